r"""The matrix $J_{ij}(x)$ as SymPy expressions, from the structure constants of g and the tensor of A."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.exact_numbers import Exact, is_zero, product_of, to_sympy
from liepoisson.inputs.deadline import checkpoint

if TYPE_CHECKING:
    from sympy import Expr, Matrix, Symbol

    from liepoisson.formula.tensors import Brackets
    from liepoisson.structure.extension import Extension

Term: TypeAlias = "tuple[int, int, int, Exact]"
"""(i, j, m, c): the summand $c\\,x_m$ of $J_{ij}$."""


def linear_terms(n: int, brackets: Brackets, extension: Extension) -> tuple[Term, ...]:
    r"""All terms of the bracket of g (x) A, $J = -W_\lambda{}^{\mu\nu} c_{ij}{}^k x_{\lambda k}$, g of dimension n."""
    W = extension.tensor
    labels = range(extension.dimension)
    products = [
        (mu, nu, lam, W[lam][mu][nu]) for mu, nu, lam in product(labels, repeat=3) if not is_zero(W[lam][mu][nu])
    ]
    terms: list[Term] = []
    for (i, j), row in brackets.items():
        for k, c in row.items():
            for mu, nu, lam, w in products:
                value = product_of(w, c)
                terms.append((mu * n + i, nu * n + j, lam * n + k, -value))
                terms.append((mu * n + j, nu * n + i, lam * n + k, value))
    return tuple(sorted(terms, key=lambda term: term[:3]))


@dataclass(frozen=True)
class PoissonMatrix:
    """The entries of the Poisson tensor as expressions in the coordinates.

    Attributes:
        variables: The coordinates.
        terms: The linear part, both orders of i and j.
        constant: The constant part by (i, j) with i < j.
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
            rates.append(expand(rate) if self.terms or rate.is_polynomial(*self.variables) else rate)
        return tuple(rates)

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
