"""What a printed error covers: the number before it, over the starts or over the time of one orbit.

The simulations have fixed seeds.  A count of N independent cases with coverage p has the standard deviation
sqrt(N p (1 - p)); bounds lie five of them away from what is stated, so that a right program fails with a probability
below 1e-6.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import liepoisson as lp
from liepoisson.indicators.mean_error import batch_errors, mean_error, mean_interval, mean_over_starts, student_quantile

TOP = lp.Top.twisted_kovalevskaya()
CASES = 4000


def coverage(hits):
    """Share of the cases, and five standard deviations of it at the least favourable p."""
    return float(np.mean(hits)), 5 * 0.5 / np.sqrt(len(hits))


def starts_with_errors(n, own):
    """Values of n starts: a spread of one over the starts, and errors of their own over time."""
    stream = np.random.default_rng(7)
    return stream.standard_normal((CASES, n)) + own * stream.standard_normal((CASES, n))


@pytest.mark.parametrize(("n", "own", "one", "two"), [(10, 0.1, 0.656, 0.918), (50, 2.0, 0.678, 0.944)])
def test_the_error_of_a_mean_over_starts_covers_the_mean_of_all_starts(n, own, one, two):
    """By Student's t with n - 1 degrees one error covers 65.7% and 67.8%, and 1.96 errors 91.8% and 94.4%."""
    values = starts_with_errors(n, own)
    mean, error = mean_over_starts(values.T, np.full(values.T.shape, own))
    for width, wanted in ((1.0, one), (1.96, two)):
        found, slack = coverage(np.abs(mean) < width * error)
        assert wanted == pytest.approx(1 - 2 * stats.t.sf(width, n - 1), abs=2e-3)
        assert found == pytest.approx(wanted, abs=slack)


@pytest.mark.parametrize("n", [2, 10])
def test_intervals_of_means_hold_what_they_say_from_two_starts_on(n):
    values = starts_with_errors(n, 0.1)
    found, slack = coverage([mean_interval(row, confidence=0.9).contains(0.0) for row in values])
    assert found == pytest.approx(0.9, abs=slack)


@pytest.mark.parametrize("n_degrees", [1, 2, 3, 7, 14])
def test_quantiles_of_few_degrees(n_degrees):
    for probability in (0.005, 0.16, 0.5, 0.84, 0.975, 0.995):
        expected = stats.t.ppf(probability, n_degrees)
        assert student_quantile(probability, n_degrees) == pytest.approx(expected, abs=1e-3)


def test_one_start_has_the_error_of_its_run_and_none_has_none():
    mean, error = mean_over_starts([[1.0, 2.0]], [[0.1, 0.2]])
    assert (mean.tolist(), error.tolist()) == ([1.0, 2.0], [0.1, 0.2])
    assert np.isnan(mean_over_starts(np.empty((0, 2)), np.empty((0, 2)))).all()
    assert np.isnan(mean_interval([1.0])[1:]).all()


@pytest.fixture(scope="module")
def spectrum():
    return lp.lyapunov_spectrum(TOP, lp.sample_states(TOP, 9, seed=1), t_end=200)


def test_the_printed_error_of_a_spectrum_is_the_spread_over_the_starts(spectrum):
    mean, error = spectrum.mean
    assert mean == pytest.approx(spectrum.end_exponent.mean(axis=0))
    assert error == pytest.approx(spectrum.end_exponent.std(axis=0, ddof=1) / 3)
    assert f"± {error[0]:.2g} (over 9 starts)" in repr(spectrum)


def test_of_one_orbit_it_is_the_error_over_its_time(spectrum):
    alone = replace(spectrum, outcome=np.array(["finished"] + ["step too small"] * 8))
    mean, error = alone.mean
    assert np.array_equal(mean, spectrum.end_exponent[0])
    assert np.array_equal(error, spectrum.error[0])


@pytest.mark.parametrize("correlation", [0.0, 0.9, -0.5])
def test_error_of_a_mean_of_correlated_values(correlation):
    """x' = r x + sqrt(1 - r^2) noise: the mean of n values has the error n^-1/2 sqrt((1 + r)/(1 - r)) (1 + O(1/n))."""
    n, members = 256, 1000
    noise = np.random.default_rng(1).standard_normal((members, n)) * np.sqrt(1 - correlation**2)
    values = np.empty((members, n))
    values[:, 0] = noise[:, 0] / np.sqrt(1 - correlation**2)
    for k in range(1, n):
        values[:, k] = correlation * values[:, k - 1] + noise[:, k]
    expected = np.sqrt((1 + correlation) / (1 - correlation) / n)
    measured = np.sqrt(np.mean(mean_error(values) ** 2))
    # the larger of two estimates, of which one has 8 to 15 batches: up to 1.2 of the true one, 1.4 where negative
    assert 0.95 * expected < measured < 1.4 * expected
    assert len(batch_errors(values)) == 6
    assert batch_errors(values)[1].mean() == pytest.approx(n**-0.5, rel=0.1)


def test_error_needs_a_few_values():
    assert np.isnan(mean_error(np.ones((2, 3)))).all()
    assert (mean_error(np.ones((2, 8))) == 0).all()
