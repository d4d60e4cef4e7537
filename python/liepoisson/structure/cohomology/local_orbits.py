r"""Orbits of the twists of one local algebra under its automorphisms.

* R and C have no class but zero.
* $\mathbb R[x,y]/(x,y)^2$: the classes are the binary cubics $C(v) = v \wedge f(v, v)$, on which GL2 acts, divided by
  the determinant.  There are five orbits, told apart by the roots.
* $\mathbb R[x]/(x^n)$: the classes are the polynomials p of degree at most n - 2, the deformations $x^n = t\,p(x)$.
  The substitution $x = y w(y)$ takes p to $p(y w)\,w^{-n}$ modulo $y^{n-1}$; so $p = x^i v(x)$ with $v(0) \ne 0$ goes
  to $x^i$ or $-x^i$, for which $w^{n-i} = \pm v(y w)$ is to be solved: with the sign of $v(0)$ if n - i is even, else
  with either one.
* $\mathbb C[x]/(x^n)$: the same without a sign, since v(0) has all roots.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import Exact
from liepoisson.algebra.real_fields import RealField, real_field
from liepoisson.structure.cohomology.binary_cubics import KINDS, discriminant, kind_of
from liepoisson.structure.extension import Extension, Products
from liepoisson.structure.normal_forms import complex_truncated_polynomials, null_square, truncated_polynomials

if TYPE_CHECKING:
    from liepoisson.structure.cohomology.cocycle import Cocycle

ZERO = "zero"
"""What the orbit of the class zero is called."""


@dataclass(frozen=True)
class LocalOrbits:
    """The orbits of a local algebra.

    Attributes:
        algebra: It, a normal form.
        representatives: A cocycle of each orbit, by what the classes of the orbit have in common, in words.
    """

    algebra: Extension
    representatives: Mapping[str, Products]

    @classmethod
    def of(cls, algebra: Extension) -> LocalOrbits | None:
        """Those of a normal form; None if they are not known."""
        n, name = algebra.dimension, algebra.name
        if name == null_square(3).name:
            return cls(algebra, {kind: _products_of_cubic(form) for kind, form in KINDS.items()})
        for m, place in ((n, truncated_polynomials(n)), (n // 2, complex_truncated_polynomials(max(n // 2, 1)))):
            if name == place.name:
                return cls(algebra, {ZERO: {}, **_of_powers(m, is_complex=name.startswith("C"))})
        return None

    def orbit_of(self, f: Cocycle) -> str:
        """The orbit of a cocycle of the algebra.

        Raises:
            ParameterError: it depends on the sign of an expression in symbols.
        """
        if f.is_coboundary:
            return ZERO
        if self.algebra.name == null_square(3).name:
            cubic, field = cubic_of(f)
            disc = discriminant(cubic)
            return kind_of(cubic, field.sign(disc) if disc else 0)
        if self.algebra.name.startswith("C"):
            n = self.algebra.dimension // 2
            return _condition(n, n - 1 - f.orbit_dimension // 2, 1)
        n = self.algebra.dimension
        i, value = next((i, c) for i, c in enumerate(f.coordinates) if c != 0)
        field = real_field([value])
        return _condition(n, i, field.sign(field.read(value)) if (n - i) % 2 == 0 else 1)


def cubic_of(f: Cocycle) -> tuple[tuple[Any, Any, Any, Any], RealField]:
    r"""The coefficients of $v \wedge f(v, v)$, $v = X e_1 + Y e_2$, and the field that they live in."""
    p, q, r = (f.representative.products.get(pair, {}) for pair in ((1, 1), (1, 2), (2, 2)))
    field = real_field(value for row in (p, q, r) for value in row.values())

    def entry(row: Mapping[int, Exact], k: int) -> Any:
        return field.read(row[k]) if k in row else field.zero

    two = field.number(2)
    return (entry(p, 2), two * entry(q, 2) - entry(p, 1), entry(r, 2) - two * entry(q, 1), -entry(r, 1)), field


def _products_of_cubic(form: tuple[int, int, int, int]) -> Products:
    """The cocycle e1 e1 = -b e1 + a e2, e2 e2 = -d e1 + c e2 of a cubic."""
    a, b, c, d = map(Fraction, form)
    rows = {(1, 1): {1: -b, 2: a}, (2, 2): {1: -d, 2: c}}
    found = {pair: {k: value for k, value in row.items() if value} for pair, row in rows.items()}
    return cast("Products", {pair: row for pair, row in found.items() if row})


def _of_powers(n: int, *, is_complex: bool) -> dict[str, Products]:
    """x^n = x^i, read to first order, the smaller orbits first."""
    found: dict[str, Products] = {}
    for i in reversed(range(n - 1)):
        for sign in (1, -1) if (n - i) % 2 == 0 and not is_complex else (1,):
            pairs = [(a, b) for a in range(1, n) for b in range(a, n) if n <= a + b < 2 * n - i]
            products: Products = {(a, b): {a + b - n + i: Fraction(sign)} for a, b in pairs}
            found[_condition(n, i, sign)] = _over_c(products) if is_complex else products
    return found


def _over_c(products: Products) -> Products:
    """The same over the complex numbers, in the basis 1, i, x, ix, ... of the reals."""
    found: Products = {}
    for (a, b), row in products.items():
        for p in (0, 1):
            for q in (0, 1) if a != b else range(p, 2):
                sign = Fraction(-1 if p and q else 1)
                target = {2 * k + (p + q) % 2: sign * cast("Fraction", value) for k, value in row.items()}
                found[2 * a + p, 2 * b + q] = cast("dict[int, Exact]", target)
    return found


def _condition(n: int, i: int, sign: int) -> str:
    power = "" if not i else "*x" if i == 1 else f"*x^{i}"
    return f"x^{n} = {'' if sign > 0 else '-'}t{power}"
