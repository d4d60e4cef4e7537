r"""Many guesses on one level: what Newton's method makes of each, and which of them lead to the same orbit.

An orbit is a set of states: a loop with the start x is one that is known where its time is a multiple of the period and
x is on that orbit, $x = e^{\sum_k\theta_k G_k}\varphi_t(y)$ for some time t and angles.  The nearest of some states
of the orbit says t to first order, and Newton's method in t does the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError, TimeLimitError
from liepoisson.formula.scalars import LEAST_TIME, MOST_TIME, as_array
from liepoisson.inputs.arrays import Array, check_shape
from liepoisson.inputs.refusals import shown
from liepoisson.numeric.starts import StartsLike, as_states, given_starts
from liepoisson.orbits.closed_orbits import CLOSES, SAME, PeriodicOrbit, Problem
from liepoisson.orbits.closing import Loops
from liepoisson.orbits.guesses import SIZES, check_moves, shortest
from liepoisson.orbits.multipliers import ClosedOrbit
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.model.system import System

CLOSED, OPEN, AT_REST, OFF, LATE = "closed", "not closed", "at rest", "off the level", "time limit"
"""What becomes of a guess."""

_TOGETHER = 256
"""Guesses that are improved together."""
_PLACES = 256
"""States of an orbit among which the nearest to another state is looked for, about."""
_NEWTON = 3
"""Steps of Newton's method in the time: from a step of these, a hundredth of a turn, to 1e-4, 1e-8 and round-off."""


def given_guesses(system: System, guesses: Any, periods: Any) -> tuple[Array, Array]:
    """States, shape (n, N), and periods, shape (n,), from states with periods, or from orbits that were found.

    Raises:
        ParameterError: there are none, one is an equilibrium, or a period is not positive and finite.
        ShapeError: a state has another number of components, or there is another number of periods.
    """
    n, names, several = len(system.component_names), system.component_names, isinstance(guesses, Sequence)
    for one in guesses if several else (guesses,):
        check_moves(one, "guesses")
    orbits = (guesses,) if isinstance(guesses, ClosedOrbit) else guesses
    if isinstance(orbits, Sequence) and orbits and all(isinstance(one, ClosedOrbit) for one in orbits):
        known = cast("Sequence[ClosedOrbit]", orbits)
        guesses = [one.start for one in known]
        periods = [one.period for one in known] if periods is None else periods
    if periods is None:
        raise ParameterError(
            "periods: wanted those of the guesses, about; got none; write periods=6.3, or one for each"
        )
    states = as_states(given_starts(system, cast("StartsLike", guesses), "guesses"), n, "guesses", names=names)
    if not len(states):
        raise ParameterError("guesses: wanted one state or more; got none; leave them out for a search")
    times = as_array(periods, "periods")
    check_shape(times.ndim == 0 or times.shape == states.shape[:1], "periods", f"() or ({len(states)},)", times)
    times = np.broadcast_to(times, states.shape[:1]).copy()
    good = (times >= LEAST_TIME) & (times <= MOST_TIME)
    if not good.all():
        raise ParameterError(
            f"periods: wanted positive finite times; got {shown(float(times[np.argmin(good)]))} for guess "
            f"{int(np.argmin(good))}; try {np.median(times[good]) if good.any() else 6.3:g}"
        )
    return states, times


@dataclass(frozen=True)
class _Known:
    """An orbit that was found, with states along it.

    Attributes:
        orbit: The orbit.
        path: States at times that are `step` apart, shape (n, N).
        step: The time between them.
    """

    orbit: PeriodicOrbit
    path: Array
    step: float

    @classmethod
    def of(cls, problem: Problem, loop: Loops) -> _Known:
        """That of a loop that closes, with its least period."""
        loop = shortest(problem, loop)
        chain, m = loop.state[0], loop.state.shape[1]
        each, part = -(-_PLACES // m), float(loop.time[0]) / m
        path = problem.closing.flow.paths(chain, np.full(m, part), each)[:, :-1]
        return cls(problem.described(loop), path.reshape(-1, chain.shape[1]), part / each)

    def has(self, problem: Problem, states: Array, times: Array) -> NDArray[np.bool_]:
        """Whether loops with these starts, shape (n, N), and times, shape (n,), run along the orbit, once or more."""
        found = np.zeros(len(states), dtype=bool)
        n = np.maximum(1.0, np.round(times / self.orbit.time))
        some = np.nonzero(np.abs(times - n * self.orbit.time) <= SAME * times)[0]
        if not some.size:
            return found
        x = states[some]
        late, off = _delays(problem, x, self.path[None])
        off[np.abs(late) > self.step] = np.inf
        nearest = np.argmin(off, axis=1)
        is_near = np.isfinite(off.min(axis=1))
        late = 2 * self.step + late[np.arange(len(some)), nearest]
        for _ in range(_NEWTON):  # from the last state but one before the nearest, so that all times are positive
            y, _ = problem.closing.flow.ends(self.path[nearest - 2], late)
            more, off = _delays(problem, x, y[:, None])
            late = np.clip(late + more[:, 0], self.step / 2, 4 * self.step)
        found[some] = is_near & (off[:, 0] <= SAME)
        return found


def _delays(problem: Problem, x: Array, y: Array) -> tuple[Array, Array]:
    """To first order how long after states y, shape (n or 1, m, N), states x follow, and how far off they stay, (n, m).

    Args:
        x: Shape (n, N); up to rotations.
    """
    rates = problem.closing.rates(y)
    way = problem.ways(x, np.broadcast_to(y, (len(x), *y.shape[1:])))
    late = (way * rates).sum(axis=2) / np.maximum((rates * rates).sum(axis=2), np.finfo(float).tiny)
    return late, linear.norm(way - late[..., None] * rates, axis=2)


@dataclass(frozen=True)
class Guesses:
    """Guesses, and where they lead.

    Attributes:
        states: Shape (n, N).
        times: Their periods, shape (n,).
        outcome: What becomes of each, shape (n,).
        orbit: The place of its orbit among those that are known, or -1, shape (n,).
        known: The orbits, each once.
    """

    states: Array
    times: Array
    outcome: NDArray[np.object_]
    orbit: NDArray[np.intp]
    known: list[_Known]

    @classmethod
    def led(cls, problem: Problem, states: Array, times: Array, tell: Callable[[float], Any]) -> Guesses:
        """Guesses that are improved, those of the same units together.

        No outcome depends on the other guesses.  They are taken in an order of their own, so that the orbits do not
        depend on the order in which they are given.  The deadline of the call leaves some as they are.
        """
        n, level, flow = len(times), problem.closing.level, problem.closing.flow
        made = cls(states, times, np.full(n, LATE, dtype=object), np.full(n, -1, dtype=np.intp), [])
        lost = flow.lost(states)
        made.outcome[lost] = OFF
        order = np.lexsort((*states.T[::-1], times))
        order = order[~lost[order]]
        try:
            for first in range(0, len(order), _TOGETHER):
                some = order[first : first + _TOGETHER]
                paths = flow.paths(states[some], times[some], SIZES)
                units = np.array([level.in_units_of(path).units for path in paths])
                for one in np.unique(units, axis=0):
                    made._lead(problem.in_units(one), some[(units == one).all(axis=1)])
                tell((first + len(some)) / len(order))
        except TimeLimitError:
            pass
        return made

    def _lead(self, problem: Problem, rows: NDArray[np.intp]) -> None:
        """Improve guesses of the same units, and see which orbits they lead to."""
        level = problem.closing.level
        moved = linear.norm(problem.system.vector_field(self.states[rows]) / level.units, axis=1) * self.times[rows]
        alone = [
            level.projected(self.states[[row]], np.eye(self.states.shape[1])) for row in rows
        ]  # as single calls do
        states, arrived = (np.concatenate(each) for each in zip(*alone, strict=True))
        self.outcome[rows] = np.where(moved > SAME, OFF, AT_REST)
        go = arrived & (moved > SAME)
        rows, loops = rows[go], problem.improved(states[go], self.times[rows[go]])
        for row, (loop, is_orbit) in zip(rows.tolist(), loops, strict=True):
            self.outcome[row] = CLOSED if is_orbit else AT_REST if loop.residual[0] <= CLOSES else OPEN
        led = np.array([is_orbit for _, is_orbit in loops], dtype=bool)
        left, loops = rows[led], [loop for loop, is_orbit in loops if is_orbit]
        starts = np.array([loop.state[0, 0] for loop in loops])
        times = np.array([float(loop.time[0]) for loop in loops])
        still = np.arange(len(left))
        for k in count():
            if not still.size:
                break
            if k == len(self.known):
                self.known.append(_Known.of(problem, loops[still[0]]))
                self.orbit[left[still[0]]], still = k, still[1:]
            mine = self.known[k].has(problem, starts[still], times[still])
            self.orbit[left[still[mine]]], still = k, still[~mine]

    def sorted(self) -> tuple[tuple[PeriodicOrbit, ...], NDArray[np.intp], NDArray[np.str_]]:
        """The orbits by decreasing growth rate, of each guess the place of its orbit among them or -1, and outcomes."""
        orbits = [one.orbit for one in self.known]
        best = sorted(range(len(orbits)), key=lambda k: (-round(orbits[k].rate, 9), orbits[k].period))
        place = np.full(len(orbits) + 1, -1, dtype=np.intp)
        place[best] = np.arange(len(orbits))
        return tuple(orbits[k] for k in best), place[self.orbit], np.array(self.outcome.tolist())
