r"""The genus of a plane curve $f(z, w) = 0$ with rational coefficients, monic in w, exactly.

Riemann and Hurwitz: for the covering of the sphere by z, of degree d, $2g - 2 = -2d + \sum_P (e_P - 1)$ over the
places P with their ramification indices. The covering is unramified where the discriminant $\Delta(z)$ does not vanish.
Over its zeros and over infinity the indices are those of the curve modulo a prime p, for a p that

* is larger than d and divides no denominator,
* leaves the degree of $\Delta$ and the number of its distinct zeros as they are.

Then the zeros of $\Delta$ and infinity do not meet modulo p, all ramification is tame, and the covering has good
reduction: by Abhyankar's lemma its ramification and its components are the same over the rationals and modulo p
[poteaux2012]. Both conditions are verified. The curve is absolutely irreducible if it is irreducible modulo p and has a
simple rational point there.

For $f \in K[x, y]$ over a finite field K the branches through $x = 0$ with $y(0) = 0$ are its Puiseux series
$y(x^{1/e})$. Newton and Puiseux's algorithm finds the ramification indices e: each edge of the Newton polygon, of slope
-m/q in lowest terms, has branches $y \approx \eta\,x^{m/q}$; a simple root $\xi = \eta^q$ of its characteristic
polynomial is one branch with $e = q$, and a multiple one is followed by Duval's substitution $x \to \xi^v x^q$,
$y \to x^m(\xi^u + y)$, with $uq - vm = 1$, which needs no other extension of K than that by $\xi$ [duval1989].
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import gcd, lcm
from random import Random
from typing import Any, TypeAlias

from flint import Ordering, fmpz_mpoly_ctx, fmpz_poly, fq_default_ctx, fq_default_poly_ctx, nmod_mpoly_ctx, nmod_poly
from sympy import nextprime

Curve: TypeAlias = Mapping[tuple[int, int], Fraction]
"""A polynomial in z, 1/z and w, monic in w, by the exponents of z and w."""

_FIRST_PRIME = 2**30
_MOST_PRIMES = 12
_MOST_POINTS = 60
_LARGEST_DISCRIMINANT = 320
"""Degree of the largest discriminant that is made."""


@dataclass(frozen=True)
class Genus:
    """The genus of a curve, with what it was computed from."""

    value: int | None  # the genus; None if it was not decided
    n_branch_points: int = 0  # number of points of the sphere over which a place is ramified
    prime: int = 0  # the prime of good reduction
    reason: str = ""  # why it was not decided; empty if it was


def interior_points(curve: Curve) -> int:
    """Lattice points inside the Newton polygon: the genus is at most their number (Baker), and equal to it in general.

    References: [khovanskii1978].
    """
    points = sorted(set(curve))
    hull = _half_hull(points)[:-1] + _half_hull(points[::-1])[:-1]
    if len(hull) < 3:
        return 0
    sides = list(zip(hull, hull[1:] + hull[:1], strict=True))
    double_area = abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in sides))
    boundary = sum(gcd(a[0] - b[0], a[1] - b[1]) for a, b in sides)
    return (double_area - boundary) // 2 + 1


def _half_hull(points: list[tuple[int, int]]) -> list[tuple[int, int]]:
    hull: list[tuple[int, int]] = []
    for p in points:
        while len(hull) > 1:
            (a, b), (c, d) = hull[-2], hull[-1]
            if (c - a) * (p[1] - b) > (d - b) * (p[0] - a):
                break
            hull.pop()
        hull.append(p)
    return hull


def integral(curve: Curve) -> Curve:
    """The curve in z and $z^k w$, with the smallest k for which no power of z is negative."""
    d = max(j for _, j in curve)
    k = max((-(i // (d - j)) for i, j in curve if j < d), default=0)
    return {(i + k * (d - j), j): c for (i, j), c in curve.items()}


def at_infinity(curve: Curve) -> Curve:
    """The curve in 1/z, integral there."""
    return integral({(-i, j): c for (i, j), c in curve.items()})


def genus(curve: Curve) -> Genus:
    """The genus of an irreducible curve."""
    d = max(j for _, j in curve)
    if d == 1:
        return Genus(0)
    finite, infinite = integral(curve), at_infinity(curve)
    if 2 * max(i for i, _ in finite) * (d - 1) > _LARGEST_DISCRIMINANT:
        return Genus(None, reason=f"the discriminant may have a degree above {_LARGEST_DISCRIMINANT}")
    denominator = lcm(*(c.denominator for c in finite.values()))
    discriminant: Any = _discriminant(finite, denominator)
    if not discriminant:
        return Genus(None, reason="the polynomial has a multiple factor")
    n_zeros, p = _n_zeros(discriminant), _FIRST_PRIME
    for _ in range(_MOST_PRIMES):
        p = int(nextprime(p))
        image = nmod_poly([int(c) % p for c in discriminant.coeffs()], p)
        if denominator % p == 0 or image.degree() < discriminant.degree() or _n_zeros(image) != n_zeros:
            continue
        if _is_absolutely_irreducible(finite, p):
            ramification, n_points = _ramification(finite, infinite, discriminant, p)
            assert ramification % 2 == 0, "the ramification of a covering of the sphere is even"
            return Genus(1 - d + ramification // 2, n_points, p)
    return Genus(None, reason="not found irreducible over the complex numbers")


def _discriminant(curve: Curve, denominator: int) -> Any:
    """A multiple of the discriminant, as a polynomial in z with whole coefficients."""
    context = fmpz_mpoly_ctx.get(["z", "w"], Ordering.lex)
    f = context.from_dict({key: int(c * denominator) for key, c in curve.items()})
    found = f.discriminant("w")
    coefficients = {int(m[0]): int(c) for m, c in found.terms()}
    return fmpz_poly([coefficients.get(k, 0) for k in range(max(coefficients, default=-1) + 1)])


def _n_zeros(f: Any) -> int:
    """How many different zeros a polynomial has."""
    return f.degree() - f.gcd(f.derivative()).degree() if f.degree() > 0 else 0


def _residue(c: Fraction, p: int) -> int:
    return c.numerator * pow(c.denominator, -1, p) % p


def _is_absolutely_irreducible(curve: Curve, p: int) -> bool:
    """Whether the curve modulo p is irreducible and has a simple point with coordinates modulo p."""
    context = nmod_mpoly_ctx.get(["z", "w"], modulus=p, ordering=Ordering.lex)
    f = context.from_dict({key: v for key, c in curve.items() if (v := _residue(c, p))})
    factors = [(q, e) for q, e in f.factor()[1] if q.degrees()[1]]
    if len(factors) != 1 or factors[0][1] != 1:
        return False
    random = Random(p)
    for _ in range(_MOST_POINTS):
        z = random.randrange(1, p)
        values: dict[int, int] = {}
        for (i, j), c in curve.items():
            values[j] = (values.get(j, 0) + _residue(c, p) * pow(z, i, p)) % p
        fibre = nmod_poly([values.get(j, 0) for j in range(max(values) + 1)], p)
        if any(q.degree() == 1 and e == 1 for q, e in fibre.factor()[1]):
            return True
    return False


def _ramification(finite: Curve, infinite: Curve, discriminant: Any, p: int) -> tuple[int, int]:
    """The sum of e - 1 over all places, and over how many points of the sphere it is not zero."""
    field = fq_default_ctx(p, 1)
    total, n_points = 0, 0
    residues = {k: field(int(c) % p) for k, c in enumerate(discriminant.coeffs())}
    for root_field, root, multiplicity, degree in _roots(residues, field):
        # a simple zero is one place with e = 2
        local = 1 if multiplicity == 1 else _defect(finite, root_field, root, p)
        assert local <= multiplicity, "the ramification is part of the discriminant"
        assert (multiplicity - local) % 2 == 0, "the rest of the discriminant is twice the singularities"
        total += degree * local
        n_points += degree * (local > 0)
    over_infinity = _defect(infinite, field, field.zero(), p)
    return total + over_infinity, n_points + (over_infinity > 0)


def _defect(curve: Curve, field: Any, z: Any, p: int) -> int:
    """The sum of e - 1 over a point z of the affine line."""
    swapped = {(j, i): field(_residue(c, p)) for (i, j), c in curve.items()}
    local = {(i, j): c for (j, i), c in _shifted(swapped, z, field).items()}
    return sum((e - 1) * count for e, count in branches(local, field).items())


Bivariate: TypeAlias = dict[tuple[int, int], Any]
"""A polynomial in x and y by the exponents, with coefficients in a finite field."""


def branches(f: Bivariate, field: Any) -> Counter[int]:
    """How many branches of each ramification index a squarefree polynomial has over x = 0, with finite y."""
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
    return [(p, q) for p, q in pairwise(_half_hull(sorted(lowest.items()))) if q[1] < p[1]]


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
    ring: Any = fq_default_poly_ctx(field)
    found: list[tuple[Any, Any, int, int]] = []
    coefficients = [polynomial.get(j, field.zero()) for j in range(max(polynomial) + 1)]
    for factor, multiplicity in ring(coefficients).factor()[1]:
        degree = factor.degree()
        if degree == 1 or multiplicity == 1:  # a simple root itself is not needed
            root = -factor.constant_coefficient() / factor.leading_coefficient() if degree == 1 else None
            found.append((field, root, multiplicity, degree))
            continue
        found.append((*_with_root(factor, field), multiplicity, degree))
    return found


def _with_root(factor: Any, field: Any) -> tuple[Any, Any]:
    """The field that a root of an irreducible polynomial generates, and one."""
    larger = fq_default_ctx(field.prime(), field.degree() * factor.degree())
    over: Any = fq_default_poly_ctx(larger)
    return larger, over([embedded(c, field, larger) for c in factor.coeffs()]).roots()[0][0]


def _in_field(f: Bivariate, field: Any, larger: Any) -> Bivariate:
    return f if field is larger else {key: embedded(c, field, larger) for key, c in f.items()}


_IMAGES: dict[tuple[str, str], Any] = {}


def embedded(element: Any, field: Any, larger: Any) -> Any:
    """An element in a larger field, by one embedding that is chosen once."""
    if field is larger or field.degree() == 1:
        return larger(int(element)) if field is not larger else element
    key = (str(field.modulus()), str(larger.modulus()) + str(larger.prime()))
    if key not in _IMAGES:
        over: Any = fq_default_poly_ctx(larger)
        modulus = over([larger(int(c)) for c in field.modulus().coeffs()])
        _IMAGES[key] = modulus.roots()[0][0]
    total = larger.zero()
    for c in reversed(element.to_list()):
        total = total * _IMAGES[key] + larger(int(c))
    return total
