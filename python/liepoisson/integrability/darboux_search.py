r"""All Darboux polynomials with given cofactors, those of them that others do not give, and integrals made of them.

For each cofactor k the polynomials with $D p = k p$ are a vector space, which contains the products of others whose
cofactors add up to k. Its dimension modulo a prime is at least the true one. Where products span as much, there is
nothing else; otherwise the space is computed exactly, and what is no sum of products is taken, lowest degree first.

A product $\prod p_i^{n_i}$ is a rational integral if $\sum n_i k_i = 0$.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, transposed
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod, rank_mod
from liepoisson.algebra.number_fields import Element
from liepoisson.algebra.residues import Residues
from liepoisson.algebra.sparse_polynomials import Polynomial, gradient_at, multiply, value_at
from liepoisson.errors import ParameterError
from liepoisson.integrability.cofactors import image
from liepoisson.integrability.derivation import Derivation, Exponents, Grading, homogeneous_parts
from liepoisson.integrability.level import Level, order
from liepoisson.integrability.modular import modular
from liepoisson.integrability.search import Search

if TYPE_CHECKING:
    from sympy import Expr

Cofactor: TypeAlias = "tuple[Element, ...]"
"""The coefficients of a cofactor, in the order of its monomials."""
Label: TypeAlias = "tuple[int, ...]"


@dataclass(frozen=True)
class Factor:
    """A Darboux polynomial of which products are made.

    Attributes:
        polynomial: It, homogeneous in the gradings.
        cofactor: Its cofactor.
        is_new: Whether the search found it.
    """

    polynomial: Polynomial
    cofactor: Cofactor
    is_new: bool

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
    """The search with given cofactors.

    Attributes:
        derivation: The equations, over a field that contains the cofactors.
        gradings: Integer gradings, in which the cofactors are homogeneous.
        level: The level set, or all of phase space.
        equations: The polynomials that vanish on the level.
        monomials: Those of the cofactors.
        factors: What is known, to which is added what is found.
    """

    derivation: Derivation
    gradings: tuple[Grading, ...]
    level: Level
    equations: tuple[Polynomial, ...]
    monomials: tuple[Exponents, ...]
    factors: list[Factor] = field(default_factory=list[Factor])

    @property
    def field(self) -> Coefficients:
        """Where coefficients live."""
        return self.derivation.field

    def over(self, field: Coefficients) -> DarbouxSearch:
        """The same search over a larger field than the rational numbers, with nothing known."""
        basis = over(field, [generator for _, generator in self.level.basis])
        return DarbouxSearch(
            Derivation(self.derivation.variables, tuple(over(field, self.derivation.components)), field),
            self.gradings,
            Level(tuple((lead, generator) for (lead, _), generator in zip(self.level.basis, basis, strict=True))),
            tuple(over(field, self.equations)),
            self.monomials,
        )

    def add_known(self, polynomial: Polynomial) -> None:
        """Take the homogeneous parts of an integral as known."""
        zero = self.field.zero
        for part in homogeneous_parts(self.level.remainder(polynomial), self.gradings).values():
            if any(map(any, part)):
                self.factors.append(Factor(part, (zero,) * len(self.monomials), is_new=False))

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
                    if found.degree == degree and span.insert(modular(polynomial, self.residues)):
                        new.append(found)
            self.factors += new
            progress(degree / highest)

    def cofactor_expression(self, factor: Factor) -> Expr:
        """The cofactor of a Darboux polynomial."""
        return self.derivation.expression(self._of(factor.cofactor))

    @cached_property
    def residues(self) -> Residues:
        """The homomorphism modulo a prime."""
        found = self.field.residues(seed=1)
        if found is None:
            raise ParameterError(
                "the square roots in the cofactors generate a field that is too large; take field='real'"
            )
        return found

    @cached_property
    def _level_mod(self) -> Level:
        return Level(tuple((lead, modular(b, self.residues)) for lead, b in self.level.basis))

    def _of(self, cofactor: Cofactor) -> dict[Exponents, Element]:
        return {m: c for m, c in zip(self.monomials, cofactor, strict=True) if c}

    def _rows(self, block: Sequence[Exponents], cofactor: Cofactor) -> list[dict[int, Element]]:
        return transposed(image(self.derivation, self._of(cofactor), monomial, self.level) for monomial in block)

    def _degrees(self, block: Sequence[Exponents], cofactor: Cofactor) -> list[int]:
        """The degrees of a basis of the null space modulo the prime, as low as possible.

        For no degree there are fewer up to it than there are exactly.
        """
        rows = [
            {c: residue for c, v in row.items() if (residue := self.residues(v))} for row in self._rows(block, cofactor)
        ]
        # vectors end in columns of their own, which increase with the degree
        return [sum(block[max(vector)]) for vector in nullspace_mod(rows, len(block), self.residues.p)]

    def _exact(self, block: Sequence[Exponents], cofactor: Cofactor) -> list[Polynomial]:
        """The null space, as polynomials of the lowest degrees possible, those with few terms first."""
        vectors = nullspace(self._rows(block, cofactor), len(block), self.field).vectors
        return sorted(({block[c]: v for c, v in vector.items()} for vector in vectors), key=len)

    def _span(self, label: Label, cofactor: Cofactor, highest: int) -> Echelon:
        """The products of factors up to a degree with a cofactor and in a block, modulo the prime."""
        p = self.residues.p
        span = Echelon(self.residues.field)
        wanted = tuple(self.residues(c) for c in cofactor)
        one: Polynomial = {(0,) * len(self.derivation.variables): self.residues.field.one}
        factors = [
            (
                f.degree,
                modular(f.polynomial, self.residues),
                tuple(self.residues(c) for c in f.cofactor),
                tuple(g.of(next(iter(f.polynomial))) for g in self.gradings),
            )
            for f in self.factors
        ]

        def extend(start: int, left: int, chosen: tuple[int, ...], rate: tuple[int, ...], weights: Label) -> None:
            if rate == wanted and weights == label:
                product = one
                for k in chosen:
                    product = multiply(product, factors[k][1])
                span.insert(self._level_mod.remainder(product))
            for k in range(start, len(factors)):
                degree, _, more, moved = factors[k]
                if 0 < degree <= left:
                    further = tuple((a + b) % p for a, b in zip(rate, more, strict=True))
                    extend(k, left - degree, (*chosen, k), further, _sum(weights, moved))

        extend(0, highest, (), (0,) * len(self.monomials), (0,) * len(self.gradings))
        return span


def _sum(first: Label, second: Label) -> Label:
    return tuple(a + b for a, b in zip(first, second, strict=True))


def over(field: Coefficients, polynomials: Sequence[Mapping[Exponents, Element]]) -> list[Polynomial]:
    """Polynomials with rational coefficients over a larger field."""
    return [{m: field.number(c) for m, c in polynomial.items()} for polynomial in polynomials]


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
        above = [_power(name, n) for name, n in self.powers.items() if n > 0]
        below = [_power(name, -n) for name, n in self.powers.items() if n < 0]
        bottom = f"({'*'.join(below)})" if len(below) > 1 else "".join(below)
        return ("*".join(above) or "1") + (f"/{bottom}" if below else "")


def rational_integrals(
    search: DarbouxSearch, factors: Sequence[Factor], names: Sequence[str], expressions: Sequence[Expr]
) -> tuple[RationalIntegral, ...]:
    """A basis of the integrals that are products of powers of some Darboux polynomials.

    Args:
        search: Where they were found; its other factors are the known integrals.
        factors: The Darboux polynomials.
        names: What they are called.
        expressions: How they are written.
    """
    from sympy import Mul, expand

    at = _Point(search)
    rows = [at.gradient([f], [1]) for f in search.factors if not f.is_new]
    found: list[RationalIntegral] = []
    for relation in _relations(factors):
        row = at.gradient(factors, relation)
        is_independent = at.rank([*rows, row]) > at.rank(rows)
        rows.append(row)
        product: Any = Mul(*(e**n for e, n in zip(expressions, relation, strict=True) if n))
        found.append(
            RationalIntegral(
                f"R{len(found) + 1}",
                {name: n for name, n in zip(names, relation, strict=True) if n},
                expand(product) if min(relation) >= 0 else product,
                is_independent,
            )
        )
    return tuple(found)


class _Point:
    """A random point modulo a prime, on the level of a search, and gradients of logarithms there."""

    def __init__(self, search: DarbouxSearch) -> None:
        here = Search(search.derivation, search.gradings, search.level, search.equations, [])
        self.point, self.residues = here.point, here.residues
        self.level = [gradient_at(modular(e, self.residues), self.point) for e in search.equations]

    def gradient(self, factors: Sequence[Factor], powers: Sequence[int]) -> dict[int, Element]:
        """The gradient of the logarithm of a product of powers."""
        total: dict[int, Element] = {}
        for factor, power in zip(factors, powers, strict=True):
            if power:
                polynomial = modular(factor.polynomial, self.residues)
                value = value_at(polynomial.items(), self.point)
                if not value:
                    return {}  # it vanishes on a component of the level
                scale = power / value
                for i, slope in gradient_at(polynomial, self.point).items():
                    total[i] = total.get(i, 0) + scale * slope
        return {i: slope for i, slope in total.items() if slope}

    def rank(self, rows: Sequence[dict[int, Element]]) -> int:
        """The rank of gradients, along the level."""
        return rank_mod([*self.level, *rows], len(self.point), self.residues.p)


def _relations(factors: Sequence[Factor]) -> list[list[int]]:
    """A basis of the whole numbers n with sum n_i k_i = 0, short by the algorithm of Lenstra, Lenstra and Lovasz."""
    from flint import fmpz_mat

    if not factors:
        return []
    rows = _whole([[x for c in f.cofactor for x in _coordinates(c)] for f in factors])
    rank = fmpz_mat(rows).rank() if rows[0] else 0
    n, weight = len(factors), 1
    while True:
        weight *= 1000
        reduced = fmpz_mat(
            [[weight * x for x in row] + [int(i == k) for k in range(n)] for i, row in enumerate(rows)]
        ).lll()
        width = len(rows[0])
        table = [[int(x) for x in row] for row in reduced.tolist()]
        found = [row[width:] for row in table if not any(row[:width])]
        if len(found) == n - rank:
            break
    signed = [[-x for x in row] if sum(row) < 0 or (not sum(row) and _first(row) < 0) else row for row in found]
    return sorted(signed, key=lambda row: (sum(map(abs, row)), [-x for x in row]))


def _first(row: Sequence[int]) -> int:
    return next(x for x in row if x)


def _coordinates(number: Any) -> list[Fraction]:
    """A number by rational numbers, the coefficients of a polynomial in the generator of its field."""
    if isinstance(number, Fraction):
        return [number]
    degree = len(number.mod_to_list()) - 1
    values = [Fraction(int(c.numerator), int(c.denominator)) for c in reversed(number.to_list())]
    return values + [Fraction(0)] * (degree - len(values))


def _whole(rows: Sequence[Sequence[Fraction]]) -> list[list[int]]:
    """The rows with all columns multiplied by one denominator."""
    scale = lcm(*(x.denominator for row in rows for x in row))
    return [[int(x * scale) for x in row] for row in rows]


def _power(name: str, n: int) -> str:
    return name if n == 1 else f"{name}^{n}"
