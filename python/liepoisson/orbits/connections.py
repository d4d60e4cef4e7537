r"""Homoclinic and heteroclinic orbits, without any symmetry: where an unstable and a stable manifold meet.

With the amplitudes a, b on the linear unstable space of the source and the stable space of the target, and the times
T, S, the equations are

$$ \varphi_T(x(a)) = \varphi_{-S}(y(b)). $$

Guesses are found on one surface.  For a vector w that is orthogonal to the difference of the ends, $w\cdot x$ is the
same in the limits $t \to \pm\infty$ of an orbit between two equilibria, and oscillates around a periodic orbit: every
connecting orbit has an extremum of it, and crosses $w\cdot\dot x = 0$.  There the crossings of orbits from both sides
are compared.  As the flow keeps H and the Casimirs, there are more equations than are independent; steps are those of
least squares, across the flow.

References: [beyn1990]; [champneys1998].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError, TimeLimitError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_time
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods, shows_progress
from liepoisson.inputs.deadline import blocks, checkpoint, has_passed
from liepoisson.io.tables import vector_columns
from liepoisson.leaf._checks import are_equal
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.run_options import RunOptions
from liepoisson.orbits.invariant_manifolds import InvariantManifold, manifold_of
from liepoisson.orbits.saved_orbits import SavedOrbits, SearchedOrbits
from liepoisson.orbits.shooting import Flow
from liepoisson.orbits.unstable_spaces import (
    Flights,
    Meeting,
    UnstableSpace,
    angles_between,
    meetings,
    points_of,
    pushed,
    usual_time,
)
from liepoisson.portable import linear
from liepoisson.streams import Purpose, stream

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.orbits.unstable_spaces import Base

_SAME_LEVEL = 1e-9
_SAME_STATE = 1e-5
_NEUTRAL = 1e-6
"""An angle between the manifolds below this is that of a family, within what the tangent spaces can tell."""
_GUESSES_PER_START = 4
_STEPS_ALONG = 4
_ROWS = 256
"""Crossings that are compared with all others at a time."""


@explains_its_methods
@dataclass(frozen=True, eq=False)
class ConnectingOrbit(SavedOrbits):
    r"""An orbit that comes from the source for $t \to -\infty$ and goes to the target for $t \to \infty$.

    Example:
        >>> pendulum = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
        >>> ends = [lp.phase_space.equilibrium(pendulum, [angle, 0]) for angle in (-np.pi, np.pi)]
        >>> orbit = lp.orbits.connecting_orbits(*ends)[0]
        >>> abs(orbit.middle).round(4).tolist(), orbit.residual < 1e-12  # q = 4 arctan(exp(t)) - pi
        ([0.0, 2.0], True)

    Attributes:
        unstable: The unstable manifold of the source.
        stable: The stable manifold of the target.
        start: Where it begins on the linear unstable space, shape (N,).
        middle: Where the orbits from both sides meet, shape (N,).
        end: Where it ends on the linear stable space, shape (N,).
        times: The times from the start to the middle and from there to the end.
        residual: How far the two computed middles were apart, in units of the level.
        angles: The angles between the tangent spaces of both manifolds at the middle, in the level across the flow, in
            rad, increasing.  The manifolds are transversal if none is 0 and their dimensions suffice.
    """

    kind = "connecting orbit"
    made_by = "lp.orbits.connecting_orbits"

    unstable: InvariantManifold
    stable: InvariantManifold
    start: Array
    middle: Array
    end: Array
    times: tuple[float, float]
    residual: float
    angles: Array

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.unstable.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table, which has one row: flight, middle and angles in rad."""
        return _columns((self,), self.system)

    @property
    def time(self) -> float:
        """From the start to the end."""
        return sum(self.times)

    def states(self, n_times: int = 401) -> tuple[Array, Array]:
        """Times, shape (n,), 0 in the middle, and states, shape (n, N), from the start to the end.

        Each part is integrated towards the middle, from which errors do not grow.
        """
        n_times, (before, after) = as_count(n_times, "n_times", least=3), self.times
        n = int(np.clip(np.rint((n_times - 1) * before / self.time), 1, n_times - 2))
        first, last = np.linspace(-before, 0.0, n + 1), np.linspace(after, 0.0, n_times - n)
        one = integrate(self.system, self.start, times=first + before).state[0]
        other = integrate(self.system, self.end, times=last - after).state[0]
        states = np.concatenate([one[:-1], self.middle[None], other[-2::-1]])
        return np.concatenate([first, last[-2::-1]]), states

    def __repr__(self) -> str:
        what = _kind_of(self.unstable, self.stable)
        angles = f", angles {', '.join(f'{angle:.5g}' for angle in self.angles)} rad" if self.angles.size else ""
        return f"<ConnectingOrbit of {self.system.name!r}: {what}, flight {self.time:.6g}{angles}>"


def _kind_of(unstable: InvariantManifold, stable: InvariantManifold) -> str:
    return "homoclinic" if unstable.base is stable.base else "heteroclinic"


def _columns(orbits: Sequence[ConnectingOrbit], system: System) -> dict[str, NDArray[Any]]:
    return {
        **{name: np.array([getattr(one, name) for one in orbits]) for name in ("time", "residual")},
        **vector_columns("middle", [one.middle for one in orbits], system.component_names),
        **vector_columns("angle", [one.angles for one in orbits]),
    }


@dataclass(frozen=True, eq=False, repr=False)
class ConnectingOrbits(SearchedOrbits[ConnectingOrbit]):
    """Orbits from one equilibrium or periodic orbit to another or itself, those with the shortest flight first.

    Example:
        >>> well = lp.System(lp.canonical(1, names=["x"]), "p_x^2/2 - x^2/2 + x^4/4")
        >>> len(lp.orbits.connecting_orbits(lp.phase_space.equilibrium(well, [0, 0])))  # one on each side
        2

    Attributes:
        unstable: The unstable manifold of the source.
        stable: The stable manifold of the target.
        found: The orbits.  Images under symmetries are orbits of their own, but for those under the symmetry by which
            the loop of a periodic orbit closes.
        t_end: The longest flight that was looked for on either side.
        n_starts: How many starts were taken on either side, at most where the time limit ended the search.
        n_families: How many orbits were left out since the manifolds do not cross there within what doubles can tell:
            they belong to families, as in integrable systems, or are tangencies.
        is_cut_short: Whether the time limit ended the search.
    """

    kind = "connecting orbits"
    made_by = "lp.orbits.connecting_orbits"
    titles = ("flight", "angles (rad)", "residual")

    unstable: InvariantManifold
    stable: InvariantManifold
    found: tuple[ConnectingOrbit, ...]
    t_end: float
    n_starts: int
    n_families: int
    is_cut_short: bool = False

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.unstable.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its flight, middle and angles in rad."""
        return _columns(self.found, self.system)

    def _head(self) -> str:
        noun = f"{_kind_of(self.unstable, self.stable)} orbit"
        where = f"of {self.system.name!r}, with flights up to {self.t_end:.6g} on either side"
        return self._sentence(noun, where, "{} starts", "along which the manifolds do not cross")

    def _row(self, one: ConnectingOrbit, /) -> tuple[str, ...]:
        return f"{one.time:.6f}", ", ".join(f"{angle:.5f}" for angle in one.angles), f"{one.residual:.0e}"


@shows_progress
def connecting_orbits(
    source: Base,
    target: Base | None = None,
    *,
    n_starts: int = 200,
    t_end: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> ConnectingOrbits:
    r"""Homoclinic and heteroclinic orbits of equilibria and periodic orbits, with or without symmetry.

    From random states of the linear unstable space of the source and the stable one of the target orbits are followed;
    where both come near to each other on a surface they are improved by Newton's method.

    Example:
        >>> saddle = lp.System(lp.canonical(1), "p1^2/2 - q1^2/2 - q1^3/3 + p1*q1^2/5")  # no reverser
        >>> found = lp.orbits.connecting_orbits(lp.phase_space.equilibrium(saddle, [0, 0]))
        >>> len(found), found[0].residual < 1e-11
        (1, True)

    Args:
        source: An equilibrium or a periodic orbit with unstable directions.
        target: One with stable directions, on the same leaf and of the same energy; by default the source.
        n_starts: How many starts on either side.
        t_end: The longest time on either side; by default $(\ln(1/d) + 6)/\lambda$ with the slowest rate and the
            amplitude d of the starts.
        seed: Draws the starts and the surface.
        threads: By default all processors, for the survey of all starts; Newton's method runs in one thread.
        time_limit: Seconds after which nothing more is looked for; what was found by then is described to the end, and
            `is_cut_short` is true.

    Returns:
        The orbits by increasing time of flight; that there are no others is not proved.  Those that leave an
        equilibrium along the slower one of two rates are rarely met by starts in all directions.

    Raises:
        ParameterError: there are no such directions, or source and target have other energies or leaves, or belong to
            different systems.
        LeafError: the leaf of an equilibrium is not regular.
        MemoryLimitError: the states up to `t_end` do not fit into memory.

    References: [beyn1990].
    """
    run = RunOptions.read(None, threads, time_limit, progress, seed=seed)
    n_starts = as_count(n_starts, "n_starts", least=1)
    longest = None if t_end is None else as_time(t_end, "t_end", example=50.0)
    solved: list[Solution] = []
    n_done = 0
    with run.deadline.running():
        unstable = manifold_of(source, "unstable", name="source")
        stable = manifold_of(source if target is None else target, "stable", name="target")
        _check_levels(unstable, stable)
        search = _Search(unstable, stable, Flow(unstable.system, run.threads), longest, run.seed)
        try:
            for n in blocks(n_starts):
                n_done += n
                for done, some in search.solved(n, run):
                    run.tell((n_done - n + 0.9 * n * done) / n_starts)
                    solved += some
        except TimeLimitError:  # what was found before is described
            pass
        is_cut_short = has_passed()
    found = [search.described(one) for one in search.distinct(solved)]
    crossing = [one for one in found if not (one.angles < _NEUTRAL).any()]
    crossing.sort(key=lambda one: one.time)
    return ConnectingOrbits(
        unstable, stable, tuple(crossing), search.longest, n_done, len(found) - len(crossing), is_cut_short
    )


Solution: TypeAlias = "tuple[UnstableSpace, UnstableSpace, Meeting]"
"""From which image of the source to which of the target, and how."""


def _check_levels(unstable: InvariantManifold, stable: InvariantManifold) -> None:
    """Refuses a target of another system, leaf or energy."""
    if not are_equal(unstable.system, stable.system):
        raise ParameterError(f"target: wanted one of {unstable.system!r}; got one of {stable.system!r}")
    one, other = unstable.space.level, stable.space.level
    near = unstable.space.state + np.diag(one.units)
    for name, function in one.functions.items():
        scale = float(np.abs(function(near) - function(unstable.space.state)).max())
        if not abs(one.constant(name) - other.constant(name)) <= _SAME_LEVEL * scale:
            raise ParameterError(
                f"target: wanted one with the same {'energy' if name == 'H' else 'leaf'} as the source, {one.text}; "
                f"got {other.text}"
            )


class _Search:
    """Flights from both sides that meet."""

    def __init__(
        self, unstable: InvariantManifold, stable: InvariantManifold, flow: Flow, longest: float | None, seed: int
    ) -> None:
        self.manifolds, self.flow, self.units = (unstable, stable), flow, unstable.space.level.units
        self.draw = stream(seed, Purpose.CONNECTING_ORBITS)
        sizes: list[float] = []
        for one in self.manifolds:  # the largest amplitude, after one loop, is that whose error was measured
            loop = float(np.abs(linear.eigvals(one.space.matrix)).max()) if one.space.loop_time else 1.0
            sizes.append(one.amplitude / loop)
        usual = max(usual_time(one.space, size) for one, size in zip(self.manifolds, sizes, strict=True))
        self.longest = usual if longest is None else float(longest)
        self.sizes = sizes
        self.images = [one.space.images() for one in self.manifolds]
        if unstable.base is stable.base:  # images under the symmetry of the loop are the same orbit
            self.images[0] = self.images[0][:1]
        self.paths = np.concatenate([points_of(one.base) for one in self.manifolds]) / self.units
        between = (stable.space.state - unstable.space.state) / self.units
        w = self.draw.standard_normal(len(self.units))
        size = float(linear.matmul(between, between))
        self.normal = w - between * (float(linear.matmul(between, w)) / size) if size > 0 else w

    def solved(self, n: int, run: RunOptions) -> Iterator[tuple[float, list[Solution]]]:
        """What is found from so many starts on either side, for one pair of images after the other.

        Raises:
            TimeLimitError: the deadline of the call has passed.
        """
        crossings: list[list[Crossings]] = []
        for k in range(2):
            flights = self.flights(k, self.images[k][0])
            amplitudes = flights.drawn(n, self.draw)
            if amplitudes.shape[1] == 1 and not flights.space.loop_time:  # of a curve there are two starts
                amplitudes = np.unique(amplitudes, axis=0)
            grid, states, early = flights.survey(amplitudes)
            found: list[Crossings] = []
            for _ in self.images[k]:
                checkpoint("crossings of a surface")
                found.append(self._crossings(amplitudes, grid, states, early))
                states = linear.matmul(states, flights.space.closing.T)
            crossings.append(found)
        pairs = [(i, j) for i in range(len(self.images[0])) for j in range(len(self.images[1]))]
        for done, (i, j) in enumerate(pairs, start=1):
            first, last = crossings[0][i], crossings[1][j]
            rows, columns = self._near(first, last, _GUESSES_PER_START * n)
            spaces = self.images[0][i], self.images[1][j]
            sides = [self.flights(k, space) for k, space in enumerate(spaces)]
            guesses = [first.amplitudes[rows], last.amplitudes[columns]], [first.times[rows], last.times[columns]]
            yield done / len(pairs), [(*spaces, one) for one in meetings(sides, *guesses, self._meet(sides))]

    def flights(self, k: int, space: UnstableSpace) -> Flights:
        """Flights from the source or the target, or from an image of it."""
        return Flights(space, self.flow, self.longest, self.sizes[k])

    def _crossings(self, amplitudes: Array, grid: Array, states: Array, early: NDArray[np.bool_]) -> Crossings:
        """Where orbits cross the surface, by cubic interpolation."""
        with np.errstate(all="ignore"):
            rates = self.flow.system.vector_field(states) / self.units
            values = linear.matmul(rates, self.normal)
            known = np.isfinite(values[:, :-1]) & np.isfinite(values[:, 1:]) & ~early[:-1]
            rows, places = np.nonzero(known & ((values[:, :-1] > 0) != (values[:, 1:] > 0)))
        x, y = states[rows, places] / self.units, states[rows, places + 1] / self.units
        v, w = rates[rows, places], rates[rows, places + 1]
        before, after = values[rows, places], values[rows, places + 1]
        step, part = (grid[places + 1] - grid[places])[:, None], (before / (before - after))[:, None]
        x = (1 - part) ** 2 * ((1 + 2 * part) * x + part * step * v)
        y = part**2 * ((3 - 2 * part) * y - (1 - part) * step * w)
        times = np.abs(grid[places] + (part * step)[:, 0])
        senses = np.where((after > before) == (step[:, 0] > 0), 1, -1)
        return Crossings(amplitudes[rows], times, x + y, senses)

    def _near(self, one: Crossings, other: Crossings, n: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The nearest crossing to each, of the n pairs that are nearest relative to their distance from the ends."""
        if not (len(one.times) and len(other.times)):
            return np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp)
        gaps, columns = np.empty(len(one.times)), np.empty(len(one.times), dtype=np.intp)
        for first in range(0, len(gaps), _ROWS):
            checkpoint("comparing crossings of a surface")
            some = slice(first, first + _ROWS)
            gap = _distances(one.states[some], other.states)
            gap[one.senses[some, None] != other.senses] = np.inf
            columns[some] = np.argmin(gap, axis=1)
            off = _distances(one.states[some], self.paths).min(axis=1)
            gaps[some] = gap.min(axis=1) / np.maximum(off, np.finfo(float).tiny)
        rows = np.argsort(gaps, kind="stable")[:n]
        rows = rows[np.isfinite(gaps[rows])]
        return rows, columns[rows]

    def _meet(self, sides: list[Flights]) -> Callable[[list[Array], list[Array], list[Array]], tuple[Array, Array]]:
        """The equations: both ends are one, which does not move along the flow, nor starts along that of equilibria."""
        units, sizes = self.units, [one.space.basis.shape[1] + 1 for one in sides]

        def equations(a: list[Array], ends: list[Array], slopes: list[Array]) -> tuple[Array, Array]:
            first, last = (slope / units[:, None] for slope in slopes)
            rows = [np.concatenate([first, -last], axis=2)]
            rate = first[..., -1] / np.maximum(linear.norm(first[..., -1], axis=1, keepdims=True), 1e-300)
            held = np.zeros((len(first), 1, sum(sizes)))
            held[:, 0, : sizes[0]] = linear.einsum("ni,nij->nj", rate, first)
            rows.append(held)
            for k, one in enumerate(sides):
                if not one.space.loop_time:
                    held = np.zeros((len(first), 1, sum(sizes)))
                    place = k * sizes[0]
                    held[:, 0, place : place + sizes[k] - 1] = a[k] / one.size
                    rows.append(held)
            matrix = np.concatenate(rows, axis=1)
            zeros = np.zeros((len(first), matrix.shape[1] - len(units)))
            return np.concatenate([(ends[0] - ends[1]) / units, zeros], axis=1), matrix

        return equations

    def distinct(self, found: list[Solution]) -> list[Solution]:
        """One for each orbit, the most accurate: the middle of another one is not on it."""
        kept: list[Solution] = []
        paths: list[Array] = []
        turns = [np.eye(len(self.units))]
        if self.manifolds[0].base is self.manifolds[1].base:
            for _ in self.images[1][1:]:
                turns.append(linear.matmul(self.images[1][0].closing, turns[-1]))
        for one in sorted(found, key=lambda one: one[2].residual):
            middles = [linear.matmul(turn, one[2].ends[0]) for turn in turns]
            if not any(self._passes(path, middle) for path in paths for middle in middles):
                kept.append(one)
                paths.append(self._path(one))
        return kept

    def _path(self, one: Solution) -> Array:
        """States along an orbit, shape (n, N)."""
        parts: list[Array] = []
        for k in range(2):
            flights = Flights(one[:2][k], self.flow, one[2].times[k], self.sizes[k])
            parts.append(flights.survey(one[2].amplitudes[k][None])[1][0])
        return np.concatenate([parts[0], parts[1][::-1]])

    def _passes(self, path: Array, state: Array) -> bool:
        """Whether an orbit passes a state."""
        x = path[np.argmin(linear.norm((path - state) / self.units, axis=1))]
        for _ in range(_STEPS_ALONG):
            gap, rate = (state - x) / self.units, self.flow.system.vector_field(x) / self.units
            if np.abs(gap).max() < _SAME_STATE:
                return True
            time = float(linear.matmul(gap, rate) / linear.matmul(rate, rate))
            if not linear.norm(gap - time * rate) < abs(time) * linear.norm(rate):  # from a near state it is the flow
                return False
            x = self.flow.ends(x[None], np.array([time]))[0][0]
        return False

    def described(self, found: Solution) -> ConnectingOrbit:
        """A connecting orbit, with the angles between the manifolds where both sides meet."""
        spaces, meeting = found[:2], found[2]
        tangents: list[Array] = []
        starts: list[Array] = []
        dimensions: list[int] = []
        for space, a, time in zip(spaces, meeting.amplitudes, meeting.times, strict=True):
            start, slopes = space.states(a[None])
            tangents.append(pushed(self.flow, start[0], space.direction * time, slopes[0]))
            starts.append(start[0])
            dimensions.append(space.basis.shape[1] - (space.loop_time == 0))
        middle = (meeting.ends[0] + meeting.ends[1]) / 2
        angles = angles_between(spaces[0].level, middle, tangents[0], tangents[1], (dimensions[0], dimensions[1]))
        times = meeting.times[0], meeting.times[1]
        return ConnectingOrbit(*self.manifolds, starts[0], middle, starts[1], times, meeting.residual, angles)


@dataclass(frozen=True, eq=False)
class Crossings:
    """Crossings of the surface by orbits from one side.

    Attributes:
        amplitudes: Where the orbits began, shape (n, k).
        times: When they cross, shape (n,).
        states: Where, in units of the level, shape (n, N).
        senses: In which sense, when time goes forwards, 1 or -1, shape (n,).
    """

    amplitudes: Array
    times: Array
    states: Array
    senses: NDArray[np.int64]


def _distances(one: Array, other: Array) -> Array:
    """The distances of all states from all others, shape (n, m)."""
    squares = np.zeros((len(one), len(other)))
    for x, y in zip(one.T, other.T, strict=True):
        squares += (x[:, None] - y) ** 2
    return np.sqrt(squares)
