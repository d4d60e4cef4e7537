r"""Fields of algebraic functions, $\mathbb Q(s_1,\dots,s_k)[\theta]/(m)$."""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq

from liepoisson.algebra.matrices import determinant
from liepoisson.algebra.number_fields import NumberField, Rational
from liepoisson.integrability.painleve.coefficient_fields import Ratio, RationalFunctions
from liepoisson.integrability.painleve.linear import solved

# Norms of larger degrees are long polynomials.
_MOST_CONJUGATES = 4


class AlgebraicFunctions(NumberField):
    """Rational functions of parameters with one root theta of a polynomial over them, of degree at least two."""

    def __init__(self, base: RationalFunctions, modulus: Sequence[Ratio]) -> None:
        self.base = base
        self.parameters = base.parameters
        self.modulus = tuple(modulus)
        """The coefficients of the monic irreducible polynomial, by powers, without the leading one."""

    @property
    def degree(self) -> int:
        """The degree over the rational functions."""
        return len(self.modulus)

    def element(self, coefficients: Sequence[Ratio]) -> AlgebraicFunction:
        """A polynomial in theta, by powers."""
        return AlgebraicFunction(self._reduced(list(coefficients)), self)

    def number(self, value: Rational) -> AlgebraicFunction:
        """A rational number."""
        zero = self.base.number(0)
        return AlgebraicFunction((self.base.number(value), *[zero] * (self.degree - 1)), self)

    def product(self, left: AlgebraicFunction, right: AlgebraicFunction) -> AlgebraicFunction:
        """The product of two elements."""
        zero = self.base.number(0)
        total = [zero] * (2 * self.degree - 1)
        for j, a in enumerate(left.coefficients):
            if a:
                for k, b in enumerate(right.coefficients):
                    if b:
                        total[j + k] = total[j + k] + a * b
        return AlgebraicFunction(self._reduced(total), self)

    def inverse(self, element: AlgebraicFunction) -> AlgebraicFunction:
        """One over an element: the solution of a linear system over the rational functions."""
        zero, one = self.base.number(0), self.base.number(1)
        columns: list[tuple[Ratio, ...]] = []
        power = list(element.coefficients)
        for _ in range(self.degree):
            columns.append(self._reduced(power))
            power = [zero, *columns[-1]]
        rows = [[column[k] for column in columns] for k in range(self.degree)]
        right = [[one if k == 0 else zero] for k in range(self.degree)]
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
        rows: list[list[Ratio]] = []
        power = list(element.coefficients)
        for _ in range(self.degree):
            rows.append(list(self._reduced(power)))
            power = [self.base.number(0), *rows[-1]]
        return determinant(rows, self.base.zero)

    @property
    def generator(self) -> str:
        """The equation of theta."""
        terms = [_term(self.base.text(c), k) for k, c in enumerate(self.modulus) if c]
        return "theta is a root of " + " + ".join([_term("1", self.degree), *reversed(terms)])

    def _reduced(self, coefficients: list[Ratio]) -> tuple[Ratio, ...]:
        zero = self.base.number(0)
        total = coefficients + [zero] * (self.degree - len(coefficients))
        while len(total) > self.degree:
            top = total.pop()
            if top:
                shift = len(total) - self.degree
                for k, m in enumerate(self.modulus):
                    total[shift + k] = total[shift + k] - top * m
        return tuple(total)


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
