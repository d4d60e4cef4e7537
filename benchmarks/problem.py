"""What both sides are asked to integrate: one top, one set of starts, one way to measure an error.

The twisted Kovalevskaya top, inertia (2, 2, 1), a = (-1, 0, 0), b = 0, epsilon = 1, with one tangent vector in R^9.
Everything is dimensionless.  This file needs numpy only, so that both environments can import it.
"""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]

INERTIA = (2.0, 2.0, 1.0)
A = (-1.0, 0.0, 0.0)
B = (0.0, 0.0, 0.0)
EPSILON = 1.0

N_STARTS = 512
SEED = 2001
T_END = 200.0
"""End of the ensemble runs: long enough that starting up is negligible."""
T_ACCURACY = 20.0
"""Where errors are measured: before chaos (growth about e^2.5) has amplified round-off beyond the 1e-13 level."""
T_SINGLE = 1000.0
N_SINGLE = 8
"""Starts over which the time of a single trajectory is averaged: step counts differ between starts."""


def unit_vectors(rng: np.random.Generator, n: int, dimension: int) -> Array:
    """Directions uniform on the sphere, shape (n, dimension): normalised Gaussian vectors."""
    v = rng.standard_normal((n, dimension))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def starts(n: int = N_STARTS, seed: int = SEED) -> Array:
    """States x = (l, alpha, beta) of independent unit vectors, shape (n, 9)."""
    rng = np.random.default_rng(seed)
    return np.concatenate([unit_vectors(rng, n, 3) for _ in range(3)], axis=1)


def relative_error(x: Array, exact: Array) -> Array:
    """|x - exact| / |exact| over the last axis: shape (n, 9) gives (n,).

    The difference is formed in the precision of `exact`, so that an extended reference is not rounded first.
    """
    return np.asarray(np.linalg.norm(x - exact, axis=-1) / np.linalg.norm(exact, axis=-1), dtype=np.float64)


def invariants(x: Array) -> Array:
    """H, C1, C2, C3 of states of shape (n, 9), as shape (n, 4)."""
    l, alpha, beta = x[:, 0:3], x[:, 3:6], x[:, 6:9]
    h = 0.5 * (l * l / np.array(INERTIA)).sum(1) + alpha @ np.array(A) + beta @ np.array(B)
    c1 = (alpha * alpha).sum(1) + 2 * EPSILON * (l * beta).sum(1)
    return np.stack([h, c1, (alpha * beta).sum(1), (beta * beta).sum(1)], axis=1)


def drift(x0: Array, x: Array) -> tuple[float, float]:
    """Medians over trajectories of |H - H0| and of the largest |C - C0| of the three Casimirs."""
    d = np.abs(invariants(x) - invariants(x0))
    return float(np.median(d[:, 0])), float(np.median(d[:, 1:].max(axis=1)))


def save_problem(path: Path, tangents: Array) -> None:
    """Write the starts and the given first tangent vectors, each of shape (n, 9), for every process to read."""
    np.save(path, np.concatenate([starts(), tangents], axis=1))


def load_problem(path: Path) -> tuple[Array, Array]:
    """Starts and first tangent vectors, each of shape (n, 9)."""
    data = np.load(path)
    return data[:, :9], data[:, 9:]
