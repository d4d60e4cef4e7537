"""Fields without a kernel of their own: equations that both sides are given, starts, and how long to run.

Each system is written once, in terms of `+ - * /` and of the functions of a namespace: `heyoka`, `sympy` or numpy in
80-bit arithmetic.  So both sides, and the reference, have the same formulas with the same shared subexpressions.  Needs
numpy only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

import problem

if TYPE_CHECKING:
    from problem import Array

    Vector = list[Any]

PAIRS = ((1, 2), (2, 0), (0, 1))


@dataclass(frozen=True)
class Problem:
    """One system.

    Attributes:
        name: What the table calls it.
        n: Dimension of the state.
        rates: x' from x and a namespace with sin, cos and sqrt.
        starts: States at time 0, shape (n_starts, n).
        t_end: End of the timed runs.
        t_accuracy: Where errors are measured.
        quadratic: Whether the right-hand side has degree two, so that liepoisson takes it as a quadratic field.
    """

    name: str
    n: int
    rates: Callable[[Vector, Any], Vector]
    starts: Callable[[np.random.Generator], Array]
    t_end: float
    t_accuracy: float
    quadratic: bool


N_STARTS = 512


def starts(one: Problem) -> Array:
    """States at time 0 with one unit tangent vector each, shape (N_STARTS, 2 n)."""
    rng = np.random.default_rng(problem.SEED)
    x0, v = one.starts(rng), rng.standard_normal((N_STARTS, one.n))
    return np.concatenate([x0, v / np.linalg.norm(v, axis=1, keepdims=True)], axis=1)


class Dual:
    """A quantity and its derivative along the tangent vector, so that v' = Df(x) v shares products with x' = f(x)."""

    functions: Any
    """The namespace with sin, cos and sqrt of plain quantities."""

    def __init__(self, value: Any, slope: Any) -> None:
        self.value, self.slope = value, slope

    def __add__(self, other: Any) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value + other, self.slope)
        return Dual(self.value + other.value, self.slope + other.slope)

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.slope)

    def __sub__(self, other: Any) -> Dual:
        return self + -other

    def __mul__(self, other: Any) -> Dual:
        if not isinstance(other, Dual):
            return Dual(other * self.value, other * self.slope)
        return Dual(self.value * other.value, self.value * other.slope + self.slope * other.value)

    def __truediv__(self, other: Dual) -> Dual:
        quotient = self.value / other.value
        return Dual(quotient, (self.slope - quotient * other.slope) / other.value)

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: Any) -> Dual:
        return -self + other

    def __rtruediv__(self, other: float) -> Dual:
        quotient = other / self.value
        return Dual(quotient, -quotient * self.slope / self.value)

    @staticmethod
    def sin(x: Dual) -> Dual:
        return Dual(Dual.functions.sin(x.value), Dual.functions.cos(x.value) * x.slope)

    @staticmethod
    def cos(x: Dual) -> Dual:
        return Dual(Dual.functions.cos(x.value), -Dual.functions.sin(x.value) * x.slope)

    @staticmethod
    def sqrt(x: Dual) -> Dual:
        root = Dual.functions.sqrt(x.value)
        return Dual(root, 0.5 * x.slope / root)


def rates_with_tangent(one: Problem, x: Vector, v: Vector, f: Any) -> Vector:
    """x' and v' = Df(x) v."""
    Dual.functions = f
    rates = one.rates([Dual(*pair) for pair in zip(x, v, strict=True)], Dual)
    return [rate.value for rate in rates] + [rate.slope for rate in rates]


def _total(terms: Vector) -> Any:
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total


def _twisted_top(x: Vector, _: Any) -> Vector:
    """As in `problem`, with all products merged that a diagonal inertia lets merge."""
    l, alpha, beta = x[0:3], x[3:6], x[6:9]
    w = [1.0 / moment for moment in problem.INERTIA]
    a, b = problem.A, problem.B
    twist = [problem.EPSILON * c for c in a]

    def cross(u: Vector, c: Any, i: int, j: int) -> Vector:
        """The terms of u_i c_j - u_j c_i whose constant is not zero."""
        return [*([u[i] * c[j]] if c[j] else []), *([u[j] * -c[i]] if c[i] else [])]

    def spun(u: Vector, i: int, j: int) -> Vector:
        return [w[j] * (u[i] * l[j]), -w[i] * (u[j] * l[i])]

    kinetic = [[(w[j] - w[i]) * (l[i] * l[j])] for i, j in PAIRS]
    d_l = [_total(kinetic[k] + cross(alpha, a, i, j) + cross(beta, b, i, j)) for k, (i, j) in enumerate(PAIRS)]
    d_alpha = [_total(spun(alpha, i, j) + cross(beta, twist, i, j)) for i, j in PAIRS]
    return d_l + d_alpha + [_total(spun(beta, i, j)) for i, j in PAIRS]


def _double_pendulum(x: Vector, f: Any) -> Vector:
    """Two unit masses on unit rods in unit gravity; angles from the vertical and their canonical momenta.

    H = [p1^2 + 2 p2^2 - 2 p1 p2 cos D] / (2 (1 + sin^2 D)) - 2 cos q1 - cos q2 with D = q1 - q2.
    """
    q1, q2, p1, p2 = x
    s, c = f.sin(q1 - q2), f.cos(q1 - q2)
    inverse = 1.0 / (1.0 + s * s)
    v1, v2 = (p1 - p2 * c) * inverse, (2.0 * p2 - p1 * c) * inverse
    coupling = v1 * v2 * s  # -dT/dq1 = dT/dq2
    return [v1, v2, -2.0 * f.sin(q1) - coupling, coupling - f.sin(q2)]


I1, I3, A3, W, ETA = 1.0, 0.5, 0.05, 1.0, 8.0
V = 0.5


def _canonical_top(x: Vector, f: Any) -> Vector:
    """The twisted Lagrange top in Euler angles (epsilon = 1), Thiffeault and Morrison (2001), gauge (e3, e1).

    H = p_t^2/(2 I1) + u^2/(2 I1) + p_s^2/(2 I3) + a3 (v cos t + r sin t sin p), u = (p_p - p_s cos t)/sin t,
    r^2 = eta - 2 w p_p.
    """
    t, p, _, p_t, p_p, p_s = x
    s, c, sp, cp = f.sin(t), f.cos(t), f.sin(p), f.cos(p)
    r = f.sqrt(ETA - 2.0 * W * p_p)
    u = (p_p - p_s * c) / s
    rate = u / s * (1.0 / I1)
    return [
        p_t * (1.0 / I1),
        rate - A3 * W * s * sp / r,
        p_s * (1.0 / I3) - rate * c,
        A3 * (V * s - r * c * sp) - u * (p_s - u * c / s) * (1.0 / I1),
        -A3 * r * s * cp,
        0.0 * p_s,
    ]


MOMENTS = (1.0, 2.0, 3.0, 4.0)
PLANES = [(i, j) for i in range(4) for j in range(i + 1, 4)]


def _manakov(x: Vector, _: Any) -> Vector:
    """M' = [M, Omega] on so(4), Omega_ij = M_ij / (J_i + J_j)."""
    m = dict(zip(PLANES, x, strict=True))

    def product(i: int, k: int, j: int) -> Any:
        """M_ik M_kj with the sign of the transpositions, times (1/(J_k + J_j) - 1/(J_i + J_k))."""
        sign = (1.0 if i < k else -1.0) * (1.0 if k < j else -1.0)
        weight = 1.0 / (MOMENTS[k] + MOMENTS[j]) - 1.0 / (MOMENTS[i] + MOMENTS[k])
        return sign * weight * (m[min(i, k), max(i, k)] * m[min(k, j), max(k, j)])

    return [_total([product(i, k, j) for k in range(4) if k not in (i, j)]) for i, j in PLANES]


MODES = [(n1, n2) for n1 in range(-2, 3) for n2 in range(-2, 3) if (n1, n2) > (0, 0)]
"""One of each pair n, -n of the modes of su(5)."""


def _su5(x: Vector, _: Any) -> Vector:
    """Euler's equation truncated to su(5) (Zeitlin 1991), real and imaginary parts of 12 modes.

    w_n' = (5 / 2 pi) sum_k sin(2 pi (n x k) / 5) w_(n+k) w_(-k) / |k|^2.
    """
    re = {n: x[2 * i] for i, n in enumerate(MODES)}
    im = {n: x[2 * i + 1] for i, n in enumerate(MODES)}

    def mode(n: tuple[int, int]) -> tuple[Any, Any, float]:
        """Real part, imaginary part, sign of the latter."""
        n = ((n[0] + 2) % 5 - 2, (n[1] + 2) % 5 - 2)
        return (re[n], im[n], 1.0) if n in re else (re[-n[0], -n[1]], im[-n[0], -n[1]], -1.0)

    rates: Vector = []
    for n in MODES:
        sums: list[dict[tuple[int, int], tuple[float, Any]]] = [{}, {}]
        for k in [*MODES, *((-k1, -k2) for k1, k2 in MODES)]:
            weight = 5.0 / (2.0 * np.pi) * np.sin(2.0 * np.pi * (n[0] * k[1] - n[1] * k[0]) / 5.0)
            m = (n[0] + k[0], n[1] + k[1])
            if m in ((0, 0), (5, 5)) or abs(weight) < 1e-12:
                continue
            (a, b, s), (c, d, t) = mode(m), mode((-k[0], -k[1]))
            weight = float(weight / (k[0] ** 2 + k[1] ** 2))
            for part, u, v, sign in ((0, a, c, 1.0), (0, b, d, -s * t), (1, a, d, t), (1, b, c, s)):
                key = _key(x, u, v)
                old = sums[part].get(key, (0.0, None))[0]
                sums[part][key] = (old + sign * weight, u * v)
        rates += [_total([c * uv for c, uv in one.values() if abs(c) > 1e-13]) for one in sums]
    return rates


def _key(x: Vector, u: Any, v: Any) -> tuple[int, int]:
    i, j = (next(k for k, y in enumerate(x) if y is w) for w in (u, v))
    return min(i, j), max(i, j)


def _unit_vectors(rng: np.random.Generator) -> Array:
    v = rng.standard_normal((N_STARTS, 3, 3))
    return (v / np.linalg.norm(v, axis=2, keepdims=True)).reshape(N_STARTS, 9)


def _pendulum_starts(rng: np.random.Generator) -> Array:
    return rng.uniform(-0.7, 0.7, (N_STARTS, 4))


def _euler_angle_starts(rng: np.random.Generator) -> Array:
    """Fast tops, which stay away from the poles sin t = 0."""
    low = np.array([1.2, 0.0, 0.0, -0.3, -0.5, 5.0])
    high = np.array([1.9, 6.28, 6.28, 0.3, 0.5, 6.0])
    return rng.uniform(low, high, (N_STARTS, 6))


def _gaussian(n: int) -> Callable[[np.random.Generator], Array]:
    return lambda rng: rng.standard_normal((N_STARTS, n))


PROBLEMS = {
    one.name: one
    for one in (
        Problem("twisted top", 9, _twisted_top, _unit_vectors, 200.0, 20.0, True),
        Problem("double pendulum", 4, _double_pendulum, _pendulum_starts, 100.0, 10.0, False),
        Problem("canonical top", 6, _canonical_top, _euler_angle_starts, 20.0, 10.0, False),
        Problem("Manakov top, so(4)", 6, _manakov, _gaussian(6), 200.0, 20.0, True),
        Problem("Euler's equation on su(5)", 24, _su5, _gaussian(24), 20.0, 2.0, True),
    )
}
