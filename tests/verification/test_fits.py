"""Powers are recovered, and their errors are those of repeated experiments."""

import numpy as np
import pytest

import fits


def test_order_is_recovered_and_the_plateau_masked():
    """Errors c h^p with p spread over starts by 0.1, on a floor of 1e-13 and with a top at 1."""
    rng = np.random.default_rng(0)
    steps = np.geomspace(1e-3, 1, 30)
    powers = 6 + 0.1 * rng.standard_normal(16)
    errors = np.minimum(rng.uniform(0.1, 1, 16)[:, None] * steps ** powers[:, None] + 1e-16, 0.5)
    errors[:, steps < 0.01] = 1e-13
    found = fits.measured_order(steps, errors, 1e-12, 1e-1)
    assert found is not None
    assert found.exponent == pytest.approx(powers.mean(), abs=1e-2)
    assert found.error == pytest.approx(powers.std(ddof=1) / 4, rel=0.05)


def test_a_start_that_failed_has_no_say():
    steps = np.array([0.1, 0.2, 0.4, 0.8])
    errors = 1e-3 * np.stack([steps**2, steps**2, steps**2])
    errors[2, 1:] = np.nan
    found = fits.measured_order(steps, errors, 1e-12, 1.0)
    assert found is not None
    assert found.exponent == pytest.approx(2)
    assert found.n_points == 8


def test_too_few_points_give_no_order():
    steps, errors = np.array([0.1, 0.2, 0.4]), np.full((4, 3), 1e-16)
    assert fits.measured_order(steps, errors, 1e-12, 1e-2) is None


@pytest.mark.parametrize(("bias", "power"), [(0.0, 0.5), (1.0, 1.0)])
def test_random_walks_and_biases_are_told_apart(bias, power):
    """64 walks of unit steps and a drift of +-1 a step: sqrt(n), and n; the error bar covers what is found."""
    rng = np.random.default_rng(1)
    time = np.unique(np.geomspace(10, 10_000, 20).astype(int))
    drift = bias * rng.choice([-1, 1], (64, 1))
    walk = (rng.standard_normal((64, 10_000)) + drift).cumsum(axis=1)[:, time - 1]
    found = fits.growth_of_rms(time.astype(float), walk**2)
    assert abs(found.exponent - power) < 4 * found.error + 0.02
    assert found.error < 0.1


def test_the_jackknife_is_the_spread_of_repeated_experiments():
    """The standard error of p from one ensemble, against the spread of p over 200 ensembles (itself known to 5%)."""
    rng = np.random.default_rng(2)
    time = np.geomspace(10, 1000, 10).astype(int)
    fitted = [
        fits.growth_of_rms(time.astype(float), rng.standard_normal((32, 1000)).cumsum(axis=1)[:, time - 1] ** 2)
        for _ in range(200)
    ]
    spread = np.std([found.exponent for found in fitted], ddof=1)
    assert np.mean([found.error for found in fitted]) == pytest.approx(spread, rel=0.2)
