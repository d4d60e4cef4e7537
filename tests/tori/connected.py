"""The number of pieces of a fibre by points that short paths on it join: no flows, no lattices."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_NEIGHBOURS, _PARTS = 10, 8


def moved(functions: Callable[[NDArray], NDArray], value: Array, x: Array, steps: int = 30) -> tuple[Array, Array]:
    """Newton's method of least norm onto functions = value: the points, and which have come there."""
    for _ in range(steps):
        # Derivatives by an imaginary step: exact for polynomials
        shifts = 1e-30j * np.eye(x.shape[1])
        gradients = np.stack([functions(x + one).imag / 1e-30 for one in shifts], axis=2)
        gap = functions(x.astype(complex)).real - value
        x = x - np.einsum("mij,mj->mi", np.linalg.pinv(gradients, rcond=1e-12), gap)
    gap = functions(x.astype(complex)).real - value
    return x, np.abs(gap).max(axis=1) < 1e-10 * (1 + np.abs(value).max())


def pieces(functions: Callable[[NDArray], NDArray], value: Array, starts: Array) -> Array:
    """The number of the piece of each of the points that the starts are moved to, with the points as rows."""
    x, there = moved(functions, value, starts)
    x = x[there]
    distance = np.linalg.norm(x[:, None] - x[None], axis=2)
    nearest = np.argsort(distance, axis=1)[:, 1 : _NEIGHBOURS + 1]
    pairs = np.unique(
        np.sort(np.stack([np.repeat(np.arange(len(x)), _NEIGHBOURS), nearest.ravel()], 1), axis=1), axis=0
    )
    a, b = x[pairs[:, 0]], x[pairs[:, 1]]
    joined, last = np.ones(len(pairs), dtype=bool), a
    length = np.linalg.norm(b - a, axis=1) / _PARTS
    for k in range(1, _PARTS + 1):
        here, good = moved(functions, value, a + k / _PARTS * (b - a), 6)
        joined &= good & (np.linalg.norm(here - last, axis=1) < 2 * length)
        last = here
    labels = np.arange(len(x))
    for i, j in pairs[joined]:
        if labels[i] != labels[j]:
            labels[labels == labels[j]] = labels[i]
    return np.unique(labels, return_inverse=True)[1]
