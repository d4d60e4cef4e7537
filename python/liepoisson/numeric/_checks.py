"""Checks that the functions of the numeric wing share: systems, shapes, numbers, counts, threads, outcomes."""

from __future__ import annotations

import operator
import os
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson import _core
from liepoisson.arrays import Array, as_array, as_double
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.field import Field, PiecesField, QuadraticField, TopField
from liepoisson.wrong_values import shown

MOST = 2**63 - 1
"""Largest count: what a signed integer of 64 bits holds."""

TIME_LIMIT = 3600.0
"""Default budget: seconds that a run may take."""

MOST_THREADS = 4096
"""Far above any machine: a larger number, also of processes, is a slip of the finger."""

TOP_COMPONENTS = tuple(f"{vector}{i}" for vector in ("l", "alpha", "beta") for i in (1, 2, 3))


class HasField(Protocol):
    """What the numeric wing needs to know of a system."""

    @property
    def name(self) -> str:
        """Name of the system, for results."""
        ...

    def field(self) -> Field:
        """The vector field as plain data."""
        ...


def as_count(value: Any, name: str, *, least: int = 0, most: int = MOST, hint: str = "") -> int:
    """A whole number from `least` to `most` as a plain int; NumPy's integers are taken, fractions and booleans not."""
    try:
        number = operator.index(value)
    except TypeError:
        number = None
    if number is None or isinstance(value, bool) or not least <= number <= most:
        wanted = f"a whole number >= {least}" if most >= MOST else f"a whole number from {least} to {most}"
        if most == MOST:
            wanted += ", below 2**63"
        raise ParameterError(f"{name}: wanted {wanted}; got {shown(value)}; {hint or f'try {name}={least}'}")
    return number


def as_number(value: Any, name: str, wanted: str) -> float:
    """A real number as a plain float, also an exact one as a text ("1/3"); complex numbers, dates, booleans are not."""
    scalar = value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value
    numeric = scalar.dtype.kind in "iuf" if isinstance(scalar, np.generic) else not isinstance(scalar, bool)
    try:
        if type(scalar) is str:
            return as_double(scalar, name)
        if numeric and hasattr(scalar, "__float__") and not isinstance(scalar, (type, np.ndarray)):
            return float(scalar)
    except (TypeError, ValueError, OverflowError):
        pass  # refused below, with all the others
    raise ParameterError(f"{name}: wanted {wanted}; got {shown(value)}; give a plain number")


def as_field(system: Any) -> Field:
    """The vector field of a system."""
    if isinstance(system, type) or not callable(getattr(system, "field", None)) or not hasattr(system, "name"):
        raise ParameterError(
            f"system: wanted a system such as Top.kovalevskaya(); got {shown(system)}; make one, or call its class"
        )
    return system.field()


def core_field(field: Field) -> _core.Field:
    """The field as the core takes it."""
    if isinstance(field, TopField):
        return _core.Field.top(field.inertia, field.a, field.b, field.epsilon)
    if isinstance(field, QuadraticField):
        return _core.Field.quadratic(field.n_components, field.constant, field.linear, field.quadratic)
    if isinstance(field, PiecesField):
        return _core.Field.pieces(field.n_components, field.pieces)
    return _core.Field.tape(field.n_components, field.instructions, field.outputs)


def component_names(system: Any, n: int) -> tuple[str, ...]:
    """Names of the components of the state: the system's own, else those of the tops, else x1, x2, ..."""
    names = getattr(system, "component_names", None)
    if names is not None:
        return tuple(names)
    return TOP_COMPONENTS if n == len(TOP_COMPONENTS) else tuple(f"x{i + 1}" for i in range(n))


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


def as_threads(threads: int | None) -> int:
    """Number of threads; by default the processors that this process may use."""
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return as_count(threads, "threads", least=1, most=MOST_THREADS, hint="leave it out to use all processors")


def as_time_limit(seconds: float) -> float:
    """Seconds that a run may take."""
    limit = as_number(seconds, "time_limit", "a positive number of seconds")
    if not limit > 0:
        raise ParameterError(f"time_limit: wanted a positive number of seconds; got {limit!r}; try 60")
    return limit


def outcome_names(codes: NDArray[np.int8]) -> NDArray[np.str_]:
    """Outcomes by name."""
    return np.array(_core.outcomes())[codes]


def _abridged(values: Sequence[float] | Array) -> str:
    return np.array2string(np.asarray(values), threshold=6, edgeitems=3)


def trajectories(outcome: NDArray[np.str_]) -> str:
    """How many there are, and how many of them failed, as a `repr` says it."""
    failed = int(np.sum(outcome != "finished"))
    return f"{outcome.size} trajector{'y' if outcome.size == 1 else 'ies'}" + (f" ({failed} failed)" if failed else "")


def typical(quantity: str, values: Array) -> str:
    """The median of the finite ones among the values, as a `repr` says it: the value itself if there is one."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return f"no {quantity}"
    return f"{'median ' if finite.size > 1 else ''}{quantity} {np.median(finite):.4g}"
