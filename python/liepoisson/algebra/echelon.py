"""Echelon forms of sparse vectors that come one by one, over the field of their coefficients.

Where all rows are known beforehand, `linear_algebra` takes the shortest first and is faster; `linear_systems` prefers
pivots without symbols and notes the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from liepoisson.algebra.coefficients import Coefficients, Element
    from liepoisson.algebra.linear_algebra import Row, Vector


class Echelon:
    """The reduced row echelon form of vectors that come one by one, sparse: row by pivot, pivot entry 1.

    Args:
        field: Where the entries live.

    Attributes:
        rows: The rows, by pivot.
    """

    def __init__(self, field: Coefficients) -> None:
        self.field = field
        self.rows: dict[int, Vector] = {}

    def __len__(self) -> int:
        return len(self.rows)

    def reduce(self, vector: Row) -> Vector:
        """What is left of the vector modulo the rows."""
        left = dict(vector)
        for pivot in sorted(left.keys() & self.rows.keys()):
            # The rows are reduced: subtracting one never fills the pivot of another.
            self._subtract(left, left[pivot], self.rows[pivot])
        return left

    def insert(self, vector: Row) -> bool:
        """Add a vector to the span; False if it was in it."""
        left = self.reduce(vector)
        if not left:
            return False
        pivot = min(left)
        inverse = self.field.one / left[pivot]
        monic = {k: value * inverse for k, value in left.items()}
        for row in self.rows.values():
            if pivot in row:
                self._subtract(row, row[pivot], monic)
        self.rows[pivot] = monic
        return True

    def basis(self) -> list[Vector]:
        """The rows, by pivot."""
        return [self.rows[pivot] for pivot in sorted(self.rows)]

    def null_space(self, n: int) -> list[Vector]:
        """A basis of the vectors v of length n with row . v = 0 for all rows."""
        free = [k for k in range(n) if k not in self.rows]
        kernel: dict[int, Vector] = {k: {k: self.field.one} for k in free}
        for pivot, row in self.rows.items():
            for k, value in row.items():
                if k != pivot:
                    kernel[k][pivot] = -value
        return [kernel[k] for k in free]

    def _subtract(self, target: Vector, factor: Element, row: Row) -> None:
        for k, value in row.items():
            new = target[k] - factor * value if k in target else -(factor * value)
            if self.field.vanishes(new):
                target.pop(k, None)
            else:
                target[k] = new
