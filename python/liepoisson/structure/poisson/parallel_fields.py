r"""Polynomials where two fields are parallel: $u = s\,n$, $v = t\,n$ with any vector n and numbers s, t."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.echelon import Echelon, transposed
from liepoisson.algebra.linear_algebra import nullspace
from liepoisson.algebra.sparse_polynomials import Monomial, Polynomial
from liepoisson.structure.poisson.casimir_search import CasimirSearch
from liepoisson.structure.poisson.leading_monomials import size

if TYPE_CHECKING:
    from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor

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
