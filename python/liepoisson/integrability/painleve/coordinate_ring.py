r"""The coordinate ring $\mathbb Q[c]/I$ of a family of balances.

What is computed without division can be computed here, in normal forms modulo a Gröbner basis, for every member of the
family at once; no parametrisation of the family is needed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import fmpq

from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.groebner import GroebnerBasis
from liepoisson.algebra.ideals.limits import Budget
from liepoisson.algebra.ideals.operations import radical_contains
from liepoisson.algebra.number_fields import Element, NumberField, Rational, as_fmpq
from liepoisson.errors import LiePoissonError
from liepoisson.integrability.painleve.coefficient_fields import polynomial_at


class DivisionError(LiePoissonError):
    """A division in a coordinate ring, which is no field."""


class CoordinateRing(NumberField):
    """Polynomials modulo an ideal.  An element is false if it is in the ideal; `vanishes` looks at its zeros.

    Args:
        basis: The Gröbner basis of the ideal.
        is_prime: Whether it is prime, so that polynomials outside of it do not vanish on the family.
        independent: Coordinates that parametrise the family.
        degree: How many members there are for general values of these.
        budget: Where the work is accounted.
    """

    def __init__(
        self, basis: GroebnerBasis, *, is_prime: bool, independent: tuple[str, ...], degree: int, budget: Budget
    ) -> None:
        self.basis, self.is_prime, self.degree, self.budget = basis, is_prime, degree, budget
        self.parameters = independent
        self._normal: dict[tuple[int, ...], Poly] = {}

    def element(self, polynomial: Poly) -> RingElement:
        """The normal form of a polynomial."""
        total = polynomial * 0
        for m, c in polynomial.terms():
            key = tuple(int(k) for k in m)
            if key not in self._normal:
                self._normal[key] = self.basis.remainder(self.basis.context.from_dict({key: 1}), self.budget)
            total = total + self._normal[key] * c
        return RingElement(total, self)

    def vanishes(self, element: RingElement) -> bool:
        """Whether an element is zero at all points of the family."""
        p = element.polynomial
        return not p or (not self.is_prime and not p.is_constant() and radical_contains(self.basis, p, self.budget))

    def number(self, value: Rational) -> RingElement:
        """A rational number."""
        return RingElement(self.basis.context.constant(as_fmpq(value)), self)

    def inverse(self, element: RingElement) -> RingElement:
        """One over a number."""
        value = self.rational(element)
        if value is None or not value:
            raise DivisionError(f"a division by {element.polynomial}")
        return self.number(1 / value)

    def rational_parts(self, elements: Sequence[RingElement]) -> list[list[fmpq]]:
        """The coefficients of the monomials of the normal forms."""
        terms = [e.polynomial.to_dict() for e in elements]
        return [[one.get(m, fmpq(0)) for one in terms] for m in sorted({m for one in terms for m in one})]

    def rational(self, element: RingElement) -> fmpq | None:
        """The number, if the function is constant."""
        if not element:
            return fmpq(0)
        return element.polynomial.leading_coefficient() if element.polynomial.is_constant() else None

    def text(self, element: RingElement) -> str:
        """The normal form."""
        return str(element.polynomial)

    def zeros(self, element: RingElement) -> str:
        """The normal form, unless it is a number."""
        return "1" if element.polynomial.is_constant() else self.text(element)

    @property
    def generator(self) -> str:
        """There is none: elements are written in the coordinates."""
        return ""


class RingElement:
    """A function on a family of balances."""

    __slots__ = ("polynomial", "ring")

    def __init__(self, polynomial: Poly, ring: CoordinateRing) -> None:
        self.polynomial, self.ring = polynomial, ring

    def __bool__(self) -> bool:
        return bool(self.polynomial)

    def __add__(self, other: RingElement) -> RingElement:
        return RingElement(self.polynomial + other.polynomial, self.ring)

    def __sub__(self, other: RingElement) -> RingElement:
        return RingElement(self.polynomial - other.polynomial, self.ring)

    def __neg__(self) -> RingElement:
        return RingElement(-self.polynomial, self.ring)

    def __mul__(self, other: RingElement) -> RingElement:
        if self.polynomial.is_constant() or other.polynomial.is_constant():
            return RingElement(self.polynomial * other.polynomial, self.ring)
        return self.ring.element(self.polynomial * other.polynomial)


def at_point(elements: Sequence[RingElement], values: Mapping[str, Element], field: Any) -> list[Element]:
    """Functions on a family at one of its points."""
    return [polynomial_at(e.polynomial, values, field) for e in elements]
