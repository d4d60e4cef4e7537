r"""How far averages along an orbit still move: weighted Birkhoff averages over the first and the last part of a run.

On a torus whose frequencies are far from resonance the average of a function f with a smooth window,

$$ \langle f\rangle = \int_0^1 w(u)\,f(x(t_0 + u L))\,du,\qquad w(u) = \tfrac83\sin^4(\pi u), $$

tends to the mean over the torus like $L^{-5}$, so two parts of one run give the same.  A chaotic orbit, also one that
sticks to an island or wanders in a thin layer, visits different parts at different times, and its averages differ by a
few per cent of the size of f long before its tangent vectors have grown.

References: Das, Saiki, Sander and Yorke, Nonlinearity 30 (2017) 4111; Sander and Meiss, Physica D 411 (2020) 132569;
Duignan and Meiss, Physica D 449 (2023) 133749.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson import _core
from liepoisson.formula.scalars import as_time
from liepoisson.inputs.arrays import Array
from liepoisson.numeric.integrate import integrate
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_starts
from liepoisson.numeric.systems import HasField, as_field, n_of_time, periods_of_components
from liepoisson.portable import elementary

_LEAST_SAMPLES, _MOST_DOUBLINGS = 4096, 4
# Numbers in the states of all trajectories that are in memory at once: 19 MB.
_AT_ONCE = 64 * _LEAST_SAMPLES * 9


def average_drift(
    system: HasField,
    starts: StartsLike,
    *,
    t_end: float,
    natural_time: ArrayLike,
    options: RunOptions,
) -> tuple[Array, NDArray[np.str_]]:
    r"""The largest change of an average from the first to the last 0.6 of the run, for the squares of all components.

    $\max_i |\langle x_i^2\rangle_1 - \langle x_i^2\rangle_2|$ over the standard deviation of $x_i^2$ along the orbit:
    a pure number, the same if components are multiplied by numbers of their own.  Squares, since the average of a
    component often vanishes by symmetry on all orbits.  Of an angle the square of its cosine is averaged, so that it
    may turn; time and its momentum are left out.  They are sampled 4,096 times, up to 16 times as often in runs
    of more than 8,192 natural times.

    Args:
        system: The system.
        starts: States at time 0, shape (component,) or (trajectory, component), dimensionless.
        t_end: Length of the run, positive.
        natural_time: The same in natural units, shape (trajectory,): `t_end` over the `time_scale`.
        options: How.

    Returns:
        The change, shape (trajectory,), NaN where a trajectory failed; and how each ended, shape (trajectory,).

    Raises:
        ShapeError: An array has another shape than stated.
        ParameterError: Numbers that are not finite, or a time that is not positive.
    """
    states = as_starts(system, starts, as_field(system).n_components)
    periods = periods_of_components(system, states.shape[1])
    n_kept = states.shape[1] - n_of_time(system)
    end = as_time(t_end, "t_end", example=1000)
    drift, outcome = np.full(len(states), np.nan), np.full(len(states), "not finite", dtype="<U16")
    good = np.flatnonzero(np.isfinite(states).all(axis=1))
    lengths = np.broadcast_to(np.asarray(natural_time, np.float64), len(states))
    doublings = np.ceil(elementary.log2(np.maximum(np.nan_to_num(lengths, posinf=0.0) / (2 * _LEAST_SAMPLES), 1.0)))
    n_done = 0
    for k in np.unique(doublings[good]):
        n_samples = _LEAST_SAMPLES * 2 ** int(min(k, _MOST_DOUBLINGS))
        members = good[doublings[good] == k]
        size = max(1, _AT_ONCE // (n_samples * states.shape[1]))
        for start in range(0, len(members), size):
            some = members[start : start + size]
            if options.is_late:
                outcome[some] = "time limit"
                continue
            orbit = integrate(
                system,
                states[some],
                times=end * np.arange(n_samples + 1) / n_samples,
                kernel="lanes",  # the same bits however the ensemble is cut
                **options.inner(n_done / len(good), len(some) / len(good)),
            )
            outcome[some] = orbit.outcome
            arrived = orbit.outcome == "finished"
            drift[some[arrived]] = _change(_functions(orbit.state[arrived, :-1, :n_kept], periods[:n_kept]))
            n_done += len(some)
            options.tell(n_done / len(good))
    return drift, outcome


def _functions(state: Array, periods: Array) -> Array:
    """What is averaged, before it is squared: the components, of points of circles the cosines."""
    turning = np.isfinite(periods)
    if not turning.any():
        return state
    values = state.copy()
    values[..., turning] = elementary.cos(state[..., turning] * (2 * np.pi / periods[turning]))
    return values


def _change(state: Array) -> Array:
    """The change of the average square, largest component, shape (trajectory,), of states (trajectory, sample, ...)."""
    return _core.average_changes(np.ascontiguousarray(state).ravel(), len(state), state.shape[-1])
