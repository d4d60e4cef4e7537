r"""The coordinate ring $\mathbb Q[c]/I$ of an algebraic set, and linear equations over it.

What is computed without division can be computed here, in normal forms modulo a Gröbner basis, at every point of the
set at once; no parametrisation of it is needed.

So are the equations $(k - K)\,c = R$, where all eigenvalues of K are known rational numbers. By the theorem of Cayley
and Hamilton, what is needed are polynomials in K with rational coefficients. With the characteristic polynomial
$\chi = (x - r)^m\psi$ and $\varphi\psi\equiv1$ modulo $(x - r)^m$,

* the projector on the generalised eigenspace is $P_r = \varphi\psi(K)$, and there is no Jordan block if
  $(K - r)P_r = 0$;
* R is in the image of $r - K$, where there is none, if $P_r R = 0$, and $c = q(K)R$ is then a solution with
  $(r - x)\,q\equiv 1 - \varphi\psi$ modulo $\chi$;
* for k that is no eigenvalue, $q(K) = (k - K)^{-1}$ with $(k - x)\,q\equiv1$.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq, fmpq_poly

from liepoisson.algebra.function_fields import FunctionField, coefficient_rows, constant_of
from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.groebner import GroebnerBasis
from liepoisson.algebra.ideals.limits import Budget
from liepoisson.algebra.ideals.operations import radical_contains
from liepoisson.algebra.matrices import Matrix, product
from liepoisson.algebra.number_fields import NumberField, Rational, as_fmpq
from liepoisson.errors import LiePoissonError


class DivisionError(LiePoissonError):
    """A division in a coordinate ring, which is no field."""


class CoordinateRing(FunctionField):
    """Polynomials modulo an ideal.  An element is false if it is in the ideal; `vanishes` looks at its zeros.

    Args:
        basis: The Gröbner basis of the ideal.
        is_prime: Whether it is prime, so that polynomials outside of it do not vanish on the set.
        independent: Coordinates that parametrise the set.
        degree: How many points there are for general values of these.
        budget: Where the work is accounted.
    """

    def __init__(
        self, basis: GroebnerBasis, *, is_prime: bool, independent: tuple[str, ...], degree: int, budget: Budget
    ) -> None:
        self.basis, self.is_prime, self.degree, self.budget = basis, is_prime, degree, budget
        self.parameters = independent
        self._normal: dict[tuple[int, ...], Poly] = {}

    def element(self, polynomial: Poly) -> RingElement:
        """The normal form of a polynomial."""
        total = polynomial * 0
        for m, c in polynomial.terms():
            key = tuple(int(k) for k in m)
            if key not in self._normal:
                self._normal[key] = self.basis.remainder(self.basis.context.from_dict({key: 1}), self.budget)
            total = total + self._normal[key] * c
        return RingElement(total, self)

    def vanishes(self, element: RingElement) -> bool:
        """Whether an element is zero at all points of the set."""
        p = element.polynomial
        return not p or (not self.is_prime and not p.is_constant() and radical_contains(self.basis, p, self.budget))

    def number(self, value: Rational) -> RingElement:
        """A rational number."""
        return RingElement(self.basis.context.constant(as_fmpq(value)), self)

    def inverse(self, element: RingElement) -> RingElement:
        """One over a number."""
        if not (value := self.rational(element)):
            raise DivisionError(f"a division by {element.polynomial}")
        return self.number(1 / value)

    def rational_parts(self, elements: Sequence[RingElement]) -> list[list[fmpq]]:
        """The coefficients of the monomials of the normal forms."""
        return coefficient_rows([e.polynomial for e in elements])

    def rational(self, element: RingElement) -> fmpq | None:
        """The number, if the function is constant."""
        return constant_of(element.polynomial)

    def text(self, element: RingElement) -> str:
        """The normal form."""
        return str(element.polynomial)

    def zeros(self, element: RingElement) -> str:
        """The normal form, unless it is a number."""
        return "1" if element.polynomial.is_constant() else self.text(element)


class RingElement:
    """A function on an algebraic set."""

    __slots__ = ("polynomial", "ring")

    def __init__(self, polynomial: Poly, ring: CoordinateRing) -> None:
        self.polynomial, self.ring = polynomial, ring

    def __bool__(self) -> bool:
        return bool(self.polynomial)

    def __add__(self, other: RingElement) -> RingElement:
        return RingElement(self.polynomial + other.polynomial, self.ring)

    def __sub__(self, other: RingElement) -> RingElement:
        return RingElement(self.polynomial - other.polynomial, self.ring)

    def __neg__(self) -> RingElement:
        return RingElement(-self.polynomial, self.ring)

    def __mul__(self, other: RingElement) -> RingElement:
        if self.polynomial.is_constant() or other.polynomial.is_constant():
            return RingElement(self.polynomial * other.polynomial, self.ring)
        return self.ring.element(self.polynomial * other.polynomial)


@dataclass(frozen=True)
class Resolvent:
    """A matrix with known rational eigenvalues.

    Attributes:
        matrix: K.
        eigenvalues: With multiplicities.
        field: The ring of its entries.
    """

    matrix: Matrix
    eigenvalues: tuple[tuple[Fraction, int], ...]
    field: NumberField

    def _factor(self, r: Fraction, power: int) -> fmpq_poly:
        return fmpq_poly([-as_fmpq(r), 1]) ** power

    def _without(self, r: Fraction) -> fmpq_poly:
        """The characteristic polynomial without its factors x - r."""
        found = fmpq_poly([1])
        for s, m in self.eigenvalues:
            if s != r:
                found = found * self._factor(s, m)
        return found

    def _projecting(self, r: Fraction, m: int) -> fmpq_poly:
        psi = self._without(r)
        _, inverse, _ = (psi % self._factor(r, m)).xgcd(self._factor(r, m))
        return psi * (inverse % self._factor(r, m))

    def applied(self, polynomial: fmpq_poly, vectors: Matrix) -> Matrix:
        """A polynomial in K times the columns of a matrix."""
        found = [[self.field.zero for _ in row] for row in vectors]
        for c in reversed(polynomial.coeffs()):
            number = self.field.number(c)
            found = product(self.matrix, found, self.field.zero)
            if c:
                found = [
                    [x + number * y if y else x for x, y in zip(row, other, strict=True)]
                    for row, other in zip(found, vectors, strict=True)
                ]
        return found

    def projector(self, r: Fraction, m: int) -> Matrix:
        """The projector on the generalised eigenspace of an eigenvalue of multiplicity m."""
        n = len(self.matrix)
        unit = [[self.field.number(int(i == j)) for j in range(n)] for i in range(n)]
        return self.applied(self._projecting(r, m), unit)

    def nilpotent(self, r: Fraction, projector: Matrix) -> Matrix:
        """K - r times the projector, zero if there is no Jordan block."""
        number = self.field.number(r)
        return [
            [x - number * y for x, y in zip(row, other, strict=True)]
            for row, other in zip(product(self.matrix, projector, self.field.zero), projector, strict=True)
        ]

    def solved(self, k: Fraction, m: int, right: Matrix) -> tuple[Matrix, Matrix]:
        """A solution of (k - K) c = R, and what must vanish if there is one; m is the multiplicity of k."""
        if not right or not right[0]:
            return [[] for _ in right], []
        if not m:
            whole = self._without(k)
            _, q, _ = fmpq_poly([as_fmpq(k), -1]).xgcd(whole)
            # xgcd makes the common divisor, a number, equal to 1
            return self.applied(q % whole, right), []
        projecting = self._projecting(k, m)
        q = (1 - projecting) // fmpq_poly([as_fmpq(k), -1])
        return self.applied(q, right), self.applied(projecting, right)
