"""Echelon forms of sparse vectors over any field: span, normal forms, null space.

A vector is a dictionary from key to nonzero element; keys are columns, monomials, or whatever has an order.  A row
leads with its smallest key, where it has a 1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeAlias

from liepoisson.algebra.number_fields import Element, NumberField
from liepoisson.inputs.deadline import checkpoint

Row: TypeAlias = "Mapping[Any, Element]"
Vector: TypeAlias = "dict[Any, Element]"


class Echelon:
    """A row echelon form, to which vectors are added one by one.

    Rows are reduced by each other when they are asked for.  Where all vectors are known beforehand, the shortest first
    costs least.

    Args:
        field: Where the entries live.
        vectors: The first vectors.

    Attributes:
        rows: The rows, by their leading keys.
        pivots: What was divided by, one element for each row, in the order in which they came.
    """

    def __init__(self, field: NumberField, vectors: Iterable[Row] = ()) -> None:
        self.field = field
        self.rows: dict[Any, Vector] = {}
        self.pivots: list[Element] = []
        for vector in vectors:
            self.insert(vector)

    def __len__(self) -> int:
        return len(self.rows)

    def insert(self, vector: Row) -> bool:
        """Add a vector to the span; False if it was in it.

        Raises:
            TimeLimitError: the deadline of the call has passed.
        """
        left = dict(vector)
        while left:
            lead = min(left)
            if lead not in self.rows:
                self.pivots.append(left[lead])
                inverse = self.field.inverse(left[lead])
                self.rows[lead] = {k: value * inverse for k, value in left.items()}
                return True
            self.subtract(left, left[lead], self.rows[lead])
        return False

    def reduce(self, vector: Row) -> Vector:
        """The normal form of a vector modulo the span: without leading keys, empty if it is in the span."""
        left = dict(vector)
        while leads := left.keys() & self.rows.keys():
            lead = min(leads)
            self.subtract(left, left[lead], self.rows[lead])
        return left

    def basis(self) -> list[Vector]:
        """The reduced rows, by their leading keys."""
        for lead in sorted(self.rows, reverse=True):
            row = self.rows[lead]
            for other in [k for k in row if k != lead and k in self.rows]:
                self.subtract(row, row[other], self.rows[other])
        return [self.rows[lead] for lead in sorted(self.rows)]

    def null_space(self, n: int) -> list[Vector]:
        """A basis of the vectors v of length n with row . v = 0 for all rows, in the form of `null_vectors`."""
        return null_vectors(self.basis(), n, self.field.one)

    def subtract(self, target: Vector, factor: Element, row: Row) -> None:
        """Target -= factor * row, in place, dropping what vanishes.

        Raises:
            TimeLimitError: the deadline of the call has passed.
        """
        checkpoint("an elimination")
        vanishes = self.field.vanishes
        for k, value in row.items():
            difference = target[k] - factor * value if k in target else -(factor * value)
            if vanishes(difference):
                target.pop(k, None)
            else:
                target[k] = difference


def eliminated(
    rows: Iterable[Row], n: int, field: NumberField, prefers: Callable[[Element], bool] = lambda _: True
) -> tuple[Echelon, list[Vector]]:
    """The echelon form by the first n columns, one after the other, and what is left of the rows that lead none.

    Args:
        rows: The rows of a matrix, which may have more columns: right-hand sides.
        n: The number of columns in which rows may lead.
        field: Where the entries live.
        prefers: Which pivots are taken before others; of these it is the first.
    """
    left, echelon = [dict(row) for row in rows], Echelon(field)
    for column in range(n):
        candidates = [k for k, row in enumerate(left) if column in row]
        if not candidates:
            continue
        k = next((k for k in candidates if prefers(left[k][column])), candidates[0])
        left[0], left[k] = left[k], left[0]
        echelon.insert(left.pop(0))
        for row in left:
            if column in row:
                echelon.subtract(row, row[column], echelon.rows[column])
    return echelon, left


def transposed(columns: Iterable[Row]) -> list[Vector]:
    """The rows of a matrix that is given by its columns, in the order in which their keys occur."""
    rows: dict[Any, Vector] = {}
    for k, column in enumerate(columns):
        for key, value in column.items():
            rows.setdefault(key, {})[k] = value
    return list(rows.values())


def sparse(row: Iterable[Element]) -> Vector:
    """A row by its nonzero entries."""
    return {column: value for column, value in enumerate(row) if value}


def dense(row: Row, columns: Iterable[int], zero: Element) -> list[Element]:
    """The entries of a row in some columns."""
    return [row.get(column, zero) for column in columns]


def null_vectors(reduced: Iterable[Row], n: int, one: Element) -> list[Vector]:
    """The vectors of length n that the rows of a reduced echelon form annihilate.

    One for each column that leads no row, in their order: it ends in a 1 there, where all others have 0.
    """
    rows = {min(row): row for row in reduced}
    found: dict[int, Vector] = {column: {} for column in range(n) if column not in rows}
    for lead, row in rows.items():
        for column, value in row.items():
            if column != lead:
                found[column][lead] = -value
    for column, vector in found.items():
        vector[column] = one
    return list(found.values())
