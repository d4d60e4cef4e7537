r"""Local solutions of a linear system at a singular point, exactly: exponents, logarithms, the local monodromy.

With $p = s - s_0$ and $u_i = p^{w_i} y_i$ for suitable integers $w_i$ the equations become $p\,u' = B(p)\,u$, B
holomorphic at 0; the point is then regular singular, and the eigenvalues of $B(0)$ are its **exponents** (those of y up
to integers).  To the exponents $e + n$, n integers, belong the solutions

$$ u = p^e \sum_{n,j} u_{n,j}\,p^n \frac{(\ln p)^j}{j!}, \qquad
   (e + n)\,u_{n,j} + u_{n,j+1} = \sum_{k\ge0} B_k u_{n-k,j} . $$

Their number is that of these exponents.  Below the smallest of them all $u_n$ vanish, beyond the largest they are
determined, so finitely many equations decide.  The derivative by $\ln p$, $u_{n,j} \mapsto u_{n,j+1}$, is a nilpotent
map N of the solutions; the monodromy around the point is $e^{2\pi i e} \exp(2\pi i N)$, and ker N are the solutions
without logarithms.  Everything is done in the field that the point generates over the rational numbers.

References: [wasow1965], chapters I and II.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import zip_longest
from math import lcm
from typing import TYPE_CHECKING, Any

from flint import fmpq_poly
from sympy import QQ, Poly, Symbol
from sympy.polys.matrices import DomainMatrix

from liepoisson.algebra.function_fields import common_roots, root_text
from liepoisson.algebra.number_fields import as_fmpq, as_fraction
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from liepoisson.integrability.galois.linear_systems import LinearSystem


@dataclass(frozen=True)
class Exponents:
    """The exponents at a point.

    Attributes:
        rational: Those that are rational, with their multiplicities.
        others: Irreducible polynomials over the rational numbers (FLINT) whose roots contain the others.
        n: How many exponents there are.
        n_different: How many of them are different.
    """

    rational: dict[Fraction, int]
    others: tuple[Any, ...]
    n: int
    n_different: int

    @property
    def all_rational(self) -> bool:
        """Whether the monodromy around the point has a power that is unipotent."""
        return sum(self.rational.values()) == self.n

    @property
    def all_integers(self) -> bool:
        """Whether the monodromy around the point is unipotent."""
        return self.all_rational and all(e.denominator == 1 for e in self.rational)

    @property
    def classes(self) -> dict[Fraction, int]:
        """The rational exponents modulo integers, each with the number of exponents in its class."""
        found: dict[Fraction, int] = {}
        for e, count in self.rational.items():
            found[e % 1] = found.get(e % 1, 0) + count
        return found

    @cached_property
    def neat_power(self) -> int:
        """The power q of the monodromy for which no quotient of two different eigenvalues is a root of unity.

        The quotients are exp(2 pi i q d), where d is a difference of exponents: d is irrational, or q d is an integer.
        Two roots of irreducible polynomials f and g differ by a rational number d only if g(x) = f(x + d).
        """
        q = 1
        first = next(iter(self.rational), Fraction(0))
        for e in self.rational:
            q = lcm(q, (e - first).denominator)
        for k, f in enumerate(self.others):
            for g in self.others[:k]:
                if (d := rational_shift(f, g)) is not None:
                    q = lcm(q, d.denominator)
        return q

    @property
    def pairwise_irrational(self) -> bool:
        """Whether no difference of two of the exponents is rational, that of two equal ones included.

        Two different roots of one irreducible polynomial never differ by a rational number.
        """
        if self.n_different < self.n or len(self.rational) > 1:
            return False
        return all(rational_shift(f, g) is None for k, f in enumerate(self.others) for g in self.others[:k])

    def differ_irrationally(self, other: Exponents) -> bool:
        """Whether no difference of one of these exponents and one of the others is rational."""
        if self.rational and other.rational:
            return False
        return all(rational_shift(f, g) is None for f in self.others for g in other.others)

    @property
    def text(self) -> str:
        """The exponents in one line."""
        parts = [str(e) for e in sorted(self.rational) for _ in range(self.rational[e])]
        return ", ".join([*parts, *(f"the roots of {root_text(f, 'e')}" for f in self.others)])


@dataclass(frozen=True)
class LocalSolutions:
    """The solutions whose exponents are e + n, n integers."""

    # u_(n,j) for n from the smallest on, matrices with a row for each component and a column for each solution
    coefficients: tuple[tuple[Any, ...], ...]
    nilpotent: Any  # N, the derivative by ln p of the solutions, a square matrix

    @property
    def n(self) -> int:
        """How many there are."""
        return int(self.nilpotent.shape[0])

    @property
    def n_without_logarithm(self) -> int:
        """How many of them have no logarithm."""
        return self.n - int(self.nilpotent.rank())


class LocalSystem:
    """A system near a singular point: its exponents, and its solutions as series with logarithms.

    Attributes:
        system: The system.
        point: The irreducible polynomial whose roots are the points; None for infinity, where p = 1/s.
        field: The numbers that the point generates.
        weights: w, such that u_i = p^(w_i) y_i has a simple pole; None where there are none.
    """

    def __init__(self, system: LinearSystem, point: Any) -> None:
        self.system = system
        self.point = point
        self._here = system.at_infinity if point is None else system
        self.field: Any = QQ
        if point is not None and point.degree() > 1:
            coefficients = [QQ(c.p, c.q) for c in reversed(point.coeffs())]
            self.field = QQ.alg_field_from_poly(Poly(coefficients, Symbol("theta"), domain=QQ))
        self._valuations, self._pole = self._orders()
        self.weights = self._weights()
        self._series: list[Any] = []

    @property
    def is_regular(self) -> bool:
        """Whether weights were found, so that the point is regular singular; if not, it may still be so."""
        return self.weights is not None

    @cached_property
    def exponents(self) -> Exponents:
        """The exponents of u."""
        characteristic: Any = Poly(self.coefficient(0).charpoly(), Symbol("x"), domain=self.field)
        coordinates = [_coordinates(c, self.field) for c in reversed(characteristic.rep.to_list())]
        rational, *_ = common_roots(zip_longest(*coordinates, fillvalue=0))
        others: list[Any] = []
        if sum(rational.values()) < self.system.n:
            norm = characteristic.norm() if self.field.is_Algebraic else characteristic
            whole = fmpq_poly([c for e in reversed(norm.rep.to_list()) for c in _coordinates(e, norm.domain)])
            others = [f for f, _ in whole.factor()[1] if f.degree() > 1]
        return Exponents(rational, tuple(others), self.system.n, int(characteristic.sqf_part().degree()))

    def coefficient(self, k: int) -> Any:
        """B_k, a matrix over the field."""
        if self.weights is None:
            raise ParameterError(
                f"{self.place} is an irregular singular point, or no weights of the components were "
                "found; there are no exponents"
            )
        if k >= len(self._series):
            self._series = self._expanded(2 * k + 4)
        return self._series[k]

    def solutions(self, exponent: Fraction = Fraction(0), *, terms: int = 0) -> LocalSolutions:
        """The solutions of a class of rational exponents.

        Args:
            exponent: e, one of the keys of `exponents.classes`.
            terms: How many terms beyond those that are needed to decide on logarithms.
        """
        whole = sorted(e - exponent for e in self.exponents.rational if (e - exponent).denominator == 1)
        count = self.exponents.classes.get(exponent % 1, 0)
        if not whole:
            known = ", ".join(map(str, self.exponents.classes)) or "none that are rational"
            raise ParameterError(f"{exponent} is no exponent modulo integers at {self.place}; there are {known}")
        first, last = int(whole[0]), int(whole[-1]) + terms
        powers = 1
        while True:
            found = self._solved(exponent, first, last, powers)
            if found[0][0].shape[1] == count:
                break
            powers += 1
        nilpotent = _shift_of(found, self.field, self.system.n, count)
        return LocalSolutions(tuple(tuple(row) for row in found), nilpotent)

    @cached_property
    def n_without_logarithm(self) -> int:
        """The number of independent solutions with rational exponents that have no logarithm."""
        return sum(self.solutions(e).n_without_logarithm for e in self.exponents.classes)

    @property
    def n_single_valued(self) -> int:
        """The number of independent solutions that are Laurent series."""
        return self.solutions().n_without_logarithm if Fraction(0) in self.exponents.classes else 0

    @property
    def place(self) -> str:
        """The point in words."""
        return "infinity" if self.point is None else root_text(self.point, self.system.variable)

    def series(self, polynomial: Any, count: int) -> list[Any]:
        """The first coefficients of a polynomial at the point, in powers of p (of p = 1/s at infinity: at p = 0)."""
        found: list[Any] = []
        current, factorial = polynomial, 1
        for k in range(count):
            found.append(self._value(current / factorial))
            current, factorial = current.derivative(), factorial * (k + 1)
        return found

    def _value(self, polynomial: Any) -> Any:
        """A polynomial at the point."""
        if self.point is None:
            c = polynomial[0]
            return QQ(c.p, c.q)
        rest = polynomial % self.point
        if self.point.degree() == 1:
            return QQ(rest[0].p, rest[0].q)
        return self.field([QQ(c.p, c.q) for c in reversed(rest.coeffs())])

    def _orders(self) -> tuple[list[list[int | None]], int]:
        """The orders of the entries of A at the point (None for zeros), and that of its common denominator."""
        numerators, denominator = self._here.polynomials
        point = fmpq_poly([0, 1]) if self.point is None else self.point

        def order(f: Any) -> int:
            k = 0
            while f.degree() > 0 and not f % point:
                f, k = f / point, k + 1
            return k

        pole = order(denominator)
        return [[order(f) - pole if f else None for f in row] for row in numerators], pole

    def _weights(self) -> tuple[int, ...] | None:
        """The largest weights, none above 0, that leave a simple pole: shortest paths; shifted to begin at 0."""
        n = self.system.n
        found = [0] * n
        for _ in range(n + 1):
            changed = False
            for i in range(n):
                for j in range(n):
                    order = self._valuations[i][j]
                    if order is not None and i != j and found[j] > found[i] + order + 1:
                        found[j], changed = found[i] + order + 1, True
            if not changed:
                break
        else:
            return None
        if any((order := self._valuations[i][i]) is not None and order < -1 for i in range(n)):
            return None
        least = min(found)
        return tuple(w - least for w in found)

    def _expanded(self, count: int) -> list[Any]:
        """B_0, B_1, ..., so many."""
        assert self.weights is not None
        w, n, pole, zero = self.weights, self.system.n, self._pole, self.field.zero
        numerators, denominator = self._here.polynomials
        size = count + max(w) - min(w) + pole
        first, *lower = self.series(denominator, size)[pole:]
        series = [[self.series(f, size) if f else [zero] * size for f in row] for row in numerators]
        found: list[Any] = []
        for k in range(count):
            # p^(w_i - w_j + 1 - pole) M_ij, divided by d p^-pole
            places = [[k - (a - b + 1 - pole) for b in w] for a in w]
            table = [
                [of_one[m] if 0 <= m < size else zero for of_one, m in zip(*rows, strict=True)]
                for rows in zip(series, places, strict=True)
            ]
            total = DomainMatrix(table, (n, n), self.field)
            for j, c in enumerate(lower[:k], start=1):
                total = total - found[k - j] * c if c else total
            found.append(total * (self.field.one / first))
        weights = [[self.field(w[i]) if i == j else zero for j in range(n)] for i in range(n)]
        return [found[0] + DomainMatrix(weights, (n, n), self.field), *found[1:]]

    def _solved(self, exponent: Fraction, first: int, last: int, powers: int) -> list[list[Any]]:
        """The solutions with powers of ln p below a bound, as in `LocalSolutions.coefficients`."""
        n, field = self.system.n, self.field
        e = field(QQ(exponent.numerator, exponent.denominator))
        identity, zero = DomainMatrix.eye(n, field), DomainMatrix.zeros((n, n), field)
        found: list[list[Any]] = []
        n_columns = 0
        for m in range(first, last + 1):
            shifted = self.coefficient(0).to_sparse() - identity * (e + field(m))
            # unknowns: u_{m,0}, ..., u_{m,powers-1}, then the coefficients of the solutions found so far
            rows: list[Any] = []
            for j in range(powers):
                blocks = [shifted if i == j else -identity if i == j + 1 else zero for i in range(powers)]
                known = DomainMatrix.zeros((n, n_columns), field)  # the sum of B_k u_(m-k,j) over k > 0
                for k in range(1, m - first + 1):
                    known = known + self.coefficient(k).to_sparse() * found[m - first - k][j]
                rows.append(DomainMatrix.hstack(*blocks, known))
            basis = DomainMatrix.vstack(*rows).nullspace().transpose()
            found = [[u * basis[n * powers :, :] for u in row] for row in found]
            found.append([basis[n * j : n * (j + 1), :] for j in range(powers)])
            n_columns = basis.shape[1]
        return found


def _shift_of(found: list[list[Any]], field: Any, n: int, count: int) -> Any:
    """N, with u_{m,j} N = u_{m,j+1}."""
    left = DomainMatrix.vstack(*(u for row in found for u in row))
    right = DomainMatrix.vstack(*(u for row in found for u in (*row[1:], DomainMatrix.zeros((n, count), field))))
    reduced, pivots = left.hstack(right).to_dense().rref()
    assert pivots[:count] == tuple(range(count)), "solutions that are not independent"
    return reduced.extract(list(range(count)), list(range(count, 2 * count)))


def _coordinates(element: Any, field: Any) -> list[Any]:
    """A number of the field by its coordinates, the coefficients of powers of theta."""
    numbers = reversed(element.to_list()) if field.is_Algebraic else [element]
    return [as_fmpq(c) for c in numbers]


def rational_shift(f: Any, g: Any) -> Fraction | None:
    """The rational d with g(x) = f(x + d) up to a factor, f and g of FLINT; None if there is none."""
    n = f.degree()
    if n != g.degree():
        return None
    d = (g[n - 1] / g[n] - f[n - 1] / f[n]) / n
    moved = f(fmpq_poly([d, 1]))
    if moved / moved.leading_coefficient() != g / g.leading_coefficient():
        return None
    return as_fraction(d)
