"""Types of the compiled core. Arrays of trajectories are flat, float64, row-major."""

from collections.abc import Callable, Sequence
from typing import TypedDict, final

import numpy as np
from numpy.typing import NDArray

from liepoisson.field import Instruction, Piece, Vector3

__all__ = [
    "Field",
    "Method",
    "__version__",
    "available_simd",
    "growth",
    "modular_null_space",
    "orbits",
    "orthonormal",
    "outcomes",
    "sections",
    "simd",
]

__version__: str

_Array = NDArray[np.float64]

@final
class Field:
    @property
    def n_components(self) -> int: ...
    @staticmethod
    def top(inertia: Vector3, a: Vector3, b: Vector3, epsilon: float) -> Field: ...
    @staticmethod
    def quadratic(
        n_components: int,
        constant: Sequence[tuple[int, float]],
        linear: Sequence[tuple[int, int, float]],
        quadratic: Sequence[tuple[int, int, int, float]],
    ) -> Field: ...
    @staticmethod
    def tape(n_components: int, instructions: Sequence[Instruction], outputs: Sequence[int]) -> Field: ...
    @staticmethod
    def pieces(n_components: int, pieces: Sequence[Piece]) -> Field: ...

@final
class Method:
    @staticmethod
    def taylor(tol: float, order: int | None, mixed: bool, max_steps: int) -> Method: ...
    @staticmethod
    def runge_kutta(
        tol: float | None, step: float | None, single: bool, compensated: bool, max_steps: int
    ) -> Method: ...
    @staticmethod
    def splitting(order: int, step: float, single: bool, max_steps: int) -> Method: ...
    @staticmethod
    def gauss(n_stages: int, step: float, max_steps: int) -> Method: ...
    @staticmethod
    def lagrange_map(step: float, max_steps: int) -> Method: ...

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

class _Sections(_Ends):
    count: NDArray[np.int64]
    touch_count: NDArray[np.int64]
    unbounded_steps: NDArray[np.int64]
    unseen_steps: NDArray[np.int64]
    undefined_time: _Array
    unresolved_time: _Array
    seen_to: _Array
    in_surface: NDArray[np.bool_]
    side: NDArray[np.int8]
    first_step: _Array
    time: _Array
    state: _Array
    sign: NDArray[np.int8]
    touch_time: _Array
    touch_state: _Array

def orbits(
    field: Field,
    method: Method,
    states: _Array,
    tangents: _Array,
    n_tangents: int,
    times: _Array,
    threads: int,
    time_limit: float,
    dense: bool,
    components: bool,
    progress: Callable[[float], object] | None,
) -> _Orbits: ...
def growth(
    field: Field,
    method: Method,
    states: _Array,
    tangents: _Array,
    times: _Array,
    threads: int,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _Growth: ...

class _NullSpace(TypedDict):
    rank: int
    complete: bool
    pivots: NDArray[np.uint32]
    free: NDArray[np.uint32]
    indptr: NDArray[np.uint64]
    columns: NDArray[np.uint32]
    residues: NDArray[np.uint64]

def modular_null_space(
    indptr: NDArray[np.uint64],
    columns: NDArray[np.uint32],
    residues: NDArray[np.uint64],
    n_columns: int,
    prime: int,
    enough_rank: int | None,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _NullSpace: ...
def orthonormal(matrices: _Array, n_rows: int, n_columns: int) -> tuple[_Array, _Array]: ...
def simd() -> str: ...
def available_simd() -> list[str]: ...
def outcomes() -> list[str]: ...
def sections(
    field: Field,
    method: Method,
    surface: tuple[int, Sequence[Instruction], Sequence[int]],
    states: _Array,
    times: _Array,
    direction: int,
    n_crossings: int | None,
    sides: Sequence[int],
    threads: int,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _Sections: ...
