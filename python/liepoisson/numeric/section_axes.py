"""Which two coordinates of the crossings a figure of a section shows where none are named."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liepoisson.arrays import Array

_CONSTANT = 1e-9
"""Width of the values of a coordinate, relative to the largest of all coordinates, that is round-off."""


def default_axes(components: Sequence[str], states: Array) -> tuple[str, str]:
    """The last component across and the second up; of coordinates and momenta a coordinate across and its momentum up.

    Where one of both is constant on the section, the two before them are taken, and so on: on the section y = 0 of a
    system in (x, y, p_x, p_y) not y and p_y, but x and p_x.

    Args:
        components: Names of the components.
        states: States of the crossings, shape (crossing, component).
    """
    n = len(components)
    last, second = (n // 2 - 1, n - 1) if _is_canonical(components) else (n - 1, min(1, n - 1))
    finite = states[np.isfinite(states).all(axis=-1)]
    if len(finite):
        varies = np.ptp(finite, axis=0) > _CONSTANT * np.abs(finite).max()
        for back in range(n):
            across, up = (last - back) % n, (second - back) % n
            if across != up and varies[across] and varies[up]:
                return components[across], components[up]
    return components[last], components[second]


def _is_canonical(components: Sequence[str]) -> bool:
    """Whether the second half of the names are those that momenta of the first half have: p_x of x, and p1 of q1."""
    half = len(components) // 2
    pairs = zip(components[:half], components[half:], strict=False)
    return len(components) == 2 * half and all(
        p == f"p_{q}" or (q.startswith("q") and p == f"p{q[1:]}") for q, p in pairs
    )
