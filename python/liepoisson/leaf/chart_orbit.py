"""Orbits in a canonical chart: integrated in its coordinates, seen in the body, up to where the chart ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import ChartError, ShapeError
from liepoisson.formula.scalars import as_array
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import counted
from liepoisson.io.result import Result, labelled, names_along, part
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.numeric.integrate import Orbit, integrate
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import as_method
from liepoisson.numeric.run import KeepsInvariants
from liepoisson.numeric.systems import TOP_COMPONENTS
from liepoisson.portable import linear

LONGEST = 100_000
"""Default bound on the steps: near where a chart ends they shrink, and a run that is caught there must end."""

DEFECT = 1e-6
"""Largest relative defect of the equations at the end of a step.  Inside a chart 1e-13 is usual."""

LEFT = "left the chart"
"""The outcome of a run whose series went on beyond the end of the chart."""


_BODY = tuple(f"{field}{k}" for field in ("l", "alpha", "beta") for k in (1, 2, 3))


class Chart(Protocol):
    """What an orbit in a chart needs of it; each of `liepoisson.model.charts` has it."""

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the components of the canonical state."""
        ...

    @property
    def system(self) -> CanonicalSystem:
        """The canonical system."""
        ...

    def from_body(self, states: ArrayLike) -> Array:
        """Canonical states from states in the body."""
        ...

    def to_body(self, z: ArrayLike) -> Array:
        """States in the body from canonical ones."""
        ...

    def margins(self, states: ArrayLike) -> dict[str, Array]:
        """How far states are from where the chart ends, by condition."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class ChartOrbit(Result, KeepsInvariants):
    """One orbit, integrated in the coordinates of a chart.

    Example:
        >>> top, start = lp.Top.twisted_lagrange(), [1, 0, 1, 0, 1, 0, 0, 0.6, 0.8]
        >>> run = lp.orbits.chart_orbit(lp.charts.EulerChart(top, state=start), start, times=[0, 10, 20])
        >>> body = lp.integrate(top, start, times=[0, 10, 20])
        >>> run.outcome, bool(np.allclose(run.body, body.state[0]))
        ('finished', True)

    Attributes:
        chart: Which chart of which leaf, in words.
        time: The wanted times, shape (time,).
        state: Canonical states, shape (time, component); NaN from where the run ended.
        body_components: Names of the components in the body.
        body: States (l, alpha, beta), shape (time, 9); NaN from where the run ended.
        outcome: How the run ended: "finished", "left the chart", or as in `Orbit.outcome`.
        end_time: The time up to which it is good.
        end_state: The canonical state there, shape (component,).
        conditions: What must not happen in the chart, in words.
        margin: How far the wanted states are from where the chart ends, shape (time, condition).  Coordinates lose
            about twice as many digits as the smallest margin on the way has zeros.
        left_by: Where the run ended early, the condition of the chart with the smallest margin there; else None.
        left_margin: That margin.
        run: What the integrator returned for the canonical system, with dense output: its method, its steps, and
            states also from where the chart ended, which mean nothing there.
    """

    kind = "chart orbit"
    made_by = "chart_orbit"
    rows = ("time",)

    chart: str
    time: Array = labelled("time", long_name="time", is_coordinate=True)
    state: Array = labelled("time", "component", long_name="canonical state")
    body_components: tuple[str, ...] = names_along("body_component", default=_BODY)
    body: Array = labelled("time", "body_component", long_name="state in the body")
    outcome: str
    end_time: float
    end_state: Array = labelled("component", long_name="last good canonical state")
    conditions: tuple[str, ...] = names_along("condition")
    margin: Array = labelled("time", "condition", long_name="distance from where the chart ends")
    left_by: str | None
    left_margin: float | None
    run: Orbit = part(lambda: Orbit, "run_", own_dims=("time", "trajectory"))

    def arguments(self) -> dict[str, Any]:
        """What `integrate` was called with; it does not know where the chart ends."""
        return self.run.arguments()

    @property
    def margins(self) -> dict[str, Array]:
        """The margins by condition, shape (time,) each."""
        return dict(zip(self.conditions, self.margin.T, strict=True))

    @property
    def system(self) -> CanonicalSystem:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The canonical system, that of the top and of its chart."""
        return cast("CanonicalSystem", self.run.system)

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components of the canonical state."""
        return self.run.components

    @property
    def method(self) -> Method:
        """How it was integrated."""
        return self.run.method

    def __repr__(self) -> str:
        by = f" by {self.left_by}" if self.left_by else ""
        end = f"{self.outcome}{by} at t = {self.end_time:.6g}"
        return f"<ChartOrbit of {self.system.name!r}: {counted(len(self.time), 'time')}, {end}, {self.method}>"


@explains_its_arguments
def chart_orbit(chart: Chart, start: ArrayLike, *, times: ArrayLike, method: Taylor | None = None) -> ChartOrbit:
    r"""The orbit of a state, integrated in the coordinates of a chart and seen in the body.

    A run that comes to where the chart ends is a result: all up to there is kept, and `left_by` says why.

    The integrator alone does not see the end of a chart.  Where alpha becomes parallel to beta, the root
    $r = |\alpha\times\beta|/|\beta|$ goes through zero like $|t - t_*|$; its power series goes on like $t_* - t$, and
    the next step starts with the wrong sign.  So the state at the end of each step is put back into the equations,
    and the run is cut, by bisection on the series, at the time from which on they do not hold.

    Example:
        >>> top, start = lp.Top.twisted_lagrange(), [1, 0, 1, 0, 1, 0, 0, 0.6, 0.8]
        >>> chart = lp.charts.EulerChart(top, state=start)
        >>> run = lp.orbits.chart_orbit(chart, start, times=np.linspace(0, 50, 501))
        >>> run.outcome, bool(run.drift["H"].max() < 1e-12)
        ('finished', True)

    Args:
        chart: `EulerChart`, `QuaternionChart` or a reduced Lagrange top with its cyclic angle.
        start: The start (l, alpha, beta), shape (9,), on the leaf of the chart.
        times: Times, as for `integrate`.
        method: By default `Taylor()` with at most 100,000 steps.

    Raises:
        ChartError: the start is not in the chart; `condition` names why.
        ShapeError: `start` is not one state.
        ParameterError: as for `integrate`.
    """
    start = as_array(start, "start", TOP_COMPONENTS)
    if start.shape != (9,):
        raise ShapeError(f"start must be one state of shape (9,); got shape {start.shape}. Take one orbit at a time.")
    how = as_method(method, Taylor(max_steps=LONGEST), in_series=True)
    run = integrate(chart.system, chart.from_body(start), times=times, method=how, dense=True)
    outcome, end_time, end_state = str(run.outcome[0]), float(run.end_time[0]), run.end_state[0]
    left = _leaving(chart.system, run)
    if left is not None:
        outcome, (end_time, end_state) = LEFT, left
    direction = np.sign(run.time[-1] - run.time[0])
    state = np.where((direction * run.time <= direction * end_time)[:, None], run.state[0], np.nan)
    body = _seen(chart, state)
    margins = chart.margins(body)
    left_by, left_margin = _reason(chart, end_state) if outcome != "finished" else (None, None)
    return ChartOrbit(
        chart=repr(chart),
        time=run.time,
        state=state,
        body=body,
        outcome=outcome,
        end_time=end_time,
        end_state=end_state,
        conditions=tuple(margins),
        margin=np.stack(list(margins.values()), axis=-1),
        left_by=left_by,
        left_margin=left_margin,
        run=run,
    )


def _leaving(system: CanonicalSystem, run: Orbit) -> tuple[float, Array] | None:
    """The time and the state up to which the series solve the equations, or None if all of them do."""
    starts, series = run.series[0]
    if not len(starts):
        return None
    lengths = np.diff(np.append(starts, run.end_time[0]))
    bad = np.logical_not(_solves(system, series, lengths))
    if not bad.any():
        return None
    k = int(np.argmax(bad))
    good, wrong = 0.0, float(lengths[k])
    for _ in range(60):
        middle = (good + wrong) / 2
        solved = bool(_solves(system, series[k : k + 1], np.array([middle]))[0])
        good, wrong = (middle, wrong) if solved else (good, middle)
    return float(starts[k] + good), _values(series[k : k + 1], np.array([good]))[0][0]


def _solves(system: CanonicalSystem, series: Array, tau: Array) -> Array:
    """Whether the series of each step solves the equations at the time tau after its start, shape (step,)."""
    state, slope = _values(series, tau)
    with np.errstate(all="ignore"):  # beyond the end of a chart there are roots of negative numbers
        rates = system.vector_field(state)
        # the slope of a series of length tau is known to some rounding errors of state/tau
        rounding = 1e-12 * linear.norm(state, axis=-1) / np.maximum(np.abs(tau), 1e-300)
        return linear.norm(slope - rates, axis=-1) <= DEFECT * linear.norm(rates, axis=-1) + rounding


def _values(series: Array, tau: Array) -> tuple[Array, Array]:
    """The value and the slope of each step's series, shape (step, component), by Horner's rule."""
    value, slope = series[:, -1], np.zeros_like(series[:, -1])
    for k in range(series.shape[1] - 2, -1, -1):
        slope = slope * tau[:, None] + value
        value = value * tau[:, None] + series[:, k]
    return value, slope


def _seen(chart: Chart, state: Array) -> Array:
    body = np.full((len(state), 9), np.nan)
    good = np.isfinite(state).all(axis=-1)
    body[good] = chart.to_body(state[good])
    return body


def _reason(chart: Chart, state: Array) -> tuple[str, float]:
    try:
        margins = {name: float(value) for name, value in chart.margins(chart.to_body(state)).items()}
    except ChartError as error:  # the last good state has rounded beyond the end
        return error.condition, 0.0
    name = min(margins, key=lambda condition: margins[condition])
    return name, margins[name]
