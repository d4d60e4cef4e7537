"""States and times that a caller gives, as arrays of the shapes that runs take."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.arrays import Array, as_array
from liepoisson.errors import ParameterError, ShapeError


def as_states(starts: ArrayLike, n_components: int, name: str = "starts", *, some_may_fail: bool = False) -> Array:
    """A copy of states as an array of shape (trajectory, component); one state may come without the first axis.

    Where some may fail, rows that are not finite are kept beside good ones: their trajectories end at once, with an
    outcome, and the others run.
    """
    states = as_array(starts, name)
    if states.ndim not in (1, 2) or states.shape[-1] != n_components:
        hint = " Transpose it?" if states.ndim == 2 and states.shape[0] == n_components else ""
        raise ShapeError(
            f"{name} must have shape ({n_components},) or (trajectory, {n_components}); got shape {states.shape}.{hint}"
        )
    states = np.atleast_2d(states)
    bad = ~np.isfinite(states).all(axis=1)
    if bad.any() and (bad.all() or not some_may_fail):
        raise ParameterError(
            f"{name}: wanted finite numbers; trajectory {int(np.argmax(bad))} of {len(states)} has a NaN or an "
            f"infinity ({int(bad.sum())} such in all); drop these rows"
        )
    return states


def as_times(times: ArrayLike, name: str, *, least: int) -> Array:
    """A copy of finite, strictly monotone times, at least `least` of them."""
    times = np.atleast_1d(as_array(times, name))
    if times.ndim != 1 or len(times) < least:
        raise ShapeError(f"{name} must have shape (time,) with {least} or more times; got shape {times.shape}")
    steps = np.diff(times)
    if not np.isfinite(times).all() or not (np.all(steps > 0) or np.all(steps < 0)):
        raise ParameterError(
            f"{name}: wanted finite, strictly increasing or strictly decreasing times; got {_abridged(times)}; "
            "sort them and drop repeated ones"
        )
    return times


def _abridged(values: Sequence[float] | Array) -> str:
    return np.array2string(np.asarray(values), threshold=6, edgeitems=3)
