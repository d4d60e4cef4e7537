"""What the functions on phase space read: systems with numbers for all parameters, energies, and values of Casimirs.

Casimirs are given by name, C1, C2, ..., or by formula: l.alpha, |alpha|^2, dot(l, alpha).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from liepoisson.errors import ParameterError, did_you_mean
from liepoisson.formula.scalars import as_number
from liepoisson.inputs.refusals import not_a_system

if TYPE_CHECKING:
    from liepoisson.model.system import System


def as_system(system: Any) -> System:
    """A system whose parameters are all numbers.

    Raises:
        ParameterError: it is no system (a text, a class, ...), or a parameter has no number.
    """
    from liepoisson.model.system import System

    if not isinstance(system, System):
        raise not_a_system(system)
    if len(system.component_names) != system.bracket.dimension:
        found = ", ".join(system.component_names[system.bracket.dimension :])
        raise ParameterError(
            f"system: wanted one whose state is a point of its phase space; {system.name} has {found} besides, found "
            "by quadrature; make it without quadratures"
        )
    if system.polynomial_hamiltonian is not None or system.typed_hamiltonian is not None:
        return system
    in_energy = {str(symbol) for symbol in system.hamiltonian.free_symbols if symbol not in system.variables}
    if free := in_energy | system.bracket.symbols:
        names = ", ".join(sorted(free))
        raise ParameterError(f"{system.name} must have numbers for all parameters; got none for {names}. Give values.")
    return system


def are_equal(first: System, second: System) -> bool:
    """Whether two systems have the same coordinates, bracket and Hamiltonian, whatever their names."""
    if first is second:
        return True
    names = [[str(x) for x in system.variables] for system in (first, second)]
    if names[0] != names[1] or set(first.bracket.terms()) != set(second.bracket.terms()):
        return False
    difference = first.hamiltonian - second.hamiltonian
    return bool(difference == 0 or difference.expand() == 0)


def as_energy(value: Any, name: str = "energy") -> float:
    """A finite energy as a plain float.

    Raises:
        ParameterError: it is no finite real number.
    """
    energy = as_number(value, name, "a finite number")
    if not np.isfinite(energy):
        hint = "Take one of leaf.energy_range()." if name.endswith("energy") else "Leave it out?"
        raise ParameterError(f"{name} must be a finite number; got {energy}. {hint}")
    return energy


T = TypeVar("T")

_SQUARE, _DOT = re.compile(r"\|([A-Za-z_]\w*)\|\s*\^\s*2"), re.compile(r"\b([A-Za-z_]\w*)\s*\.\s*([A-Za-z_]\w*)\b")


def by_name(system: System, given: Mapping[str, T], what: str = "casimirs") -> dict[str, T]:
    """Values by the names C1, C2, ... of the Casimirs, whether these were named or written as formulas.

    Raises:
        ParameterError: a name is no Casimir of the bracket, or one comes twice; the message says what they are.
    """
    known = tuple(system.functions.casimirs)
    values: dict[str, T] = {}
    for key, value in given.items():
        name = key if key in known else _name_of(system, str(key))
        if name is None:
            hint = did_you_mean(key, known)
            raise ParameterError(
                f"{what} must name Casimirs of {system.name}; got {str(key)!r:.60}. Known: "
                f"{', '.join(formulas(system)) or 'none'}. {hint}{example_of_values(what, known)}"
            )
        if name in values:
            raise ParameterError(f"{what} must give each Casimir once; {name} comes twice. Remove one.")
        values[name] = value
    return values


def formulas(system: System) -> list[str]:
    """The Casimirs with their formulas, as messages name them: "C1 = l.alpha"."""
    from liepoisson.formula.styles import PLAIN
    from liepoisson.report.vector_notation import VectorNotation

    notation, casimirs = VectorNotation(system.bracket), system.bracket.casimirs()
    texts = [notation.formula(casimir).write(PLAIN) for casimir in casimirs]
    return [f"C{k}" + (f" = {text}" if len(text) <= 60 else "") for k, text in enumerate(texts, start=1)]


def _name_of(system: System, formula: str) -> str | None:
    """The Casimir that a formula is, if it is one."""
    text = _DOT.sub(r"dot(\1, \2)", _SQUARE.sub(r"dot(\1, \1)", formula))
    try:
        expression = system.expression(text)
    except ParameterError:
        return None
    equal = (name for name, f in system.functions.casimirs.items() if (f.expression - expression).expand() == 0)
    return next(equal, None)


def example_of_values(what: str, known: tuple[str, ...]) -> str:
    """What to write for values of these Casimirs; where there are none, nothing has to be given."""
    if not known:
        return f"Leave {what} out." if what.startswith("--") else "Write {}, which gives values to none."
    if what.startswith("--"):
        return f"Write {what} {known[0]}=1."
    values = ", ".join(f'"{name}": ...' for name in known)
    return f"Write {{{values}}}."
