"""Trajectories with dense output, forwards and backwards in time, with any number of tangent vectors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike

from liepoisson import _core
from liepoisson.compile.field import TopField
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_array, as_number, as_time
from liepoisson.inputs.arrays import Array, check_finite, check_shape
from liepoisson.inputs.calls import explains_its_arguments, shows_progress
from liepoisson.inputs.refusals import counted
from liepoisson.io.result import labelled, pieces
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import IntegratedRun, KeepsInvariants, outcome_names, trajectories
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_starts, as_times, as_values
from liepoisson.numeric.systems import HasField, component_names, core_field, without_value

_N_TIMES = 1001
"""Times of a run of which only the end is given."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Orbit(IntegratedRun, KeepsInvariants):
    """Trajectories at given times.  The arrays are read-only; `.copy()` gives one that can be changed.

    `invariants` has the Hamiltonian, the Casimirs and the known integrals along them, `drift` their largest changes.

    Example:
        >>> run = lp.integrate(lp.catalog.system("kovalevskaya"), {"l": (1, 0, 1), "alpha3": 1}, t_end=100)
        >>> run.state.shape, run.outcome.tolist()
        ((1, 1001, 6), ['finished'])
        >>> {name: bool(drift.max() < 1e-12) for name, drift in run.drift.items()}
        {'H': True, 'C1': True, 'C2': True, 'K': True}

    Attributes:
        start_time: Time of the starts.
        start_tangent: Shape (trajectory, tangent, component).
        time: Times, shape (time,); the first is that of the initial states.
        state: States, shape (trajectory, time, component); NaN from where a trajectory failed.
        tangent: Tangent vectors, shape (trajectory, time, tangent, component).
        outcome: How each trajectory ended, shape (trajectory,): "finished", "step too small", "not finite",
            "max steps", "no convergence", "time limit"; "not finite" also where the Hamiltonian or a given integral
            stops being a real number.
        end_time: Time that each trajectory reached, that of its last good state, shape (trajectory,).
        kernel: The code that advanced the trajectories: the instruction set of the kernel for many ("avx512", "avx2",
            "neon", "scalar": the same bits), or "components", the kernel for one trajectory (other last bits).
        series: Dense output of each trajectory, if it was asked for: starts of the steps, shape (step,), and
            coefficients, shape (step, order, component).
    """

    kind = "orbit"
    made_by = "integrate"
    rows = ("trajectory", "time")

    start_time: float
    start_tangent: Array = labelled("trajectory", "vector", "component", long_name="tangent vectors as they were given")
    time: Array = labelled("time", long_name="time", is_coordinate=True)
    state: Array = labelled("trajectory", "time", "component", long_name="state")
    tangent: Array = labelled("trajectory", "time", "vector", "component", long_name="tangent vectors")
    series: tuple[tuple[Array, Array], ...] = pieces("step", ("step_time", "step_series"), ("power", "component"))

    def arguments(self) -> dict[str, Any]:
        """What `integrate` was called with."""
        if float(self.time[0]) != self.start_time:
            raise ParameterError(
                f"time: wanted times from {self.start_time:g} on, where the starts are; got {self.time[0]:g}"
            )
        return {
            **super().arguments(),
            "times": self.time,
            "tangents": self.start_tangent if self.start_tangent.shape[1] else None,
            "dense": bool(self.series),
            "kernel": "components" if self.kernel == "components" else "lanes",
        }

    @explains_its_arguments
    def go_on(self, *, times: ArrayLike | None = None, t_end: float | None = None, **options: Any) -> Orbit:
        """The orbits and their tangent vectors from their last time on.

        A step begins at the last time.  A single run has other steps there, and so agrees within the error of the
        method, not bit for bit.

        Args:
            times: Further times, strictly monotone in the direction of travel; the last time of this orbit is put
                before them.
            t_end: Instead, the end of the run, with as many times as here, evenly spaced.
            **options: As for `integrate`, in place of those of this run: method, dense, kernel, threads, time_limit,
                progress.

        Raises:
            ParameterError: A trajectory has ended before the last time; both or neither of `times` and `t_end`.
        """
        last = float(self.time[-1])
        if not (self.outcome == "finished").all():
            raise ParameterError(
                f"go_on: wanted trajectories that reached t = {last:g}; got some that did not (see outcome)"
            )
        if (times is None) == (t_end is None):
            raise ParameterError("go_on: wanted times or t_end; got both or neither; try t_end=200")
        if times is None:
            end = as_number(t_end, "t_end", "a finite time")
            onward = np.linspace(last, end, len(self.time)) if np.isfinite(end) else np.zeros(2)
            if (np.diff(onward) == 0).any():
                raise ParameterError(
                    f"t_end: wanted a finite time beyond {last:g}, with room for {len(self.time)} times; got {end:g}; "
                    f"try t_end={2 * last - float(self.time[0]):g}"
                )
        else:
            onward = np.atleast_1d(as_values(times, "times"))
            onward = onward if onward.size and onward[0] == last else np.concatenate([[last], onward])
        if (onward[-1] - last) * (last - float(self.time[0])) < 0:
            raise ParameterError(
                f"go_on: wanted times beyond {last:g}, in the direction of travel; got {onward[-1]:g}; to turn round, "
                "integrate from end_state"
            )
        same = {name: value for name, value in self.arguments().items() if name not in ("starts", "times", "tangents")}
        tangents = self.tangent[:, -1] if self.tangent.shape[2] else None
        run: dict[str, Any] = {**same, "times": onward, "tangents": tangents} | options
        return integrate(self.system, self.state[:, -1], **run)

    def at(self, times: ArrayLike) -> Array:
        """States at any times between the first and the last, from the power series of the steps.

        Args:
            times: Times, any shape, within the run.

        Returns:
            States, shape (trajectory, *shape of times, component), as accurate as the steps; NaN at times that the
            trajectory did not reach.

        Raises:
            ParameterError: The run was made without `dense=True`, or a time lies outside it.
        """
        if not self.series:
            raise ParameterError(
                "at(times): wanted a run with dense output; got one without; try integrate(..., dense=True)"
            )
        times = as_values(times, "times")
        low, high = min(self.time[0], self.time[-1]), max(self.time[0], self.time[-1])
        if not ((times >= low) & (times <= high)).all():
            raise ParameterError(f"at(times): wanted times from {low} to {high}; got {times.min()} to {times.max()}")
        values = _core.states_at(
            [(starts, coefficients.ravel()) for starts, coefficients in self.series],
            self.end_time.tolist(),
            self.state.shape[-1],
            np.ascontiguousarray(times).ravel(),
            bool(self.time[-1] < self.time[0]),
        )
        return values.reshape(len(self.series), *times.shape, self.state.shape[-1])

    def __repr__(self) -> str:
        span = f"t = {self.time[0]:g} to {self.time[-1]:g}"
        n_tangents = self.tangent.shape[2]
        tangents = f", {n_tangents} tangent vector{'' if n_tangents == 1 else 's'} each" if n_tangents else ""
        return f"<Orbit of {self.system.name}: {trajectories(self.outcome)}, {len(self.time)} times, {span}{tangents}>"


@shows_progress
def integrate(
    system: HasField,
    starts: StartsLike,
    *,
    times: ArrayLike | None = None,
    t_end: float | None = None,
    tangents: ArrayLike | None = None,
    method: MethodChoice | None = None,
    dense: bool = False,
    kernel: Literal["lanes", "components"] | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Orbit:
    r"""Trajectories $\dot x = J(x)\nabla H(x)$ and their tangent vectors $\dot v = D(J\nabla H)(x)\,v$.

    Example:
        >>> orbit = lp.integrate(lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}, t_end=100)
        >>> orbit
        <Orbit of Kovalevskaya top: 1 trajectory, 1001 times, t = 0 to 100>
        >>> bool(orbit.drift["H"].max() < 1e-13)
        True

    Args:
        system: What is integrated.
        starts: States at the first time, shape (component,) or (trajectory, component), dimensionless; or vectors and
            components by name, the others being zero, `{"l": (1, 0, 0), "beta3": "1/3"}`.  Labels of a table, a Series
            or an xarray object decide the order.  A row that is not finite
            beside good ones ends at once, with the outcome "not finite".
        times: Times at which states are wanted, strictly monotone, shape (time,), the first that of the starts;
            decreasing times run backwards.  One number T means the times 0 and T.
        t_end: Instead, the end of a run from 0, with 1,001 evenly spaced times; negative ends run backwards.
        tangents: Tangent vectors at the first time, shape (tangent, component) for all trajectories or
            (trajectory, tangent, component).
        method: How; by default `Taylor()`, to round-off.  Methods without power series step to every wanted time.
        dense: Keep the power series of every step, so that `orbit.at(times)` answers for any time.
        kernel: "lanes" advances trajectories side by side in registers, "components" one trajectory without tangent
            vectors, with the components of its vectors side by side, which is quicker and rounds differently; only tops
            have the latter.  By default "components" for one such trajectory, else "lanes".

    Returns:
        Orbit; a trajectory that fails is an outcome in it, not an error.

    Raises:
        ShapeError: An array has another shape than stated.
        ParameterError: Numbers that are not finite, times that are not monotone, a method or kernel that does not
            apply.
        KeyboardInterrupt: Ctrl-C.
    """
    in_series = dense or kernel == "components"
    options = RunOptions.read(
        method, threads, time_limit, progress, default=Taylor(), system=system, in_series=in_series
    )
    method, field = options.method, options.field(system)
    n = field.n_components
    states, times = as_starts(system, starts, n), _as_orbit_times(times, t_end)
    vectors = _as_tangents(tangents, len(states), component_names(system, n))
    in_series = isinstance(method, Taylor)
    if dense and not in_series:
        raise ParameterError(f"dense: wanted the Taylor method, which has power series; got {method}; leave dense out")
    by_components = isinstance(method, Taylor) and method.precision == "double" and isinstance(field, TopField)
    alone = by_components and len(states) == 1 and vectors.shape[1] == 0
    if kernel not in (None, "lanes", "components") or (kernel == "components" and not alone):
        raise ParameterError(
            f'kernel: wanted "lanes", or "components" for one trajectory of a top without tangent vectors; got '
            f"{kernel!r} for {counted(len(states), 'trajectory', 'trajectories')} with "
            f"{counted(vectors.shape[1], 'tangent vector')} of a field of kind "
            f"{field.kind!r}; leave it out to have it chosen"
        )
    raw = _core.orbits(
        core_field(field),
        method.core(),
        states.ravel(),
        vectors.ravel(),
        vectors.shape[1],
        times,
        options.threads,
        options.left,
        dense,
        alone if kernel is None else kernel == "components",
        progress,
    )
    orbit = Orbit(
        **options.given(system, states, field),
        start_time=float(times[0]),
        start_tangent=vectors,
        time=times,
        state=raw["state"].reshape(len(states), len(times), n),
        tangent=raw["tangent"].reshape(len(states), len(times), vectors.shape[1], n),
        outcome=outcome_names(raw["outcome"]),
        end_time=raw["end_time"],
        n_steps=raw["n_steps"],
        end_state=raw["final_state"].reshape(len(states), n),
        order=raw["order"],
        kernel=raw["kernel"],
        series=tuple((begins, c.reshape(len(begins), raw["order"] + 1, n)) for begins, c in raw["series"]),
    )
    overflown = in_series and not np.isfinite(orbit.end_state[orbit.n_steps > 0]).all()
    return _while_invariants_are_real(_before_overflow(orbit) if overflown else orbit)


def _while_invariants_are_real(orbit: Orbit) -> Orbit:
    """The same, with trajectories that end before the first time at which an invariant is no real number.

    The rates may be real beyond: the logarithm of a negative number has a real derivative.
    """
    lost = np.zeros(orbit.state.shape[:2], dtype=bool)
    for places in without_value(orbit.system, orbit.state).values():
        lost |= places
    if not lost.any():
        return orbit
    end, time, outcome = orbit.end_state.copy(), orbit.end_time.copy(), orbit.outcome.copy()
    state, tangent = orbit.state.copy(), orbit.tangent.copy()
    for k in np.flatnonzero(lost.any(axis=1)):
        first = int(lost[k].argmax())
        end[k], time[k], outcome[k] = state[k, first - 1], orbit.time[first - 1], "not finite"
        state[k, first:], tangent[k, first:] = np.nan, np.nan
    return replace(orbit, end_state=end, end_time=time, outcome=outcome, state=state, tangent=tangent)


def _before_overflow(orbit: Orbit) -> Orbit:
    """The same, where a last step led from a good state to one that is not finite without that step.

    It was known to be wrong only when the next one could not be made, and nothing is left of the state before: the few
    that end so are run again, up to that step.
    """
    end, time, n_steps, state = orbit.end_state.copy(), orbit.end_time.copy(), orbit.n_steps.copy(), orbit.state.copy()
    tangent = orbit.tangent.copy()
    for k in np.flatnonzero(~np.isfinite(end).all(axis=1) & (n_steps > 0)):
        if n_steps[k] == 1:
            end[k], time[k] = orbit.start[k], orbit.start_time
        else:
            again = integrate(
                orbit.field,
                orbit.start[k],
                times=orbit.time,
                tangents=orbit.start_tangent[k : k + 1] if orbit.start_tangent.shape[1] else None,
                method=replace(cast("Taylor", orbit.method), max_steps=int(n_steps[k]) - 1),
                kernel="components" if orbit.kernel == "components" else "lanes",
                threads=1,
                time_limit=orbit.time_limit,
            )
            end[k], time[k] = again.end_state[0], again.end_time[0]
        n_steps[k] -= 1
        beyond = np.abs(orbit.time - orbit.start_time) > abs(time[k] - orbit.start_time)
        state[k, beyond], tangent[k, beyond] = np.nan, np.nan
    return replace(orbit, end_state=end, end_time=time, n_steps=n_steps, state=state, tangent=tangent)


def _as_orbit_times(times: ArrayLike | None, t_end: float | None) -> Array:
    """The wanted times: given, or evenly spaced up to the end."""
    if times is not None and t_end is not None:
        raise ParameterError("times: wanted times or t_end; got both; leave one out")
    if times is None:
        if t_end is None:
            raise ParameterError("times: wanted times or t_end; got neither; try t_end=100")
        return np.linspace(0.0, as_time(t_end, "t_end", example=100, forwards=False), _N_TIMES)
    wanted = as_values(times, "times")
    return as_times(np.array([0.0, float(wanted)]) if wanted.ndim == 0 else wanted, "times", least=2)


def _as_tangents(tangents: ArrayLike | None, n_trajectories: int, names: Sequence[str]) -> Array:
    n = len(names)
    if tangents is None:
        return np.empty((n_trajectories, 0, n))
    vectors = as_array(tangents, "tangents", names)
    if vectors.ndim == 2:
        vectors = np.broadcast_to(vectors, (n_trajectories, *vectors.shape))
    fits = vectors.ndim == 3 and vectors.shape[0] == n_trajectories and vectors.shape[2] == n
    check_shape(fits, "tangents", f"(tangent, {n}) or ({n_trajectories}, tangent, {n})", vectors)
    check_finite(vectors, "tangents", "drop these vectors")
    return np.ascontiguousarray(vectors)
