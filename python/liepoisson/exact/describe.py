"""Systems as text, written as the paper writes them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from liepoisson.exact.system import System
    from liepoisson.exact.top_parameters import TopParameters


def describe(system: System) -> str:
    """Name, bracket, Hamiltonian, equations of motion and invariants of a system, one per line."""
    top = system.top_parameters
    lines = [system.name, f"  bracket      {system.bracket!r}", f"  Hamiltonian  H = {system.hamiltonian}"]
    lines += _equation_lines(system) if top is None else _top_lines(top)
    lines.append("  invariants")
    lines += [f"    {name} = {expression}" for name, expression in system.invariants.items()]
    return "\n".join(lines)


def _equation_lines(system: System) -> list[str]:
    return ["  equations"] + [f"    {variable}' = {value}" for variable, value in system.equations.items()]


def _top_lines(top: TopParameters) -> list[str]:
    return [
        f"  parameters   {top.describe()}",
        "  equations    omega = I^-1 l",
        "    l' = l × omega + alpha × a + beta × b",
        "    alpha' = alpha × omega + epsilon beta × a",
        "    beta' = beta × omega",
    ]
