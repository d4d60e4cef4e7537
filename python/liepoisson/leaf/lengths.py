"""What lengths on phase space are compared with.

A Lie-Poisson bracket proper is homogeneous: x and any multiple of it look alike, so that only ratios to the length of x
itself have a meaning, and the origin is a leaf of its own.  With a constant part the origin is a point like others, and
lengths are compared with 1 + |x|, in the units of the leaf (`liepoisson.leaf.field_units`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.linear_algebra import nullspace

if TYPE_CHECKING:
    from liepoisson.structure.bracket import Bracket

_MOST = 100
"""Coordinates beyond which the gradings are not looked for."""


@lru_cache(maxsize=64)
def unit_groups(bracket: Bracket) -> tuple[int, ...]:
    r"""Which coordinates are in one unit: a number for each, equal for those that are.

    Those of one field are, unless weights tell them apart with $w_i + w_j = w_m$ whenever $x_m$ occurs in
    $\{x_i, x_j\}$: then $x_i\to s^{w_i}x_i$ keeps the bracket, as for rotations and translations in se(n).  Where the
    bracket is only constant each coordinate has a unit of its own: canonical coordinates are lengths, angles and what
    else one likes.
    """
    n, N = bracket.algebra.dimension, bracket.dimension
    entries = bracket.entries()
    if not entries:
        return tuple(range(N))
    keys = [(i // n, *weights) for i, weights in enumerate(_weights(entries, N))]
    number = {key: k for k, key in enumerate(dict.fromkeys(keys))}
    return tuple(number[key] for key in keys)


def _weights(entries: Iterable[tuple[int, int, int, Any]], n: int) -> list[tuple[Any, ...]]:
    """The weights of each coordinate in a basis of all gradings of the linear part."""
    if n > _MOST:
        return [()] * n
    relations: set[tuple[tuple[int, int], ...]] = set()
    for i, j, m, _ in entries:
        relation = Counter((i, j))
        relation[m] -= 1
        relations.add(tuple(sorted((k, c) for k, c in relation.items() if c)))
    rows = [{k: Fraction(c) for k, c in relation} for relation in sorted(relations)]
    basis = nullspace(rows, n, Coefficients()).vectors
    return [tuple(vector.get(i, 0) for vector in basis) for i in range(n)]


def unit_length(bracket: Bracket) -> float:
    """What is added to the length of a state: 1 where the bracket has a constant part, else 0."""
    return 1.0 if bracket.constant else 0.0
