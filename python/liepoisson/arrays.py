"""Arrays of doubles from what a caller gives; both wings read states through this one function."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError, ShapeError

Array: TypeAlias = NDArray[np.float64]


def as_array(values: ArrayLike, name: str) -> Array:
    """An array of doubles; what would lose its meaning as a double (complex, date, text, mask) is refused."""
    try:
        given = np.asanyarray(values)
        masked = isinstance(given, np.ma.MaskedArray)
        if given.dtype.kind in "SU":
            raise TypeError("texts")
        if not masked and given.dtype.kind not in "cmM":
            return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ShapeError(
            f"{name}: wanted an array of numbers; got {type(values).__name__} ({error}); try a list of floats"
        ) from error
    kind = "a masked array" if masked else f"an array of {given.dtype}"
    raise ParameterError(f"{name}: wanted real numbers; got {kind}; convert it, or drop what is not a number")
