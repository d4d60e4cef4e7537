r"""Symmetric homoclinic orbits to symmetric periodic orbits and to equilibria.

An orbit on the unstable manifold that meets $\mathrm{Fix}\,\rho$ is its own mirror image, and so it is on the stable
manifold of the mirror image of where it came from, too.  With k unstable directions (m - 1 for a periodic orbit, m for
an equilibrium, on a leaf of dimension 2m), the unknowns are the amplitudes a on the linear unstable space and the time;
the equations say that the end is in the fixed set.

References: [devaney1976]; [champneys1998].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from liepoisson.errors import OrbitError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_time
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import blocks, has_passed
from liepoisson.numeric.run_options import RunOptions
from liepoisson.orbits.homoclinic_orbits import HomoclinicOrbit, HomoclinicOrbits
from liepoisson.orbits.level import Level
from liepoisson.orbits.shooting import Flow, mirror_basis
from liepoisson.orbits.symmetric_orbits import group_of_level, reversers_of
from liepoisson.orbits.unstable_spaces import (
    AMPLITUDE,
    Flights,
    UnstableSpace,
    angles_between,
    meetings,
    points_of,
    pushed,
    unstable_space,
    usual_time,
)
from liepoisson.portable import linear
from liepoisson.streams import Purpose, stream

if TYPE_CHECKING:
    from liepoisson.equilibrium.stability import Equilibrium
    from liepoisson.model.discrete_symmetries import DiscreteSymmetry
    from liepoisson.orbits.multipliers import SymmetricOrbit

_SAME_STATE = 1e-5
_SAME_TIME = 1e-2
_GUESSES_PER_START = 4
_OFF = 0.05
"""A midpoint is at least so far from the orbit that it is homoclinic to, in units of the level."""


Solution: TypeAlias = "tuple[DiscreteSymmetry, Array, float, Array, float]"
"""Reverser, amplitudes, time, midpoint and residual."""


@shows_progress
def symmetric_homoclinic_orbits(
    origin: SymmetricOrbit | Equilibrium,
    *,
    reversers: Sequence[DiscreteSymmetry] | None = None,
    n_starts: int = 400,
    t_end: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> HomoclinicOrbits:
    r"""Homoclinic orbits that are their own mirror images, to a hyperbolic periodic orbit or equilibrium.

    From random states of the linear unstable space, at an amplitude of 1e-4, orbits are followed; the moments when they
    come near the fixed set of a reverser are improved by Newton's method in amplitudes and time.  The second half is
    the mirror image of the first.  Orbits that are images of one another under discrete symmetries of the level are
    listed once, those with the shortest flight first.

    A homoclinic orbit to a periodic orbit may approach an image of it under the symmetry $\rho_1\rho_0$ of the loop,
    which is the same orbit.

    Example:
        >>> duffing = lp.System(lp.canonical(1, names=["x"]), "p_x^2/2 - x^2/2 + x^4/4")
        >>> saddle = lp.phase_space.equilibrium(duffing, [0, 0])
        >>> found = lp.orbits.symmetric_homoclinic_orbits(saddle, n_starts=20)
        >>> [abs(orbit.midpoint).round(6).tolist() for orbit in found]  # one of two that mirror each other
        [[1.414214, 0.0]]

    Args:
        origin: A hyperbolic orbit of `symmetric_periodic_orbits`, or a hyperbolic equilibrium.
        reversers: The reversers in whose fixed sets midpoints are looked for; by default all that suit the level, and
            keep the equilibrium.
        n_starts: How many starts.
        t_end: The longest time from the amplitude 1e-4 to the midpoint; by default $(\ln 10^4 + 6)/\lambda$ with the
            slowest unstable rate.
        seed: Draws the starts.
        threads: By default all processors, for the survey of all starts; Newton's method runs in one thread.
        time_limit: Seconds after which nothing more is looked for; what was found by then is described to the end, and
            `is_cut_short` is true.

    Returns:
        The orbits by increasing time of flight; that there are no others is not proved.

    Raises:
        ParameterError: `origin` is not hyperbolic, or no reverser suits it.
        LeafError: the leaf of an equilibrium is not regular.
        MemoryLimitError: the states up to `t_end` do not fit into memory.
    """
    run = RunOptions.read(None, threads, time_limit, progress, seed=seed)
    n_starts = as_count(n_starts, "n_starts", least=1)
    space = unstable_space(origin)
    level = space.level
    chosen = reversers_of(level, reversers)
    if space.loop_time == 0.0:
        chosen = [one for one in chosen if np.abs((one(space.state) - space.state) / level.units).max() < _SAME_STATE]
        if not chosen:
            raise ParameterError("origin: wanted an equilibrium in the fixed set of a reverser; none keeps this one")
    usual = usual_time(space, AMPLITUDE)
    longest = usual if t_end is None else as_time(t_end, "t_end", example=usual)
    flights = Flights(space, Flow(level.system, run.threads), float(longest))
    search = _Search(flights)
    draw = stream(run.seed, Purpose.HOMOCLINIC_ORBITS)
    solved: list[Solution] = []
    n_done = 0
    with run.deadline.running():
        for n in blocks(n_starts):
            guesses = search.near(flights.drawn(n, draw), chosen, _GUESSES_PER_START * n)
            for k, one in enumerate(chosen):
                run.tell((0.9 * n_done + n * (0.2 + 0.7 * k / len(chosen))) / n_starts)
                solved += [(one, *found) for found in search.solved(one, *guesses[k])]
            n_done += n
        is_cut_short = has_passed()
    path = points_of(origin)
    found = [
        _described(origin, space, flights.flow, one)
        for one in _distinct(level, solved, np.array(group_of_level(level)), path)
    ]
    found.sort(key=lambda one: one.time)
    return HomoclinicOrbits(origin, tuple(found), tuple(chosen), float(longest), n_done, is_cut_short)


class _Search:
    """Flights from the linear unstable space to fixed sets."""

    def __init__(self, flights: Flights) -> None:
        self.flights, self.units = flights, flights.space.level.units

    def near(
        self, amplitudes: Array, reversers: Sequence[DiscreteSymmetry], n_wanted: int
    ) -> list[tuple[Array, Array]]:
        """Amplitudes and times at which flights come near the fixed set of each reverser."""
        grid, states, early = self.flights.survey(amplitudes)
        state = states / self.units
        speed = linear.norm(np.gradient(state, grid, axis=1), axis=-1)
        found: list[tuple[Array, Array]] = []
        for one in reversers:
            distance = linear.norm(linear.matmul(state, mirror_basis(one)), axis=-1)
            inner = (distance[:, 1:-1] <= distance[:, :-2]) & (distance[:, 1:-1] < distance[:, 2:]) & ~early[1:-1]
            rows, places = np.nonzero(inner)
            size = distance[rows, places + 1] / np.maximum(speed[rows, places + 1], 1e-300)
            best = np.argsort(size, kind="stable")[:n_wanted]
            found.append((amplitudes[rows[best]], grid[places[best] + 1]))
        return found

    def solved(
        self, reverser: DiscreteSymmetry, amplitudes: Array, times: Array
    ) -> list[tuple[Array, float, Array, float]]:
        """Amplitudes, times, midpoints and residuals where Newton's method converges before the deadline."""
        rows = mirror_basis(reverser).T / self.units

        def in_fixed_set(_: list[Array], ends: list[Array], slopes: list[Array]) -> tuple[Array, Array]:
            return linear.matmul(ends[0], rows.T), linear.matmul(rows, slopes[0])

        found = meetings([self.flights], [amplitudes], [times], in_fixed_set)
        return [(one.amplitudes[0], one.times[0], one.ends[0], one.residual) for one in found]


def lengthened(orbit: HomoclinicOrbit, n_loops: int) -> HomoclinicOrbit:
    """The same orbit, or its image under the symmetry of the loop, from so many loops before.

    The amplitude is found anew: that on the linear space is a coordinate of the manifold up to its square only.

    Raises:
        OrbitError: Newton's method does not lead back to it.
    """
    space = orbit.space
    amplitude = orbit.amplitude
    for _ in range(n_loops):  # one after the other: the power of the matrix may be singular to round-off
        amplitude = linear.solve(space.matrix, amplitude)
    time = orbit.time + n_loops * space.loop_time
    flights = Flights(space, Flow(orbit.system, 1), 2 * time, float(linear.norm(amplitude)))
    found = _Search(flights).solved(orbit.reverser, amplitude[None], np.array([time]))
    if not found or abs(found[0][1] - time) > _SAME_TIME * time:
        raise OrbitError(
            f"a homoclinic orbit must be found again {n_loops} loops before; Newton's method left {orbit!r}"
        )
    return _described(orbit.origin, space, flights.flow, (orbit.reverser, *found[0]))


def _distinct(
    level: Level,
    found: list[Solution],
    group: Array,
    path: Array,
) -> list[Solution]:
    """One for each midpoint and its images under the group, the most accurate; none on the origin itself."""
    kept: list[Solution] = []
    images = np.zeros((0, len(level.units)))
    every = linear.einsum("gij,tj->gti", group, path).reshape(-1, path.shape[1])
    for one in sorted(found, key=lambda one: one[4]):
        middle = one[3]
        if linear.norm((every - middle) / level.units, axis=1).min() < _OFF:
            continue
        if len(images) and (np.abs((images - middle) / level.units).max(axis=1) < _SAME_STATE).any():
            continue
        kept.append(one)
        images = np.concatenate([images, linear.matmul(group, middle)])
    return kept


def _described(
    origin: SymmetricOrbit | Equilibrium,
    space: UnstableSpace,
    flow: Flow,
    found: Solution,
) -> HomoclinicOrbit:
    """A homoclinic orbit, with the angles between the manifolds at its midpoint."""
    reverser, amplitude, time, middle, residual = found
    starts, slopes = space.states(amplitude[None])
    middle = (middle + reverser(middle)) / 2
    tangents = pushed(flow, starts[0], time, slopes[0])
    n = (space.level.dimension - 1) // 2
    angles = angles_between(space.level, middle, tangents, linear.matmul(reverser.matrix, tangents), (n, n))
    path = points_of(origin)
    return HomoclinicOrbit(
        origin=origin,
        space=space,
        reverser=reverser,
        amplitude=amplitude,
        start=starts[0],
        midpoint=middle,
        time=time,
        residual=residual,
        angles=angles,
        distance=float(linear.norm(path - middle, axis=1).min()),
    )
