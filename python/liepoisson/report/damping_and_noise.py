"""What is reported about a system that is damped or shaken, beside what is reported of the system without."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from liepoisson.report.lines import Line, joined, record_of_formula
from liepoisson.report.topics import Topic
from liepoisson.report.vector_notation import VectorNotation

if TYPE_CHECKING:
    from liepoisson.damping.damped_system import DampedSystem
    from liepoisson.model.system import System


class HasNoise(Protocol):
    """A system with noise, such as `NoisySystem`."""

    name: str
    system: System
    noises: tuple[str, ...]
    inverse_temperature: Any

    @property
    def noise(self) -> dict[str, Any]:
        """Noises and inverse temperature as arguments."""
        ...


def damping_topic(damped: DampedSystem) -> Topic:
    """The damping, and what falls, rises and stays with it."""
    notation = VectorNotation(damped.undamped.bracket)
    rate, entropy = notation.formula(damped.rate), damped.entropy
    of_entropy = [] if entropy is None else [", entropy ", notation.formula(entropy)]
    lines: list[Line] = [(f"{damped.damping.kind}, rate ", rate, *of_entropy)]
    lines += [(str(law),) for law in damped.laws]
    lines.append(("all that follows is about the system without damping",))
    return Topic(
        "damping",
        lines,
        lambda: {
            "kind": damped.damping.kind,
            "rate": record_of_formula(rate, damped.rate),
            "entropy": None if entropy is None else record_of_formula(notation.formula(entropy), entropy),
            "laws": [{"quantity": law.quantity, "motion": law.motion, "known": law.known} for law in damped.laws],
            "equations": {
                str(x): record_of_formula(notation.components(value), value) for x, value in damped.equations.items()
            },
        },
    )


def noise_topic(noisy: HasNoise) -> Topic:
    r"""The noise Hamiltonians, and which invariants are constant on every path, $\{f, H\} = \{f, H_k\} = 0$."""
    system, notation = noisy.system, VectorNotation(noisy.system.bracket)
    noises = [system.expression(text) for text in noisy.noises]
    formulas, beta = [notation.formula(noise) for noise in noises], noisy.inverse_temperature
    constant = [
        name
        for name, f in system.invariants.items()
        if system.is_casimir(f)
        or (system.is_constant(f) and all(system.bracket(f, noise).expand() == 0 for noise in noises))
    ]
    lines: list[Line] = [("noise Hamiltonians ", *(joined(formulas) or ["none"]))]
    if beta:
        lines.append((f"inverse temperature {beta}: with it exp(-{beta} H) is stationary on each leaf",))
    lines.append((f"constant on every path: {', '.join(constant) or 'none that is known'}",))
    lines.append(("all that follows is about the system without noise",))
    return Topic(
        "noise",
        lines,
        lambda: {
            "noises": [record_of_formula(*pair) for pair in zip(formulas, noises, strict=True)],
            "inverse_temperature": str(beta),
            "constant": constant,
        },
    )
