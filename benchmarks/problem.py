"""What is asked of both sides: one top, one set of starts and first tangent vectors, one way to measure an error.

The twisted Kovalevskaya top: inertia (2, 2, 1), a = (-1, 0, 0), b = 0, epsilon = 1; everything is dimensionless.
Needs numpy only, since both environments import it.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

INERTIA = (2.0, 2.0, 1.0)
A = (-1.0, 0.0, 0.0)
B = (0.0, 0.0, 0.0)
EPSILON = 1.0

N_STARTS = 512
SEED = 2001

T_END = 200.0
"""End of the ensemble runs: long enough that starting up does not count."""

T_ACCURACY = 20.0
"""Where errors are measured: late enough to add up many steps, early enough that chaos, which multiplies every error by
about e^2.5 until then, has not buried the 1e-13 level in amplified round-off."""

T_SINGLE = 1000.0

N_SINGLE = 8
"""Starts over which the time of a single trajectory is averaged: they differ in their numbers of steps."""


def shown(level: float) -> str:
    """A level of accuracy as text: 1e-8."""
    return f"{level:.0e}".replace("e-0", "e-")


def starts() -> Array:
    """States x = (l, alpha, beta) of independent vectors uniform on the unit sphere, shape (N_STARTS, 9)."""
    v = np.random.default_rng(SEED).standard_normal((N_STARTS, 3, 3))
    return (v / np.linalg.norm(v, axis=2, keepdims=True)).reshape(N_STARTS, 9)


def timed(run: Callable[[], object], repeats: int) -> list[float]:
    """Seconds of each of some calls, after one that does not count."""
    run()
    seconds: list[float] = []
    for _ in range(repeats):
        begin = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - begin)
    return seconds


def relative_error(x: NDArray[Any], exact: NDArray[Any]) -> Array:
    """|x - exact| / |exact| over the last axis: shape (n, 9) gives (n,).

    The difference is formed in the precision of `exact`, so that an extended reference is not rounded first.
    """
    return np.asarray(np.linalg.norm(x - exact, axis=-1) / np.linalg.norm(exact, axis=-1), dtype=np.float64)


def invariants(x: Array) -> Array:
    """H, C1, C2, C3 of states of shape (n, 9), as shape (n, 4)."""
    l, alpha, beta = x[:, 0:3], x[:, 3:6], x[:, 6:9]
    h = 0.5 * (l * l / np.array(INERTIA)).sum(1) + alpha @ np.array(A) + beta @ np.array(B)
    c1 = (alpha * alpha).sum(1) + 2.0 * EPSILON * (l * beta).sum(1)
    return np.stack([h, c1, (alpha * beta).sum(1), (beta * beta).sum(1)], axis=1)


def drift(x0: Array, x: Array) -> float:
    """Median over trajectories of the largest change among H, C1, C2, C3."""
    return float(np.median(np.abs(invariants(x) - invariants(x0)).max(axis=1)))
