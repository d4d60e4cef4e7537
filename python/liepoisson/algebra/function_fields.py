r"""Number fields and fields of functions of some parameters, of finite degree over $\mathbb Q(s_1,\dots,s_k)$.

* $\mathbb Q$, elements are FLINT's rationals;
* $\mathbb Q[\theta]/(m)$, a number field;
* $\mathbb Q(s_1,\dots,s_k)$, rational functions, quotients of FLINT's polynomials;
* $\mathbb Q(s_1,\dots,s_k)[\theta]/(m)$, algebraic functions.

Elements have `+`, `-`, `*` and are true if they are not zero; the field inverts them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import prod
from re import sub
from typing import Any, Protocol

from flint import fmpq, fmpq_poly

from liepoisson.algebra.ideals.components import irreducible_factors
from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.matrices import determinant, solved
from liepoisson.algebra.number_fields import AlgebraicNumber, Element, NumberField, Rational, as_fmpq, as_fraction

_MOST_CONJUGATES = 4
"""Norms of larger degrees are long polynomials."""


class FunctionField(NumberField, Protocol):
    r"""A field of finite degree over the rational functions of some parameters; a number field if there are none.

    Attributes:
        degree: The degree over the rational functions: how many conjugates a generator theta has.
        parameters: Names of the parameters $s_j$.
    """

    degree: int = 1
    parameters: tuple[str, ...] = ()

    @property
    def generator(self) -> str:
        """What theta is, as words; empty if there is none."""
        return ""

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
        return str(element)

    def zeros(self, element: Element) -> str:
        """A polynomial in the parameters that is 0 wherever the element is, or one of its conjugates; "1" for a number.

        The element is not zero.
        """
        del element
        return "1"


@dataclass(frozen=True)
class Rationals(FunctionField):
    """The rational numbers."""

    def number(self, value: Rational) -> fmpq:
        """The number itself."""
        return as_fmpq(value)

    def rational_parts(self, elements: Sequence[fmpq]) -> list[list[fmpq]]:
        """One row: the numbers."""
        return [list(elements)]

    def rational(self, element: fmpq) -> fmpq | None:
        """The number."""
        return element


class AlgebraicNumbers(FunctionField):
    """A number field, by the irreducible polynomial of a generator, of degree at least two."""

    def __init__(self, modulus: fmpq_poly) -> None:
        self.modulus, self.degree = modulus, int(modulus.degree())

    def element(self, polynomial: fmpq_poly) -> AlgebraicNumber:
        """The value of a polynomial at the generator."""
        return AlgebraicNumber(polynomial % self.modulus, self)

    def number(self, value: Rational) -> AlgebraicNumber:
        """A rational number."""
        return AlgebraicNumber(fmpq_poly([as_fmpq(value)]), self)

    def rational_parts(self, elements: Sequence[AlgebraicNumber]) -> list[list[fmpq]]:
        """The coefficients of the powers of the generator."""
        return [[e.polynomial[k] for e in elements] for k in range(self.degree)]

    def rational(self, element: AlgebraicNumber) -> fmpq | None:
        """The number, if it is rational."""
        return element.polynomial[0] if element.polynomial.degree() < 1 else None

    def text(self, element: AlgebraicNumber) -> str:
        """A polynomial in theta."""
        return str(element.polynomial).replace("x", "theta")

    @property
    def generator(self) -> str:
        """The equation of theta."""
        return f"theta is a root of {str(self.modulus).replace('x', 'theta')}"


class RationalFunctions(FunctionField):
    """Rational functions of some parameters with rational coefficients."""

    def __init__(self, parameters: Sequence[str]) -> None:
        self.parameters = tuple(parameters)
        self.context = rational_context(self.parameters)

    def element(self, numerator: Any, denominator: Any = None) -> Ratio:
        """A quotient of polynomials of the context."""
        return Ratio(numerator, self.context.constant(1) if denominator is None else denominator).reduced()

    def number(self, value: Rational) -> Ratio:
        """A rational number."""
        return Ratio(self.context.constant(as_fmpq(value)), self.context.constant(1))

    def rational_parts(self, elements: Sequence[Ratio]) -> list[list[fmpq]]:
        """The coefficients of the monomials in the parameters, after multiplication by a common denominator."""
        pairs = [(e.numerator, e.denominator) for e in elements]
        return coefficient_rows(over_common_denominator(pairs, self.context.constant(1))[0])

    def rational(self, element: Ratio) -> fmpq | None:
        """The number, if the function is constant."""
        return constant_of(element.numerator) if element.denominator.is_constant() else None

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

    def __truediv__(self, other: Ratio) -> Ratio:
        return Ratio(self.numerator * other.denominator, self.denominator * other.numerator).reduced()


class AlgebraicFunctions(FunctionField):
    """Rational functions of parameters with one root theta of a polynomial over them, of degree at least two.

    Args:
        base: The rational functions.
        modulus: The coefficients of the monic irreducible polynomial, by powers, without the leading one.
    """

    def __init__(self, base: RationalFunctions, modulus: Sequence[Ratio]) -> None:
        self.base, self.modulus = base, tuple(modulus)
        self.parameters, self.degree = base.parameters, len(self.modulus)

    def element(self, coefficients: Sequence[Ratio]) -> AlgebraicFunction:
        """A polynomial in theta, by powers."""
        total = [*coefficients, *[self.base.zero] * (self.degree - len(coefficients))]
        while len(total) > self.degree:
            if top := total.pop():
                shift = len(total) - self.degree
                for k, m in enumerate(self.modulus):
                    total[shift + k] = total[shift + k] - top * m
        return AlgebraicFunction(tuple(total), self)

    def number(self, value: Rational) -> AlgebraicFunction:
        """A rational number."""
        return AlgebraicFunction((self.base.number(value), *[self.base.zero] * (self.degree - 1)), self)

    def product(self, left: AlgebraicFunction, right: AlgebraicFunction) -> AlgebraicFunction:
        """The product of two elements."""
        total = [self.base.zero] * (2 * self.degree - 1)
        for j, a in enumerate(left.coefficients):
            if a:
                for k, b in enumerate(right.coefficients):
                    if b:
                        total[j + k] = total[j + k] + a * b
        return self.element(total)

    def inverse(self, element: AlgebraicFunction) -> AlgebraicFunction:
        """One over an element: the solution of a linear system over the rational functions."""
        rows = list(map(list, zip(*self._multiples(element), strict=True)))
        right = [[self.base.number(int(k == 0))] for k in range(self.degree)]
        return AlgebraicFunction(tuple(row[0] for row in solved(rows, right, self.base)), self)

    def rational_parts(self, elements: Sequence[AlgebraicFunction]) -> list[list[fmpq]]:
        """The coefficients of the powers of theta and of the monomials in the parameters."""
        return [
            row for k in range(self.degree) for row in self.base.rational_parts([e.coefficients[k] for e in elements])
        ]

    def rational(self, element: AlgebraicFunction) -> fmpq | None:
        """The number, if it is rational."""
        return None if any(element.coefficients[1:]) else self.base.rational(element.coefficients[0])

    def text(self, element: AlgebraicFunction) -> str:
        """A polynomial in theta."""
        if not any(element.coefficients[1:]):
            return self.base.text(element.coefficients[0])
        terms = [_term(self.base.text(c), k) for k, c in enumerate(element.coefficients) if c]
        return " + ".join(terms) or "0"

    def zeros(self, element: AlgebraicFunction) -> str:
        """Those of the norm, the product of the conjugates; the element itself where that is long."""
        return self.base.zeros(self.norm(element)) if self.degree <= _MOST_CONJUGATES else self.text(element)

    def norm(self, element: AlgebraicFunction) -> Ratio:
        """The determinant of the multiplication with the element."""
        return determinant(self._multiples(element), self.base.zero)

    def _multiples(self, element: AlgebraicFunction) -> list[tuple[Ratio, ...]]:
        """The element times the powers of theta."""
        found = [element.coefficients]
        for _ in range(self.degree - 1):
            found.append(self.element([self.base.zero, *found[-1]]).coefficients)
        return found

    @property
    def generator(self) -> str:
        """The equation of theta."""
        terms = [_term(self.base.text(c), k) for k, c in enumerate(self.modulus) if c]
        return "theta is a root of " + " + ".join([_term("1", self.degree), *reversed(terms)])


def _term(coefficient: str, power: int) -> str:
    """A coefficient times a power of theta."""
    generator = f"theta^{power}" if power > 1 else "theta"
    if not power:
        return coefficient
    if coefficient == "1":
        return generator
    return f"{coefficient}*{generator}" if coefficient.isalnum() else f"({coefficient})*{generator}"


class AlgebraicFunction:
    """An element of a field of algebraic functions."""

    __slots__ = ("coefficients", "field")

    def __init__(self, coefficients: tuple[Ratio, ...], field: AlgebraicFunctions) -> None:
        self.coefficients, self.field = coefficients, field

    def __bool__(self) -> bool:
        return any(map(bool, self.coefficients))

    def __add__(self, other: AlgebraicFunction) -> AlgebraicFunction:
        return AlgebraicFunction(
            tuple(a + b for a, b in zip(self.coefficients, other.coefficients, strict=True)), self.field
        )

    def __sub__(self, other: AlgebraicFunction) -> AlgebraicFunction:
        return self + (-other)

    def __neg__(self) -> AlgebraicFunction:
        return AlgebraicFunction(tuple(-a for a in self.coefficients), self.field)

    def __mul__(self, other: AlgebraicFunction) -> AlgebraicFunction:
        return self.field.product(self, other)


def common_roots(rows: Iterable[Sequence[Any]]) -> tuple[dict[Fraction, int], list[tuple[fmpq_poly, int]], fmpq_poly]:
    """The rational roots that polynomials have in common, the other factors of their greatest common divisor, and that.

    With multiplicities; rows are rational coefficients, by powers.
    """
    common = fmpq_poly()
    for row in rows:
        common = common.gcd(fmpq_poly(list(row)))
    factors = [(fmpq_poly(f), int(k)) for f, k in common.factor()[1]]
    rational = {as_fraction(-f[0] / f[1]): k for f, k in factors if f.degree() == 1}
    return rational, [(f, k) for f, k in factors if f.degree() > 1], common


def readable(polynomial: str) -> str:
    """FLINT's text of a polynomial with minus signs for negative numbers."""
    return sub(r"\+ \((-[\d/]+)\)", r"+ \1", polynomial).replace("+ -", "- ")


def root_text(polynomial: Any, variable: Any) -> str:
    """The roots of an irreducible polynomial in words, for example "s = -1" or "s^2 + 1 = 0"."""
    if polynomial.degree() == 1:
        return f"{variable} = {-polynomial[0] / polynomial[1]}"
    text = readable(str(polynomial).replace("x", str(variable)))
    return sub(r"\b1\*", "", text) + " = 0"


def over_common_denominator(fractions: Sequence[tuple[Any, Any]], one: Any) -> tuple[list[Any], Any]:
    """The numerators of fractions of FLINT's polynomials over their least common denominator, and that.

    Args:
        fractions: Numerators and denominators.
        one: The polynomial 1.
    """
    common = one
    for _, bottom in fractions:
        common = common * (bottom // common.gcd(bottom))
    return [top * (common // bottom) for top, bottom in fractions], common


def coefficient_rows(polynomials: Sequence[Any]) -> list[list[fmpq]]:
    """For each monomial its coefficients in some of FLINT's polynomials."""
    terms = [p.to_dict() for p in polynomials]
    return [[one.get(m, fmpq(0)) for one in terms] for m in sorted({m for one in terms for m in one})]


def constant_of(polynomial: Any) -> fmpq | None:
    """The number that a polynomial of FLINT is, or None."""
    if not polynomial:
        return fmpq(0)
    return polynomial.leading_coefficient() if polynomial.is_constant() else None


def polynomial_at(polynomial: Any, values: Mapping[str, Element], field: NumberField) -> Element:
    """A polynomial of FLINT at elements of a field, by the names of its variables."""
    names = polynomial.context().names()
    terms = (
        prod((values[n] for n, k in zip(names, m, strict=True) for _ in range(int(k))), start=field.number(c))
        for m, c in polynomial.terms()
    )
    return sum(terms, field.zero)


def polynomial_quotient(
    dividend: Sequence[Element], divisor: Sequence[Element], field: NumberField
) -> tuple[list[Element], list[Element]]:
    """The quotient and the remainder of two polynomials in one variable, by powers."""
    rest, zero = list(dividend), field.zero
    scale = field.inverse(divisor[-1])
    quotient = [zero] * max(1, len(rest) - len(divisor) + 1)
    while len(rest) >= len(divisor):
        top = rest[-1] * scale
        shift = len(rest) - len(divisor)
        quotient[shift] = top
        if top:
            for k, d in enumerate(divisor):
                rest[shift + k] = rest[shift + k] - top * d
        rest.pop()
    while rest and not rest[-1]:
        rest.pop()
    return quotient, rest


def polynomial_gcd(left: Sequence[Element], right: Sequence[Element], field: NumberField) -> list[Element]:
    """The greatest common divisor of two polynomials in one variable, the first not zero."""
    a, b = list(left), list(right)
    while b and not b[-1]:
        b.pop()
    while b:
        a, b = b, polynomial_quotient(a, b, field)[1]
    return a
