"""Inputs that no method can like end with an outcome for each trajectory: no hang, no crash, no poisoned neighbours."""

import numpy as np
import pytest

import liepoisson as lp

TOP = lp.Top.twisted_kovalevskaya()
METHODS = [
    lp.Taylor(max_steps=20_000),
    lp.Taylor(tol=1e-8, precision="mixed", max_steps=20_000),
    lp.RungeKutta(tol=1e-8, max_steps=20_000),
    lp.RungeKutta(step=0.1, max_steps=20_000),
    lp.RungeKutta(tol=1e-5, precision="single", max_steps=20_000),
    lp.Splitting(step=0.1, order=6, max_steps=20_000),
    lp.Splitting(step=0.1, precision="single", max_steps=20_000),
    lp.Gauss(step=0.1, max_steps=5_000),
]
OUTCOMES = {"finished", "step too small", "not finite", "max steps", "no convergence", "time limit"}
every_method = pytest.mark.parametrize("method", METHODS, ids=str)


ENDS = {"f": "finished", "s": "max steps", "n": "not finite", "c": "no convergence"}
"""What a letter below stands for, one for each of `METHODS`."""


def check(orbit):
    """Every trajectory has an outcome that agrees with its numbers."""
    assert set(orbit.outcome) <= OUTCOMES
    finished = orbit.outcome == "finished"
    assert np.isfinite(orbit.state[finished]).all()
    assert (orbit.end_time[finished] == orbit.time[-1]).all()
    # what failed has no state at the last time, and keeps the last good one
    assert np.isnan(orbit.state[~finished, -1]).all()
    assert (np.abs(orbit.end_time[~finished]) < abs(orbit.time[-1])).all()


@every_method
@pytest.mark.parametrize(
    ("scale", "ends"),
    [
        (1e-300, "ffffnfnf"),  # single precision ends at 1e-38: such a state is none
        (1e-8, "ffffffff"),
        (1e3, "fffnfffc"),
        (1e15, "sssnsffc"),  # 1e15 turns
        (1e300, "nnnnnnnn"),
    ],
)
def test_huge_and_tiny_states(method, scale, ends):
    orbit = lp.integrate(TOP, scale * lp.sample_states(TOP, 20, seed=1), times=[0, 0.5, 1], method=method)
    check(orbit)
    assert list(orbit.outcome) == [ENDS[ends[METHODS.index(method)]]] * 20


@every_method
def test_bad_members_do_not_touch_their_neighbours(method):
    x0 = lp.sample_states(TOP, 40, seed=3)
    tangents = np.ones((40, 1, 9))
    good = lp.integrate(TOP, x0, times=[0, 1, 3], tangents=tangents, method=method)
    bad = {2: (0, np.nan), 3: (4, np.inf), 17: (5, 1e300), 30: (8, -np.inf), 39: (1, 1e200)}
    for member, (component, value) in bad.items():
        x0[member, component] = value
    orbit = lp.integrate(TOP, x0, times=[0, 1, 3], tangents=tangents, method=method)
    check(orbit)
    kept = [member for member in range(40) if member not in bad]
    assert (orbit.outcome[kept] == "finished").all()
    assert orbit.state[kept].tobytes() == good.state[kept].tobytes()
    assert orbit.tangent[kept].tobytes() == good.tangent[kept].tobytes()
    assert (orbit.outcome[[2, 3, 30]] == "not finite").all()
    assert (orbit.outcome[[17, 39]] != "finished").all()


@every_method
def test_an_end_time_out_of_reach_ends_with_the_budget_of_steps(method):
    orbit = lp.integrate(TOP, lp.sample_states(TOP, 20, seed=1), times=[0, 1, 1e9], method=method)
    assert (orbit.outcome == "max steps").all()
    assert np.isfinite(orbit.state[:, 1]).all()
    check(orbit)
