r"""Commuting integrals among the polynomials of degree two in known ones: the square of an angular momentum, say.

Where the integrals $g_i$ do not commute, combinations $Q = \sum a_i g_i + \sum b_{ij} g_i g_j$ may.  That Q commutes
with given functions is linear in the coefficients.  A chain is built: functions that commute with all $g_i$, then
one of these, then functions that commute with all $g_i$ that commute with it, and so on.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, combinations_with_replacement
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import transposed
from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.algebra.linear_algebra import nullspace
from liepoisson.algebra.sparse_polynomials import Polynomial, add_multiple, multiply
from liepoisson.integrability.algebraic_functions import algebraic_equations, is_algebraic
from liepoisson.integrability.completeness import fields_rank
from liepoisson.integrability.level import Level, level_of

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.system import System

_MOST_GENERATORS = 15
_MOST_TERMS = 3000
"""Of a product of two integrals."""
_MOST_CHAINS = 60
"""Linear systems that are solved before the search is given up."""

Combination = dict[int, Any]
"""Coefficients by the number of a product."""


def commuting_combinations(system: System, integrals: Mapping[str, Expr], rank: int) -> list[tuple[Expr, Expr]]:
    """As many commuting functions with independent vector fields as half the rank, H first; empty if none are found.

    Each comes with the polynomial that it is in the names of the integrals.
    """
    from sympy import Symbol

    functions = {name: f for name, f in integrals.items() if name != "H" and is_algebraic(system, f)}
    if len(functions) < 2 or rank < 4:
        return []
    names = list(functions)[:_MOST_GENERATORS]
    algebra = _Algebra.of(system, [functions[name] for name in names])
    found = _Chains(system, algebra, rank // 2).longest()
    symbols: list[Any] = [Symbol(name) for name in names]
    chosen = [(algebra.combined(c, algebra.generators).expand(), algebra.combined(c, symbols)) for c in found]
    return [(system.hamiltonian, Symbol("H")), *chosen] if found else []


@dataclass(frozen=True)
class _Algebra:
    """Integrals, their products and brackets.

    Attributes:
        generators: The integrals, as expressions.
        polynomials: The same as polynomials.
        brackets: Of the pairs, by their numbers.
        products: The linearly independent ones among the generators and products of two, by the numbers of the factors.
        field: Where coefficients live.
        level: The relations of functions that are no polynomials.
    """

    generators: list[Expr]
    polynomials: list[Polynomial]
    brackets: dict[tuple[int, int], Polynomial]
    products: list[tuple[int, ...]]
    field: Coefficients
    level: Level

    @classmethod
    def of(cls, system: System, functions: list[Expr]) -> _Algebra:
        """The algebra of some integrals; brackets are divided by their common power of pi."""
        n = len(functions)
        scale: Any = to_sympy(Coefficients.containing([value for *_, value in system.bracket.entries()]).scale)
        pairs = list(combinations(range(n), 2))
        brackets = [(system.bracket(functions[i], functions[j]) / scale).expand() for i, j in pairs]
        equations, read = algebraic_equations(system, *functions, *brackets)
        field, level = equations.derivation.field, level_of(equations.derivation, equations.relations)
        remainders = [level.remainder(f) for f in read]
        table: dict[tuple[int, int], Polynomial] = {(i, i): {} for i in range(n)}
        for (i, j), bracket in zip(pairs, remainders[n:], strict=True):
            table |= {(i, j): bracket, (j, i): {m: -c for m, c in bracket.items()}}
        found = cls(functions, remainders[:n], table, [], field, level)
        products = [*((i,) for i in range(n)), *combinations_with_replacement(range(n), 2)]
        images = {p: found._product(p) for p in products if found._size(p) <= _MOST_TERMS}
        dependent = {max(v) for v in _null_vectors(list(images.values()), field)}
        found.products.extend(p for k, p in enumerate(images) if k not in dependent)
        return found

    def _size(self, product: tuple[int, ...]) -> int:
        sizes = [len(self.polynomials[i]) for i in product]
        return sizes[0] * sizes[-1] if len(sizes) > 1 else sizes[0]

    def _product(self, product: tuple[int, ...]) -> Polynomial:
        i, *others = product
        return (
            self.level.remainder(multiply(self.polynomials[i], self.polynomials[others[0]]))
            if others
            else self.polynomials[i]
        )

    def with_generators(self, combination: Combination) -> list[Polynomial]:
        """The brackets of each generator with a combination, by the rule of Leibniz."""
        found: list[Polynomial] = []
        for i in range(len(self.generators)):
            total: Polynomial = {}
            for k, coefficient in combination.items():
                add_multiple(
                    total, self._leibniz(self.products[k], [self.brackets[i, j] for j in self.products[k]]), coefficient
                )
            found.append(self.level.remainder(total))
        return found

    def _leibniz(self, product: tuple[int, ...], derivatives: Sequence[Polynomial]) -> Polynomial:
        """The derivative of a product, from those of its factors."""
        if len(product) == 1:
            return derivatives[0]
        total = multiply(self.polynomials[product[0]], derivatives[1])
        add_multiple(total, multiply(self.polynomials[product[1]], derivatives[0]), self.field.one)
        return total

    def commuting(self, with_generators: Sequence[Sequence[Polynomial]]) -> list[Combination]:
        """A basis of the combinations that commute with functions, given by the brackets of generators with them."""
        if not with_generators:
            return [{k: self.field.one} for k in range(len(self.products))]
        columns: list[dict[Any, Any]] = []
        for product in self.products:
            column: dict[Any, Any] = {}
            for number, brackets in enumerate(with_generators):
                image = self.level.remainder(self._leibniz(product, [brackets[i] for i in product]))
                column |= {(number, m): c for m, c in image.items()}
            columns.append(column)
        return sorted(_null_vectors(columns, self.field), key=len)

    def combined(self, combination: Combination, generators: Sequence[Expr]) -> Expr:
        """A combination of products of the generators, or of their names."""
        from sympy import Add, Mul

        terms = [
            Mul(self.field.to_sympy(c), *(generators[i] for i in self.products[k])) for k, c in combination.items()
        ]
        return Add(*terms)


class _Chains:
    """A search, depth first, for a chain of commuting combinations."""

    def __init__(self, system: System, algebra: _Algebra, n: int) -> None:
        self.system, self.algebra, self.n = system, algebra, n
        self.left = _MOST_CHAINS

    def longest(self) -> list[Combination]:
        """As many as are wanted with H; empty if they are not found."""
        return self._extended([], [])

    def _extended(self, chosen: list[Combination], brackets: list[list[Polynomial]]) -> list[Combination]:
        """The chain with further functions; `brackets` are those of the generators with what was chosen."""
        algebra = self.algebra
        while len(chosen) < self.n - 1 and self.left > 0:
            self.left -= 1
            free = [i for i in range(len(algebra.generators)) if not any(one[i] for one in brackets)]
            of_free = [[algebra.brackets[j, i] for j in range(len(algebra.generators))] for i in free]
            central = next(self._further(chosen, algebra.commuting([*brackets, *of_free])), None)
            if central is None:
                break
            chosen, brackets = [*chosen, central], [*brackets, algebra.with_generators(central)]
        if len(chosen) == self.n - 1:
            return chosen
        for further in self._further(chosen, algebra.commuting(brackets)):
            if self.left <= 0:
                break
            if found := self._extended([*chosen, further], [*brackets, algebra.with_generators(further)]):
                return found
        return []

    def _further(self, chosen: Sequence[Combination], candidates: Sequence[Combination]) -> Iterator[Combination]:
        """Those of the candidates that are independent of H and of what was chosen."""
        algebra = self.algebra
        known = [self.system.hamiltonian, *(algebra.combined(c, algebra.generators) for c in chosen)]
        for candidate in candidates:
            if fields_rank(self.system, [*known, algebra.combined(candidate, algebra.generators)]) > len(known):
                yield candidate


def _null_vectors(columns: Sequence[Mapping[Any, Any]], field: Coefficients) -> list[Combination]:
    return list(nullspace(transposed(columns), len(columns), field).vectors)
