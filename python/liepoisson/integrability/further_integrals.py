r"""Whether the integrals at a point of the parameters are polynomials in known ones: in H, the Casimirs, and others.

The known integrals $f_1,\dots,f_r$ generate an algebra A, and the null space N of D up to a degree d is compared with
the part of A up to that degree. Three arguments decide it:

1. An element of N whose gradient is no combination of theirs is functionally independent of them.
2. If the leading forms of the $f_i$ are algebraically independent, nothing cancels in a polynomial in the $f_i$, and
   the part of A is spanned by products of degree at most d.
3. Otherwise high degrees may cancel: at equal moments $H-\tfrac12aC_1 = k\cdot\ell$. Let the $f_i$ be independent. On a
   general plane of dimension r they have finite fibres, and the preimage of a line is a curve of degree at most
   $\delta$, the product of the r - 1 largest degrees (Bézout). Along it coordinates grow at most as $t^\delta$, so
   $F = P(f)$ of degree d has $\deg P\le d\delta$. Products up to that degree are tried, lowest first.

All of it at random points modulo a prime of 61 bits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.linear_algebra import nullspace_mod, rank_mod
from liepoisson.algebra.number_fields import Element, PrimeField
from liepoisson.algebra.residues import Residues
from liepoisson.algebra.sparse_polynomials import Polynomial, gradient_at, multiply, value_at
from liepoisson.integrability.derivation import Exponents
from liepoisson.integrability.level import Level
from liepoisson.integrability.modular import random_point
from liepoisson.integrability.parameter_cases import Poly, SparseRow
from liepoisson.integrability.parameter_matrix import ParameterMatrix
from liepoisson.integrability.search import Label, point_on_level

_MOST_PRODUCTS = 1500
"""Products of known integrals of one comparison; beyond them it is not decided."""

ParameterPolynomial = dict[Exponents, Poly]
"""A polynomial in the coordinates whose coefficients are polynomials in the parameters."""


@dataclass(frozen=True)
class Block:
    """A block of the search.

    Attributes:
        label: The weights of its monomials.
        monomials: They, largest first.
        rows: The matrix of D on them, with entries in the parameters.
    """

    label: Label
    monomials: list[Exponents]
    rows: list[SparseRow]


@dataclass(frozen=True)
class Comparison:
    """The integrals at a point, compared with polynomials in known ones.

    Attributes:
        is_further: Whether there is one that is none; None if it was not decided.
        is_independent: Whether there is one that is functionally independent of the known ones.
        nullities: The number of integrals in each block.
    """

    is_further: bool | None
    is_independent: bool
    nullities: dict[Label, int]


class IntegralsAtPoints:
    """Null spaces at points of the parameters modulo primes.

    Args:
        matrix: The equations of motion, and the level.
        blocks: The blocks of all monomials up to the degree.
        degree: The degree.
    """

    def __init__(self, matrix: ParameterMatrix, blocks: Sequence[Block], degree: int) -> None:
        self.matrix, self.blocks, self.degree = matrix, blocks, degree

    def compare(self, point: list[Element], p: int, known: Sequence[ParameterPolynomial]) -> Comparison:
        """The integrals at a point and polynomials in known ones."""
        vectors: list[Polynomial] = []
        nullities: dict[Label, int] = {}
        values: dict[str, Element] = {}
        number = PrimeField(p).number

        def value(q: Poly) -> Element:
            text = str(q)
            if text not in values:
                values[text] = value_at(q.terms(), point, number)
            return values[text]

        for block in self.blocks:
            rows = [{c: x for c, q in row.items() if (x := value(q))} for row in block.rows]
            found = nullspace_mod([row for row in rows if row], len(block.monomials), p)
            nullities[block.label] = len(found)
            vectors += [{block.monomials[c]: number(x) for c, x in vector.items()} for vector in found]
        is_further, is_independent = self._algebra(point, p, known).contains(vectors)
        return Comparison(None if is_further is None else not is_further, is_independent, nullities)

    def contains(
        self, point: list[Element], p: int, known: Sequence[ParameterPolynomial], function: ParameterPolynomial
    ) -> bool | None:
        """Whether a function is a polynomial in known ones at a point; None if it was not decided."""
        algebra = self._algebra(point, p, known)
        return algebra.contains([algebra.level.remainder(_at(function, point, p))])[0]

    def _algebra(self, point: list[Element], p: int, known: Sequence[ParameterPolynomial]) -> _Algebra:
        level = Level(tuple((lead, _at(b, point, p)) for lead, b in self.matrix.level.basis))
        zeros = [_at(zero, point, p) for zero in self.matrix.zeros]
        functions = [level.remainder(_at(f, point, p)) for f in known]
        return _Algebra([{m: c for m, c in f.items() if any(m)} for f in functions], level, zeros, self.degree, p)


def _at(polynomial: Mapping[Exponents, Poly], point: list[Element], p: int) -> Polynomial:
    number = PrimeField(p).number
    return {m: c for m, q in polynomial.items() if (c := value_at(q.terms(), point, number))}


class _Algebra:
    """Polynomials in some functions without constant terms, modulo a prime, on a level."""

    def __init__(
        self, functions: Sequence[Polynomial], level: Level, zeros: Sequence[Polynomial], degree: int, p: int
    ) -> None:
        self.level, self.degree, self.residues = level, degree, Residues(p)
        self.zeros = [zero for zero in zeros if zero]
        self.functions = sorted((f for f in functions if f), key=lambda f: (_degree(f), len(f)))

    def contains(self, vectors: Sequence[Polynomial]) -> tuple[bool | None, bool]:
        """Whether all of some polynomials up to the degree are polynomials in the functions; None if not decided.

        And whether one of them is functionally independent of the functions.
        """
        if not vectors:
            return True, False
        n = len(next(iter(vectors[0])))
        place = point_on_level(self.zeros, self.residues, n)
        basis = self._independent(self.functions, place)
        gradients = [gradient_at(f, place) for f in (*self.zeros, *self.functions, *vectors)]
        if rank_mod(gradients, n, self.residues.p) > len(basis) + self._rank(self.zeros, place):
            return False, True
        return self._spans(vectors, basis, n), False

    def _spans(self, vectors: Sequence[Polynomial], basis: Sequence[Polynomial], n: int) -> bool | None:
        degrees = sorted((_degree(f) for f in basis), reverse=True)
        tops = [{m: c for m, c in f.items() if sum(m) == _degree(f)} for f in basis]
        is_exact = len(basis) == len(self.functions) and not self.level.basis
        exact_up_to = self.degree * prod(degrees[:-1]) * max(degrees, default=1) if is_exact else None
        if is_exact and self._rank(tops, random_point(n, self.residues, seed=2)) == len(basis):
            exact_up_to = self.degree
        span, total = Echelon(self.residues.field), 0
        weight = 0
        while True:
            weight += 1
            new = self._products(weight)
            total += len(new)
            if total > _MOST_PRODUCTS:
                return None if is_exact else False
            for product in new:
                span.insert(_by_degree(product))
            if weight < self.degree:
                continue
            if not any(span.reduce(_by_degree(v)) for v in vectors):
                return True
            if exact_up_to is not None and weight >= exact_up_to:
                return False
            # of functions with relations, or on a level, only some more products are tried
            if exact_up_to is None and weight >= self.degree + max(map(_degree, self.functions), default=0):
                return False

    def _products(self, weight: int) -> list[Polynomial]:
        """The products of the functions whose degrees have this sum."""
        found: list[Polynomial] = []

        def extend(start: int, left: int, product: Polynomial | None) -> None:
            if not left and product is not None:
                remainder = self.level.remainder(product)
                found.append({m: c for m, c in remainder.items() if any(m)})
            for k in range(start, len(self.functions)):
                f = self.functions[k]
                if (size := _degree(f)) <= left and len(found) <= _MOST_PRODUCTS:
                    extend(k, left - size, f if product is None else multiply(product, f))

        extend(0, weight, None)
        return found

    def _independent(self, functions: Sequence[Polynomial], place: list[Element]) -> list[Polynomial]:
        """Functions whose gradients at a point are independent of each other and of those of the level."""
        found: list[Polynomial] = []
        rank = self._rank(self.zeros, place)
        for f in functions:
            if self._rank([*self.zeros, *found, f], place) > rank + len(found):
                found.append(f)
        return found

    def _rank(self, functions: Sequence[Polynomial], place: list[Element]) -> int:
        return rank_mod([gradient_at(f, place) for f in functions], len(place), self.residues.p)


def _by_degree(f: Polynomial) -> Polynomial:
    """The polynomial with minus the degree before the exponents, so that the highest degree comes first."""
    return {(-sum(m), *m): c for m, c in f.items()}


def _degree(f: Mapping[Exponents, Any]) -> int:
    return max(map(sum, f))
