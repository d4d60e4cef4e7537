"""What holds for every indicator: a trajectory is the same in any ensemble, and one that fails is an outcome."""

import inspect
from dataclasses import fields
from functools import partial

import numpy as np
import pytest

import liepoisson as lp
from public_calls import rows

TOP = lp.Top.twisted_kovalevskaya()
GENERIC = lp.Top.heavy(inertia=(2, 2, 1.2), a=(-1, 0, 0))

OWN = {"starts", "tangents", "seed", "structure"}
"""Arguments with a value for each trajectory, and the seed: each test has its own."""
ENDS = {"state", "end_state", "time", "end_time", "largest_ratio"}
"""What is known up to where a trajectory ended, also one that failed."""
INDICATORS = {
    name: partial(row.function, **{key: value for key, value in row.arguments.items() if key not in OWN})
    for name, row in rows().items()
    if {"first", "starts"} <= {*inspect.signature(row.function).parameters}
}
INDICATORS |= {  # their rows have a system of three components
    name: partial(run, system=TOP, noises=["l1", "alpha2"]) for name, run in INDICATORS.items() if "stochastic" in name
}
INDICATORS |= {
    "alignment on the leaf": partial(lp.chaos.alignment, TOP, times=[3], within="leaf"),
    "alignment on the energy surface": partial(lp.chaos.alignment, TOP, times=[3], within="energy"),
    "covariant vectors": lambda **more: (
        lp.lyapunov_spectrum(TOP, t_end=10, transient=5, covariant=True, **more).covariant
    ),
}


def values(found, n):
    """The arrays of a result that have a row for each trajectory, but for starts and units."""
    names = {one.name for one in fields(found)} - {"start", "start_tangent", "unit", "edges"}
    arrays = {name: np.asarray(getattr(found, name)) for name in sorted(names)}
    return {name: array for name, array in arrays.items() if array.ndim and len(array) == n}


@pytest.mark.parametrize("run", INDICATORS.values(), ids=INDICATORS)
def test_members_are_the_same_in_pieces_and_for_any_number_of_threads(run):
    x0 = lp.sample_states(TOP, 262, seed=3)[-12:]  # 250 to 261: streams begin anew at 256
    kept = x0.copy()
    whole = values(run(starts=x0, seed=1, first=250, threads=1), 12)
    part = values(run(starts=x0[5:9], seed=1, first=255, threads=2), 4)
    assert np.array_equal(x0, kept)
    assert whole
    for name, array in whole.items():
        assert np.array_equal(array[5:9], part[name], equal_nan=array.dtype.kind == "f"), name


@pytest.mark.parametrize("run", INDICATORS.values(), ids=INDICATORS)
def test_a_trajectory_that_fails_is_an_outcome_beside_good_ones(run):
    x0 = np.array([np.ones(9), np.full(9, 1e200), np.full(9, np.nan)])
    if run is INDICATORS["alignment on the energy surface"]:
        x0[1] = np.inf  # of 1e200 the rates, which the surface is tangent to, are beyond the largest number
    found, alone = run(starts=x0), run(starts=x0[:1])
    if hasattr(found, "outcome"):
        assert list(found.outcome) == ["finished", "not finite", "not finite"]
    for name, array in values(found, 3).items():
        if array.dtype.kind == "f" and name not in ENDS:
            assert np.array_equal(array[0], getattr(alone, name)[0], equal_nan=True), name
            assert np.isnan(array[1:]).any(axis=tuple(range(1, array.ndim))).all(), name


@pytest.mark.parametrize("run", INDICATORS.values(), ids=INDICATORS)
def test_no_trajectories_give_an_empty_result(run):
    found = run(starts=np.empty((0, 9)))
    assert all(len(array) == 0 for array in values(found, 0).values())
