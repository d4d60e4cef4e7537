"""Surfaces of angles, modulo a turn: each crossing once, against closed forms and dense sampling."""

import numpy as np
import pytest
from scipy.special import ellipk

import liepoisson as lp
from liepoisson.errors import ParameterError

PENDULUM = lp.System(lp.canonical(names=["theta"], angles=["theta"]), "p_theta^2/2 - cos(theta)", name="pendulum")
DOUBLE = (
    "(p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - b)^2)) - 2*cos(a) - cos(b)"  # equal masses and lengths
)
OPEN = lp.System(lp.canonical(names=["a", "b"]), DOUBLE, name="double pendulum")
CLOSED = lp.System(lp.canonical(names=["a", "b"], angles=["a", "b"]), DOUBLE, name="double pendulum")


def time_of_a_turn(energy):
    r"""The time in which a pendulum of energy E > 1 goes round, $2K(m)/\sqrt{(E + 1)/2}$ with $m = 2/(E + 1)$."""
    return 2 * ellipk(2 / (energy + 1)) / np.sqrt((energy + 1) / 2)


@pytest.mark.parametrize(("energy", "sign"), [(3.5, 1), (3.5, -1), (1.001, 1), (200.0, -1)])
def test_a_rotating_pendulum_returns_after_each_turn(energy, sign):
    start = {"p_theta": sign * np.sqrt(2 * (energy + 1))}
    period = time_of_a_turn(energy)
    run = lp.section(PENDULUM, start, surface="theta", t_end=20.5 * period)
    assert len(run.time) == 20
    precision = 1e-12 + 1e-14 / (energy - 1)  # round-off of E changes the period by its part of E - 1; measured 6e-12
    np.testing.assert_allclose(run.time, period * np.arange(1, 21), rtol=precision)
    np.testing.assert_allclose(run.state[:, 0], sign * 2 * np.pi * np.arange(1, 21), rtol=1e-13)
    assert (run.sign == sign).all()
    assert not len(lp.section(PENDULUM, start, surface="theta", t_end=5 * period, direction=-sign).time)
    once = lp.sections.first_return(PENDULUM, start, surface="theta", direction=sign, t_end=2 * period)
    assert float(once.time) == pytest.approx(period, rel=precision)
    if energy == 3.5:
        assert float(once.time) == pytest.approx(2.412890, abs=5e-7)


def test_a_libration_crosses_twice_and_not_at_the_top():
    run = lp.section(PENDULUM, {"theta": 3.1}, surface="theta", t_end=100)
    assert np.abs(run.state[:, 0]).max() < 1e-10
    assert (run.sign[1:] == -run.sign[:-1]).all()


def test_wanted_crossings_and_further_ones_are_those_of_the_surface():
    period = time_of_a_turn(3.5)
    run = lp.section(PENDULUM, {"p_theta": 3.0}, surface="theta - 1", t_end=100, n_crossings=3)
    assert len(run.time) == 3
    assert run.end_time[0] < 3 * period
    further = run.go_on(t_end=10 * period, n_crossings=2)
    np.testing.assert_allclose(further.time + run.end_time, run.time[-1] + period * np.arange(1, 3), rtol=1e-12)


def test_a_pendulum_at_rest_lies_in_its_own_surface_alone():
    with pytest.warns(lp.errors.SurfaceWarning, match="lies in the surface"):
        assert not len(lp.section(PENDULUM, {"theta": 0}, surface="theta", t_end=10).time)
    top = lp.section(PENDULUM, {"theta": np.pi}, surface="theta", t_end=1)
    assert top.unresolved_time.max() == 0


def test_of_a_time_below_round_off_the_warning_claims_no_more_than_it_knows():
    circle = lp.VectorField({"x": "-y", "y": "x"})
    with pytest.warns(lp.errors.SurfaceWarning, match=r"to round-off, .* a larger t_end"):
        lp.section(circle, [0.6, 0.8], surface="x - 0.6", t_end=1e-15)
    assert not len(lp.section(circle, [0.6, 0.8], surface="x - 0.6", t_end=1e-12).time)


def crossings_of_samples(values, times, level):
    """Where sampled values pass levels 2 pi k + level, by the linear rule, and in which direction."""
    turns = np.floor((values - level) / (2 * np.pi))
    steps = np.flatnonzero(np.diff(turns))
    assert np.abs(np.diff(turns)).max() <= 1
    part = (2 * np.pi * np.maximum(turns[steps], turns[steps + 1]) + level - values[steps]) / np.diff(values)[steps]
    return times[steps] + part * np.diff(times)[steps], np.sign(np.diff(turns)[steps])


@pytest.mark.parametrize("surface", ["b - 1", "a", "b - a"])
def test_crossings_of_a_double_pendulum_are_those_of_dense_sampling(surface):
    start, times = {"a": 2.5, "b": 2.0}, np.linspace(0, 60, 120_001)
    orbit = lp.integrate(CLOSED, start, times=times).state[0]
    values = {"b - 1": orbit[:, 1] - 1, "a": orbit[:, 0], "b - a": orbit[:, 1] - orbit[:, 0]}[surface]
    wanted, directions = crossings_of_samples(values, times, 0.0)
    run = lp.section(CLOSED, start, surface=surface, t_end=60)
    assert np.ptp(orbit[:, 1]) > 4 * np.pi  # it does turn over
    np.testing.assert_allclose(run.time, wanted, atol=2e-6)
    assert (run.sign == directions).all()
    upwards = lp.section(CLOSED, start, surface=surface, t_end=60, direction=1)
    np.testing.assert_array_equal(upwards.time, run.time[run.sign > 0])


def test_methods_of_equal_steps_cross_once_in_a_turn():
    period = time_of_a_turn(3.5)
    how = lp.methods.Gauss(step=0.05)
    run = lp.section(PENDULUM, {"p_theta": 3.0}, surface="theta", t_end=5.5 * period, method=how)
    np.testing.assert_allclose(run.time, period * np.arange(1, 6), rtol=1e-6)


def test_a_section_of_an_angle_is_kept_in_a_file(tmp_path):
    run = lp.section(PENDULUM, {"p_theta": 3.0}, surface="theta", t_end=20)
    again = lp.load(run.save(tmp_path / "turns.nc"))
    np.testing.assert_array_equal(lp.rerun(again).time, run.time)
    assert again.system.periods == PENDULUM.periods


def test_a_surface_that_is_none_on_the_circle_is_refused():
    with pytest.raises(ParameterError, match=r"surface: wanted a function on the circle of theta"):
        lp.section(PENDULUM, {"p_theta": 3.0}, surface="theta*p_theta", t_end=1)
