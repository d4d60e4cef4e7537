"""How accurate is either side?  A third answer, in 80-bit arithmetic, that shares no code and no SIMD with either.

A plain Taylor series of the equations as they are printed, at a fixed step, in `numpy.longdouble`, over all starts at
once.  With omega = l / I,

    l' = l x omega + alpha x a + beta x b,   alpha' = alpha x omega + epsilon beta x a,   beta' = beta x omega,

and the tangent equations are the derivative of these; the k-th coefficient of a product is a sum of products of
coefficients.  The arithmetic has epsilon 1.1e-19, so the reference at t = 20 is good to about 1e-17 in the median,
10,000 times better than the tightest level compared; `self_error` measures that by halving the step.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import problem

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from problem import Array

    Extended = NDArray[np.longdouble]

ORDER = 26
STEP = 0.1
"""Order 26 and 34 agree to the last bit at this step: what is left is round-off."""

PAIRS = ((1, 2), (2, 0), (0, 1))


def _cross_coefficient(u: Extended, v: Extended, k: int) -> Extended:
    """Coefficient k of the series of u x v; u and v have shape (order + 1, 3, n), the result (3, n)."""
    left, right = u[: k + 1], v[k::-1]
    return np.stack([(left[:, i] * right[:, j] - left[:, j] * right[:, i]).sum(axis=0) for i, j in PAIRS])


def _cross_constant(u: Extended, c: Extended) -> Extended:
    """u x c for u of shape (3, n) and a constant vector c of shape (3,)."""
    return np.stack([u[i] * c[j] - u[j] * c[i] for i, j in PAIRS])


def _step(y: Extended, h: np.longdouble) -> Extended:
    """Advance y = (l, alpha, beta, dl, dalpha, dbeta), of shape (6, 3, n), by one step h."""
    a, b, inertia = (np.array(c, dtype=np.longdouble) for c in (problem.A, problem.B, problem.INERTIA))
    series = np.zeros((ORDER + 1, *y.shape), dtype=np.longdouble)
    omega = np.zeros((ORDER + 1, 2, *y.shape[1:]), dtype=np.longdouble)
    series[0] = y
    for k in range(ORDER):
        omega[k] = series[k, (0, 3)] / inertia[:, None]
        w, dw = omega[:, 0], omega[:, 1]
        rate = np.empty_like(y)
        for m in range(3):
            rate[m] = _cross_coefficient(series[:, m], w, k)
            rate[m + 3] = _cross_coefficient(series[:, m + 3], w, k) + _cross_coefficient(series[:, m], dw, k)
        for l, alpha, beta in ((0, 1, 2), (3, 4, 5)):
            rate[l] += _cross_constant(series[k, alpha], a) + _cross_constant(series[k, beta], b)
            rate[alpha] += problem.EPSILON * _cross_constant(series[k, beta], a)
        series[k + 1] = rate / (k + 1)
    value = series[ORDER]
    for coefficient in series[ORDER - 1 :: -1]:
        value = value * h + coefficient
    return value


def flow(x0: Array, tangents: Array, t_end: float, step: float = STEP) -> Extended:
    """States and tangent vectors at `t_end`, shape (n, 18), from those at time 0, of shape (n, 9) each.

    Raises:
        RuntimeError: `numpy.longdouble` is no wider than a double on this machine.
    """
    if np.finfo(np.longdouble).eps > 1e-18:
        raise RuntimeError("the reference needs an extended numpy.longdouble; x86-64 Linux has one")
    n_steps = round(t_end / step)
    y = np.concatenate([x0, tangents], axis=1).astype(np.longdouble).T.reshape(6, 3, len(x0))
    for _ in range(n_steps):
        y = _step(y, np.longdouble(t_end) / n_steps)
    return y.reshape(18, len(x0)).T


def self_error(x0: Array, tangents: Array, t_end: float, n: int = 32) -> float:
    """Median over the first `n` starts of the relative change of state and tangent vector when the step is halved."""
    coarse, fine = (flow(x0[:n], tangents[:n], t_end, step) for step in (STEP, STEP / 2))
    return float(np.median(np.asarray(np.linalg.norm(coarse - fine, axis=1) / np.linalg.norm(fine, axis=1))))


def cached_flow(x0: Array, tangents: Array, t_end: float, folder: Path) -> tuple[Extended, float]:
    """`flow` and `self_error`, kept in `folder` for the next run with the same question (they take half a minute)."""
    path = folder / "reference.npz"
    question = np.concatenate([x0.ravel(), tangents.ravel(), [t_end, ORDER, STEP]])
    if path.exists():
        with np.load(path) as kept:
            if np.array_equal(kept["question"], question):
                return kept["answer"], float(kept["self_error"])
    answer, error = flow(x0, tangents, t_end), self_error(x0, tangents, t_end)
    np.savez(path, question=question, answer=answer, self_error=error)
    return answer, error
