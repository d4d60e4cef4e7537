"""Systems that users type: what liepoisson is given, the same equations for heyoka, starts, and how long to run.

liepoisson gets a bracket and the text of a Hamiltonian.  heyoka gets the equations, written by hand with as few
products, quotients and functions as we could find, each of them formed once, and with squares as powers, as its own
models have them; `Dual` continues them to a tangent vector.
That the two are the same is tested at random states (tests/test_benchmarks.py).  Needs numpy only: the peer's
environment has no liepoisson.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

import problem

if TYPE_CHECKING:
    from problem import Array

    Vector = list[Any]


@dataclass(frozen=True)
class Problem:
    """One system.

    Attributes:
        name: What the tables call it.
        n: Dimension of the state.
        typed: The system of liepoisson, from the package and what a user types.
        rates: x' from x and a namespace with exp, sin, cos and sqrt.
        starts: That many states at time 0, shape (n_starts, n).
        t_accuracy: Where errors are measured.
        t_end: End of the timed runs of many orbits.
        t_one: End of those of one orbit, after some 10,000 steps at 1e-13.
    """

    name: str
    n: int
    typed: Callable[[Any], Any]
    rates: Callable[[Vector, Any], Vector]
    starts: Callable[[np.random.Generator, int], Array]
    t_accuracy: float
    t_end: float
    t_one: float


def starts(one: Problem, n_starts: int = problem.N_STARTS) -> Array:
    """States at time 0 with one unit tangent vector each, shape (n_starts, 2 n)."""
    rng = np.random.default_rng(problem.SEED)
    x0, v = one.starts(rng, n_starts), rng.standard_normal((n_starts, one.n))
    return np.concatenate([x0, v / np.linalg.norm(v, axis=1, keepdims=True)], axis=1)


class Dual:
    """A quantity and its derivative along the tangent vector, so that v' = Df(x) v shares products with x' = f(x)."""

    functions: Any
    """The namespace with the functions of plain quantities."""

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

    def __pow__(self, exponent: float) -> Dual:
        if exponent == 2:
            return Dual(self.value**2, 2.0 * (self.value * self.slope))
        power = self.value**exponent
        return Dual(power, exponent * (power * self.slope / self.value))

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: Any) -> Dual:
        return -self + other

    def __rtruediv__(self, other: float) -> Dual:
        quotient = other / self.value
        return Dual(quotient, -quotient * self.slope / self.value)

    @staticmethod
    def exp(x: Dual) -> Dual:
        power = Dual.functions.exp(x.value)
        return Dual(power, power * x.slope)

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
    return sum(terms[1:], terms[0])


def _in_box(*ranges: tuple[float, float]) -> Callable[[np.random.Generator, int], Array]:
    """States uniform in a box."""
    low, high = np.transpose(ranges)
    return lambda rng, n_starts: rng.uniform(low, high, (n_starts, len(ranges)))


def _gaussian(n: int) -> Callable[[np.random.Generator, int], Array]:
    return lambda rng, n_starts: rng.standard_normal((n_starts, n))


def _typed_pendulum(lp: Any) -> Any:
    """Two unit masses on unit rods in unit gravity; angles from the vertical."""
    return lp.System(
        lp.canonical(names=["theta1", "theta2"]),
        "(p_theta1^2 + 2*p_theta2^2 - 2*p_theta1*p_theta2*cos(theta1 - theta2))/(2*(1 + sin(theta1 - theta2)^2))"
        " - 2*cos(theta1) - cos(theta2)",
    )


def _pendulum(x: Vector, f: Any) -> Vector:
    q1, q2, p1, p2 = x
    s, c = f.sin(q1 - q2), f.cos(q1 - q2)
    inverse = 1.0 / (1.0 + s**2)
    v1, v2 = (p1 - p2 * c) * inverse, (2.0 * p2 - p1 * c) * inverse
    coupling = v1 * v2 * s  # -dT/dq1 = dT/dq2
    return [v1, v2, -2.0 * f.sin(q1) - coupling, coupling - f.sin(q2)]


def _typed_canonical_top(lp: Any) -> Any:
    """The twisted Lagrange top in Euler angles (epsilon = 1), Thiffeault and Morrison (2001), gauge (e3, e1)."""
    return lp.System(
        lp.canonical(names=["theta", "phi", "psi"]),
        "p_theta^2/2 + (p_phi - p_psi*cos(theta))^2/(2*sin(theta)^2) + p_psi^2"
        " + (cos(theta)/2 + sqrt(8 - 2*p_phi)*sin(theta)*sin(phi))/16",
    )


def _canonical_top(x: Vector, f: Any) -> Vector:
    t, p, _, p_t, p_p, p_s = x
    s, c, sp = f.sin(t), f.cos(t), f.sin(p)
    r = f.sqrt(8.0 - 2.0 * p_p)
    u = (p_p - p_s * c) / s
    v = u / s
    lifted = r * sp
    force = s * 0.03125 - c * lifted * 0.0625 - u * (p_s - v * c)
    return [p_t, v - s * sp / r * 0.0625, 2.0 * p_s - v * c, force, r * s * f.cos(p) * -0.0625, 0.0 * p_s]


def _typed_henon_heiles(lp: Any) -> Any:
    return lp.System(lp.canonical(names=["x", "y"]), "(p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3")


def _henon_heiles(x: Vector, _: Any) -> Vector:
    q1, q2, p1, p2 = x
    return [p1, p2, -q1 - 2.0 * (q1 * q2), q2**2 - q1**2 - q2]


def _typed_spring(lp: Any) -> Any:
    """A unit mass on a spring of stiffness 4 and natural length 3/4 in unit gravity: the resonance 1:2."""
    return lp.System(
        lp.canonical(names=["x", "y"]),
        "(p_x^2 + p_y^2)/2 + k*(sqrt(x^2 + y^2) - length)^2/2 + y",
        {"k": 4, "length": "3/4"},
    )


def _spring(x: Vector, _: Any) -> Vector:
    q1, q2, p1, p2 = x
    pull = 3.0 * (q1**2 + q2**2) ** -0.5 - 4.0
    return [p1, p2, q1 * pull, q2 * pull - 1.0]


def _typed_toda(lp: Any) -> Any:
    springs = " + ".join(f"exp(q{k} - q{k % 8 + 1})" for k in range(1, 9))
    return lp.System(lp.canonical(8), f"dot(p, p)/2 + {springs}")


def _toda(x: Vector, f: Any) -> Vector:
    q, p = x[:8], x[8:]
    springs = [f.exp(q[k] - q[(k + 1) % 8]) for k in range(8)]
    return p + [springs[k - 1] - springs[k] for k in range(8)]


def _typed_three_bodies(lp: Any) -> Any:
    """The planar circular problem in rotating coordinates, masses 63/64 and 1/64."""
    return lp.System(
        lp.canonical(names=["x", "y"]),
        "(p_x^2 + p_y^2)/2 + y*p_x - x*p_y - (1 - mu)/sqrt((x + mu)^2 + y^2) - mu/sqrt((x + mu - 1)^2 + y^2)",
        {"mu": "1/64"},
    )


def _three_bodies(x: Vector, _: Any) -> Vector:
    mu = 1.0 / 64.0
    q1, q2, p1, p2 = x
    from_first, from_second, square = q1 + mu, q1 + (mu - 1.0), q2**2
    first = (1.0 - mu) * (from_first**2 + square) ** -1.5
    second = mu * (from_second**2 + square) ** -1.5
    return [p1 + q2, p2 - q1, p2 - first * from_first - second * from_second, -p1 - q2 * (first + second)]


def _three_body_starts(rng: np.random.Generator, n_starts: int) -> Array:
    """Nearly circular orbits about the large mass, at 0.3 to 0.6 of the distance of the small one."""
    r, angle, faster = rng.uniform([0.3, 0.0, 0.9], [0.6, 2.0 * np.pi, 1.1], (n_starts, 3)).T
    speed = faster * np.sqrt(63.0 / 64.0 / r)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([r * c - 1.0 / 64.0, r * s, -speed * s, speed * c], axis=1)


def _typed_atwood(lp: Any) -> Any:
    """The swinging Atwood's machine, masses 2 and 1 in unit gravity; the lighter one swings."""
    return lp.System(
        lp.canonical(names=["r", "theta"]),
        "p_r^2/(2*(M + m)) + p_theta^2/(2*m*r^2) + r*(M - m*cos(theta))",
        {"M": 2, "m": 1},
    )


def _atwood(x: Vector, f: Any) -> Vector:
    r, theta, p_r, p_theta = x
    speed = p_theta / r
    turning = speed / r
    return [p_r * (1.0 / 3.0), turning, speed * turning - 2.0 + f.cos(theta), -(r * f.sin(theta))]


PLANES = list(combinations(range(4), 2))


def _typed_manakov(lp: Any) -> Any:
    squares = " + ".join(f"M{i + 1}{j + 1}^2/(J{i + 1} + J{j + 1})" for i, j in PLANES)
    return lp.System((lp.so(4) @ lp.trivial()).rename("M"), f"({squares})/2", {"J": [1, 2, 3, 4]})


def _manakov(x: Vector, _: Any) -> Vector:
    """M' = [M, Omega] on so(4), Omega_ij = M_ij / (J_i + J_j), J = (1, 2, 3, 4)."""
    m = dict(zip(PLANES, x, strict=True))

    def product(i: int, k: int, j: int) -> Any:
        """M_ik M_kj with the sign of the transpositions, times 1/(J_k + J_j) - 1/(J_i + J_k)."""
        sign = (1 if i < k else -1) * (1 if k < j else -1)
        weight = sign * (Fraction(1, k + j + 2) - Fraction(1, i + k + 2))
        return float(weight) * (m[min(i, k), max(i, k)] * m[min(k, j), max(k, j)])

    return [_total([product(i, k, j) for k in range(4) if k not in (i, j)]) for i, j in PLANES]


MODES = sorted(
    ((n1, n2) for n1 in range(-2, 3) for n2 in range(-2, 3) if (n1, n2) > (0, 0)),
    key=lambda n: (n[0] ** 2 + n[1] ** 2, -n[0], -n[1]),
)
"""One of each pair n, -n of the modes of su(5), in the order of `lp.algebras.sine(5)`."""


def _typed_su5(lp: Any) -> Any:
    """Euler's equation of the ideal fluid truncated to su(5) (Zeitlin 1991), in the 24 coordinates of the modes."""
    names = [f"{part}{n1}{'m' * (n2 < 0)}{abs(n2)}" for n1, n2 in MODES for part in ("wc", "ws")]
    squares = [n1 * n1 + n2 * n2 for n1, n2 in MODES for _ in range(2)]
    energy = " + ".join(f"{name}^2/{square}" for name, square in zip(names, squares, strict=True))
    return lp.System((lp.algebras.sine(5) @ lp.trivial()).rename("w"), energy)


@cache
def _su5_terms() -> list[dict[tuple[int, int], float]]:
    """The coefficients of the products x_i x_j, i <= j, in each rate.

    w_n' = (5 / 2 pi) sum_k sin(2 pi (n x k) / 5) w_(n+k) w_(-k) / |k|^2, x the real and imaginary parts of the w_n.
    """
    place = {n: 2 * k for k, n in enumerate(MODES)}

    def mode(n1: int, n2: int) -> tuple[int, float]:
        """Where the real part is, the imaginary part coming next, and the sign of the latter."""
        n = ((n1 + 2) % 5 - 2, (n2 + 2) % 5 - 2)
        return (place[n], 1.0) if n in place else (place[-n[0], -n[1]], -1.0)

    rates: list[dict[tuple[int, int], float]] = []
    for n1, n2 in MODES:
        real, imaginary = {}, {}
        for k1, k2 in [*MODES, *((-k1, -k2) for k1, k2 in MODES)]:
            cross = (n1 * k2 - n2 * k1) % 5
            if cross == 0:
                continue
            (a, s), (c, t) = mode(n1 + k1, n2 + k2), mode(-k1, -k2)
            weight = float(5.0 / (2.0 * np.pi) * np.sin(2.0 * np.pi * cross / 5.0)) / (k1 * k1 + k2 * k2)
            terms = (
                (real, a, c, 1.0),
                (real, a + 1, c + 1, -s * t),
                (imaginary, a, c + 1, t),
                (imaginary, a + 1, c, s),
            )
            for part, i, j, sign in terms:
                pair = (min(i, j), max(i, j))
                part[pair] = part.get(pair, 0.0) + sign * weight
        rates += [real, imaginary]
    return [{pair: weight for pair, weight in rate.items() if abs(weight) > 1e-13} for rate in rates]


def _su5(x: Vector, _: Any) -> Vector:
    products: dict[tuple[int, int], Any] = {}
    for rate in _su5_terms():
        products |= {(i, j): x[i] * x[j] for i, j in rate if (i, j) not in products}
    return [_total([weight * products[pair] for pair, weight in rate.items()]) for rate in _su5_terms()]


def _typed_twisted_top(lp: Any) -> Any:
    """The twisted Kovalevskaya top with its vectors in the order beta, alpha, l: so liepoisson sees no top in it.

    The same algebra in another order of its basis, e_l being the unit and e_alpha e_alpha = e_beta.
    """
    products = {(0, 2): {0: 1}, (1, 2): {1: 1}, (2, 2): {2: 1}, (1, 1): {0: 1}}
    extension = lp.Extension.from_products(3, products, field_names=("beta", "alpha", "l"))
    return lp.System(lp.so(3) @ extension, "l1^2/4 + l2^2/4 + l3^2/2 - alpha1")


def _twisted_top(x: Vector, _: Any) -> Vector:
    """As in `problem`, with all products merged that a diagonal inertia (2, 2, 1) lets merge, and a = -e1."""
    beta, alpha, (l1, l2, l3) = x[0:3], x[3:6], x[6:9]

    def spun(u: Vector) -> Vector:
        """u x omega, with omega = (l1/2, l2/2, l3)."""
        return [u[1] * l3 - 0.5 * (u[2] * l2), 0.5 * (u[2] * l1) - u[0] * l3, 0.5 * (u[0] * l2 - u[1] * l1)]

    d_alpha = spun(alpha)
    d_l = [0.5 * (l2 * l3), -0.5 * (l3 * l1) - alpha[2], alpha[1]]
    return [*spun(beta), d_alpha[0], d_alpha[1] - beta[2], d_alpha[2] + beta[1], *d_l]


def _unit_vectors(rng: np.random.Generator, n_starts: int) -> Array:
    v = rng.standard_normal((n_starts, 3, 3))
    return (v / np.linalg.norm(v, axis=2, keepdims=True)).reshape(n_starts, 9)


_PENDULUM = _in_box(*[(-0.7, 0.7)] * 4)
_FAST_TOPS = _in_box((1.2, 1.9), (0.0, 6.28), (0.0, 6.28), (-0.3, 0.3), (-0.5, 0.5), (5.0, 6.0))
"""They stay away from the poles sin(theta) = 0."""
_BOUND_STARS = _in_box((-0.3, 0.3), (-0.3, 0.3), (-0.2, 0.2), (-0.2, 0.2))
"""All below the energy of escape, 1/6."""
_SPRINGS = _in_box((-0.5, 0.5), (-1.3, -0.7), (-0.3, 0.3), (-0.3, 0.3))
_CHAINS = _in_box(*[(-1.0, 1.0)] * 16)
_MACHINES = _in_box((0.8, 1.2), (-0.5, 0.5), (-0.3, 0.3), (0.5, 1.0))

PROBLEMS = {
    "double-pendulum": Problem("double pendulum", 4, _typed_pendulum, _pendulum, _PENDULUM, 10, 100, 2000),
    "canonical-top": Problem("canonical top", 6, _typed_canonical_top, _canonical_top, _FAST_TOPS, 10, 20, 1000),
    "henon-heiles": Problem("Hénon–Heiles", 4, _typed_henon_heiles, _henon_heiles, _BOUND_STARS, 20, 200, 10_000),
    "spring-pendulum": Problem("spring pendulum", 4, _typed_spring, _spring, _SPRINGS, 10, 100, 4000),
    "toda-8": Problem("Toda chain of 8", 16, _typed_toda, _toda, _CHAINS, 10, 50, 2000),
    "three-bodies": Problem(
        "restricted three bodies", 4, _typed_three_bodies, _three_bodies, _three_body_starts, 10, 50, 1000
    ),
    "swinging-atwood": Problem("swinging Atwood's machine", 4, _typed_atwood, _atwood, _MACHINES, 10, 100, 1500),
    "manakov-so4": Problem("Manakov top on so(4)", 6, _typed_manakov, _manakov, _gaussian(6), 20, 200, 20_000),
    "euler-su5": Problem("Euler's equation on su(5)", 24, _typed_su5, _su5, _gaussian(24), 2, 20, 500),
    "twisted-top": Problem("twisted top as typed", 9, _typed_twisted_top, _twisted_top, _unit_vectors, 20, 200, 4000),
}

LEVELS = (1e-13, 1e-8)
PREFIX = "general-"
ROWS = {
    f"{PREFIX}{system}-{problem.shown(level)}{'' if tangent else '-one'}": (system, tangent, level)
    for system in PROBLEMS
    for tangent in (True, False)
    for level in LEVELS
}
"""The rows by their names, `general-double-pendulum-1e-13-one`: system, whether many orbits run, each with a tangent
vector, or one orbit of the state alone, and the level of its errors."""
