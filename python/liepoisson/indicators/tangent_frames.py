r"""Orthonormal frames of tangent vectors, carried along trajectories and made orthonormal again after each interval.

Over an interval the tangent flow D takes the frame Q to $DQ = Q'R$: the new frame Q' is orthonormal, R is upper
triangular with a positive diagonal, and $\ln R_{kk}$ is what direction k has grown.

References: [benettin1980]; Eckmann and Ruelle, Rev. Mod. Phys. 57 (1985) 617.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.compile.field import Field
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_count, as_positive, as_time
from liepoisson.inputs.arrays import Array
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.run import outcome_names
from liepoisson.numeric.run_options import Progress, RunOptions
from liepoisson.numeric.sampling import BLOCK, as_first, sample_tangents
from liepoisson.numeric.starts import StartsLike, as_starts
from liepoisson.numeric.systems import HasField, core_field, n_of_time
from liepoisson.streams import Purpose, stream

MOST_INTERVALS = 10_000_000
"""Most intervals of a run: each costs microseconds at least, so that these take a minute for each trajectory."""

HIDDEN = 0.1 / np.finfo(float).eps
"""A vector that is stretched less by this factor than another one is a tenth round-off of the longer one, or more."""


@dataclass(frozen=True)
class Carried:
    r"""What frames have found on their way over many intervals; NaN in what a trajectory did not complete.

    Attributes:
        growth: Sums of $\ln R_{kk}$ over the intervals of each row, shape (trajectory, row, vector).
        triangle: R of each interval, shape (trajectory, interval, vector, vector); of none if they were not to be kept.
        frame: Frames at the ends of the intervals, shape (trajectory, interval, component, vector), likewise.
        state: States there, shape (trajectory, interval, component), likewise.
    """

    growth: Array
    triangle: Array
    frame: Array
    state: Array


class TangentFrames:
    """Trajectories with orthonormal tangent frames, advanced interval by interval.

    Args:
        system: The system.
        starts: States at time 0, shape (component,) or (trajectory, component).
        options: How.  The first vector is the one that `finite_time_exponents` starts with.
        units: Unit of each component, in which vectors are drawn and orthonormal, shape (trajectory, component); by
            default 1.  Growth is that of lengths in these units, which in the long run are the same in any.
        n_vectors: Vectors of each frame.
        at_equal_times: Whether vectors of a system with time lead to neighbours at the same time: their components
            along t and $p_t$ are zero and stay so.  There are two less, and those that are left out do not grow.

    Attributes:
        options: How they are advanced.
        field: The vector field.
        state: Last good states, shape (trajectory, component).
        unit: The units, shape (trajectory, component).
        frame: Orthonormal columns in these units, shape (trajectory, component, vector); meaningless where a trajectory
            has failed.
        outcome: "finished" for the trajectories that still go on, else how they ended.
        end_time: Time reached, shape (trajectory,).
        n_steps: Accepted steps, shape (trajectory,).
        n_wanted, n_left_out: Vectors that were asked for, and components that all vectors have zero.
        ratio: For each vector the largest ratio in one interval of the greatest stretching to its own, shape
            (trajectory, vector).
    """

    def __init__(
        self,
        system: HasField,
        starts: StartsLike,
        options: RunOptions,
        *,
        units: Array | None = None,
        n_vectors: int | None = None,
        at_equal_times: bool = False,
    ) -> None:
        self.options = options
        self.field: Field = options.tangent_field(system)
        n = self.field.n_components
        self.state: Array = as_starts(system, starts, n)
        self.unit: Array = np.ones_like(self.state) if units is None else units
        k = n if n_vectors is None else as_count(n_vectors, "n_exponents", least=1, most=n)
        first = as_first(options.first, len(self.state))
        self.n_wanted, self.n_left_out = k, n_of_time(system) if at_equal_times else 0
        k = min(k, n - self.n_left_out)
        frame = orthonormal_frames(n - self.n_left_out, k, len(self.state), seed=options.seed, first=first)
        self.frame: Array = np.concatenate([frame, np.zeros((len(frame), self.n_left_out, k))], axis=1)
        finite = np.isfinite(self.state).all(axis=1)
        self.outcome: NDArray[np.str_] = np.where(finite, "finished", "not finite").astype("<U32")
        self.end_time: Array = np.zeros(len(self.state))
        self.n_steps: NDArray[np.int64] = np.zeros(len(self.state), dtype=np.int64)
        self.ratio: Array = np.ones((len(self.state), k))
        self.order, self.kernel = 0, ""
        self._system = _Prepared(system.name, self.field)

    @property
    def is_hidden(self) -> NDArray[np.bool_]:
        """Which vectors' stretchings round-off hides, shape (trajectory, vector)."""
        return self.ratio > HIDDEN

    def goes_on(self, only: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
        """Which of the (given) trajectories have not ended, shape (trajectory,)."""
        going = self.outcome == "finished"
        return going if only is None else going & only

    def advance(
        self,
        duration: float,
        progress: Progress = None,
        *,
        only: NDArray[np.bool_] | None = None,
    ) -> Array:
        """Advances trajectories that still go on, and makes their frames orthonormal.

        Args:
            duration: Length of the interval, positive.
            progress: Called with the fraction of the interval that is done.
            only: Which ones, shape (trajectory,); by default all.

        Returns:
            The triangular matrices R, shape (trajectory, vector, vector); NaN where a trajectory has failed
            or was not asked for.
        """
        n_vectors = self.frame.shape[2]
        triangles = np.full((len(self.state), n_vectors, n_vectors), np.nan)
        going = np.flatnonzero(self.goes_on(only))
        if self.options.is_late:
            self.outcome[going] = "time limit"
        elif len(going):
            triangles[going] = self._advance(going, duration, progress)
        return triangles

    def carry(
        self,
        n: int,
        duration: float,
        progress: Progress = None,
        *,
        per_row: int = 1,
        keep: bool = False,
        only: NDArray[np.bool_] | None = None,
    ) -> Carried:
        """`advance`, n times, in one call of the core: the same steps, bit for bit.

        Args:
            n: Number of intervals.
            duration: Length of each, positive.
            progress: Called with the fraction that is done.
            per_row: So many intervals make up a row of the growth.
            keep: Whether what is found at each interval is kept.
            only: Which trajectories, shape (trajectory,); by default all.

        Returns:
            Carried; NaN in what a trajectory did not complete.
        """
        members, n_vectors = len(self.state), self.frame.shape[2]
        going = np.flatnonzero(self.goes_on(only))
        raw: Any = None
        if self.options.is_late and n:
            self.outcome[going] = "time limit"
        elif len(going) and n:
            raw = self._carry(going, n, duration, progress, per_row=per_row, keep=keep)
            failed = np.zeros(members, dtype=np.bool_)
            failed[going] = (raw["n_complete"] < n) & (self.outcome[going] == "finished")
            if failed.any():  # by the way that says how
                self.advance(duration, only=failed)
                assert not self.goes_on(failed).any(), "both ways take the same steps"

        def every(name: str, *shape: int) -> Array:
            if raw is not None and len(going) == members:
                return raw[name].reshape(members, *shape)
            values = np.full((members, *shape), np.nan)
            if raw is not None:
                values[going] = raw[name].reshape(len(going), *shape)
            return values

        n_kept, n_components = n if keep else 0, self.state.shape[1]
        return Carried(
            growth=every("growth", n // per_row, n_vectors),
            triangle=every("triangle", n_kept, n_vectors, n_vectors),
            frame=every("kept_frame", n_kept, n_components, n_vectors),
            state=every("kept_state", n_kept, n_components),
        )

    def _carry(
        self,
        going: NDArray[np.intp],
        n: int,
        duration: float,
        progress: Progress,
        *,
        per_row: int,
        keep: bool,
    ) -> Any:
        raw = _core.carry_frames(
            core_field(self.field),
            self.options.method.core(),
            self.state[going].ravel(),
            self.frame[going].ravel(),
            self.frame.shape[2],
            self.unit[going].ravel(),
            self.end_time[going],
            duration,
            n,
            per_row,
            keep,
            self.options.threads,
            self.options.left,
            progress,
        )
        self.order, self.kernel = raw["order"], raw["kernel"]
        self.state[going] = raw["final_state"].reshape(len(going), -1)
        self.frame[going] = raw["frame"].reshape(len(going), *self.frame.shape[1:])
        self.end_time[going] = raw["end_time"]
        self.n_steps[going] += raw["n_steps"]
        self.ratio[going] = np.maximum(self.ratio[going], raw["ratio"].reshape(len(going), -1))
        late = outcome_names(raw["outcome"]) == "time limit"
        self.outcome[going[late]] = "time limit"
        return raw

    def _advance(self, going: NDArray[np.intp], duration: float, progress: Progress) -> Array:
        orbit = integrate(
            self._system,
            self.state[going],
            times=[0.0, duration],
            tangents=np.ascontiguousarray(np.swapaxes(self.frame[going] * self.unit[going, :, None], 1, 2)),
            **replace(self.options, progress=progress).inner(),
        )
        self.order, self.kernel = orbit.order, orbit.kernel
        pushed = np.swapaxes(orbit.tangent[:, -1], 1, 2) / self.unit[going, :, None]
        overflown = (orbit.outcome == "finished") & ~np.isfinite(pushed).all(axis=(1, 2))
        self.outcome[going] = np.where(overflown, "not finite", orbit.outcome)
        self.state[going] = orbit.end_state
        self.end_time[going] += orbit.end_time
        self.n_steps[going] += orbit.n_steps
        good = self.outcome[going] == "finished"
        frames, triangles = np.full_like(pushed, np.nan), np.full((len(going), *(pushed.shape[2],) * 2), np.nan)
        frames[good], triangles[good] = positive_qr(pushed[good])
        self.frame[going] = frames
        diagonal = np.diagonal(triangles[good], axis1=1, axis2=2)
        largest, ratio = diagonal.max(axis=1, keepdims=True, initial=0.0), np.full_like(diagonal, np.inf)
        np.divide(largest, diagonal, out=ratio, where=diagonal > 0)
        self.ratio[going[good]] = np.maximum(self.ratio[going[good]], ratio)
        return triangles


class Clock:
    """Counts the intervals of a run and tells its progress, a few times a second and at the end.

    Args:
        n_intervals: Intervals of the whole run.
        progress: Called with the fraction that is done.
    """

    def __init__(self, n_intervals: int, progress: Progress) -> None:
        self._total, self._done, self._progress = n_intervals, 0, progress

    def carry(
        self,
        frames: TangentFrames,
        n: int,
        duration: float,
        *,
        per_row: int = 1,
        keep: bool = False,
        only: NDArray[np.bool_] | None = None,
    ) -> Carried:
        """`TangentFrames.carry`, over some of the intervals of the run."""
        tell, done = self._progress, self._done
        progress = None if tell is None else lambda part: tell((done + part * n) / self._total)
        carried = frames.carry(n, duration, progress, per_row=per_row, keep=keep, only=only)
        self._done += n
        if tell is not None and n:
            tell(self._done / self._total)
        return carried


class _Prepared:
    """A system whose field has been made."""

    def __init__(self, name: str, field: Field) -> None:
        self.name = name
        self._field = field

    def field(self) -> Field:
        return self._field


def positive_qr(matrices: Array) -> tuple[Array, Array]:
    """Householder's factors Q R of matrices (..., component, vector), with a positive diagonal of R.

    By the core: a library for linear algebra rounds differently from one processor to the next, and frames act on the
    steps, so that whole orbits would.
    """
    n_rows, n_columns = matrices.shape[-2:]
    frames, triangles = _core.orthonormal(np.ascontiguousarray(matrices).ravel(), n_rows, n_columns)
    return frames.reshape(matrices.shape), triangles.reshape(*matrices.shape[:-2], n_columns, n_columns)


def orthonormal_frames(n_components: int, n_vectors: int, n: int, *, seed: int, first: int = 0) -> Array:
    """Random orthonormal frames, shape (trajectory, component, vector); each is the same whatever `n` and `first`.

    The first vector has the direction of `sample_tangents`, the others are normal random vectors made orthonormal.
    """
    vectors = np.empty((n, n_components, n_vectors))
    for block in range(first // BLOCK, -(-(first + n) // BLOCK)):
        drawn = stream(seed, Purpose.FRAMES, block).standard_normal((BLOCK, n_components, n_components))[
            :, :, :n_vectors
        ]
        start = block * BLOCK - first
        kept = slice(max(start, 0), min(start + BLOCK, n))
        vectors[kept] = drawn[kept.start - start : kept.stop - start]
    vectors[:, :, 0] = sample_tangents(n_components, n, seed=seed, first=first)
    return positive_qr(vectors)[0]


def as_duration(value: Any, name: str, *, zero: bool = False) -> float:
    """A finite time > 0 (or >= 0) as a plain float.

    Raises:
        ParameterError: it is none.
    """
    return (
        as_positive(value, name, "a finite time >= 0", example=0, zero=True)
        if zero
        else as_time(value, name, example=5)
    )


def n_intervals(duration: float, interval: float, *, names: tuple[str, str] = ("t_end", "interval")) -> int:
    """The smallest number of equal intervals, at most `interval` long, that make up a duration.

    Raises:
        ParameterError: more than 10,000,000; `names` are those of the two times in the message.
    """
    number = np.ceil(duration / interval * (1.0 - 1e-12))
    if not number <= MOST_INTERVALS:
        raise ParameterError(
            f"{names[0]}: wanted at most {MOST_INTERVALS} intervals; got {names[0]}={duration:g} with "
            f"{names[1]}={interval:g}; take a shorter {names[0]}, or a longer {names[1]}"
        )
    return max(1, int(number)) if duration else 0
