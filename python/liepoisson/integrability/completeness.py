r"""When are there enough integrals?  Two theorems, and their hypotheses checked exactly.

On a leaf of dimension 2n:

* Liouville and Arnold [arnold1989]: n integrals that commute with each other and are independent.  A compact connected
  component of a common level set on which they are independent is a torus of dimension n, on which the motion is
  linear.
* Mishchenko and Fomenko [mishchenko1978b], for functions in place of a Lie algebra [nekhoroshev1972, fasso2005]: k
  independent integrals that are closed under the bracket, $\{f_i, f_j\} = P_{ij}(f)$, with
  $k + \operatorname{corank} P = 2n$.  A compact connected component of a common level set on which they are independent
  and P has its generic rank is a torus of dimension $\operatorname{corank} P = 2n - k$, on which the motion is linear.

Independence is that of the Hamiltonian vector fields, at a point modulo a prime, which proves it for generic points.
On one leaf brackets vanish that are in the ideal of its equations, and the point is one of it.
The brackets are written as polynomials in the integrals and Casimirs, which is an identity of polynomials, and the rank
of P is that over the field of rational functions of them.  Compactness is not examined.

Where the integrals $g_i$ do not commute, combinations $Q = \sum a_i g_i + \sum b_{ij} g_i g_j$ may, such as the square
of an angular momentum.  That Q commutes with given functions is linear in the coefficients.  A chain is built:
functions that commute with all $g_i$, then one of these, then functions that commute with all $g_i$ that commute with
it, and so on.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from itertools import combinations, combinations_with_replacement
from math import prod
from typing import Any

from sympy import Add, Expr, Integer, Mul, Poly, Symbol
from sympy.polys.matrices import DomainMatrix

from liepoisson.algebra.coefficients import Coefficients, check_degree
from liepoisson.algebra.echelon import transposed
from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.algebra.linear_algebra import nullspace, rank_mod, solve
from liepoisson.algebra.sparse_polynomials import Polynomial, add_multiple, multiply, value_at
from liepoisson.integrability.algebraic_functions import algebraic_equations, is_algebraic
from liepoisson.integrability.derivation import Level, level_of
from liepoisson.integrability.search import modular, point_on_level, residues_of
from liepoisson.model.system import System
from liepoisson.structure.trace import traces_in

_MOST_PRIMES = 2
"""Primes of which one may be unlucky: modulo it a rank drops."""
_MOST_PRODUCTS = 2000
"""Products of integrals of which a bracket may be a sum."""


@dataclass(frozen=True)
class ClosedIntegrals:
    """Independent integrals that are closed under the bracket, as many as the theorem of Mishchenko and Fomenko wants.

    Attributes:
        names: The integrals.
        corank: Of the matrix of their brackets, the dimension of the tori.
        brackets: Those that do not vanish, as polynomials in the names of integrals and Casimirs.
    """

    names: tuple[str, ...]
    corank: int
    brackets: dict[tuple[str, str], Expr] = field(hash=False)


def are_integrals(system: System, functions: Sequence[Expr]) -> list[bool]:
    """Which functions are constant along the motion, exactly."""
    return _vanish(system, _brackets(system, [(f, system.hamiltonian) for f in functions]))


def are_in_involution(system: System, functions: Sequence[Expr], on: Sequence[Expr] = ()) -> bool:
    """Whether functions commute with each other, exactly; on a leaf, if its brackets are in the ideal of the equations.

    Args:
        on: Functions that vanish on the leaf, such as Casimirs less their values.
    """
    return all(_vanish(system, _brackets(system, combinations(functions, 2)), on))


def fields_rank(system: System, functions: Sequence[Expr], on: Sequence[Expr] = ()) -> int:
    """The rank of the Hamiltonian vector fields of functions at a random point modulo a prime, a lower bound.

    Args:
        on: Functions that vanish at the point.
    """
    scale = _scale(system)
    fields = [[(e / scale).expand() for e in system.bracket.vector_field(f)] for f in functions]
    equations, read = algebraic_equations(system, *(e for one in fields for e in one), *on)
    if not functions:
        return 0
    n, variables = len(system.variables), len(equations.derivation.variables)
    entries, zeros = read[: n * len(functions)], [*equations.relations, *read[n * len(functions) :]]
    found = 0
    for skipped in range(_MOST_PRIMES):
        residues = residues_of(equations.derivation.field, (*entries, *zeros), skipped)
        p, point = residues.p, point_on_level(zeros, residues, variables)
        values = [value_at(modular(e, residues).items(), point) for e in entries]
        rows = [{k: v for k, v in enumerate(values[i : i + n]) if v} for i in range(0, len(values), n)]
        found = max(found, rank_mod(rows, n, p))
        if found == len(functions):
            break
    return found


def commuting_integrals(
    system: System, integrals: Mapping[str, Expr], rank: int, on: Sequence[Expr] = ()
) -> tuple[str, ...]:
    """Names of as many commuting integrals with independent vector fields as half the rank, H among them, if found.

    Args:
        on: Functions that vanish on the leaf that is meant.
    """
    names, n = list(integrals), rank // 2
    if len(names) < n or not n:
        return ()
    others = [pair for pair in combinations(names, 2) if "H" not in pair]
    zero = _vanish(system, _brackets(system, [(integrals[a], integrals[b]) for a, b in others]), on)
    commuting = {frozenset(pair) for pair, vanishes in zip(others, zero, strict=True) if vanishes}
    for chosen in combinations(names[1:], n - 1):
        if (
            all(frozenset(pair) in commuting for pair in combinations(chosen, 2))
            and fields_rank(system, [integrals[c] for c in ("H", *chosen)], on) == n
        ):
            return ("H", *chosen)
    return ()


def closed_integrals(system: System, integrals: Mapping[str, Expr], rank: int) -> ClosedIntegrals | None:
    """The integrals, if they are closed under the bracket and as many as the theorem wants."""
    # Casimirs that are traces of matrices are left out: written out they are long
    names, casimirs = list(integrals), [c for c in system.bracket.casimirs() if not traces_in(c)]
    pairs = list(combinations(names, 2))
    brackets = _brackets(system, combinations(integrals.values(), 2))
    if fields_rank(system, list(integrals.values())) < len(names):
        return None
    generators = {Symbol(name): f for name, f in integrals.items() if is_algebraic(system, f)}
    generators |= {Symbol(f"C{k}"): c for k, c in enumerate(casimirs, start=1)}
    written = as_polynomials(system, brackets, generators)
    if written is None:
        return None
    matrix = {pair: p for pair, p in zip(pairs, written, strict=True) if p != 0}
    corank = len(names) - _generic_rank(names, matrix, list(generators))
    if len(names) + corank != rank:
        return None
    return ClosedIntegrals(tuple(names), corank, {pair: (_scale(system) * p).expand() for pair, p in matrix.items()})


def _scale(system: System) -> Any:
    """The common power of pi of all brackets, as those of the sine algebra have; numbers are exact without it."""
    return to_sympy(Coefficients.containing([value for *_, value in system.bracket.entries()]).scale)


def _brackets(system: System, pairs: Iterable[tuple[Expr, Expr]]) -> list[Expr]:
    """The brackets of pairs of functions, expanded, divided by the common power of pi."""
    scale = _scale(system)
    return [(system.bracket(f, g) / scale).expand() for f, g in pairs]


def _vanish(system: System, functions: Sequence[Expr], on: Sequence[Expr] = ()) -> list[bool]:
    equations, read = algebraic_equations(system, *functions, *on)
    n = len(functions)
    level = level_of(equations.derivation, [*equations.relations, *read[n:]]) if on else equations.level
    return [not level.remainder(f) for f in read[:n]]


def as_polynomials(system: System, functions: Sequence[Expr], generators: Mapping[Any, Expr]) -> list[Expr] | None:
    """Functions as polynomials in generators of no higher degree; None if one is none."""
    equations, read = algebraic_equations(system, *functions, *generators.values())
    level, field = equations.level, equations.derivation.field
    remainders = [level.remainder(f) for f in read]
    targets, factors = remainders[: len(functions)], remainders[len(functions) :]
    degrees = [max(map(sum, f), default=0) for f in factors]
    highest = max((max(map(sum, f), default=0) for f in targets), default=0)
    products: list[tuple[int, Any, Polynomial]] = [
        (0, Integer(1), {(0,) * len(equations.derivation.variables): field.one})
    ]
    for symbol, degree, factor in zip(generators, degrees, factors, strict=True):
        for d, name, product in products:  # grows while it is read: powers of the factor
            if degree and d + degree <= highest:
                if len(products) == _MOST_PRODUCTS:
                    return None
                products.append((d + degree, name * symbol, level.remainder(multiply(product, factor))))
    rows: dict[Any, int] = {}
    columns = [{rows.setdefault(m, len(rows)): c for m, c in f.items()} for _, _, f in products]
    found: list[Expr] = []
    for target in targets:
        if not all(m in rows for m in target):
            return None
        solution = solve(columns, {rows[m]: c for m, c in target.items()}, field)
        if solution is None:
            return None
        terms = [Mul(field.to_sympy(c), name) for c, (_, name, _) in zip(solution, products, strict=True) if c]
        found.append(Add(*terms))
    return found


def _generic_rank(names: Sequence[str], matrix: Mapping[tuple[str, str], Expr], generators: Sequence[Any]) -> int:
    """The rank of the antisymmetric matrix over the field of rational functions of the generators."""
    if not matrix:
        return 0
    check_degree(matrix.values())
    domain = Poly(sum(matrix.values()) + sum(generators), *generators, extension=True).domain
    fractions: Any = domain.get_field().frac_field(*generators)
    size = len(names)
    entries = [[fractions.zero] * size for _ in names]
    for (a, b), value in matrix.items():
        i, j = names.index(a), names.index(b)
        entries[i][j] = fractions.from_sympy(value)
        entries[j][i] = -entries[i][j]
    return DomainMatrix(entries, (size, size), fractions).rank()


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
    functions = {name: f for name, f in integrals.items() if name != "H" and is_algebraic(system, f)}
    if len(functions) < 2 or rank < 4:
        return []
    names = list(functions)[:_MOST_GENERATORS]
    algebra = _Algebra.of(system, [functions[name] for name in names])
    found = _longest_chain(system, algebra, rank // 2)
    symbols: list[Any] = [Symbol(name) for name in names]
    chosen = [(algebra.combined(c, algebra.generators).expand(), algebra.combined(c, symbols)) for c in found]
    return [(system.hamiltonian, Symbol("H")), *chosen] if found else []


@dataclass(frozen=True)
class _Algebra:
    """Integrals, their products and brackets."""

    generators: list[Expr]  # the integrals, as expressions
    polynomials: list[Polynomial]  # the same as polynomials
    brackets: dict[tuple[int, int], Polynomial]  # of the pairs, by their numbers
    # the linearly independent ones among the generators and products of two, by the numbers of the factors
    products: list[tuple[int, ...]]
    field: Coefficients
    level: Level  # the relations of functions that are no polynomials

    @classmethod
    def of(cls, system: System, functions: list[Expr]) -> _Algebra:
        """The algebra of some integrals; brackets are divided by their common power of pi."""
        n = len(functions)
        pairs, brackets = list(combinations(range(n), 2)), _brackets(system, combinations(functions, 2))
        equations, read = algebraic_equations(system, *functions, *brackets)
        field, level = equations.derivation.field, equations.level
        remainders = [level.remainder(f) for f in read]
        table: dict[tuple[int, int], Polynomial] = {(i, i): {} for i in range(n)}
        for (i, j), bracket in zip(pairs, remainders[n:], strict=True):
            table |= {(i, j): bracket, (j, i): {m: -c for m, c in bracket.items()}}
        found = cls(functions, remainders[:n], table, [], field, level)
        products = [*((i,) for i in range(n)), *combinations_with_replacement(range(n), 2)]
        small = [p for p in products if prod(len(remainders[i]) for i in p) <= _MOST_TERMS]
        images = {p: level.remainder(reduce(multiply, (remainders[i] for i in p))) for p in small}
        dependent = {max(v) for v in _null_vectors(list(images.values()), field)}
        found.products.extend(p for k, p in enumerate(images) if k not in dependent)
        return found

    def with_generators(self, combination: Combination) -> list[Polynomial]:
        """The brackets of each generator with a combination, by the rule of Leibniz."""
        found: list[Polynomial] = []
        for i in range(len(self.generators)):
            total: Polynomial = {}
            for k, coefficient in combination.items():
                derivatives = [self.brackets[i, j] for j in self.products[k]]
                add_multiple(total, self._leibniz(self.products[k], derivatives), coefficient)
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
        to_sympy = self.field.to_sympy
        return Add(*(Mul(to_sympy(c), *(generators[i] for i in self.products[k])) for k, c in combination.items()))


def _longest_chain(system: System, algebra: _Algebra, n: int) -> list[Combination]:
    """A chain of commuting combinations, as many as are wanted with H, depth first; empty if they are not found."""
    left = _MOST_CHAINS

    def independent(chosen: Sequence[Combination], candidates: Sequence[Combination]) -> Iterator[Combination]:
        known = [system.hamiltonian, *(algebra.combined(c, algebra.generators) for c in chosen)]
        for candidate in candidates:
            if fields_rank(system, [*known, algebra.combined(candidate, algebra.generators)]) > len(known):
                yield candidate

    def extended(chosen: list[Combination], brackets: list[list[Polynomial]]) -> list[Combination]:
        """The chain with further functions; `brackets` are those of the generators with what was chosen."""
        nonlocal left
        places = range(len(algebra.generators))
        while len(chosen) < n - 1 and left > 0:
            left -= 1
            of_free = [[algebra.brackets[j, i] for j in places] for i in places if not any(one[i] for one in brackets)]
            central = next(independent(chosen, algebra.commuting([*brackets, *of_free])), None)
            if central is None:
                break
            chosen, brackets = [*chosen, central], [*brackets, algebra.with_generators(central)]
        if len(chosen) == n - 1:
            return chosen
        for further in independent(chosen, algebra.commuting(brackets)):
            if left <= 0:
                break
            if found := extended([*chosen, further], [*brackets, algebra.with_generators(further)]):
                return found
        return []

    return extended([], [])


def _null_vectors(columns: Sequence[Mapping[Any, Any]], field: Coefficients) -> list[Combination]:
    return list(nullspace(transposed(columns), len(columns), field).vectors)
