"""Sections of orbits in equal steps: of the orbit itself, to the order of the method, in the words of all sections."""

import numpy as np
import pytest

import liepoisson as lp

HENON = lp.catalog.system("henon-heiles")
STATES = np.array([[0, 0.1, 0.4, 0.05], [0, -0.1, 0.3, 0.1], [0.1, 0.1, 0.3, 0.1]])
METHOD = lp.methods.Gauss(step=0.1)
OF_X = {"surface": "x", "t_end": 60, "direction": 1}


def test_crossings_are_on_the_orbit_and_the_orbit_is_not_disturbed():
    found = lp.section(HENON, STATES, **OF_X, method=METHOD)
    orbit = lp.integrate(HENON, STATES, times=0.1 * np.arange(601), method=METHOD)
    assert np.abs(found.state[:, 0]).max() < 1e-16
    np.testing.assert_allclose(found.end_state, orbit.state[:, -1], atol=1e-13)
    x = orbit.state[:, :, 0]
    assert found.count.tolist() == ((x[:, :-1] < 0) & (x[:, 1:] >= 0)).sum(axis=1).tolist()
    for k, time, state in zip(found.trajectory, found.time, found.state, strict=True):
        before = int(time / 0.1)
        step = lp.integrate(HENON, orbit.state[k, before], times=[0, time - 0.1 * before], method=METHOD)
        np.testing.assert_allclose(state, step.state[0, -1], atol=1e-13)


@pytest.mark.parametrize("order", [2, 4, 6])
def test_crossings_converge_to_those_of_the_flow(order):
    exact = lp.section(HENON, STATES, **OF_X)
    errors = []
    for step in (0.2, 0.1):
        found = lp.section(HENON, STATES, **OF_X, method=lp.methods.Gauss(step=step, order=order))
        assert found.count.tolist() == exact.count.tolist()
        np.testing.assert_array_equal(found.sign, exact.sign)
        errors.append(np.abs(found.state - exact.state).max())
    assert np.log2(errors[0] / errors[1]) > order - 0.5, errors


def test_one_trajectory_is_the_same_among_others():
    found = lp.section(HENON, STATES, **OF_X, method=METHOD)
    for k in range(len(STATES)):
        np.testing.assert_array_equal(lp.section(HENON, STATES[k], **OF_X, method=METHOD).state, found.of(k))


def test_it_ends_goes_on_and_is_repeated(tmp_path):
    found = lp.section(HENON, STATES, **OF_X, method=METHOD)
    few = lp.section(HENON, STATES, **OF_X, method=METHOD, n_crossings=3)
    assert few.count.tolist() == [3, 3, 3]
    for k in range(3):
        np.testing.assert_array_equal(few.of(k), found.of(k)[:3])
        np.testing.assert_allclose(few.go_on(t_end=30).of(k)[0], found.of(k)[3], atol=1e-12)
    np.testing.assert_array_equal(lp.rerun(few.save(tmp_path / "few.nc")).state, few.state)


def test_a_start_on_the_surface_is_a_crossing_only_where_its_side_says_so():
    for x in (0.0, 1e-12, -1e-12):
        given = {"starts": [x, 0.1, 0.4, 0.05], "surface": "x", "t_end": 1, "method": METHOD}
        assert lp.section(HENON, **given).count.tolist() == [0]
        assert lp.section(HENON, **given, start_side=1).count.tolist() == [0]
        assert lp.section(HENON, **given, start_side=-1).time.tolist() == [0.0]


def test_gaps_failures_and_kept_functions():
    pendulum = lp.System(lp.canonical(1), "p1^2/2 + q1^2/2")
    root = lp.section(pendulum, [[1, 0]], surface="sqrt(q1) - 1/2", keep=["q1"], t_end=6.3, method=METHOD)
    assert root.coordinates == ("q1",)
    np.testing.assert_allclose(root.state, 0.25, atol=1e-14)
    assert root.sign.tolist() == [-1, 1]
    assert 3 < root.undefined_time[0] < 3.5
    assert 1.4 < root.seen_to[0] < np.pi / 2
    assert (root.unseen_steps[0], root.unbounded_steps[0]) == (round(root.undefined_time[0] / 0.1), root.n_steps[0])
    short = lp.section(HENON, STATES, **OF_X, method=lp.methods.Gauss(step=0.1, max_steps=100))
    assert set(short.outcome) == {"max steps"}
    np.testing.assert_allclose(short.end_time, 10)
    blown = lp.System(lp.canonical(1), "p1*q1^2")
    found = lp.section(blown, [[1, 0]], surface="q1 - 2", t_end=3, method=lp.methods.RungeKutta(step=0.01))
    assert found.outcome[0] != "finished"
    np.testing.assert_allclose(found.time, [0.5], rtol=1e-9)
    assert found.end_time[0] < 1.1


def test_a_pole_and_a_jump_are_no_crossings():
    swing = lp.System(lp.canonical(1), "p1^2/2 + q1^2/2")
    for surface in ("1/q1", "(q1 - 1/3)^(-3)", "atan(1/q1)"):
        assert not len(lp.section(swing, [[1, 0]], surface=surface, t_end=20, method=METHOD).time)
    both = lp.section(swing, [[1, 0]], surface="(q1 - 1/2)/(q1 + 1/2)", t_end=6.28, method=METHOD)
    np.testing.assert_allclose(both.state[:, 0], 0.5, atol=1e-14)


def test_a_crossing_takes_few_steps(monkeypatch):
    from liepoisson.poincare import equal_steps

    made = []
    monkeypatch.setattr(equal_steps, "after", lambda *given, after=equal_steps.after: made.append(0) or after(*given))
    found = lp.section(HENON, STATES, **OF_X, method=METHOD)
    assert len(made) < 8 * len(found.time)


def test_backwards_and_without_starts():
    forth = lp.section(HENON, STATES[:1], surface="y", t_end=20, method=METHOD)
    back = lp.section(HENON, forth.end_state, surface="y", t_end=-20, method=METHOD)
    np.testing.assert_allclose(back.state[::-1], forth.state, atol=1e-9)
    np.testing.assert_array_equal(back.sign[::-1], -forth.sign)
    assert lp.section(HENON, np.zeros((0, 4)), **OF_X, method=METHOD).state.shape == (0, 4)
