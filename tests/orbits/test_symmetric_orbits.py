"""Symmetric periodic orbits: closed formulas, and the orbit of the proof that the twisted top is chaotic."""

from math import gamma, pi, sqrt

import numpy as np
import pytest
from numbers_of_the_proof import QUARTER, START

import liepoisson as lp
from liepoisson.orbits import symmetric_periodic_orbits


@pytest.mark.thorough
def test_the_orbit_of_the_proof_is_found(twisted_orbits):
    """Its multipliers of half a period followed by R1 were found to be -5.08636360 +- 6.27502974 i."""
    orbit = twisted_orbits[0]
    np.testing.assert_allclose(orbit.start, [float(v) for v in START], atol=2e-14)
    assert abs(orbit.time - float(QUARTER)) < 1e-14
    assert abs(orbit.period - 4 * float(QUARTER)) < 1e-13
    np.testing.assert_allclose(orbit.multipliers[:2], [-5.08636360 + 6.27502974j, -5.08636360 - 6.27502974j], rtol=3e-9)
    np.testing.assert_allclose(orbit.multipliers[:2] * orbit.multipliers[2:], 1, rtol=1e-13)
    assert orbit.stability == "hyperbolic"
    assert abs(orbit.rate - np.log(np.hypot(5.08636360, 6.27502974)) / (2 * float(QUARTER))) < 1e-8


@pytest.mark.thorough
def test_each_orbit_closes_and_has_the_structure_that_it_must_have(twisted_orbits):
    """Measured: residuals below 6e-15, pairs to 2e-13, trivial multipliers to 6e-14 of the size of the matrix."""
    assert len(twisted_orbits) > 20
    for orbit in twisted_orbits:
        assert orbit.residual < 1e-12
        assert orbit.pair_defect < 1e-10
        assert orbit.trivial_defect < 1e-10
        states = orbit.states(64)
        tolerance = 1e-12 * max(1.0, abs(orbit.multipliers[0]) ** (orbit.period / orbit.return_time))
        np.testing.assert_allclose(states[-1], states[0], atol=tolerance)
        # it is no multiple of a shorter one, and no equilibrium
        assert np.linalg.norm(states[1:-1] - states[0], axis=1).min() > 1e-3


@pytest.mark.thorough
def test_each_orbit_is_listed_once(twisted_orbits):
    """Two of them would share a point up to the eight symmetries; periods that agree belong to other orbits."""
    group = [np.eye(9), *(one.matrix for one in lp.systems.discrete_symmetries(twisted_orbits.level.system))]
    for k, one in enumerate(twisted_orbits):
        for other in twisted_orbits[k + 1 :]:
            if abs(one.period - other.period) < 1e-6:
                path = other.states(4001)
                distance = min(np.linalg.norm(path - g @ one.start, axis=1).min() for g in group)
                assert distance > 1e-2
    rates = [one.rate for one in twisted_orbits]
    assert rates == sorted(rates, reverse=True)


@pytest.mark.thorough
def test_two_oscillators_have_two_normal_modes():
    r"""$\omega = 1, \sqrt2$: neighbours of the one turn by the other's frequency, $\mu = e^{2\pi i\omega_2/\omega_1}$.

    A segment is a half of the period or less, closed by a symmetry: the angle is that of the loop.
    """
    system = lp.System(lp.canonical(2), "(dot(p, p) + q1^2 + 2*q2^2)/2")
    found = symmetric_periodic_orbits(system, {}, energy=1, threads=1)
    assert {round(one.period / pi, 9) for one in found} == {2.0, round(sqrt(2), 9)}
    for one in found:
        other = sqrt(2) if abs(one.period - 2 * pi) < 1e-6 else 1.0
        angle = other * one.return_time
        signs = {round(abs(np.cos(angle)), 9), round(abs(np.real(one.multipliers[0])), 9)}
        assert len(signs) == 1
        assert one.stability == "elliptic"


def test_a_pendulum_at_the_height_of_its_axis():
    r"""H = p^2/2 - cos q = 0: $T = 4K(1/\sqrt2) = \Gamma(1/4)^2/\sqrt\pi$."""
    found = symmetric_periodic_orbits(lp.System(lp.canonical(1), "dot(p, p)/2 - cos(q1)"), {}, energy=0)
    assert len(found) == 1
    assert abs(found[0].period - gamma(0.25) ** 2 / sqrt(pi)) < 1e-13
