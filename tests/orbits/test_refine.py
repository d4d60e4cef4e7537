"""Orbits to many digits."""

import mpmath as mp
import pytest
from flint import arb, ctx
from numbers_of_the_proof import MIDPOINT, QUARTER, START

import liepoisson as lp


def agrees(got, wanted, tolerance):
    with ctx.workprec(300):
        return abs(float(arb(got).mid() - arb(wanted).mid())) <= tolerance


@pytest.mark.thorough
def test_the_orbit_of_the_proof_to_twenty_five_digits(twisted_orbits):
    precise = twisted_orbits[0].polished(digits=25)
    assert all(agrees(got, wanted, 1e-25) for got, wanted in zip(precise.start, START, strict=True))
    assert agrees(precise.time, QUARTER, 1e-18)
    assert [precise.end[k] for k in (2, 5, 8)] == ["0", "0", "0"]
    assert precise.residual < 1e-12


def test_a_harmonic_oscillator():
    """A quarter of the period is pi / 6."""
    system = lp.System(lp.canonical(1), "dot(p, p)/2 + 9*dot(q, q)/2")
    precise = lp.orbits.symmetric_periodic_orbits(system, {}, energy=1, n_starts=5)[0].polished(digits=60)
    with ctx.workprec(300):
        assert abs(float(arb(precise.time) - arb.pi() / 6)) < 1e-60
        assert abs(float(arb(precise.start[1]) ** 2 - 2)) < 1e-58


def test_an_orbit_without_symmetry_to_forty_digits():
    """Of p^2/2 + q^2/2 + q^4/4 = 3/4 the amplitude is 1 and the period 4 K(m = 1/4)/sqrt(2)."""
    duffing = lp.System(lp.canonical(1), "p1^2/2 + q1^2/2 + q1^4/4")
    precise = lp.orbits.periodic_orbit(duffing, [0.9, 0.3], period=4.8, energy="3/4").polished(digits=40)
    with ctx.workprec(300):
        q, p = map(arb, precise.start)
        assert abs(float(p * p / 2 + q * q / 2 + q**4 / 4 - arb(3) / 4)) < 1e-39
    mp.mp.dps = 50
    wanted = 4 * mp.ellipk(mp.mpf(1) / 4) / mp.sqrt(2)
    assert abs(mp.mpf(precise.time) - wanted) < mp.mpf(10) ** -38
    assert precise.residual < 1e-18


@pytest.mark.thorough
def test_the_orbit_of_the_proof_without_its_symmetry(twisted_orbits):
    """Four times the segment between its fixed sets."""
    level, gamma = {"C1": 1, "C2": "1/2", "C3": 1}, twisted_orbits[0]
    one = lp.orbits.periodic_orbit(gamma.system, gamma.start, period=gamma.period, leaf=level, energy="1/2")
    precise = one.polished(digits=25)
    with ctx.workprec(300):
        assert abs(float(arb(precise.time) - 4 * arb(QUARTER))) < 4e-18


def test_orbits_that_cannot_be_polished():
    pendulum = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
    with pytest.raises(lp.errors.ParameterError, match="polynomials"):
        lp.orbits.periodic_orbit(pendulum, [1, 0], period=7).polished()
    top = lp.catalog.system("lagrange")
    turning = lp.orbits.periodic_orbit(top, [1, 0, 0.5, 0, 0.6, 0.8], period=4, momenta=["l3"])
    with pytest.raises(lp.errors.ParameterError, match="momenta"):
        turning.polished()


@pytest.mark.slow
def test_the_midpoint_of_the_homoclinic_orbit(homoclinic_orbits):
    """The digits of an independent computation, whose orbit began at an amplitude of 1e-11: right to 1e-21."""
    orbit = next(one for one in homoclinic_orbits if abs(one.angles[0] - 0.78271) < 1e-5)
    precise = orbit.polished(digits=22)
    assert all(
        agrees(got.strip("-"), wanted.strip("-"), 2e-21) for got, wanted in zip(precise.midpoint, MIDPOINT, strict=True)
    )
    fewer = orbit.polished(digits=15)
    assert fewer.amplitude > 10 * precise.amplitude
    assert all(agrees(a, b, 1e-14) for a, b in zip(fewer.midpoint, precise.midpoint, strict=True))
