r"""Branches of a plane curve over a point, and their ramification, over finite fields.

For $f \in K[x, y]$ the branches through $x = 0$ with $y(0) = 0$ are its Puiseux series $y(x^{1/e})$. Newton
and Puiseux's algorithm finds the ramification indices e: each edge of the Newton polygon, of slope -m/q in lowest
terms, has branches $y \approx \eta\,x^{m/q}$; a simple root $\xi = \eta^q$ of its characteristic polynomial is one
branch with $e = q$, and a multiple one is followed by Duval's substitution $x \to \xi^v x^q$, $y \to x^m(\xi^u + y)$,
with $uq - vm = 1$, which needs no other extension of K than that by $\xi$ [duval1989].

K is a finite field whose characteristic is larger than the degree in y, so that all ramification is tame.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import pairwise
from math import gcd
from typing import Any, TypeAlias

Bivariate: TypeAlias = dict[tuple[int, int], Any]
"""A polynomial in x and y by the exponents, with coefficients in a finite field."""


def branches(f: Bivariate, field: Any) -> Counter[int]:
    """How many branches of each ramification index a squarefree polynomial has over x = 0, with finite y.

    Args:
        f: Monic in y, say; squarefree.
        field: FLINT's context of the finite field.
    """
    found: Counter[int] = Counter()
    over_zero = {j: c for (i, j), c in f.items() if i == 0}
    for root_field, root, multiplicity, n_conjugates in _roots(over_zero, field):
        if multiplicity == 1:
            found[1] += n_conjugates
            continue
        shifted = _shifted(_in_field(f, field, root_field), root, root_field)
        for e, count in _branches_at_origin(shifted, multiplicity, root_field).items():
            found[e] += count * n_conjugates
    return found


def _branches_at_origin(f: Bivariate, multiplicity: int, field: Any) -> Counter[int]:
    """The branches through the origin of a polynomial whose restriction to x = 0 has a zero of this multiplicity."""
    if multiplicity == 1:
        return Counter({1: 1})
    found: Counter[int] = Counter()
    lowest: dict[int, int] = {}
    for i, j in f:
        if j <= multiplicity:
            lowest[j] = min(i, lowest.get(j, i))
    if 0 not in lowest:  # y divides f, once since f is squarefree
        found[1] += 1
        first = min(lowest)
        lowest = {j: i for j, i in lowest.items() if j >= first}
    for (j0, i0), (j1, i1) in _lower_edges(lowest):
        width, height = j1 - j0, i0 - i1
        common = gcd(width, height)
        q, m = width // common, height // common
        edge = {(j - j0) // q: f[i, j] for i, j in f if j0 <= j <= j1 and (i - i1) * q == (j1 - j) * m}
        for root_field, xi, r, n_conjugates in _roots(edge, field):
            if r == 1:
                found[q] += n_conjugates
                continue
            further = _substituted(_in_field(f, field, root_field), xi, q, m, root_field)
            for e, count in _branches_at_origin(further, r, root_field).items():
                found[q * e] += count * n_conjugates
    return found


def _lower_edges(lowest: Mapping[int, int]) -> Iterable[tuple[tuple[int, int], tuple[int, int]]]:
    """The edges of the lower hull of points (j, i) that go down, from left to right."""
    hull: list[tuple[int, int]] = []
    for j, i in sorted(lowest.items()):
        while len(hull) > 1:
            (a, b), (c, d) = hull[-2], hull[-1]
            if (d - b) * (j - c) < (i - d) * (c - a):
                break
            hull.pop()
        hull.append((j, i))
    return [(p, q) for p, q in pairwise(hull) if q[1] < p[1]]


def _substituted(f: Bivariate, xi: Any, q: int, m: int, field: Any) -> Bivariate:
    """Duval's substitution, divided by the power of x that it contains."""
    u = next(u for u in range(1, m + 1) if (u * q - 1) % m == 0) if m > 1 else 1
    v = (u * q - 1) // m
    scaled: Bivariate = {}
    for (i, j), c in f.items():
        key = (q * i + m * j, j)
        scaled[key] = scaled.get(key, field.zero()) + c * xi ** (v * i)
    lowest = min(i for i, _ in scaled)
    return _shifted({(i - lowest, j): c for (i, j), c in scaled.items()}, xi**u, field)


def _shifted(f: Bivariate, c: Any, field: Any) -> Bivariate:
    """The polynomial f(x, c + y)."""
    from flint import fq_default_poly_ctx

    ring: Any = fq_default_poly_ctx(field)
    rows: dict[int, dict[int, Any]] = {}
    for (i, j), value in f.items():
        rows.setdefault(i, {})[j] = value
    linear = ring([c, field.one()])
    found: Bivariate = {}
    for i, row in rows.items():
        polynomial = ring([row.get(j, field.zero()) for j in range(max(row) + 1)])
        for j, value in enumerate(polynomial.compose(linear).coeffs()):
            if not value.is_zero():
                found[i, j] = value
    return found


def _roots(polynomial: Mapping[int, Any], field: Any) -> list[tuple[Any, Any, int, int]]:
    """The roots up to conjugation: a field that contains one, it, its multiplicity, the number of its conjugates."""
    from flint import fq_default_poly_ctx

    ring: Any = fq_default_poly_ctx(field)
    found: list[tuple[Any, Any, int, int]] = []
    coefficients = [polynomial.get(j, field.zero()) for j in range(max(polynomial) + 1)]
    for factor, multiplicity in ring(coefficients).factor()[1]:
        degree = factor.degree()
        if degree == 1 or multiplicity == 1:  # a simple root itself is not needed
            root = -factor.constant_coefficient() / factor.leading_coefficient() if degree == 1 else None
            found.append((field, root, multiplicity, degree))
            continue
        larger = _extension(field, degree)
        over: Any = fq_default_poly_ctx(larger)
        lifted = over([embedded(c, field, larger) for c in factor.coeffs()])
        found.append((larger, lifted.roots()[0][0], multiplicity, degree))
    return found


def _extension(field: Any, degree: int) -> Any:
    from flint import fq_default_ctx

    return fq_default_ctx(field.prime(), field.degree() * degree)


def _in_field(f: Bivariate, field: Any, larger: Any) -> Bivariate:
    return f if field is larger else {key: embedded(c, field, larger) for key, c in f.items()}


_IMAGES: dict[tuple[str, str], Any] = {}


def embedded(element: Any, field: Any, larger: Any) -> Any:
    """An element in a larger field, by one embedding that is chosen once."""
    if field is larger or field.degree() == 1:
        return larger(int(element)) if field is not larger else element
    key = (str(field.modulus()), str(larger.modulus()) + str(larger.prime()))
    if key not in _IMAGES:
        from flint import fq_default_poly_ctx

        over: Any = fq_default_poly_ctx(larger)
        modulus = over([larger(int(c)) for c in field.modulus().coeffs()])
        _IMAGES[key] = modulus.roots()[0][0]
    total = larger.zero()
    for c in reversed(element.to_list()):
        total = total * _IMAGES[key] + larger(int(c))
    return total
