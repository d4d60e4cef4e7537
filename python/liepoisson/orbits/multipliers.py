r"""Multipliers of a closed orbit on its level, with a check of the structure that they must have.

The derivative D of the flow along one loop, followed by the symmetry that closes it, has the trivial multipliers 1 of
the flow and of H and the Casimirs.  They are divided out exactly, not picked out of a spectrum: with an orthonormal
basis Q of the vectors that are orthogonal to the flow, in the level,

$$ M = Q^T D Q $$

has the others.  M is symplectic, so its multipliers come in pairs $\mu, 1/\mu$, and $w = \mu + 1/\mu$ is a double
eigenvalue of $M + M^{-1}$.  $M^{-1}$ is computed by running the loop backwards; hence large and small multipliers are
accurate alike, and the two values of w are a check.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from liepoisson.inputs.arrays import Array
from liepoisson.portable import linear

ComplexArray = NDArray[np.complex128]

HYPERBOLIC = 1e-6
"""How far a multiplier must be from the unit circle: a double one at 1 scatters by the root of the round-off."""


@dataclass(frozen=True)
class LoopSpectrum:
    r"""The multipliers of a loop.

    Attributes:
        values: The multipliers, the largest first, then their reciprocals in the same order, shape (2m - 2,).
        pair_defect: The largest difference between the two computed values of a $\mu + 1/\mu$, relative to the largest.
        trivial_defect: How far the flow, H and the Casimirs are from being kept by D: the larger one of
            $|Df - f|/|f|$ and $|D^T\nabla C - \nabla C|/|\nabla C|$, relative to $|D|$.
        expanding: The matrix M, shape (2m - 2, 2m - 2).
        basis: The columns Q, shape (N, 2m - 2).
    """

    values: ComplexArray
    pair_defect: float
    trivial_defect: float
    expanding: Array
    basis: Array


def transversal_basis(gradients: Array, rate: Array) -> Array:
    """An orthonormal basis of the vectors that are orthogonal to the gradients and to the flow, shape (N, k)."""
    rows = np.vstack([gradients, rate])
    rows = rows / linear.norm(rows, axis=1, keepdims=True)
    left = linear.svd(rows.T, full_matrices=True)[0]
    return left[:, len(rows) :]


def loop_spectrum(forwards: Array, backwards: Array, gradients: Array, rate: Array) -> LoopSpectrum:
    """The multipliers of a loop.

    Args:
        forwards: The derivative of the loop, shape (N, N).
        backwards: That of the loop run backwards.
        gradients: The gradients of H and the Casimirs where it begins, shape (function, N).
        rate: The vector field there, shape (N,).
    """
    basis = transversal_basis(gradients, rate)
    forth, back = (
        linear.matmul(linear.matmul(basis.T, forwards), basis),
        linear.matmul(linear.matmul(basis.T, backwards), basis),
    )
    size = float(linear.norm(forwards, 2))
    trivial = max(
        float(linear.norm(linear.matmul(forwards, rate) - rate) / linear.norm(rate)),
        float(
            (linear.norm(linear.matmul(gradients, forwards) - gradients, axis=1) / linear.norm(gradients, axis=1)).max()
        ),
    )
    values, defect = _paired(linear.eigvals(forth + back).astype(np.complex128))
    return LoopSpectrum(values, defect, trivial / size, forth, basis)


def _paired(sums: ComplexArray) -> tuple[ComplexArray, float]:
    r"""Multipliers from the eigenvalues $\mu + 1/\mu$, which are double, and how far they are from being so."""
    left = sorted(sums.tolist(), key=lambda w: (-abs(w), w.imag))
    large: list[complex] = []
    defect, scale = 0.0, max((abs(w) for w in left), default=1.0)
    while left:
        one = left.pop(0)
        k = min(range(len(left)), key=lambda k: abs(left[k] - one))
        other = left.pop(k)
        defect = max(defect, abs(one - other) / scale)
        w = (one + other) / 2
        root = complex(np.sqrt(complex(w * w - 4)))
        large.append(max((w + root) / 2, (w - root) / 2, key=lambda m: (abs(m), m.imag)))
    large.sort(key=lambda m: (-round(abs(m), 9), -m.imag))
    return np.array([*large, *(1 / m for m in large)], dtype=np.complex128), defect


def kind_of(values: ComplexArray) -> str:
    """What multipliers say of a loop: "hyperbolic", "elliptic", "mixed" or, where there is none, "neutral"."""
    if not values.size:
        return "neutral"
    off = np.abs(np.abs(values) - 1) > HYPERBOLIC
    return "hyperbolic" if off.all() else "mixed" if off.any() else "elliptic"
