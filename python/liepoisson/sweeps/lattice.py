r"""The points of a sweep on a lattice of whole numbers, and the cells that refinement halves.

With L levels of refinement, the values of an axis lie at multiples of $2^L$; a cell of level k has sides of $2^{L-k}$.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from liepoisson.inputs.arrays import Array
from liepoisson.portable import elementary

if TYPE_CHECKING:
    from liepoisson.sweeps.spec import SweepSpec

Place: TypeAlias = tuple[int, ...]
"""A point of the lattice, a whole number for each axis."""


@dataclass(frozen=True)
class Cell:
    """A cell by its lowest corner and its side."""

    corner: Place  # the lowest corner
    side: int  # length of its sides, a power of two

    def corners(self) -> list[Place]:
        """All corners, two or four."""
        return self._grid((0, self.side))

    def halves(self) -> list[Cell]:
        """The two or four cells of half the side."""
        return [Cell(corner, self.side // 2) for corner in self._grid((0, self.side // 2))]

    def new_places(self) -> list[Place]:
        """What halving adds: the middle, and in two dimensions those of the four sides."""
        return [p for p in self._grid((0, self.side // 2, self.side)) if p not in self.corners()]

    def _grid(self, steps: Sequence[int]) -> list[Place]:
        return [
            tuple(c + s for c, s in zip(self.corner, shift, strict=True))
            for shift in product(steps, repeat=len(self.corner))
        ]


class Lattice:
    """The lattice of a sweep."""

    def __init__(self, spec: SweepSpec) -> None:
        self.levels = spec.refine.levels if spec.refine else 0
        self.unit = 2**self.levels
        self._spec = spec
        self.shape = tuple((n - 1) * self.unit + 1 for n in spec.shape)

    def grid(self) -> list[Place]:
        """The points of level 0, the last axis fastest."""
        return list(product(*(range(0, n, self.unit) for n in self.shape)))

    def cells(self) -> list[Cell]:
        """The cells of level 0; none along an axis of one value."""
        corners = product(*(range(0, n - 1, self.unit) for n in self.shape))
        return [Cell(corner, self.unit) for corner in corners]

    def coordinates(self, places: Sequence[Place]) -> Array:
        """Values of the axes, linear between the given ones, shape (point, axis)."""
        positions = np.array(places, np.float64).reshape(len(places), len(self.shape)) / self.unit
        columns = [
            elementary.interp(positions[:, k], np.arange(len(axis.values)), axis.values)
            for k, axis in enumerate(self._spec.axes)
        ]
        return np.stack(columns, axis=-1)


def split(cells: Sequence[Cell], statistic: Mapping[Place, float], difference: float) -> tuple[list[Cell], list[Place]]:
    """The halves of the cells whose corners differ by more than this, and the points that they need, in order."""
    halves: list[Cell] = []
    places: set[Place] = set()
    for cell in cells:
        values = np.array([statistic[corner] for corner in cell.corners()])
        values = values[np.isfinite(values)]
        if values.size > 1 and np.ptp(values) > difference:
            halves += cell.halves()
            places.update(place for place in cell.new_places() if place not in statistic)
    return halves, sorted(places)
