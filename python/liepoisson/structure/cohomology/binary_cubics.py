r"""Normal forms of binary cubics $C = a X^3 + b X^2 Y + c X Y^2 + d Y^3$ under GL2, twisted by the determinant.

A basis $e'_i = \sum_j M_{ij} e_j$ of the plane changes the cubic to $C'(v) = C(v M)/\det M$.  Over the reals there are
five orbits, told apart by the roots: zero; a triple root, $X^3$; a double root, $-X^2 Y$; three real roots,
$X Y (Y - X)$; one real root, $-Y (X^2 + Y^2)$.  Over the complex numbers the last two are one.

Since multiples of the identity multiply the cubic by any number, no cube root is needed: M lies in the field of one
root and of the square root of plus or minus the discriminant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, TypeAlias

from flint import fmpq_poly

from liepoisson.algebra.exact_numbers import Exact, ExactMatrix, to_sympy
from liepoisson.algebra.function_fields import AlgebraicNumbers
from liepoisson.algebra.number_fields import as_fmpq, as_fraction
from liepoisson.algebra.real_fields import RealRationals, Surd

Cubic: TypeAlias = tuple[Fraction, Fraction, Fraction, Fraction]
"""The coefficients a, b, c, d."""

KINDS: dict[str, tuple[int, int, int, int]] = {
    "zero": (0, 0, 0, 0),
    "a triple root": (1, 0, 0, 0),
    "a double root": (0, -1, 0, 0),
    "three real roots": (0, -1, 1, 0),
    "one real root": (0, -1, 0, -1),
}
"""The normal forms of the orbits."""


@dataclass(frozen=True)
class CubicForm:
    """How a binary cubic is brought to its normal form.

    Attributes:
        kind: The orbit, one of `KINDS`.
        rows: M, exact.
        field_extension: The field that its entries generate, for example "Q" or "Q(sqrt(5))".
    """

    kind: str
    rows: ExactMatrix
    field_extension: str


def discriminant(cubic: Sequence[Any]) -> Any:
    """Positive for three real roots, negative for one, zero for a double or triple one."""
    a, b, c, d = cubic
    number = [k * x for k, x in ((18, a * b * c * d), (-4, b * b * b * d), (1, b * b * c * c), (-4, a * c * c * c))]
    return sum(number[1:], number[0]) - 27 * (a * a * d * d)


def kind_of(cubic: Sequence[Any], sign: int) -> str:
    """The orbit of a cubic, from the sign of its discriminant."""
    a, b, c, d = cubic
    if not any(cubic):
        return "zero"
    if sign:
        return "three real roots" if sign > 0 else "one real root"
    # The Hessian vanishes at a triple root only.
    hessian = (b * b - 3 * (a * c), b * c - 9 * (a * d), c * c - 3 * (b * d))
    return "a double root" if any(hessian) else "a triple root"


def moved(cubic: Sequence[Any], rows: Sequence[Sequence[Any]], zero: Any) -> list[Any]:
    r"""$C(v M)$, without the division by the determinant."""
    (p, q), (r, s) = rows
    first, second = [p, r], [q, s]  # X and Y as linear forms in the new coordinates
    total = [zero] * 4
    for k, c in enumerate(cubic):
        product: list[Any] = [c]
        for factor in [first] * (3 - k) + [second] * k:
            longer = [zero] * (len(product) + 1)
            for i, value in enumerate(product):
                for j, other in enumerate(factor):
                    longer[i + j] = longer[i + j] + other * value
            product = longer
        total = [old + new for old, new in zip(total, product, strict=True)]
    return total


def cubic_form(cubic: Cubic) -> CubicForm:
    """The normal form of a cubic with rational coefficients, and a matrix that leads to it; verified exactly."""
    disc = discriminant(cubic)
    kind = kind_of(cubic, (disc > 0) - (disc < 0))
    if kind == "zero":
        return CubicForm(kind, ((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))), "Q")
    (p, q), (r, s) = shear = _with_leading(cubic)
    determinant = p * s - q * r
    a, b, c, d = (value / determinant for value in moved(cubic, shear, Fraction(0)))
    numbers = _Numbers((a, b, c, d)) if disc else _Numbers((a, Fraction(0), Fraction(0), Fraction(0)))
    if not disc:
        inner = [[numbers.surd(x) for x in row] for row in _of_repeated_root(kind, (a, b, c, d))]
    elif disc > 0:
        inner = numbers.of_three_roots()
    else:
        inner = numbers.of_one_root()
    matrix = [[numbers.number(x) for x in row] for row in shear]
    rows = [[u * matrix[0][k] + v * matrix[1][k] for k in (0, 1)] for u, v in inner]
    _verify([numbers.surd(x) for x in cubic], rows, [numbers.surd(Fraction(x)) for x in KINDS[kind]])
    return CubicForm(kind, tuple(tuple(map(numbers.write, row)) for row in rows), numbers.name)


def _with_leading(cubic: Cubic) -> list[list[Fraction]]:
    """A change of basis after which the coefficient of X^3 is not zero: of four points not all are roots."""
    one, zero = Fraction(1), Fraction(0)
    for x, y in ((one, zero), (zero, one), (one, one), (one, -one)):
        if moved(cubic, [[x, y], [zero, zero]], zero)[0]:
            return [[x, y], [zero, one] if x else [one, zero]]
    raise AssertionError


def _of_repeated_root(kind: str, cubic: Cubic) -> list[list[Fraction]]:
    """The matrix for a cubic with a repeated root and a != 0."""
    a, b, c, d = cubic
    one = Fraction(1)
    if kind == "a triple root":  # a (X - r Y)^3
        r = -b / (3 * a)
        return [[one, Fraction(0)], [a * r, a]]
    # a (X - r Y)^2 (X - s Y), with r the root of the cubic and of its derivative
    r = (9 * a * d - b * c) / (2 * (b * b - 3 * a * c))
    s = -b / a - 2 * r
    k = one / (a * (s - r) * (s - r))
    return [[k * s, k], [r, one]]


class _Numbers:
    r"""The field of one real root r of a cubic with a != 0, with $\sqrt{\pm\mathrm{disc}}$ adjoined.

    The other factor is $X^2 + p X Y + q Y^2$, with
    $\sqrt{|p^2/4 - q|} = \sqrt{\pm\mathrm{disc}}/(2 a^2 (r^2 + p r + q))$.
    """

    def __init__(self, cubic: Cubic) -> None:
        a, b, c, d = cubic
        factors = [f for f, _ in fmpq_poly([as_fmpq(x) for x in (d, c, b, a)]).factor()[1]]
        linear = sorted((as_fraction(-f[0] / f[1]) for f in factors if f.degree() == 1), key=lambda r: (abs(r), r))
        self.field = None if linear else AlgebraicNumbers(factors[0] / factors[0].leading_coefficient())
        self.a, self.r = self.number(a), self.number(linear[0]) if self.field is None else self._generator
        self.p = self.number(b / a) + self.r
        self.q = self.number(c / a) + self.p * self.r
        self.value = self.r * self.r + self.p * self.r + self.q
        size, radicand = RealRationals().extract_square(abs(discriminant(cubic)) or Fraction(1))
        self._root = to_sympy(radicand)
        self.radicand: Any = self.number(radicand)
        self._key = frozenset[Any]() if radicand == 1 else frozenset([self.radicand])
        if discriminant(cubic):
            self.width = self.number(size / (2 * a * a)) / self.value

    @property
    def _generator(self) -> Any:
        assert self.field is not None
        return self.field.element(fmpq_poly([0, 1]))

    def number(self, value: Fraction) -> Any:
        """A rational number."""
        return value if self.field is None else self.field.number(value)

    def surd(self, value: Fraction) -> Surd:
        """The same, where square roots are."""
        return Surd.of(self.number(value))

    def of_three_roots(self) -> list[list[Surd]]:
        """Kernels of two of the factors, so scaled that the third is proportional to Y - X."""
        centre = Surd.of(self.number(Fraction(-1, 2)) * self.p)
        width = Surd({self._key: self.width})
        first, second, third = Surd.of(self.r), centre + width, centre - width
        d13, d23 = first - third, second - third
        scale = self._inverse((first - second) * d13 * d23 * self.a)
        alpha, beta = -(scale * d13), scale * d23
        return [[alpha * second, alpha], [beta * first, beta]]

    def of_one_root(self) -> list[list[Surd]]:
        """The kernel of the linear factor, and what is orthogonal to it for the quadratic one."""
        half, one = self.number(Fraction(1, 2)), self.number(Fraction(1))
        alpha = one / (self.a * self.value)
        beta = self._inverse(Surd({self._key: self.width})) * alpha
        across = (-(self.p * self.r * half + self.q), self.r + self.p * half)
        return [[Surd.of(alpha * self.r), Surd.of(alpha)], [beta * x for x in across]]

    def _inverse(self, value: Surd) -> Surd:
        """One over a number with at most one square root."""
        one = self.number(Fraction(1))
        if not value.radicands:
            return Surd.of(one / value.field_value())
        return value.conjugate(self.radicand) * (one / value.norm())

    def write(self, value: Surd) -> Exact:
        """The exact value: a Fraction if it is rational, else a SymPy expression."""
        from sympy import S, sqrt

        total: Any = S.Zero
        for roots, c in value.terms.items():
            total += self._written(c) * (sqrt(self._root) if roots else S.One)
        return Fraction(int(total.p), int(total.q)) if total.is_Rational else total

    def _written(self, c: Any) -> Any:
        from sympy import S

        if self.field is None:
            return to_sympy(c)
        total: Any = S.Zero
        for k, coefficient in enumerate(c.polynomial.coeffs()):
            total += to_sympy(as_fraction(coefficient)) * self.root**k
        return total

    @cached_property
    def _modulus(self) -> Any:
        from sympy import Poly, Symbol

        assert self.field is not None
        return Poly([to_sympy(as_fraction(c)) for c in reversed(self.field.modulus.coeffs())], Symbol("x"))

    @cached_property
    def root(self) -> Any:
        """The root r of an irreducible cubic: the least real one."""
        from sympy import CRootOf

        return CRootOf(self._modulus, 0)

    @property
    def name(self) -> str:
        """The field in words."""
        names = [] if self.field is None else [f"a root of {self._modulus.as_expr()}"]
        if self._key:
            names.append(f"sqrt({self._root})")
        return f"Q({', '.join(names)})" if names else "Q"


def _verify(cubic: Sequence[Surd], rows: Sequence[Sequence[Surd]], wanted: Sequence[Surd]) -> None:
    """Assert that the matrix takes the cubic to the normal form."""
    (p, q), (r, s) = rows
    determinant = p * s - q * r
    assert determinant.norm(), "independent rows"
    for got, value in zip(moved(cubic, rows, Surd({})), wanted, strict=True):
        assert not got - determinant * value, "the normal form"
