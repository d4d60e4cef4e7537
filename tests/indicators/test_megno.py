"""MEGNO: closed forms, the laws of tori and of chaos, quadrature, pieces, bad input."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
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


def test_rotation_about_a_fixed_axis_has_zero():
    """H linear on so(3)*: l' = l x c, an isometry, so ln|v| = 0 and Y = 0 but for round-off."""
    spin = lp.System(lp.so(3) @ lp.trivial(), "l1 + 2*l2 - l3/2")
    result = megno(spin, [[1.0, 0.5, -0.3], [0.0, 2.0, 1.0]], t_end=300)
    assert np.abs(result.megno).max() < 1e-11
    assert np.abs(result.mean).max() < 1e-11


def test_tori_tend_to_two():
    """Free rigid body: linear growth, mean Y = 2 - O(ln t/t); between 1.9 and 2.1 for all 32 starts at t = 1e4."""
    body = lp.Top.free_rigid_body(inertia=(1, 2, 3))
    result = megno(body, lp.sample_states(body, 32, seed=1), t_end=1e4, n_samples=8192)
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
    fine = megno(CHAOTIC, x0, t_end=100, n_samples=64_000)
    coarse = megno(CHAOTIC, x0, t_end=100, n_samples=800)
    assert np.array_equal(fine.time, coarse.time)
    assert (np.abs(fine.megno - coarse.megno).max(axis=1) < coarse.quadrature_error).all()
    assert (coarse.quadrature_error > 100 * fine.quadrature_error).all()


def test_log_growth_is_that_of_the_exponent():
    x0 = lp.sample_states(CHAOTIC, 3, seed=1)
    result = megno(CHAOTIC, x0, t_end=50, seed=4)
    growth = lp.finite_time_exponents(CHAOTIC, x0, times=result.time, seed=4)
    assert np.abs(result.log_growth - growth.exponent * growth.time).max() < 1e-12


def test_members_are_the_same_in_pieces_and_for_any_number_of_threads():
    x0 = lp.sample_states(CHAOTIC, 260, seed=3)  # more than one chunk
    whole = megno(CHAOTIC, x0, t_end=10, n_samples=64, seed=1, threads=1)
    part = megno(CHAOTIC, x0[250:258], t_end=10, n_samples=64, seed=1, first=250, threads=2)
    for name in ("megno", "mean", "log_growth", "quadrature_error"):
        assert np.array_equal(getattr(whole, name)[250:258], getattr(part, name)), name
    assert whole.time[-1] == 10


def test_a_trajectory_that_fails_is_an_outcome():
    x0 = np.array([np.ones(9), np.full(9, 1e200), np.full(9, np.nan)])
    result = megno(CHAOTIC, x0, t_end=3)
    assert list(result.outcome) == ["finished", "not finite", "not finite"]
    assert np.isfinite(result.mean[0]).all()
    assert np.isnan(result.mean[1:, -1]).all()
    assert np.isnan(result.quadrature_error[1:]).all()


def test_no_trajectories_give_an_empty_result():
    result = megno(CHAOTIC, np.empty((0, 9)), t_end=10, n_samples=64, progress=lambda _: None)
    assert result.mean.shape == result.log_growth.shape == (0, 32)
    assert result.outcome.shape == result.quadrature_error.shape == (0,)


@pytest.mark.parametrize(("n_samples", "n"), [(2**26, 1), (2**20, 256)])
def test_samples_beyond_four_gib_are_refused(n_samples, n):
    with pytest.raises(ParameterError, match="n_samples: wanted at most 4 GiB"):
        megno(CHAOTIC, np.ones((n, 9)), t_end=1, n_samples=n_samples)


def test_progress_is_reported_in_order():
    seen = []
    megno(CHAOTIC, lp.sample_states(CHAOTIC, 600, seed=1), t_end=2, n_samples=16, progress=seen.append)
    assert seen == sorted(seen)
    assert not seen or seen[-1] <= 1


@pytest.mark.parametrize("arguments", [{"t_end": 0}, {"t_end": np.inf}, {"t_end": 1, "n_samples": 3}])
def test_bad_input_is_refused(arguments):
    with pytest.raises(ParameterError):
        megno(CHAOTIC, np.ones(9), **arguments)
    with pytest.raises(ShapeError):
        megno(CHAOTIC, np.ones(8), t_end=1)
