"""Diagrams of systems with separated equations against polynomials with double roots."""

import numpy as np
import pytest
from connected import pieces

import liepoisson as lp

# ---------------------------------------------------------------------------------------------- Manakov's top of so(4)

MANAKOV = lp.catalog.system("manakov-so4")
SQUARES = np.array([1.0, 4, 9, 16])  # of J


def manakov_numbers(states):
    """|M|^2, Pf, q1 and q0 of states (M12, M13, M14, M23, M24, M34): Q(t) = |M|^2 t^2 - q1 t + q0."""
    pairs = [(2, 3), (1, 3), (1, 2), (0, 3), (0, 2), (0, 1)]  # the other two indices
    sums, products = (np.array([f(SQUARES[[*pair]]) for pair in pairs]) for f in (np.sum, np.prod))
    m = np.moveaxis(states, -1, 0)
    pfaffian = m[0] * m[5] - m[1] * m[4] + m[2] * m[3]
    return (m**2).sum(0), pfaffian, np.tensordot(sums, m**2, 1), np.tensordot(products, m**2, 1)


def quartic(c, p, values):
    """D = Q^2 - 4 Pf^2 (a1 - t)...(a4 - t), the discriminant of the spectral curve, and Q, by values of (H, K).

    2 H = (151 |M|^2 + 5 q1 + q0)/1260 for J = 1, 2, 3, 4.
    """
    h, k = values
    q = np.array([c, -(2520 * h - 151 * c - k) / 5, k])
    return np.polysub(np.convolve(q, q), 4 * p**2 * np.poly(SQUARES)), q
