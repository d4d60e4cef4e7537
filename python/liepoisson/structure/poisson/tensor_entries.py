r"""Poisson tensors by the formulas of their entries: Jacobi identity, rank and Casimirs, exact where it can be decided.

The entries, their derivatives and what is compared with them are elements of the field that they generate with the
coordinates and the parameters: of rational functions, in which equality is decided, or of rational functions in
further generators such as sin(x1), of which only "is zero" is a proof.  Where that leaves an identity open it is tried
at random points, in as many digits as its numbers need.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations
from math import lcm
from random import Random
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.decimals import HAVE_VALUES, decimals, refuse_sizes, round_off, vanishes_at_all
from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.algebra.linear_algebra import nullspace, rank, rank_mod
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.structure.given_expressions import is_finite_and_real
from liepoisson.structure.poisson.poisson_tensor import SEEDS
from liepoisson.structure.poisson.polynomial_tensor import PolynomialTensor

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.algebra.exact_numbers import Exact

Pair: TypeAlias = tuple[int, int]
Triple: TypeAlias = tuple[int, int, int]

N_POINTS = 10
"""Random points at which an identity is tried that is not decided."""


@dataclass(frozen=True)
class TensorEntries:
    r"""The entries $J_{ij}(x)$, i < j, as expressions in the coordinates.

    Attributes:
        variables: The coordinates.
        entries: The nonzero entries by (i, j) with i < j; other symbols in them are parameters.
    """

    variables: tuple[Symbol, ...]
    entries: Mapping[Pair, Expr]

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: the formulas; everything else is derived again."""
        return {"variables": self.variables, "entries": self.entries}

    @property
    def dimension(self) -> int:
        """Number N of coordinates."""
        return len(self.variables)

    @cached_property
    def is_rational(self) -> bool:
        """Whether all entries are rational functions of the coordinates."""
        return _is_rational(self._field, self.variables)

    @cached_property
    def degree(self) -> int | None:
        """The highest degree of an entry; None if one is no polynomial in the coordinates."""
        from sympy import Poly

        entries: list[Any] = list(self.entries.values())
        if not all(entry.is_polynomial(*self.variables) for entry in entries):
            return None
        return max((int(Poly(entry, *self.variables).total_degree()) for entry in entries), default=0)

    @cached_property
    def linear_terms(self) -> tuple[tuple[int, int, int | None, Exact], ...]:
        """The terms (i, j, m, c) of entries of degree at most one, i < j; m is None for a constant one."""
        from sympy import Poly

        found: list[tuple[int, int, int | None, Exact]] = []
        for (i, j), entry in sorted(self.entries.items()):
            for powers, c in Poly(entry, *self.variables).terms():
                found.append((i, j, powers.index(1) if any(powers) else None, _exact(c)))
        return tuple(sorted(found, key=lambda term: (*term[:2], -1 if term[2] is None else term[2])))

    @cached_property
    def log_canonical(self) -> dict[Pair, Exact] | None:
        """The numbers c where all entries are $c_{ij} x_i x_j$; None where one is not."""
        found: dict[Pair, Exact] = {}
        for (i, j), entry in self.entries.items():
            quotient: Any = (entry / (self.variables[i] * self.variables[j])).cancel()
            if quotient.free_symbols & {*self.variables}:
                return None
            found[i, j] = _exact(quotient)
        return found

    @cached_property
    def _field(self) -> Coefficients:
        return self._containing([])

    @cached_property
    def _roots(self) -> bool | None:
        """Whether square roots of rational functions occur in numerators alone; None if others or none at all do.

        With roots in denominators the sums grow beyond what is computed in seconds.
        """
        from sympy import fraction, together

        roots: dict[Any, Any] = {}
        named = [_with_named_roots(entry, roots) for entry in self.entries.values()]
        symbols = [*{s for one in (*named, *roots) for s in one.free_symbols}]
        if not roots or not all(one.is_rational_function(*symbols) for one in (*named, *roots)):
            return None
        return not any(fraction(together(one))[1].has(*roots.values()) for one in named)

    def _containing(self, more: Iterable[Expr]) -> Coefficients:
        slopes = (slope for own in self._slopes.values() for slope in own.values())
        return Coefficients.containing([*self.variables, *self.entries.values(), *slopes, *more])

    @cached_property
    def _slopes(self) -> dict[Pair, dict[int, Expr]]:
        """The derivatives of each entry, those that are not zero."""
        found: dict[Pair, dict[int, Expr]] = {}
        for pair, entry in self.entries.items():
            checkpoint("the derivatives of a Poisson tensor")
            occurring = entry.free_symbols
            own = {m: entry.diff(x) for m, x in enumerate(self.variables) if x in occurring}
            found[pair] = {m: slope for m, slope in own.items() if slope != 0}
        return found

    # The Jacobi identity

    def jacobi_residual(self, triple: Triple) -> Expr | None:
        r"""The cyclic sum of $\{\{x_i, x_j\}, x_k\}$ where it is found zero or decided; None where it is left open."""
        if self._roots is not None:
            is_proved = self._roots and _vanishes_with_roots(self._cyclic(triple))
            return to_sympy(Fraction(0)) if is_proved else None
        field, total = self._field, self._field.zero
        for term in self._cyclic(triple):
            first, second = (field.read(factor) for factor in term)
            total = total + first * second
        if not total:
            return to_sympy(Fraction(0))
        return field.to_sympy(total) if field.decides and self.is_rational else None

    def jacobi_fails_at_a_point(self, triple: Triple) -> Expr | None:
        """The cyclic sum as it stands where it is not zero at a point; None if it is at all.

        Where the entries are not real they are continued analytically; points where they are not defined are passed
        over.

        Raises:
            ParameterError: they are defined at none of the points, or contain roots of squares.
        """
        from sympy import Add

        products: list[Any] = [cast("Any", first) * second for first, second in self._cyclic(triple)]
        vanishes = vanishes_at_all(products, self.points())
        if vanishes is None:
            raise ParameterError(
                f"the entries of a Poisson tensor must {HAVE_VALUES} where coordinates and parameters lie between 0 "
                "and 1 and the Jacobi identity is tried; these are not. Move the coordinates, or give check=False."
            )
        if not vanishes:
            return Add(*products)
        refuse_sizes(products, "the entries of a Poisson tensor")
        return None

    def _cyclic(self, triple: Triple) -> Iterator[tuple[Expr, Expr]]:
        r"""The products $\partial_m J_{ij}\, J_{mk}$ of the cyclic sum, as factors."""
        i, j, k = triple
        for a, b, c in ((i, j, k), (j, k, i), (k, i, j)):
            for m, slope in self._slopes.get((min(a, b), max(a, b)), {}).items():
                if (entry := self.entry(m, c)) is not None:
                    yield (slope if a < b else -slope), entry

    def triples(self) -> Iterator[Triple]:
        """All triples i < j < k whose cyclic sum has a term."""
        return (t for t in combinations(range(self.dimension), 3) if any(True for _ in self._cyclic(t)))

    def entry(self, i: int, j: int) -> Expr | None:
        """$J_{ij}$ for any order of i and j; None if it is zero."""
        found = self.entries.get((min(i, j), max(i, j)))
        return found if found is None or i < j else -found

    # Casimirs

    def image(self, function: Expr) -> list[Expr]:
        r"""$J\nabla f$ as far as it is not found zero: its components in the field that everything generates."""
        slopes = {m: function.diff(x) for m, x in enumerate(self.variables) if x in function.free_symbols}
        field = self._containing(slopes.values())
        sums: list[Any] = [field.zero] * self.dimension
        for (i, j), entry in self.entries.items():
            J = field.read(entry)
            if j in slopes:
                sums[i] = sums[i] + J * field.read(slopes[j])
            if i in slopes:
                sums[j] = sums[j] - J * field.read(slopes[i])
        return [field.to_sympy(total) for total in sums if total and not field.vanishes(total)]

    def n_independent(self, functions: Sequence[Expr]) -> int:
        """How many functions are independent: the rank of their gradients, at a random point where that is proved."""
        rows = [{m: f.diff(x) for m, x in enumerate(self.variables) if x in f.free_symbols} for f in functions]
        return self.rank_of(rows)

    @cached_property
    def cleared(self) -> PolynomialTensor | None:
        """The tensor times the common denominator, which has the same Casimirs and rank; None if it is not rational."""
        from sympy import Poly

        field = self._field
        if not self.is_rational:
            return None
        elements = {pair: field.read(entry) for pair, entry in self.entries.items()}
        common: Any = None
        for element in elements.values():
            common = element.denom if common is None else common.lcm(element.denom)
        polynomials: dict[Pair, dict[Any, Any]] = {}
        for pair, element in elements.items():
            cleared: Any = element.numer * common.quo(element.denom)
            terms = Poly(cleared.as_expr(*field.parameters), *self.variables).terms()
            polynomials[pair] = {_factors(powers): _exact(c) for powers, c in terms}
        own = Coefficients.containing(c for polynomial in polynomials.values() for c in polynomial.values())
        read = {pair: {m: own.read(c) for m, c in terms.items()} for pair, terms in polynomials.items()}
        return PolynomialTensor(self.dimension, own, read)

    def log_canonical_casimirs(self) -> list[Expr] | None:
        r"""Products of powers $x^k$, $\sum_j c_{ij} k_j = 0$, of integers; None where the tensor is not of this kind.

        $J\nabla x^k = x^k\,(x_i \sum_j c_{ij} k_j)_i$.  They generate all Casimirs that are products of powers; where
        the null space has no basis of integers they are the logarithms, $\sum_j k_j \log x_j$.
        """
        from sympy import Add, Mul, log

        numbers = self.log_canonical
        if numbers is None:
            return None
        field = Coefficients.containing(numbers.values())
        rows: list[dict[int, Any]] = [{} for _ in self.variables]
        for (i, j), c in numbers.items():
            rows[i][j], rows[j][i] = field.read(c), -field.read(c)
        found: list[Expr] = []
        for vector in nullspace(rows, self.dimension, field).vectors:
            powers = {j: field.write(value) for j, value in vector.items()}
            if all(isinstance(k, Fraction) or k.is_Rational for k in powers.values()):
                fractions = {j: Fraction(str(k)) for j, k in powers.items()}
                scale = lcm(*(k.denominator for k in fractions.values()))
                scale = scale if sum(fractions.values()) >= 0 else -scale
                found.append(Mul(*(self.variables[j] ** int(k * scale) for j, k in fractions.items())))
            else:
                found.append(Add(*(to_sympy(k) * log(self.variables[j]) for j, k in powers.items())))
        return found

    # Rank

    def rows(self) -> list[dict[int, Expr]]:
        """The matrix as sparse rows of expressions."""
        rows: list[dict[int, Expr]] = [{} for _ in self.variables]
        for (i, j), entry in self.entries.items():
            rows[i][j], rows[j][i] = entry, -entry
        return rows

    @cached_property
    def lower_rank(self) -> int:
        """The rank at one random point."""
        return self.rank_of(self.rows())

    @cached_property
    def upper_rank(self) -> int:
        """The rank over the field that the entries generate: the generic one, or a bound of it where relations hide."""
        field = self._field
        rows = [{j: field.read(entry) for j, entry in row.items()} for row in self.rows()]
        return rank([row for row in rows if row], field)

    def rank_of(self, rows: Sequence[Mapping[int, Expr]]) -> int:
        """The rank of a matrix of functions at a random point: modulo a prime, or in decimals."""
        field = Coefficients.containing([*self.variables, *(e for row in rows for e in row.values())])
        if _is_rational(field, self.variables):
            for seed in SEEDS:
                if (residues := field.residues(seed)) is None:
                    break
                try:
                    images = [{j: residues(field.read(e)) for j, e in row.items()} for row in rows]
                except ZeroDivisionError:
                    continue
                return rank_mod(images, self.dimension, residues.p)
        flat = [(i, j, e) for i, row in enumerate(rows) for j, e in row.items()]
        for point in self.points():
            if (found := decimals([e for *_, e in flat], point)) is not None:
                return _numeric_rank(flat, found[0], found[2], len(rows), self.dimension)
        raise ParameterError(
            f"functions whose rank is tried must {HAVE_VALUES} where coordinates and parameters lie between 0 and 1; "
            "these are not. Move the coordinates."
        )

    def rank_at(self, point: Sequence[Exact]) -> int:
        """The rank at a point; parameters are generic.

        Raises:
            ParameterError: an entry is not finite and real there.
        """
        at: Any = {x: to_sympy(value) for x, value in zip(self.variables, point, strict=True)}
        rows: list[dict[int, Any]] = [{j: entry.xreplace(at) for j, entry in row.items()} for row in self.rows()]
        if not all(is_finite_and_real(entry) for row in rows for entry in row.values()):
            raise ParameterError(
                f"point: wanted one where all entries are finite and real; got {list(map(str, at.values()))}. Move it."
            )
        field = Coefficients.containing(entry for row in rows for entry in row.values())
        elements = [{j: v for j, e in row.items() if not field.vanishes(v := field.read(e))} for row in rows]
        return rank([row for row in elements if row], field)

    def points(self) -> Iterator[dict[str, Any]]:
        """Random rational points between 0 and 1, by the names of coordinates and parameters, of a fixed seed."""
        from sympy import Rational

        random = Random(1)
        symbols = {symbol for entry in self.entries.values() for symbol in entry.free_symbols}
        names = sorted({*map(str, self.variables), *map(str, symbols)})
        for _ in range(N_POINTS):
            yield {name: Rational(random.randrange(1, 1000), 1000) for name in names}


def _with_named_roots(expression: Any, roots: dict[Any, Any]) -> Any:
    """The expression with a name for the square root of each base, which is added to `roots`."""
    from sympy import Dummy

    def named(power: Any) -> Any:
        base = power.base
        return base ** ((power.exp.p - 1) // 2) * roots.setdefault(base, Dummy())

    def is_root(e: Any) -> bool:
        return bool(e.is_Pow and e.exp.is_Rational and e.exp.q == 2 and e.base.free_symbols)

    return expression.replace(is_root, named)


def _vanishes_with_roots(products: Iterable[tuple[Expr, Expr]]) -> bool:
    """Whether a sum of products is zero by the rule that the square of a root is its base."""
    roots: dict[Any, Any] = {}
    factors = [tuple(_with_named_roots(factor, roots) for factor in product) for product in products]
    field = Coefficients.containing([*roots, *roots.values(), *(one for pair in factors for one in pair)])
    total: Any = sum((field.read(a) * field.read(b) for a, b in factors), field.zero)
    if not total:
        return True
    names = [*map(str, field.parameters)]
    places = {names.index(str(name)): field.read(base) for base, name in roots.items()}
    parts: dict[tuple[int, ...], Any] = {}
    for powers, c in total.numer.terms():
        odd = tuple(powers[k] % 2 for k in places)
        term = total.numer.ring({tuple(0 if k in places else int(p) for k, p in enumerate(powers)): c})
        value = field.domain(term)
        for k, base in places.items():
            value = value * base ** (powers[k] // 2)
        parts[odd] = parts.get(odd, field.zero) + value
    return not any(parts.values())


def _is_rational(field: Coefficients, variables: Sequence[Symbol]) -> bool:
    """Whether the field is one of rational functions of the coordinates, over whatever numbers and parameters."""
    if not getattr(field.domain, "is_FractionField", False):
        return False
    return all(s.is_Symbol or not s.free_symbols & {*variables} for s in field.parameters)


def _exact(value: Any) -> Exact:
    return Fraction(int(value.p), int(value.q)) if value.is_Rational else value


def _factors(powers: Sequence[int]) -> tuple[int, ...]:
    return tuple(k for k, power in enumerate(powers) for _ in range(power))


def _numeric_rank(
    flat: Sequence[tuple[int, int, Any]], values: Sequence[Any], digits: int, n_rows: int, n_columns: int
) -> int:
    """The rank of a matrix of decimals, by elimination with the largest pivots, until they are round-off."""
    from mpmath import mp

    rows: list[list[Any]] = [[0] * n_columns for _ in range(n_rows)]
    for (i, j, _), value in zip(flat, values, strict=True):
        rows[i][j] = value
    found = 0
    with mp.workdps(digits):
        smallest = round_off(digits) * max((abs(value) for row in rows for value in row), default=0)
        while rows:
            size, i, j = max((abs(value), i, j) for i, row in enumerate(rows) for j, value in enumerate(row))
            if not size or size <= smallest:
                break
            pivot = rows.pop(i)
            rows = [[x - row[j] / pivot[j] * y for x, y in zip(row, pivot, strict=True)] for row in rows]
            found += 1
    return found
