r"""Shooting from one fixed set to another: many segments at once, by Newton's method in starts and times.

A segment begins in $\mathrm{Fix}\,\rho_0$ on a level and ends after the time T in $\mathrm{Fix}\,\rho_1$.  With a basis
F of $\mathrm{Fix}\,\rho_0$, the start $x = Fz$, and a basis A of the vectors with $\rho_1 a = -a$, the equations are

$$ C(Fz) = c, \qquad A^T\varphi_T(Fz) = 0 . $$

For the reversers of a system on leaves of dimension 2m they are as many as the unknowns (z, T), once the functions C
(H and the Casimirs) are counted; where there are more, or other solutions beside, steps have minimum norm.

References: [devogelaere1958]; [lamb1998].
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.errors import TimeLimitError
from liepoisson.formula.scalars import MOST, TIME_LIMIT
from liepoisson.inputs.arrays import Array, check_memory
from liepoisson.inputs.deadline import checkpoint, seconds_left
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.method.method import MAX_STEPS, Method
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import field_for
from liepoisson.numeric.systems import as_field, core_field, without_value
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.model.discrete_symmetries import DiscreteSymmetry
    from liepoisson.model.system import System
    from liepoisson.orbits.level import Level

TOGETHER = 16
"""Trajectories of about the same length that are integrated in one call: two registers of eight."""

_ARRAYS_OF_STATES = 3
"""Arrays of all states that a survey makes: the states, those in units of the level, and their derivatives."""

_MOST_KNOWN = 4096
"""Ends that are kept, of 8 N (N + 1) bytes each: 3 MB where N = 9.  Measured in searches from starts and from guesses,
in cycles and in families: of 300 to 3400 ends that are asked for, 6 to 34 in a hundred were known, with 1024 that are
kept nearly as many, with more than 4096 not one more; without any the searches take a tenth to a fifth longer."""

_UNDER_WAY = "following orbits"
_FAST = 10
"""Steps for each time of a survey, at twelve in a natural time, above which a trajectory is too fast for it.  Measured
up to 2 and up to 30 natural times: in the systems of the catalog it takes a quarter of a step for each, in the Kepler
problem and that of three bodies, which have close encounters, up to 6; one that winds up towards infinity takes any
number."""
LONGEST_STEP, LONGEST_DELAY = 0.3, 0.2
"""The longest correction of Newton's method: of a state, in units of the level, and of the time, relative to it."""
_MOST_STEPS = 20
_MEETS = 1e-4
"""Norm of the residual from which on Newton's method converges quadratically: it must get there in some steps."""


def fixed_basis(symmetry: DiscreteSymmetry) -> Array:
    """An orthonormal basis of the fixed space, as columns, shape (N, d)."""
    n = len(symmetry.signs)
    rows = np.array(symmetry.fixed_space, dtype=np.float64).reshape(-1, n)
    return (rows / linear.norm(rows, axis=1, keepdims=True)).T


def mirror_basis(symmetry: DiscreteSymmetry) -> Array:
    r"""An orthonormal basis of the vectors that are orthogonal to the fixed space, as columns, shape (N, N - d).

    A signed permutation is an orthogonal matrix, so for an involution these are the vectors with $\rho a = -a$.
    """
    fixed = fixed_basis(symmetry)
    vectors, sizes, _ = linear.svd(np.eye(len(fixed)) - linear.matmul(fixed, fixed.T))
    return vectors[:, sizes > 0.5]


def are_finite(states: Array) -> NDArray[np.bool_]:
    """Which states are finite, shape (n,)."""
    return np.asarray(np.isfinite(states).all(axis=-1))


def n_times_of(t_end: float, unit: float) -> int:
    """Number of times that are surveyed up to one, so many in each unit of time; too many are refused by `survey`."""
    return int(min(np.ceil(t_end / unit), MOST))


@dataclass(frozen=True)
class Flow:
    """Ends of trajectories that have each a time of its own.

    They are integrated in groups, each by one thread: starting threads for so little work costs more than it gives.
    The last ones are kept: a loop is linearised where it is found, and again where it is followed and described.

    Attributes:
        system: The system.
        threads: How many threads survey many starts at once; None for all.
        method: How they are integrated.
    """

    system: System
    threads: int | None = None
    method: Method = field(default_factory=Taylor)
    _known: dict[bytes, tuple[Array, Array]] = field(default_factory=dict, init=False, repr=False, compare=False)

    def ends(self, starts: Array, times: Array, tangents: Array | None = None) -> tuple[Array, Array]:
        """States and tangent vectors of each trajectory at its own time; NaN where it did not reach it.

        Args:
            starts: Shape (n, N).
            times: Shape (n,), all of one sign, none zero.
            tangents: Tangent vectors as columns, shape (N, k) for all or (n, N, k).

        Returns:
            States, shape (n, N), and tangent vectors as columns, shape (n, N, k).

        Raises:
            TimeLimitError: the deadline of the call has passed.
        """
        n, N = starts.shape
        vectors = np.zeros((n, N, 0)) if tangents is None else np.broadcast_to(tangents, (n, N, tangents.shape[-1]))
        keys = [a.tobytes() + t.tobytes() + v.tobytes() for a, t, v in zip(starts, times, vectors, strict=True)]
        new = np.array([k for k, key in enumerate(keys) if key not in self._known], dtype=int)
        if len(self._known) + len(new) > max(_MOST_KNOWN, n):
            self._known.clear()
            new = np.arange(n)
        backwards = bool(n) and times[0] < 0
        order = new[np.argsort(np.abs(times[new]), kind="stable")]
        for first in range(0, len(order), TOGETHER):
            checkpoint(_UNDER_WAY)
            some = order[first : first + TOGETHER]
            grid = np.unique(np.append(0.0, np.abs(times[some])))
            states, moved = self._followed(
                starts[some], -grid if backwards else grid, np.ascontiguousarray(np.swapaxes(vectors[some], 1, 2))
            )
            checkpoint(_UNDER_WAY)
            places = np.searchsorted(grid, np.abs(times[some])).tolist()
            for row, (k, place) in enumerate(zip(some.tolist(), places, strict=True)):
                self._known[keys[k]] = states[row, place], moved[row, place].T
        found = [self._known[key] for key in keys]
        ends, slopes = [end for end, _ in found], [slope for _, slope in found]
        return np.array(ends).reshape(starts.shape), np.array(slopes).reshape(vectors.shape)

    def _followed(self, starts: Array, times: Array, vectors: Array) -> tuple[Array, Array]:
        """States and tangent vectors as `integrate` has them, which is asked where one does not come to the end."""
        n, k, N = vectors.shape
        seconds = seconds_left(TIME_LIMIT)
        begin = are_finite(starts) & ~self.lost(starts)
        if begin.all() and np.isfinite(times).all():
            raw = _core.orbits(
                *self._data, starts.ravel(), vectors.ravel(), k, times, 1, seconds, False, False, None
            )  # fmt: skip
            states, moved = (
                raw[name].reshape(n, len(times), *rest) for name, rest in (("state", (N,)), ("tangent", (k, N)))
            )
            if not (raw["outcome"].any() or self.lost(states).any()) and np.isfinite(raw["final_state"]).all():
                return states, moved
        states, moved = np.full((n, len(times), N), np.nan), np.full((n, len(times), k, N), np.nan)
        if begin.any():
            orbit = integrate(
                self.system,
                starts[begin],
                times=times,
                tangents=vectors[begin] if k else None,
                method=self.method,
                kernel="lanes",  # one trajectory alone is then the same as among others
                threads=1,
                time_limit=seconds,
            )
            states[begin], moved[begin] = orbit.state, orbit.tangent
        return states, moved

    def lost(self, states: Array) -> NDArray[np.bool_]:
        """At which of them an invariant is no real number, shape (...)."""
        lost = np.zeros(states.shape[:-1], dtype=bool)
        for one in without_value(self.system, states).values() if self._is_partial else ():
            lost |= one
        return lost

    @cached_property
    def _is_partial(self) -> bool:
        """Whether an invariant has no value at some states."""
        return bool(without_value(self.system, np.zeros(len(self.system.component_names))))

    @cached_property
    def _data(self) -> tuple[_core.Field, _core.Method]:
        """The field and the method as the core takes them."""
        return core_field(field_for(self.system, as_field(self.system), self.method)), self.method.core()

    def survey(self, starts: Array, t_end: float, n_times: int) -> tuple[Array, Array]:
        """Evenly spaced times up to one, and the states of all trajectories there.

        Args:
            starts: Shape (n, N).
            t_end: The last time.
            n_times: Number of times after 0.

        Returns:
            Times, shape (n_times + 1,), and states, shape (n, n_times + 1, N); NaN where a trajectory did not get, or
            not before the deadline of the call.

        Raises:
            MemoryLimitError: the states, scaled and with their derivatives, do not fit into memory.
        """
        check_memory(_ARRAYS_OF_STATES * 8 * starts.size * (n_times + 1), "t_end")
        grid = np.linspace(0.0, t_end, n_times + 1)
        orbit = integrate(
            self.system,
            starts,
            times=grid,
            method=self.method,
            kernel="lanes",
            threads=self.threads,
        )
        return grid, orbit.state

    def paths(self, starts: Array, times: Array, n: int) -> Array:
        """States at 0, 1/n, 2/n, ... of its own time of each trajectory, shape (len(starts), n + 1, N).

        Args:
            starts: Shape (len(starts), N).
            times: Shape (len(starts),), positive.
            n: In how many parts.

        Raises:
            TimeLimitError: the deadline of the call has passed.
        """
        grids = np.linspace(0.0, times, n + 1, axis=1)
        found = np.empty((*grids.shape, starts.shape[1]))
        order = np.argsort(times, kind="stable")
        for first in range(0, len(order), TOGETHER):
            checkpoint(_UNDER_WAY)
            some = order[first : first + TOGETHER]
            grid = np.unique(grids[some])
            states, _ = self._followed(starts[some], grid, np.zeros((len(some), 0, starts.shape[1])))
            checkpoint(_UNDER_WAY)
            for k, row in zip(some.tolist(), states, strict=True):
                found[k] = row[np.searchsorted(grid, grids[k])]
        return found

    def searching(self, n_times: int) -> Flow:
        """The same for a search that surveys so many times: trajectories that are too fast for these end."""
        return replace(self, method=replace(self.method, max_steps=min(_FAST * n_times, MAX_STEPS)))

    def matrix(self, start: Array, time: float) -> tuple[Array, Array]:
        """The end of one trajectory and the derivative of the flow along it, shapes (N,) and (N, N)."""
        ends, tangents = self.ends(start[None], np.array([time]), np.eye(len(start)))
        return ends[0], tangents[0]


@dataclass(frozen=True)
class Segments:
    """Segments from one fixed set to another.

    Attributes:
        start: Shape (n, N).
        time: Shape (n,).
        residual: How far the end is from the fixed set, in units of the level, shape (n,).
        regularity: The smallest singular value of the equations by the largest one, shape (n,): 0 where segments are
            not isolated.
    """

    start: Array
    time: Array
    residual: Array
    regularity: Array

    def __len__(self) -> int:
        return len(self.time)

    def of(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> Segments:
        """Some of them."""
        return Segments(self.start[rows], self.time[rows], self.residual[rows], self.regularity[rows])


@dataclass(frozen=True)
class Shooting:
    """The equations for segments between two fixed sets of a level.

    Attributes:
        level: The level.
        first: The reverser in whose fixed set segments begin.
        last: That in whose fixed set they end.
        flow: How they are integrated.
    """

    level: Level
    first: DiscreteSymmetry
    last: DiscreteSymmetry
    flow: Flow

    def near(self, starts: Array, t_end: float, n_times: int, n_wanted: int) -> Segments:
        """Starts and times at which trajectories come near the last fixed set, the nearest first.

        They are local minima in time of the distance; each start gives several.
        """
        grid, states = self.flow.searching(n_times).survey(starts, t_end, n_times)
        mirror = mirror_basis(self.last)
        distance = linear.norm(linear.matmul((states / self.level.units), mirror), axis=-1)
        speed = linear.norm(np.gradient(states / self.level.units, grid, axis=1), axis=-1)
        inner = (distance[:, 1:-1] <= distance[:, :-2]) & (distance[:, 1:-1] < distance[:, 2:])
        rows, places = np.nonzero(inner)
        places = places + 1
        # how far off it is, in units of the time that it would take to get there
        size = distance[rows, places] / np.maximum(speed[rows, places], 1e-300)
        best = np.argsort(size, kind="stable")[:n_wanted]
        rows, places = rows[best], places[best]
        return Segments(starts[rows], grid[places], distance[rows, places], np.ones(len(rows)))

    def solved(self, guesses: Segments, *, tolerance: float, least: float, most: float) -> Segments:
        """What Newton's method makes of guesses; those that leave the range of times or do not converge are dropped.

        Where the deadline of the call passes, those that have converged are kept.

        Args:
            guesses: Starts and times.
            tolerance: Largest residual of what is kept.
            least: Smallest time.
            most: Largest time.
        """
        x, T = guesses.start.copy(), guesses.time.copy()
        residual, regularity = np.full(len(T), np.inf), np.zeros(len(T))
        best_x, best_T = x.copy(), T.copy()
        active = np.arange(len(T))
        units = self.level.units
        basis, mirror = fixed_basis(self.first) * units[:, None], mirror_basis(self.last)
        for k in range(_MOST_STEPS):
            if not active.size:
                break
            try:
                ends, tangents = self.flow.ends(x[active], T[active], basis)
            except TimeLimitError:
                break
            values, slopes = self._equations(x[active], ends, tangents, basis, mirror)
            size = np.abs(values).max(axis=-1)
            size[~np.isfinite(size)] = np.inf
            better = size < residual[active]
            best_x[active[better]], best_T[active[better]] = x[active[better]], T[active[better]]
            # at round-off a step helps no more; one that is still far off after some steps is given up
            stalled = ~better & (residual[active] < _MEETS)
            residual[active[better]] = size[better]
            sizes = linear.svd(slopes[better], compute_uv=False)
            regularity[active[better]] = sizes[:, -1] / sizes[:, 0]
            go = np.isfinite(size) & ~stalled & (size > 1e-16) & ((k < 8) | (size < _MEETS))
            move = -linear.einsum("nij,nj->ni", linear.pinv(np.where(go[:, None, None], slopes, 0.0), rcond=1e-11),
                              np.where(go[:, None], values, 0.0))  # fmt: skip
            step, delay = linear.matmul(move[:, :-1], basis.T), move[:, -1]
            length = linear.norm(step / units, axis=1)
            factor = 1.0 / np.maximum(1.0, np.maximum(length / LONGEST_STEP, np.abs(delay / T[active]) / LONGEST_DELAY))
            x[active] += factor[:, None] * step
            T[active] += factor * delay
            active = active[go & (T[active] > 0.5 * least) & (T[active] < 1.5 * most)]
        good = (residual <= tolerance) & (best_T >= least) & (best_T <= most)
        return Segments(best_x[good], best_T[good], residual[good], regularity[good])

    def _equations(self, x: Array, ends: Array, tangents: Array, basis: Array, mirror: Array) -> tuple[Array, Array]:
        """Values (n, e) and derivatives (n, e, d + 1) of all equations in (z, T), in units of the level."""
        level, units = self.level, self.level.units
        scale = np.maximum(linear.matmul(np.abs(level.gradients(x)), units), 1e-300)
        on_level = level.deviations(x) / scale
        slopes = linear.matmul(level.gradients(x), basis) / scale[..., None]
        with np.errstate(all="ignore"):
            rate = np.where(are_finite(ends)[:, None], self.flow.system.vector_field(ends), np.nan)
        rows = mirror.T / units
        # a signed permutation may only exchange components of one unit, so the rows stay mirror vectors
        at_end = linear.matmul(ends, rows.T)
        end_slopes = np.concatenate([linear.matmul(rows, tangents), linear.matmul(rate, rows.T)[..., None]], axis=-1)
        zeros = np.zeros((*slopes.shape[:-1], 1))
        return (
            np.concatenate([on_level, at_end], axis=-1),
            np.concatenate([np.concatenate([slopes, zeros], axis=-1), end_slopes], axis=-2),
        )
