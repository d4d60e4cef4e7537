"""Monomials of a degree or a weight, in blocks that the equations do not mix."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import comb

from liepoisson.integrability.derivation import Exponents
from liepoisson.integrability.gradings import Grading


def n_monomials(n_variables: int, degree: int) -> int:
    """The number of monomials up to a degree."""
    return comb(n_variables + degree, degree)


def n_of_weight(weights: Sequence[int], weight: int) -> int:
    """The number of monomials of one weight, without listing them; weights are positive."""
    counts = [1] + [0] * weight
    for w in weights:
        for k in range(w, weight + 1):
            counts[k] += counts[k - w]
    return counts[weight]


def of_degree(n_variables: int, degree: int) -> Iterator[Exponents]:
    """All monomials of one degree."""
    return of_weight((1,) * n_variables, degree)


def of_weight(weights: Sequence[int], weight: int) -> Iterator[Exponents]:
    """All monomials of one weight; weights are positive."""
    if not weights:
        if weight == 0:
            yield ()
        return
    if len(weights) == 1:
        if weight % weights[0] == 0:
            yield (weight // weights[0],)
        return
    for power in range(weight // weights[0] + 1):
        for rest in of_weight(weights[1:], weight - power * weights[0]):
            yield (power, *rest)


def in_blocks(monomials: Iterator[Exponents], gradings: Sequence[Grading]) -> dict[tuple[int, ...], list[Exponents]]:
    """The monomials by their weights in all gradings."""
    blocks: dict[tuple[int, ...], list[Exponents]] = {}
    for monomial in monomials:
        blocks.setdefault(tuple(g.of(monomial) for g in gradings), []).append(monomial)
    return blocks
