r"""Crossings of a surface by orbits in equal steps, of methods that have no power series.

Where the surface function s changes its sign from one step to the next, the step is made again, shorter: a part
$\theta$ of it with $s(\Phi_\theta(x)) = 0$.  So the crossing is a state of the method itself, and the orbit goes on
from the end of the whole step, as if nobody had looked.  Two crossings within one step are not seen.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.compile.field import TapeFunction
from liepoisson.compile.tape_values import values_of_tape
from liepoisson.errors import ParameterError
from liepoisson.inputs.arrays import Array
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.systems import HasField
from liepoisson.portable import elementary

_STEPS = 64
"""Steps that are made in one call, whatever the number of trajectories, which therefore do not change one another."""
_MOST_TRIALS = 100
_AT_THE_START = 1e-6
"""A crossing within this part of the first step is the start itself: what `first_return` computes is as near."""


def takes_equal_steps(method: Method) -> bool:
    """Whether a method makes equal steps in double precision, so that what it computes is a smooth map."""
    return getattr(method, "step", None) is not None and getattr(method, "precision", "double") == "double"


def check_method(method: Method) -> None:
    """Refuses a method from which no surface of section is made.

    Raises:
        ParameterError: it has neither power series nor equal steps, or is not in double precision.
    """
    if takes_equal_steps(method) or (isinstance(method, Taylor) and method.precision == "double"):
        return
    raise ParameterError(
        "method: wanted Taylor() in double precision, whose power series show every crossing, or a method of equal "
        f"steps, such as Gauss(step=0.1) or RungeKutta(step=0.1); got {method}; leave it out"
    )


def after(system: HasField, state: Array, time: float, method: Method) -> Array:
    """The state after one step of this length, shape (component,); NaN where the method fails."""
    if time == 0.0:
        return state.copy()
    return integrate(system, state, times=[0.0, time], method=method, threads=1).state[0, -1].copy()


def tangents_in_equal_steps(system: HasField, start: Array, time: float, method: Any) -> tuple[Array, Array]:
    r"""The derivatives of the map that made equal steps and a shorter one, by the start and by the time.

    That by the start is exact but for round-off.  That by the time, $\partial_\theta\Phi_\theta$ of the last step, is
    a difference of fourth order, whose truncation $\delta^4$ and round-off $\epsilon/\delta$ are alike, relative, where
    $\delta$ is $\epsilon^{1/5}$ steps.

    Args:
        system: The system.
        start: Where the first step begins, shape (component,).
        time: When the last one ends.
        method: A method of equal steps.

    Returns:
        The derivative by the start, shape (component, component), and by the time, shape (component,).
    """
    step = float(np.copysign(method.step, time))
    whole = max(0, int(np.ceil(time / step)) - 1) * step
    grid = np.unique(np.abs([0.0, whole, time]))
    orbit = integrate(
        system, start, times=np.copysign(grid, time), tangents=np.eye(len(start)), method=method, threads=1
    )
    last = orbit.state[0, np.searchsorted(grid, abs(whole))]
    delta = float(elementary.power(np.finfo(float).eps, 0.2)) * step
    near = [after(system, last, time - whole + k * delta, method) for k in (-2, -1, 1, 2)]
    rate = (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * delta)
    return orbit.tangent[0, -1].T.copy(), rate


def crossings_in_equal_steps(
    system: HasField,
    starts: Array,
    tape: TapeFunction,
    options: RunOptions,
    *,
    t_end: float,
    direction: int,
    n_crossings: int | None,
    sides: NDArray[np.int8],
) -> dict[str, Any]:
    """What `_core.sections` returns, of a method of equal steps."""
    method: Any = options.method
    step = float(np.copysign(method.step, t_end))
    total = max(1, int(np.ceil(abs(t_end / step) * (1 - 4 * np.finfo(float).eps))))
    within = min(total, method.max_steps)
    walks = [_Walk(system, x, int(side), method, tape) for x, side in zip(starts, sides, strict=True)]
    active, order, kernel = walks, 0, "lanes"
    for first in range(0, within, _STEPS):
        steps = np.arange(first, min(first + _STEPS, within) + 1)
        times = np.where(steps == total, t_end, steps * step)
        orbit = integrate(
            system,
            np.array([walk.state for walk in active]).reshape(len(active), tape.n_components),
            times=times - times[0],
            method=method,
            threads=options.threads,
            time_limit=options.left,
        )
        values, order, kernel = values_of_tape(tape, orbit.state)[..., 0], orbit.order, orbit.kernel
        for k, walk in enumerate(active):
            walk.go(times, orbit.state[k], values[k], str(orbit.outcome[k]), (direction, n_crossings))
        active = [walk for walk in active if not walk.is_done]
        options.tell(float(steps[-1]) / within)
        if not active:
            break
    for walk in active:
        walk.outcome = "finished" if within == total else "max steps"
    known = _core.outcomes()
    states = np.array([state for walk in walks for _, state, _ in walk.crossings])
    states = states.reshape(-1, tape.n_components)
    n, none = len(walks), np.zeros((0, 1))
    numbers = np.array([(walk.n_steps, walk.n_unseen, walk.n_lost, len(walk.crossings)) for walk in walks], dtype=int)
    n_steps, n_unseen, n_lost, count = numbers.reshape(n, 4).T.copy()
    ends = np.array(
        [(walk.time, walk.undefined, walk.time if walk.seen_to is None else walk.seen_to) for walk in walks]
    )
    end_time, undefined, seen_to = ends.reshape(n, 3).T.copy()
    return {
        "count": count,
        "time": np.array([time for walk in walks for time, _, _ in walk.crossings]),
        "state": values_of_tape(tape, states)[:, 1:] if len(tape.outputs) > 1 else states,
        "sign": np.array([sign for walk in walks for _, _, sign in walk.crossings], dtype=np.int8),
        "touch_count": np.zeros(n, dtype=np.int64),
        "touch_time": none[:, 0],
        "touch_state": none,
        "unbounded_steps": n_steps,
        "unseen_steps": n_unseen,
        "undefined_time": undefined,
        "unresolved_time": np.zeros(n),
        "seen_to": seen_to,
        "lost_changes": n_lost,
        "in_surface": np.array([walk.lies_in_it and walk.n_steps > 0 for walk in walks], dtype=bool),
        "side": np.array([walk.side for walk in walks], dtype=np.int8),
        "first_step": np.where(n_steps > 0, min(abs(step), abs(t_end)), np.nan),
        "outcome": np.array([known.index(walk.outcome) for walk in walks], dtype=np.int8),
        "end_time": end_time,
        "n_steps": n_steps,
        "final_state": np.array([walk.state for walk in walks]),
        "order": order,
        "kernel": kernel,
    }


class _Walk:
    """One trajectory: where it is, and what it crossed."""

    def __init__(self, system: HasField, start: Array, side: int, method: Method, tape: TapeFunction) -> None:
        self.system, self.method, self.tape = system, method, tape
        self.state, self.side, self.time = start.copy(), side, 0.0
        self.crossings: list[tuple[float, Array, int]] = []
        self.n_steps = self.n_unseen = self.n_lost = 0
        self.undefined, self.lies_in_it, self.is_done = 0.0, True, False
        self.seen_to: float | None = None
        self.outcome = "finished"

    def go(self, times: Array, states: Array, values: Array, outcome: str, wanted: tuple[int, int | None]) -> None:
        """Takes some steps, until the wanted number of crossings or where the method failed."""
        begins = not self.n_steps
        near = begins and bool(abs(values[0]) <= _AT_THE_START * abs(values[1] - values[0]))
        if begins and not near and np.isfinite(values[0]):
            self.side = int(np.sign(values[0]))
        for k in range(len(times) - 1):
            if not np.isfinite(states[k + 1]).all():
                self.outcome, self.is_done = outcome, True
                return
            side = int(np.sign(values[k + 1])) if np.isfinite(values[k + 1]) else 0
            is_seen = bool(np.isfinite(values[k : k + 2]).all())
            changes = side * self.side < 0
            self.n_lost += changes and not is_seen
            if changes and is_seen and wanted[0] in (0, side):
                part = 0.0 if near and k == 0 else self._part(float(times[k + 1] - times[k]), states[k])
                if part is not None:
                    state = after(self.system, states[k], part, self.method)
                    if self._is_guarded(state):
                        self.crossings.append((float(times[k]) + part, state, side))
            if not is_seen:
                self.n_unseen += 1
                self.undefined += float(abs(times[k + 1] - times[k]))
                self.seen_to = float(times[k]) if self.seen_to is None else self.seen_to
            self.lies_in_it &= values[k] == 0 == values[k + 1] and self._is_guarded(states[k])
            self.side, self.state, self.time = side or self.side, states[k + 1].copy(), float(times[k + 1])
            self.n_steps += 1
            if len(self.crossings) == wanted[1]:
                self.is_done = True
                return
        if outcome != "finished":
            self.outcome, self.is_done = outcome, True

    def _part(self, step: float, state: Array) -> float | None:
        """The time after a state at which a shorter step ends on the surface, to the last digits; None at a pole.

        By false position, where an end that stays twice counts half, so that it moves, too (the Illinois rule).
        """
        low, high = 0.0, step
        first, last = (self._value(state, time) for time in (low, high))
        sizes = [abs(first), abs(last)]  # at the present ends
        best, largest, moved = min((sizes[0], low), (sizes[1], high)), max(sizes), 0
        for _ in range(_MOST_TRIALS):
            if best[0] == 0.0 or abs(high - low) <= 4 * np.finfo(float).eps * abs(step):
                break
            middle = (low * last - high * first) / (last - first)
            if not min(low, high) < middle < max(low, high):
                middle = 0.5 * (low + high)
            value = self._value(state, middle)
            if not np.isfinite(value):
                return None
            if (value > 0) == (last > 0):
                high, last, first, sizes[1] = middle, value, first / 2 if moved > 0 else first, abs(value)
                moved = 1
            else:
                low, first, last, sizes[0] = middle, value, last / 2 if moved < 0 else last, abs(value)
                moved = -1
            best = min(best, (abs(value), middle))
        return None if best[0] > 0.0 and min(sizes) >= largest else float(best[1])

    def _is_guarded(self, state: Array) -> bool:
        """Whether a zero of the function belongs to the surface."""
        return self.tape.guard is None or bool(values_of_tape(self.tape.with_guard, state)[1] > 0)

    def _value(self, state: Array, time: float) -> float:
        return float(values_of_tape(self.tape, after(self.system, state, time, self.method))[0])
