"""Exact numbers as fractions.

A sum of fractions is zero or it is not.  Irrational numbers are rounded to 40 digits, and where they should cancel they
leave 1e-40 of their own size: what is left is judged beside these terms, never beside other numbers, which may have
other units.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from sympy import Expr

_DIGITS = 40
"""Decimal digits to which an irrational number is known."""

_ROUND_OFF = Fraction(1, 10**30)
"""A sum below this fraction of its rounded terms is zero."""


class _Rounded(NamedTuple):
    """A number and the sum of the sizes of the rounded terms in it, 0 if it is exact."""

    value: Fraction
    inexact: Fraction = Fraction(0)

    def plus(self, other: _Rounded) -> _Rounded:
        return _Rounded(self.value + other.value, self.inexact + other.inexact)

    def times(self, other: _Rounded) -> _Rounded:
        inexact = abs(self.value) * other.inexact + self.inexact * (abs(other.value) + other.inexact)
        return _Rounded(self.value * other.value, inexact)


def rational(value: Fraction | Expr) -> Fraction:
    """An exact number as a fraction; one that is irrational is rounded, each of its summands by itself.

    Raises:
        ParameterError: it is no finite real number.
    """
    return value if isinstance(value, Fraction) else _rounded(value).value


@lru_cache(maxsize=10_000)
def _rounded(value: Expr) -> _Rounded:
    """The number; exactly 0 where nothing but what was rounded off is left."""
    from sympy import Rational

    if isinstance(value, Rational):
        return _Rounded(Fraction(int(value.p), int(value.q)))
    if value.is_Add or value.is_Mul:
        parts: Any = value.args
        total = _Rounded(Fraction(0 if value.is_Add else 1))
        for part in parts:
            total = total.plus(_rounded(part)) if value.is_Add else total.times(_rounded(part))
        return total if abs(total.value) > total.inexact * _ROUND_OFF else _Rounded(Fraction(0))
    evaluated: Any = value.evalf(_DIGITS)
    if not evaluated.is_Float:
        raise ParameterError(f"a coefficient must be a finite real number; got {value}. Check the parameters.")
    binary: Any = Rational(evaluated)
    number = Fraction(int(binary.p), int(binary.q))
    return _Rounded(number, abs(number))
