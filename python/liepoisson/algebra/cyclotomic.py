r"""Numbers of a cyclotomic field $\mathbb Q(\zeta_n)$, in which sines and cosines of rational angles are exact.

A number is a polynomial in $\zeta = e^{2\pi i/n}$ with rational coefficients, modulo the cyclotomic polynomial
$\Phi_n$ (python-flint).  Equality is decided by comparing coefficients: no numerical tolerance, no simplification.

References: Washington, Introduction to Cyclotomic Fields (1997), chapter 2.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import lcm
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.number_fields import AlgebraicNumber, NumberField, Rational, as_fmpq

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sympy import Expr

_MAX_ORDER = 2000  # work grows with the square of Euler's phi of the order
_NESTED = (5, 8, 10, 12, 24)  # angles pi/q of which SymPy writes the sine with nested square roots


class CyclotomicField(NumberField):
    r"""The field $\mathbb Q(\zeta_n)$, $\zeta_n = e^{2\pi i/n}$; n is a multiple of 4, so that i is in it."""

    def __init__(self, order: int) -> None:
        from flint import fmpq_poly, fmpz_poly

        self.order = order
        self.modulus: Any = fmpq_poly(fmpz_poly.cyclotomic(order))
        self._powers: dict[int, AlgebraicNumber] = {}

    def to_sympy(self, number: AlgebraicNumber) -> Expr:
        r"""The real part $\sum_k q_k \cos(2\pi k/n)$ of a number, which is the number itself when it is real."""
        from sympy import Add, Rational, cos, pi

        terms = enumerate(number.polynomial.coeffs())
        n = self.order
        return Add(*(Rational(int(c.p), int(c.q)) * cos(Rational(2 * k, n) * pi) for k, c in terms if c != 0))

    def number(self, value: Rational) -> AlgebraicNumber:
        """A rational number as a number of the field."""
        from flint import fmpq_poly

        return AlgebraicNumber(fmpq_poly([as_fmpq(value)]), self)

    def root(self, power: int) -> AlgebraicNumber:
        r"""The root of unity $\zeta_n^p$."""
        from flint import fmpq_poly

        p = power % self.order
        if p not in self._powers:
            self._powers[p] = AlgebraicNumber(fmpq_poly([0] * p + [1]) % self.modulus, self)
        return self._powers[p]

    def cosine(self, p: int, q: int) -> AlgebraicNumber:
        r"""The number $\cos(\pi p/q) = (z + z^{-1})/2$, $z = e^{i\pi p/q}$; 2q divides the order."""
        k = p * (self.order // (2 * q))
        return (self.root(k) + self.root(-k)) * self.number(Fraction(1, 2))

    def sine(self, p: int, q: int) -> AlgebraicNumber:
        r"""The number $\sin(\pi p/q) = (z - z^{-1})/(2i)$."""
        k = p * (self.order // (2 * q))
        return (self.root(k) - self.root(-k)) * self.root(-self.order // 4) * self.number(Fraction(1, 2))

    def square_root(self, prime: int) -> AlgebraicNumber:
        r"""$\sqrt p$ of a prime by Gauss's sum $g = \sum_a \zeta_p^{a^2}$, which is $\sqrt p$ or $i\sqrt p$; 4p | n."""
        if prime == 2:
            return self.root(self.order // 8) + self.root(-self.order // 8)
        total = self.zero
        for a in range(prime):
            total = total + self.root(a * a * (self.order // prime))
        return total if prime % 4 == 1 else total * self.root(-self.order // 4)


class _NotCyclotomicError(Exception):
    """The expression is not built from rationals, their square roots and sines of rational angles."""


def cyclotomic_images(values: Iterable[Expr]) -> dict[Expr, AlgebraicNumber] | None:
    r"""The SymPy numbers in the smallest cyclotomic field that is found to hold them, or None.

    Understood are rationals, square roots of rationals, i, sin, cos, tan and cot of rational multiples of pi, the
    nested square roots that SymPy writes for some of these sines, and sums, products and integer powers.
    """
    given = list(values)
    try:
        order = lcm(4, *(_order(value) for value in given))
        if order > _MAX_ORDER:
            return None
        field = CyclotomicField(order)
        return {value: _image(value, field) for value in given}
    except _NotCyclotomicError:
        return None


def _angle(expression: Any) -> tuple[int, int]:
    from sympy import pi

    turns: Any = expression / pi
    if not turns.is_Rational:
        raise _NotCyclotomicError
    return int(turns.p), int(turns.q)


@cache
def _nested_sines() -> dict[Expr, tuple[int, int]]:
    from sympy import Pow, Rational, pi, sin

    angles = [(p, q) for q in _NESTED for p in range(1, q)]
    values = [(sin(Rational(p, q) * pi), (p, q)) for p, q in angles]
    return {value: angle for value, angle in values if isinstance(value, Pow) and not value.base.is_Rational}


def _square_root_primes(base: Any) -> list[int]:
    """The primes with odd exponent in the numerator times the denominator of a rational, -1 among them."""
    from sympy import factorint

    return [int(p) for p, power in factorint(int(base.p * base.q)).items() if power % 2]


def _order(value: Any) -> int:
    """An order n for which the value is in the field."""
    base: Any
    from sympy import Add, Integer, Mul, Pow, Rational, S, cos, cot, sin, tan

    if isinstance(value, Rational) or value is S.ImaginaryUnit:
        return 4
    if isinstance(value, (Add, Mul)):
        return lcm(*(_order(term) for term in value.args))
    if isinstance(value, (sin, cos, tan, cot)):
        return lcm(4, 2 * _angle(value.args[0])[1])
    if isinstance(value, Pow) and isinstance(value.exp, Integer):
        return _order(value.base)
    if isinstance(value, Pow) and value.exp in (Rational(1, 2), Rational(-1, 2)):
        base = value.base
        if base.is_Rational:
            if max(abs(int(base.p)), int(base.q)) > _MAX_ORDER**2:
                raise _NotCyclotomicError
            return lcm(4, *(4 * abs(p) for p in _square_root_primes(base)))
        root = value if value.exp > 0 else 1 / value
        if root in _nested_sines():
            return lcm(4, 2 * _nested_sines()[root][1])
    raise _NotCyclotomicError


def _image(value: Any, field: CyclotomicField) -> AlgebraicNumber:
    from sympy import Add, Integer, Mul, Pow, Rational, S, cos, cot, sin, tan

    match value:
        case Rational():
            image = field.number(Fraction(int(value.p), int(value.q)))
        case Add():
            image = sum((_image(term, field) for term in value.args), field.zero)
        case Mul():
            image = _product([_image(factor, field) for factor in value.args], field)
        case sin():
            image = field.sine(*_angle(value.args[0]))
        case cos():
            image = field.cosine(*_angle(value.args[0]))
        case tan():
            angle = _angle(value.args[0])
            image = field.sine(*angle) / field.cosine(*angle)
        case cot():
            angle = _angle(value.args[0])
            image = field.cosine(*angle) / field.sine(*angle)
        case Pow():
            whole = isinstance(value.exp, Integer)
            base = _image(value.base, field) if whole else _root_image(value.base, field)
            power = _product([base] * (abs(int(value.exp)) if whole else 1), field)
            image = power if value.exp > 0 else field.one / power
        case _:
            assert value is S.ImaginaryUnit, value  # nothing else has an order
            image = field.root(field.order // 4)
    return image


def _root_image(base: Any, field: CyclotomicField) -> AlgebraicNumber:
    from sympy import sqrt

    if not base.is_Rational:
        return field.sine(*_nested_sines()[sqrt(base)])
    primes = _square_root_primes(base)
    roots = [field.root(field.order // 4) if p == -1 else field.square_root(p) for p in primes]
    rational = abs(base)
    for p in primes:
        rational /= abs(p)
    outside: Any = sqrt(rational)  # a rational number: only even powers of primes are left
    return _product([*roots, field.number(Fraction(int(outside.p), int(outside.q)))], field)


def _product(factors: list[AlgebraicNumber], field: CyclotomicField) -> AlgebraicNumber:
    result = field.one
    for factor in factors:
        result = result * factor
    return result
