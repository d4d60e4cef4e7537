r"""The periodic orbits of a level: those that guesses lead to, which are given, or are returns of random orbits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import LeafError, ParameterError, TimeLimitError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_time
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.deadline import blocks, checkpoint, has_passed
from liepoisson.leaf._checks import as_system
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike
from liepoisson.orbits.closed_orbits import SAME, Momenta, PeriodicOrbit, Problem, problem_at
from liepoisson.orbits.guesses import shortest
from liepoisson.orbits.level import Level, level_of
from liepoisson.orbits.many_guesses import CLOSED, LATE, Guesses, given_guesses
from liepoisson.orbits.multipliers import SymmetricOrbit, orbit_columns
from liepoisson.orbits.saved_orbits import SearchedOrbits
from liepoisson.orbits.shooting import n_times_of
from liepoisson.orbits.symmetric_orbits import natural_time, searched
from liepoisson.streams import Purpose, stream

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.system import System

_UNITS, _TIMES_PER_UNIT, _GUESSES, _TOGETHER = 30.0, 12.0, 2, 64


@dataclass(frozen=True, eq=False, repr=False)
class PeriodicOrbits(SearchedOrbits[PeriodicOrbit]):
    """Periodic orbits of a level, those with the largest growth rate first.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.orbits.periodic_orbits(system, {}, energy="1/10", n_starts=30)
        >>> [(round(orbit.period, 3), orbit.stability) for orbit in found[:1]]
        [(6.794, 'hyperbolic')]

    Attributes:
        level: The level.
        found: The orbits.  Those that guesses lead to, each once; of those of a search with the same period and
            multipliers, as symmetries map to one another, one.
        t_end: How long starts were followed; the longest period of guesses.
        n_starts: How many starts, or guesses, were taken.
        n_families: How many orbits of a search were left out since they belong to families on the level.
        is_cut_short: Whether the time limit ended the search.
        orbit: Of each guess that was given the place of its orbit in the list, -1 without one, shape (guess,).
        outcome: What became of each guess, shape (guess,): "closed"; "not closed", where Newton's method does not
            converge or the guess does not reach its period; "at rest", where it comes to an equilibrium, or to states
            that only turn; "off the level", where no state of it was found near the guess; "time limit".
    """

    kind = "periodic orbits"
    made_by = "lp.orbits.periodic_orbits"
    titles = ("period", "rate", "stability", "multipliers", "residual", "pairs")

    level: Level
    found: tuple[PeriodicOrbit, ...]
    t_end: float
    n_starts: int
    n_families: int
    is_cut_short: bool = False
    orbit: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    outcome: NDArray[np.str_] = field(default_factory=lambda: np.zeros(0, dtype=np.str_))

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.level.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its period, stability, start and multipliers."""
        return orbit_columns(self.found, self.system)

    def _head(self) -> str:
        starts = f"the returns of {{}} orbits up to t = {self.t_end:g}"
        if self.outcome.size:
            starts = f"{{}} guesses, of which {int((self.outcome == CLOSED).sum())} lead to one"
        where = f"of {self.system.name!r} on {self.level.text}"
        return self._sentence("periodic orbit", where, starts, "that belong to families")

    def _row(self, one: PeriodicOrbit, /) -> tuple[str, ...]:
        return (
            f"{one.period:.8f}",
            f"{one.rate:.4f}",
            one.stability,
            one.multiplier_words,
            f"{one.residual:.0e}",
            f"{one.pair_defect:.0e}",
        )


@shows_progress
def periodic_orbits(
    system: System,
    leaf: Leaf | Mapping[str, float | str],
    energy: float | str,
    *,
    guesses: StartsLike | Sequence[PeriodicOrbit | SymmetricOrbit] | None = None,
    periods: ArrayLike | None = None,
    momenta: Momenta = (),
    n_starts: int | None = None,
    t_end: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> PeriodicOrbits:
    r"""Periodic orbits of a level, symmetric or not: those that guesses lead to by Newton's method.

    Guesses are given, or they are the nearest returns of random orbits.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> found = lp.orbits.periodic_orbits(top, {"C1": 1, "C2": "1/2", "C3": 1}, energy="1/2", n_starts=30)
        >>> len(found) > 3, bool(max(orbit.residual for orbit in found) <= 1e-12)
        (True, True)
        >>> henon = lp.catalog.system("henon-heiles")
        >>> states = [[0, 0, 0, 0.3], [0, 0, 0.3, 0], [0, 0, 0, 0.31], [0, 0, 0, 0]]
        >>> found = lp.orbits.periodic_orbits(henon, {}, "1/20", guesses=states, periods=6.3)
        >>> found.outcome.tolist(), found.orbit.tolist()
        (['closed', 'closed', 'closed', 'at rest'], [1, 0, 1, -1])

    Args:
        system: A system whose parameters are all numbers.
        leaf: A regular leaf, or the values of the Casimirs by name.
        energy: The value of the Hamiltonian; a text is exact.
        guesses: States, by components or by name, shape (component,) or (guess, component), which are moved onto the
            level; or orbits that were found, perhaps on another level.  Each leads to the orbit that `periodic_orbit`
            has for it, whatever the others are.
        periods: Their periods, about, one for all or shape (guess,); by default those of orbits.
        momenta: Linear integrals that are held, with their values, `{"l3": 0.5}`.
        n_starts: Of a search without guesses, how many random states of the level are followed; by default 200.
        t_end: How long; by default 30 times $1/\rho(Df)$, with the median of the spectral radius along them.
        seed: Draws the states.

    Returns:
        The orbits by decreasing growth rate, and of each guess its outcome and its orbit; that there are no other
        orbits is not proved.

    Raises:
        LeafError: the leaf is not regular, or in a search no state of it has this energy.
        ParameterError: a guess is an equilibrium, a period is not positive, or guesses and numbers of a search come
            together; of a state at rest the outcome says so.
        ShapeError: guesses or periods have another shape.
    """
    run = RunOptions.read(None, threads, time_limit, progress, seed=seed)
    system = as_system(system)
    if guesses is None and periods is not None:
        raise ParameterError("periods: they are those of guesses; got none of these; write guesses=states, or t_end")
    if guesses is not None:
        if n_starts is not None or t_end is not None:
            raise ParameterError("n_starts, t_end: they are those of a search; got guesses, too; leave out the ones")
        states, times = given_guesses(system, guesses, periods)
        with run.deadline.running():
            problem = _problem(system, states, momenta, leaf=leaf, energy=energy, threads=run.threads)
            found, orbit, outcome = Guesses.led(problem, states, times, run.tell).sorted()
        cut = bool((outcome == LATE).any())
        return PeriodicOrbits(
            problem.closing.level, found, float(times.max()), len(times), 0, cut, orbit=orbit, outcome=outcome
        )
    count = as_count(200 if n_starts is None else n_starts, "n_starts", least=1)
    level = searched(level_of(system, leaf, energy), run.seed)
    draw, n_done, meets = stream(run.seed, Purpose.PERIODIC_ORBITS), 0, False
    listed: list[PeriodicOrbit] = []
    n_families = 0
    with run.deadline.running():
        unit = natural_time(level, run.seed)
        longest = _UNITS * unit if t_end is None else as_time(t_end, "t_end", example=_UNITS * unit)
        for n in blocks(count):
            drawn = draw.standard_normal((n, len(level.units))) * level.units
            states, arrived = level.projected(drawn, np.eye(len(level.units)))
            n_done, starts = n_done + n, states[arrived]
            if not len(starts):
                continue
            problem = _problem(system, starts, momenta, leaf=leaf, energy=energy, threads=run.threads, along=starts)
            meets = True
            try:
                for one in _orbits_from(problem, starts, (longest, unit), _GUESSES * n, found=listed):
                    if not one.is_isolated:
                        n_families += 1
                    elif not any(_is_same(one, other) for other in listed):
                        listed.append(one)
            except TimeLimitError:
                break
            run.tell(min(1.0, n_done / count))
        cut = has_passed()
    if not (meets or cut):
        raise LeafError(
            f"an orbit must lie on its level; of {n_done} random states none could be moved to {level.text}. The "
            f"energies of the leaf are {level.leaf.energy_range()}."
        )
    listed.sort(key=lambda one: (-round(one.rate, 9), one.period))
    return PeriodicOrbits(level, tuple(listed), float(longest), n_done, n_families, cut)


def _problem(system: System, states: Array, momenta: Momenta, **options: Any) -> Problem:
    """The problem of a level; momenta must come with values, as states that are drawn, or given, have each their own.

    Raises:
        ParameterError: they have none.
    """
    problem = problem_at(system, states[0], momenta=momenta, **options)
    if problem.momenta and not isinstance(momenta, Mapping):
        raise ParameterError(
            "momenta: wanted integrals with the values that the search holds; got none; write for example "
            f"momenta={{{next(iter(problem.momenta))!r}: 1.5}}"
        )
    return problem


def _orbits_from(
    problem: Problem,
    starts: Array,
    times: tuple[float, float],
    n_wanted: int,
    *,
    found: Sequence[PeriodicOrbit],
) -> Iterator[PeriodicOrbit]:
    """The orbits that the nearest returns of starts lead to, without loops of one that was found.

    Raises:
        TimeLimitError: the deadline of the call has passed.
    """
    longest, unit = times
    n_times = n_times_of(_TIMES_PER_UNIT * longest, unit)
    flow = problem.closing.flow.searching(n_times)
    problem = replace(problem, closing=replace(problem.closing, flow=flow))
    grid, states = flow.survey(starts, longest, n_times)
    checkpoint("following orbits")
    gaps = problem.gaps(starts, states)
    inner = (gaps[:, 1:-1] <= gaps[:, :-2]) & (gaps[:, 1:-1] < gaps[:, 2:])
    rows, places = np.nonzero(inner)
    best = np.argsort(gaps[rows, places + 1], kind="stable")[:n_wanted]
    rows, periods = rows[best], grid[places[best] + 1]
    for k in range(0, len(rows), _TOGETHER):
        some = slice(k, k + _TOGETHER)
        loops = problem.closing.solved(problem.loops(starts[rows[some]], periods[some]))
        sums = problem.closing.sums(loops)
        for j in np.nonzero(problem.closed(loops) & (loops.time <= 1.2 * longest))[0]:
            if any(_repeats(float(loops.time[j]), float(sums[j]), other) for other in found):
                continue
            yield problem.described(problem.in_short_segments(shortest(problem, loops.of(np.array([j])))))


def _is_same(one: PeriodicOrbit, other: PeriodicOrbit) -> bool:
    """Whether the periods and multipliers are the same."""
    return _repeats(one.period, complex(np.sum(one.multipliers)), other, most=1)


def _repeats(period: float, total: complex, other: PeriodicOrbit, most: int | None = None) -> bool:
    """Whether a period and the sum of the multipliers are those of an orbit, run through once or more times."""
    n = max(1, round(period / other.period))
    near = (most is None or n <= most) and abs(period - n * other.period) <= SAME * period
    return near and bool(abs(total - np.sum(other.multipliers**n)) <= 1e3 * SAME * (abs(total) + 1))
