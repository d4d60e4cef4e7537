r"""The tops of the audit, their invariants and Poisson tensors in extended precision, and how errors are measured.

States $x = (\ell, \alpha, \beta)$, dimensionless.  Invariants are evaluated in `numpy.longdouble` (80 bits on x86-64)
from states in double precision, so what is shown is the error of the states and not that of the evaluation.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

import liepoisson as lp

Array: TypeAlias = NDArray[np.float64]
Extended: TypeAlias = NDArray[np.longdouble]

TOPS: dict[str, lp.Top] = {
    "twisted Kovalevskaya": lp.Top.twisted_kovalevskaya(),
    "general": lp.Top.twisted(inertia=(1.7, 1.1, 0.6), a=(0.4, -0.3, 0.9), b=(0.2, 0.5, -0.1)),
    "twisted Lagrange": lp.Top.twisted_lagrange(),
}
NONLINEAR = ("twisted Kovalevskaya", "general")
"""Two equal moments and none: splitting methods treat the two differently."""

EPSILON = float(np.finfo(np.float64).eps)


def starts(top: str, n: int) -> Array:
    """The first n members of the audit's ensemble, independent unit vectors, shape (n, 9)."""
    return lp.sample_states(TOPS[top], n, seed=0)


def first_tangents(n: int) -> Array:
    """One random tangent vector of length one for each member, shape (n, 9)."""
    vectors = np.random.default_rng(1).standard_normal((n, 9))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def integrate(
    top: lp.Top, x0: Array, times: Any, method: Any, *, tangents: Array | None = None, threads: int | None = None
) -> lp.results.Orbit:
    """`liepoisson.integrate` with the kernel for many trajectories, also for one."""
    return lp.integrate(top, x0, times=times, method=method, tangents=tangents, kernel="lanes", threads=threads)


def _parameters(top: lp.Top) -> tuple[Extended, Extended, Extended, np.longdouble]:
    field = top.field()
    assert isinstance(field, lp.fields.TopField)
    inertia, a, b = (np.array(u, dtype=np.longdouble) for u in (field.inertia, field.a, field.b))
    return inertia, a, b, np.longdouble(field.epsilon)


def invariants(top: lp.Top, x: NDArray[Any]) -> dict[str, Extended]:
    r"""$H$ and the Casimirs of states of shape (..., 9), and for the twisted Lagrange top its two further integrals.

    $H = \tfrac12\ell\cdot I^{-1}\ell + a\cdot\alpha + b\cdot\beta$, $C_1 = |\alpha|^2 + 2\epsilon\,\ell\cdot\beta$,
    $C_2 = \alpha\cdot\beta$, $C_3 = |\beta|^2$; $\ell_3$ and $P = \ell\cdot\alpha + \epsilon I_1 a_3\beta_3$
    [Thiffeault and Morrison 2001].
    """
    inertia, a, b, epsilon = _parameters(top)
    l, alpha, beta = np.split(x.astype(np.longdouble), 3, axis=-1)
    found = {
        "H": 0.5 * (l * l / inertia).sum(-1) + (alpha * a).sum(-1) + (beta * b).sum(-1),
        "C1": (alpha * alpha).sum(-1) + 2 * epsilon * (l * beta).sum(-1),
        "C2": (alpha * beta).sum(-1),
        "C3": (beta * beta).sum(-1),
    }
    if top is TOPS["twisted Lagrange"]:
        found["l3"] = l[..., 2]
        found["P"] = (l * alpha).sum(-1) + epsilon * inertia[0] * a[2] * beta[..., 2]
    return found


def scales(top: lp.Top, x0: NDArray[Any]) -> dict[str, Extended]:
    """The sizes that errors of invariants are relative to: the sums of the sizes of their terms at the start, (n,)."""
    inertia, a, b, epsilon = _parameters(top)
    l, alpha, beta = np.split(x0.astype(np.longdouble), 3, axis=-1)

    def size(u: Extended) -> Extended:
        return np.sqrt((u * u).sum(-1))

    kinetic = 0.5 * (l * l / inertia).sum(-1)
    return {
        "H": kinetic + size(a) * size(alpha) + size(b) * size(beta),
        "C1": size(alpha) ** 2 + 2 * abs(epsilon) * size(l) * size(beta),
        "C2": size(alpha) * size(beta),
        "C3": size(beta) ** 2,
        "l3": size(l),
        "P": size(l) * size(alpha) + abs(epsilon * inertia[0] * a[2]) * size(beta),
    }


def invariant_errors(top: lp.Top, x0: Array, states: Array) -> dict[str, Array]:
    """Signed errors of the invariants relative to their scales, shape (n, time) for states (n, time, 9)."""
    at_start, now, size = invariants(top, x0), invariants(top, states), scales(top, x0)
    return {
        name: np.asarray((value - at_start[name][:, None]) / size[name][:, None], dtype=np.float64)
        for name, value in now.items()
    }


def poisson_tensor(top: lp.Top, x: NDArray[Any]) -> Extended:
    r"""$J(x)$, shape (..., 9, 9), of the Leibniz bracket: $\dot x = J(x)\nabla H(x)$.

    Blocks $((\hat\ell, \hat\alpha, \hat\beta), (\hat\alpha, \epsilon\hat\beta, 0), (\hat\beta, 0, 0))$ with $\hat u v
    = u\times v$.
    """
    l, alpha, beta = (_hat(u) for u in np.split(x.astype(np.longdouble), 3, axis=-1))
    zero, epsilon = np.zeros_like(l), _parameters(top)[3]
    rows = ((l, alpha, beta), (alpha, epsilon * beta, zero), (beta, zero, zero))
    return np.concatenate([np.concatenate(row, axis=-1) for row in rows], axis=-2)


def _hat(u: Extended) -> Extended:
    zero = np.zeros_like(u[..., 0])
    rows = ((zero, -u[..., 2], u[..., 1]), (u[..., 2], zero, -u[..., 0]), (-u[..., 1], u[..., 0], zero))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def relative_error(x: Array, high: Array, low: Array) -> Array:
    """|x - (high + low)| / |high| over the last axis; the reference is the sum of two doubles."""
    return np.asarray(np.linalg.norm((x - high) - low, axis=-1) / np.linalg.norm(high, axis=-1))
