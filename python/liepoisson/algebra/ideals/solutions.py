r"""All solutions of a system that has finitely many, proved: a rational univariate representation.

A linear form u with different values at the different zeros $\xi$ turns the system into one equation. With q the
squarefree part of the characteristic polynomial of u and, for any polynomial f,

$$g_f(T) = \sum_\xi\mu(\xi)f(\xi)\prod_{\eta\ne\xi}(T-u(\eta)), \qquad
  \frac{g_f(T)}{q(T)} = \sum_{k\ge0}\mathrm{Tr}(fu^k)\,T^{-k-1},$$

the zeros are the roots t of q with $f(\xi) = g_f(t)/g_1(t)$, for the coordinates and for every other polynomial. That u
tells the zeros apart is certain if q has as many roots as there are distinct zeros. Each irreducible factor of q
has zeros that no polynomial with rational coefficients distinguishes: f vanishes at all of them if the factor divides
$g_f$, and else at none. So a value is zero, or a ball around it excludes zero at some precision: nothing is decided by
a tolerance.

References: [rouillier1999].
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import count
from typing import Any, cast

from flint import acb, arb, ctx, fmpq, fmpq_mat, fmpq_poly, fmpz_poly, nmod_mat, nmod_poly

from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.certified_roots import ball, evaluate, precision
from liepoisson.algebra.ideals.groebner import GroebnerBasis
from liepoisson.algebra.ideals.limits import Budget, NotDecidedError
from liepoisson.algebra.ideals.quotient import Quotient
from liepoisson.algebra.residues import primes

_MOST_BITS = 1 << 16
"""Bits of the ball arithmetic after which a ball is given up."""


@dataclass(frozen=True, repr=False)
class Solution:
    """One zero of a system; the balls of different zeros are disjoint.

    Attributes:
        values: The coordinates, real balls (`flint.arb`) for a real zero and complex ones (`flint.acb`) for others; a
            coordinate that is rational with denominator 1 or zero may be an exact ball.
        multiplicity: Its multiplicity.
        factor: The number of the irreducible factor that it is a root of, in `Solutions.factors`: zeros of one factor
            are conjugate.
        root: The number of the root among those of the factor.
        is_real: Whether all coordinates are real.
    """

    values: tuple[Any, ...]
    multiplicity: int
    factor: int
    root: int
    is_real: bool

    def __repr__(self) -> str:
        shown = ", ".join(_shown(value) for value in self.values)
        times = f", multiplicity {self.multiplicity}" if self.multiplicity > 1 else ""
        return f"<Solution ({shown}){times}>"


def _shown(value: Any) -> str:
    if isinstance(value, arb):
        return f"{float(value.mid()):.10g}"
    return f"{complex(float(value.real.mid()), float(value.imag.mid())):.10g}"


@dataclass(frozen=True)
class Factor:
    """An irreducible factor of the equation for u.

    Attributes:
        polynomial: The factor, primitive.
        multiplicity: The multiplicity of each of its zeros.
    """

    polynomial: fmpz_poly
    multiplicity: int

    @property
    def degree(self) -> int:
        """The number of its zeros."""
        return int(self.polynomial.degree())


@dataclass(frozen=True, repr=False)
class Solutions:
    """All complex solutions of a system of dimension 0.

    Attributes:
        quotient: The algebra of the ideal.
        form: The coefficients of the linear form u.
        equation: The squarefree polynomial q whose roots are the values of u.
        factors: Its irreducible factors, by degree.
    """

    quotient: Quotient
    form: tuple[int, ...]
    equation: fmpq_poly
    factors: tuple[Factor, ...]
    _moments: list[fmpq_mat] = field(repr=False)
    _budget: Budget = field(repr=False)
    _known_roots: dict[tuple[int, int], list[acb]] = field(default_factory=dict[tuple[int, int], list[acb]], repr=False)

    def __repr__(self) -> str:
        return (
            f"<Solutions: {self.n_distinct} complex, {self.n_real} real; {self.degree} with multiplicities; "
            f"factors of degree {', '.join(str(f.degree) for f in self.factors) or 'none'}>"
        )

    @property
    def degree(self) -> int:
        """The number of complex solutions with multiplicities."""
        return self.quotient.dimension

    @property
    def n_distinct(self) -> int:
        """The number of distinct complex solutions."""
        return sum(f.degree for f in self.factors)

    @cached_property
    def n_real(self) -> int:
        """The number of distinct real solutions."""
        return sum(root.imag.is_zero() for k in range(len(self.factors)) for root in self._roots(k))

    def real(self, bits: int = 60) -> list[Solution]:
        """The real solutions, each coordinate to this many bits."""
        return [s for s in self._all(bits, is_real_only=True) if s.is_real]

    def complex(self, bits: int = 60) -> list[Solution]:
        """All complex solutions, the real ones among them."""
        return self._all(bits, is_real_only=False)

    def numerator(self, p: Poly) -> fmpq_poly:
        """The polynomial $g_p$: the value of p at the zero of a root t is $g_p(t)/g_1(t)$."""
        vector = self.quotient.vector(p)
        sums = [(moment * vector)[0, 0] for moment in self._moments]
        q = self.equation.coeffs()
        return fmpq_poly(
            [sum((q[j + k + 1] * sums[k] for k in range(len(q) - 1 - j)), fmpq(0)) for j in range(len(q) - 1)]
        )

    def vanishes(self, p: Poly, factor: int) -> bool:
        """Whether a polynomial is zero at the solutions of a factor, exactly."""
        return not self.numerator(p) % fmpq_poly(self.factors[factor].polynomial)

    def value(self, p: Poly, solution: Solution, bits: int = 60) -> Any:
        """The value of a polynomial at a solution, a ball with a relative error of at most $2^{-bits}$; 0 is exact."""
        numerator = self.numerator(p)
        return self._ratio(numerator, solution.factor, solution.root, bits)

    def sign(self, p: Poly, solution: Solution) -> int:
        """The sign of a polynomial at a real solution: 1, -1, or 0 where it vanishes exactly."""
        value = self.value(p, solution, 8)
        return 0 if value.is_zero() else 1 if value > 0 else -1

    @cached_property
    def _one(self) -> fmpq_poly:
        return self.numerator(self.quotient.ideal.context.constant(1))

    @cached_property
    def _coordinates(self) -> list[fmpq_poly]:
        return [self.numerator(x) for x in self.quotient.ideal.context.gens()]

    def _roots(self, factor: int) -> list[acb]:
        """The roots of a factor at the present precision, in an order that does not depend on it."""
        if (factor, ctx.prec) in self._known_roots:
            return self._known_roots[factor, ctx.prec]
        polynomial = self.factors[factor].polynomial
        words = max(abs(c).bit_length() for c in map(int, polynomial.coeffs())) + ctx.prec
        self._budget.spend(0.02 * polynomial.degree() ** 2 * (1 + words / 64), "isolation of roots")
        found = [root for root, _ in cast("list[tuple[acb, int]]", polynomial.complex_roots())]
        # FLINT's order may change with the precision
        self._known_roots[factor, ctx.prec] = sorted(found, key=_Ordered)
        return self._known_roots[factor, ctx.prec]

    def _all(self, bits: int, *, is_real_only: bool) -> list[Solution]:
        found: list[Solution] = []
        for k, factor in enumerate(self.factors):
            with precision(max(64, bits)):
                are_real = [bool(root.imag.is_zero()) for root in self._roots(k)]
            for number, is_real in enumerate(are_real):
                if is_real or not is_real_only:
                    found.append(Solution((), factor.multiplicity, k, number, is_real))
        close = list(range(len(found)))
        while close:
            for k in close:
                found[k] = self._enclosed(found[k], bits)
            close = _overlapping([one.values for one in found])
            bits *= 2
        return found

    def _enclosed(self, solution: Solution, bits: int) -> Solution:
        """The solution with its coordinates to this many bits."""
        values = tuple(self._ratio(g, solution.factor, solution.root, bits) for g in self._coordinates)
        return replace(solution, values=values)

    def _ratio(self, numerator: fmpq_poly, factor: int, root: int, bits: int) -> Any:
        """The value of $g/g_1$ at a root."""
        modulus = fmpq_poly(self.factors[factor].polynomial)
        top, bottom = numerator % modulus, self._one % modulus
        if not top:
            return arb(0)
        if top.degree() == bottom.degree() and not (top - bottom * (top.coeffs()[-1] / bottom.coeffs()[-1])):
            with precision(max(64, bits + 8)):
                return ball(top.coeffs()[-1] / bottom.coeffs()[-1])
        for extra in _growing(bits):
            with precision(extra):
                at = self._roots(factor)[root]
                is_real = at.imag.is_zero()
                divisor = evaluate(bottom, at.real if is_real else at)
                if divisor.contains(0):
                    continue
                value = evaluate(top, at.real if is_real else at) / divisor
                if value.contains(0):
                    continue
                size = abs(value)
                width = value.rad() if is_real else value.real.rad() + value.imag.rad()
                if width * arb(2) ** bits < size:
                    return value
        raise NotDecidedError(f"not decided: a coordinate of a solution needs more than {_MOST_BITS} bits")


def _overlapping(boxes: Sequence[tuple[Any, ...]]) -> list[int]:
    """The numbers of the boxes that are not disjoint from all others."""
    found: set[int] = set()
    for j, box in enumerate(boxes):
        for k in range(j):
            if all(acb(x).overlaps(acb(y)) for x, y in zip(box, boxes[k], strict=True)):
                found |= {j, k}
    return sorted(found)


def _growing(bits: int) -> Generator[int]:
    at = max(64, 2 * bits)
    while at <= _MOST_BITS:
        yield at
        at *= 2


class _Ordered:
    """Real roots before others; by the real part where the balls differ in it, then by the imaginary part."""

    def __init__(self, root: acb) -> None:
        self._root = root

    def __lt__(self, other: _Ordered) -> bool:
        a, b = self._root, other._root
        if a.imag.is_zero() != b.imag.is_zero():
            return bool(a.imag.is_zero())
        return bool(a.real.mid() < b.real.mid()) if not a.real.overlaps(b.real) else bool(a.imag.mid() < b.imag.mid())


def solutions(basis: GroebnerBasis, budget: Budget) -> Solutions:
    """All complex solutions of an ideal of dimension 0 or less.

    Raises:
        NotDecidedError: the limits were reached.
    """
    quotient = Quotient(basis, budget)
    if not quotient.dimension:
        return Solutions(quotient, (0,) * quotient.n, fmpq_poly([1]), (), [], budget)
    n_distinct = quotient.n_distinct
    for form in _forms(quotient.n):
        if not _may_separate(quotient, form, n_distinct):
            continue
        matrix = quotient.multiplication(form)
        characteristic = quotient.characteristic(matrix)
        factors = [Factor(f.numer(), int(e)) for f, e in characteristic.factor()[1]]
        if sum(f.degree for f in factors) == n_distinct:
            break
    else:  # pragma: no cover, as the forms do not end
        raise AssertionError
    factors.sort(key=lambda f: (f.degree, str(f.polynomial)))
    equation = fmpq_poly([1])
    for f in factors:
        equation = equation * fmpq_poly(f.polynomial) / fmpq(f.polynomial.leading_coefficient())
    moments = [quotient.traces]
    for _ in range(n_distinct - 1):
        budget.spend(0.1 * quotient.dimension**2 * (1 + basis.words), "moments of a linear form")
        moments.append(moments[-1] * matrix)
    return Solutions(quotient, form, equation, tuple(factors), moments, budget)


def _forms(n: int) -> Generator[tuple[int, ...]]:
    r"""Linear forms of which one tells the zeros apart: the variables, then sums such as $\sum_i k^i x_i$."""
    for k in reversed(range(n)):
        yield tuple(int(i == k) for i in range(n))
    for k in count(2):
        yield tuple((-1) ** i * (k**i % 1009 + i) for i in range(n))
        yield tuple(k**i for i in range(n))


def _may_separate(quotient: Quotient, form: Sequence[int], n_distinct: int) -> bool:
    """Whether a linear form has as many different values modulo a prime; True if a prime is unlucky."""
    d = quotient.dimension
    for p in primes():
        images = [_modular(matrix, p) for matrix in quotient.by_variables]
        if any(image is None for image in images):
            continue
        total = nmod_mat(d, d, p)
        for c, image in zip(form, images, strict=True):
            total = total + image * (c % p)
        characteristic = cast("nmod_poly", cast("Any", total).charpoly())
        common = characteristic.gcd(characteristic.derivative())
        return d - common.degree() == n_distinct
    raise AssertionError


def _modular(matrix: fmpq_mat, p: int) -> Any:
    entries = [(int(c.p), int(c.q) % p) for c in matrix.entries()]
    if any(not q for _, q in entries):
        return None
    return nmod_mat(matrix.nrows(), matrix.ncols(), [a * pow(q, -1, p) % p if a else 0 for a, q in entries], p)
