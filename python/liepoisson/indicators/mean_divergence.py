r"""The mean divergence along orbits: the rate at which the flow changes volumes.

All Lyapunov exponents of an orbit add up to it, at every time (Liouville),

$$ \sum_k\lambda_k(t) = \frac1t\int_0^t \mathrm{div} f(x(s))\,ds . $$

The integral is one more component of the state, integrated with it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liepoisson.inputs.arrays import Array
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.model.vector_field import VectorField
from liepoisson.numeric.integrate import integrate


def divergence_of(system: Any) -> Any:
    """The divergence of a system whose equations are known and do not depend on time; None of others."""
    is_known = isinstance(system, EquationsOfMotion) and getattr(system, "clock", None) is None
    return system.divergence if is_known else None


def mean_divergence(system: Any, starts: Array, *, transient: float, t_end: float, time_limit: float) -> Array:
    """The mean from the end of a transient on, shape (trajectory,).

    NaN where an orbit does not reach the end, and for systems whose equations are not known or depend on time.

    Args:
        system: The system.
        starts: States, shape (trajectory, component).
        transient: Time before the mean begins.
        t_end: For how long it is taken.
        time_limit: Seconds after which the orbits that are left end.
    """
    divergence = divergence_of(system)
    if divergence is None or divergence.is_number:
        return np.full(len(starts), np.nan if divergence is None else float(divergence))
    name = "divergence"
    while name in system.component_names:
        name += "_"
    rates = {str(x): rate for x, rate in system.equations.items()} | {name: divergence}
    begin = np.concatenate([starts, np.zeros((len(starts), 1))], axis=1)
    times = [0.0, t_end] if not transient else [0.0, transient, transient + t_end]
    orbit = integrate(VectorField(rates, name=system.name), begin, times=times, time_limit=time_limit)
    return (orbit.state[:, -1, -1] - orbit.state[:, -2, -1]) / t_end
