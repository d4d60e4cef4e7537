"""Frames carried over many intervals in one call of the core: the steps of one run for each interval, bit for bit."""

import time

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.indicators.tangent_frames import Clock, TangentFrames

TOP = lp.Top.twisted_kovalevskaya()
ROTOR = lp.System(lp.so(3) @ lp.semidirect(2), "sqrt(1 + dot(l, l)) + sin(alpha1)/(3 + alpha2) + exp(l3/5)")
SU3 = lp.catalog.zeitlin(3)


def both(system, starts, n, duration, *, n_vectors=None, method=None, units=None, only=None):
    """Frames carried over n intervals in one call, what they have found, and the same interval by interval."""
    options = {"n_vectors": n_vectors, "seed": 3, "method": method, "units": units, "threads": 1, "time_limit": 60.0}
    together, apart = (TangentFrames(system, starts, **options) for _ in range(2))
    carried = together.carry(n, duration, keep=True, only=only)
    frames, states, triangles = [], [], []
    for _ in range(n):
        triangles.append(apart.advance(duration, only=only))
        frames.append(apart.frame.copy())
        states.append(apart.state.copy())
    return together, carried, apart, [np.stack(kept, axis=1) for kept in (triangles, frames, states)]


def assert_same(together, carried, apart, kept, asked=None):
    """What ends well is the same in all, what fails in how and where it ends."""
    assert together.outcome.tolist() == apart.outcome.tolist()
    for name in ("state", "end_time", "n_steps", "largest_ratio"):
        assert np.array_equal(getattr(together, name), getattr(apart, name), equal_nan=True), name
    triangles, frames, states = kept
    good = np.isfinite(triangles).all(axis=(2, 3))
    if asked is not None:
        good &= asked[:, None]
    assert np.array_equal(carried.triangle[good], triangles[good])
    assert np.array_equal(carried.frame[good], frames[good])
    assert np.array_equal(carried.state[good], states[good])
    stretchings = np.log(np.diagonal(triangles[good], axis1=1, axis2=2))
    assert np.abs(carried.growth[good] - stretchings).max(initial=0.0) <= 1e-15 * np.abs(stretchings).max(initial=1.0)
    for values in (carried.triangle, carried.frame, carried.state, carried.growth):
        assert np.isnan(values[~good]).all()
    assert (together.order, together.kernel) == (apart.order, apart.kernel)


@pytest.mark.parametrize("n_vectors", [1, 4, 9])
@pytest.mark.parametrize(
    "method",
    [
        None,
        lp.Taylor(tol=1e-8, order=9),
        lp.Taylor(precision="mixed"),
        lp.Taylor(tol=1e-8, precision="mixed"),
        lp.RungeKutta(tol=1e-8),
        lp.RungeKutta(step=0.1, precision="single"),
        lp.Splitting(step=0.07, order=4),
        lp.Splitting(step=0.07, precision="single"),
        lp.Gauss(step=0.3),
    ],
    ids=repr,
)
def test_frames_of_a_top_are_those_of_one_run_for_each_interval(method, n_vectors):
    starts = lp.sample_states(TOP, 19, seed=1)
    units = np.exp(np.random.default_rng(1).standard_normal(starts.shape))
    assert_same(*both(TOP, starts, 3, 0.83, n_vectors=n_vectors, method=method, units=units))


@pytest.mark.parametrize(
    ("system", "method"),
    [
        (SU3, None),
        (SU3, lp.RungeKutta(tol=1e-6, precision="single")),
        (SU3, lp.Gauss(step=0.3)),
        (ROTOR, None),
        (ROTOR, lp.RungeKutta(step=0.1)),
        (lp.Top.lagrange(), lp.methods.LagrangeMap(step=0.1)),
    ],
    ids=repr,
)
def test_frames_of_other_systems_are_those_of_one_run_for_each_interval(system, method):
    assert_same(*both(system, lp.sample_states(system, 11, seed=2), 3, 0.7, method=method))


def test_frames_give_way_to_one_another_without_a_trace():
    """More trajectories than lanes take turns; 70 intervals are two in a turn."""
    starts = lp.sample_states(TOP, 37, seed=4)
    together, carried, apart, kept = both(TOP, starts, 70, 0.2, n_vectors=2)
    assert_same(together, carried, apart, kept)
    rows = TangentFrames(TOP, starts, n_vectors=2, seed=3, threads=2, time_limit=60.0).carry(70, 0.2, per_row=14)
    assert rows.growth.shape == (37, 5, 2)
    assert rows.triangle.shape == (37, 0, 2, 2)
    sums = np.zeros((37, 5, 2))
    for k in range(14):  # in the order of the intervals
        sums += carried.growth[:, k::14]
    assert np.array_equal(rows.growth, sums)


def test_a_trajectory_that_fails_ends_as_in_a_run_of_its_own():
    """Of 12 starts some need more steps than they may take in an interval, one is none, and one is not asked for."""
    starts = lp.sample_states(TOP, 12, seed=5)
    starts[3, 2] = np.nan
    asked = np.arange(12) != 7
    method = lp.Taylor(tol=1e-13, max_steps=8)
    together, carried, apart, kept = both(TOP, starts, 6, 2.5, method=method, only=asked)
    assert_same(together, carried, apart, kept, asked)
    assert set(together.outcome) == {"finished", "max steps", "not finite"}
    later = (together.outcome == "max steps") & (together.end_time > 2.5)
    assert later.any()  # not all of them fail at once
    assert together.n_steps[7] == 0


def test_a_solution_that_ends_and_vectors_beyond_the_numbers_are_not_finite():
    """x' = x^2 from 1 has a pole at 1; about a saddle with exponents +-300 a vector is beyond 1e308 at a time of 3."""
    pole = lp.System(lp.canonical(1), "p1*q1^2")
    assert_same(*both(pole, np.array([[1.0, 0.3], [-1.0, 0.2]]), 5, 0.3))
    saddle = lp.System(lp.canonical(1), "300*p1*q1")
    starts = np.zeros((2, 2))
    frames, carried, *rest = both(saddle, starts, 2, 3.0)
    assert_same(frames, carried, *rest)
    assert (frames.outcome == "not finite").all()
    frames, carried, *rest = both(saddle, starts, 2, 0.5)
    assert_same(frames, carried, *rest)
    assert (frames.outcome == "finished").all()


def test_what_is_done_when_the_time_is_over_is_kept():
    frames = TangentFrames(TOP, lp.sample_states(TOP, 40, seed=6), time_limit=0.4, threads=1)
    carried = frames.carry(20_000, 1.0, per_row=10)
    done = np.isfinite(carried.growth).all(axis=2).sum(axis=1)
    assert (frames.outcome == "time limit").all()
    assert (frames.n_steps > 0).any()
    assert np.ptp(frames.end_time) < max(64.0, 0.25 * frames.end_time.max())  # turns of 16 intervals
    assert (frames.end_time >= 10 * done).all()
    assert (frames.end_time <= 10 * (done + 1)).all()
    assert np.isfinite(frames.state).all()
    late = frames.carry(3, 1.0)
    assert np.isnan(late.growth).all()


def test_frames_stop_at_the_wish_of_the_caller():
    def stop(_):
        raise KeyboardInterrupt

    frames = TangentFrames(TOP, lp.sample_states(TOP, 40, seed=6), time_limit=1e6, threads=2)
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        frames.carry(10_000_000, 1.0, stop, per_row=10_000_000)
    assert time.monotonic() - began < 30.0


def test_progress_counts_intervals():
    seen = []
    clock = Clock(5_000, seen.append)
    frames = TangentFrames(TOP, lp.sample_states(TOP, 8, seed=6), n_vectors=1, threads=1, time_limit=100.0)
    clock.carry(frames, 1_000, 0.5)
    assert seen[-1] == 0.2
    clock.carry(frames, 4_000, 0.5, per_row=4_000)
    assert seen[-1] == 1.0
    assert (np.diff(seen) >= 0.0).all()
