r"""Rational integrals $\prod p_i^{n_i}$ made of Darboux polynomials, whose cofactors satisfy $\sum n_i k_i = 0$."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.linear_algebra import rank_mod
from liepoisson.algebra.number_fields import Element
from liepoisson.algebra.sparse_polynomials import gradient_at, value_at
from liepoisson.integrability.darboux_search import DarbouxSearch, Factor
from liepoisson.integrability.modular import modular
from liepoisson.integrability.search import Search

if TYPE_CHECKING:
    from sympy import Expr


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
    powers: dict[str, int]
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
