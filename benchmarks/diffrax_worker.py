"""diffrax's side: Dopri8 with an adaptive step for each start, all starts at once by `vmap`, in double precision."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

os.environ["JAX_PLATFORMS"] = "cpu"
os.environ["JAX_ENABLE_X64"] = "1"

import diffrax  # pyright: ignore[reportMissingImports]  # lives in the peers' environment only
import jax  # pyright: ignore[reportMissingImports]
import jax.numpy as jnp  # pyright: ignore[reportMissingImports]
import numpy as np

import peer
import peer_top

if TYPE_CHECKING:
    from problem import Array

MAX_STEPS = 1_000_000


def field(_t: Any, y: Any, _arguments: Any) -> Any:
    """The right-hand side for a tuple of 18 numbers."""
    return peer_top.rates(y)


@jax.jit  # pyright: ignore[reportUntypedFunctionDecorator]
def flow_of_all(x0: Any, t_end: Any, tol: Any) -> Any:
    """All starts; 18 numbers for each rather than an array of 18, which is a third slower."""

    def flow_of_one(y: Any) -> Any:
        found = diffrax.diffeqsolve(
            diffrax.ODETerm(field),
            diffrax.Dopri8(),
            t0=0.0,
            t1=t_end,
            dt0=None,
            y0=tuple(y),
            stepsize_controller=diffrax.PIDController(rtol=tol, atol=tol),
            saveat=diffrax.SaveAt(t1=True),
            max_steps=MAX_STEPS,
            adjoint=diffrax.ForwardMode(),
            throw=False,
        )
        good = found.result == diffrax.RESULTS.successful
        return jnp.where(good, jnp.stack([component[-1] for component in found.ys]), jnp.nan)

    return jax.vmap(flow_of_one)(x0)


def prepare(tol: float) -> peer.Flow:
    """The flow at one tolerance, relative and absolute."""

    def flow(x0: Array, t_end: float) -> Array:
        return np.asarray(flow_of_all(x0, t_end, tol))

    return flow


if __name__ == "__main__":
    peer.serve("diffrax", prepare)
