"""Frames carried over many intervals in one call of the core: the steps of one run for each interval, bit for bit."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.indicators.tangent_frames import Clock, TangentFrames
from liepoisson.numeric.run_options import RunOptions

TOP = lp.Top.twisted_kovalevskaya()


def both(system, starts, n, duration, *, n_vectors=None, method=None, units=None, only=None):
    """Frames carried over n intervals in one call, what they have found, and the same interval by interval."""
    options = RunOptions.read(method, 1, 60.0, seed=3)
    together, apart = (TangentFrames(system, starts, options, n_vectors=n_vectors, units=units) for _ in range(2))
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
    for name in ("state", "end_time", "n_steps", "ratio"):
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
    assert together.order == apart.order


@pytest.mark.parametrize(
    "method",
    [
        None,
        lp.Taylor(precision="mixed"),
        lp.RungeKutta(step=0.1, precision="single"),
        lp.Splitting(step=0.07, order=4),
        lp.Gauss(step=0.3),
    ],
    ids=repr,
)
def test_frames_of_a_top_are_those_of_one_run_for_each_interval(method):
    starts = lp.sample_states(TOP, 11, seed=1)
    units = np.exp(np.random.default_rng(1).standard_normal(starts.shape))
    assert_same(*both(TOP, starts, 3, 0.83, n_vectors=4, method=method, units=units))


def test_frames_give_way_to_one_another_without_a_trace():
    """More trajectories than lanes take turns; 70 intervals are two in a turn."""
    starts = lp.sample_states(TOP, 37, seed=4)
    together, carried, apart, kept = both(TOP, starts, 70, 0.2, n_vectors=2)
    assert_same(together, carried, apart, kept)
    rows = TangentFrames(TOP, starts, RunOptions.read(None, 2, 60.0, seed=3), n_vectors=2).carry(70, 0.2, per_row=14)
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


def test_progress_counts_intervals():
    seen = []
    clock = Clock(5_000, seen.append)
    frames = TangentFrames(TOP, lp.sample_states(TOP, 8, seed=6), RunOptions.read(None, 1, 100.0), n_vectors=1)
    clock.carry(frames, 1_000, 0.5)
    assert seen[-1] == 0.2
    clock.carry(frames, 4_000, 0.5, per_row=4_000)
    assert seen[-1] == 1.0
    assert (np.diff(seen) >= 0.0).all()
