r"""The fields in which balances have their coordinates, with exact arithmetic.

* $\mathbb Q$, elements are FLINT's rationals;
* $\mathbb Q[\theta]/(m)$, a number field, for a balance that is isolated: its conjugates are the roots of m;
* $\mathbb Q(s_1,\dots,s_k)$, rational functions, for a family of balances that is rationally parametrised, and where
  symbols stand for parameters of the system;
* $\mathbb Q(s_1,\dots,s_k)[\theta]/(m)$, algebraic functions, for other families.

Elements have `+`, `-`, `*` and are true if they are not zero; the field inverts them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from flint import fmpq, fmpq_poly

from liepoisson.algebra.ideals.components import irreducible_factors
from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.number_fields import AlgebraicNumber, Element, NumberField, Rational, as_fmpq


class Field(NumberField, Protocol):
    """What the algebra of a balance needs of a field."""

    @property
    def degree(self) -> int:
        r"""The degree over the rational functions of the parameters: how many conjugate balances there are."""
        ...

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters $s_j$."""
        ...

    def rational_parts(self, elements: Sequence[Element]) -> list[list[fmpq]]:
        r"""Elements in a basis over $\mathbb Q$, after multiplication by a common denominator.

        Rows are basis elements: a sum of products of the elements with rational numbers vanishes if and only if it does
        in each row.
        """
        ...

    def rational(self, element: Element) -> fmpq | None:
        """The rational number that an element is, or None."""
        ...

    def text(self, element: Element) -> str:
        """The element as a formula in the generators."""
        ...

    def zeros(self, element: Element) -> str:
        """A polynomial in the parameters that is 0 wherever the element is, or one of its conjugates; "1" for a number.

        The element is not zero.
        """
        ...

    @property
    def generator(self) -> str:
        """What theta is, as words; empty if there is none."""
        ...


@dataclass(frozen=True)
class Rationals(NumberField):
    """The rational numbers."""

    degree: int = 1
    parameters: tuple[str, ...] = ()

    def number(self, value: Rational) -> fmpq:
        """The number itself."""
        return as_fmpq(value)

    def inverse(self, element: fmpq) -> fmpq:
        """One over a number."""
        return 1 / element

    def rational_parts(self, elements: Sequence[fmpq]) -> list[list[fmpq]]:
        """One row: the numbers."""
        return [list(elements)]

    def rational(self, element: fmpq) -> fmpq | None:
        """The number."""
        return element

    def text(self, element: fmpq) -> str:
        """The number as text."""
        return str(element)

    def zeros(self, element: fmpq) -> str:
        """A number has none."""
        del element
        return "1"

    @property
    def generator(self) -> str:
        """There is none."""
        return ""


class AlgebraicNumbers(NumberField):
    """A number field, by the irreducible polynomial of a generator, of degree at least two."""

    parameters: tuple[str, ...] = ()

    def __init__(self, modulus: fmpq_poly) -> None:
        self.modulus = modulus

    @property
    def degree(self) -> int:
        """The degree of the field."""
        return int(self.modulus.degree())

    def element(self, polynomial: fmpq_poly) -> AlgebraicNumber:
        """The value of a polynomial at the generator."""
        return AlgebraicNumber(polynomial % self.modulus, self)

    def number(self, value: Rational) -> AlgebraicNumber:
        """A rational number."""
        return AlgebraicNumber(fmpq_poly([as_fmpq(value)]), self)

    def inverse(self, element: AlgebraicNumber) -> AlgebraicNumber:
        """One over an element."""
        return self.one / element

    def rational_parts(self, elements: Sequence[AlgebraicNumber]) -> list[list[fmpq]]:
        """The coefficients of the powers of the generator."""
        return [[_coefficient(e.polynomial, k) for e in elements] for k in range(self.degree)]

    def rational(self, element: AlgebraicNumber) -> fmpq | None:
        """The number, if it is rational."""
        return _coefficient(element.polynomial, 0) if element.polynomial.degree() < 1 else None

    def text(self, element: AlgebraicNumber) -> str:
        """A polynomial in theta."""
        return str(element.polynomial).replace("x", "theta")

    def zeros(self, element: AlgebraicNumber) -> str:
        """A number has none."""
        del element
        return "1"

    @property
    def generator(self) -> str:
        """The equation of theta."""
        return f"theta is a root of {str(self.modulus).replace('x', 'theta')}"


def _coefficient(polynomial: fmpq_poly, k: int) -> fmpq:
    return polynomial[k] if k <= polynomial.degree() else fmpq(0)


class RationalFunctions(NumberField):
    """Rational functions of some parameters with rational coefficients."""

    degree = 1

    def __init__(self, parameters: Sequence[str]) -> None:
        self.parameters = tuple(parameters)
        self.context = rational_context(self.parameters)

    def element(self, numerator: Any, denominator: Any = None) -> Ratio:
        """A quotient of polynomials of the context."""
        return Ratio(numerator, self.context.constant(1) if denominator is None else denominator).reduced()

    def number(self, value: Rational) -> Ratio:
        """A rational number."""
        return Ratio(self.context.constant(as_fmpq(value)), self.context.constant(1))

    def inverse(self, element: Ratio) -> Ratio:
        """One over a function."""
        return Ratio(element.denominator, element.numerator).reduced()

    def rational_parts(self, elements: Sequence[Ratio]) -> list[list[fmpq]]:
        """The coefficients of the monomials in the parameters, after multiplication by a common denominator."""
        common = self.context.constant(1)
        for e in elements:
            common = common * (e.denominator / common.gcd(e.denominator))
        terms = [(e.numerator * (common / e.denominator)).to_dict() for e in elements]
        return [[one.get(m, fmpq(0)) for one in terms] for m in sorted({m for one in terms for m in one})]

    def rational(self, element: Ratio) -> fmpq | None:
        """The number, if the function is constant."""
        if not element:
            return fmpq(0)
        is_constant = element.numerator.is_constant() and element.denominator.is_constant()
        return element.numerator.leading_coefficient() if is_constant else None

    def text(self, element: Ratio) -> str:
        """The quotient as text."""
        top, bottom = str(element.numerator), str(element.denominator)
        return top if bottom == "1" else f"({top})/({bottom})"

    def zeros(self, element: Ratio) -> str:
        """The irreducible factors of the numerator."""
        factors = sorted(map(str, irreducible_factors(element.numerator)))
        if len(factors) < 2:
            return "".join(factors) or "1"
        return "*".join(f"({q})" if " " in q else q for q in factors)

    @property
    def generator(self) -> str:
        """There is none."""
        return ""


class Ratio:
    """A quotient of two polynomials without common factors, the denominator monic."""

    __slots__ = ("denominator", "numerator")

    def __init__(self, numerator: Any, denominator: Any) -> None:
        self.numerator, self.denominator = numerator, denominator

    def reduced(self) -> Ratio:
        """The quotient in lowest terms."""
        if not self.numerator:
            return Ratio(self.numerator, self.numerator.context().constant(1))
        if self.denominator.is_constant():
            lead = self.denominator.leading_coefficient()
            return self if lead == 1 else Ratio(self.numerator / lead, self.denominator / lead)
        common = self.numerator.gcd(self.denominator)
        top, bottom = self.numerator / common, self.denominator / common
        lead = bottom.leading_coefficient()
        return Ratio(top / lead, bottom / lead)

    def __bool__(self) -> bool:
        return bool(self.numerator)

    def __add__(self, other: Ratio) -> Ratio:
        if self.denominator == other.denominator:
            return Ratio(self.numerator + other.numerator, self.denominator).reduced()
        return Ratio(
            self.numerator * other.denominator + other.numerator * self.denominator,
            self.denominator * other.denominator,
        ).reduced()

    def __sub__(self, other: Ratio) -> Ratio:
        return self + (-other)

    def __neg__(self) -> Ratio:
        return Ratio(-self.numerator, self.denominator)

    def __mul__(self, other: Ratio) -> Ratio:
        return Ratio(self.numerator * other.numerator, self.denominator * other.denominator).reduced()


def polynomial_at(polynomial: Any, values: Mapping[str, Element], field: Field) -> Element:
    """A polynomial of FLINT at elements of a field, by the names of its variables."""
    names = polynomial.context().names()
    return total(
        (
            product([field.number(c), *(values[n] for n, k in zip(names, m, strict=True) for _ in range(int(k)))])
            for m, c in polynomial.terms()
        ),
        field,
    )


def total(elements: Iterable[Element], field: Field) -> Element:
    """The sum of elements."""
    found = field.zero
    for e in elements:
        found = found + e
    return found


def product(elements: Sequence[Element]) -> Element:
    """The product of at least one element."""
    found = elements[0]
    for e in elements[1:]:
        found = found * e
    return found
