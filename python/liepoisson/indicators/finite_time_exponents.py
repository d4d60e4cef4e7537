"""The largest Lyapunov exponent along each trajectory, as a function of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson import _core
from liepoisson.compile.field import QuadraticField, TopField
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import TIME_LIMIT, as_threads, as_time, as_time_limit
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.io.result import labelled
from liepoisson.numeric.methods import Method, Taylor, as_method, field_for
from liepoisson.numeric.outcomes import outcome_names, trajectories, typical
from liepoisson.numeric.run import IntegratedRun, given
from liepoisson.numeric.sampling import as_first, as_seed, sample_tangents
from liepoisson.numeric.starts import StartsLike, as_starts, as_states, as_times
from liepoisson.numeric.systems import HasField, as_field, component_names, core_field, core_fields
from liepoisson.portable import elementary

N_TIMES = 200


@dataclass(frozen=True, kw_only=True)
class FiniteTimeExponents(IntegratedRun):
    """Finite-time Lyapunov exponents.  The arrays are read-only; `.copy()` gives one that can be changed.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 4, seed=1), t_end=200)
        >>> growth.exponent.shape, round(float(np.median(growth.exponent[:, -1])), 2)
        ((4, 200), 0.13)

    Attributes:
        system: The system, as it was given.
        components: Names of the components of the state.
        field: Its vector field.
        method: How it was integrated.
        seed: Seed of the tangent vectors.
        first: Number of the first member.
        time: Times, shape (time,).
        exponent: Finite-time exponents, in inverse time, shape (trajectory, time); NaN from where a trajectory failed.
        outcome: How each trajectory ended, shape (trajectory,): "finished", "step too small", "not finite",
            "max steps", "no convergence", "time limit".
        end_time: Time that each trajectory reached, shape (trajectory,).
        n_steps: Accepted steps of each trajectory.
        start: Shape (trajectory, component).
        start_tangent: Shape (trajectory, component).
        end_state: Last good state, shape (trajectory, component).
        order: Order of the method.
        kernel: Instruction set used.
        time_limit: Seconds that the run was allowed to take.
    """

    kind = "growth"

    seed: int
    first: int
    time: Array = labelled("time", long_name="time", is_coordinate=True)
    exponent: Array = labelled(
        "trajectory",
        "time",
        long_name="finite-time largest Lyapunov exponent",
        units="inverse time, dimensionless",
    )
    start_tangent: Array = labelled("trajectory", "component", long_name="tangent vector at time 0")

    def arguments(self) -> dict[str, Any]:
        """What `finite_time_exponents` was called with."""
        own = {"times": self.time, "tangents": self.start_tangent, "seed": self.seed, "first": self.first}
        return super().arguments() | own

    def __repr__(self) -> str:
        value, name = typical("exponent", self.exponent[:, -1]), self.system.name
        return f"<FiniteTimeExponents of {name}: {trajectories(self.outcome)}, {value} at t = {self.time[-1]:g}>"


@shows_progress
def finite_time_exponents(
    system: HasField,
    starts: StartsLike,
    *,
    t_end: float | None = None,
    times: ArrayLike | None = None,
    tangents: ArrayLike | None = None,
    seed: int = 0,
    first: int = 0,
    method: Method | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> FiniteTimeExponents:
    r"""Largest Lyapunov exponent along each trajectory, as a function of time.

    $\lambda(t) = t^{-1}\ln(|v(t)|/|v(0)|)$ for one tangent vector $v$, by default drawn uniformly from the unit
    sphere of the state space.  The vector is only ever rescaled by exact powers of two, so there is no interval of
    renormalisation to choose.

    $\lambda(t)$ is a finite-time value, biased upwards: it falls like $\ln t/t$ on a regular orbit, and on a chaotic
    one approaches its limit like $1/\sqrt t$ or more slowly; `finite_time_fit` estimates the limit of an ensemble.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> lp.finite_time_exponents(top, lp.sample_states(top, 4, seed=1), t_end=200)
        <FiniteTimeExponents of twisted Kovalevskaya top: 4 trajectories, median exponent 0.1326 at t = 200>

    Args:
        system: The system.
        starts: States at time 0, shape (component,) or (trajectory, component), dimensionless; a row that is not finite
            beside good ones ends at once, with the outcome "not finite".
        t_end: Last time, positive, in units of the system's own time; the exponent is then given at 200 times
            spaced evenly in the logarithm, from `t_end`/1000 on.
        times: The times themselves, positive and increasing, shape (time,), instead of `t_end`.
        tangents: Tangent vectors at time 0, shape (component,) or (trajectory, component), not zero, instead of random
            ones.
        seed: Draws the tangent vectors.
        first: Number of the first member, so that an ensemble can be computed in pieces: member k has the same tangent
            vector in whichever piece it is.
        method: How; by default `Taylor(tol=1e-13)`.
        threads: By default all processors that the process may use.  Results do not depend on it, bit for bit.
        time_limit: Seconds that the run may take; trajectories that are not done by then end with the outcome
            "time limit", and all that is done is kept.
        progress: Called a few times a second with the fraction that is done.

    Returns:
        FiniteTimeExponents; a trajectory that fails is an outcome in it, not an error.

    Raises:
        ShapeError: An array has another shape than stated.
        ParameterError: Numbers that are not finite, a time that is not positive, both or neither of `t_end` and
            `times`, a tangent vector that is zero.
        KeyboardInterrupt: Ctrl-C.

    References:
        Benettin, Galgani, Giorgilli and Strelcyn, Meccanica 15 (1980) 9.
    """
    method = as_method(method, Taylor(tol=1e-13))
    field = field_for(system, as_field(system), method)
    n = field.n_components
    states, wanted = as_starts(system, starts, n), _as_exponent_times(t_end, times)
    seed, first = as_seed(seed), as_first(first, len(states))
    if tangents is None:
        vectors = sample_tangents(n, len(states), seed=seed, first=first)
    else:
        vectors = as_states(tangents, n, "tangents", names=component_names(system, n))
        if len(vectors) not in (1, len(states)):
            raise ShapeError(
                f"tangents must have shape ({n},) or ({len(states)}, {n}), one for each trajectory; got shape "
                f"{vectors.shape}. Give as many as there are states."
            )
        vectors = np.ascontiguousarray(np.broadcast_to(vectors, states.shape))
    limit = as_time_limit(time_limit)
    raw = _core.growth(
        core_field(field),
        method.core(),
        states.ravel(),
        vectors.ravel(),
        np.concatenate([[0.0], wanted]),
        as_threads(threads),
        limit,
        progress,
    )
    return FiniteTimeExponents(
        **given(system, field, method, states),
        seed=seed,
        first=first,
        time=wanted,
        exponent=raw["exponent"].reshape(len(states), len(wanted)),
        outcome=outcome_names(raw["outcome"]),
        end_time=raw["end_time"],
        n_steps=raw["n_steps"],
        start_tangent=vectors,
        end_state=raw["final_state"].reshape(len(states), n),
        order=raw["order"],
        kernel=raw["kernel"],
        time_limit=limit,
    )


def exponents_of_many(
    fields: Sequence[TopField] | Sequence[QuadraticField],
    states: Array,
    *,
    t_end: float,
    tangents: Array,
    method: Taylor,
    threads: int | None,
    time_limit: float,
    progress: Callable[[float], Any] | None,
) -> tuple[Array, NDArray[np.str_]]:
    """Exponents at `t_end` and outcomes of one trajectory of each of many fields, shape (field,).

    They fill a register as trajectories of one field do, with the same bits as each of them by itself.

    Args:
        fields: Tops, or quadratic fields that differ in their coefficients only.
        states: States at time 0, shape (field, component).
        t_end: The time, positive.
        tangents: Tangent vectors at time 0, shape (field, component).
        method: How.
        threads: By default all processors that the process may use.
        time_limit: Seconds that the run may take.
        progress: Called a few times a second with the fraction that is done.

    Raises:
        ParameterError: Quadratic fields with other terms than the first.
    """
    raw = _core.growth(
        core_fields(fields),
        method.core(),
        states.ravel(),
        tangents.ravel(),
        np.array([0.0, t_end]),
        as_threads(threads),
        as_time_limit(time_limit),
        progress,
    )
    return raw["exponent"], outcome_names(raw["outcome"])


def _as_exponent_times(t_end: float | None, times: ArrayLike | None) -> Array:
    if (t_end is None) == (times is None):
        raise ParameterError("wanted either t_end or times; got both or neither; try t_end=1000")
    if times is None:
        end = as_time(t_end, "t_end", example=1000)
        wanted = elementary.geomspace(end / 1000.0, end, N_TIMES)
        wanted[-1] = end
        return wanted
    wanted = as_times(times, "times", least=1)
    if wanted[0] <= 0.0 or wanted[-1] <= 0.0 or (len(wanted) > 1 and wanted[1] < wanted[0]):
        raise ParameterError(
            f"times: wanted positive increasing times; got {wanted[0]} to {wanted[-1]}; time starts at 0"
        )
    return wanted
