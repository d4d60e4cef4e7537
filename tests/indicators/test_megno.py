"""MEGNO: closed forms, the laws of tori and of chaos, quadrature, pieces, bad input."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.indicators.megno import _indicators, megno

CHAOTIC = lp.Top.twisted_kovalevskaya()


def test_exponential_growth_in_closed_form():
    """ln|v| = c t: Y = 2(c t - c t/2) = c t and its mean c t/2; the trapezoidal rule is exact for both."""
    t = np.arange(1, 81) * 0.25
    values, means, logs, change = _indicators(t, 0.7 * t[None], 8)
    assert values[0] == pytest.approx(0.7 * t[7::8], rel=1e-14)
    assert means[0] == pytest.approx(0.35 * t[7::8], rel=1e-14)
    assert np.array_equal(logs[0], 0.7 * t[7::8])
    assert change[0] < 1e-13


def test_linear_growth_in_closed_form():
    """ln|v| = ln(1 + t): the integral is (1 + t) ln(1 + t) - t, so Y = 2 - 2 ln(1 + t)/t."""
    t = np.arange(1, 4001) * 0.01
    values, _, _, change = _indicators(t, np.log1p(t)[None], 100)
    exact = 2 - 2 * np.log1p(t) / t
    # trapezoidal rule: h^2/12 |f'(t) - f'(0)| 2/t <= 2e-5 / t for h = 0.01
    assert np.abs(values[0] - exact[99::100]).max() < 2e-5
    # half as many samples have four times the error, so the stated change is three times the error
    assert np.abs(values[0] - exact[99::100]).max() < change[0] < 1e-4


def test_tori_tend_to_two():
    """Free rigid body: linear growth, mean Y = 2 - O(ln t/t); between 1.9 and 2.1 for all starts at t = 1e4."""
    body = lp.Top.free_rigid_body(inertia=(1, 2, 3))
    result = megno(body, lp.sample_states(body, 16, seed=1), t_end=1e4, n_samples=8192)
    assert result.mean[:, -1].min() > 1.9
    assert result.mean[:, -1].max() < 2.1


def test_chaos_grows_with_half_the_exponent():
    """At a saddle with exponent sqrt 2, ln|v| = t sqrt 2 + const: mean Y = t/sqrt 2 + O(1)."""
    upright = np.zeros(9)
    upright[3] = -2.0
    result = megno(lp.Top.heavy(inertia=(2, 2, 1), a=(-1, 0, 0)), upright, t_end=1000)
    assert result.mean[0, -1] == pytest.approx(1000 / np.sqrt(2), abs=3)
    chaotic = megno(CHAOTIC, lp.sample_states(CHAOTIC, 16, seed=1), t_end=1000)
    assert (chaotic.mean[:, -1] > 10).all()


def test_quadrature_error_is_stated():
    """A coarse grid must not differ from a fine one by more than it says."""
    x0 = lp.sample_states(CHAOTIC, 8, seed=1)
    fine = megno(CHAOTIC, x0, t_end=100, n_samples=16_000)
    coarse = megno(CHAOTIC, x0, t_end=100, n_samples=400)
    assert np.array_equal(fine.time, coarse.time)
    assert (np.abs(fine.megno - coarse.megno).max(axis=1) < coarse.quadrature_error).all()
    assert (coarse.quadrature_error > 50 * fine.quadrature_error).all()


def test_log_growth_is_that_of_the_exponent():
    x0 = lp.sample_states(CHAOTIC, 3, seed=1)
    result = megno(CHAOTIC, x0, t_end=50, seed=4)
    growth = lp.finite_time_exponents(CHAOTIC, x0, times=result.time, seed=4)
    assert np.abs(result.log_growth - growth.exponent * growth.time).max() < 1e-12
