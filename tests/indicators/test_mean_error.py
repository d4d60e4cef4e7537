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
from liepoisson.errors import ParameterError
from liepoisson.indicators.mean_error import mean_error, mean_interval, mean_over_starts, student_quantile

TOP = lp.Top.twisted_kovalevskaya()
CASES = 4000


def coverage(hits):
    """Share of the cases, and five standard deviations of it at the least favourable p."""
    return float(np.mean(hits)), 5 * 0.5 / np.sqrt(len(hits))


def starts_with_errors(n, own):
    """Values of n starts: a spread of one over the starts, and errors of their own over time."""
    stream = np.random.default_rng(7)
    return stream.standard_normal((CASES, n)) + own * stream.standard_normal((CASES, n))


@pytest.mark.parametrize(("n", "one", "two"), [(10, 0.656, 0.918), (50, 0.678, 0.944)])
@pytest.mark.parametrize("own", [0.1, 2.0])
def test_the_error_of_a_mean_over_starts_covers_the_mean_of_all_starts(n, one, two, own):
    """By Student's t with n - 1 degrees one error covers 65.7% and 67.8%, and 1.96 errors 91.8% and 94.4%."""
    values = starts_with_errors(n, own)
    mean, error = mean_over_starts(values.T, np.full(values.T.shape, own))
    for width, wanted in ((1.0, one), (1.96, two)):
        found, slack = coverage(np.abs(mean) < width * error)
        assert wanted == pytest.approx(1 - 2 * stats.t.sf(width, n - 1), abs=2e-3)
        assert found == pytest.approx(wanted, abs=slack)


def test_the_errors_over_time_alone_would_cover_next_to_nothing():
    """What a spectrum printed before: the errors of the runs combined, where the starts differ ten times as much."""
    values = starts_with_errors(50, 0.1)
    found, _ = coverage(np.abs(values.mean(axis=1)) < 1.96 * 0.1 / np.sqrt(50))
    assert found < 0.2


@pytest.mark.parametrize("n", [2, 3, 10])
def test_intervals_of_means_hold_what_they_say_from_two_starts_on(n):
    values = starts_with_errors(n, 0.1)
    found, slack = coverage([mean_interval(row, confidence=0.9).contains(0.0) for row in values])
    assert found == pytest.approx(0.9, abs=slack)


@pytest.mark.parametrize("n_degrees", range(1, 15))
def test_quantiles_of_few_degrees(n_degrees):
    for probability in (0.005, 0.16, 0.5, 0.84, 0.975, 0.995):
        expected = stats.t.ppf(probability, n_degrees)
        assert student_quantile(probability, n_degrees) == pytest.approx(expected, abs=1e-3)


def test_one_start_has_the_error_of_its_run_and_none_has_none():
    mean, error = mean_over_starts([[1.0, 2.0]], [[0.1, 0.2]])
    assert (mean.tolist(), error.tolist()) == ([1.0, 2.0], [0.1, 0.2])
    assert np.isnan(mean_over_starts(np.empty((0, 2)), np.empty((0, 2)))).all()
    assert np.isnan(mean_interval([1.0])[1:]).all()
    with pytest.raises(ParameterError, match="confidence"):
        mean_interval([1.0, 2.0], confidence=2)


def test_the_error_of_one_run_covers_its_mean_over_time():
    """Correlated rates, 0.5^j: 1,000 runs of 256; the larger one of two errors is 8% to 14% too large."""
    stream, rates = np.random.default_rng(3), np.empty((1000, 256))
    rates[:, 0] = stream.standard_normal(1000)
    for k in range(1, 256):
        rates[:, k] = 0.5 * rates[:, k - 1] + np.sqrt(0.75) * stream.standard_normal(1000)
    found, slack = coverage(np.abs(rates.mean(axis=1)) < 1.96 * mean_error(rates))
    assert found == pytest.approx(0.95, abs=slack)


@pytest.fixture(scope="module")
def spectrum():
    return lp.lyapunov_spectrum(TOP, lp.sample_states(TOP, 9, seed=1), t_end=200)


def test_the_printed_error_of_a_spectrum_is_the_spread_over_the_starts(spectrum):
    mean, error = spectrum.mean
    assert mean == pytest.approx(spectrum.end_exponent.mean(axis=0))
    assert error == pytest.approx(spectrum.end_exponent.std(axis=0, ddof=1) / 3)
    ends = spectrum.end_exponent[:, 0]
    assert f"± {error[0]:.2g} (over 9 starts), from {ends.min():.2g} to {ends.max():.2g} at t" in repr(spectrum)


def test_of_one_orbit_it_is_the_error_over_its_time(spectrum):
    alone = replace(spectrum, outcome=np.array(["finished"] + ["step too small"] * 8))
    mean, error = alone.mean
    assert np.array_equal(mean, spectrum.end_exponent[0])
    assert np.array_equal(error, spectrum.error[0])
    assert f"± {error[0]:.2g} (over the time of one orbit)" in repr(alone)


def test_all_means_over_starts_have_the_same_error(spectrum):
    """A spectrum, exponents with errors and a sweep: property or not, one number."""
    values = spectrum.end_exponent[:, 0]
    estimate = lp.lyapunov_exponent(TOP, lp.sample_states(TOP, 3, seed=1), t_end=200)
    same = replace(estimate, exponent=values)
    assert same.mean.standard_error == pytest.approx(spectrum.mean[1][0])
    assert same.mean.value == pytest.approx(spectrum.mean[0][0])
    swept = lp.sweep(system=lp.Top.kovalevskaya, axes={"epsilon": [1.0]}, n_starts=9, t_end=20)
    assert swept.standard_error[0] == pytest.approx(mean_over_starts(swept.value[0], swept.value[0])[1])
