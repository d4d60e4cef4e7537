r"""Kovalevskaya exponents of a balance, and its Laurent (or Puiseux) series with symbols for the free constants.

**Series.** With $x_i = \tau^{-g_i}\sum_k c_i^{(k)}\tau^k$, k in steps of $1/q$, the equations at the order k are linear
in the new coefficients:

$$(k - K)\,c^{(k)} = R^{(k)}(c^{(0)},\dots,c^{(k-1/q)}) .$$

Where k is an exponent of multiplicity m, K - k has a kernel.  Its dimension must be m: else a solution of the
variational equation has a logarithm, whether or not these equations are solvable.  And $R^{(k)}$, a polynomial in the
free constants of lower orders, must satisfy the conditions of solvability identically: else the series itself needs a
logarithm.

**Exponents** are the eigenvalues of K.  The characteristic polynomial has coefficients in the field of the balance.
Written in a basis over $\mathbb Q$, it is a sum of basis elements times polynomials with rational coefficients; a
rational number is a root if and only if it is one of all these, with the multiplicity that it has in their greatest
common divisor G.  So rational exponents are the linear factors of G, and all others are proved to be irrational.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import Any, TypeAlias, cast

from flint import acb, acb_poly, fmpq_poly

from liepoisson.algebra.function_fields import (
    AlgebraicFunctions,
    AlgebraicNumbers,
    FunctionField,
    RationalFunctions,
    common_roots,
    polynomial_at,
    polynomial_gcd,
    polynomial_quotient,
    readable,
)
from liepoisson.algebra.ideals.certified_roots import ball, evaluate, precision
from liepoisson.algebra.ideals.coordinate_ring import CoordinateRing, Resolvent
from liepoisson.algebra.matrices import Matrix, Solved, eliminated, independent_columns
from liepoisson.algebra.number_fields import Element
from liepoisson.algebra.sparse_polynomials import Monomial, Polynomial, add_multiple
from liepoisson.inputs.deadline import checkpoint
from liepoisson.integrability.painleve.quasi_homogeneous import LocalField

_BITS = (128, 256, 512, 1024, 2048)


@dataclass(frozen=True)
class Exponents:
    """The exponents of a balance.

    Attributes:
        rational: The rational ones with their multiplicities, in increasing order.
        over_rationals: Irreducible polynomials over the rational numbers, of degree two or more, with multiplicities,
            whose roots are exponents, too.
        rest: The coefficients, by powers, of the polynomial whose roots are the others; it has no rational roots. (1,)
            if there are no others.
        field: The field of the balance.
    """

    rational: tuple[tuple[Fraction, int], ...]
    over_rationals: tuple[tuple[fmpq_poly, int], ...]
    rest: tuple[Element, ...]
    field: FunctionField

    @property
    def all_rational(self) -> bool:
        """Whether all exponents are rational numbers."""
        return not self.over_rationals and len(self.rest) == 1

    @property
    def are_integers(self) -> bool:
        """Whether all exponents are integers."""
        return self.all_rational and all(r.denominator == 1 for r, _ in self.rational)

    def multiplicity(self, r: Fraction | int) -> int:
        """How often a rational number occurs."""
        return dict(self.rational).get(Fraction(r), 0)

    @cached_property
    def others(self) -> tuple[acb, ...]:
        """The other exponents as balls, of all conjugates of the balance; empty where they depend on parameters."""
        found: list[acb] = []
        for p, k in self.over_rationals:
            with precision(_BITS[0]):
                found += [root for root in _roots(p) for _ in range(k)]
        if len(self.rest) > 1:
            found += self._roots_of_rest()
        return tuple(found)

    def _roots_of_rest(self) -> list[acb]:
        if isinstance(self.field, RationalFunctions | AlgebraicFunctions):
            return []
        field = self.field
        slope = [c * field.number(k) for k, c in enumerate(self.rest)][1:]
        common = polynomial_gcd(self.rest, slope, field)
        squarefree = polynomial_quotient(self.rest, common, field)[0]
        for bits in _BITS:
            with precision(bits):
                try:
                    found: list[acb] = []
                    for theta in _roots(field.modulus) if isinstance(field, AlgebraicNumbers) else [acb(0)]:
                        coefficients = [_at(c, theta) for c in squarefree]
                        while coefficients[-1] == 0:
                            coefficients.pop()
                        found += acb_poly(coefficients).roots()
                except ValueError:  # FLINT's, where roots are not isolated
                    continue
                return found
        return []

    def __str__(self) -> str:
        parts = [str(r) for r, k in self.rational for _ in range(k)]
        for p, k in self.over_rationals:
            with precision(_BITS[0]):
                roots = ", ".join(shown_number(z) for z in _roots(p))
            parts += [f"the roots of {readable(str(p).replace('x', 'r'))} ({roots})"] * k
        if len(self.rest) > 1:
            degree = len(self.rest) - 1
            if isinstance(self.field, AlgebraicNumbers):
                shown = ", ".join(shown_number(z) for z in self.others[-degree * self.field.degree :][:degree])
                parts.append(f"{degree} that are irrational, for one conjugate {shown}")
            else:
                parts.append(self._depending())
        return ", ".join(parts)

    def _depending(self) -> str:
        """The exponents that depend on parameters."""
        degree = len(self.rest) - 1
        if degree == 1:
            return self._explained(self.field.text(-self.rest[0] * self.field.inverse(self.rest[1])))
        lead = self.field.inverse(self.rest[-1])
        monic = [c * lead for c in self.rest]
        terms: list[str] = []
        for k in range(degree, -1, -1):
            if monic[k]:
                power = f"r^{k}" if k > 1 else "r" if k else ""
                text = self.field.text(monic[k])
                simple = text if text.isalnum() or not power else f"({text})"
                terms.append(power if text == "1" and power else f"{simple}*{power}" if power else text)
        return self._explained(f"the roots of {readable(' + '.join(terms))}")

    def _explained(self, text: str) -> str:
        """A text, with the equation of theta if it occurs."""
        return f"{text}, where {self.field.generator}" if "theta" in text else text


def exponents_of(characteristic: Sequence[Element], field: FunctionField) -> Exponents:
    """The exponents of a characteristic polynomial, given by powers."""
    rational, others, common = common_roots(field.rational_parts(characteristic))
    divisor = [field.number(c) for c in common.coeffs()]
    rest, _ = polynomial_quotient(characteristic, divisor, field)
    while len(rest) > 1 and not rest[-1]:
        rest.pop()
    return Exponents(tuple(sorted(rational.items())), tuple(others), tuple(rest), field)


def _roots(p: fmpq_poly) -> list[acb]:
    return [root for root, _ in cast("list[tuple[acb, int]]", p.complex_roots())]


def _at(element: Element, theta: acb) -> acb:
    polynomial: Any = getattr(element, "polynomial", None)
    return acb(ball(element)) if polynomial is None else evaluate(polynomial, theta)


def shown_number(z: acb) -> str:
    """A number with ten digits, which its ball proves."""
    real, imaginary = float(z.real.mid()), float(z.imag.mid())
    if abs(imaginary) <= float(z.imag.rad()):
        return f"{real:.10g}"
    if abs(real) <= float(z.real.rad()):
        return f"{imaginary:.10g}i"
    return f"{real:.10g}{imaginary:+.10g}i"


@dataclass(frozen=True)
class FreeConstant:
    """A free constant of a series.

    Attributes:
        name: C1, C2, ...
        exponent: The order at which it enters.
        direction: The element of the kernel that it multiplies.
    """

    name: str
    exponent: Fraction
    direction: tuple[Element, ...] = field(repr=False)


@dataclass(frozen=True)
class Resonance:
    """A rational exponent and what was found there.

    Attributes:
        exponent: The exponent r.
        multiplicity: How often it is an eigenvalue of K.
        kernel: The dimension of the kernel of K - r.
        conditions: Polynomials in the constants of lower orders that do not vanish and should, up to factors without
            zeros, so that "1" cannot be satisfied; None where they were not computed: of negative exponents, and after
            a logarithm.
    """

    exponent: Fraction
    multiplicity: int
    kernel: int
    conditions: tuple[str, ...] | None

    @property
    def has_jordan_block(self) -> bool:
        """Whether the kernel is too small."""
        return self.kernel < self.multiplicity

    def __str__(self) -> str:
        words = f"exponent {self.exponent}, multiplicity {self.multiplicity}, kernel of dimension {self.kernel}"
        if self.conditions is None:
            return words
        return f"{words}, {'not solvable' if self.conditions else 'solvable'}"


@dataclass
class Expansion:
    r"""The series of a balance with symbols for its free constants."""

    local: LocalField  # the vector field over the field of the balance
    denominator: int  # q, the series being one in $\tau^{1/q}$
    coefficients: list[list[Polynomial]]  # $c^{(j/q)}$ for j = 0, 1, ..., each a list of polynomials
    constants: list[FreeConstant] = field(default_factory=list[FreeConstant])
    resonances: list[Resonance] = field(default_factory=list[Resonance])  # what was found at the rational exponents
    _products: dict[tuple[tuple[int, ...], int], Polynomial] = field(
        default_factory=dict[tuple[tuple[int, ...], int], Polynomial]
    )

    def right_hand_side(self, j: int) -> list[Polynomial]:
        """The terms of order j/q of the vector field, without those that are linear in the new coefficients."""
        found: list[Polynomial] = []
        for of_one in self.local.terms:
            total: Polynomial = {}
            for exponents, c, defect in of_one:
                order = j - defect * self.denominator
                if order < 0:
                    continue
                factors = tuple(i for i, k in enumerate(exponents) for _ in range(k))
                add_multiple(total, self._product(factors, int(order), j), c)
            found.append(total)
        return found

    def _product(self, factors: tuple[int, ...], order: int, at: int | None) -> Polynomial:
        """The coefficient of order/q of a product of coordinates; those of the order `at` count as zero."""
        if not factors:
            return {(): self.local.field.one} if not order else {}
        if at == order and len(factors) == 1:
            return {}
        if len(factors) == 1:
            return self.coefficients[order][factors[0]]
        key = (factors, order)
        if at != order and key in self._products:
            return self._products[key]
        total: Polynomial = {}
        for k in range(order + 1):
            if at == order and k == order:
                left = self._product(factors[:-1], order, at)
            else:
                left = self._product(factors[:-1], k, None)
            if not left or (at == order and order - k == order):
                continue
            right = self.coefficients[order - k][factors[-1]]
            for m, c in left.items():
                add_multiple(total, {_joined(m, other): d for other, d in right.items()}, c)
        if at != order:
            self._products[key] = total
        return total


def _joined(left: Monomial, right: Monomial) -> Monomial:
    if not left:
        return right
    if not right:
        return left
    if len(left) < len(right):
        left, right = right, left
    return (*(a + b for a, b in zip(left, right, strict=False)), *left[len(right) :])


@dataclass(frozen=True)
class OverField:
    """The equations over a field, by elimination."""

    matrix: Matrix
    field: FunctionField

    def kernel(self, r: Fraction) -> int:
        """The dimension of the kernel of K - r."""
        return len(self.solved(r, 1, [[] for _ in self.matrix]).kernel)

    def solved(self, k: Fraction, multiplicity: int, right: Matrix) -> Solved:
        """The kernel, a solution and the conditions for it."""
        number, zero = self.field.number(k), self.field.zero
        shifted = [[(number if i == j else zero) - x for j, x in enumerate(row)] for i, row in enumerate(self.matrix)]
        return eliminated(shifted, right, self.field)


@dataclass(frozen=True)
class OverRing:
    """The equations over the coordinate ring of a family; a point shows which columns of projectors are independent."""

    ring: CoordinateRing
    resolvent: Resolvent
    point: Mapping[str, Element]
    point_field: FunctionField

    def _at(self, matrix: Matrix) -> Matrix:
        return [[polynomial_at(e.polynomial, self.point, self.point_field) for e in row] for row in matrix]

    def kernel(self, r: Fraction) -> int:
        """The dimension of the kernel of K - r: the multiplicity without Jordan blocks, else that at the point."""
        multiplicity = dict(self.resolvent.eigenvalues)[r]
        nilpotent = self.resolvent.nilpotent(r, self.resolvent.projector(r, multiplicity))
        if all(self.ring.vanishes(x) for row in nilpotent for x in row):
            return multiplicity
        kernel = OverField(self._at(self.resolvent.matrix), self.point_field).kernel(r)
        return min(kernel, multiplicity - 1)

    def solved(self, k: Fraction, multiplicity: int, right: Matrix) -> Solved:
        """The kernel, a solution and the conditions for it."""
        particular, conditions = self.resolvent.solved(k, multiplicity, right)
        zero = self.ring.number(0)
        conditions = [[zero if self.ring.vanishes(x) else x for x in row] for row in conditions]
        kernel: list[list[Element]] = []
        if multiplicity:
            n = self.kernel(k)
            if n < multiplicity:
                return Solved([[] for _ in range(n)], particular, conditions)
            projector = self.resolvent.projector(k, multiplicity)
            columns = list(map(list, zip(*projector, strict=True)))
            at = list(map(list, zip(*self._at(projector), strict=True)))
            kernel = [columns[j] for j in independent_columns(at, self.point_field, n)]
        return Solved(kernel, particular, conditions)


Equations: TypeAlias = OverField | OverRing
"""The equations (k - K) c = R of a balance."""


def expand(local: LocalField, point: Sequence[Element], equations: Equations, exponents: Exponents) -> Expansion:
    """Follow the series of a balance up to its largest rational exponent, or to the first logarithm."""
    defects = [defect for of_one in local.terms for _, _, defect in of_one]
    rational = [r for r, _ in exponents.rational]
    q = lcm(*(x.denominator for x in (*defects, *(r for r in rational if r > 0))), 1)
    start: list[Polynomial] = [{(): c} if c else {} for c in point]
    series = Expansion(local, q, [start])
    for r, multiplicity in exponents.rational:
        if r <= 0:
            series.resonances.append(Resonance(r, multiplicity, equations.kernel(r), None))
    last = max((r for r in rational if r > 0), default=Fraction(0))
    ended = False
    for j in range(1, int(last * q) + 1):
        checkpoint("a series")
        order = Fraction(j, q)
        multiplicity = exponents.multiplicity(order)
        if ended:
            if multiplicity:
                series.resonances.append(Resonance(order, multiplicity, equations.kernel(order), None))
            continue
        ended = not _step(series, equations, order, multiplicity)
    return series


def _step(series: Expansion, equations: Equations, order: Fraction, multiplicity: int) -> bool:
    """Find the coefficients of one order; whether the series goes on without a logarithm."""
    numbers = series.local.field
    right = series.right_hand_side(len(series.coefficients))
    monomials = sorted({m for p in right for m in p}, key=lambda m: (sum(m), m))
    zero = numbers.number(0)
    columns = [[p.get(m, zero) for m in monomials] for p in right]
    found = equations.solved(order, multiplicity, columns)
    coefficients: list[Polynomial] = [
        {m: c for m, c in zip(monomials, row, strict=True) if c} for row in found.particular
    ]
    if multiplicity:
        texts = (condition_text(monomials, row, numbers) for row in found.conditions)
        conditions = tuple(dict.fromkeys(text for text in texts if text is not None))
        series.resonances.append(Resonance(order, multiplicity, len(found.kernel), conditions))
        if conditions or len(found.kernel) < multiplicity:
            return False
        for vector in found.kernel:
            name = f"C{len(series.constants) + 1}"
            power = (*(0,) * len(series.constants), 1)
            series.constants.append(FreeConstant(name, order, tuple(vector)))
            for p, v in zip(coefficients, vector, strict=True):
                if v:
                    p[power] = v
    series.coefficients.append(coefficients)
    return True


def condition_text(monomials: Sequence[Monomial], row: Sequence[Element], field: FunctionField) -> str | None:
    """A condition on the free constants and the parameters as text, None if it holds identically, "1" if it cannot.

    A text is 0 where the condition holds.  Factors that do not change where that is are left out.
    """
    terms = [(m, c) for m, c in zip(monomials, row, strict=True) if c]
    if not terms:
        return None
    if len(terms) == 1:
        ((m, c),) = terms
        zeros = field.zeros(c)
        factors = [f"C{k + 1}" for k, e in enumerate(m) if e]
        if zeros == "1":
            return "*".join(factors) or zeros
        return "*".join([f"({zeros})" if factors and " " in zeros else zeros, *factors])
    if not field.parameters:  # another coefficient than 1 is a number, by which the condition is divided
        scale = field.inverse(terms[-1][1])
        terms = [(m, c * scale) for m, c in terms]
    texts: list[str] = []
    for m, c in terms:
        power = "*".join(f"C{k + 1}" + (f"^{e}" if e > 1 else "") for k, e in enumerate(m) if e)
        text = field.text(c)
        whole = text if text.lstrip("-").isalnum() else f"({text})"
        texts.append(power if power and text == "1" else f"{whole}*{power}" if power else text)
    return " + ".join(texts)
