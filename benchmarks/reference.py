"""How accurate is either side?  A third answer, in 80-bit arithmetic, that shares no code with either.

A plain Taylor series of the equations as printed in the paper, fixed step, in `numpy.longdouble`, over all starts at
once.  With u = (l, alpha, beta), omega = l / I and ' the time derivative,

    l' = l x omega + alpha x a + beta x b,   alpha' = alpha x omega + epsilon beta x a,   beta' = beta x omega,

and the tangent equations are its derivative; the k-th coefficient of a product is a sum of products of coefficients.
Epsilon of the arithmetic is 1.1e-19, so even after the growth of errors up to t = 20 the reference is good to
about 1e-17, a thousand times better than the tightest level compared; `self_error` measures it by halving the step.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

import problem

Extended: TypeAlias = NDArray[np.longdouble]

ORDER = 26
STEP = 0.1


def _cross_coefficient(u: Extended, v: Extended, k: int) -> Extended:
    """Coefficient k of the series of u x v; u and v have shape (order + 1, 3, n), the result (3, n)."""
    left, right = u[: k + 1], v[k::-1]
    return np.stack(
        [(left[:, i] * right[:, j] - left[:, j] * right[:, i]).sum(axis=0) for i, j in ((1, 2), (2, 0), (0, 1))]
    )


def _cross_constant(u: Extended, c: Extended) -> Extended:
    """u x c for u of shape (3, n) and a constant vector c of shape (3,)."""
    return np.stack([u[i] * c[j] - u[j] * c[i] for i, j in ((1, 2), (2, 0), (0, 1))])


def _step(y: Extended, h: np.longdouble) -> Extended:
    """Advance state and tangent, y of shape (6, 3, n) = (l, alpha, beta, dl, dalpha, dbeta), by one step h."""
    a, b = np.array(problem.A, dtype=np.longdouble), np.array(problem.B, dtype=np.longdouble)
    inertia = np.array(problem.INERTIA, dtype=np.longdouble)[:, None]
    epsilon = np.longdouble(problem.EPSILON)
    series = np.zeros((ORDER + 1, *y.shape), dtype=np.longdouble)
    omega = np.zeros((ORDER + 1, 2, *y.shape[1:]), dtype=np.longdouble)
    series[0] = y
    for k in range(ORDER):
        omega[k] = series[k, (0, 3)] / inertia
        w, dw = omega[:, 0], omega[:, 1]
        rate = [_cross_coefficient(series[:, m], w, k) for m in range(3)]
        rate += [
            _cross_coefficient(series[:, m + 3], w, k) + _cross_coefficient(series[:, m], dw, k) for m in range(3)
        ]
        for first in (0, 3):
            rate[first] = rate[first] + _cross_constant(series[k, first + 1], a) + _cross_constant(series[k, first + 2], b)
            rate[first + 1] = rate[first + 1] + epsilon * _cross_constant(series[k, first + 2], a)
        series[k + 1] = np.stack(rate) / (k + 1)
    value = series[ORDER].copy()
    for k in range(ORDER - 1, -1, -1):
        value = value * h + series[k]
    return value


def flow(x0: problem.Array, tangent: problem.Array, t_end: float, step: float = STEP) -> tuple[Extended, Extended]:
    """State and tangent vector at `t_end`, each of shape (n, 9), from those at time 0.

    Raises:
        RuntimeError: `numpy.longdouble` is not wider than a double on this machine.
    """
    if np.finfo(np.longdouble).eps > 1e-18:
        raise RuntimeError("the reference needs an extended numpy.longdouble (x86-64 Linux has one)")
    n = len(x0)
    y = np.concatenate([x0, tangent], axis=1).astype(np.longdouble).T.reshape(6, 3, n)
    n_steps = round(t_end / step)
    h = np.longdouble(t_end) / n_steps
    for _ in range(n_steps):
        y = _step(y, h)
    z = y.reshape(18, n).T
    return z[:, :9], z[:, 9:]


def self_error(x0: problem.Array, tangent: problem.Array, t_end: float, n: int = 32) -> float:
    """Largest relative change, over the first `n` starts, of state or tangent when the step is halved."""
    coarse, fine = (flow(x0[:n], tangent[:n], t_end, step) for step in (STEP, STEP / 2))
    return max(float(np.max(problem.relative_error(c, f))) for c, f in zip(coarse, fine, strict=True))
