"""Exact numbers as fractions that remember what has been rounded in them.

A sum of fractions is zero or it is not.  Irrational numbers are rounded to 40 digits, and where they should cancel they
leave 1e-40 of their own size: what is left is judged beside these terms, never beside other numbers, which may have
other units.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.algebra.rational_polynomials import RationalPolynomial

_DIGITS = 40
"""Decimal digits to which an irrational number is known."""

_ROUND_OFF = Fraction(1, 10**30)
"""A sum below this fraction of its rounded terms is zero."""


@dataclass(frozen=True, slots=True)
class Rounded:
    """A number and the sum of the sizes of the rounded terms in it.

    Attributes:
        value: The number, as it was summed.
        inexact: Sizes of its rounded terms together, 0 if it is exact.
    """

    value: Fraction
    inexact: Fraction = Fraction(0)

    @property
    def number(self) -> Fraction:
        """The number; 0 where nothing but what was rounded off is left."""
        return self.value if abs(self.value) > self.inexact * _ROUND_OFF else Fraction(0)

    def settled(self) -> Rounded:
        """The same; exactly 0 where nothing but what was rounded off is left."""
        return self if self.number else ZERO

    def __add__(self, other: Rounded) -> Rounded:
        return Rounded(self.value + other.value, self.inexact + other.inexact)

    def __neg__(self) -> Rounded:
        return Rounded(-self.value, self.inexact)

    def __mul__(self, other: Rounded) -> Rounded:
        if not self.inexact and not other.inexact:
            return Rounded(self.value * other.value)
        inexact = abs(self.value) * other.inexact + self.inexact * (abs(other.value) + other.inexact)
        return Rounded(self.value * other.value, inexact)


ZERO, ONE = Rounded(Fraction(0)), Rounded(Fraction(1))


def rounded(value: Fraction | Expr) -> Rounded:
    """An exact number as a fraction; one that is irrational is rounded, each of its summands by itself.

    Raises:
        ParameterError: it is no finite real number.
    """
    if isinstance(value, Fraction):
        return Rounded(value)
    from sympy import Rational

    if isinstance(value, Rational):
        return Rounded(Fraction(int(value.p), int(value.q)))
    number = _KNOWN.get(value)
    if number is None:
        if len(_KNOWN) > 10_000:
            _KNOWN.clear()
        number = _KNOWN[value] = _rounded(value)
    return number


def rational(value: Fraction | Expr) -> Fraction:
    """An exact number as a fraction; one that is irrational is rounded to 40 digits."""
    return rounded(value).number


def _rounded(value: Expr) -> Rounded:
    from sympy import Rational

    if value.is_Add or value.is_Mul:
        parts: Any = value.args
        total = ZERO if value.is_Add else ONE
        for part in parts:
            total = total + rounded(part) if value.is_Add else total * rounded(part)
        return total.settled()
    evaluated: Any = value.evalf(_DIGITS)
    if not evaluated.is_Float:
        raise ParameterError(f"a coefficient must be a finite real number; got {value}. Check the parameters.")
    binary: Any = Rational(evaluated)
    number = Fraction(int(binary.p), int(binary.q))
    return Rounded(number, abs(number))


_KNOWN: dict[Expr, Rounded] = {}


def of_degree_two(polynomial: RationalPolynomial) -> dict[tuple[int, ...], Rounded] | None:
    """The coefficients of a polynomial of degree at most two; None for another one."""
    expanded = polynomial.expanded
    if max(map(len, expanded), default=0) > 2:
        return None
    return {monomial: rounded(value) for monomial, value in expanded.items()}
