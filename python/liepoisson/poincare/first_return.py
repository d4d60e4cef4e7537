"""The map of first return to the side of a surface."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.compile.field import TapeFunction
from liepoisson.errors import ShapeError
from liepoisson.formula.scalars import TIME_LIMIT
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.io.result import labelled, recorded
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import Run, typical
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, given_starts
from liepoisson.numeric.systems import HasField
from liepoisson.poincare.section import Section, section
from liepoisson.poincare.section_arguments import (
    Function,
    as_direction,
    as_end,
    as_formula,
    as_surface,
    read_tape,
    surface_alone,
)

_SAME_POINT = 1e-9
"""Distance, relative to the size of the state, within which a start counts as on the surface in `first_return`: above
what integration to round-off adds up in a long run, far below any section."""

_SAME_TIME = 1e-6
"""The same as a time, relative to the first step.  A step takes the state about a tenth of its size: this is far above
what `_SAME_POINT` takes, and matters where the components that change are small beside one that does not."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FirstReturn(Run):
    """Images of the map of first return.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> once = lp.sections.first_return(system, [0, 0.1, 0.3, 0], surface="x", t_end=10)
        >>> back = lp.sections.first_return(system, once.state, surface="x", t_end=-10, direction=-1)
        >>> str(once.outcome), bool(np.allclose(back.state, once.start))
        ('returned', True)

    Attributes:
        start: The states that were mapped, shape (..., component).
        surface: The function $s$ as it was written, for labels.
        tape: It as data.
        direction: In which direction it was passed.
        t_end: Longest time that was waited.
        state: Where each orbit returned, shape (..., component); NaN where it did not.
        time: When, shape (...).
        outcome: "returned"; "no return" until `t_end`; "none seen", where the surface function could not be followed
            all the time; or why the orbit ended before, as for `integrate`.  Shape (...).
    """

    kind = "first return"
    made_by = "first_return"
    rows = (...,)

    start: Array = labelled(..., "component", long_name="state that was mapped")
    outcome: NDArray[np.str_] = labelled(..., long_name="whether and why not it returned")
    surface: str
    tape: TapeFunction = recorded(asdict, read_tape)
    direction: int
    t_end: float
    state: Array = labelled(..., "component", long_name="image")
    time: Array = labelled(..., long_name="time of return")

    def arguments(self) -> dict[str, Any]:
        """What `first_return` was called with."""
        return super().arguments() | {"surface": self.tape, "direction": self.direction, "t_end": self.t_end}

    def __iter__(self) -> Iterator[Any]:
        """Images, times and outcomes, for `images, times, outcomes = first_return(...)`."""
        return iter((self.state, self.time, self.outcome))

    def __repr__(self) -> str:
        n = np.sum(self.outcome == "returned")
        return f"<FirstReturn: {n} of {self.outcome.size} states returned, {typical('time', self.time)}>"


@shows_progress
def first_return(
    system: HasField,
    starts: StartsLike,
    *,
    surface: Function | TapeFunction,
    t_end: float,
    direction: int = 1,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> FirstReturn:
    r"""The map of first return to the side of a surface, $P(x) = \varphi_{\tau(x)}(x)$, and the times $\tau(x)$.

    $\tau(x)$ is the first time after 0 at which $s(\varphi_t(x))$ passes zero in the given direction.  The map can be
    applied to its own results; with a negative `t_end` and the opposite direction it is the inverse map.

    A state counts as on the surface if its orbit meets it within a millionth of the first step and within $10^{-9}$ of
    the largest component of x: images that other programs computed, or that were rounded, do not return at once.

    Example:
        >>> oscillators = lp.System(lp.canonical(2), "dot(p, p)/2 + (q1^2 + 4*q2^2)/2")
        >>> back = lp.sections.first_return(oscillators, [0, 0.3, 1, 0.4], surface="q1", t_end=10)
        >>> round(float(back.time / np.pi), 9), bool(np.allclose(back.state, back.start))  # a resonance
        (2.0, True)

    Args:
        system: What is integrated.
        starts: States on the surface (elsewhere it is the map of first arrival), shape (..., component).
        surface: The function $s$, as for `section`.
        t_end: Longest time that is waited; negative: backwards.
        direction: +1, -1 or 0, as for `section`.
        method: `Taylor()`, or a method of equal steps, as for `section`.

    Returns:
        `state`, `time` and `outcome`, which says why the first two are NaN where they are.

    Raises:
        As `section`.
    """
    run = RunOptions.read(method, threads, time_limit, progress, default=Taylor(), in_series=True)
    states, field = given_starts(system, starts), run.field(system)
    n = field.n_components
    if states.ndim == 0 or states.shape[-1] != n:
        raise ShapeError(f"starts must end in {n} components; got shape {states.shape}")
    options: dict[str, Any] = {"surface": surface_alone(surface), "t_end": t_end, "direction": direction}
    returned, times, outcome = _arrivals(system, states.reshape(-1, n), run, options)
    shape = states.shape[:-1]
    label = "s" if isinstance(surface, TapeFunction) else str(as_formula(surface, "surface"))
    return FirstReturn(
        **run.given(system, states, field),
        surface=label,
        tape=as_surface(system, options["surface"], None)[0],
        direction=as_direction(direction),
        t_end=as_end(t_end),
        state=returned.reshape(states.shape),
        time=times.reshape(shape),
        outcome=outcome.reshape(shape),
    )


def _arrivals(
    system: HasField, starts: Array, run: RunOptions, options: dict[str, Any]
) -> tuple[Array, Array, NDArray[np.str_]]:
    """State and time of the first crossing of each trajectory that is not its start, and the outcomes."""
    found = section(system, starts, n_crossings=1, **options, **run.inner())
    returned, times = np.full(starts.shape, np.nan), np.full(len(starts), np.nan)
    returned[found.trajectory], times[found.trajectory] = found.state, found.time
    outcome = _outcome_without_crossing(found)
    outcome[found.trajectory] = "returned"
    # Within one step of a power series no orbit is periodic: a near crossing there is the start itself. Where the
    # components that change are small beside one that does not, it is near in time, too.
    near = np.abs(returned - starts).max(axis=1) <= _SAME_POINT * np.abs(starts).max(axis=1)
    early = (found.n_steps <= 1) & (np.abs(times) <= _SAME_TIME * found.first_step)
    again = np.flatnonzero(near & early)
    if again.size:
        second = section(system, starts[again], n_crossings=2, **options, **run.inner())
        last = np.cumsum(second.count) - 1
        there = second.count == 2
        returned[again], times[again] = np.nan, np.nan
        returned[again[there]], times[again[there]] = second.state[last[there]], second.time[last[there]]
        outcome[again] = np.where(there, "returned", _outcome_without_crossing(second))
    return returned, times, outcome


def _outcome_without_crossing(found: Section) -> NDArray[np.str_]:
    none = np.where(found.unresolved_time > 0, "none seen", "no return")
    return np.where(found.outcome == "finished", none, found.outcome)
