"""pynamicalsys's side: its adaptive Runge-Kutta method of order 5, the higher of its two, on 18 compiled equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba  # pyright: ignore[reportMissingImports]  # lives in the peers' environment only
import numpy as np
from pynamicalsys import ContinuousDynamicalSystem  # pyright: ignore[reportMissingImports]
from pynamicalsys.continuous_time.step_methods import estimate_initial_step  # pyright: ignore[reportMissingImports]

import peer
import peer_top

if TYPE_CHECKING:
    from problem import Array

compiled_rates = numba.njit(peer_top.rates)
NO_PARAMETERS = np.zeros(1)


@numba.njit  # pyright: ignore[reportUntypedFunctionDecorator]
def field(_t: float, u: Array, _parameters: Array) -> Array:
    """The right-hand side as an array."""
    return np.array(compiled_rates(u))


def prepare(tol: float) -> peer.Flow:
    """The flow at one tolerance, relative and absolute."""
    system = ContinuousDynamicalSystem(equations_of_motion=field, system_dimension=18, number_of_parameters=1)
    system.integrator("rk45", atol=tol, rtol=tol)

    def flow_of_one(x: Array, t_end: float) -> Array:
        # version 1.7.0 ends one initial step later than it is told to
        late = estimate_initial_step(0.0, x, NO_PARAMETERS, field, atol=tol, rtol=tol)
        return system.evolve_system(x, t_end - late, parameters=NO_PARAMETERS)

    return peer.one_by_one(flow_of_one)


if __name__ == "__main__":
    peer.serve("pynamicalsys", prepare)
