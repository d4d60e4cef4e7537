r"""Buchberger's algorithm over any field that FLINT has, with the criteria of Gebauer and Möller.

A pair of polynomials whose leading monomials have the least common multiple m gives an S-polynomial; the pairs of
smallest degree of m come first. For homogeneous polynomials this goes from degree to degree, and nothing is computed
that a later degree would have made shorter.

Which pairs reduce to zero is the same modulo almost all primes. A run remembers it, and the next run leaves them out.

References: [gebauer1988], for the criteria; [traverso1988], for runs that remember.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import compress
from operator import mul, sub
from typing import Any, TypeAlias

from liepoisson.algebra.ideals.limits import Budget
from liepoisson.algebra.sparse_polynomials import Monomial, divides

Poly: TypeAlias = Any
"""A polynomial of FLINT over a field: fmpq_mpoly or nmod_mpoly."""

_CALL, _TERM = 3.0, 0.15
"""Work of one division of polynomials, and of each term in it, with coefficients of one word (measured)."""


def leading(p: Poly) -> Monomial:
    """The exponents of the leading monomial."""
    return tuple(map(int, p.monomial(0)))


def common_multiple(first: Monomial, second: Monomial) -> Monomial:
    """The least common multiple of two monomials."""
    return tuple(map(max, first, second))


def remainder(
    p: Poly,
    basis: Iterable[Poly],
    budget: Budget | None = None,
    words: int = 1,
    leads: Iterable[Monomial] | None = None,
) -> Poly:
    """What is left of a polynomial when no leading monomial of the basis divides a term any more.

    Args:
        p: The polynomial.
        basis: Polynomials that are not zero.
        budget: Where the work is accounted.
        words: Size of the coefficients in machine words, for the account.
        leads: The leading monomials of the basis, where they are known.
    """
    known = list(basis)
    # a division by what divides no term costs as much as any; of few divisors none is worth the look
    looks = leads is not None and len(known) > 8
    divisors = list(zip(known, leads if looks and leads is not None else [()] * len(known), strict=True))
    while p:
        before = p
        highest = tuple(map(int, p.degrees())) if looks else ()
        for divisor, lead in divisors:
            if not divides(lead, highest):
                continue
            if budget is not None:
                budget.spend(_CALL + _TERM * (len(p) + len(divisor)) * words, "division of polynomials")
            p = p % divisor
            if not p:
                return p
        if p == before:
            return p
    return p


def monic(p: Poly) -> Poly:
    """The polynomial with leading coefficient 1."""
    return p * (1 / p.leading_coefficient())


@dataclass(frozen=True)
class Run:
    """What one run of the algorithm gave.

    Attributes:
        basis: The reduced Gröbner basis, monic, by increasing leading monomials.
        idle: The numbers of the pairs that reduced to zero, in the order in which pairs were taken.
    """

    basis: tuple[Poly, ...]
    idle: frozenset[int]


@dataclass
class _Pairs:
    """The polynomials so far and the pairs that wait: (degree, least common multiple, number, first, second).

    Pairs are numbered as they come, so that of two with one least common multiple the older is the smaller tuple.
    """

    polynomials: list[Poly]
    leads: list[Monomial]
    needed: list[bool]
    waiting: list[tuple[int, Monomial, int, int, int]]
    n_pairs: int = 0

    def add(self, p: Poly) -> None:
        """Add a polynomial with its pairs, without those that the criteria find superfluous."""
        new, k = leading(p), len(self.polynomials)
        self.waiting = [
            pair
            for pair in self.waiting
            if not (
                divides(new, pair[1])
                and common_multiple(new, self.leads[pair[3]]) != pair[1]
                and common_multiple(new, self.leads[pair[4]]) != pair[1]
            )
        ]
        fresh = [(common_multiple(new, self.leads[i]), i) for i in range(k) if self.needed[i]]
        coprime = {i for _, i in fresh if not any(map(mul, new, self.leads[i]))}
        # of the pairs with one least common multiple a coprime one comes first, and none of them is needed then
        fresh.sort(key=lambda pair: (sum(pair[0]), pair[1] not in coprime))
        kept: list[Monomial] = []
        for multiple, i in fresh:
            if any(divides(m, multiple) for m in kept):
                continue
            kept.append(multiple)
            if i not in coprime:
                self.waiting.append((sum(multiple), multiple, self.n_pairs, i, k))
                self.n_pairs += 1
        for i in range(k):
            self.needed[i] = self.needed[i] and not divides(new, self.leads[i])
        self.polynomials.append(p)
        self.leads.append(new)
        self.needed.append(True)

    def next_pair(self) -> tuple[Monomial, int, int]:
        """The least common multiple of the pair of smallest degree that waits, and the pair."""
        first = min(self.waiting)
        self.waiting.remove(first)
        _, multiple, _, i, j = first
        return multiple, i, j

    def difference(self, multiple: Monomial, i: int, j: int) -> Poly:
        """The S-polynomial of two monic polynomials."""
        context = self.polynomials[i].context()
        shifts = [context.from_dict({tuple(map(sub, multiple, self.leads[k])): 1}) for k in (i, j)]
        return shifts[0] * self.polynomials[i] - shifts[1] * self.polynomials[j]

    def remainder(self, p: Poly, budget: Budget, words: int) -> Poly:
        """The remainder modulo the polynomials whose leading monomial is no multiple of another one."""
        return remainder(p, self.minimal(), budget, words, compress(self.leads, self.needed))

    def minimal(self) -> list[Poly]:
        """The polynomials whose leading monomial is no multiple of another one."""
        return list(compress(self.polynomials, self.needed))


def buchberger(generators: Sequence[Poly], budget: Budget, idle: frozenset[int] = frozenset(), words: int = 1) -> Run:
    """The reduced Gröbner basis of the ideal that some polynomials generate, in the order of their context.

    Args:
        generators: Polynomials over a field.
        budget: Where the work is accounted.
        idle: Pairs that are known to reduce to zero, from a run modulo another prime: they are left out.
        words: Size of the coefficients in machine words, for the account.

    Raises:
        NotDecidedError: the budget was spent.
    """
    pairs = _Pairs([], [], [], [])
    for generator in sorted((g for g in generators if g), key=lambda g: (g.total_degree(), len(g))):
        if p := pairs.remainder(generator, budget, words):
            pairs.add(monic(p))
    zeros: set[int] = set()
    count = -1
    while pairs.waiting:
        count += 1
        multiple, i, j = pairs.next_pair()
        budget.spend(1.0 * len(pairs.polynomials), "choice of a pair")
        if count in idle:
            continue
        if p := pairs.remainder(pairs.difference(multiple, i, j), budget, words):
            pairs.add(monic(p))
        else:
            zeros.add(count)
    return Run(reduced(pairs.minimal(), budget, words), frozenset(zeros) | idle)


def reduced(basis: Sequence[Poly], budget: Budget | None = None, words: int = 1) -> tuple[Poly, ...]:
    """The reduced Gröbner basis, from one of the same ideal."""
    leads = [leading(p) for p in basis]
    minimal = [
        k
        for k, lead in enumerate(leads)
        if not any(divides(other, lead) and (other != lead or j < k) for j, other in enumerate(leads) if j != k)
    ]
    found: list[Poly] = []
    for k in minimal:
        others = [j for j in minimal if j != k]
        left = remainder(basis[k], [basis[j] for j in others], budget, words, [leads[j] for j in others])
        found.append(monic(left))
    return tuple(sorted(found, key=lambda p: (sum(leading(p)), leading(p))))


def are_groebner(basis: Sequence[Poly], budget: Budget, words: int = 1) -> bool:
    """Whether monic polynomials are a Gröbner basis of the ideal that they generate: all S-polynomials reduce to zero.

    Raises:
        NotDecidedError: the budget was spent.
    """
    pairs = _Pairs([], [], [], [])
    for p in basis:
        pairs.add(p)
    while pairs.waiting:
        multiple, i, j = pairs.next_pair()
        if remainder(pairs.difference(multiple, i, j), basis, budget, words, pairs.leads):
            return False
    return True
