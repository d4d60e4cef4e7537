r"""Quaternions: rotation matrices, the shortest turn to an axis, for arrays and expressions alike.

$q = q_0 + q_1 i + q_2 j + q_3 k$ with $ij = k$; the rotation $v \mapsto q v\bar q$ is $R(q)$ for $|q| = 1$.

References: Marsden and Ratiu, Introduction to Mechanics and Symmetry, second edition (1999), chapter 9.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liepoisson.inputs.arrays import Array
from liepoisson.portable import elementary, linear


def rotation(q: Any) -> list[list[Any]]:
    """The rows of $R(q)$ times $|q|^2$, body to space components, from four components of any kind."""
    q0, q1, q2, q3 = q
    return [
        [q0**2 + q1**2 - q2**2 - q3**2, 2 * (q1 * q2 - q0 * q3), 2 * (q1 * q3 + q0 * q2)],
        [2 * (q1 * q2 + q0 * q3), q0**2 - q1**2 + q2**2 - q3**2, 2 * (q2 * q3 - q0 * q1)],
        [2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1), q0**2 - q1**2 - q2**2 + q3**2],
    ]


def body_rotation(q: Any) -> list[list[Any]]:
    """The rows of the transpose, space to body components, times |q|^2."""
    return [list(column) for column in zip(*rotation(q), strict=True)]


def shortest_turn(n: Array) -> Array:
    """Unit quaternions that take e3 in space to n in the body, shape (..., 4): the shortest turn.

    For n3 < 0 it comes after half a turn about the first axis, so that nothing cancels near n = -e3.

    Args:
        n: Unit vectors, shape (..., 3); NaN stays NaN.
    """
    n1, n2, n3 = components(n)
    zero = np.zeros_like(n3)
    above = np.stack([1 + n3, n2, -n1, zero], axis=-1)
    below = np.stack([n2, 1 - n3, zero, n1], axis=-1)
    q = np.where((n3 < 0)[..., None], below, above)
    return q / linear.norm(q, axis=-1, keepdims=True)


def turned(q: Array, angle: Array) -> Array:
    """The quaternions after a turn by -angle about the third axis in space."""
    q0, q1, q2, q3 = components(q)
    c, s = elementary.cos(angle / 2), elementary.sin(angle / 2)
    return np.stack([c * q0 + s * q3, c * q1 + s * q2, c * q2 - s * q1, c * q3 - s * q0], axis=-1)


def left_matrix(q: Any) -> list[list[Any]]:
    """The matrix G of the body angular momentum, l = G p/2."""
    q0, q1, q2, q3 = q
    return [[-q1, q0, q3, -q2], [-q2, -q3, q0, q1], [-q3, q2, -q1, q0]]


def components(vectors: Array) -> tuple[Array, ...]:
    """The components along the last axis."""
    return tuple(np.moveaxis(vectors, -1, 0))
