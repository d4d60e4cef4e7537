"""Fits of ensemble growth, on synthetic ensembles whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.indicators.finite_time_fit import (
    EnsembleReduction,
    Estimate,
    Resampling,
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
    # 400 ensembles of 200 members: at 90 % the count of covering intervals is binomial with standard deviation 6.
    # Skewness at n = 200 costs the percentile interval up to 1 % of coverage, so the count is between 336 and 384
    # with probability of error below 1e-3 per coefficient.
    n_ensembles, covered = 400, dict.fromkeys(TRUTH, 0)
    for seed in range(n_ensembles):
        fit = finite_time_fit(TIME, synthetic_ensemble(200, seed), n_bootstrap=300, confidence=0.9, seed=seed)
        for name, truth in TRUTH.items():
            covered[name] += fit.estimates[name].contains(truth)
    for name, count in covered.items():
        assert 336 <= count <= 384, f"{name}: {count} of {n_ensembles} intervals at 90 % cover the truth"


@pytest.mark.thorough
def test_band_of_the_mean_covers_the_truth():
    truth = TRUTH["lambda"] + TRUTH["c1"] / np.sqrt(TIME) + TRUTH["c0"] / TIME
    covered = np.zeros(TIME.size)
    for seed in range(400):
        curve = mean_curve(TIME, synthetic_ensemble(100, seed))
        covered += (curve.low <= truth) & (truth <= curve.high)
    # Binomial(400, 0.95) has standard deviation 4.4; correlated times, so bound the worst time at five deviations.
    assert covered.min() >= 380 - 22, covered.min()
    assert covered.max() <= 380 + 20, covered.max()
    assert 375 <= covered.mean() <= 390


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


def test_next_term_of_the_regular_law_is_not_taken_for_a_floor():
    # ln|u + w t| with |u| = 30 |w| orthogonal: exactly ln t + ln(1 + 900/t^2)/2, and with u along w ln t + 30/t + ...
    generator = np.random.default_rng(12)
    offset = np.abs(10 + generator.standard_normal((400, 1)))
    exponent = (np.log(TIME + offset) + 0.01 * generator.standard_normal((400, TIME.size))) / TIME
    fit = log_fit(TIME, exponent, window=(50, 1000))
    assert not fit.linear_term_is_zero
    assert abs(fit.floor.value) < 0.1 * abs(fit.D)
    assert "not zero within its error" in str(fit)


def test_pieces_give_what_the_whole_gives():
    exponent = synthetic_ensemble(301, seed=7)
    whole = EnsembleReduction(TIME, windows=[(20, 200), (5, 100)], log_windows=[(50, 1000)])
    whole.add(exponent)
    streamed = EnsembleReduction(TIME, windows=[(20, 200), (5, 100)], log_windows=[(50, 1000)])
    for start in range(0, 301, 64):
        streamed.add(exponent[start : start + 64])
    for one, other in zip(whole.finite_time_fits(), streamed.finite_time_fits(), strict=True):
        for name in TRUTH:
            np.testing.assert_allclose(one.estimates[name], other.estimates[name], rtol=1e-10)
    for laws in ("estimates", "with_linear_term", "with_next_term"):
        one, other = getattr(whole.log_fits()[0], laws), getattr(streamed.log_fits()[0], laws)
        for name, estimate in one.items():
            np.testing.assert_allclose(other[name], estimate, rtol=1e-7)
    curve, streamed_curve = whole.mean_curve(), streamed.mean_curve()
    np.testing.assert_allclose(curve.mean, exponent.mean(axis=0), rtol=1e-12)
    np.testing.assert_allclose(curve.standard_error, exponent.std(axis=0, ddof=1) / np.sqrt(301), rtol=1e-12)
    np.testing.assert_allclose(streamed_curve.mean, curve.mean, rtol=1e-12)
    np.testing.assert_allclose(streamed_curve.standard_error, curve.standard_error, rtol=1e-11)


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


def test_same_seed_gives_the_same_numbers_and_another_seed_others():
    exponent = synthetic_ensemble(50, seed=9)
    assert finite_time_fit(TIME, exponent, seed=1) == finite_time_fit(TIME, exponent, seed=1)
    assert finite_time_fit(TIME, exponent, seed=1).intervals != finite_time_fit(TIME, exponent, seed=2).intervals


def test_scan_over_windows_agrees_with_single_fits():
    exponent = synthetic_ensemble(60, seed=10)
    windows = [(5.0, 100.0), (20.0, 200.0), (50.0, 1000.0)]
    scan = window_scan(TIME, exponent, windows=windows)
    assert [fit.window for fit in scan] == windows
    for fit, window in zip(scan, windows, strict=True):
        single = finite_time_fit(TIME, exponent, window=window)
        for name in TRUTH:
            np.testing.assert_allclose(fit.estimates[name], single.estimates[name], rtol=1e-9)


def test_a_scan_over_no_window_is_refused():
    exponent = synthetic_ensemble(60, seed=10)
    with pytest.raises(ParameterError, match=r"windows: wanted at least one \(start, end\); got none"):
        window_scan(TIME, exponent, windows=[])


def test_default_windows_lie_inside_the_sample_times():
    windows = window_grid(np.arange(1.0, 251.0))
    assert (25.0, 250.0) in windows
    assert all(2 * start <= end <= 250 for start, end in windows)
    assert (50.0, 125.0) in windows
    assert (50.0, 50.0) not in windows
    assert last_decade(np.arange(1.0, 251.0)) == (25.0, 250.0)
    # and follow the unit of time
    assert np.array(window_grid(1e-6 * np.arange(1.0, 251.0))) == pytest.approx(1e-6 * np.array(windows))


def test_an_estimate_reads_with_its_error():
    assert str(Estimate(0.12357, 0.00049, 0.1, 0.2)) == "0.12357 ± 0.00049"
    assert str(Estimate(-1.1712, 0.0234, -1.2, -1.1)) == "-1.171 ± 0.023"
    assert str(Estimate(2.0, 0.0, 2.0, 2.0)) == "2 ± 0"


@pytest.mark.thorough
def test_large_ensemble_is_fitted_in_modest_memory():
    import tracemalloc

    exponent = np.broadcast_to(TIME**-0.5, (20_000, TIME.size))
    reduction = EnsembleReduction(TIME, windows=window_grid(TIME))
    tracemalloc.start()
    for start in range(0, 20_000, 1000):
        reduction.add(exponent[start : start + 1000])
    reduction.finite_time_fits()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # 20,000 x 78 coefficients are 12.5 MB, once in pieces and once joined; a block of replicates is 16 MB.
    assert peak < 64e6, f"peak {peak / 1e6:.0f} MB"


BAD_CALLS = [
    (np.ones((3, 4)), np.ones((3, 4)), {}, ShapeError, "time must have shape"),
    (TIME, np.ones(TIME.size), {}, ShapeError, "Transpose"),
    (TIME, np.ones((TIME.size, 5)), {}, ShapeError, "Transpose"),
    (TIME - 1, np.ones((5, TIME.size)), {}, ParameterError, "strictly increasing"),
    (TIME[::-1], np.ones((5, TIME.size)), {}, ParameterError, "strictly increasing"),
    (np.where(TIME == 7, np.nan, TIME), np.ones((5, TIME.size)), {}, ParameterError, "finite"),
    (TIME, np.full((5, TIME.size), np.nan), {}, ParameterError, "5 did not finish"),
    (TIME, np.ones((1, TIME.size)), {}, ParameterError, "at least 2 members"),
    (TIME, np.ones((5, TIME.size)), {"window": (200, 20)}, ParameterError, "start < end"),
    (TIME, np.ones((5, TIME.size)), {"window": (20, np.inf)}, ParameterError, "start < end"),
    (TIME, np.ones((5, TIME.size)), {"window": (2000, 3000)}, ParameterError, "must lie inside the sample times"),
    (TIME, np.ones((5, TIME.size)), {"window": (20, 22)}, ParameterError, "at least 5 sample times"),
    (TIME, np.ones((5, TIME.size)), {"confidence": 95}, ParameterError, "between 0 and 1"),
    (TIME, np.ones((5, TIME.size)), {"n_bootstrap": 0}, ParameterError, "n_bootstrap"),
    (TIME, np.ones((5, TIME.size)), {"seed": -1}, ParameterError, "seed"),
]


@pytest.mark.parametrize(("time", "exponent", "options", "error", "message"), BAD_CALLS)
def test_bad_input_is_refused_with_a_reason(time, exponent, options, error, message):
    with pytest.raises(error, match=message):
        finite_time_fit(time, exponent, **options)


def test_no_windows_and_bad_resampling_are_refused():
    with pytest.raises(ParameterError, match="no window"):
        window_grid(np.arange(1.0, 5.0))
    with pytest.raises(ParameterError, match="confidence"):
        Resampling(confidence=0.0)
    with pytest.raises(ParameterError, match="time must lie in"):
        mean_curve(TIME, synthetic_ensemble(5, seed=0)).at(2000.0)


@pytest.mark.thorough
def test_chi_squared_of_the_truth_has_mean_three():
    """Over 400 ensembles the mean is 3 with deviation sqrt(6/400); 5 sigma, error probability 6e-7."""
    rng = np.random.default_rng(8)
    time, truth = np.arange(20.0, 201.0), np.array([0.12, 0.15, 0.4])
    law = np.stack([np.ones_like(time), time**-0.5, 1 / time])
    # coefficients of single members with strong correlations
    mixing = np.array([[0.05, 0.0, 0.0], [-0.4, 0.2, 0.0], [1.0, -1.5, 0.7]])
    distances = []
    for _ in range(400):
        members = (truth + rng.standard_normal((400, 3)) @ mixing.T) @ law
        fit = finite_time_fit(time, members, n_bootstrap=2)
        distances.append(fit.chi_squared(truth))
    # with the covariance estimated from 400 members this is Hotelling's T^2, larger by 3/400 or so
    assert abs(np.mean(distances) - 3) < 5 * np.sqrt(6 / 400) + 0.05


def test_a_window_that_reaches_beyond_the_data_is_refused():
    members = np.ones((5, TIME.size)) + np.arange(5)[:, None]
    end = TIME[-1]
    for window in ((20, 2 * end), (TIME[0] / 2, 50)):
        with pytest.raises(ParameterError, match="must lie inside the sample times"):
            finite_time_fit(TIME, members, window=window)
    assert finite_time_fit(TIME, members, window=(20, end * (1 + 1e-12))).n_times > 3


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


@pytest.mark.parametrize("unit", [1e-45, 1e45])
def test_logarithmic_fits_know_any_unit_of_time(unit):
    """t lambda = A + B ln t: in another unit of time B is the same and A changes by B times its logarithm."""
    time, noise = np.geomspace(100, 1000, 30), np.random.default_rng(0).normal(size=(5, 30)) / 100
    growth = 2 + 3 * np.log(time) + noise
    wanted, found = (log_fit(t, growth / t) for t in (time, time * unit))
    np.testing.assert_allclose(found.B, wanted.B, rtol=1e-9)
    np.testing.assert_allclose(found.A, wanted.A - wanted.B * np.log(unit), rtol=1e-9)


@pytest.mark.parametrize("largest", [1e120, 1e150, 1e200])
def test_times_whose_powers_fit_into_no_double_are_refused(largest):
    time = np.geomspace(largest / 10, largest, 30)
    with pytest.raises(ParameterError, match="another unit of time"):
        log_fit(time, np.ones((3, 30)) / time)
