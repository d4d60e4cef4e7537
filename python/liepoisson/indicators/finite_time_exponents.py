"""The largest Lyapunov exponent along each trajectory, as a function of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson import _core
from liepoisson.compile.field import QuadraticField, TopField
from liepoisson.formula.scalars import TIME_LIMIT
from liepoisson.inputs.arrays import Array, check_shape
from liepoisson.inputs.calls import shows_progress
from liepoisson.io.result import labelled
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import IntegratedRun, outcome_names, trajectories, typical
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.sampling import as_first, sample_tangents
from liepoisson.numeric.starts import StartsLike, as_forward_times, as_starts, as_states
from liepoisson.numeric.systems import (
    HasField,
    at_equal_times,
    component_names,
    core_field,
    core_fields,
    with_momentum_of_time,
)

N_TIMES = 200


@dataclass(frozen=True, kw_only=True, eq=False)
class FiniteTimeExponents(IntegratedRun):
    """Finite-time Lyapunov exponents.  The arrays are read-only; `.copy()` gives one that can be changed.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 4, seed=1), t_end=200)
        >>> growth.exponent.shape, round(float(np.median(growth.exponent[:, -1])), 2)
        ((4, 200), 0.13)

    Attributes:
        time: Times, shape (time,).
        exponent: Finite-time exponents, in inverse time, shape (trajectory, time); NaN from where a trajectory failed.
        outcome: How each trajectory ended, shape (trajectory,): "finished", "step too small", "not finite",
            "max steps", "no convergence", "time limit".
        start_tangent: Tangent vectors at time 0, shape (trajectory, component).
    """

    kind = "growth"
    made_by = "finite_time_exponents"

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
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> FiniteTimeExponents:
    r"""Largest Lyapunov exponent along each trajectory, as a function of time.

    $\lambda(t) = t^{-1}\ln(|v(t)|/|v(0)|)$ for one tangent vector $v$, by default drawn uniformly from the unit
    sphere of the state space; with time it leads to a neighbour at the same time.  The vector is only ever rescaled by
    exact powers of two, so there is no interval of renormalisation to choose.

    $\lambda(t)$ is a finite-time value, biased upwards: it falls like $\ln t/t$ on a regular orbit, and on a chaotic
    one approaches its limit like $1/\sqrt t$ or more slowly; `finite_time_fit` estimates the limit of an ensemble.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> lp.finite_time_exponents(top, lp.sample_states(top, 4, seed=1), t_end=200)
        <FiniteTimeExponents of twisted Kovalevskaya top: 4 trajectories, median exponent 0.1326 at t = 200>

    Args:
        t_end: Last time, positive, in units of the system's own time; the exponent is then given at 200 times
            spaced evenly in the logarithm, from `t_end`/1000 on.
        times: The times themselves, positive and increasing, shape (time,), instead of `t_end`.
        tangents: Tangent vectors at time 0, shape (component,) or (trajectory, component), not zero, instead of random
            ones.

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
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first, system=system)
    field = options.tangent_field(system)
    n = field.n_components
    states, at = as_starts(system, starts, n), as_forward_times(t_end, times, N_TIMES)
    first = as_first(options.first, len(states))
    if tangents is None:
        vectors = at_equal_times(system, sample_tangents(n, len(states), **options.drawn))
    else:
        vectors = as_states(tangents, n, "tangents", names=component_names(system, n))
        wanted = f"({n},) or ({len(states)}, {n}), one for each trajectory"
        fits = len(vectors) in (1, len(states))
        check_shape(fits, "tangents", wanted, vectors, "Give as many as there are states.")
        vectors = np.ascontiguousarray(np.broadcast_to(vectors, states.shape))
    raw = _core.growth(
        core_field(field),
        options.method.core(),
        states.ravel(),
        vectors.ravel(),
        np.concatenate([[0.0], at]),
        options.threads,
        options.left,
        progress,
    )
    return FiniteTimeExponents(
        **options.given(system, states, field),
        seed=options.seed,
        first=first,
        time=at,
        exponent=raw["exponent"].reshape(len(states), len(at)),
        outcome=outcome_names(raw["outcome"]),
        end_time=raw["end_time"],
        n_steps=raw["n_steps"],
        start_tangent=vectors,
        end_state=with_momentum_of_time(system, states, raw["final_state"].reshape(len(states), n)),
        order=raw["order"],
        kernel=raw["kernel"],
    )


def exponents_of_many(
    fields: Sequence[TopField] | Sequence[QuadraticField],
    states: Array,
    *,
    t_end: float,
    tangents: Array,
    options: RunOptions,
) -> tuple[Array, NDArray[np.str_]]:
    """Exponents at `t_end` and outcomes of one trajectory of each of many fields, shape (field,).

    They fill a register as trajectories of one field do, with the same bits as each of them by itself.

    Args:
        fields: Tops, or quadratic fields that differ in their coefficients only.
        states: States at time 0, shape (field, component).
        t_end: The time, positive.
        tangents: Tangent vectors at time 0, shape (field, component).
        options: How.

    Raises:
        ParameterError: Quadratic fields with other terms than the first.
    """
    raw = _core.growth(
        core_fields(fields),
        options.method.core(),
        states.ravel(),
        tangents.ravel(),
        np.array([0.0, t_end]),
        options.threads,
        options.left,
        options.progress,
    )
    return raw["exponent"], outcome_names(raw["outcome"])
