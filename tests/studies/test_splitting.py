"""Melnikov's integrals of the report, against an independent integrator, other functions, and the splitting itself."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import liepoisson as lp
from liepoisson.studies.twisted_top.claims import splitting
from liepoisson.studies.twisted_top.claims.evidence import Evidence
from liepoisson.studies.twisted_top.claims.splitting import ENERGY, MOMENTUM, Loop

pytestmark = pytest.mark.thorough

MIDDLE = np.array([2 * np.sqrt(ENERGY - MOMENTUM**2 / 2), 0, MOMENTUM, 0, 0, 1, 0, 0, 0])
TWIST = -7.5170668
"""The integral for a unit vector beta along e2 in the middle."""


@pytest.fixture(scope="module")
def evidence():
    found = Evidence()
    splitting.state_numbers(found)
    return found


def test_all_is_borne_out_with_errors(evidence):
    assert all(step.succeeded and step.kind == "computation" for step in evidence.steps)
    assert evidence.data["excess_of_dimensions"] == [1, -1, 1]
    assert evidence.data["largest_error_of_integrals"] < 1e-11
    assert evidence.data["twist_integral"] == pytest.approx(TWIST, abs=2e-7)
    assert evidence.data["twist_integral_error"] < 1e-6


def twisted_rates(_, state):
    """The ordinary Kovalevskaya top with a passive beta, and dF/dt per epsilon, written out by hand."""
    l, alpha, beta = state[:3], state[3:6], state[6:9]
    omega, a = l / np.array([2, 2, 1]), np.array([-1.0, 0, 0])
    alpha_rate = np.cross(beta, a)  # the twist
    c, square, energy = l @ alpha, alpha @ alpha, l @ omega / 2 + a @ alpha
    slope = (
        2 * (energy - c**2 / (2 * square)) * (c / square * (l @ alpha_rate) - c**2 / square**2 * (alpha @ alpha_rate))
    )
    quartic_rate = -2 * beta[2] * (alpha[1] + l[0] * l[1] / 2)
    rates = np.cross(l, omega) + np.cross(alpha, a), np.cross(alpha, omega), np.cross(beta, omega)
    return np.concatenate([*rates, [quartic_rate + slope]])


@pytest.mark.parametrize("theta", [0, 0.6, np.pi / 2])
def test_another_integrator_gives_the_integral_of_the_twist(theta, evidence):
    """M is proportional to sin theta; a part of beta along alpha changes nothing. F is flattest at about t = 33."""
    start = np.concatenate([MIDDLE[:6], [np.cos(theta), np.sin(theta), 0.3, 0]])
    halves = [
        way * solve_ivp(twisted_rates, (0, 33 * way), start, "DOP853", rtol=1e-13, atol=1e-14).y[9, -1]
        for way in (1, -1)
    ]
    assert sum(halves) == pytest.approx(evidence.data["twist_integral"] * np.sin(theta), abs=2e-6)


def function(top):
    return top.functions.of(splitting._F)


def on_manifold(top, beta, way, time):
    """F at the state beside the middle from which F has vanished after a time, up to its square in epsilon."""
    f = function(top)
    slope = f.gradient(MIDDLE)
    start, across = MIDDLE + np.concatenate([np.zeros(6), beta]), slope / (slope @ slope)

    def end(s):
        return float(f(lp.integrate(top, start + s * across, times=[0, way * time]).state[0, -1]))

    first, last = 0.0, 1e-5
    left, right = end(first), end(last)
    while abs(right) > 1e-14 and left != right:
        first, last, left = last, last - right * (last - first) / (right - left), right
        right = end(last)
    return float(f(start + last * across))


@pytest.mark.parametrize("theta", [0.6, np.pi / 2])
def test_manifolds_of_the_twisted_top_split_by_it(theta):
    top, size = lp.Top.kovalevskaya(epsilon=1e-5), 1e-5
    beta = np.array([np.cos(theta), np.sin(theta), 0.3])
    split = (on_manifold(top, beta, -1, 16) - on_manifold(top, beta, 1, 16)) / size
    assert split == pytest.approx(TWIST * np.sin(theta), rel=1e-3)


@pytest.mark.parametrize("sign", [1, -1])
def test_angles_are_those_of_the_search(sign):
    loop = Loop(1, 2, sign)
    found = lp.orbits.symmetric_homoclinic_orbits(lp.phase_space.equilibrium(loop.top, loop.rest), n_starts=200)
    (same,) = [one for one in found if np.abs(one.midpoint - loop.state(0)).max() < 1e-8]
    np.testing.assert_allclose(np.sort(loop.angles(12)), same.angles, atol=1e-6)
