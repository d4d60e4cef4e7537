"""Families that end at homoclinic or heteroclinic orbits of equilibria, whatever the eigenvalues of these."""

import numpy as np
import pytest

import liepoisson as lp

WELL = lp.System(lp.canonical(1), "p1^2/2 - q1^2/2 + q1^4/4")
PENDULUM = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
HENON = lp.catalog.system("henon-heiles")


def strut(p):
    """u'''' + P u'' + u - u^2 = 0 with q = (u, u') and p2 = u''; at u = 0 the eigenvalues obey s^4 + P s^2 + 1 = 0."""
    return lp.System(lp.canonical(2), "p1*q2 + p2^2/2 + P*q2^2/2 - q1^2/2 + q1^3/3", {"P": p}, name="strut")


def around(system, state, **options):
    return lp.orbits.orbit_family(system, lp.phase_space.equilibrium(system, state), **options)


def test_a_loop_of_a_double_well_is_homoclinic():
    """The period grows with ln(1/E), down to the last digits of E."""
    family = around(WELL, [1, 0])
    assert family.end == "orbits homoclinic to the equilibrium (0, 0)"
    assert abs(family[-1].energy) < 1e-14


def test_an_upright_pendulum_is_at_both_ends_of_its_swing():
    family = around(PENDULUM, [0, 0], until=2)
    assert family.end == "orbits heteroclinic between 2 equilibria"
    assert family[-1].energy == pytest.approx(1, abs=1e-6)


@pytest.mark.thorough
@pytest.mark.parametrize("p", [-1, 0])
def test_a_family_ends_at_a_saddle_focus(p):
    """The energy turns again and again: of two turns the energies have the ratio -exp(pi a/b), for a +- ib, and the
    periods differ by pi/b [henrard1973]."""
    system = strut(p)
    family = around(system, [1, 0, 0, 0], max_orbits=1000)
    assert family.end == "orbits homoclinic to the equilibrium (0, 0, 0, 0)"
    focus = lp.phase_space.equilibrium(system, [0, 0, 0, 0]).spectrum[0]
    a, b = abs(focus.real), abs(focus.imag)
    folds = [point.orbit for point in family.points if point.kind == "fold"]
    energy, period = (np.array([getattr(one, name) for one in folds]) for name in ("energy", "period"))
    np.testing.assert_allclose(-energy[1:-1] / energy[2:], np.exp(np.pi * a / b), rtol=0.01)
    assert -energy[-2] / energy[-1] == pytest.approx(np.exp(np.pi * a / b), rel=2e-4)
    np.testing.assert_allclose(np.diff(period)[1:], np.pi / b, rtol=5e-3)


@pytest.mark.thorough
def test_a_straight_orbit_ends_at_a_saddle_that_has_a_centre_beside():
    family = lp.orbits.orbit_family(HENON, lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=6.3))
    assert family.end == "orbits homoclinic to the equilibrium (0, 1, 0, 0)"
    assert family[-1].energy == pytest.approx(1 / 6, abs=1e-9)


def test_in_a_parameter_the_equilibrium_is_that_of_the_last_system():
    """The saddle at q = g has the energy g - 1, which is that of the orbit where the family ends."""
    system = lp.System(lp.canonical(1), "p1^2/2 - (q1 - g)^2/2 + (q1 - g)^4/4 + g - 1", {"g": "1/2"})
    start = lp.orbits.periodic_orbit(system, [1.55, 0], period=4.5)
    family = lp.orbits.orbit_family(system, start, along="g", increasing=False)
    assert family.end == f"orbits homoclinic to the equilibrium ({start.energy + 1:.6g}, 0)"


def test_an_end_far_from_equilibria_is_not_decided():
    """Multipliers of 1e10 end this family while the orbit is no nearer to the saddle than 5e-2."""
    family = around(strut(-3), [1, 0, 0, 0])
    assert family.end == "the steps became too short"
    assert np.abs(family[-1].states(1000)).max(axis=1).min() > 1e-2
