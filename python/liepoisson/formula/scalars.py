"""Numbers that a caller gives, also as exact texts ("1/3", "sqrt(2)/2"): arrays of doubles, counts, threads, limits."""

from __future__ import annotations

import math
import operator
import os
import sys
from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.algebra.exact_numbers import as_float
from liepoisson.errors import ExpressionError, ParameterError, ShapeError
from liepoisson.inputs.arrays import Array, check_memory, too_large
from liepoisson.inputs.deadline import Deadline
from liepoisson.inputs.given import as_scalar, ordered
from liepoisson.inputs.refusals import shown

MOST = 2**63 - 1
"""Largest count: what a signed integer of 64 bits holds."""

LEAST_TIME, MOST_TIME = 1e-300, 1e300
"""A shorter time has too few doubles for the times in between, and multiples of one above 1e300 are no doubles."""

TIME_LIMIT = 3600.0
"""Default budget: seconds that a run may take."""

MOST_THREADS = 4096
"""Far above any machine: a larger number, also of processes, is a slip of the finger."""


def as_array(values: ArrayLike, name: str, labels: Sequence[str] = ()) -> Array:
    """An array of doubles with memory of its own, whatever a caller gives: aligned, native byte order, C order.

    Texts, also in lists, are exact numbers, of which the nearest doubles are taken: "1/3", "sqrt(2)/2" (`as_double`).
    A NumPy array of texts is most likely a table that was not converted, and is refused.  Where the last axis has
    labels, they bring it into the order of `labels` (`liepoisson.inputs.given`).

    It is always a copy.  A function takes it once, at its beginning, checks the copy, and works with the copy only: the
    caller's array may be changed later, or by another thread while the core runs without the interpreter's lock.

    Raises:
        ShapeError: It is no array of numbers (names, mappings, sets, rows of different lengths, objects).
        ParameterError: Numbers that would lose their meaning as doubles (complex ones, dates, records, masked ones),
            booleans, or labels that are not those that were wanted.
        MemoryLimitError: The copy does not fit into memory; an array that repeats a few numbers by strides takes none.
    """
    if type(values) is np.ndarray and values.dtype.kind in "fiu":
        check_memory(8 * values.size, name)
        return np.array(values, dtype=np.float64, order="C")
    try:
        masked = _has_masks(values)
        plain = () if masked else ordered(values, name, labels)
        given = np.asanyarray(plain)
        check_memory(8 * given.size, name)
        if given.dtype.kind in "SUTO":
            given = _with_texts_read(given, name, written=isinstance(plain, (list, tuple, str)))
        if not masked and given.dtype.kind not in "bcmMV":
            return np.array(given, dtype=np.float64, order="C", copy=True, subok=False)
    except (ShapeError, ParameterError):
        raise
    except MemoryError as error:
        raise too_large(8 * np.size(values), name) from error
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise ShapeError(
            f"{name}: wanted an array of numbers; got {type(values).__name__} ({error}); try a list of floats"
        ) from error
    kind = "a masked array" if masked else f"an array of {given.dtype}"
    raise ParameterError(f"{name}: wanted real numbers; got {kind}; convert it, or drop what is not a number")


def as_phase_points(given: ArrayLike, components: Sequence[str], fields: Sequence[str], name: str = "states") -> Array:
    """States of shape (..., n), n the number of components; labels are those of the components.

    Raises:
        ShapeError: the last axis has another length.
        ParameterError: the labels are not those of the components.
    """
    states, n = as_array(given, name, components), len(components)
    if states.ndim == 0 or states.shape[-1] != n:
        hint = " Transpose it?" if states.ndim > 1 and states.shape[0] == n else ""
        raise ShapeError(f"{name} must end in {n} components ({', '.join(fields)}); got shape {states.shape}.{hint}")
    return states


def _has_masks(values: Any) -> bool:
    """Whether an entry of an array or of a list of arrays is masked: NumPy joins rows and forgets the masks."""
    if "numpy.ma" not in sys.modules:  # which NumPy imports when it is asked for the first masked array
        return False
    rows = cast("list[Any]", values) if isinstance(values, (list, tuple)) else [values]
    return any(isinstance(row, np.ma.MaskedArray) and np.ma.is_masked(row) for row in rows)


def as_double(text: str, name: str) -> float:
    """The double that is nearest to the exact number of a text: "1/3", "0.1", "sqrt(2)/2".

    This is the one place where texts become doubles; it asks the reader of exact parameters.

    Raises:
        ParameterError: it is no number, or one that no double holds.
    """
    from liepoisson.formula.expression import constant

    try:
        return as_float(constant(text), name)
    except ExpressionError as error:
        raise ParameterError(f"{name}: {text:.60}: {error.within_formula()}") from error


def _with_texts_read(given: NDArray[Any], name: str, *, written: bool) -> NDArray[Any]:
    """Numbers for texts; objects without a value as a double are refused, for NumPy would take None as NaN."""
    read = np.empty(given.size, dtype=object)
    for k, item in enumerate(given.ravel().tolist()):
        if not (isinstance(item, str) and written) and (
            isinstance(item, (str, bytes)) or not hasattr(item, "__float__")
        ):
            raise TypeError(f"{type(item).__name__} among them")
        try:
            read[k] = as_double(item, name) if isinstance(item, str) else item
        except ParameterError as error:
            raise ShapeError(f"{name}: wanted an array of numbers; {str(error).removeprefix(f'{name}: ')}") from error
    return read.reshape(given.shape)


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


def as_finite(value: Any, name: str) -> float:
    """A finite number as a plain float."""
    number = as_number(value, name, "a finite number")
    if not math.isfinite(number):
        raise ParameterError(f"{name}: wanted a finite number; got {shown(value)}; give one")
    return number


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
