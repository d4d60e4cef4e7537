"""Inputs that no method can like end with an outcome for each trajectory: no hang, no crash, no poisoned neighbours."""

from __future__ import annotations

import time

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


def check(orbit: lp.Orbit) -> None:
    """Every trajectory has an outcome that agrees with its numbers."""
    assert set(orbit.outcome) <= OUTCOMES
    finished = orbit.outcome == "finished"
    assert np.isfinite(orbit.state[finished]).all()
    assert (orbit.end_time[finished] == orbit.time[-1]).all()
    # what failed has no state at the last time, and keeps the last good one
    assert np.isnan(orbit.state[~finished, -1]).all()
    assert (np.abs(orbit.end_time[~finished]) < abs(orbit.time[-1])).all()


@pytest.mark.filterwarnings("ignore::liepoisson.errors.InertiaWarning")  # no rigid body has these moments
@every_method
@pytest.mark.parametrize("inertia", [(1e6, 1.0, 0.5), (1e6, 1e6, 1.0), (1.0, 1.0, 1e6), (1e-6, 1.0, 1.0)], ids=str)
def test_stiff_inertia(method: lp.Taylor, inertia: tuple[float, float, float]) -> None:
    top = lp.Top(inertia=inertia, a=(1, 0.5, 0), b=(0, 0, 1), epsilon=1)
    check(lp.integrate(top, lp.sample_states(top, 20, seed=1), t=[0, 0.5, 1], method=method))


@every_method
@pytest.mark.parametrize("epsilon", [0, 1e-12, 1e6])
def test_extreme_twist(method: lp.Taylor, epsilon: float) -> None:
    top = lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), b=(0, 0, 0), epsilon=epsilon)
    check(lp.integrate(top, lp.sample_states(top, 20, seed=1), t=[0, 0.5, 1], method=method))


@every_method
def test_a_tiny_twist_is_nearly_none(method: lp.Taylor) -> None:
    tops = [lp.Top(inertia=(2, 2, 1), a=(-1, 0, 0), b=(0, 0, 0), epsilon=e) for e in (0, 1e-12)]
    x0 = lp.sample_states(TOP, 8, seed=2)
    ends = [lp.integrate(top, x0, t=[0, 2], method=method).state[:, -1] for top in tops]
    precision = 1e-4 if getattr(method, "precision", "double") == "single" else 1e-9
    assert np.abs(ends[0] - ends[1]).max() < precision


@every_method
@pytest.mark.parametrize("scale", [1e-300, 1e-30, 1e-8, 1e3, 1e15, 1e150, 1e300])
def test_huge_and_tiny_states(method: lp.Taylor, scale: float) -> None:
    check(lp.integrate(TOP, scale * lp.sample_states(TOP, 20, seed=1), t=[0, 0.5, 1], method=method))


@every_method
def test_bad_members_do_not_touch_their_neighbours(method: lp.Taylor) -> None:
    x0 = lp.sample_states(TOP, 40, seed=3)
    tangents = np.ones((40, 1, 9))
    good = lp.integrate(TOP, x0, t=[0, 1, 3], tangents=tangents, method=method)
    bad = {2: (0, np.nan), 3: (4, np.inf), 17: (5, 1e300), 30: (8, -np.inf), 39: (1, 1e200)}
    for member, (component, value) in bad.items():
        x0[member, component] = value
    orbit = lp.integrate(TOP, x0, t=[0, 1, 3], tangents=tangents, method=method)
    check(orbit)
    kept = [member for member in range(40) if member not in bad]
    assert (orbit.outcome[kept] == "finished").all()
    assert orbit.state[kept].tobytes() == good.state[kept].tobytes()
    assert orbit.tangent[kept].tobytes() == good.tangent[kept].tobytes()
    assert (orbit.outcome[[2, 3, 30]] == "not finite").all()
    assert (orbit.outcome[[17, 39]] != "finished").all()


@every_method
def test_an_end_time_out_of_reach_ends_with_the_budget_of_steps(method: lp.Taylor) -> None:
    orbit = lp.integrate(TOP, lp.sample_states(TOP, 20, seed=1), t=[0, 1, 1e9], method=method)
    assert (orbit.outcome == "max steps").all()
    assert np.isfinite(orbit.state[:, 1]).all()
    check(orbit)


@pytest.mark.thorough
@every_method
def test_a_limit_of_time_ends_a_run_and_keeps_what_is_done(method: lp.Taylor) -> None:
    patient = type(method)(**{**vars(method), "max_steps": 10**15})
    x0 = lp.sample_states(TOP, 200, seed=1)
    begin = time.perf_counter()
    orbit = lp.integrate(TOP, x0, t=[0, 1, 1e9], method=patient, time_limit=0.4, threads=2)
    # a worker looks at the clock every 64 turns, which take milliseconds
    assert time.perf_counter() - begin < 5.0
    assert (orbit.outcome == "time limit").all()
    started = ~np.isnan(orbit.end_time)
    assert 0 < started.sum() < 200
    assert np.isfinite(orbit.final_state[started]).all()
    assert np.isnan(orbit.final_state[~started]).all()


def test_default_budgets_end_an_endless_exponent(monkeypatch: pytest.MonkeyPatch) -> None:
    """The defaults at work, with the number of steps lowered to what a test can wait for."""
    assert lp.Taylor().max_steps == 10_000_000
    growth = lp.lyapunov_exponent(
        TOP, lp.sample_states(TOP, 4, seed=1), t_end=1e9, method=lp.Taylor(tol=1e-13, max_steps=5_000)
    )
    assert (growth.outcome == "max steps").all()
    assert (growth.n_steps == 5_000).all()
    assert np.isnan(growth.exponent[:, -1]).all()
