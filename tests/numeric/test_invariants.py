import numpy as np
import pytest

import liepoisson as lp

TOP = lp.Top.kovalevskaya()
STARTS = lp.sample_states(TOP, 3, seed=1)


def test_invariants_along_an_orbit_are_those_of_its_system():
    orbit = lp.integrate(TOP, STARTS, t_end=10)
    assert list(orbit.invariants) == list(TOP.invariants)
    assert {values.shape for values in orbit.invariants.values()} == {(3, 1001)}
    np.testing.assert_array_equal(orbit.invariants["H"], TOP.invariant_values(orbit.state)["H"])
    with pytest.raises(ValueError, match="read-only"):
        orbit.invariants["H"][0, 0] = 1


def test_drift_is_the_largest_change_since_the_start():
    orbit = lp.integrate(TOP, STARTS, times=np.arange(0, 21), method=lp.methods.RungeKutta(step=1.0))
    assert list(orbit.drift) == list(TOP.invariants)
    for name, values in TOP.invariant_values(orbit.state).items():
        np.testing.assert_array_equal(orbit.drift[name], np.abs(values - values[:, :1]).max(axis=1))
    assert (orbit.drift["H"] > 1e-12).all()  # a method of order 8 at a long step
    assert all((change < 1e-12).all() for change in lp.integrate(TOP, STARTS, t_end=10).drift.values())


def test_times_that_were_not_reached_count_for_nothing():
    starts = np.array([STARTS[0], np.full(9, np.nan)])
    orbit = lp.integrate(TOP, starts, t_end=5)
    assert orbit.drift["H"][0] < 1e-12
    assert np.isnan(orbit.drift["H"][1])
    short = lp.integrate(TOP, STARTS[0], t_end=50, method=lp.Taylor(max_steps=20))
    assert short.outcome[0] == "max steps"
    assert short.drift["H"][0] < 1e-12


def test_attitudes_and_orbits_in_charts_have_them_too():
    attitude = lp.orbits.attitude(TOP, STARTS, times=[0, 1, 2])
    assert attitude.drift["H"].shape == (3,)
    pendulum = lp.integrate(lp.catalog.system("henon-heiles"), [0.1, 0, 0, 0.1], t_end=5)
    assert pendulum.drift["H"].max() < 1e-13


def test_a_loaded_orbit_has_them(tmp_path):
    orbit = lp.integrate(TOP, STARTS, t_end=10)
    loaded = lp.load(orbit.save(tmp_path / "orbit.nc"))
    for name, change in orbit.drift.items():
        np.testing.assert_array_equal(loaded.drift[name], change)


class OnlyAField:
    name = "only a field"

    def field(self):
        return TOP.field()


def test_a_system_that_is_only_a_field_says_that_it_has_none():
    orbit = lp.integrate(OnlyAField(), STARTS, t_end=1)
    with pytest.raises(lp.errors.ParameterError, match=r"wanted a system with a bracket.*got only a field"):
        _ = orbit.drift
