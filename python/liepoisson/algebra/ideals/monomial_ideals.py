r"""Ideals that monomials generate: their dimension, degree and standard monomials.

The standard monomials, which no generator divides, are counted by the Hilbert series $K(t)/(1-t)^n$. Adding a generator
m changes the numerator by $-t^{\deg m}K_{I:m}$. With dimension d the degree is $K(t)/(1-t)^{n-d}$ at t = 1.

References: [cox2015], chapter 9.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpz_poly

from liepoisson.algebra.sparse_polynomials import Monomial, divides


def dimension(leads: Sequence[Monomial], n: int) -> int:
    """The largest number of variables of which no generator is a product; -1 if 1 is a generator."""
    if any(not any(m) for m in leads):
        return -1
    supports = {frozenset(k for k, power in enumerate(m) if power) for m in leads}
    return n - _least_cover([s for s in supports if not any(other < s for other in supports)], n)


def _least_cover(supports: Sequence[frozenset[int]], most: int) -> int:
    """The smallest number of variables that meet all supports."""
    if not supports:
        return 0
    if most <= 0:
        return 1
    smallest = min(supports, key=len)
    best = most
    for k in smallest:
        best = min(best, 1 + _least_cover([s for s in supports if k not in s], best - 1))
    return best


def degree(leads: Sequence[Monomial], n: int) -> int:
    """The degree of the ideal, in dimension 0 the number of standard monomials; 0 if 1 is a generator."""
    d = dimension(leads, n)
    if d < 0:
        return 0
    numerator = _numerator(_minimal(leads))
    return int((numerator // fmpz_poly([1, -1]) ** (n - d))(1))


def _numerator(generators: Sequence[Monomial]) -> fmpz_poly:
    if not generators:
        return fmpz_poly([1])
    if all(
        not any(a and b for a, b in zip(m, o, strict=True)) for i, m in enumerate(generators) for o in generators[:i]
    ):
        total = fmpz_poly([1])
        for m in generators:
            total *= 1 - fmpz_poly([0, 1]) ** sum(m)
        return total
    *others, last = sorted(generators, key=sum)
    quotients = _minimal([tuple(max(a - b, 0) for a, b in zip(m, last, strict=True)) for m in others])
    return _numerator(others) - fmpz_poly([0, 1]) ** sum(last) * _numerator(quotients)


def _minimal(monomials: Sequence[Monomial]) -> list[Monomial]:
    distinct = list(dict.fromkeys(monomials))
    return [m for m in distinct if not any(other != m and divides(other, m) for other in distinct)]


def standard_monomials(leads: Sequence[Monomial], n: int) -> list[Monomial]:
    """The monomials that no generator divides, by degree; of an ideal of dimension 0."""
    level: list[Monomial] = [(0,) * n] if all(any(m) for m in leads) else []
    found: list[Monomial] = []
    while level:
        found += level
        above = dict.fromkeys((*m[:k], m[k] + 1, *m[k + 1 :]) for m in level for k in range(n))
        level = [m for m in above if not any(divides(lead, m) for lead in leads)]
    return found
