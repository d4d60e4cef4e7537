r"""All Darboux polynomials with given cofactors, those of them that others do not give, and integrals made of them.

For each cofactor k the polynomials with $D p = k p$ are a vector space, which contains the products of others whose
cofactors add up to k. Its dimension modulo a prime is at least the true one. Where products span as much, there is
nothing else; otherwise the space is computed exactly, and what is no sum of products is taken, lowest degree first.

A product $\prod p_i^{n_i}$ is a rational integral if $\sum n_i k_i = 0$, and an integral that depends on time with
$e^{-ct}$ if $\sum n_i k_i$ is a number c.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce
from math import lcm
from operator import add
from typing import Any, TypeAlias, cast

from flint import fmpz_mat
from sympy import Expr, Mul, Symbol, exp, expand

from liepoisson.algebra.echelon import Echelon, transposed
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod, rank_mod
from liepoisson.algebra.number_fields import Element, as_fraction
from liepoisson.algebra.sparse_polynomials import Polynomial, add_multiple, gradient_at, multiply, value_at
from liepoisson.inputs.names import free_name
from liepoisson.integrability.cofactors import image
from liepoisson.integrability.derivation import Exponents, homogeneous_parts, order
from liepoisson.integrability.search import Search, in_field, modular, next_name

Cofactor: TypeAlias = "tuple[Element, ...]"
"""The coefficients of a cofactor, in the order of its monomials."""
Label: TypeAlias = "tuple[int, ...]"


@dataclass(frozen=True)
class Factor:
    """A Darboux polynomial of which products are made."""

    polynomial: Polynomial  # it, homogeneous in the gradings
    cofactor: Cofactor
    is_new: bool  # whether the search found it

    @property
    def degree(self) -> int:
        """Its total degree."""
        return max(map(sum, self.polynomial))


@dataclass
class _Entry:
    """One linear system of a search: the monomials of a block and a cofactor."""

    label: Label
    block: list[Exponents]
    cofactor: Cofactor
    degrees: list[int] = field(default_factory=list[int])
    exact: list[Polynomial] | None = None


@dataclass
class DarbouxSearch:
    """The search with given cofactors."""

    search: Search  # equations over a field that contains the cofactors, a level, and integer gradings
    monomials: tuple[Exponents, ...]  # those of the cofactors, homogeneous in the gradings
    factors: list[Factor] = field(default_factory=list[Factor])  # what is known, to which is added what is found

    def add_known(self, polynomial: Polynomial) -> None:
        """Take the homogeneous parts of an integral with rational coefficients as known."""
        numbers = self.search.derivation.field
        remainder = self.search.level.remainder(in_field(polynomial, numbers))
        for part in homogeneous_parts(remainder, self.search.gradings).values():
            if any(map(any, part)):
                self.factors.append(Factor(part, (numbers.zero,) * len(self.monomials), is_new=False))

    def run(
        self,
        blocks: Sequence[tuple[Label, list[Exponents], Sequence[Cofactor]]],
        progress: Callable[[float], Any] = lambda _: None,
    ) -> None:
        """Look for Darboux polynomials with the monomials of some blocks and the cofactors named with each.

        Degree by degree, so that what is found is no product: factors have lower degrees, and were found before.
        """
        entries = [
            _Entry(label, sorted(block, key=order), cofactor)
            for label, block, cofactors in blocks
            for cofactor in cofactors
        ]
        for entry in entries:
            entry.degrees = self._degrees(entry.block, entry.cofactor)
        highest = max((e for entry in entries for e in entry.degrees), default=0)
        for degree in range(1, highest + 1):
            new: list[Factor] = []
            for entry in entries:
                if degree not in entry.degrees:
                    continue
                span = self._span(entry.label, entry.cofactor, degree)
                if len(span) >= sum(e <= degree for e in entry.degrees):
                    continue
                if entry.exact is None:
                    entry.exact = self._exact(entry.block, entry.cofactor)
                for polynomial in entry.exact:
                    found = Factor(polynomial, entry.cofactor, is_new=True)
                    if found.degree == degree and span.insert(modular(polynomial, self.search.residues)):
                        new.append(found)
            self.factors += new
            progress(degree / highest)

    def cofactor_expression(self, factor: Factor) -> Expr:
        """The cofactor of a Darboux polynomial."""
        return self.search.derivation.expression(self._of(factor.cofactor))

    def _of(self, cofactor: Cofactor) -> dict[Exponents, Element]:
        return {m: c for m, c in zip(self.monomials, cofactor, strict=True) if c}

    def _rows(self, block: Sequence[Exponents], cofactor: Cofactor) -> list[dict[int, Element]]:
        here, k = self.search, self._of(cofactor)
        return transposed(image(here.derivation, k, monomial, here.level) for monomial in block)

    def _degrees(self, block: Sequence[Exponents], cofactor: Cofactor) -> list[int]:
        """The degrees of a basis of the null space modulo the prime, as low as possible.

        For no degree there are fewer up to it than there are exactly.
        """
        residues = self.search.residues
        rows = [{c: r for c, v in row.items() if (r := residues(v))} for row in self._rows(block, cofactor)]
        # vectors end in columns of their own, which increase with the degree
        return [sum(block[max(vector)]) for vector in nullspace_mod(rows, len(block), residues.p)]

    def _exact(self, block: Sequence[Exponents], cofactor: Cofactor) -> list[Polynomial]:
        """The null space, as polynomials of the lowest degrees possible, those with few terms first."""
        vectors = nullspace(self._rows(block, cofactor), len(block), self.search.derivation.field).vectors
        return sorted(({block[c]: v for c, v in vector.items()} for vector in vectors), key=len)

    def _span(self, label: Label, cofactor: Cofactor, highest: int) -> Echelon:
        """The products of factors up to a degree with a cofactor and in a block, modulo the prime."""
        here, residues = self.search, self.search.residues
        span, one = Echelon(residues.field), {(0,) * len(here.derivation.variables): residues.field.one}

        def rate(cofactor: Cofactor, weights: Label) -> tuple[Any, ...]:
            return (*(residues.field.number(residues(c)) for c in cofactor), *weights)

        wanted = rate(cofactor, label)
        factors: list[tuple[int, Polynomial, tuple[Any, ...]]] = []
        for f in self.factors:
            weights = tuple(g.of(next(iter(f.polynomial))) for g in here.gradings)
            factors.append((f.degree, modular(f.polynomial, residues), rate(f.cofactor, weights)))

        def extend(start: int, left: int, chosen: tuple[int, ...], reached: tuple[Any, ...]) -> None:
            if reached == wanted:
                span.insert(here.level_mod.remainder(reduce(multiply, (factors[k][1] for k in chosen), one)))
            for k in range(start, len(factors)):
                degree, _, more = factors[k]
                if 0 < degree <= left:
                    extend(k, left - degree, (*chosen, k), tuple(map(add, reached, more)))

        zero = here.derivation.field.zero
        extend(0, highest, (), rate((zero,) * len(self.monomials), (0,) * len(here.gradings)))
        return span

    def gradient(self, factors: Sequence[Factor], powers: Sequence[int]) -> dict[int, Element]:
        """The gradient of the logarithm of a product of powers at a random point of the level modulo the prime."""
        total: dict[Any, Element] = {}
        for factor, power in zip(factors, powers, strict=True):
            if power:
                polynomial, point = modular(factor.polynomial, self.search.residues), self.search.point
                value = value_at(polynomial.items(), point)
                if not value:
                    return {}  # it vanishes on a component of the level
                slopes: dict[Any, Element] = gradient_at(polynomial, point)
                add_multiple(total, slopes, power / value)
        return total

    def rank(self, rows: Sequence[dict[int, Element]]) -> int:
        """The rank of gradients at the same point, along the level."""
        residues, point = self.search.residues, self.search.point
        level = [gradient_at(modular(e, residues), point) for e in self.search.equations]
        return rank_mod([*level, *rows], len(point), residues.p)


@dataclass(frozen=True)
class RationalIntegral:
    """A product of powers of Darboux polynomials that is constant along the motion.

    Attributes:
        name: R1, R2, ...
        powers: The power of each polynomial, by its name, those that occur.
        expression: The integral; expanded if it is a polynomial.
        is_independent: Whether it is functionally independent of the known integrals and those before it.
    """

    name: str
    powers: dict[str, int] = field(hash=False)
    expression: Expr
    is_independent: bool

    @property
    def is_polynomial(self) -> bool:
        """Whether no power is negative."""
        return min(self.powers.values()) > 0

    @property
    def remark(self) -> str:
        """What is said behind it."""
        return "" if self.is_independent else "   (depends on the others)"

    def __str__(self) -> str:
        """The product, by the names of its factors."""
        return _product(self.powers)


@dataclass(frozen=True)
class TimeDependentIntegral:
    r"""A product of powers of Darboux polynomials that is constant when multiplied with an exponential of the time.

    Attributes:
        name: E1, E2, ...
        powers: The power of each polynomial, by its name, those that occur.
        rate: The number c that the cofactors add up to: the product grows like $e^{ct}$.
        expression: The product times $e^{-ct}$.
        time: The symbol t, called t_ where t is a coordinate.
        is_independent: Whether it is functionally independent of the known and rational integrals and those before it.
    """

    name: str
    powers: dict[str, int] = field(hash=False)
    rate: Expr
    expression: Expr
    time: Symbol
    is_independent: bool

    @property
    def remark(self) -> str:
        """What is said behind it."""
        return "" if self.is_independent else "   (depends on the others)"

    def __str__(self) -> str:
        """The product by the names of its factors, and the exponential."""
        exponent: Any = -cast("Any", self.rate) * self.time
        return f"{_product(self.powers)}*exp({str(exponent).replace('**', '^')})"


def rational_integrals(
    search: DarbouxSearch,
    factors: Sequence[Factor],
    names: Sequence[str],
    expressions: Sequence[Expr],
    taken: Collection[str],
) -> tuple[RationalIntegral, ...]:
    """A basis of the integrals that are products of powers of some Darboux polynomials; they avoid the names taken."""
    rows = [search.gradient([f], [1]) for f in search.factors if not f.is_new]
    found: list[RationalIntegral] = []
    for relation in _relations(factors):
        row = search.gradient(factors, relation)
        is_independent = search.rank([*rows, row]) > search.rank(rows)
        rows.append(row)
        product: Any = Mul(*(e**n for e, n in zip(expressions, relation, strict=True) if n))
        found.append(
            RationalIntegral(
                next_name(taken, [one.name for one in found], letter="R"),
                {name: n for name, n in zip(names, relation, strict=True) if n},
                expand(product) if min(relation) >= 0 else product,
                is_independent,
            )
        )
    return tuple(found)


def time_dependent_integrals(
    search: DarbouxSearch,
    factors: Sequence[Factor],
    names: Sequence[str],
    expressions: Sequence[Expr],
    taken: Collection[str],
) -> tuple[TimeDependentIntegral, ...]:
    """Products of powers whose cofactors add up to a number c that is not 0; all others follow with those of c = 0."""
    numbers, variables = search.search.derivation.field, search.search.derivation.variables
    constant = (0,) * len(variables)
    if constant not in search.monomials:
        return ()
    place, time = search.monomials.index(constant), Symbol(free_name("t", [*map(str, variables)]))
    rows = [search.gradient([f], [1]) for f in search.factors if not f.is_new]
    rows += [search.gradient(factors, relation) for relation in _relations(factors)]
    found: list[TimeDependentIntegral] = []
    for relation in _relations(factors, place):
        terms = (numbers.number(n) * f.cofactor[place] for n, f in zip(relation, factors, strict=True))
        if not (rate := sum(terms, numbers.zero)):
            continue
        # where gradients by the coordinates are dependent, so are the rates, which are derivatives along the motion
        row = search.gradient(factors, relation)
        is_independent = search.rank([*rows, row]) > search.rank(rows)
        rows.append(row)
        product: Any = Mul(*(e**n for e, n in zip(expressions, relation, strict=True) if n))
        c: Any = numbers.to_sympy(rate)
        powers = {name: n for name, n in zip(names, relation, strict=True) if n}
        name = next_name(taken, [one.name for one in found], letter="E")
        found.append(TimeDependentIntegral(name, powers, c, product * exp(-c * time), time, is_independent))
    return tuple(found)


def _relations(factors: Sequence[Factor], left_out: int | None = None) -> list[list[int]]:
    """A basis of the whole numbers n with sum n_i k_i = 0, short by the algorithm of Lenstra, Lenstra and Lovasz.

    Args:
        left_out: The monomial of the cofactors whose coefficients do not count, by its place.
    """
    if not factors:
        return []
    table = [[x for place, c in enumerate(f.cofactor) if place != left_out for x in _coordinates(c)] for f in factors]
    scale = lcm(*(x.denominator for row in table for x in row))
    rows = [[int(x * scale) for x in row] for row in table]
    rank = fmpz_mat(rows).rank() if rows[0] else 0
    n, weight = len(factors), 1
    while True:
        weight *= 1000
        matrix = [[weight * x for x in row] + [int(i == k) for k in range(n)] for i, row in enumerate(rows)]
        reduced = [[int(x) for x in row] for row in fmpz_mat(matrix).lll().tolist()]
        found = [row[len(rows[0]) :] for row in reduced if not any(row[: len(rows[0])])]
        if len(found) == n - rank:
            break
    signed = [[-x for x in row] if (sum(row) or next(filter(None, row))) < 0 else row for row in found]
    return sorted(signed, key=lambda row: (sum(map(abs, row)), [-x for x in row]))


def _coordinates(number: Any) -> list[Fraction]:
    """A number by rational numbers, the coefficients of a polynomial in the generator of its field."""
    if isinstance(number, Fraction):
        return [number]
    degree = len(number.mod_to_list()) - 1
    values = [as_fraction(c) for c in reversed(number.to_list())]
    return values + [Fraction(0)] * (degree - len(values))


def _product(powers: Mapping[str, int]) -> str:
    """A product of powers, by the names of its factors."""
    above = [_power(name, n) for name, n in powers.items() if n > 0]
    below = [_power(name, -n) for name, n in powers.items() if n < 0]
    bottom = f"({'*'.join(below)})" if len(below) > 1 else "".join(below)
    return ("*".join(above) or "1") + (f"/{bottom}" if below else "")


def _power(name: str, n: int) -> str:
    return name if n == 1 else f"{name}^{n}"
