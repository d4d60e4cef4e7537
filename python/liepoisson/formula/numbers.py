"""Numbers that a caller gives, also as exact texts ("1/3", "sqrt(2)/2"), as doubles."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.algebra.exact_numbers import as_float
from liepoisson.errors import ExpressionError, ParameterError, ShapeError
from liepoisson.inputs.arrays import Array, check_memory, too_large
from liepoisson.inputs.given import ordered


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
