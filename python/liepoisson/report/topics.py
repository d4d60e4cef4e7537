"""Parts of a report, and which of them are left out, by the size of the system: they would take minutes.

The limits are sizes and not times, so that a report says the same on every machine.  At each of them its part takes
some seconds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.report.lines import Line
    from liepoisson.structure.bracket import Bracket

TITLES = {
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

MOST_DIMENSIONS = 300
"""Of the Lie algebra: its series and its Killing form are dense."""

MOST_COORDINATES = 200
"""For the Jacobi identity and all that rests on it, and for the equations."""

MOST_FIELDS = 40
"""For the unit of the extension and its normal form."""

MOST_FIELDS_MOVED = 20
"""For symmetries, which are matrices that act on the fields."""

MOST_TERMS = 400
"""Of the Hamiltonian when it is expanded, for its equations and for the symmetries that keep it."""


@dataclass(frozen=True)
class Topic:
    """One part of a report."""

    key: str  # its name in JSON
    told: Sequence[Line]  # the facts in words and formulas
    data: Callable[[], Any]  # makes the facts as data that JSON can write

    @property
    def title(self) -> str:
        """Its heading."""
        return TITLES[self.key]

    def lines(self) -> list[Line]:
        """The facts in words and formulas."""
        return list(self.told)

    def record(self) -> Any:
        """The facts as data that JSON can write."""
        return self.data()


def not_computed(key: str, obstacle: str) -> Topic:
    """A part that was left out, and why."""
    return Topic(key, [(f"not computed: {obstacle}",)], lambda: {"not_computed": obstacle})


def unless(obstacle: str, key: str, make: Callable[[], Topic]) -> Topic:
    """A part, or where there is an obstacle, the sentence that says why it is left out."""
    return not_computed(key, obstacle) if obstacle else make()


def too_large_algebra(bracket: Bracket) -> str:
    """Why the Lie algebra is not examined; empty if it is."""
    return _beyond(bracket.algebra.dimension, MOST_DIMENSIONS, "dimensions")


def too_large_extension(bracket: Bracket) -> str:
    """Why the extension is not examined; empty if it is."""
    return _beyond(bracket.extension.dimension, MOST_FIELDS, "fields")


def too_large_bracket(bracket: Bracket) -> str:
    """Why the Jacobi identity, the Casimirs and the leaves are not examined; empty if they are."""
    return _beyond(bracket.dimension, MOST_COORDINATES, "coordinates")


def too_large_motion(bracket: Bracket, hamiltonian: Expr) -> str:
    """Why the equations are not printed; empty if they are."""
    return too_large_bracket(bracket) or too_large_formula(hamiltonian)


def too_large_formula(hamiltonian: Expr) -> str:
    """Why the Hamiltonian is printed as it is, and nothing that needs its terms; empty if it is not too large."""
    from liepoisson.formula.arithmetic import expanded_terms

    return _beyond(expanded_terms(hamiltonian), MOST_TERMS, "terms in H")


def too_large_for_symmetries(bracket: Bracket, hamiltonian: Expr) -> str:
    """Why symmetries are not looked for; empty if they are."""
    few = _beyond(bracket.extension.dimension, MOST_FIELDS_MOVED, "fields")
    return few or too_large_motion(bracket, hamiltonian)


def _beyond(size: int, limit: int, things: str) -> str:
    return f"{size} {things} (limit {limit})" if size > limit else ""
