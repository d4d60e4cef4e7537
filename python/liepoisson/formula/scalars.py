"""Numbers, counts, threads and limits that a caller gives, as plain ones."""

from __future__ import annotations

import math
import operator
import os
from typing import Any

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.formula.numbers import as_double
from liepoisson.inputs.deadline import Deadline
from liepoisson.inputs.given import as_scalar
from liepoisson.inputs.refusals import shown

MOST = 2**63 - 1
"""Largest count: what a signed integer of 64 bits holds."""

LEAST_TIME, MOST_TIME = 1e-300, 1e300
"""A shorter time has too few doubles for the times in between, and multiples of one above 1e300 are no doubles."""

TIME_LIMIT = 3600.0
"""Default budget: seconds that a run may take."""

MOST_THREADS = 4096
"""Far above any machine: a larger number, also of processes, is a slip of the finger."""


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


def as_seed(seed: int) -> int:
    """A seed as a plain int: up to 128 bits, the entropy that numpy's `SeedSequence` keeps."""
    return as_count(seed, "seed", most=2**128 - 1)


def as_number(value: Any, name: str, wanted: str) -> float:
    """A real number as a plain float, also an exact one as a text ("1/3"); complex numbers, dates, booleans are not."""
    scalar = as_scalar(value)
    numeric = scalar.dtype.kind in "iuf" if isinstance(scalar, np.generic) else not isinstance(scalar, bool)
    try:
        if type(scalar) is str:
            return as_double(scalar, name)
        if numeric and hasattr(scalar, "__float__") and not isinstance(scalar, (type, np.ndarray)):
            return float(scalar)
    except (TypeError, ValueError, OverflowError):
        pass  # refused below, with all the others
    raise ParameterError(f"{name}: wanted {wanted}; got {shown(value)}; give a plain number")


def as_positive(value: Any, name: str, wanted: str, *, example: float, zero: bool = False) -> float:
    """A finite number above 0 as a plain float; 0, too, if it may be."""
    number = as_number(value, name, wanted)
    if not (0.0 < number < math.inf or (zero and number == 0.0)):
        raise ParameterError(f"{name}: wanted {wanted}; got {shown(value)}; try {example:g}")
    return number


def as_time(value: Any, name: str, *, example: float, forwards: bool = True) -> float:
    """A length of time that is divided into others, as a plain float; either way if not `forwards`."""
    wanted = "a positive finite time" if forwards else "a finite time that is not 0"
    time = as_number(value, name, wanted)
    if not math.isfinite(time) or time == 0 or (forwards and time < 0):
        raise ParameterError(f"{name}: wanted {wanted}; got {time:g}; try {name}={example:g}")
    if not LEAST_TIME <= abs(time) <= MOST_TIME:
        bound = f"at least {LEAST_TIME:g}" if abs(time) < 1 else f"at most {MOST_TIME:g}"
        raise ParameterError(f"{name}: wanted a time of {bound}; got {time:g}; try {name}={example:g}")
    return time


def as_threads(threads: int | None, name: str = "threads") -> int:
    """Number of threads; by default the processors that this process may use."""
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return as_count(threads, name, least=1, most=MOST_THREADS, hint="leave it out to use all processors")


def as_deadline(time_limit: float) -> Deadline:
    """The deadline of a call that begins now.

    Raises:
        ParameterError: the limit is no positive number of seconds.
    """
    return Deadline(as_time_limit(time_limit))


def as_time_limit(seconds: float, name: str = "time_limit") -> float:
    """Seconds that a run may take."""
    limit = as_number(seconds, name, "a positive number of seconds")
    if not limit > 0:
        raise ParameterError(f"{name}: wanted a positive number of seconds; got {limit!r}; try 60")
    return limit
