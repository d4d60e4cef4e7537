r"""The flow of a polynomial vector field, and its derivative, to any number of digits.

Power series of the state in the arithmetic of Arb: every monomial of degree two or more of the equations is a product
of two shorter ones, so that its coefficients are one convolution per order, and the tangent vectors solve $V' = Df(x)V$
with the series of $Df(x(t))$.  Only midpoints of the balls are carried on from step to step: the digits are as good as
the tolerance says, and nothing is proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, log
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.exact_numbers import Exact, to_sympy
from liepoisson.errors import OrbitError, ParameterError
from liepoisson.inputs.refusals import shown

if TYPE_CHECKING:
    from liepoisson.model.system import System

Ball: TypeAlias = Any
"""A number of python-flint's `arb`."""

Matrix: TypeAlias = Any
"""A matrix of them, `arb_mat`."""

_GUARD = 12
"""Decimal digits beyond those that are wanted."""


def bits(digits: int) -> int:
    """The working precision for so many decimal digits."""
    return ceil((digits + _GUARD) * log(10, 2)) + 16


def as_ball(value: Any) -> Ball:
    """An exact number at the working precision: a fraction, a SymPy expression, a double or a decimal text."""
    from flint import arb, ctx, fmpq

    if isinstance(value, str):
        return arb(value).mid()
    if isinstance(value, float):
        return arb(value)
    if isinstance(value, Fraction):
        return arb(fmpq(value.numerator, value.denominator))
    expression: Any = to_sympy(value)
    if expression.is_Rational:
        return arb(fmpq(int(expression.p), int(expression.q)))
    return arb(str(expression.evalf(ceil(ctx.prec / log(10, 2)) + 5))).mid()


def column(values: Sequence[Ball]) -> Matrix:
    """A matrix of one column."""
    from flint import arb_mat

    return arb_mat(len(values), 1, list(values))


def midpoints(matrix: Matrix) -> Matrix:
    """The matrix without its radii."""
    from flint import arb_mat

    return arb_mat(matrix.nrows(), matrix.ncols(), [entry.mid() for entry in matrix.entries()])


def solved(matrix: Matrix, right: Matrix) -> Matrix:
    """The solution of linear equations of full rank, that of least squares if there are more equations than unknowns.

    Raises:
        OrbitError: the equations are singular.
    """
    if matrix.nrows() != matrix.ncols():
        matrix, right = matrix.transpose() * matrix, matrix.transpose() * right
    try:
        return midpoints(matrix.solve(right))
    except ZeroDivisionError as error:
        raise OrbitError("Newton's equations must be regular; they are singular here: no isolated solution") from error


@dataclass(frozen=True)
class Polynomials:
    """Polynomial functions of the state, evaluated with their derivatives in Arb's arithmetic.

    Attributes:
        terms: For each function its terms: coefficient, and the variable of each factor.
        n: The number of variables.
    """

    terms: tuple[tuple[tuple[Exact, tuple[int, ...]], ...], ...]
    n: int

    @classmethod
    def of(cls, expressions: Sequence[Any], variables: Sequence[Any], what: str) -> Polynomials:
        """From SymPy expressions.

        Raises:
            ParameterError: one is no polynomial, or has a free parameter.
        """
        from sympy import Poly

        every: list[tuple[tuple[Exact, tuple[int, ...]], ...]] = []
        for expression in expressions:
            if not expression.is_polynomial(*variables) or not expression.free_symbols <= set(variables):
                raise ParameterError(
                    f"{what}: wanted polynomials with numbers for coefficients, for arithmetic of many digits; got "
                    f"{shown(expression)}"
                )
            terms: list[Any] = [] if expression == 0 else Poly(expression, *variables).terms()
            every.append(tuple((c, tuple(i for i, k in enumerate(m) for _ in range(k))) for m, c in terms if c != 0))
        return cls(tuple(every), len(variables))

    def values(self, x: Sequence[Ball]) -> list[Ball]:
        """The values at a state."""
        return [sum((_product(as_ball(c), [x[i] for i in m]) for c, m in terms), as_ball(0.0)) for terms in self.terms]

    def derivatives(self, x: Sequence[Ball]) -> Matrix:
        """The matrix of derivatives at a state, shape (function, N)."""
        from flint import arb_mat

        rows: list[Ball] = []
        for terms in self.terms:
            row = [as_ball(0.0)] * self.n
            for c, m in terms:
                for k, i in enumerate(m):
                    row[i] = row[i] + _product(as_ball(c), [x[j] for j in m[:k] + m[k + 1 :]])
            rows += row
        return arb_mat(len(self.terms), self.n, rows)


def _product(start: Ball, factors: Sequence[Ball]) -> Ball:
    for factor in factors:
        start = start * factor
    return start


class PreciseFlow:
    """The flow of a system with polynomial equations.

    Use it inside of `flint.ctx.workprec(bits(digits))`.

    Args:
        system: The system.
        digits: How many digits of each step are right.

    Raises:
        ParameterError: the equations are no polynomials.
    """

    def __init__(self, system: System, digits: int) -> None:
        self.digits = digits
        self.field = Polynomials.of(list(system.equations.values()), system.variables, "equations")
        self.n = self.field.n
        # Taylor series of d digits cost least at some 1.2 d terms, where a step is a fraction 1/e^2 of the radius.
        self.order = max(20, ceil(1.2 * (digits + _GUARD)))
        self._places: dict[tuple[int, ...], int] = {(i,): i for i in range(self.n)}
        self._factors: list[tuple[int, int]] = []
        self._rates = [[(as_ball(c), self._place(m)) for c, m in terms] for terms in self.field.terms]
        self._slopes: list[tuple[int, int, Ball, int]] = []
        for i, terms in enumerate(self.field.terms):
            for c, m in terms:
                for k, j in enumerate(m):
                    self._slopes.append((i, j, as_ball(c), self._place(m[:k] + m[k + 1 :])))

    def _place(self, monomial: tuple[int, ...]) -> int:
        """The number of a monomial among the series; -1 for the constant 1."""
        if not monomial:
            return -1
        if monomial not in self._places:
            factors = self._place(monomial[:-1]), monomial[-1]
            self._factors.append(factors)
            self._places[monomial] = self.n + len(self._factors) - 1
        return self._places[monomial]

    def end(self, start: Sequence[Ball], time: Ball, tangents: Matrix | None = None) -> tuple[list[Ball], Matrix]:
        """The state after a time, and the tangent vectors, as columns.

        Args:
            start: The state at time 0, N balls.
            time: The time, of any sign.
            tangents: Tangent vectors at time 0 as columns, shape (N, k); none by default.
        """
        x, moved, left = list(start), tangents, time
        while float(abs(left)) > 0.0:
            series = self._series(x)
            h = self._step(series)
            last = h >= float(abs(left))
            step = left if last else (as_ball(h) if float(left) > 0 else as_ball(-h))
            if moved is not None:
                moved = self._carried(series, moved, step)
            x = [_horner(series[i][: self.order + 1], step).mid() for i in range(self.n)]
            if last:
                break
            left = (left - step).mid()
        return x, moved

    def rate(self, x: Sequence[Ball]) -> list[Ball]:
        """The vector field."""
        return self.field.values(x)

    def _series(self, x: Sequence[Ball]) -> list[list[Ball]]:
        """The coefficients of all monomials, up to the order."""
        zero = as_ball(0.0)
        series: list[list[Ball]] = [[value] for value in x]
        for left, right in self._factors:
            series.append([series[left][0] * series[right][0]])
        for k in range(self.order):
            for i, terms in enumerate(self._rates):
                total = zero
                for c, place in terms:
                    if place >= 0:
                        total = total + c * series[place][k]
                    elif k == 0:
                        total = total + c
                series[i].append(total / (k + 1))
            for place, (left, right) in enumerate(self._factors, start=self.n):
                a, b = series[left], series[right]
                series[place].append(sum((a[j] * b[k + 1 - j] for j in range(k + 2)), zero))
        return series

    def _step(self, series: list[list[Ball]]) -> float:
        """The step for which the last two terms are below the tolerance, relative to the state."""
        size = max(1e-300, *(abs(float(series[i][0])) for i in range(self.n)))
        goal = log(10) * -(self.digits + _GUARD - 4)
        found = []
        for k in (self.order - 1, self.order):
            largest = max((abs(series[i][k]) for i in range(self.n)), key=float)
            if float(largest) > 0 or bool(largest > 0):
                found.append((goal - float((largest / size).log())) / k)
        if not found:
            return 1e3
        return min(1e3, 2.718281828 ** min(found))

    def _carried(self, series: list[list[Ball]], V: Matrix, step: Ball) -> Matrix:
        r"""Tangent vectors after a step: $V_{k+1} = \frac1{k+1}\sum_j A_j V_{k-j}$."""
        from flint import arb_mat

        zero = as_ball(0.0)
        slopes: list[Matrix] = []
        for k in range(self.order):
            entries = [zero] * (self.n * self.n)
            for i, j, c, place in self._slopes:
                if place >= 0:
                    entries[i * self.n + j] = entries[i * self.n + j] + c * series[place][k]
                elif k == 0:
                    entries[i * self.n + j] = entries[i * self.n + j] + c
            slopes.append(arb_mat(self.n, self.n, entries))
        terms = [V]
        for k in range(self.order):
            total = slopes[0] * terms[k]
            for j in range(1, k + 1):
                total = total + slopes[j] * terms[k - j]
            terms.append(midpoints(total / (k + 1)))
        found = terms[-1]
        for term in reversed(terms[:-1]):
            found = found * step + term
        return midpoints(found)


def _horner(coefficients: list[Ball], step: Ball) -> Ball:
    value = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        value = value * step + c
    return value
