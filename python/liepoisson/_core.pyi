"""Types of the compiled core. Arrays of trajectories are flat, float64, row-major."""

from collections.abc import Callable, Sequence
from typing import Any, NotRequired, TypeAlias, TypedDict, final

import numpy as np
from numpy.typing import NDArray

from liepoisson.compile.field import Instruction, Piece, Vector3

__all__ = [
    "Field",
    "Method",
    "TypedSystem",
    "__version__",
    "available_simd",
    "average_changes",
    "carry_frames",
    "check_covering_relations",
    "cholesky",
    "determinants",
    "eigen",
    "elementary_of_one",
    "elementary_of_two",
    "enclose_equilibria",
    "enclose_flow",
    "enclose_periodic_orbit",
    "enclose_section_map",
    "fourier_transforms",
    "growth",
    "growth_powers",
    "megno",
    "methods",
    "modular_null_space",
    "orbits",
    "orthonormal",
    "outcomes",
    "printed_equations",
    "printed_field",
    "printed_functions",
    "products",
    "sali",
    "sections",
    "simd",
    "singular",
    "solutions",
    "states_at",
    "symmetric",
    "usual_rule",
    "verdicts",
    "votes",
]

__version__: str

_Array = NDArray[np.float64]

@final
class TypedSystem:
    def __new__(
        cls,
        names: Sequence[str] | Sequence[tuple[str, Sequence[str]]],
        terms: Sequence[tuple[int, int, int | None, str]],
        hamiltonian: str,
        parameters: Sequence[tuple[str, str | Sequence[str] | Sequence[Sequence[str]]]],
        declared: Sequence[str],
    ) -> TypedSystem: ...
    def equations(self) -> list[str]: ...
    def parameters(self) -> list[str]: ...
    def field(self, general: bool = False) -> dict[str, Any]: ...
    def functions(self, texts: Sequence[str]) -> dict[str, Any]: ...

def printed_field(
    n_components: int,
    parts: Sequence[str],
    terms: Sequence[tuple[int, int, int | None, str]],
    hamiltonian: str,
    as_tape: bool,
) -> dict[str, Any]: ...
def printed_equations(
    n_components: int, parts: Sequence[str], rates: Sequence[str], as_tape: bool
) -> dict[str, Any]: ...
def printed_functions(n_components: int, parts: Sequence[str], functions: Sequence[str]) -> dict[str, Any]: ...

@final
class Field:
    @property
    def n_components(self) -> int: ...
    def prefers_runge_kutta(self, tol: float) -> bool: ...
    @staticmethod
    def top(inertia: Vector3, a: Vector3, b: Vector3, epsilon: float) -> Field: ...
    @staticmethod
    def tops(tops: Sequence[tuple[Vector3, Vector3, Vector3, float]]) -> Field: ...
    @staticmethod
    def quadratics(
        n_components: int,
        fields: Sequence[
            tuple[
                Sequence[tuple[int, float]],
                Sequence[tuple[int, int, float]],
                Sequence[tuple[int, int, int, float]],
            ]
        ],
    ) -> Field: ...
    @staticmethod
    def quadratic(
        n_components: int,
        constant: Sequence[tuple[int, float]],
        linear: Sequence[tuple[int, int, float]],
        quadratic: Sequence[tuple[int, int, int, float]],
    ) -> Field: ...
    @staticmethod
    def tape(
        n_components: int,
        instructions: Sequence[Instruction],
        outputs: Sequence[int],
        size_limits: Sequence[float | None] = ...,
    ) -> Field: ...
    @staticmethod
    def pieces(n_components: int, pieces: Sequence[Piece]) -> Field: ...
    def with_noise(
        self,
        noises: Sequence[Sequence[Piece]],
        energy: Sequence[Piece],
        inverse_temperature: float,
        key: Sequence[int],
        first: int,
        n_before: int,
        n_increments: int,
    ) -> Field: ...

@final
class Method:
    def __new__(cls, name: str, options: dict[str, Any]) -> Method: ...

def methods() -> list[str]: ...

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
    lost_changes: NDArray[np.int64]
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
def states_at(
    series: list[tuple[_Array, _Array]], ends: list[float], n_components: int, times: _Array, backwards: bool
) -> _Array: ...
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

class _Carried(_Ends):
    growth: _Array
    triangle: _Array
    kept_frame: _Array
    kept_state: _Array
    frame: _Array
    n_complete: NDArray[np.int64]
    ratio: _Array

def carry_frames(
    field: Field,
    method: Method,
    states: _Array,
    frames: _Array,
    n_vectors: int,
    units: _Array,
    elapsed: _Array,
    duration: float,
    n_intervals: int,
    per_row: int,
    keep: bool,
    threads: int,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _Carried: ...

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
def products(a: _Array, b: _Array, n_matrices: int, shape: tuple[int, int, int]) -> _Array: ...
def solutions(a: _Array, b: _Array, n_matrices: int, shape: tuple[int, int]) -> _Array | None: ...
def determinants(a: _Array, n_matrices: int, n: int) -> list[_Array]: ...
def cholesky(a: _Array, n_matrices: int, n: int) -> _Array | None: ...
def singular(a: _Array, n_matrices: int, shape: tuple[int, int]) -> list[_Array]: ...
def symmetric(a: _Array, n_matrices: int, n: int) -> list[_Array]: ...
def eigen(a: _Array, n_matrices: int, n: int) -> list[_Array] | None: ...
def fourier_transforms(samples: _Array, n: int) -> _Array: ...
def elementary_of_one(name: str, x: _Array) -> _Array: ...
def elementary_of_two(name: str, x: _Array, y: _Array) -> _Array: ...
def simd() -> str: ...
def available_simd() -> list[str]: ...
def outcomes() -> list[str]: ...
def sections(
    field: Field,
    method: Method,
    surface: tuple[int, Sequence[Instruction], Sequence[int]],
    has_guard: bool,
    states: _Array,
    times: _Array,
    direction: int,
    n_crossings: int | None,
    sides: Sequence[int],
    threads: int,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _Sections: ...

# Rigorous enclosures. A polynomial is a sequence of terms: a rational coefficient as text ("-1/3", "0.25"), and the
# exponents of all variables. Bounds come in pairs, lower and upper; matrices are flat, row by row. What cannot be
# enclosed is an EnclosureError.

_Terms = Sequence[tuple[str, Sequence[int]]]
_Pair = tuple[float, float]
_How = tuple[int, float, float | None, int]
"""Order of the Taylor series; longest step; size of the remainders, or None for equal steps; most steps."""

class _Bounds(TypedDict):
    lower: _Array
    upper: _Array
    derivative_lower: _Array
    derivative_upper: _Array

class _FlowBounds(_Bounds):
    n_steps: int
    tube_start: NotRequired[_Array]
    tube_end: NotRequired[_Array]
    tube_lower: NotRequired[_Array]
    tube_upper: NotRequired[_Array]

class _SectionMapBounds(_Bounds):
    time: _Pair
    rate: _Pair

class _PeriodicOrbit(_Bounds):
    period: _Pair
    times_lower: _Array
    times_upper: _Array
    unique_radius: float
    multipliers_real_lower: _Array
    multipliers_real_upper: _Array
    multipliers_imaginary_lower: _Array
    multipliers_imaginary_upper: _Array
    multipliers_alone: NDArray[np.bool_]

class _Equilibria(TypedDict):
    lower: _Array
    upper: _Array
    unique_lower: _Array
    unique_upper: _Array
    undecided_lower: _Array
    undecided_upper: _Array
    eigenvalues_real_lower: _Array
    eigenvalues_real_upper: _Array
    eigenvalues_imaginary_lower: _Array
    eigenvalues_imaginary_upper: _Array
    eigenvalues_alone: NDArray[np.bool_]

class _CoveringRotation(TypedDict):
    discriminant: _Pair
    angles: tuple[_Pair, _Pair]
    periods: tuple[_Pair, _Pair]
    moduli: tuple[_Pair, _Pair]

class _CoveringMargins(TypedDict):
    n_steps: int
    expansion: _Array
    contraction: _Array
    cone: _Array
    chart: _Array
    crossing_rate: float
    small_expansion: float
    small_contraction: float
    reversal: float
    middle: int
    apart_from_orbit: float
    apart_from_excursion: float
    apart_from_image: float
    loop_times: tuple[_Pair, _Pair]
    loop_reflections: tuple[int, int]
    entropy: float
    rotation: _CoveringRotation | None

def enclose_flow(
    field: Sequence[_Terms],
    center: _Array,
    frame: _Array,
    lower: _Array,
    upper: _Array,
    time: float,
    how: _How,
    tube: bool,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _FlowBounds: ...
def enclose_section_map(
    field: Sequence[_Terms],
    section: _Terms,
    center: _Array,
    frame: _Array,
    lower: _Array,
    upper: _Array,
    time: float,
    how: _How,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _SectionMapBounds: ...
def enclose_periodic_orbit(
    field: Sequence[_Terms],
    constants: Sequence[_Terms],
    level: Sequence[str] | None,
    symmetry: Sequence[int] | None,
    states: _Array,
    times: _Array,
    reach: float,
    how: _How,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _PeriodicOrbit: ...
def enclose_equilibria(
    field: Sequence[_Terms],
    lower: _Array,
    upper: _Array,
    max_boxes: int,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _Equilibria: ...
def check_covering_relations(
    field: Sequence[_Terms],
    constants: Sequence[_Terms],
    level: Sequence[str],
    symmetry: Sequence[int],
    reversers: Sequence[Sequence[int]],
    n_unstable: int,
    names: Sequence[str],
    centers: _Array,
    frames: _Array,
    edges: Sequence[tuple[int, int, float, bool]],
    how: tuple[str, int, float, float, float, float, str | None],
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> _CoveringMargins: ...

_Thresholds: TypeAlias = tuple[tuple[float, float], tuple[float, float], tuple[float, float], float, float]

def usual_rule() -> _Thresholds: ...
def votes(rule: _Thresholds, indicators: _Array) -> NDArray[np.int8]: ...
def verdicts(rule: _Thresholds, votes: NDArray[np.int8], natural_time: _Array) -> NDArray[np.int8]: ...
def megno(times: _Array, log_growth: _Array) -> tuple[_Array, _Array]: ...
def growth_powers(times: _Array, log_growth: _Array) -> _Array: ...
def sali(pairs: _Array, n: int) -> _Array: ...
def average_changes(values: _Array, n_rows: int, n: int) -> _Array: ...
