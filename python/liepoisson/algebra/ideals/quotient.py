r"""The algebra $A = \mathbb Q[x]/I$ of an ideal with finitely many complex zeros, as matrices.

A has the standard monomials of a Gröbner basis for a basis, and its dimension is the number of zeros with
multiplicities $\mu(\xi)$. Multiplication by f has the trace $\sum_\xi\mu(\xi)f(\xi)$, and the rank of the form
$(f,g)\mapsto\mathrm{Tr}(fg)$ is the number of distinct zeros.

References: [cox2005], chapters 2 and 4.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

from flint import fmpq, fmpq_mat, fmpq_poly

from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.groebner import GroebnerBasis
from liepoisson.algebra.ideals.limits import Budget, NotDecidedError
from liepoisson.algebra.sparse_polynomials import Monomial, of_exponents


class Quotient:
    """The algebra of an ideal of dimension 0.

    Args:
        basis: The Gröbner basis.
        budget: Where the work is accounted.

    Raises:
        NotDecidedError: there are more zeros than the limits allow.
    """

    def __init__(self, basis: GroebnerBasis, budget: Budget) -> None:
        self.ideal, self._budget = basis, budget
        if basis.degree > budget.limits.degree:
            raise NotDecidedError(
                f"not decided: {basis.degree} complex solutions, with multiplicities, are more than the "
                f"{budget.limits.degree} of the limits. Allow more with Limits(degree=...)."
            )
        self.monomials = basis.standard_monomials()
        self._place = {m: k for k, m in enumerate(self.monomials)}
        self.n = len(basis.names)

    @property
    def dimension(self) -> int:
        """The number of complex zeros with multiplicities."""
        return len(self.monomials)

    def vector(self, p: Poly) -> fmpq_mat:
        """The coordinates of a polynomial modulo the ideal, a column."""
        column = fmpq_mat(self.dimension, 1)
        for m, c in self.ideal.remainder(p, self._budget).terms():
            column[self._place[tuple(map(int, m))], 0] = c
        return column

    @cached_property
    def by_variables(self) -> list[fmpq_mat]:
        """The matrices of the multiplications by the variables; their columns are images."""
        context, d = self.ideal.context, self.dimension
        found: list[fmpq_mat] = []
        for k in range(self.n):
            matrix = fmpq_mat(d, d)
            for column, m in enumerate(self.monomials):
                above = (*m[:k], m[k] + 1, *m[k + 1 :])
                if above in self._place:
                    matrix[self._place[above], column] = fmpq(1)
                    continue
                for power, c in self.ideal.remainder(context.from_dict({above: 1}), self._budget).terms():
                    matrix[self._place[tuple(map(int, power))], column] = c
            found.append(matrix)
        return found

    def _words(self) -> int:
        return 1 + 2 * self.ideal.words

    @cached_property
    def _products(self) -> dict[Monomial, fmpq_mat]:
        """The coordinates of all products of two standard monomials."""
        d = self.dimension
        found: dict[Monomial, fmpq_mat] = {}
        for m in self.monomials:
            found[m] = fmpq_mat(d, 1)
            found[m][self._place[m], 0] = fmpq(1)
        wanted = {of_exponents(a, b) for a in self.monomials for b in self.monomials}
        for m in sorted(wanted, key=sum):
            self._column(m, found)
        return found

    def _column(self, m: Monomial, found: dict[Monomial, fmpq_mat]) -> fmpq_mat:
        """The coordinates of a monomial that is a variable times one that is simpler."""
        if m not in found:
            lower = [(k, (*m[:k], m[k] - 1, *m[k + 1 :])) for k in range(self.n) if m[k]]
            k, below = next(((k, b) for k, b in lower if b in found), lower[0])
            self._budget.spend(0.1 * self.dimension**2 * self._words(), "products in the quotient")
            found[m] = self.by_variables[k] * self._column(below, found)
        return found[m]

    @cached_property
    def traces(self) -> fmpq_mat:
        """The traces of the standard monomials, a row."""
        d = self.dimension
        row = fmpq_mat(1, d)
        for k, m in enumerate(self.monomials):
            total = fmpq(0)
            for j, other in enumerate(self.monomials):
                total += self._products[of_exponents(m, other)][j, 0]
            row[0, k] = total
        return row

    @cached_property
    def n_distinct(self) -> int:
        """The number of distinct complex zeros."""
        d = self.dimension
        self._budget.spend(0.02 * d**3 * self._words(), "the rank of the trace form")
        values = {m: (self.traces * column)[0, 0] for m, column in self._products.items()}
        entries = [values[of_exponents(a, b)] for a in self.monomials for b in self.monomials]
        return int(fmpq_mat(d, d, entries).rank())

    def multiplication(self, form: tuple[int, ...]) -> fmpq_mat:
        """The matrix of the multiplication by a linear form with these coefficients."""
        total = fmpq_mat(self.dimension, self.dimension)
        for c, matrix in zip(form, self.by_variables, strict=True):
            total = total + matrix * fmpq(c) if c else total
        return total

    def characteristic(self, matrix: fmpq_mat) -> fmpq_poly:
        r"""The characteristic polynomial of a multiplication by f, $\prod_\xi(T - f(\xi))^{\mu(\xi)}$."""
        self._budget.spend(0.003 * self.dimension**4 * self._words() + 50, "a characteristic polynomial")
        found: Any = matrix.charpoly()
        return found
