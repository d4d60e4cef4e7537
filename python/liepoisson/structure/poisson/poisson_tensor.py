r"""Poisson tensors, $J_{ij}(x) = \{x_i, x_j\} = \sum_m c_{ij}{}^m x_m + k_{ij}$, sparse and over an exact field.

The $c_{ij}{}^m$ are coefficients of J: those of $[e_i, e_j]$ enter with a minus, in `linear_terms`.

A constant part k is one more term of the sum, with the constant coordinate $x_{-1} = 1$: J is then a linear tensor on
the central extension of the Lie algebra by the cocycle k, restricted to where the central coordinate is 1.

`PoissonMatrix` is $J_{ij}(x)$ as SymPy expressions, from the structure constants of g and the tensor of A.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations
from random import Random
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import Coefficient, Exact, product_of, to_sympy
from liepoisson.algebra.linear_algebra import rank, rank_mod, solve
from liepoisson.algebra.residues import PRIME, Residues
from liepoisson.inputs.deadline import checkpoint

if TYPE_CHECKING:
    from sympy import Expr, Matrix, Symbol

    from liepoisson.formula.tensors import Rows

CONSTANT = -1
"""The index of the constant coordinate, 1; a list of coordinates with a 1 behind them has it at this index."""

SEEDS = range(1, 21)
"""Of random points to try; one is enough unless a denominator vanishes there."""


@dataclass(frozen=True)
class GenericRank:
    """The rank of the tensor at a random point modulo a prime, a lower bound of the rank at a generic point.

    Attributes:
        rank: The bound; it is the generic rank unless the point was unlucky, with probability below N / 2^60.
        residues: Where parameters and irrational numbers went.
        point: The coordinates, integers modulo `residues.p`.
    """

    rank: int
    residues: Residues
    point: tuple[int, ...]


class Ranked:
    """What has the rank of a tensor from its matrices at points: linear ones, and those of any degree."""

    dimension: int
    field: Coefficients

    def at(self, point: Sequence[Any]) -> list[dict[int, Any]]:
        """The matrix at a point whose coordinates are elements of the field, as sparse rows."""
        raise NotImplementedError

    def rows_modulo(self, point: Sequence[int], residues: Residues) -> list[dict[int, int]]:
        """The matrix at a point modulo the prime of the residues.

        Raises:
            ZeroDivisionError: a denominator vanishes there.
        """
        raise NotImplementedError

    @cached_property
    def generic_rank(self) -> GenericRank | None:
        """The rank at a random point modulo a prime; None if the field has no images modulo primes."""
        for seed in SEEDS:
            residues = self.field.residues(seed)
            if residues is None:
                return None
            random = Random(seed)
            point = tuple(random.randrange(1, PRIME) for _ in range(self.dimension))
            try:
                rows = self.rows_modulo(point, residues)
            except ZeroDivisionError:
                continue
            return GenericRank(rank_mod(rows, self.dimension, residues.p), residues, point)
        return None

    @cached_property
    def rank_at_a_point(self) -> int:
        """The rank at one random point: a lower bound of the generic rank, and almost surely equal to it."""
        if self.generic_rank is not None:
            return self.generic_rank.rank
        random = Random(1)
        return rank(self.at([self.field.number(random.randrange(1, 100)) for _ in range(self.dimension)]), self.field)


@dataclass(frozen=True)
class LinearPoissonTensor(Ranked):
    """A matrix of linear forms in the coordinates and the constant coordinate.

    Attributes:
        dimension: Number N of coordinates.
        field: Where the coefficients live.
        rows: `rows[i][j]` lists the pairs (m, c) with c the coefficient of $x_m$ in $J_{ij}$, only nonzero ones;
            m is `CONSTANT` for the constant part.
        block: Number of coordinates of a field; N if there is one field.
    """

    dimension: int
    field: Coefficients
    rows: tuple[dict[int, tuple[tuple[int, Any], ...]], ...]
    block: int

    degree: ClassVar[int] = 1

    @classmethod
    def of(
        cls, dimension: int, terms: Iterable[tuple[int, int, int, Exact]], block: int | None = None
    ) -> LinearPoissonTensor:
        """The tensor with the given terms (i, j, m, c), J_ij and J_ji both listed."""
        given = list(terms)
        field = Coefficients.containing(c for *_, c in given)
        elements = {c: field.read(c) for *_, c in given}
        read = ((i, j, m, elements[c]) for i, j, m, c in given)
        return cls._collected(dimension, field, read, block or dimension)

    @classmethod
    def _collected(
        cls, dimension: int, field: Coefficients, terms: Iterable[tuple[int, int, int, Any]], block: int
    ) -> LinearPoissonTensor:
        rows: list[dict[int, tuple[tuple[int, Any], ...]]] = [{} for _ in range(dimension)]
        for i, j, m, element in terms:
            if element:
                rows[i][j] = (*rows[i].get(j, ()), (m, element))
        return cls(dimension, field, tuple(rows), block)

    @cached_property
    def is_homogeneous(self) -> bool:
        """Whether there is no constant part."""
        return all(m != CONSTANT for *_, m, _ in self.terms())

    def terms(self) -> Iterator[tuple[int, int, int, Any]]:
        """All (i, j, m, c), both orders of i and j."""
        return ((i, j, m, c) for i, row in enumerate(self.rows) for j, form in row.items() for m, c in form)

    def restricted(self, kept: Sequence[int]) -> LinearPoissonTensor:
        """The tensor of the kept coordinates, those of whole fields, where all the others vanish.

        This is the bracket of a Poisson submanifold when the others span an ideal.
        """
        place = {CONSTANT: CONSTANT} | {old: new for new, old in enumerate(kept)}
        inside = ((i, j, m, c) for i, j, m, c in self.terms() if i in place and j in place and m in place)
        moved = ((place[i], place[j], place[m], c) for i, j, m, c in inside)
        return self._collected(len(kept), self.field, moved, self.block)

    def at(self, point: Sequence[Any]) -> list[dict[int, Any]]:
        """The matrix at a point whose coordinates are elements of the field, as sparse rows."""
        values = [*point, self.field.one]
        return [
            {j: value for j, form in row.items() if (value := _combination(form, values)) is not None and value}
            for row in self.rows
        ]

    def rows_modulo(self, point: Sequence[int], residues: Residues) -> list[dict[int, int]]:
        """The matrix at a point modulo the prime of the residues."""
        values = (*point, 1)
        # By identity: a few structure constants occur again and again.
        distinct = {id(c): c for row in self.rows for form in row.values() for _, c in form}
        images = {key: residues(c) for key, c in distinct.items()}
        return [{j: sum(images[id(c)] * values[m] for m, c in form) for j, form in row.items()} for row in self.rows]


def potential_of_constant_part(tensor: LinearPoissonTensor) -> tuple[Exact, ...] | None:
    r"""A solution of $\sum_m c_{ij}{}^m \xi_m = k_{ij}$ for all i, j, shape (N,), or None if there is none."""
    pairs = [(i, j) for i, row in enumerate(tensor.rows) for j in row if i < j]
    number = {pair: row for row, pair in enumerate(pairs)}
    columns: list[dict[int, Any]] = [{} for _ in range(tensor.dimension + 1)]
    for i, j, m, c in tensor.terms():
        if i < j:
            column, row = columns[m], number[i, j]
            column[row] = column[row] + c if row in column else c
    nonzero = [{row: c for row, c in column.items() if c} for column in columns]
    found = solve(nonzero[:-1], nonzero[-1], tensor.field)
    return None if found is None else tuple(tensor.field.write(value) if value else Fraction(0) for value in found)


def _combination(form: tuple[tuple[int, Any], ...], point: Sequence[Any]) -> Any:
    total: Any = None
    for m, c in form:
        term = c * point[m]
        total = term if total is None else total + term
    return total


Term: TypeAlias = "tuple[int, int, int, Exact]"
"""(i, j, m, c): the summand $c\\,x_m$ of $J_{ij}$."""


def linear_terms(n: int, brackets: Rows, products: Rows) -> list[tuple[int, int, int, Coefficient]]:
    r"""All terms of the bracket of g (x) A, $J = -W_\lambda{}^{\mu\nu} c_{ij}{}^k x_{\lambda k}$.

    Args:
        n: The dimension of g.
        brackets: Its structure constants.
        products: Those of A, in one order where they commute.
    """
    both = [(mu, nu, lam, w) for (mu, nu), row in products.items() for lam, w in row.items()]
    both += [(nu, mu, lam, w) for mu, nu, lam, w in both if (nu, mu) not in products]
    terms: list[tuple[int, int, int, Coefficient]] = []
    made: dict[tuple[int, int], tuple[Coefficient, Coefficient]] = {}  # a few numbers occur again and again
    for (i, j), row in brackets.items():
        for k, c in row.items():
            for mu, nu, lam, w in both:
                key = id(w), id(c)
                if key not in made:
                    value = product_of(w, c)
                    made[key] = value, -value
                value, opposite = made[key]
                terms.append((mu * n + i, nu * n + j, lam * n + k, opposite))
                terms.append((mu * n + j, nu * n + i, lam * n + k, value))
    return sorted(terms, key=lambda term: term[:3])


@dataclass(frozen=True)
class PoissonMatrix:
    """The entries of the Poisson tensor as expressions in the coordinates.

    Attributes:
        variables: The coordinates.
        terms: The linear part, both orders of i and j.
        constant: The constant part by (i, j) with i < j; or all entries, where these are functions of the coordinates.
    """

    variables: tuple[Symbol, ...]
    terms: tuple[Term, ...]
    constant: Mapping[tuple[int, int], Exact]

    @cached_property
    def entries(self) -> dict[tuple[int, int], Expr]:
        """The nonzero entries."""
        from sympy import Add

        forms: dict[tuple[int, int], list[Expr]] = {}
        for i, j, m, c in self.terms:
            forms.setdefault((i, j), []).append(to_sympy(c) * self.variables[m])
        for (i, j), c in self.constant.items():
            forms.setdefault((i, j), []).append(to_sympy(c))
            forms.setdefault((j, i), []).append(-to_sympy(c))
        return {pair: Add(*terms) for pair, terms in forms.items()}

    @cached_property
    def matrix(self) -> Matrix:
        """All entries, shape (N, N)."""
        from sympy import zeros

        J: Any = zeros(len(self.variables), len(self.variables))
        for pair, form in self.entries.items():
            J[pair] = form
        return J

    def times(self, gradient: Sequence[Expr]) -> tuple[Expr, ...]:
        r"""$J \nabla h$, expanded; where J is constant, only polynomials are."""
        from sympy import Add, expand

        sums: list[list[Expr]] = [[] for _ in self.variables]
        for (i, j), form in self.entries.items():
            if gradient[j] != 0:
                sums[i].append(form * gradient[j])
        rates: list[Expr] = []
        for terms in sums:
            checkpoint("the equations of motion")
            rate: Any = Add(*terms)
            is_expanded = not self._is_constant or rate.is_polynomial(*self.variables)
            rates.append(expand(rate) if is_expanded else rate)
        return tuple(rates)

    @cached_property
    def _is_constant(self) -> bool:
        functions = (c for c in self.constant.values() if not isinstance(c, Fraction))
        return not self.terms and not any(c.free_symbols & {*self.variables} for c in functions)

    def jacobi_residuals(self) -> dict[tuple[Symbol, Symbol, Symbol], Expr]:
        r"""$\{\{x_i, x_j\}, x_k\}$ + cyclic for all i < j < k."""
        from sympy import Add

        x = self.variables
        slopes: dict[tuple[int, int], list[tuple[int, Expr]]] = {}
        for i, j, m, c in self.terms:
            slopes.setdefault((i, j), []).append((m, to_sympy(c)))

        def nested(i: int, j: int, k: int) -> list[Expr]:
            return [slope * self.entries[m, k] for m, slope in slopes.get((i, j), []) if (m, k) in self.entries]

        return {
            (x[i], x[j], x[k]): Add(*nested(i, j, k), *nested(j, k, i), *nested(k, i, j)).expand()
            for i, j, k in combinations(range(len(x)), 3)
        }
