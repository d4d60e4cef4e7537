"""Types of the compiled core. All arrays are flat, float64, row-major."""

from collections.abc import Callable
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from liepoisson.field import Vector3

__all__ = ["__version__", "available_simd", "growth_of_top", "orbits_of_top", "outcomes", "simd"]

__version__: str

_Array = NDArray[np.float64]
_Top = tuple[Vector3, Vector3, Vector3, float]
_Taylor = tuple[float, int | None, int]

class _Ends(TypedDict):
    outcome: NDArray[np.int8]
    end_time: _Array
    n_steps: NDArray[np.int64]
    final_state: _Array
    kernel: str
    order: int

class _Orbits(_Ends):
    state: _Array
    tangent: _Array
    series: list[tuple[_Array, _Array]]

class _Growth(_Ends):
    exponent: _Array

def orbits_of_top(
    top: _Top,
    taylor: _Taylor,
    states: _Array,
    tangents: _Array,
    n_tangents: int,
    times: _Array,
    threads: int,
    dense: bool,
    components: bool,
    progress: Callable[[float], object] | None,
) -> _Orbits: ...
def growth_of_top(
    top: _Top,
    taylor: _Taylor,
    states: _Array,
    tangents: _Array,
    times: _Array,
    threads: int,
    progress: Callable[[float], object] | None,
) -> _Growth: ...
def simd() -> str: ...
def available_simd() -> list[str]: ...
def outcomes() -> list[str]: ...
