r"""How manifolds split, in floating-point numbers with errors: integrals of Melnikov, the splitting itself, angles.

The sleeping tops are those with $I_1 = a_3 = 1$; the middles of their homoclinic orbits are the states at t = 0 of the
solution that `homoclinic` verifies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

import liepoisson as lp
from liepoisson.studies.twisted_top.claims.evidence import Evidence

Array: TypeAlias = NDArray[np.float64]

EPSILON = 0.7
"""Of the twisted sleeping top."""
SIZES = (1e-2, 1e-3, 1e-4)
"""Of the change of inertia of which the splitting is measured."""
ENERGY, MOMENTUM = 1.0, 0.5
"""H and l.alpha of the orbits of Kovalevskaya's top that are homoclinic to a periodic one."""
_F = (
    "((l1^2 - l2^2)/4 + alpha1)^2 + (l1*l2/2 + alpha2)^2"
    " - (l1^2/4 + l2^2/4 + l3^2/2 - alpha1 - dot(l, alpha)^2/(2*dot(alpha, alpha)))^2"
)
"""K - (H - (l.alpha)^2/(2 |alpha|^2))^2."""
_HYPERBOLIC = 1e-6
"""A real part below this is zero."""
_N_PHASES, _N_MODES, _FLIGHT = 48, 10, 60.0
"""Orbits around a manifold, the harmonics of their angle that are fitted, and a time after which all are past the
middle."""
_PLACES, _LONGEST = 16, 40
"""Places of Gauss's rule in each unit of time, and how many of these an orbit is followed."""


@dataclass(frozen=True)
class Sleeping:
    """A sleeping top, of which lambda^3 + l3 lambda^2 + ... is (lambda - mu)(lambda^2 + nu lambda + height)."""

    inertia: float  # I3
    nu: float
    mu: float  # 0 for the ordinary top
    height: float

    @property
    def top(self) -> lp.Top:
        """Lagrange's top."""
        return lp.Top(inertia=(1, 1, self.inertia), a=(0, 0, 1), b=(0, 0, 0), epsilon=EPSILON)

    @property
    def rest(self) -> Array:
        """The equilibrium."""
        m, n = self.nu, self.height
        return np.array([0, 0, m - self.mu, 0, 0, n - self.mu * m, 0, 0, -self.mu * n / EPSILON])

    @property
    def kappa(self) -> float:
        """The rate of growth."""
        return float(np.sqrt(self.height - self.nu**2 / 4))

    @property
    def turning(self) -> float:
        """Omega."""
        return (self.nu - self.mu) * (1 / self.inertia - 0.5) - self.mu / 2

    def middle(self, psi: float) -> Array:
        """The middle of the homoclinic orbit on which (l1, l2) has this angle there."""
        turn, axis, kappa = np.array([np.cos(psi), np.sin(psi), 0]), np.array([0, 0, 1]), self.kappa
        m = 2 * kappa * turn + self.nu * axis
        n = self.nu * kappa * turn + (self.height - 2 * kappa**2) * axis
        return np.concatenate([m - self.mu * axis, n - self.mu * m, -self.mu * n / EPSILON])

    def by_inertia(self, psi: float) -> float:
        """The closed form for (l1^2 - l2^2)/2."""
        return float(-8 * np.pi * self.turning / np.sinh(np.pi * self.turning / self.kappa) * np.sin(2 * psi))

    def by_tilt(self, psi: float) -> float:
        """The closed form for alpha1."""
        decay = np.cosh(np.pi * self.turning / (2 * self.kappa))
        return float(2 * np.pi * (self.nu - self.mu) * (1 / self.inertia - 1) / decay * np.sin(psi))


ORDINARY, TWISTED, SYMMETRIC = Sleeping(0.6, 0.8, 0, 1), Sleeping(0.6, 0.8, 0.3, 1), Sleeping(1, 0.8, 0.3, 1)


@dataclass(frozen=True)
class Loop:
    """An elementary homoclinic orbit of the twisted Kovalevskaya top with epsilon = 1 (I3 = 1, a1 = -1)."""

    z0: float
    B: float
    sign: int = 1  # of m

    @property
    def top(self) -> lp.Top:
        """The top."""
        return lp.Top.kovalevskaya(epsilon=1)

    @property
    def rest(self) -> Array:
        """The saddle."""
        return np.array([0, 0, self.z0, -self.B / self.z0, 0, 0, 0, 0, self.B])

    def state(self, t: float) -> Array:
        """A state of the orbit."""
        z0, squared = self.z0, self.B / self.z0  # m^2 = a1 d
        m, k = self.sign * np.sqrt(squared), np.sqrt(squared - z0**2)
        below = z0 + m * np.cosh(k * t)
        z, rate = z0 + 2 * k**2 / below, -2 * k**3 * m * np.sinh(k * t) / below**2
        return np.array([0, 0, z, (z**2 - z0**2) / 2 - squared, rate, 0, 0, 0, self.B])

    def angles(self, flight: float) -> Array:
        """Those between both manifolds in the middle, across the flow, in rad, from linear ones at times +-flight."""
        top = self.top
        values, vectors = np.linalg.eig(top.functions.jacobian(self.rest))
        spaces: list[Array] = []
        for way in (1, -1):
            chosen = vectors[:, way * np.real(values) > _HYPERBOLIC]
            basis = np.linalg.svd(np.hstack([np.real(chosen), np.imag(chosen)]))[0][:, : chosen.shape[1]]
            run = lp.integrate(top, self.state(-way * flight), times=[0, way * flight], tangents=basis.T)
            spaces.append(np.linalg.qr(run.tangent[0, 1].T)[0])
        cosines = np.linalg.svd(spaces[0].T @ spaces[1])[1]
        return np.arccos(np.minimum(cosines[1:], 1))  # the first one is of the flow


def state_numbers(evidence: Evidence) -> None:
    """State what is computed, and keep the numbers that the answers quote."""
    for part in (_dimensions, _crossing, _integrals, _splitting, _around_periodic_orbits):
        evidence.data |= part(evidence)


def _dimensions(evidence: Evidence) -> dict[str, Any]:
    """State the dimensions of the manifolds of three equilibria, counted by eigenvalues."""
    cases = {
        "ordinary sleeping top": ORDINARY,
        "twisted sleeping top": TWISTED,
        "elementary orbits, z₀ = 1, B = 2": Loop(1, 2),
    }
    rows: list[tuple[object, ...]] = [("equilibrium", "leaf", "growing", "oscillations", "level", "excess")]
    excess: list[int] = []
    for name, case in cases.items():
        rates = lp.phase_space.equilibrium(case.top, case.rest).spectrum
        growing, oscillating = (rates.real > _HYPERBOLIC).sum(), (np.abs(rates.real) < _HYPERBOLIC).sum() // 2
        excess.append(2 * int(growing) - (len(rates) - 1))
        rows.append((name, len(rates), growing, oscillating, len(rates) - 1, excess[-1]))
    evidence.computation(
        "dimensions of a leaf, of the unstable manifold (and the stable one), of the oscillations and of a level of H; "
        "the excess of both manifolds over the level is 1 where they cross along single orbits in general, less where "
        "they do not meet in general",
        excess == [1, -1, 1],
        table=rows,
    )
    return {"excess_of_dimensions": excess}


def _crossing(evidence: Evidence) -> dict[str, Any]:
    """State that the manifolds are transversal along two elementary homoclinic orbits."""
    found: list[lp.results.Estimate] = []
    for sign in (1, -1):
        loop = Loop(1, 2, sign)
        late, early = (float(loop.angles(flight).min()) for flight in (12, 10))
        found.append(_known(late, abs(late - early)))
    evidence.computation(
        "twisted Kovalevskaya top, ε = 1, z₀ = 1, B = 2: least angle between the manifolds along the elementary orbits "
        "with m = √2 and m = −√2, across the flow, is not zero",
        all(one.value > 10 * one.standard_error for one in found),
        [f"{_text(one)} rad" for one in found],
    )
    return {"least_angles": [one.value for one in found], "least_angle": _text(min(found, key=lambda one: one.value))}


def _integrals(evidence: Evidence) -> dict[str, Any]:
    """State that integrals along the orbits are what the closed forms say."""
    rows: list[tuple[object, ...]] = [("sleeping top", "H₁", "ψ", "integral", "error", "closed form")]
    largest = 0.0
    borne_out = True
    for name, case in (("ordinary", ORDINARY), ("twisted", TWISTED), ("twisted, I₃ = 1", SYMMETRIC)):
        top = case.top
        origin = lp.phase_space.equilibrium(top, case.rest)
        for change, shown, psi, angle, formula in (
            ("(l1^2 - l2^2)/2", "(l₁² − l₂²)/2", np.pi / 4, "π/4", case.by_inertia),
            ("alpha1", "α₁", np.pi / 2, "π/2", case.by_tilt),
        ):
            found = lp.orbits.melnikov(top, case.middle(psi), change, origin=origin, integrals=["l3"])
            value, error, wanted = float(found.value[0, 0]), float(found.error[0, 0]), formula(psi)
            borne_out &= abs(value - wanted) <= error + 4 * np.finfo(float).eps * abs(wanted)
            largest = max(largest, error)
            rows.append((name, shown, angle, _digits(value), _power(error), _digits(wanted)))
    evidence.computation(
        f"the integral ∫{{l₃, H₁}} dt along the orbits agrees with the closed forms; ν = 0.8, A = 1, I₃ = 0.6 where "
        f"nothing else is said, μ = 0 (ordinary) or 0.3 (twisted, ε = {EPSILON})",
        bool(borne_out),
        table=rows,
    )
    return {"largest_error_of_integrals": largest, "integral_error": _power(largest)}


def _splitting(evidence: Evidence) -> dict[str, Any]:
    """State that l3 differs between the manifolds by the integral, up to the square of the change."""
    rows: list[tuple[object, ...]] = [("δ", "largest difference, in units of the largest M")]
    psi = 2 * np.pi * np.arange(8) / 8
    wanted = np.array([TWISTED.by_inertia(one) for one in psi])
    off: list[float] = []
    for size in SIZES:
        top = lp.Top(
            inertia=(1 / (1 + size), 1 / (1 - size), TWISTED.inertia), a=(0, 0, 1), b=(0, 0, 0), epsilon=EPSILON
        )
        unstable, stable = (_on_manifold(top, TWISTED.rest, way, psi) for way in (1, -1))
        off.append(float(np.abs((unstable - stable) / size - wanted).max() / np.abs(wanted).max()))
        rows.append((f"{size:g}", _power(off[-1])))
    texts = [_power(one) for one in off]
    power = float(np.log10(off[0] / off[-1]) / np.log10(SIZES[0] / SIZES[-1]))
    evidence.computation(
        "twisted sleeping top with 1/I₁ = 1 + δ, 1/I₂ = 1 − δ: the values of l₃ on the unstable and the stable "
        f"manifold, where α₃ is least, differ by δM up to a term in δ³ ({power:.3f} is measured for the power of δ in "
        "the difference from M)",
        abs(power - 2) < 0.01,
        table=rows,
    )
    return {
        "splitting_off": off,
        "splitting_power": power,
        "splitting": " and ".join((", ".join(texts[:-1]), texts[-1])),
    }


def _on_manifold(top: lp.Top, rest: Array, way: int, psi: Array) -> Array:
    """The value of l3 on a manifold where alpha3 is least, at angles of (l1, l2)."""
    values, vectors = np.linalg.eig(top.functions.jacobian(rest))
    v = vectors[:, np.argmax(way * np.real(values))]
    phases = np.exp(2j * np.pi * np.arange(_N_PHASES) / _N_PHASES)
    run = lp.section(
        top, rest + 1e-7 * (phases[:, None] * v / np.abs(v).max()).real, surface="l1*alpha2 - l2*alpha1", direction=0,
        t_end=way * _FLIGHT, n_crossings=1, method=lp.Taylor(tol=1e-15),
    )  # fmt: skip
    state = run.state.reshape(_N_PHASES, -1)
    modes = np.arange(-_N_MODES, _N_MODES + 1)
    waves = np.exp(1j * np.arctan2(state[:, 1], state[:, 0])[:, None] * modes)
    harmonics = np.linalg.lstsq(waves, state[:, 2].astype(complex), rcond=None)[0]
    return (np.exp(1j * psi[:, None] * modes) @ harmonics).real


def _around_periodic_orbits(evidence: Evidence) -> dict[str, Any]:
    """State that the manifolds of a hyperbolic periodic orbit of Kovalevskaya's top split at first order in epsilon."""
    middle = np.array([2 * np.sqrt(ENERGY - MOMENTUM**2 / 2), 0, MOMENTUM, 0, 0, 1, 0, 1, 0])
    found, slope = _twist_integral(middle)
    kovalevskaya = lp.catalog.system("kovalevskaya")
    run = lp.integrate(kovalevskaya, middle[:6], times=np.linspace(0, _LONGEST, 601))
    orbit = lp.orbits.periodic_orbit(kovalevskaya, run)  # the one to whose neighbourhood it comes
    quartic = float(kovalevskaya.functions.of(kovalevskaya.invariants["K"])(orbit.start))
    evidence.computation(
        f"ε = 0, H = {ENERGY:g}, l·α = {MOMENTUM:g}, |α| = 1: the orbit comes near a hyperbolic periodic orbit with "
        "K = (H − (l·α)²/2)², both ways, while ∇F decays; for a unit vector β with θ = π/2 its M is not zero",
        orbit.stability == "hyperbolic"
        and abs(quartic - (ENERGY - MOMENTUM**2 / 2) ** 2) < 1e-12
        and abs(found.value) > 10 * found.standard_error,
        [
            f"period {orbit.period:.6f}, largest multiplier {np.abs(orbit.multipliers).max():.1f}",
            f"|∇F| falls to {_power(slope)}, before round-off leads the orbit away",
            f"M = {_text(found)}",
        ],
    )
    return {"twist_integral": found.value, "twist_integral_error": found.standard_error, "twist": _text(found)}


def _twist_integral(middle: Array) -> tuple[lp.results.Estimate, float]:
    """The integral of {F, H} with the twist along an orbit, and to which slope F falls along it.

    The slope decays as the orbit comes near the periodic one, and grows again with round-off: each half of the integral
    ends where it is least, and what it changes while the slope is less than ten times that is its error.
    """
    top, twisted = lp.Top.kovalevskaya(epsilon=0), lp.Top.kovalevskaya(epsilon=1)
    function = twisted.functions.of(_F)
    rate = twisted.functions.of(twisted.bracket(function.expression, twisted.hamiltonian))
    places, weights = np.polynomial.legendre.leggauss(_PLACES)
    times = np.concatenate([[0], (np.arange(_LONGEST)[:, None] + (places + 1) / 2).ravel()])
    value = error = steepest = 0.0
    for way in (1, -1):
        run = lp.integrate(top, middle, times=way * times, method=lp.Taylor(tol=1e-15))
        states = run.state[0, 1:].reshape(_LONGEST, _PLACES, -1)
        sums = np.cumsum((rate(states) * weights / 2).sum(axis=1))
        slope = np.linalg.norm(function.gradient(states), axis=2).max(axis=1)
        end = slope.argmin()
        value += float(sums[end])
        error += float(np.abs(sums[slope < 10 * slope[end]] - sums[end]).max())
        steepest = max(steepest, float(slope[end]))
    return _known(value, error), steepest


def _known(value: float, error: float) -> lp.results.Estimate:
    """A number with its error."""
    return lp.results.Estimate(value, error, value - error, value + error)


def _text(estimate: lp.results.Estimate) -> str:
    """A number with its error as text."""
    return str(estimate).replace("-", "−")


def _digits(value: float) -> str:
    """A number with the digits that double precision leaves to an integral."""
    return f"{value:z.11f}"


def _power(number: float) -> str:
    """A positive number with two digits, as 4.6·10⁻⁴."""
    digits, exponent = f"{number:.1e}".split("e")
    return f"{digits}·10{str(int(exponent)).translate(str.maketrans('0123456789-', '⁰¹²³⁴⁵⁶⁷⁸⁹⁻'))}"
