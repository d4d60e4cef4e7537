r"""A polynomial vector field with weights: which weights fit, its terms by the weight they lack, and the balances.

A solution with poles of orders $g_i$, $x_i = \tau^{-g_i}\sum_k c_i^{(k)}\tau^k$, is dominated by the terms of
$\dot x_i = f_i(x)$ that are of weight $g_i + 1$, if no term is of a larger one:

$$\sum_j m_j g_j \le g_i + 1 \quad\text{for each term } x^m \text{ of } f_i .$$

These inequalities, with $g\ge0$, describe a polyhedron. Poles that are of lower orders than g are among the series for
g, with leading coefficients that vanish, so that only maximal weights are wanted. Where the largest value of each
weight fits all inequalities, there is one choice. A weight that may be as large as one likes belongs to coordinates
that follow the others linearly; it is taken as large as the largest of the others.

A term $x^m$ of $f_i$ enters at the order $\tau^{-g_i-1+\delta}$ with the defect
$\delta = g_i + 1 - \sum_j m_j g_j\ge0$.  The terms without defect make the **dominant part** $\hat f$, and the leading
coefficients c of a balance are the solutions of $g_i c_i + \hat f_i(c) = 0$.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import prod
from typing import Any

from sympy import Rational
from sympy.solvers.simplex import UnboundedLPError, linprog

from liepoisson.algebra.function_fields import FunctionField, over_common_denominator, polynomial_at
from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.groebner import rational_context
from liepoisson.algebra.ideals.polynomial_system import polynomial
from liepoisson.algebra.matrices import Matrix
from liepoisson.algebra.number_fields import Element, as_fmpq
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.integrability.derivation import Derivation, Exponents


@dataclass(frozen=True)
class Term:
    """A term of a right-hand side."""

    exponents: Exponents  # the exponents m of the coordinates
    # the numerator and the denominator of its coefficient, polynomials in the parameters
    coefficient: tuple[Poly, Poly]
    defect: Fraction  # how much weight it lacks


@dataclass(frozen=True)
class QuasiHomogeneous:
    """A polynomial vector field with weights for its coordinates."""

    derivation: Derivation
    weights: tuple[Fraction, ...]  # one for each coordinate
    context: Any  # FLINT's context of the coordinates and, after them, the parameters

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
            tops, common = over_common_denominator([t.coefficient for t in dominant], self.context.constant(1))
            equation = gens[i] * as_fmpq(self.weights[i]) * common
            for t, top in zip(dominant, tops, strict=True):
                equation += top * self.context.from_dict({(*t.exponents, *(0,) * len(self.parameter_names)): 1})
            found.append(equation)
        return found


@dataclass(frozen=True)
class LocalField:
    """The vector field with coefficients in the field of a balance."""

    field: FunctionField
    weights: tuple[Fraction, ...]  # one for each coordinate
    # for each right-hand side the exponents, the coefficient and the defect of each term
    terms: tuple[tuple[tuple[Exponents, Element, Fraction], ...], ...]

    @classmethod
    def of(cls, system: QuasiHomogeneous, field: FunctionField, parameters: Mapping[str, Element]) -> LocalField:
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
                for j, power in enumerate(exponents):
                    if power:
                        factors = (point[i] for i, k in enumerate(exponents) for _ in range(k - int(i == j)))
                        row[j] = row[j] + prod(factors, start=c * self.field.number(power))
            found.append(row)
        return found


_MOST_NODES = 200_000
"""Partial choices of whole weights that are tried where there is no largest one."""

Row = tuple[Fraction, ...]


def inequalities(derivation: Derivation) -> list[Row]:
    r"""The rows of $m - e_i$, whose products with the weights are at most 1."""
    rows: set[Row] = set()
    for i, component in enumerate(derivation.components):
        for monomial in component:
            row = [Fraction(m) for m in monomial]
            row[i] -= 1
            if any(x > 0 for x in row):
                rows.add(tuple(row))
    return sorted(rows)


def excess(rows: Iterable[Row], weights: Sequence[Fraction]) -> Fraction:
    """The largest product of a row with the weights; 0 if there are no rows."""
    return max(
        (sum((r * w for r, w in zip(row, weights, strict=True)), Fraction(0)) for row in rows), default=Fraction()
    )


def maximal_weights(derivation: Derivation) -> tuple[tuple[Fraction, ...], ...]:
    """All maximal weights; where there is no largest choice, all whole ones that are maximal."""
    rows = inequalities(derivation)
    n = len(derivation.variables)
    tops = [_largest(rows, k, n) for k in range(n)]
    if any(top is None for top in tops):
        cap = max([top for top in tops if top is not None], default=Fraction(1)) or Fraction(1)
        limits = [tuple(Fraction(int(j == k)) / cap for j in range(n)) for k in range(n) if tops[k] is None]
        rows = [*rows, *limits]
        tops = [_largest(rows, k, n) for k in range(n)]
    bounds = [top for top in tops if top is not None]
    if excess(rows, bounds) <= 1:
        return (tuple(bounds),)
    return _maximal_whole(rows, bounds)


def _largest(rows: Sequence[Row], k: int, n: int) -> Fraction | None:
    """The largest value of one weight, by SymPy's exact simplex method; None if there is none."""
    checkpoint("the weights")
    if not rows:
        return None
    matrix = [[Rational(x.numerator, x.denominator) for x in row] for row in rows]
    try:
        least: Any = linprog([-int(j == k) for j in range(n)], matrix, [1] * len(rows))[0]
    except UnboundedLPError:
        return None
    return Fraction(-int(least.p), int(least.q))


def _maximal_whole(rows: Sequence[Row], bounds: Sequence[Fraction]) -> tuple[tuple[Fraction, ...], ...]:
    """The maximal ones among whole weights that satisfy the inequalities."""
    n, nodes = len(bounds), 0
    found: list[tuple[Fraction, ...]] = []
    chosen: list[Fraction] = []

    def fits() -> bool:
        for row in rows:
            least = Fraction(0)
            for k, r in enumerate(row):
                least += r * chosen[k] if k < len(chosen) else min(r, Fraction(0)) * bounds[k]
            if least > 1:
                return False
        return True

    def search() -> None:
        nonlocal nodes
        nodes += 1
        checkpoint("the weights")
        if nodes > _MOST_NODES:
            raise ParameterError(
                f"weights: wanted equations with few choices of weights for their singular part; after {_MOST_NODES:,} "
                "attempts there are more. Give the weights of the coordinates"
            )
        if any(all(w <= v for w, v in zip([*chosen, *bounds[len(chosen) :]], other, strict=True)) for other in found):
            return
        if len(chosen) == n:
            found.append(tuple(chosen))
            return
        for value in range(int(bounds[len(chosen)]), -1, -1):
            chosen.append(Fraction(value))
            if fits():
                search()
            chosen.pop()

    search()
    return tuple(w for w in found if not any(w != v and all(a <= b for a, b in zip(w, v, strict=True)) for v in found))
