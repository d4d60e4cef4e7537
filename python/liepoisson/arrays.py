"""Arrays of doubles from what a caller gives: copied once, so that nothing done to them later changes a result."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ExpressionError, MemoryLimitError, ParameterError, ShapeError
from liepoisson.given import ordered
from liepoisson.portable import linear

Array: TypeAlias = NDArray[np.float64]


def as_array(values: ArrayLike, name: str, labels: Sequence[str] = ()) -> Array:
    """An array of doubles with memory of its own, whatever a caller gives: aligned, native byte order, C order.

    Texts, also in lists, are exact numbers, of which the nearest doubles are taken: "1/3", "sqrt(2)/2" (`as_double`).
    A NumPy array of texts is most likely a table that was not converted, and is refused.  Where the last axis has
    labels, they bring it into the order of `labels` (`liepoisson.given`).

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
        raise _too_large(8 * np.size(values), name) from error
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise ShapeError(
            f"{name}: wanted an array of numbers; got {type(values).__name__} ({error}); try a list of floats"
        ) from error
    kind = "a masked array" if masked else f"an array of {given.dtype}"
    raise ParameterError(f"{name}: wanted real numbers; got {kind}; convert it, or drop what is not a number")


def check_memory(n_bytes: int, name: str) -> None:
    """Refuse what is larger than the memory of the machine, before anything is made.

    Args:
        n_bytes: What is wanted.
        name: The argument that asks for it.

    Raises:
        MemoryLimitError: it is larger.
    """
    try:
        memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):  # the system does not say
        return
    if n_bytes > memory:
        raise _too_large(n_bytes, name)


def _too_large(n_bytes: int, name: str) -> MemoryLimitError:
    return MemoryLimitError(
        f"{name}: wanted what fits into memory; got {n_bytes:,} bytes ({n_bytes / 2**30:.3g} GiB); ask for less at once"
    )


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
    from liepoisson.exact.expression import constant
    from liepoisson.exact.parameters import as_float

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
