"""Arrays of doubles from what a caller gives: copied once, so that nothing done to them later changes a result."""

from __future__ import annotations

import math
import os
from functools import cache
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import MemoryLimitError, ParameterError, ShapeError
from liepoisson.portable import linear

Array: TypeAlias = NDArray[np.float64]


def check_memory(n_bytes: int, name: str) -> None:
    """Refuse what is larger than the memory of the machine, before anything is made.

    Args:
        n_bytes: What is wanted.
        name: The argument that asks for it.

    Raises:
        MemoryLimitError: it is larger.
    """
    if n_bytes > _memory():
        raise too_large(n_bytes, name)


@cache
def _memory() -> float:
    """The bytes of memory that the machine has; infinite where the system does not say."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return math.inf


def too_large(n_bytes: int, name: str) -> MemoryLimitError:
    """The refusal of an array of this size."""
    return MemoryLimitError(
        f"{name}: wanted what fits into memory; got {n_bytes:,} bytes ({n_bytes / 2**30:.3g} GiB); ask for less at once"
    )


def check_shape(fits: bool, name: str, wanted: str, values: Any, hint: str = "") -> None:
    """Refuse an array of another shape than the one that the docstring of a function asks for.

    Args:
        fits: Whether it has the shape.
        name: The argument.
        wanted: The shape in words, "(trajectory, time)".
        values: The array.
        hint: What to try.

    Raises:
        ShapeError: it does not fit.
    """
    if not fits:
        raise ShapeError(f"{name} must have shape {wanted}; got shape {values.shape}. {hint}".rstrip())


def check_finite(values: NDArray[Any], name: str, hint: str) -> None:
    """Refuse numbers that are not finite.

    Raises:
        ParameterError: one of them is none.
    """
    if not np.isfinite(values).all():
        raise ParameterError(f"{name}: wanted finite numbers; got a NaN or an infinity; {hint}")


_SQUARABLE = 1e-140, 1e140
"""Numbers between these have squares, and sums of squares, among the doubles."""


def norm(values: Array, axis: int | tuple[int, ...] | None = None) -> Array:
    """Euclidean lengths along axes, also of numbers whose squares leave the doubles.

    `numpy.linalg.norm` returns 0 for numbers below 1e-162, as if a slope in the tail of a Gaussian were none. Such
    numbers are brought to order one by a power of two; for all others its result is returned.
    """
    largest = np.abs(values).max(axis=axis, keepdims=True, initial=0.0)
    if bool(((largest >= _SQUARABLE[0]) & (largest <= _SQUARABLE[1]) | (largest == 0)).all()):
        return np.asarray(linear.norm(values, axis=axis))
    finite = np.isfinite(largest) & (largest > 0)
    exponent = np.where(finite, np.frexp(np.where(finite, largest, 1.0))[1], 0)
    lengths = np.sqrt(np.sum(np.ldexp(values, -exponent) ** 2, axis=axis))
    return np.asarray(np.ldexp(lengths, exponent.reshape(np.shape(lengths))))


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """A view of an array through which it cannot be changed, nor be made writable again: a buffer that is read-only."""
    try:
        buffer: Any = array  # NumPy says that it is one from Python 3.12 on
        view = np.asarray(memoryview(buffer).toreadonly())
    except (ValueError, TypeError, BufferError):  # a kind of numbers that buffers do not know, such as dates
        view = None
    if view is None or view.dtype != array.dtype or view.shape != array.shape:
        view = array.view()
    view.flags.writeable = False
    return view


class ReadOnlyArrays:
    """Base of results, dataclasses whose arrays cannot be changed: they are what the run was given and what it gave.

    So a file that is written later has the numbers of the run, and the rerun of the file too.  Arrays in tuples and
    dictionaries are read-only as well, and those of copies and of results that come from another process.
    """

    def __post_init__(self) -> None:
        """Makes the arrays read-only."""
        self.__setstate__(vars(self))

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update({name: _protected(value) for name, value in state.items()})


def _protected(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return read_only(cast("NDArray[Any]", value))
    if type(value) is tuple:
        return tuple(_protected(item) for item in cast("tuple[Any, ...]", value))
    if type(value) is dict:
        return {key: _protected(item) for key, item in cast("dict[Any, Any]", value).items()}
    return value
