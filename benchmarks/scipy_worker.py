"""SciPy's side: `solve_ivp` with DOP853 and a right-hand side compiled by Numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba  # pyright: ignore[reportMissingImports]  # lives in the peers' environment only
import numpy as np
from scipy.integrate import solve_ivp

import peer
import peer_top

if TYPE_CHECKING:
    from problem import Array

compiled_rates = numba.njit(peer_top.rates)


@numba.njit  # pyright: ignore[reportUntypedFunctionDecorator]
def field(_t: float, y: Array) -> Array:
    """The right-hand side as an array."""
    return np.array(compiled_rates(y))


def prepare(tol: float) -> peer.Flow:
    """The flow at one tolerance, relative and absolute."""

    def flow_of_one(x: Array, t_end: float) -> Array:
        found = solve_ivp(field, (0.0, t_end), x, method="DOP853", rtol=tol, atol=tol, t_eval=[t_end])
        return found.y[:, -1] if found.success else np.full(18, np.nan)

    return peer.one_by_one(flow_of_one)


if __name__ == "__main__":
    peer.serve("scipy", prepare)
