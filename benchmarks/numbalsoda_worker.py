"""numbalsoda's side: its dop853 with a compiled right-hand side, called in a compiled loop over the starts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numba  # pyright: ignore[reportMissingImports]  # lives in the peers' environment only
import numpy as np
from numbalsoda import dop853, lsoda_sig  # pyright: ignore[reportMissingImports]

import peer
import peer_top

if TYPE_CHECKING:
    from problem import Array

MAX_STEPS = 1_000_000
compiled_rates = numba.njit(peer_top.rates)


@numba.cfunc(lsoda_sig)  # pyright: ignore[reportUntypedFunctionDecorator]
def field(_t: float, y: Any, rate: Any, _parameters: Any) -> None:
    """The right-hand side, written to `rate`."""
    values = compiled_rates(y)
    for i in range(18):
        rate[i] = values[i]


ADDRESS = field.address  # pyright: ignore[reportFunctionMemberAccess]


@numba.njit  # pyright: ignore[reportUntypedFunctionDecorator]
def flow_of_all(x0: Array, t_end: float, tol: float) -> Array:
    """All starts, one after another."""
    ends = np.full_like(x0, np.nan)
    times = np.array([0.0, t_end])
    for k in range(len(x0)):
        found, success = dop853(ADDRESS, x0[k], times, rtol=tol, atol=tol, mxstep=MAX_STEPS)
        if success:
            ends[k] = found[-1]
    return ends


def prepare(tol: float) -> peer.Flow:
    """The flow at one tolerance, relative and absolute."""
    return lambda x0, t_end: flow_of_all(x0, t_end, tol)


if __name__ == "__main__":
    peer.serve("numbalsoda", prepare)
