r"""A polynomial vector field with weights: its terms by how much weight they lack, and the equations for balances.

With $x_i = \tau^{-g_i}\sum_k c_i^{(k)}\tau^k$ a term $x^m$ of $f_i$ enters at the order $\tau^{-g_i-1+\delta}$ with the
defect $\delta = g_i + 1 - \sum_j m_j g_j\ge0$.  The terms without defect make the **dominant part** $\hat f$, and the
leading coefficients c of a balance are the solutions of $g_i c_i + \hat f_i(c) = 0$.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.ideals.polynomial_system import polynomial
from liepoisson.algebra.number_fields import Element, as_fmpq
from liepoisson.integrability.derivation import Derivation, Exponents
from liepoisson.integrability.painleve.coefficient_fields import Field, polynomial_at, total
from liepoisson.integrability.painleve.linear import Matrix


@dataclass(frozen=True)
class Term:
    """A term of a right-hand side.

    Attributes:
        exponents: The exponents m of the coordinates.
        coefficient: The numerator and the denominator of its coefficient, polynomials in the parameters.
        defect: How much weight it lacks.
    """

    exponents: Exponents
    coefficient: tuple[Poly, Poly]
    defect: Fraction


@dataclass(frozen=True)
class QuasiHomogeneous:
    """A polynomial vector field with weights for its coordinates.

    Attributes:
        derivation: The vector field.
        weights: One for each coordinate.
        context: FLINT's context of the coordinates and, after them, the parameters.
    """

    derivation: Derivation
    weights: tuple[Fraction, ...]
    context: Any

    @classmethod
    def of(cls, derivation: Derivation, weights: tuple[Fraction, ...]) -> QuasiHomogeneous:
        """The vector field with these weights."""
        names = [str(s) for s in (*derivation.variables, *derivation.field.parameters)]
        return cls(derivation, weights, rational_context(names))

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return len(self.weights)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """The names of the parameters in the context."""
        return tuple(self.context.names()[self.n :])

    @cached_property
    def terms(self) -> tuple[tuple[Term, ...], ...]:
        """The terms of each right-hand side."""
        found: list[tuple[Term, ...]] = []
        for i, component in enumerate(self.derivation.components):
            of_one: list[Term] = []
            for monomial, c in component.items():
                weight = sum((k * w for k, w in zip(monomial, self.weights, strict=True)), Fraction(0))
                of_one.append(Term(monomial, self._coefficient(c), self.weights[i] + 1 - weight))
            found.append(tuple(of_one))
        return tuple(found)

    def _coefficient(self, c: Any) -> tuple[Poly, Poly]:
        if isinstance(c, Fraction):
            return self.context.constant(as_fmpq(c)), self.context.constant(1)
        expression: Any = self.derivation.field.to_sympy(c)
        top, bottom = expression.as_numer_denom()
        return polynomial(top, self.context), polynomial(bottom, self.context)

    @cached_property
    def denominators(self) -> tuple[Poly, ...]:
        """The denominators of coefficients, polynomials in the parameters that are assumed not to vanish."""
        found = {str(t.coefficient[1]): t.coefficient[1] for of_one in self.terms for t in of_one}
        return tuple(p for p in found.values() if not p.is_constant())

    def indicial_equations(self) -> list[Poly]:
        r"""The equations $g_i c_i + \hat f_i(c) = 0$ without denominators."""
        found: list[Poly] = []
        gens = self.context.gens()
        for i, of_one in enumerate(self.terms):
            dominant = [t for t in of_one if not t.defect]
            common = self.context.constant(1)
            for t in dominant:
                common = common * (t.coefficient[1] / common.gcd(t.coefficient[1]))
            equation = gens[i] * as_fmpq(self.weights[i]) * common
            for t in dominant:
                monomial = self.context.from_dict({(*t.exponents, *(0,) * len(self.parameter_names)): 1})
                equation = equation + t.coefficient[0] * (common / t.coefficient[1]) * monomial
            found.append(equation)
        return found


@dataclass(frozen=True)
class LocalField:
    """The vector field with coefficients in the field of a balance.

    Attributes:
        field: The field.
        weights: One for each coordinate.
        terms: For each right-hand side the exponents, the coefficient and the defect of each term.
    """

    field: Field
    weights: tuple[Fraction, ...]
    terms: tuple[tuple[tuple[Exponents, Element, Fraction], ...], ...]

    @classmethod
    def of(cls, system: QuasiHomogeneous, field: Field, parameters: Mapping[str, Element]) -> LocalField:
        """A vector field over a field that contains its parameters."""

        def element(t: Term) -> Element:
            top, bottom = (polynomial_at(p, parameters, field) for p in t.coefficient)
            return top * field.inverse(bottom)

        return cls(
            field,
            system.weights,
            tuple(tuple((t.exponents, element(t), t.defect) for t in of_one) for of_one in system.terms),
        )

    def kovalevskaya_matrix(self, point: Sequence[Element]) -> Matrix:
        r"""The matrix $K = \partial\hat f/\partial x(c) + \operatorname{diag}(g)$; exponents are its eigenvalues."""
        n = len(self.weights)
        found: Matrix = []
        for i, of_one in enumerate(self.terms):
            row = [self.field.zero] * n
            row[i] = self.field.number(self.weights[i])
            for exponents, c, defect in of_one:
                if defect:
                    continue
                for j, k in enumerate(exponents):
                    if k:
                        row[j] = row[j] + self._derivative(exponents, c, j, point)
            found.append(row)
        return found

    def _derivative(self, exponents: Exponents, c: Element, j: int, point: Sequence[Element]) -> Element:
        value = c * self.field.number(exponents[j])
        for i, k in enumerate(exponents):
            for _ in range(k - int(i == j)):
                value = value * point[i]
        return value

    def indicial_residuals(self, point: Sequence[Element]) -> list[Element]:
        r"""$g_i c_i + \hat f_i(c)$, zero for the leading coefficients of a balance."""
        found: list[Element] = []
        for i, of_one in enumerate(self.terms):
            values: list[Element] = [self.field.number(self.weights[i]) * point[i]]
            for exponents, c, defect in of_one:
                if defect:
                    continue
                value = c
                for j, k in enumerate(exponents):
                    for _ in range(k):
                        value = value * point[j]
                values.append(value)
            found.append(total(values, self.field))
        return found
