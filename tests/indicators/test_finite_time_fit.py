"""Fits of ensemble growth, on synthetic ensembles whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from liepoisson.indicators.finite_time_fit import (
    EnsembleReduction,
    finite_time_fit,
    last_decade,
    log_fit,
    mean_curve,
    window_grid,
    window_scan,
)

TIME = np.concatenate([np.arange(1.0, 201.0), np.geomspace(205, 1000, 60)])
TRUTH = {"lambda": 0.12, "c1": 0.11, "c0": 0.5}


def synthetic_ensemble(n: int, seed: int, spread: float = 0.04) -> np.ndarray:
    """Members with their own limit and their own noise; the mean obeys the finite-time law with TRUTH exactly."""
    generator = np.random.default_rng(seed)
    # A skewed distribution of limits, as a mixture of regular and chaotic orbits has.
    limit = TRUTH["lambda"] + spread * (generator.exponential(size=(n, 1)) - 1)
    decay = TRUTH["c1"] + 0.2 * generator.standard_normal((n, 1))
    noise = 0.05 * generator.standard_normal((n, TIME.size)) / np.sqrt(TIME)
    return limit + decay / np.sqrt(TIME) + TRUTH["c0"] / TIME + noise


def test_fit_is_exact_for_a_curve_that_obeys_the_law():
    curve = 0.12 + 0.11 / np.sqrt(TIME) + 0.5 / TIME
    fit = finite_time_fit(TIME, np.stack([curve, curve]))
    assert fit.lambda_ == pytest.approx(0.12, abs=1e-13)
    assert fit.c1 == pytest.approx(0.11, abs=1e-12)
    assert fit.c0 == pytest.approx(0.5, abs=1e-11)
    assert max(fit.standard_errors.values()) < 1e-12
    for estimate in fit.estimates.values():
        np.testing.assert_allclose([estimate.low, estimate.high], estimate.value, rtol=1e-10)
    assert fit.rms_residual < 1e-14
    np.testing.assert_allclose(fit.curve(TIME), curve, rtol=1e-12)


def test_fit_is_least_squares_on_the_ensemble_mean():
    exponent = synthetic_ensemble(50, seed=3)
    fit = finite_time_fit(TIME, exponent, window=(20, 200))
    inside = (TIME >= 20) & (TIME <= 200)
    t = TIME[inside]
    design = np.stack([np.ones_like(t), t**-0.5, 1 / t], axis=1)
    expected, *_ = np.linalg.lstsq(design, exponent.mean(axis=0)[inside], rcond=None)
    np.testing.assert_allclose([fit.lambda_, fit.c1, fit.c0], expected, rtol=1e-9)
    rms = np.sqrt(np.mean((exponent.mean(axis=0)[inside] - design @ expected) ** 2))
    assert fit.rms_residual == pytest.approx(rms, rel=1e-6)
    assert fit.n_times == t.size


def test_bootstrap_error_is_that_of_the_mean_of_member_fits():
    n = 400
    exponent = synthetic_ensemble(n, seed=4)
    inside = (TIME >= 20) & (TIME <= 200)
    t = TIME[inside]
    design = np.stack([np.ones_like(t), t**-0.5, 1 / t], axis=1)
    members, *_ = np.linalg.lstsq(design, exponent[:, inside].T, rcond=None)
    expected = members.std(axis=1) / np.sqrt(n)
    fit = finite_time_fit(TIME, exponent, window=(20, 200), n_bootstrap=4000)
    # A standard deviation of 4000 replicates has a relative error of 1/sqrt(8000) = 1.1 %; bound at five of them.
    np.testing.assert_allclose(list(fit.standard_errors.values()), expected, rtol=0.056)


@pytest.mark.thorough
def test_intervals_cover_the_truth_as_often_as_they_say():
    # Binomial(200, 0.9) has the standard deviation 4.2; skewness at n = 200 costs the interval up to 1 % of coverage.
    n_ensembles, covered = 200, dict.fromkeys(TRUTH, 0)
    for seed in range(n_ensembles):
        fit = finite_time_fit(TIME, synthetic_ensemble(200, seed), n_bootstrap=300, confidence=0.9, seed=seed)
        for name, truth in TRUTH.items():
            covered[name] += fit.estimates[name].contains(truth)
    for name, count in covered.items():
        assert 164 <= count <= 194, f"{name}: {count} of {n_ensembles} intervals at 90 % cover the truth"


def test_logarithmic_fit_finds_power_and_no_floor():
    generator = np.random.default_rng(5)
    n = 500
    power = 1 + 0.1 * generator.standard_normal((n, 1))
    exponent = (-1.2 + power * np.log(TIME) + 0.1 * generator.standard_normal((n, TIME.size))) / TIME
    fit = log_fit(TIME, exponent, window=(50, 1000))
    # Five standard errors: wrong with probability 6e-7 for normal errors.
    assert abs(fit.A + 1.2) < 5 * fit.estimates["A"].standard_error
    assert abs(fit.B - 1.0) < 5 * fit.estimates["B"].standard_error
    assert fit.estimates["B"].standard_error < 0.01
    assert abs(fit.D) < 5 * fit.with_linear_term["D"].standard_error
    assert fit.linear_term_is_zero
    assert "zero within its error" in str(fit)


def test_logarithmic_fit_sees_a_small_floor():
    generator = np.random.default_rng(6)
    exponent = (-1.2 + np.log(TIME) + 0.1 * generator.standard_normal((500, TIME.size))) / TIME + 1e-3
    fit = log_fit(TIME, exponent, window=(50, 1000))
    assert not fit.linear_term_is_zero
    assert pytest.approx(1e-3, abs=5 * fit.with_linear_term["D"].standard_error) == fit.D
    assert "not zero within its error" in str(fit)


def test_pieces_give_what_the_whole_gives():
    exponent = synthetic_ensemble(301, seed=7)
    whole = EnsembleReduction(TIME, windows=[(20, 200), (5, 100)], log_windows=[(50, 1000)])
    whole.add(exponent)
    streamed = EnsembleReduction(TIME, windows=[(20, 200), (5, 100)], log_windows=[(50, 1000)])
    for start in range(0, 301, 64):
        streamed.add(exponent[start : start + 64])
    scan = window_scan(TIME, exponent, windows=[(20, 200), (5, 100)])
    for one, other, third in zip(whole.finite_time_fits(), streamed.finite_time_fits(), scan, strict=True):
        for name in TRUTH:
            np.testing.assert_allclose(one.estimates[name], other.estimates[name], rtol=1e-10)
            np.testing.assert_allclose(one.estimates[name], third.estimates[name], rtol=1e-9)
    for laws in ("estimates", "with_linear_term", "with_next_term"):
        one, other = getattr(whole.log_fits()[0], laws), getattr(streamed.log_fits()[0], laws)
        for name, estimate in one.items():
            np.testing.assert_allclose(other[name], estimate, rtol=1e-7)
    curve, streamed_curve = whole.mean_curve(), streamed.mean_curve()
    np.testing.assert_allclose(curve.mean, exponent.mean(axis=0), rtol=1e-12)
    np.testing.assert_allclose(curve.standard_error, exponent.std(axis=0, ddof=1) / np.sqrt(301), rtol=1e-12)
    np.testing.assert_allclose(streamed_curve.mean, curve.mean, rtol=1e-12)
    np.testing.assert_allclose(streamed_curve.standard_error, curve.standard_error, rtol=1e-11)
    for side in (curve.mean - curve.low, curve.high - curve.mean):  # for 95% of a normal distribution
        np.testing.assert_allclose(side, 1.96 * curve.standard_error, rtol=0.02)


def test_members_that_did_not_finish_are_left_out_and_counted():
    exponent = synthetic_ensemble(100, seed=8)
    broken = exponent.copy()
    broken[[3, 50]] = np.nan
    broken[77, 150:] = np.nan
    fit = finite_time_fit(TIME, broken)
    expected = finite_time_fit(TIME, np.delete(exponent, [3, 50, 77], axis=0))
    assert (fit.n_members, fit.n_excluded) == (97, 3)
    assert fit.estimates == expected.estimates
    assert "3 left out" in str(fit)
    assert mean_curve(TIME, broken).n_excluded == 3


def test_default_windows_lie_inside_the_sample_times():
    windows = window_grid(np.arange(1.0, 251.0))
    assert (25.0, 250.0) in windows
    assert all(2 * start <= end <= 250 for start, end in windows)
    assert (50.0, 125.0) in windows
    assert (50.0, 50.0) not in windows
    assert last_decade(np.arange(1.0, 251.0)) == (25.0, 250.0)
    # and follow the unit of time
    assert np.array(window_grid(1e-6 * np.arange(1.0, 251.0))) == pytest.approx(1e-6 * np.array(windows))


@pytest.mark.thorough
def test_chi_squared_of_the_truth_has_mean_three():
    """Over 100 ensembles the mean is 3 with deviation sqrt(6/100); 5 sigma, error probability 6e-7."""
    rng = np.random.default_rng(8)
    time, truth = np.arange(20.0, 201.0), np.array([0.12, 0.15, 0.4])
    law = np.stack([np.ones_like(time), time**-0.5, 1 / time])
    # coefficients of single trajectories with strong correlations
    mixing = np.array([[0.05, 0.0, 0.0], [-0.4, 0.2, 0.0], [1.0, -1.5, 0.7]])
    distances = []
    for _ in range(100):
        members = (truth + rng.standard_normal((400, 3)) @ mixing.T) @ law
        fit = finite_time_fit(time, members, n_bootstrap=2)
        distances.append(fit.chi_squared(truth))
    # with the covariance estimated from 400 trajectories this is Hotelling's T^2, larger by 3/400 or so
    assert abs(np.mean(distances) - 3) < 5 * np.sqrt(6 / 100) + 0.05


def regular_curves(rng, n, t, *, narrow):
    """ln|u + w t|/t, which has no floor."""
    u, g = rng.standard_normal((2, n, 9))
    u, g = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (u, g))
    w = g * (rng.uniform(0.5, 2, (n, 1)) if narrow else 3 * rng.lognormal(0, 1, (n, 1)) * u.sum(axis=1, keepdims=True))
    return np.log(np.linalg.norm(u[:, None] + w[:, None] * t[:, None], axis=2)) / t


@pytest.mark.parametrize("narrow", [False, True])
def test_regular_curves_have_no_floor_and_others_have_theirs(narrow):
    rng, t = np.random.default_rng(1), np.geomspace(1, 1000, 80)
    zero, found = 0, 0
    for _ in range(20):
        exponent = regular_curves(rng, 300, t, narrow=narrow)
        fit = log_fit(t, exponent, window=(50, 1000), n_bootstrap=200)
        zero += fit.floor_is_zero
        # a floor ten times the statistical error or the bias is seen
        real = 10 * max(fit.floor.standard_error, fit.floor_bias)
        with_floor = log_fit(t, exponent + real, window=(50, 1000), n_bootstrap=200)
        assert with_floor.floor.value == pytest.approx(fit.floor.value + real, rel=1e-6)
        found += not with_floor.floor_is_zero
    assert zero >= 18  # without floor_bias 10 and 0
    assert found >= 18


@pytest.mark.parametrize("unit", [1e45])
def test_logarithmic_fits_know_any_unit_of_time(unit):
    """t lambda = A + B ln t: in another unit of time B is the same and A changes by B times its logarithm."""
    time, noise = np.geomspace(100, 1000, 30), np.random.default_rng(0).normal(size=(5, 30)) / 100
    growth = 2 + 3 * np.log(time) + noise
    wanted, found = (log_fit(t, growth / t) for t in (time, time * unit))
    np.testing.assert_allclose(found.B, wanted.B, rtol=1e-9)
    np.testing.assert_allclose(found.A, wanted.A - wanted.B * np.log(unit), rtol=1e-9)
