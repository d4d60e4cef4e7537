"""Families in files: they come back as they were, with their symmetries, momenta and parameters, and go on."""

import numpy as np
import pytest

import liepoisson as lp

HENON = lp.catalog.system("henon-heiles")
TOP = lp.catalog.system("lagrange")


def straight():
    start = lp.orbits.periodic_orbit(HENON, [0, 0, 0, 0.2], period=6.3, energy="1/10")
    return lp.orbits.orbit_family(HENON, start, until=0.14)


def turning():
    start = lp.orbits.periodic_orbit(TOP, [1, 0, 0.5, 0, 0.6, 0.8], period=4, momenta=["l3"])
    return lp.orbits.orbit_family(TOP, start, max_orbits=3)


def symmetric():
    half = next(one for one in lp.systems.discrete_symmetries(HENON) if not one.reverses_time)
    start = lp.orbits.periodic_orbit(HENON, [0.3, 0, 0, 0.2], period=3.1, symmetry=half)
    return lp.orbits.orbit_family(HENON, start, max_orbits=3)


def in_a_parameter():
    pendulum = lp.System(lp.canonical(1), "p1^2/2 - g*cos(q1)", {"g": 1})
    start = lp.orbits.periodic_orbit(pendulum, [1, 0], period=7)
    return lp.orbits.orbit_family(pendulum, start, along="g", until=1.5)


@pytest.mark.parametrize("make", [straight, turning, symmetric, in_a_parameter])
def test_a_family_comes_back_as_it_was(tmp_path, make):
    family = make()
    again = lp.load(family.save(tmp_path / "family.nc"))
    assert repr(again) == repr(family)
    assert [repr(one) for one in again] == [repr(one) for one in family]
    assert again.to_dataframe().equals(family.to_dataframe())
    pairs = zip((*family, *(p.orbit for p in family.points)), (*again, *(p.orbit for p in again.points)), strict=True)
    for one, other in pairs:
        np.testing.assert_array_equal(other.start, one.start)
        np.testing.assert_array_equal(other.multipliers, one.multipliers)
        np.testing.assert_array_equal(other.level.units, one.level.units)
        assert other.level.values == one.level.values
        assert (other.momenta, other.angles.tolist()) == (one.momenta, one.angles.tolist())
        assert (other.symmetry is None) == (one.symmetry is None)
    for point, other in zip(family.points, again.points, strict=True):
        np.testing.assert_array_equal(other.tangent, point.tangent)
        assert (other.kind, other.after, other.is_located) == (point.kind, point.after, point.is_located)


def test_a_loaded_family_goes_on_branches_and_is_drawn(tmp_path):
    family = straight()
    again = lp.load(family.save(tmp_path / "family.nc"))
    further = [lp.orbits.orbit_family(HENON, one[-1], until=0.15) for one in (family, again)]
    np.testing.assert_array_equal(further[0].period, further[1].period)
    branch = lp.orbits.orbit_family(HENON, again.points[0], max_orbits=2)
    assert branch[0].period == pytest.approx(2 * again.points[0].orbit.period, rel=1e-3)
    assert len(lp.plot.draw(again).axes) == 1
    assert again.dataset["start"].dims == ("orbit", "component")


def test_a_family_is_not_repeated(tmp_path):
    path = straight().save(tmp_path / "family.nc")
    with pytest.raises(lp.errors.ParameterError, match=r"lp\.orbits\.orbit_family goes on from one of its orbits"):
        lp.rerun(path)
    with pytest.raises(lp.errors.OutputError, match=r"ends in \.nc"):
        straight().save(tmp_path / "family.csv")
