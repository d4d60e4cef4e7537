"""jitcode's side: state and tangent vector as 18 compiled equations, advanced by DOP853.

Not `jitcode_lyap`, which advances the same equations with renormalisations in between, and hides the tangent vector.
"""

from __future__ import annotations

import tempfile
from contextlib import chdir
from typing import TYPE_CHECKING

import numpy as np
from jitcode import jitcode, y  # pyright: ignore[reportMissingImports]  # lives in the peers' environment only

import peer
import peer_top

if TYPE_CHECKING:
    from problem import Array

system = jitcode(list(peer_top.rates([y(i) for i in range(18)])), n=18, verbose=False)
with tempfile.TemporaryDirectory() as empty, chdir(empty):  # setuptools refuses a folder that holds other packages
    system.compile_C(verbose=False)


def prepare(tol: float) -> peer.Flow:
    """The flow at one tolerance, relative and absolute."""
    system.set_integrator("dop853", rtol=tol, atol=tol)

    def flow_of_one(x: Array, t_end: float) -> Array:
        system.set_initial_value(x, 0.0)
        return np.array(system.integrate(t_end))

    return peer.one_by_one(flow_of_one)


if __name__ == "__main__":
    peer.serve("jitcode", prepare)
