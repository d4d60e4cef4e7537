r"""Covariant Lyapunov vectors: the directions that the tangent flow carries into themselves.

The frames Q of the QR method depend on the inner product; the covariant vectors do not.  Ginelli and others find them
from the triangular matrices of the forward run, $D\,Q_i = Q_{i+1}R_i$: coefficients C that run backwards,

$$ C_i = R_i^{-1}\,C_{i+1}, \qquad V_i = Q_i C_i, $$

keep the space spanned by the first k vectors and turn, in it, into the directions that grow with exponent k.

References: [ginelli2007]; Kuptsov and Parlitz, J. Nonlinear Sci. 22 (2012) 727.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_array, as_count
from liepoisson.indicators.mean_error import mean_error
from liepoisson.indicators.tangent_frames import Carried, TangentFrames
from liepoisson.inputs.arrays import Array, ReadOnlyArrays, check_shape
from liepoisson.inputs.refusals import counted
from liepoisson.io.result import labelled
from liepoisson.portable import elementary, linear
from liepoisson.streams import Purpose, stream

MOST_BYTES = 4 * 2**30


@dataclass(frozen=True, eq=False)
class CovariantVectors(ReadOnlyArrays):
    """Covariant Lyapunov vectors along trajectories.

    Vectors of equal exponents (the zeros, above all) are not unique one by one: only the space that they span is.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> run = lp.lyapunov_spectrum(system, [0, -0.1, 0.5, 0], t_end=200, transient=200, covariant=True)
        >>> vectors = run.covariant
        >>> flow = system.vector_field(vectors.state)
        >>> bool(vectors.distance_from_centre(flow, n_zeros=2).max() < 1e-6)  # it neither grows nor shrinks
        True
        >>> bool(vectors.angle(n_zeros=2).min() > 0.1)  # far from a tangency
        True

    Attributes:
        time: Times, from the end of the transient on, shape (time,).
        state: The states there, shape (trajectory, time, component).
        vector: Unit vectors in the order of the exponents, shape (trajectory, time, k, component); NaN for trajectories
            that did not finish, or along which round-off hides an exponent (`Spectrum.largest_ratio`).
        growth: Mean growth rate of each vector over each interval, in inverse time, shape (trajectory, time - 1, k).
    """

    time: Array = labelled("covariant_time", long_name="time", is_coordinate=True)
    state: Array = labelled("trajectory", "covariant_time", "component", long_name="state")
    vector: Array = labelled("trajectory", "covariant_time", "k", "component", long_name="covariant vectors")
    growth: Array = labelled(
        "trajectory",
        "covariant_interval",
        "k",
        long_name="mean growth rate of each vector",
        units="inverse time, dimensionless",
    )

    def __repr__(self) -> str:
        n, n_times, k, _ = self.vector.shape
        of, at = counted(n, "trajectory", "trajectories"), counted(n_times, "time")
        span = f"t = {self.time[0]:g} to {self.time[-1]:g}"
        return f"<CovariantVectors: {counted(k, 'vector')} of {of} at {at}, {span}>"

    @property
    def exponent(self) -> Array:
        """Exponents measured from the growth of the covariant vectors, shape (trajectory, k)."""
        return self.growth.mean(axis=1)

    @property
    def error(self) -> Array:
        """Standard errors of these exponents as averages over the time of each orbit, shape (trajectory, k).

        See `mean_error`.
        """
        return mean_error(self.growth)

    def centre(self, n_zeros: int) -> Array:
        """Orthonormal bases of the space of the `n_zeros` middle vectors, shape (trajectory, time, component, n_zeros).

        Raises:
            ParameterError: `n_zeros` is not of the parity of N, or not between 0 and N.
        """
        n, side = self.vector.shape[2], self._n_growing(n_zeros)
        return linear.qr(np.swapaxes(self.vector[:, :, side : n - side], 2, 3))[0]

    def distance_from_centre(self, vectors: ArrayLike, n_zeros: int) -> Array:
        """Sine of the angle between given vectors and the centre space, shape (trajectory, time).

        Args:
            vectors: One at each time, such as the vector field, shape (trajectory, time, component).
            n_zeros: Dimension of the centre space.

        Raises:
            ShapeError: `vectors` has another shape.
        """
        given, wanted = as_array(vectors, "vectors"), self.state.shape
        check_shape(given.shape == wanted, "vectors", f"{wanted}, one at each time", given)
        basis = self.centre(n_zeros)
        inside = linear.einsum("tsik,tsk->tsi", basis, linear.einsum("tsik,tsi->tsk", basis, given))
        return linear.norm(given - inside, axis=-1) / linear.norm(given, axis=-1)

    def angle(self, n_zeros: int) -> Array:
        """Smallest angle between the growing and the shrinking space, in radians, shape (trajectory, time).

        Near zero the two nearly touch, as at a homoclinic tangency or in a regular region.  NaN for trajectories that
        did not finish.

        Raises:
            ParameterError: `n_zeros` is not of the parity of N, or not between 0 and N - 2.
        """
        n, side = self.vector.shape[2], self._n_growing(n_zeros)
        if side == 0:
            raise ParameterError(
                f"n_zeros: wanted at most {n - 2}, so that some vectors grow and some shrink; got {n_zeros}"
            )
        angle = np.full(self.vector.shape[:2], np.nan)
        good = np.isfinite(self.vector).all(axis=(2, 3))
        vectors = np.swapaxes(self.vector[good], 1, 2)
        growing, shrinking = (linear.qr(part)[0] for part in (vectors[..., :side], vectors[..., n - side :]))
        cosine = linear.svd(linear.matmul(np.swapaxes(growing, 1, 2), shrinking), compute_uv=False)[..., 0]
        angle[good] = elementary.arccos(np.minimum(cosine, 1.0))
        return angle

    def _n_growing(self, n_zeros: int) -> int:
        """How many vectors grow if `n_zeros` in the middle do neither, which is checked."""
        n = self.vector.shape[2]
        count = as_count(n_zeros, "n_zeros", most=n)
        if (n - count) % 2:
            raise ParameterError(
                f"n_zeros: wanted a number such that the {n} - n_zeros others come in pairs; got {count}"
            )
        return (n - count) // 2


class CovariantRecord:
    """What the forward run leaves for the way back: frames, states and triangular matrices.

    Raises:
        ParameterError: not all vectors are in the frame, there is no transient, or more than 4 GiB would be kept.
    """

    def __init__(self, frames: TangentFrames, t_end: float, transient: float, during: int, after: int) -> None:
        n, n_vectors = frames.frame.shape[1:]
        if n_vectors != n:
            raise ParameterError(f"covariant: wanted all {n} exponents; got n_exponents={n_vectors}; leave it out")
        if not transient > 0.0:
            raise ParameterError(
                "covariant: wanted a transient > 0, in which the vectors turn into their directions; got none; "
                f"try transient={t_end / 10:g}"
            )
        size = 24 * n**2 * len(frames.state) * (during + after)
        if size > MOST_BYTES:
            raise ParameterError(
                f"covariant: wanted at most {MOST_BYTES / 2**30:g} GiB of frames; got {size / 2**30:.3g} GiB, for "
                f"{len(frames.state)} trajectories and {during + after} intervals; take fewer at a time, or longer "
                "intervals"
            )
        self._source, self._t_end, self._during = frames, t_end, during

    def begin(self) -> None:
        """Keeps the frames where the averages begin."""
        self._frame, self._state = self._source.frame.copy(), self._source.state.copy()

    def keep(self, carried: Carried) -> None:
        """Keeps the intervals of the averages."""
        self._carried = carried

    def settle(self, carried: Carried) -> None:
        """Keeps the intervals after the averages, where the vectors turn into their directions on the way back."""
        self._after = carried.triangle

    def vectors(self) -> CovariantVectors:
        """Goes back through the triangular matrices; states after the end of all runs are the last good ones."""
        source, n_times = self._source, self._during + 1
        finished = (source.outcome == "finished") & ~source.is_hidden.any(axis=1)
        n_all, n = source.state.shape
        vector = np.full((n_all, n_times, n, n), np.nan)
        growth = np.full((n_all, self._during, n), np.nan)
        time = self._t_end * np.arange(n_times) / self._during
        states = np.concatenate([self._state[:, None], self._carried.state], axis=1)
        states = np.where(np.isnan(states).any(axis=2, keepdims=True), source.state[:, None], states)
        if not finished.any():
            return CovariantVectors(time, states, vector, growth)
        coefficients = _random_triangles(n, n_all, **source.options.drawn)[finished]
        for k in range(self._after.shape[1] - 1, -1, -1):
            coefficients, _ = _back(self._after[finished, k], coefficients)
        for k in range(self._during - 1, -1, -1):
            vector[finished, k + 1] = _rows(linear.matmul(self._carried.frame[finished, k], coefficients))
            coefficients, length = _back(self._carried.triangle[finished, k], coefficients)
            growth[finished, k] = -elementary.log(length) * self._during / self._t_end
        vector[finished, 0] = _rows(linear.matmul(self._frame[finished], coefficients))
        scaled = np.flatnonzero((source.unit != 1.0).any(axis=1))
        vector[scaled] *= source.unit[scaled, None, None, :]
        vector[scaled] /= linear.norm(vector[scaled], axis=-1, keepdims=True)
        return CovariantVectors(time, states, vector, growth)


def _back(triangles: Array, coefficients: Array) -> tuple[Array, Array]:
    """Unit columns of coefficients an interval earlier, and the lengths that they had."""
    earlier = linear.solve(triangles, coefficients)
    length = linear.norm(earlier, axis=1)
    return earlier / length[:, None, :], length


def _rows(matrices: Array) -> NDArray[np.float64]:
    return np.swapaxes(matrices, 1, 2)


def _random_triangles(n: int, n_members: int, *, seed: int, first: int) -> Array:
    """Upper triangular matrices with unit columns; those of a trajectory depend on the seed and on its number only."""
    triangles = np.empty((n_members, n, n))
    for k in range(n_members):
        triangles[k] = np.triu(stream(seed, Purpose.TRIANGLES, first + k).standard_normal((n, n)))
    return triangles / linear.norm(triangles, axis=1, keepdims=True)
