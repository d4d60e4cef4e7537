"""The equations of the top with one tangent vector, written once for all peers: plain arithmetic on anything indexed.

With omega = l / I: l' = l x omega + alpha x a, alpha' = alpha x omega + epsilon beta x a, beta' = beta x omega for a
along the first axis and b = 0, and their derivative.  Numba compiles it, JAX and SymEngine trace it.
"""

from __future__ import annotations

from typing import Any

import problem

W1, W2, W3 = (1.0 / moment for moment in problem.INERTIA)
A1 = problem.A[0]
TWIST = problem.EPSILON * problem.A[0]

if problem.A[1:] != (0.0, 0.0) or problem.B != (0.0, 0.0, 0.0):
    raise ValueError("these equations leave out the terms with a2, a3 and b")


def rates(y: Any) -> Any:
    """Derivatives of (l, alpha, beta, dl, dalpha, dbeta), 18 numbers, as a tuple."""
    l1, l2, l3, p1, p2, p3, q1, q2, q3 = y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], y[8]
    m1, m2, m3, r1, r2, r3, s1, s2, s3 = y[9], y[10], y[11], y[12], y[13], y[14], y[15], y[16], y[17]
    o1, o2, o3 = W1 * l1, W2 * l2, W3 * l3
    d1, d2, d3 = W1 * m1, W2 * m2, W3 * m3
    return (
        (W3 - W2) * (l2 * l3),
        (W1 - W3) * (l3 * l1) + A1 * p3,
        (W2 - W1) * (l1 * l2) - A1 * p2,
        p2 * o3 - p3 * o2,
        p3 * o1 - p1 * o3 + TWIST * q3,
        p1 * o2 - p2 * o1 - TWIST * q2,
        q2 * o3 - q3 * o2,
        q3 * o1 - q1 * o3,
        q1 * o2 - q2 * o1,
        (W3 - W2) * (m2 * l3 + l2 * m3),
        (W1 - W3) * (m3 * l1 + l3 * m1) + A1 * r3,
        (W2 - W1) * (m1 * l2 + l1 * m2) - A1 * r2,
        r2 * o3 - r3 * o2 + p2 * d3 - p3 * d2,
        r3 * o1 - r1 * o3 + p3 * d1 - p1 * d3 + TWIST * s3,
        r1 * o2 - r2 * o1 + p1 * d2 - p2 * d1 - TWIST * s2,
        s2 * o3 - s3 * o2 + q2 * d3 - q3 * d2,
        s3 * o1 - s1 * o3 + q3 * d1 - q1 * d3,
        s1 * o2 - s2 * o1 + q1 * d2 - q2 * d1,
    )
