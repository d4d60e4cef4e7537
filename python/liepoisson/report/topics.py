"""Parts of a report, and which of them are left out, by the size of the system: they would take minutes.

The limits are sizes and not times, so that a report says the same on every machine.  At each of them its part takes
some seconds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.report.lines import Line

TITLES = {
    "damping": "Damping",
    "noise": "Noise",
    "algebra": "Lie algebra",
    "extension": "Extension",
    "bracket": "Bracket",
    "casimirs": "Casimirs",
    "rank": "Rank",
    "strata": "Leaves",
    "symmetries": "Symmetries",
    "hamiltonian": "Hamiltonian",
    "equations": "Equations",
    "integrals": "Known integrals",
    "kernel": "Kernel",
}
"""The parts by their names in JSON, in the order of printing, with their headings."""

_MOTION = {"coordinates": 200, "terms in H": 400}

LIMITS = {
    "algebra": {"dimensions": 300},  # its series and its Killing form are dense
    "extension": {"fields": 40},  # its unit and its normal form
    "bracket": {"coordinates": 200},  # the Jacobi identity and all that rests on it
    "symmetries": {"fields": 20, **_MOTION},  # matrices that act on the fields, and keep H
    "hamiltonian": {"terms in H": 400},  # when it is expanded
    "equations": _MOTION,
}
"""The largest sizes at which a part is computed."""


@dataclass(frozen=True)
class Topic:
    """One part of a report."""

    key: str  # its name in JSON
    lines: Sequence[Line]  # the facts in words and formulas
    record: Callable[[], Any]  # makes the facts as data that JSON can write

    @property
    def title(self) -> str:
        """Its heading."""
        return TITLES[self.key]


def not_computed(key: str, obstacle: str) -> Topic:
    """A part that was left out, and why."""
    return Topic(key, [(f"not computed: {obstacle}",)], lambda: {"not_computed": obstacle})


def unless_too_large(key: str, system: System, make: Callable[[], Topic]) -> Topic:
    """A part, or where the system is too large for it, the sentence that says so."""
    return not_computed(key, obstacle) if (obstacle := too_large(key, system)) else make()


def too_large(key: str, system: System) -> str:
    """Why a part is not computed; empty if it is."""
    from liepoisson.formula.arithmetic import expanded_terms

    bracket = system.bracket
    sizes: dict[str, Callable[[], int]] = {
        "dimensions": lambda: bracket.algebra.dimension,
        "fields": lambda: bracket.extension.dimension,
        "coordinates": lambda: bracket.dimension,
        "terms in H": lambda: expanded_terms(system.hamiltonian),
    }
    for things, limit in LIMITS[key].items():
        if (size := sizes[things]()) > limit:
            return f"{size} {things} (limit {limit})"
    return ""
