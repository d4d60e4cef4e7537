r"""Poisson tensors whose entries are polynomials of any degree, sparse and over an exact field.

The search for Casimirs needs no more of a tensor than its terms (`liepoisson.structure.poisson.casimir_search`).  Those
of lower degree than the highest are made homogeneous by factors of the constant coordinate, $x_{-1} = 1$.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.residues import Residues
from liepoisson.algebra.sparse_polynomials import Monomial, Polynomial
from liepoisson.structure.poisson.poisson_tensor import CONSTANT, Ranked


@dataclass(frozen=True)
class PolynomialTensor(Ranked):
    r"""The polynomials $J_{ij}(x)$, i < j, with coefficients in an exact field.

    Attributes:
        dimension: Number N of coordinates.
        field: Where the coefficients live.
        entries: The nonzero entries by (i, j) with i < j.
    """

    dimension: int
    field: Coefficients
    entries: Mapping[tuple[int, int], Polynomial]

    @property
    def block(self) -> int:
        """Number of coordinates of a field: all, as there is one field."""
        return self.dimension

    @cached_property
    def degree(self) -> int:
        """The highest degree of an entry."""
        return max((len(m) for entry in self.entries.values() for m in entry), default=0)

    @cached_property
    def is_homogeneous(self) -> bool:
        """Whether all monomials have the highest degree."""
        return all(len(m) == self.degree for entry in self.entries.values() for m in entry)

    def terms(self) -> Iterator[tuple[int, int, Monomial, Any]]:
        """All (i, j, m, c), both orders of i and j, the monomials m of one length."""
        for (i, j), entry in self.entries.items():
            for monomial, c in entry.items():
                padded = (CONSTANT,) * (self.degree - len(monomial)) + monomial
                yield i, j, padded, c
                yield j, i, padded, -c

    def at(self, point: Sequence[Any]) -> list[dict[int, Any]]:
        """The matrix at a point whose coordinates are elements of the field, as sparse rows."""
        return self._rows({pair: _value(entry, point, self.field.one) for pair, entry in self.entries.items()})

    def rows_modulo(self, point: Sequence[int], residues: Residues) -> list[dict[int, int]]:
        """The matrix at a point modulo the prime of the residues."""
        return self._rows({pair: _residue(entry, point, residues) for pair, entry in self.entries.items()})

    def _rows(self, values: Mapping[tuple[int, int], Any]) -> list[dict[int, Any]]:
        rows: list[dict[int, Any]] = [{} for _ in range(self.dimension)]
        for (i, j), value in values.items():
            if value:
                rows[i][j], rows[j][i] = value, -value
        return rows


def _value(polynomial: Polynomial, point: Sequence[Any], one: Any) -> Any:
    total: Any = one - one
    for monomial, c in polynomial.items():
        term = c
        for k in monomial:
            term = term * point[k]
        total = total + term
    return total


def _residue(polynomial: Polynomial, point: Sequence[int], residues: Residues) -> int:
    total = 0
    for monomial, c in polynomial.items():
        term = residues(c)
        for k in monomial:
            term = term * point[k] % residues.p
        total += term
    return total % residues.p
