"""Boxes around the eigenvalues of all real matrices of a matrix of balls, by Arb."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from flint import acb_mat, arb_mat

from liepoisson.errors import EnclosureError
from liepoisson.inputs.arrays import Array
from liepoisson.proofs.box import Box
from liepoisson.proofs.rigorous import down, up

if TYPE_CHECKING:
    from numpy.typing import NDArray


def eigenvalue_boxes(matrix: arb_mat) -> tuple[Box, Box, NDArray[np.bool_]]:
    """Boxes around the real and imaginary parts, and whether a box contains one eigenvalue only.

    Raises:
        EnclosureError: Arb has no enclosure.
    """
    n = matrix.nrows()
    if not n:
        return Box(np.zeros(0), np.zeros(0)), Box(np.zeros(0), np.zeros(0)), np.zeros(0, dtype=bool)
    try:
        try:
            found = acb_mat(matrix).eig(multiple=True)
        except ValueError:  # of multiple eigenvalues, where the matrix has many zeros: not in other coordinates
            found = acb_mat(_in_other_coordinates(matrix)).eig(multiple=True)
    except ValueError as error:
        raise EnclosureError(f"eigenvalues: wanted their enclosures; {error}; try a smaller set") from error
    low, high = (np.array([(bound(value.real), bound(value.imag)) for value in found], float) for bound in (down, up))
    simple = np.array([not any(_overlap(low, high, i, j) for j in range(n) if j != i) for i in range(n)])
    conjugate_low, conjugate_high = low.copy(), high.copy()
    conjugate_low[:, 1], conjugate_high[:, 1] = -high[:, 1], -low[:, 1]
    for i in np.nonzero(simple)[0].tolist():
        others = [j for j in range(n) if j != i]
        meets = [bool(np.all(conjugate_low[i] <= high[j]) and np.all(low[j] <= conjugate_high[i])) for j in others]
        if low[i, 1] <= 0 <= high[i, 1] and not any(meets):
            low[i, 1] = high[i, 1] = 0.0  # the conjugate of a single eigenvalue is in no other box: it is real
    order = np.lexsort((low[:, 1], low[:, 0]))[::-1]
    low, high = low[order], high[order]
    return Box(low[:, 0], high[:, 0]), Box(low[:, 1], high[:, 1]), simple[order]


def _in_other_coordinates(matrix: arb_mat) -> arb_mat:
    """A similar matrix, by whole numbers of determinant 1."""
    n = matrix.nrows()
    below = {(i, j): (i * j + i + j) % 3 - 1 for i in range(n) for j in range(i)}
    lower = arb_mat(n, n, [1 if i == j else below.get((i, j), 0) for i in range(n) for j in range(n)])
    T = lower * lower.transpose()
    return T.inv() * matrix * T


def _overlap(low: Array, high: Array, i: int, j: int) -> bool:
    return bool(np.all(low[i] <= high[j]) and np.all(low[j] <= high[i]))
