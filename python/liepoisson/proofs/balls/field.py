r"""Polynomial fields in Arb's balls: values, derivatives, and Taylor series of solutions.

A ball is an interval of real numbers; every operation returns a ball that contains all results for numbers in its
arguments (Johansson, *Arb: efficient arbitrary-precision midpoint-radius interval arithmetic*, IEEE Transactions on
Computers 66 (2017) 1281).
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from typing import Any, TypeAlias

from flint import arb, arb_mat, arb_series, ctx, fmpq

from liepoisson.algebra.sparse_polynomials import derivative
from liepoisson.proofs.polynomial_field import PolynomialField, Terms

Ball: TypeAlias = arb
Vector: TypeAlias = "list[arb]"

PRECISION = 96
"""Bits of the arithmetic.  The widths of sets are far above 2^-96, and those of single orbits below what is asked."""


@contextmanager
def working(precision: int = PRECISION) -> Generator[None]:
    """Set the precision of FLINT, and put back what was there."""
    before = ctx.prec, ctx.cap
    ctx.prec = precision
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before


def ball(value: Fraction | float) -> arb:
    """A ball that contains a number; a double is itself."""
    if isinstance(value, Fraction):
        return arb(fmpq(value.numerator, value.denominator))
    return arb(value)


def interval(lower: arb, upper: arb) -> arb:
    """The hull of two balls."""
    return lower.union(upper)


def magnitude(x: arb) -> arb:
    """An upper bound of the absolute values in a ball, as an exact number."""
    return x.abs_upper()


def symmetric(bound: arb) -> arb:
    """The ball [-b, b]."""
    b = bound.abs_upper()
    return arb(0, b)


def lies_inside(inner: arb, outer: arb) -> bool:
    """Whether the first ball lies in the interior of the second; a ball that is not finite lies nowhere."""
    return bool(
        inner.is_finite() and outer.is_finite() and inner.lower() > outer.lower() and inner.upper() < outer.upper()
    )


class BallField:
    """A polynomial field that is evaluated in balls, or in power series with balls for coefficients."""

    def __init__(self, field: PolynomialField) -> None:
        self.field = field
        self.n = len(field.names)
        self._rates = _Evaluator(field.rates)
        pairs = [(i, j, derivative(rate, j)) for i, rate in enumerate(field.rates) for j in range(self.n)]
        self._places = [(i, j) for i, j, terms in pairs if terms]
        self._jacobian = _Evaluator([terms for _, _, terms in pairs if terms])
        self.constant_names = tuple(field.constants)
        self._constants = _Evaluator(list(field.constants.values()))
        gradients = [derivative(f, j) for f in field.constants.values() for j in range(self.n)]
        self._gradients = _Evaluator(gradients)
        self._hessians = _Evaluator([derivative(g, k) for g in gradients for k in range(self.n)])

    def rates(self, x: Sequence[Any]) -> list[Any]:
        """f(x)."""
        return self._rates(x)

    def jacobian(self, x: Sequence[arb]) -> arb_mat:
        """Df(x)."""
        return self._as_matrix(self._jacobian(x))

    def constants(self, x: Sequence[arb]) -> Vector:
        """H and the Casimirs."""
        return self._constants(x)

    def gradients(self, x: Sequence[arb]) -> arb_mat:
        """Their gradients, one in each row."""
        return arb_mat(len(self.constant_names), self.n, self._gradients(x))

    def hessians(self, x: Sequence[arb]) -> list[arb_mat]:
        """Their second derivatives, one matrix for each."""
        n, values = self.n, self._hessians(x)
        return [arb_mat(n, n, values[k : k + n * n]) for k in range(0, len(values), n * n)]

    def series(self, x: Sequence[arb], order: int) -> list[Vector]:
        r"""Taylor coefficients of the solutions that start in a box: [k][i] contains $x_i^{(k)}/k!$ for all of them.

        The recursion is Picard's: if x is right up to $t^k$, then $x(0) + \int f(x)\,dt$ is so up to $t^{k+1}$.
        """
        found = self._grown(x, order)
        coefficients = [_padded(s, order + 1) for s in found]
        return [[c[k] for c in coefficients] for k in range(order + 1)]

    def series_with_jacobian(self, x: Sequence[arb], order: int) -> tuple[list[Vector], list[arb_mat]]:
        """The Taylor coefficients of solutions up to t^order, and those of Df along them up to t^(order - 1)."""
        found = self._grown(x, order)
        ctx.cap = order
        entries = [_padded(s, order) for s in self._jacobian([arb_series(s, prec=order) for s in found])]
        matrices = [self._as_matrix([e[k] for e in entries]) for k in range(order)]
        coefficients = [_padded(s, order + 1) for s in found]
        return [[c[k] for c in coefficients] for k in range(order + 1)], matrices

    def _grown(self, x: Sequence[arb], order: int) -> list[arb_series]:
        starts = [arb_series([c], prec=order + 1) for c in x]
        found = starts
        for k in range(1, order + 1):
            ctx.cap = k
            rates = self._rates([arb_series(s, prec=k) for s in found])
            ctx.cap = k + 1
            found = [s + _series(r, k).integral() for s, r in zip(starts, rates, strict=True)]
        return found

    def _as_matrix(self, values: Sequence[Any]) -> arb_mat:
        matrix = arb_mat(self.n, self.n)
        for (i, j), value in zip(self._places, values, strict=True):
            matrix[i, j] = value
        return matrix


class _Evaluator:
    """Several polynomials, whose monomials are computed once each."""

    def __init__(self, polynomials: Sequence[Terms]) -> None:
        number = {}
        self._products: list[tuple[int, int]] = []  # monomial = earlier monomial times variable
        n = next((len(m) for p in polynomials for m in p), 0)
        self._n = n

        def place(m: tuple[int, ...]) -> int:
            """The variables come first, then 1, then products."""
            if not any(m):
                return n
            if sum(m) == 1:
                return m.index(1)
            if m not in number:
                k = max(k for k in range(n) if m[k])
                rest = place((*m[:k], m[k] - 1, *m[k + 1 :]))
                number[m] = n + 1 + len(self._products)
                self._products.append((rest, k))
            return number[m]

        with working():
            self._sums = [[(*_factor(c), place(m)) for m, c in sorted(p.items())] for p in polynomials]

    def __call__(self, x: Sequence[Any]) -> list[Any]:
        values: list[Any] = [*x, arb(1)]
        for a, b in self._products:
            values.append(values[a] * values[b])
        return [self._sum(terms, values) for terms in self._sums]

    @staticmethod
    def _sum(terms: Sequence[tuple[int, arb | None, int]], values: Sequence[Any]) -> Any:
        total: Any = None
        for sign, factor, k in terms:
            term: Any = values[k] if factor is None else values[k] * factor
            signed: Any = term if sign > 0 else -term
            total = signed if total is None else total + signed
        return arb(0) if total is None else total


def _factor(coefficient: Fraction) -> tuple[int, arb | None]:
    """The sign of a coefficient and its size, None where that is 1 and the term is no constant."""
    return (1 if coefficient > 0 else -1), ball(abs(coefficient)) if abs(coefficient) != 1 else None


def _series(value: Any, precision: int) -> arb_series:
    """A series; a rate that is constant comes as a number."""
    return value if isinstance(value, arb_series) else arb_series([value], prec=precision)


def _padded(value: Any, length: int) -> Vector:
    """The coefficients of a series, which lacks those that are exactly zero at its end."""
    if not isinstance(value, arb_series):
        return [value, *[arb(0)] * (length - 1)]
    if value.prec < length:
        raise ArithmeticError(f"a series is known to order {value.prec}, not {length}")
    found: Vector = value.coeffs()
    return [*found, *[arb(0)] * (length - len(found))]


def as_column(x: Sequence[arb]) -> arb_mat:
    """A vector as a matrix of one column."""
    return arb_mat(len(x), 1, list(x))


def norm(matrix: arb_mat) -> arb:
    """An upper bound of the largest sum of absolute values in a row."""
    rows = [sum((abs(e) for e in row), arb(0)).upper() for row in matrix.tolist()]
    largest = arb(0)
    for row in rows:
        largest = largest.max(row)
    return largest.upper()


def constants_of(level: Mapping[str, Fraction], names: Sequence[str], radius: Fraction = Fraction(0)) -> Vector:
    """The values of H and the Casimirs as balls of a radius."""
    return [ball(level[name]) + arb(0, ball(radius).upper()) for name in names]
