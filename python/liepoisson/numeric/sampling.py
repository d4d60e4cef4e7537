"""Random starts and tangent vectors: named ensembles, one stream of numbers per block of trajectories."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import UnknownNameError, did_you_mean
from liepoisson.formula.scalars import MOST, as_count, as_seed
from liepoisson.inputs.arrays import check_memory, read_only
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import shown
from liepoisson.numeric.systems import HasField, as_field, vector_length
from liepoisson.portable import linear
from liepoisson.streams import Purpose, Random, stream

BLOCK = 256
"""Members that share a stream; a member's numbers depend on the seed and on its own number only."""


def _unit_vectors(rng: Random, n: int, length: int) -> NDArray[np.float64]:
    vectors = rng.standard_normal((BLOCK, n // length, length))
    return (vectors / linear.norm(vectors, axis=-1, keepdims=True)).reshape(BLOCK, n)


def _cube(rng: Random, n: int, length: int) -> NDArray[np.float64]:
    return rng.uniform(-1.0, 1.0, (BLOCK, n))


def _gaussian(rng: Random, n: int, length: int) -> NDArray[np.float64]:
    return rng.standard_normal((BLOCK, n))


def _unit_tangent(rng: Random, n: int, length: int) -> NDArray[np.float64]:
    vectors = rng.standard_normal((BLOCK, n))
    return vectors / linear.norm(vectors, axis=-1, keepdims=True)


_Draw: TypeAlias = Callable[[Random, int, int], NDArray[np.float64]]
"""Draws a block of states, given the number of components and the length of each vector."""

ENSEMBLES: dict[str, _Draw] = {
    "unit-vectors": _unit_vectors,
    "cube": _cube,
    "gaussian": _gaussian,
}


def unknown_ensemble(given: object) -> UnknownNameError:
    """What is said of an unknown ensemble."""
    hint = did_you_mean(given, ENSEMBLES).strip() or "Take one of these."
    return UnknownNameError(f"ensemble: wanted one of {', '.join(ENSEMBLES)}; got {shown(given)}. {hint}")


@explains_its_arguments
def sample_states(
    system: HasField, n_starts: int, *, seed: int = 0, ensemble: str = "unit-vectors", first: int = 0
) -> NDArray[np.float64]:
    r"""Random initial states.

    Ensembles, for a state made of vectors such as $(\ell, \alpha, \beta)$:

    - `"unit-vectors"`: each vector independent and uniform on the unit sphere (for a top $C_3 = |\beta|^2 = 1$);
    - `"cube"`: each component independent and uniform in $[-1, 1]$;
    - `"gaussian"`: each component independent and normal with mean 0 and variance 1.

    None of them fixes the energy or the Casimirs: averages over them mix leaves and energies.  Time and its momentum
    are not drawn: they are zero.

    Example:
        >>> lp.sample_states(lp.Top.kovalevskaya(), 20, seed=7).shape
        (20, 9)

    Args:
        system: The system whose states are wanted; its dimension is used.
        n_starts: Number of states.
        seed: Root of the random numbers (numpy's `SeedSequence`).
        ensemble: One of the names above.
        first: Number of the first trajectory: trajectories `first .. first + n - 1` of one infinite ensemble.

    Returns:
        States, shape (trajectory, component), dimensionless.  A trajectory is the same whatever `n_starts` and `first`.

    Raises:
        UnknownNameError: No such ensemble.
        ParameterError: `n_starts`, `first` or `seed` is not a whole number >= 0, or too large (`first + n_starts`
            below 2**63, `seed` below 2**128).
    """
    draw = ENSEMBLES.get(ensemble) if isinstance(ensemble, str) else None  # pyright: ignore[reportUnnecessaryIsInstance]
    if draw is None:
        raise unknown_ensemble(ensemble)
    components = as_field(system).n_components
    drawn = components if getattr(system, "clock", None) is None else components - 2
    length = min(vector_length(system, components), drawn)
    states = _draw(draw, drawn, n_starts, seed, length=length, first=first, purpose=Purpose.STATES)
    return states if drawn == components else np.pad(states, ((0, 0), (0, 2)))


def as_first(first: int, n: int) -> int:
    """The number of the first of n trajectories as a plain int; the number of the last one fits into 64 bits."""
    return as_count(first, "first", most=MOST - n)


def sample_tangents(n_components: int, n: int, *, seed: int, first: int = 0) -> NDArray[np.float64]:
    """Random tangent vectors, uniform on the unit sphere of the state space, shape (trajectory, component)."""
    return _draw(_unit_tangent, n_components, n, seed, length=n_components, first=first, purpose=Purpose.TANGENTS)


def sample_alignment_vectors(
    n_components: int, n: int, n_vectors: int, *, seed: int, first: int = 0
) -> NDArray[np.float64]:
    """Random tangent vectors for alignment indices, uniform on the unit sphere of the state space.

    Their stream is not that of `sample_tangents`: SALI and an exponent with the same seed are made of independent
    vectors.

    Returns:
        Vectors, shape (trajectory, tangent, component).
    """
    vectors = _draw(
        _unit_tangent,
        n_components,
        n * n_vectors,
        seed,
        length=n_components,
        first=first * n_vectors,
        purpose=Purpose.ALIGNMENT,
    )
    return vectors.reshape(n, n_vectors, n_components)


def _draw(
    draw: _Draw,
    n_components: int,
    n: int,
    seed: int,
    *,
    length: int,
    first: int,
    purpose: Purpose,
) -> NDArray[np.float64]:
    n = as_count(n, "n_starts")
    seed, first = as_seed(seed), as_first(first, n)
    check_memory(8 * n * n_components, "n_starts")
    result = np.empty((n, n_components))
    for block in range(first // BLOCK, -(-(first + n) // BLOCK)):
        start = block * BLOCK - first
        kept = slice(max(start, 0), min(start + BLOCK, n))
        drawn = _block(draw, n_components, length, seed=seed, purpose=purpose, block=block)
        result[kept] = drawn[kept.start - start : kept.stop - start]
    return result


@lru_cache(maxsize=4)
def _block(
    draw: _Draw, n_components: int, length: int, *, seed: int, purpose: Purpose, block: int
) -> NDArray[np.float64]:
    """The members of a block, which nobody writes to: the points of a sweep have the same."""
    return read_only(draw(stream(seed, purpose, block), n_components, length))
