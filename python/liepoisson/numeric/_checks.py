"""Checks that the functions of the numeric wing share: shapes, finite numbers, threads, outcomes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson import _core
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.field import TopField, Vector3

Array = NDArray[np.float64]


class HasField(Protocol):
    """What the numeric wing needs to know of a system."""

    @property
    def name(self) -> str:
        """Name of the system, for results."""
        ...

    def field(self) -> TopField:
        """The vector field as plain data."""
        ...


def core_parameters(field: TopField) -> tuple[Vector3, Vector3, Vector3, float]:
    """The parameters of a top as the core takes them."""
    return field.inertia, field.a, field.b, field.epsilon


def as_states(x0: ArrayLike, n_components: int, name: str = "x0") -> Array:
    """States as an array of shape (trajectory, component); one state may come without the first axis."""
    states = _as_array(x0, name)
    if states.ndim not in (1, 2) or states.shape[-1] != n_components:
        hint = " Transpose it?" if states.ndim == 2 and states.shape[0] == n_components else ""
        raise ShapeError(
            f"{name} must have shape ({n_components},) or (trajectory, {n_components}); got shape {states.shape}.{hint}"
        )
    states = np.atleast_2d(states)
    bad = ~np.isfinite(states).all(axis=1)
    if bad.any():
        raise ParameterError(
            f"{name}: wanted finite numbers; trajectory {int(np.argmax(bad))} of {len(states)} has a NaN or an "
            f"infinity ({int(bad.sum())} such in all); drop these rows"
        )
    return np.ascontiguousarray(states)


def as_times(t: ArrayLike, name: str, *, least: int) -> Array:
    """Finite, strictly monotone times, at least `least` of them."""
    times = np.atleast_1d(_as_array(t, name))
    if times.ndim != 1 or len(times) < least:
        raise ShapeError(f"{name} must have shape (time,) with {least} or more times; got shape {times.shape}")
    steps = np.diff(times)
    if not np.isfinite(times).all() or not (np.all(steps > 0) or np.all(steps < 0)):
        raise ParameterError(
            f"{name}: wanted finite, strictly increasing or strictly decreasing times; got {_abridged(times)}; "
            "sort them and drop repeated ones"
        )
    return np.ascontiguousarray(times)


def as_threads(threads: int | None) -> int:
    """Number of threads; by default the processors that this process may use."""
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if threads < 1:
        raise ParameterError(
            f"threads: wanted a positive whole number; got {threads}; leave it out to use all processors"
        )
    return int(threads)


def outcome_names(codes: NDArray[np.int8]) -> NDArray[np.str_]:
    """Outcomes by name."""
    return np.array(_core.outcomes())[codes]


def _as_array(values: ArrayLike, name: str) -> Array:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ShapeError(f"{name}: wanted an array of numbers; got {type(values).__name__} ({error})") from error


def _abridged(values: Sequence[float] | Array) -> str:
    return np.array2string(np.asarray(values), threshold=6, edgeitems=3)
