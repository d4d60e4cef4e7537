"""What holds for every indicator: a trajectory is the same in any ensemble, and one that fails is an outcome."""

from functools import partial

import numpy as np
import pytest

import liepoisson as lp

TOP = lp.Top.twisted_kovalevskaya()
GENERIC = lp.Top.heavy(inertia=(2, 2, 1.2), a=(-1, 0, 0))

INDICATORS = {
    "finite_time_exponents": partial(lp.finite_time_exponents, TOP, times=[1, 3]),
    "lyapunov_exponent": partial(lp.lyapunov_exponent, TOP, t_end=70, block=1, transient=2),
    "lyapunov_spectrum": partial(lp.lyapunov_spectrum, TOP, t_end=20, interval=5),
    "megno": partial(lp.chaos.megno, TOP, t_end=3, n_samples=64),
    "alignment": partial(lp.chaos.alignment, TOP, t_end=3, n_vectors=3),
    "alignment on the leaf": partial(lp.chaos.alignment, TOP, times=[3], within="leaf"),
    "alignment on the energy surface": partial(lp.chaos.alignment, TOP, times=[3], within="energy"),
    "decide": partial(lp.decide, GENERIC, t_end=20),
    "covariant vectors": lambda x0, **more: (
        lp.lyapunov_spectrum(TOP, x0, t_end=10, transient=5, covariant=True, **more).covariant
    ),
}
VALUES = ("exponent", "megno", "mean", "log_growth", "quadrature_error", "sali", "log_gali", "rates", "error", "vector",
          "verdict", "votes", "growth_power", "mean_megno", "average_drift", "state", "natural_time")  # fmt: skip


def values(found, n):
    """The arrays of a result that have a row for each trajectory."""
    kept = {name: np.asarray(getattr(found, name)) for name in VALUES if hasattr(found, name)}
    return {name: array for name, array in kept.items() if array.ndim and len(array) == n}


@pytest.mark.parametrize("run", INDICATORS.values(), ids=INDICATORS)
def test_members_are_the_same_in_pieces_and_for_any_number_of_threads(run):
    x0 = lp.sample_states(TOP, 262, seed=3)[-12:]  # 250 to 261: streams begin anew at 256
    kept = x0.copy()
    whole = values(run(x0, seed=1, first=250, threads=1), 12)
    part = values(run(x0[5:9], seed=1, first=255, threads=2), 4)
    assert np.array_equal(x0, kept)
    assert whole
    for name, array in whole.items():
        assert np.array_equal(array[5:9], part[name], equal_nan=array.dtype.kind == "f"), name


@pytest.mark.parametrize("run", INDICATORS.values(), ids=INDICATORS)
def test_a_trajectory_that_fails_is_an_outcome_beside_good_ones(run):
    x0 = np.array([np.ones(9), np.full(9, 1e200), np.full(9, np.nan)])
    if run is INDICATORS["alignment on the energy surface"]:
        x0[1] = np.inf  # of 1e200 the rates, which the surface is tangent to, are beyond the largest number
    found, alone = run(x0), run(x0[:1])
    if hasattr(found, "outcome"):
        assert list(found.outcome) == ["finished", "not finite", "not finite"]
    for name, array in values(found, 3).items():
        if array.dtype.kind == "f" and name != "state":
            assert np.array_equal(array[0], getattr(alone, name)[0], equal_nan=True), name
            assert np.isnan(array[1:]).any(axis=tuple(range(1, array.ndim))).all(), name


@pytest.mark.parametrize("run", INDICATORS.values(), ids=INDICATORS)
def test_no_trajectories_give_an_empty_result(run):
    found = run(np.empty((0, 9)))
    assert all(len(array) == 0 for array in values(found, 0).values())
