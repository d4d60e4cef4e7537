"""What exact algebra asks of a field, and the fields of prime order."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

if TYPE_CHECKING:
    from flint import fmpq, fmpq_poly

Element: TypeAlias = Any
"""A number of a field: + - * are exact, and it is true unless it is zero."""

Rational: TypeAlias = "fmpq | Fraction | int"
"""A rational number that a field is given."""


_WORD = 2 * sys.maxsize + 2
"""Moduli below this fit a word of FLINT."""


def as_fmpq(value: Rational) -> fmpq:
    """A rational number as FLINT's."""
    from flint import fmpq

    return value if isinstance(value, fmpq) else fmpq(int(value.numerator), int(value.denominator))


def as_fraction(value: Any) -> Fraction:
    """A rational number of FLINT or SymPy as Python's."""
    return Fraction(int(value.numerator), int(value.denominator))


class NumberField(Protocol):
    """A field with exact arithmetic; elements add and multiply themselves, the field inverts them."""

    def number(self, value: Rational) -> Element:
        """The element for a rational number."""
        ...

    def inverse(self, element: Element) -> Element:
        """One over an element that is not zero."""
        return self.one / element

    @cached_property
    def zero(self) -> Element:
        """The number zero."""
        return self.number(0)

    @cached_property
    def one(self) -> Element:
        """The number one."""
        return self.number(1)

    def vanishes(self, element: Element) -> bool:
        """Whether an element is zero."""
        return not element


@dataclass(frozen=True)
class PrimeField(NumberField):
    r"""The field $\mathbb F_p$ of integers modulo a prime; elements are FLINT's.

    Attributes:
        p: The prime.
    """

    p: int

    @cached_property
    def _residue(self) -> Callable[[Any, int], Any]:
        from flint import fmpz_mod_ctx, nmod

        if self.p < _WORD:
            return nmod
        context = fmpz_mod_ctx(self.p)
        return lambda value, _: context(value)

    def __reduce__(self) -> tuple[Any, ...]:
        return PrimeField, (self.p,)  # without the elements that are kept: FLINT's cannot be pickled

    def number(self, value: Rational) -> Element:
        """The residue of a rational number whose denominator p does not divide; elements stay what they are."""
        if isinstance(value, Fraction):
            return self._residue(value.numerator, self.p) / self._residue(value.denominator, self.p)
        return self._residue(value, self.p)


class AlgebraicNumber:
    r"""A number of a field $\mathbb Q[\theta]/(m)$: a polynomial in theta, of FLINT, modulo the irreducible m.

    Args:
        polynomial: It, of a degree below that of m.
        field: The field, which has m as its `modulus`.
    """

    __slots__ = ("field", "polynomial")

    def __init__(self, polynomial: fmpq_poly, field: Any) -> None:
        self.polynomial, self.field = polynomial, field

    def __bool__(self) -> bool:
        return bool(self.polynomial)

    def __add__(self, other: AlgebraicNumber) -> AlgebraicNumber:
        return AlgebraicNumber(self.polynomial + other.polynomial, self.field)

    def __sub__(self, other: AlgebraicNumber) -> AlgebraicNumber:
        return AlgebraicNumber(self.polynomial - other.polynomial, self.field)

    def __neg__(self) -> AlgebraicNumber:
        return AlgebraicNumber(-self.polynomial, self.field)

    def __mul__(self, other: AlgebraicNumber | int) -> AlgebraicNumber:
        if isinstance(other, int):
            return AlgebraicNumber(self.polynomial * other, self.field)
        return AlgebraicNumber(self.polynomial * other.polynomial % self.field.modulus, self.field)

    __rmul__ = __mul__

    def __truediv__(self, other: AlgebraicNumber) -> AlgebraicNumber:
        # The modulus is irreducible: 1 = s * other + t * m.
        if not other:
            raise ZeroDivisionError("division by zero in a number field")
        _, inverse, _ = other.polynomial.xgcd(self.field.modulus)
        return AlgebraicNumber(self.polynomial * inverse % self.field.modulus, self.field)
