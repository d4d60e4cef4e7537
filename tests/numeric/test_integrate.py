"""Trajectories: against independent integrators, reversal, dense output, bad input, interruption."""

import signal
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf
from scipy.integrate import solve_ivp

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError

TOP = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.3, 0.2), b=(0.4, 0, -0.7), epsilon=0.8)
NAMED = {
    "free rigid body": lp.Top.free_rigid_body(inertia=(3, 2, 1)),
    "Lagrange": lp.Top.lagrange(),
    "Kovalevskaya": lp.Top.kovalevskaya(),
    "twisted Lagrange": lp.Top.twisted_lagrange(),
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


def _taylor_in_40_digits(top, x0, v0, t_end, steps):
    """State and tangent vector by a plain Taylor series of order 30 in 40-digit arithmetic, J grad H written out."""
    mp.dps = 40
    inertia, a, b, epsilon = ([mpf(float(c)) for c in u] for u in (top.inertia, top.a, top.b, [top.epsilon]))

    def cross(u, v):
        return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]

    def product(x, y):  # the symmetric bilinear part of the field, as B(x, y) with f(x) = B(x, x) + A x
        omega = [y[i] / inertia[i] for i in range(3)]
        return cross(x[:3], omega) + cross(x[3:6], omega) + cross(x[6:], omega)

    def linear(x):
        torque = [p + q for p, q in zip(cross(x[3:6], a), cross(x[6:], b), strict=True)]
        return torque + [epsilon[0] * c for c in cross(x[6:], a)] + [mpf(0)] * 3

    h = mpf(t_end) / steps
    x, v = [mpf(float(c)) for c in x0], [mpf(float(c)) for c in v0]
    for _ in range(steps):
        xs, vs = [x], [v]
        for k in range(30):
            dx, dv = linear(xs[k]), linear(vs[k])
            for j in range(k + 1):
                dx = [p + q for p, q in zip(dx, product(xs[j], xs[k - j]), strict=True)]
                both = zip(dv, product(vs[j], xs[k - j]), product(xs[j], vs[k - j]), strict=True)
                dv = [p + q + r for p, q, r in both]
            xs.append([c / (k + 1) for c in dx])
            vs.append([c / (k + 1) for c in dv])
        x = [sum(c[i] * h**k for k, c in enumerate(xs)) for i in range(9)]
        v = [sum(c[i] * h**k for k, c in enumerate(vs)) for i in range(9)]
    return np.array([float(c) for c in x]), np.array([float(c) for c in v])


@pytest.mark.thorough
def test_state_and_tangent_vector_agree_with_a_40_digit_reference():
    """Independent series in 40 digits, 60 steps of 0.05; truncation below 1e-25."""
    x0 = lp.sample_states(TOP, 1, seed=5)[0]
    v0 = np.arange(1.0, 10.0) / 10
    x, v = _taylor_in_40_digits(TOP, x0, v0, 3.0, 60)
    orbit = lp.integrate(TOP, x0, times=[0, 3], tangents=[v0])
    assert np.abs(orbit.state[0, 1] - x).max() < 5e-15 * np.abs(x).max() * 3
    assert np.abs(orbit.tangent[0, 1, 0] - v).max() < 5e-15 * np.abs(v).max() * 3
    single = lp.integrate(TOP, x0, times=[0, 3])
    assert single.kernel == "components"
    assert np.abs(single.state[0, 1] - x).max() < 5e-15 * np.abs(x).max() * 3


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


@settings(max_examples=20)
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
        assert np.array_equal(orbit.at(float(wanted[0])), orbit.at(wanted)[:, 0])


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("members", [1, 3])
def test_dense_output_does_not_depend_on_the_order_of_times(direction, members):
    """Times within one step are summed side by side: in order, shuffled and one by one they have the same bits."""
    orbit = lp.integrate(TOP, lp.sample_states(TOP, members, seed=4), times=[0.0, 9.0 * direction], dense=True)
    rng = np.random.default_rng(5)
    times = direction * np.sort(rng.uniform(0.0, 9.0, 400))
    times[::50] = orbit.series[0][0][1:9]  # where steps begin
    values, shuffled = orbit.at(times), rng.permutation(400)
    np.testing.assert_array_equal(orbit.at(times[shuffled]), values[:, shuffled])
    np.testing.assert_array_equal(np.stack([orbit.at(time) for time in times], axis=1), values)
    np.testing.assert_array_equal(orbit.at(times.reshape(20, 20)), values.reshape(members, 20, 20, 9))
    starts, coefficients = orbit.series[-1]
    step = np.clip(np.searchsorted(direction * starts, direction * times, side="right") - 1, 0, None)
    powers = (times - starts[step])[:, None] ** np.arange(coefficients.shape[1])
    assert np.abs(values[-1] - np.einsum("tk,tkn->tn", powers, coefficients[step])).max() < 1e-13


def test_dense_output_refuses_what_it_does_not_have():
    x0 = lp.sample_states(TOP, 1, seed=4)
    with pytest.raises(ParameterError, match="dense=True"):
        lp.integrate(TOP, x0, times=[0, 1]).at(0.5)
    with pytest.raises(ParameterError, match=r"from 0\.0 to 1\.0"):
        lp.integrate(TOP, x0, times=[0, 1], dense=True).at([0.5, 1.5])
    with pytest.raises(ParameterError, match=r"from 0\.0 to 1\.0"):
        lp.integrate(TOP, x0, times=[0, 1], dense=True).at(np.nan)


def test_casimirs_and_invariants_of_every_named_top_are_kept():
    for name, top in NAMED.items():
        orbit = lp.integrate(top, lp.sample_states(top, 30, seed=6), times=[0, 50])
        start, end = top.invariant_values(orbit.state[:, 0]), top.invariant_values(orbit.state[:, 1])
        for invariant in start:
            drift = np.abs(end[invariant] - start[invariant]) / (1 + np.abs(start[invariant]))
            # measured: at most 7e-15 over these tops and starts
            assert drift.max() < 1e-13, f"{name}: {invariant} drifts by {drift.max():.1e}, bound 1e-13"


def test_energy_error_does_not_grow_with_a_trend():
    """Brouwer's law: after 64 times as long the RMS error of H is about 8 times as large; 3 times that is allowed."""
    top = lp.Top.twisted_kovalevskaya()
    orbit = lp.integrate(top, lp.sample_states(top, 64, seed=8), times=[0, 20, 1280])
    energy = top.invariant_values(orbit.state)["H"]
    rms = np.sqrt(np.mean((energy - energy[:, :1]) ** 2, axis=0))
    assert rms[2] < 3 * 8 * rms[1]
    assert rms[2] < 5e-14  # measured 8e-15


@pytest.mark.parametrize(
    ("x0", "message"),
    [
        (np.zeros((9, 128)), r"got shape \(9, 128\). Transpose it\?"),
        (np.zeros(8), r"must have shape \(9,\) or \(trajectory, 9\); got shape \(8,\)"),
        (np.zeros((2, 3, 9)), r"got shape \(2, 3, 9\)"),
        ("nine", "wanted an array of numbers"),
    ],
)
def test_wrong_shapes_are_refused(x0, message):
    with pytest.raises(ShapeError, match=message):
        lp.integrate(TOP, x0, times=[0, 1])


def test_numbers_that_are_not_finite_are_refused():
    x0 = lp.sample_states(TOP, 4, seed=1)
    with pytest.raises(ParameterError, match="trajectory 0 of 4 has a NaN"):
        lp.integrate(TOP, np.full_like(x0, np.inf), times=[0, 1])
    for times in ([0, 0], [0, 1, 0.5], [0, np.inf]):
        with pytest.raises(ParameterError, match="strictly increasing or strictly decreasing"):
            lp.integrate(TOP, x0[:1], times=times)
    with pytest.raises(ShapeError, match="2 or more times"):
        lp.integrate(TOP, x0[:1], times=[0])
    with pytest.raises(ShapeError, match=r"tangents must have shape \(tangent, 9\) or \(1, tangent, 9\)"):
        lp.integrate(TOP, x0[:1], times=[0, 1], tangents=np.zeros(9))
    with pytest.raises(ParameterError, match="threads"):
        lp.integrate(TOP, x0[:1], times=[0, 1], threads=0)


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


def test_a_kernel_that_does_not_apply_is_refused():
    x0 = lp.sample_states(TOP, 2, seed=1)
    with pytest.raises(ParameterError, match="for 2 trajectories with 0 tangent vectors"):
        lp.integrate(TOP, x0, times=[0, 1], kernel="components")
    with pytest.raises(ParameterError, match="for 1 trajectories with 9 tangent vectors"):
        lp.integrate(TOP, x0[0], times=[0, 1], tangents=np.eye(9), kernel="components")
    with pytest.raises(ParameterError, match="got 'fast'"):
        lp.integrate(TOP, x0[0], times=[0, 1], kernel="fast")


def test_a_zero_tangent_vector_does_not_shorten_the_steps():
    x0 = lp.sample_states(TOP, 1, seed=1)
    steps = [
        lp.integrate(TOP, x0, times=[0, 50], tangents=v, kernel="lanes").n_steps[0] for v in (None, np.zeros((1, 9)))
    ]
    assert steps[0] == steps[1]


def test_no_trajectories_give_an_empty_orbit():
    orbit = lp.integrate(TOP, np.empty((0, 9)), times=[0, 1])
    assert orbit.state.shape == (0, 2, 9)


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


@pytest.mark.thorough
def test_a_close_passage_of_keplers_problem_on_the_sphere_is_right_to_round_off_of_the_state():
    """An orbit that passes the centre of attraction at 0.0015: SciPy's DOP853 is 40 times further from the truth.

    The end was computed with power series of order 30 in numbers of 45 digits, from the equations of
    `equations_by_hand.py`.  At a distance rho from the centre the energy, with 1/rho in it, is known to the unit of the
    last place over rho^2 when the state is known to its last place: no method in doubles is better than that.
    """
    system = lp.catalog.system("kepler-on-the-sphere")
    start = [0.48776649151452084, -0.8723538626133716, 0.03290270717047299]
    start += [0.854221505958478, 0.39042194769128646, 0.34333121256153265]
    end = [-0.19799582844958036, -0.9386258319080819, 0.03290270717047299]
    end += [0.9102871245190188, -0.27423100967470726, 0.31012046734726656]
    round_off = np.finfo(float).eps / 0.0014831515**2
    ours = lp.integrate(system, start, times=[0, 10]).state[0, -1]
    assert np.abs(ours - end).max() < 0.1 * round_off  # measured 1.5e-12, of 1e-10
    scipy = solve_ivp(lambda _, x: system.vector_field(x), (0, 10), start, method="DOP853", rtol=1e-13, atol=1e-13).y[
        :, -1
    ]
    assert np.abs(scipy - end).max() > 10 * np.abs(ours - end).max()  # measured 5.6e-11


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
    for wanted in ({}, {"t_end": 5, "times": [5]}):
        with pytest.raises(ParameterError, match="both or neither"):
            first.go_on(**wanted)
    for wrong in ({"t_end": np.nan}, {"t_end": np.inf}, {"t_end": 4}, {"t_end": 1}, {"times": [3]}):
        with pytest.raises(ParameterError):
            first.go_on(**wrong)
    cut = lp.integrate(top, starts, t_end=8, method=lp.Taylor(max_steps=2))
    with pytest.raises(ParameterError, match="some that did not"):
        cut.go_on(t_end=9)


def test_a_run_goes_on_with_as_many_times_as_it_had():
    """Two times that are close say nothing of how many are wanted later."""
    start = lp.sample_states(lp.Top.kovalevskaya(), 1, seed=1)
    first = lp.integrate(lp.Top.kovalevskaya(), start, times=[5, 5 + 1e-9])
    np.testing.assert_array_equal(first.go_on(t_end=6).time, [5 + 1e-9, 6])


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


def test_a_system_names_all_components_or_none():
    class Short:
        name, component_names = "short", ("x", "y")

        def field(self):
            return lp.Top.kovalevskaya().field()

    with pytest.raises(ParameterError, match="wanted 9 names"):
        lp.integrate(Short(), np.ones(9), times=[0, 1])


@pytest.mark.parametrize("t_end", [1.3e154, 1.4e154, -1e200, 1e300])
@pytest.mark.parametrize("kernel", ["components", "lanes"])
def test_a_top_at_rest_stays_there_for_any_time(t_end, kernel):
    """The square of a step of 1.4e154 is beyond the largest number, and NaN times a coefficient that vanishes."""
    orbit = lp.integrate(lp.Top.heavy((2, 1.5, 1), (0, 0, 1)), {"alpha3": 1}, times=[0, t_end], kernel=kernel)
    assert (orbit.outcome[0], orbit.end_time[0]) == ("finished", t_end)
    np.testing.assert_array_equal(orbit.state[0, -1], [0, 0, 0, 0, 0, 1, 0, 0, 0])
