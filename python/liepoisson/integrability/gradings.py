r"""Gradings of a polynomial vector field, which divide the search for integrals into blocks.

Weights $w_i$ of the coordinates are a grading if all terms of D change the weight of a monomial by the same number s:
$\sum_i m_i w_i - w_k = s$ for each term $x^m\,\partial_k$ of D.  Then D maps the polynomials of weight w to those of
weight w + s, and each part of one weight of an integral is an integral.  Weights may be integers (quasi-homogeneous
equations) or integers modulo 2 (changes of signs; with s = 1 they reverse time) or 3.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.integrability.derivation import Derivation, Exponents

MODULI = (2, 3)
_MOST_COMBINATIONS = 6
"""Integer gradings are combined with factors up to this to find one with positive weights."""


@dataclass(frozen=True)
class Grading:
    """Weights of the coordinates, and what D adds to a weight.

    Attributes:
        weights: One for each coordinate.
        shift: What D adds.
        modulus: 0 for integers.
    """

    weights: tuple[int, ...]
    shift: int
    modulus: int = 0

    def of(self, monomial: Exponents) -> int:
        """The weight of a monomial."""
        weight = sum(w * k for w, k in zip(self.weights, monomial, strict=True) if k)
        return weight % self.modulus if self.modulus else weight


def gradings(derivation: Derivation) -> tuple[Grading, ...]:
    """A basis of the gradings over the integers, and of those modulo 2 and 3."""
    n = len(derivation.variables)
    relations: set[tuple[tuple[int, int], ...]] = set()
    for k, component in enumerate(derivation.components):
        for monomial in component:
            row = {i: m for i, m in enumerate(monomial) if m}
            row[k] = row.get(k, 0) - 1
            row[n] = -1
            relations.add(tuple(sorted((i, c) for i, c in row.items() if c)))
    rows = [dict(relation) for relation in sorted(relations)]
    found: list[Grading] = []
    rationals = Coefficients()
    exact = [{c: Fraction(v) for c, v in row.items()} for row in rows]
    for vector in nullspace(exact, n + 1, rationals).vectors:
        scale = lcm(*(value.denominator for value in vector.values()))
        whole = [int(vector.get(i, 0) * scale) for i in range(n + 1)]
        common = gcd(*whole)
        found.append(_grading([w // common for w in whole], 0))
    for q in MODULI:
        found += [_grading([v.get(i, 0) for i in range(n + 1)], q) for v in nullspace_mod(rows, n + 1, q)]
    return tuple(g for g in found if any(g.weights))


def _grading(whole: Sequence[int], modulus: int) -> Grading:
    return Grading(tuple(whole[:-1]), whole[-1], modulus)


def positive_grading(found: Iterable[Grading]) -> Grading | None:
    """A grading with positive integer weights, small ones preferred; None if there is none of small factors."""
    integer = [g for g in found if not g.modulus]
    best: Grading | None = None
    for factors in _small_vectors(len(integer)):
        weights = [sum(f * g.weights[i] for f, g in zip(factors, integer, strict=True)) for i in _range(integer)]
        if not weights or min(weights) <= 0:
            continue
        shift = sum(f * g.shift for f, g in zip(factors, integer, strict=True))
        common = gcd(*weights, shift)
        candidate = Grading(tuple(w // common for w in weights), shift // common)
        if best is None or (abs(candidate.shift - 1), sum(candidate.weights)) < (
            abs(best.shift - 1),
            sum(best.weights),
        ):
            best = candidate
    return best


def _range(integer: Sequence[Grading]) -> range:
    return range(len(integer[0].weights)) if integer else range(0)


def _small_vectors(n: int) -> Iterable[tuple[int, ...]]:
    from itertools import product

    bound = _MOST_COMBINATIONS if n <= 2 else 2
    return product(range(-bound, bound + 1), repeat=n) if n <= 5 else ()


def homogeneous_parts(polynomial: Polynomial, found: Sequence[Grading]) -> dict[tuple[int, ...], Polynomial]:
    """The parts of a polynomial, by their weights in all gradings."""
    parts: dict[tuple[int, ...], Polynomial] = {}
    for monomial, coefficient in polynomial.items():
        parts.setdefault(tuple(g.of(monomial) for g in found), {})[monomial] = coefficient
    return parts
