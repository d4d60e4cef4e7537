r"""Polynomial first integrals of one weight, counted exactly.

With b = 0 the equations are homogeneous for the weights 1, 2, 3 of l, alpha, beta, so a polynomial integral splits
into integrals of one weight.  Those of weight n are the null vectors of $D = \dot x\cdot\nabla$ on the monomials of
weight n.  The rank of D modulo a prime is at most its rank over the rationals, so the nullity modulo a prime is an
upper bound; the products of the known integrals give a lower bound.  Where the two agree the count is exact.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

Monomial: TypeAlias = tuple[int, ...]
Polynomial: TypeAlias = dict[Monomial, int]

PRIME = 2**61 - 1
"""A Mersenne prime.  Rows are eliminated as they are, sparse: five to ten times as fast as a transposed null space."""

COUNT_HEADING = ("weight", "monomials", "rank", "integrals", "known")


@dataclass(frozen=True)
class IntegralCount:
    """The integrals of one weight.

    Attributes:
        weight: Their weight.
        monomials: Number of unknowns, the monomials of this weight.
        found: Upper bound for the independent integrals, the nullity of D modulo the prime.
        known: Independent products of the known integrals, a lower bound.
    """

    weight: int
    monomials: int
    found: int
    known: tuple[str, ...]

    @property
    def excess(self) -> int:
        """How many integrals there may be beyond the known ones; zero is exact."""
        return self.found - len(self.known)

    @property
    def row(self) -> tuple[int, ...]:
        """The sizes, as in `COUNT_HEADING`."""
        return self.weight, self.monomials, self.monomials - self.found, self.found, len(self.known)


def count_integrals(
    equations: Sequence[Any],
    variables: Sequence[Any],
    weights: Sequence[int],
    known: Mapping[str, tuple[Any, int]],
    weight: int,
) -> IntegralCount:
    """Count the integrals of a weight, and those that products of known ones give.

    Args:
        equations: Right-hand sides, polynomials with rational coefficients in the variables.
        variables: Coordinates.
        weights: Their weights, positive.
        known: Integrals with their weights, by name.
        weight: The weight of the integrals.
    """
    n_monomials = sum(1 for _ in monomials_of_weight(weights, weight))
    found = nullity(equations, variables, weights, weight)
    return IntegralCount(weight, n_monomials, found, tuple(independent_products(known, variables, weight)))


def nullity(equations: Sequence[Any], variables: Sequence[Any], weights: Sequence[int], weight: int) -> int:
    """Upper bound for the number of independent integrals of a weight: the nullity of D modulo a prime.

    Args:
        equations: Right-hand sides, polynomials with rational coefficients in the variables.
        variables: Coordinates.
        weights: Their weights, positive.
        weight: The weight of the integrals.
    """
    field = [modular(equation, variables) for equation in equations]
    monomials = list(monomials_of_weight(weights, weight))
    rows = (_derivative(monomial, field) for monomial in monomials)
    return len(monomials) - rank(rows)


def independent_products(known: Mapping[str, tuple[Any, int]], variables: Sequence[Any], weight: int) -> list[str]:
    """Products of known integrals of a weight that are linearly independent (modulo a prime, hence over the rationals).

    Args:
        known: Integrals with their weights, by name.
        variables: Coordinates.
        weight: The weight of the products.
    """
    names = list(known)
    base = [modular(expression, variables) for expression, _ in known.values()]
    one: Polynomial = {(0,) * len(variables): 1}
    chosen: list[str] = []
    rows: list[Polynomial] = []
    for powers in monomials_of_weight([w for _, w in known.values()], weight):
        product = one
        for factor, power in zip(base, powers, strict=True):
            for _ in range(power):
                product = _multiply(product, factor)
        if rank([*rows, product]) > len(rows):
            rows.append(product)
            chosen.append("·".join(f"{n}^{p}" if p > 1 else n for n, p in zip(names, powers, strict=True) if p))
    return chosen


def monomials_of_weight(weights: Sequence[int], weight: int) -> Iterator[Monomial]:
    """All exponent tuples whose weighted sum is the given weight."""
    if not weights:
        if weight == 0:
            yield ()
        return
    for power in range(weight // weights[0] + 1):
        for rest in monomials_of_weight(weights[1:], weight - power * weights[0]):
            yield (power, *rest)


def modular(expression: Any, variables: Sequence[Any]) -> Polynomial:
    """The polynomial with its rational coefficients read modulo the prime."""
    from sympy import Poly

    terms = Poly(expression, *variables).terms()
    return {powers: int(c.p) * pow(int(c.q), -1, PRIME) % PRIME for powers, c in terms if c != 0}


def rank(rows: Iterable[Polynomial]) -> int:
    """Rank modulo the prime of sparse rows, by elimination."""
    pivots: dict[Monomial, Polynomial] = {}
    for given in rows:
        row = dict(given)
        while row:
            lead = max(row)
            if lead not in pivots:
                inverse = pow(row[lead], -1, PRIME)
                pivots[lead] = {key: value * inverse % PRIME for key, value in row.items()}
                break
            _subtract(row, row[lead], pivots[lead])
    return len(pivots)


def _subtract(row: Polynomial, factor: int, pivot: Polynomial) -> None:
    for key, value in pivot.items():
        left = (row.get(key, 0) - factor * value) % PRIME
        if left:
            row[key] = left
        else:
            row.pop(key, None)


def _derivative(monomial: Monomial, field: Sequence[Polynomial]) -> Polynomial:
    result: Polynomial = {}
    for k, power in enumerate(monomial):
        if not power:
            continue
        for factor, coefficient in field[k].items():
            key = tuple(m + f - (i == k) for i, (m, f) in enumerate(zip(monomial, factor, strict=True)))
            value = (result.get(key, 0) + power * coefficient) % PRIME
            if value:
                result[key] = value
            else:
                result.pop(key, None)
    return result


def _multiply(first: Polynomial, second: Polynomial) -> Polynomial:
    result: Polynomial = {}
    for m, c in first.items():
        for n, d in second.items():
            key = tuple(i + j for i, j in zip(m, n, strict=True))
            result[key] = (result.get(key, 0) + c * d) % PRIME
    return {key: value for key, value in result.items() if value}
