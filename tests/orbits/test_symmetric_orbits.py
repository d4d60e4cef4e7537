"""Symmetric periodic orbits: closed formulas, and the orbit of the proof that the twisted top is chaotic."""

from math import gamma, pi, sqrt

import numpy as np
import pytest
from numbers_of_the_proof import QUARTER, START

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError
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
def test_more_starts_find_the_same_images_of_the_orbits(twisted_orbits):
    """An orbit is represented by one of its images, whatever the starts."""
    again = symmetric_periodic_orbits(
        twisted_orbits.level.system, twisted_orbits.level.leaf, "1/2", threads=1, n_starts=40, seed=5
    )
    np.testing.assert_allclose(again[0].start, twisted_orbits[0].start, atol=1e-13)
    assert {round(one.period, 6) for one in again} & {round(one.period, 6) for one in twisted_orbits[1:]}


def test_a_harmonic_oscillator():
    """H = p^2/2 + 9 q^2/2: the period is 2 pi / 3 for every energy; a segment is a quarter of it."""
    found = symmetric_periodic_orbits(lp.System(lp.canonical(1), "dot(p, p)/2 + 9*dot(q, q)/2"), {}, energy="1/3")
    assert len(found) == 1
    assert abs(found[0].period - 2 * pi / 3) < 1e-14
    assert abs(found[0].time - pi / 6) < 1e-14
    assert found[0].stability == "neutral"
    assert found[0].multipliers.shape == (0,)


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


def test_eulers_top():
    """I = (3, 2, 1), |l|^2 = 1: the period is 4K(m)/n, from Landau and Lifshitz, section 37, with K by the mean.

    K(m) = pi / (2 M(1, sqrt(1 - m))); for 2 E I2 > 1 the body turns about the axis of the smallest moment.
    """
    energy = 0.35
    found = symmetric_periodic_orbits(
        lp.System(lp.so(3) @ lp.trivial(), "l1^2/6 + l2^2/4 + l3^2/2"), {"C1": 1}, energy=energy
    )
    first, second, third = 1.0, 2.0, 3.0  # in the order of the book's formulas: I1 < I2 < I3, the axis being that of I1
    M2, E2 = 1.0, 2 * energy
    m = (second - third) * (E2 * first - M2) / ((second - first) * (E2 * third - M2))
    n = sqrt((E2 * third - M2) * (second - first) / (first * second * third))
    a, b = 1.0, sqrt(1 - m)
    for _ in range(8):
        a, b = (a + b) / 2, sqrt(a * b)
    assert len(found) == 1
    assert abs(found[0].period - 4 * pi / (2 * a) / n) < 1e-12


@pytest.mark.thorough
def test_a_level_that_does_not_suit():
    top = lp.Top.kovalevskaya(epsilon=1)
    with pytest.raises(LeafError, match="none of"):
        symmetric_periodic_orbits(top, {"C1": 1, "C2": "1/2", "C3": 1}, -100, n_starts=20)
    with pytest.raises(LeafError, match="regular"):
        symmetric_periodic_orbits(top, lp.Leaf.through(top, [1, 0, 0, 0, 0, 0, 0, 0, 0]), 0)
    asymmetric = lp.Top.twisted((3, 2, 1), (1, "1/2", "1/3"), (1, 0, 1))
    with pytest.raises(ParameterError, match="must have a reverser"):
        symmetric_periodic_orbits(asymmetric, {"C1": 1, "C2": "1/2", "C3": 1}, 1)
    time = [one for one in lp.systems.discrete_symmetries(top).reversers if not one.keeps_every_level]
    with pytest.raises(ParameterError, match="to itself"):
        symmetric_periodic_orbits(top, {"C1": 1, "C2": "1/2", "C3": 1}, "1/2", reversers=time)
    with pytest.raises(ParameterError, match="leaf must be"):
        symmetric_periodic_orbits(top, 3, "1/2")


@pytest.mark.thorough
def test_families_are_counted_and_not_listed():
    """All orbits of two equal oscillators have one period: with H fixed they fill the sphere."""
    found = symmetric_periodic_orbits(
        lp.System(lp.canonical(2), "(dot(p, p) + dot(q, q))/2"), {}, energy=1, threads=1, n_starts=20
    )
    assert len(found) == 0
    assert found.n_families > 0
    assert "families are left out" in repr(found)


@pytest.mark.thorough
def test_the_table(twisted_orbits):
    text = repr(twisted_orbits)
    assert "symmetric periodic orbits of 'twisted Kovalevskaya top' on H = 1/2, C1 = 1, C2 = 1/2, C3 = 1" in text
    assert "6.37427107" in text
    assert "-5.0864+6.275i" in text
    assert "that there are no others is not proved" in text
