r"""The equations $(k - K)\,c = R$ without division by elements, where all eigenvalues of K are known rational numbers.

By the theorem of Cayley and Hamilton, what is needed are polynomials in K with rational coefficients. With the
characteristic polynomial $\chi = (x - r)^m\psi$ and $\varphi\psi\equiv1$ modulo $(x - r)^m$,

* the projector on the generalised eigenspace is $P_r = \varphi\psi(K)$, and there is no Jordan block if
  $(K - r)P_r = 0$;
* R is in the image of $r - K$, where there is none, if $P_r R = 0$, and $c = q(K)R$ is then a solution with
  $(r - x)\,q\equiv 1 - \varphi\psi$ modulo $\chi$;
* for k that is no eigenvalue, $q(K) = (k - K)^{-1}$ with $(k - x)\,q\equiv1$.

So this holds over rings, for all balances of a family at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq_poly

from liepoisson.algebra.matrices import product
from liepoisson.algebra.number_fields import as_fmpq
from liepoisson.integrability.painleve.coefficient_fields import Field
from liepoisson.integrability.painleve.linear import Matrix


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
    field: Field

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
