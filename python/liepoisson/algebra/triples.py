"""Vectors of three scalars of one kind: SymPy expressions, rational polynomials or numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

Scalar: TypeAlias = Any
"""Whatever can be added and multiplied."""


@dataclass(frozen=True, slots=True)
class Triple:
    """Three components, in the formulas of tops."""

    first: Scalar
    second: Scalar
    third: Scalar

    def __iter__(self) -> Iterator[Scalar]:
        return iter((self.first, self.second, self.third))

    def __getitem__(self, k: int) -> Scalar:
        return (self.first, self.second, self.third)[k]

    def __add__(self, other: Triple) -> Triple:
        return Triple(*(x + y for x, y in zip(self, other, strict=True)))

    def __rmul__(self, factor: Scalar) -> Triple:
        return Triple(*(factor * x for x in self))

    def dot(self, other: Triple) -> Scalar:
        """The inner product."""
        return self[0] * other[0] + self[1] * other[1] + self[2] * other[2]

    def cross(self, other: Triple) -> Triple:
        """The vector product."""
        return Triple(*(self[i] * other[j] - self[j] * other[i] for i, j in ((1, 2), (2, 0), (0, 1))))
