r"""Pfaffians of a linear Poisson tensor, and proofs that they vanish together only on a given set.

The rank of an antisymmetric matrix is less than r exactly where all Pfaffians of its principal blocks of size r vanish.

On the set where two fields are parallel, polynomials are taken at $u = s\,n$, $v = t\,n$ with any vector n.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from itertools import combinations, combinations_with_replacement
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.echelon import Echelon, transposed
from liepoisson.algebra.linear_algebra import nullspace, solve
from liepoisson.algebra.sparse_polynomials import Monomial, Polynomial
from liepoisson.structure.poisson.casimir_search import CasimirSearch
from liepoisson.structure.poisson.polynomials import multiply, size

if TYPE_CHECKING:
    from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor

_MAX_COORDINATES = 9  # 84 Pfaffians of size 6


class PfaffianIdeal:
    """The Pfaffians of one size.

    Args:
        tensor: The Poisson tensor.
        size: The size r of the principal blocks, even.
        block: Number of components of a field.  With more than nine coordinates only those blocks are taken that have
            the same two components of every field; this is for fields with three components.

    Attributes:
        generators: The nonzero Pfaffians.
        is_full: Whether all of this size are among them.
    """

    def __init__(self, tensor: LinearPoissonTensor, size: int, block: int) -> None:
        self.tensor, self.size = tensor, size
        N = tensor.dimension
        self.is_full = N <= _MAX_COORDINATES
        chosen: Iterable[tuple[int, ...]] = ()
        if self.is_full:
            chosen = combinations(range(N), size)
        elif block == 3 and size == 2 * (N // 3):
            chosen = (tuple(i for i in range(N) if i % 3 != left) for left in range(3))
        known: dict[tuple[int, ...], Polynomial] = {}
        self.generators: list[Polynomial] = [p for rows in chosen if (p := self._pfaffian(rows, known))]

    def contains_powers_of(self, equations: Sequence[Polynomial]) -> str | None:
        """Whether a power of each equation is a combination of the Pfaffians, with polynomials as coefficients.

        Returns:
            None if that was not found; else the assumption on parameters under which it holds ("" if there is none).
        """
        field, assumptions = self.tensor.field, set[str]()
        degree = self.size // 2
        for equation in equations:
            own = len(next(iter(equation)))
            power = -(-degree // own)
            target: Polynomial = {(): field.one}
            for _ in range(power):
                target = multiply(target, equation)
            columns = self._multiples(power * own - degree, sorted({i for m in target for i in m}))
            order: dict[Any, int] = {m: k for k, m in enumerate(sorted({m for c in (*columns, target) for m in c}))}
            numbered = [{order[m]: v for m, v in column.items()} for column in columns]
            found = solve(numbered, {order[m]: v for m, v in target.items()}, field)
            if found is None:
                return None
            assumptions |= {a for value in found if value and (a := self._assumption(value))}
        return ", ".join(sorted(assumptions))

    def _multiples(self, degree: int, variables: list[int]) -> list[Polynomial]:
        """The Pfaffians times all monomials of a degree in the given variables."""
        one = self.tensor.field.one
        monomials = list(combinations_with_replacement(variables, degree))
        return [multiply(p, {m: one}) for p in self.generators for m in monomials]

    def _assumption(self, coefficient: Any) -> str:
        """The condition under which a coefficient is defined: its denominator does not vanish."""
        field = self.tensor.field
        if not field.parameters or coefficient.denom.is_ground:
            return ""
        factors = coefficient.denom.factor_list()[1]
        return ", ".join(f"{factor.as_expr(*field.parameters)} != 0" for factor, _ in factors)

    def _pfaffian(self, rows: tuple[int, ...], known: dict[tuple[int, ...], Polynomial]) -> Polynomial:
        if not rows:
            return {(): self.tensor.field.one}
        if rows not in known:
            total: Polynomial = {}
            first, rest = rows[0], rows[1:]
            for k, partner in enumerate(rest):
                form = self.tensor.rows[first].get(partner)
                if form is None:
                    continue
                minor = self._pfaffian(rest[:k] + rest[k + 1 :], known)
                for monomial, value in multiply({(m,): c for m, c in form}, minor).items():
                    term = -value if k % 2 else value
                    total[monomial] = total[monomial] + term if monomial in total else term
            known[rows] = {m: c for m, c in total.items() if c}
        return known[rows]


def pfaffian_of(entry: Callable[[int, int], Any], *, zero: Any = 0, one: Any = 1) -> Callable[[tuple[int, ...]], Any]:
    """The Pfaffian of the block of some rows, of an antisymmetric matrix by its entries (i, j), i < j.

    By the expansion along the first row; each block is computed once.  Entries may be of any ring.
    """

    @cache
    def of(rows: tuple[int, ...]) -> Any:
        if not rows:
            return one
        first, rest = rows[0], rows[1:]
        total = zero
        for k, partner in enumerate(rest):
            if factor := entry(first, partner):
                term = factor * of(rest[:k] + rest[k + 1 :])
                total = total - term if k % 2 else total + term
        return total

    return of


Blocks = Sequence[tuple[int, ...]]
"""The coordinates of the two fields."""


def vanish_on_parallel_fields(polynomials: Sequence[Polynomial], blocks: Blocks) -> bool:
    """Whether all polynomials vanish where the two fields are parallel."""
    return not any(_restricted(polynomial, blocks) for polynomial in polynomials)


def casimirs_on_parallel_fields(tensor: LinearPoissonTensor, blocks: Blocks) -> list[Polynomial]:
    r"""Quadratic polynomials with $J\nabla C = 0$ there, independent as functions on that set."""
    search = CasimirSearch(tensor)
    every = combinations_with_replacement(range(tensor.dimension), 2)
    monomials = sorted(every, key=lambda monomial: size(monomial, tensor.block))
    columns: list[dict[Any, Any]] = []
    for monomial in monomials:
        by_component: dict[int, Polynomial] = {}
        for (i, image), value in search.image({monomial: tensor.field.one}).items():
            by_component.setdefault(i, {})[image] = value
        restricted = ((i, _restricted(polynomial, blocks)) for i, polynomial in by_component.items())
        columns.append({(i, key): value for i, terms in restricted for key, value in terms.items()})
    vectors = nullspace(transposed(columns), len(monomials), tensor.field).vectors
    found: list[Polynomial] = []
    for candidate in search.sorted({monomials[c]: value for c, value in vector.items()} for vector in vectors):
        if _n_independent([*found, candidate], tensor, blocks) > len(found):
            found.append(candidate)
    return found


def _n_independent(polynomials: Sequence[Polynomial], tensor: LinearPoissonTensor, blocks: Blocks) -> int:
    restricted = [_restricted(polynomial, blocks) for polynomial in polynomials]
    order = {m: k for k, m in enumerate(sorted({m for p in restricted for m in p}))}
    return len(Echelon(tensor.field, ({order[m]: c for m, c in p.items()} for p in restricted)))


def _restricted(polynomial: Polynomial, blocks: Blocks) -> dict[tuple[int, int, Monomial], Any]:
    """The polynomial with s n and t n inserted: by the powers of s and t, and what is left (n in place of u)."""
    u, v = blocks
    to_n = dict(zip(v, u, strict=True))
    total: dict[tuple[int, int, Monomial], Any] = {}
    for monomial, value in polynomial.items():
        powers = sum(i in u for i in monomial), sum(i in v for i in monomial)
        key = (*powers, tuple(sorted(to_n.get(i, i) for i in monomial)))
        total[key] = total[key] + value if key in total else value
    return {key: value for key, value in total.items() if value}
