"""What lengths on phase space are compared with.

A Lie-Poisson bracket proper is homogeneous: x and any multiple of it look alike, so that only ratios to the length of x
itself have a meaning, and the origin is a leaf of its own.  With a constant part the origin is a point like others, and
lengths are compared with 1 + |x|, in the units of the leaf (`liepoisson.phase_space.field_units`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from liepoisson.exact.bracket import Bracket


def field_length(bracket: Bracket) -> int:
    """The number of components that are in one unit: those of a field, and one where the bracket is only constant.

    Canonical coordinates are lengths, angles and what else one likes.
    """
    return bracket.algebra.dimension if next(iter(bracket.entries()), None) is not None else 1


def unit_length(bracket: Bracket) -> float:
    """What is added to the length of a state: 1 where the bracket has a constant part, else 0."""
    return 1.0 if bracket.constant else 0.0
