"""Which two coordinates of the crossings a figure of a section shows where none are named."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from liepoisson.inputs.arrays import Array
from liepoisson.portable import linear

_ROUND_OFF, _NOTHING = 1e-9, 1e-14
"""Width of the values of a coordinate, relative to its size along the orbits, and of a figure across its longest
extent, that is round-off; width relative to the largest of all coordinates that is, too."""


def default_axes(
    components: Sequence[str], states: Array, beside: Array | None = None, idle: Collection[str] = ()
) -> tuple[str, str]:
    """The last component across and the second up; of coordinates and momenta a coordinate across and its momentum up.

    Where one of both is constant on the section, or all points are on one line, the two before are taken, and so on: on
    the section y = 0 of a system in (x, y, p_x, p_y) not y and p_y, but x and p_x.

    Args:
        components: Names of the components.
        states: States of the crossings, shape (crossing, component).
        beside: States of the same orbits elsewhere, shape (state, component): they tell how large a coordinate is that
            vanishes on the section.
        idle: Names of components that are taken only where no two others will do.
    """
    n = len(components)
    last, second = (n // 2 - 1, n - 1) if _is_canonical(components) else (n - 1, min(1, n - 1))
    finite = states[np.isfinite(states).all(axis=-1)]
    if len(finite) > 1:
        others = finite if beside is None else np.concatenate([finite, beside[np.isfinite(beside).all(axis=-1)]])
        sizes = np.abs(others).max(axis=0)
        unit = np.where(sizes > 0, sizes, 1.0)
        centred = (finite - finite.mean(axis=0)) / unit
        width = np.ptp(finite, axis=0)
        varies = (width > _ROUND_OFF * sizes) & (width > _NOTHING * sizes.max())
        acting = [k for k in range(n) if components[k] not in idle]
        if _is_canonical(components):
            pairs = sorted(_pairs(range(n), last, second), key=lambda pair: not {*pair} <= {*acting})
        else:
            pairs = _pairs(acting, len(acting) - 1, 1) + _pairs(range(n), last, second)
        for across, up in pairs:
            if across != up and varies[across] and varies[up] and _fills_a_plane(centred[:, (across, up)]):
                return components[across], components[up]
    return components[last], components[second]


def _pairs(places: Sequence[int], last: int, second: int) -> list[tuple[int, int]]:
    """The last and the second of some places, then in turn those before both, then all others."""
    n = len(places)
    pairs = [(places[(last - back) % n], places[(second - back) % n]) for back in range(n)]
    return pairs + [(across, up) for across in reversed(places) for up in places if up < across]


def _fills_a_plane(points: Array) -> bool:
    """Whether points are on no line, each coordinate in units of its width."""
    longest, shortest = linear.svd(points / np.ptp(points, axis=0), compute_uv=False)
    return len(points) < 3 or bool(shortest > _ROUND_OFF * longest)


def _is_canonical(components: Sequence[str]) -> bool:
    """Whether the second half of the names are those that momenta of the first half have: p_x of x, and p1 of q1."""
    half = len(components) // 2
    pairs = zip(components[:half], components[half:], strict=False)
    return len(components) == 2 * half and all(
        p == f"p_{q}" or (q.startswith("q") and p == f"p{q[1:]}") for q, p in pairs
    )
