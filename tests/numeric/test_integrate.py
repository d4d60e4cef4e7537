"""Trajectories: against independent integrators, reversal, dense output, bad input, interruption."""

import signal
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import liepoisson as lp
from liepoisson.errors import ParameterError

TOP = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.3, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)
NAMED = {
    "Kovalevskaya": lp.Top.kovalevskaya(),
    "twisted Kovalevskaya": lp.Top.twisted_kovalevskaya(),
    "general": TOP,
}


@pytest.mark.thorough
@pytest.mark.parametrize("top", NAMED.values(), ids=NAMED.keys())
def test_orbit_agrees_with_an_independent_integrator(top):
    """SciPy's DOP853 at rtol 1e-13 on the symbolic field; its own error at t=10 is a few 1e-13."""
    x0 = lp.sample_states(top, 3, seed=11)
    orbit = lp.integrate(top, x0, times=[0, 4, 10])
    for k in range(3):
        reference = solve_ivp(
            lambda _, x: top.vector_field(x), (0, 10), x0[k], method="DOP853", rtol=1e-13, atol=1e-13, t_eval=[4, 10]
        )
        assert np.abs(orbit.state[k, 1:] - reference.y.T).max() < 1e-11


def test_state_at_the_first_time_is_the_start_itself():
    x0 = lp.sample_states(TOP, 20, seed=2)
    orbit = lp.integrate(TOP, x0, times=[3, 2, -1])
    assert np.array_equal(orbit.state[:, 0], x0)
    assert (orbit.outcome == "finished").all()
    assert np.array_equal(orbit.end_time, np.full(20, -1.0))
    assert np.array_equal(orbit.end_state, orbit.state[:, -1])


def test_running_backwards_undoes_running_forwards():
    x0 = lp.sample_states(TOP, 50, seed=3)
    forth = lp.integrate(TOP, x0, times=[0, 8])
    back = lp.integrate(TOP, forth.state[:, 1], times=[8, 0])
    # round-off times the growth of tangent vectors over 8 time units; measured 2e-14
    assert np.abs(back.state[:, 1] - x0).max() < 1e-12


@settings(max_examples=8)
@given(st.lists(st.floats(-2.0, 7.0), min_size=1, max_size=20))
def test_dense_output_is_the_orbit(times):
    """at(t) answers to round-off for any time, forwards and backwards."""
    x0 = lp.sample_states(TOP, 2, seed=4)
    wanted = np.unique(np.round(times, 6))
    for direction in (1, -1):
        orbit = lp.integrate(TOP, x0, times=np.array([-2.0, 7.0])[::direction], dense=True)
        grid = np.unique(np.concatenate([[-2.0, 7.0], wanted]))[::direction]
        direct = lp.integrate(TOP, x0, times=grid).state
        assert np.abs(orbit.at(grid) - direct).max() < 1e-14
        assert orbit.at(wanted).shape == (2, len(wanted), 9)
        np.testing.assert_array_equal(orbit.at(wanted[::-1]), orbit.at(wanted)[:, ::-1])
        assert np.array_equal(orbit.at(float(wanted[0])), orbit.at(wanted)[:, 0])


def test_energy_error_does_not_grow_with_a_trend():
    """Brouwer's law: after 64 times as long the RMS error of H is about 8 times as large; 3 times that is allowed."""
    top = lp.Top.twisted_kovalevskaya()
    orbit = lp.integrate(top, lp.sample_states(top, 64, seed=8), times=[0, 20, 1280])
    energy = top.invariant_values(orbit.state)["H"]
    rms = np.sqrt(np.mean((energy - energy[:, :1]) ** 2, axis=0))
    assert rms[2] < 3 * 8 * rms[1]
    assert rms[2] < 5e-14  # measured 8e-15


def test_a_trajectory_that_fails_is_an_outcome():
    x0 = lp.sample_states(TOP, 3, seed=1)
    x0[1] *= 1e200
    orbit = lp.integrate(TOP, x0, times=[0, 1, 2], dense=True)
    assert list(orbit.outcome) == ["finished", "not finite", "finished"]
    assert np.isnan(orbit.state[1]).all()
    assert np.array_equal(orbit.end_state[1], x0[1])
    assert np.isnan(orbit.at([0.5])[1]).all()
    assert np.isfinite(orbit.at([0.5])[[0, 2]]).all()
    few = lp.integrate(TOP, x0[:1], times=[0, 1, 1e6], method=lp.Taylor(max_steps=50))
    assert few.outcome[0] == "max steps"
    assert np.isfinite(few.state[0, 1]).all()
    assert np.isnan(few.state[0, 2]).all()
    assert few.n_steps[0] == 50


@pytest.mark.thorough
def test_ctrl_c_stops_a_long_run_soon():
    # a process started in the background by a shell ignores the signal
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    x0 = lp.sample_states(TOP, 8, seed=1)
    timer = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        lp.integrate(TOP, x0, times=[0, 1e12])
    timer.join()
    signal.signal(signal.SIGINT, before)


@pytest.mark.thorough
def test_progress_rises_to_at_most_one_and_its_errors_stop_the_run():
    x0 = lp.sample_states(TOP, 8, seed=1)
    seen = []
    lp.integrate(TOP, x0, times=[0, 2e5], progress=seen.append)
    assert seen == sorted(seen)
    assert all(0 <= fraction <= 1 for fraction in seen)

    def refuse(fraction):
        raise RuntimeError("no")

    with pytest.raises(RuntimeError, match="no"):
        lp.integrate(TOP, x0, times=[0, 1e12], progress=refuse)


def test_an_orbit_goes_on_from_where_it_ended(tmp_path):
    """Also one that was loaded: the two runs together are the one that was not interrupted, to round-off."""
    top = lp.Top.twisted_kovalevskaya()
    starts, tangents = lp.sample_states(top, 2, seed=1), np.eye(9)[:2]
    first = lp.integrate(top, starts, times=np.linspace(0, 4, 9), tangents=tangents)
    whole = lp.integrate(top, starts, times=np.linspace(0, 8, 17), tangents=tangents)
    for orbit in (first, lp.load(first.save(tmp_path / "first.nc"))):
        again = orbit.go_on(t_end=8)
        assert np.array_equal(again.time, whole.time[8:])
        assert np.abs(again.state - whole.state[:, 8:]).max() < 1e-12
        assert np.abs(again.tangent - whole.tangent[:, 8:]).max() < 1e-10
        assert np.array_equal(orbit.go_on(times=[5, 8]).time, [4, 5, 8])
    # two times that are close say nothing of how many are wanted later
    near = lp.integrate(top, starts, times=[5, 5 + 1e-9])
    np.testing.assert_array_equal(near.go_on(t_end=6).time, [5 + 1e-9, 6])
    for wrong in ({}, {"t_end": 5, "times": [5]}, {"t_end": np.inf}, {"t_end": 4}, {"times": [3]}):
        with pytest.raises(ParameterError):
            first.go_on(**wrong)
    with pytest.raises(ParameterError, match="some that did not"):
        lp.integrate(top, starts, t_end=8, method=lp.Taylor(max_steps=2)).go_on(t_end=9)


@pytest.mark.parametrize("n", [1, 3])
def test_the_last_good_state_is_finite(n):
    """x' = x, p' = -p from 1 exceeds all doubles at t = 709.78."""
    growth = lp.System(lp.canonical(1), "q1*p1")
    orbit = lp.integrate(growth, np.ones((n, 2)), times=[0, 700, 800], tangents=np.eye(2)[:1])
    assert (orbit.outcome == "not finite").all()
    assert ((orbit.end_time > 700) & (orbit.end_time < 709.79)).all()
    np.testing.assert_allclose(np.log(orbit.end_state), np.array([1, -1]) * orbit.end_time[:, None], rtol=1e-12)
    assert np.isfinite(orbit.state[:, :2]).all()
    assert np.isnan(orbit.state[:, 2]).all()
