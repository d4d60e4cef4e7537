"""Largest exponents with errors, exponents energy by energy, goodness of the fit."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import liepoisson as lp
from liepoisson.indicators.exponents_by_energy import exponents_by_energy
from liepoisson.indicators.fit_goodness import _f_tail, fit_goodness
from liepoisson.indicators.lyapunov_exponent import _is_done, lyapunov_exponent
from liepoisson.indicators.mean_error import batch_errors, mean_error, n_longest_batches
from liepoisson.indicators.verdict import decide

TOP = lp.Top.twisted_kovalevskaya()
FAST = lp.Taylor(tol=1e-9)


def test_value_is_the_growth_of_the_tangent_vector():
    x0 = lp.sample_states(TOP, 3, seed=1)
    estimate = lyapunov_exponent(TOP, x0, t_end=100, block=1, transient=0, seed=2)
    growth = lp.finite_time_exponents(TOP, x0, times=[100.0], seed=2)
    assert np.abs(estimate.exponent - growth.exponent[:, -1]).max() < 1e-8
    assert (estimate.time == 100).all()


@pytest.mark.thorough
def test_error_is_the_spread_over_nearby_starts():
    """Copies of a start that differ by 1e-9 forget each other: their spread is the error of one."""
    x0 = lp.sample_states(TOP, 1, seed=1) + 1e-9 * np.random.default_rng(0).standard_normal((32, 9))
    estimate = lyapunov_exponent(TOP, x0, t_end=4000, transient=300, method=FAST)
    spread, predicted = estimate.exponent.std(ddof=1), np.sqrt(np.mean(estimate.error**2))
    assert 0.6 < spread / predicted < 1.5  # 32 trajectories know a spread to 13%, the error to some 30%; measured 0.98


@pytest.mark.thorough
def test_a_run_goes_on_from_where_it_is_until_the_error_is_small_enough():
    x0 = lp.sample_states(TOP, 4, seed=1)
    estimate = lyapunov_exponent(TOP, x0, wanted_error=0.01, method=FAST)
    assert (estimate.error[estimate.converged] <= 0.01).all()
    assert estimate.converged.any()
    assert len(set(estimate.time)) > 1
    # nothing is done twice and nothing left out: the same blocks as one long run of each
    for k, time in enumerate(estimate.time):
        alone = lyapunov_exponent(
            TOP, x0[k], t_end=time, block=estimate.block, transient=estimate.transient, first=k, method=FAST
        )
        assert np.array_equal(alone.rates[0], estimate.rates[k, : round(time / estimate.block)])
        assert np.isnan(estimate.rates[k, round(time / estimate.block) :]).all()
        assert alone.exponent[0] == estimate.exponent[k]
        assert alone.error[0] == estimate.error[k]


def test_the_longest_run_ends_a_search_for_too_small_an_error():
    estimate = lyapunov_exponent(TOP, lp.sample_states(TOP, 2, seed=1), wanted_error=1e-9, t_end=2000, method=FAST)
    assert (estimate.time == 2000).all()
    assert not estimate.converged.any()


def test_a_run_stops_only_when_its_halves_agree_too():
    """Rates 0.1 and 0.2 of the two halves with little noise: the error of 64 batches is small, the halves differ."""
    noise = 1e-4 * np.random.default_rng(0).standard_normal((1, 256))
    steady, jump = 0.15 + noise, np.where(np.arange(256) < 128, 0.1, 0.2) + noise
    assert mean_error(jump)[0] < 0.05
    assert list(_is_done(np.concatenate([steady, jump]), 20.0, 0.05, np.ones(2))) == [True, False]
    assert not _is_done(steady, 20.0, 1e-7, np.ones(1))[0]


def test_the_text_has_the_values_of_both_halves():
    estimate = lyapunov_exponent(TOP, lp.sample_states(TOP, 1, seed=1), t_end=1280, block=20, method=FAST)
    first, second = estimate.finite_time(640)[0]
    assert f"halves {first:#.2g} and {second:#.2g}, " in str(estimate)
    rates = np.where(np.arange(64) < 32, 0.1, 0.2)[None] + 1e-4 * estimate.rates
    assert "halves 0.10 and 0.20 differ, " in str(replace(estimate, rates=rates))
    assert "too short for halves" in str(replace(estimate, rates=rates[:, :5]))


def test_intervals_have_the_quantile_of_student():
    """256 blocks make 8 longest batches, 7 degrees of freedom: 2.3646 for 95%."""
    estimate = lyapunov_exponent(TOP, lp.sample_states(TOP, 2, seed=1), t_end=5120, block=20, method=FAST)
    half = np.diff(estimate.interval(), axis=1)[:, 0] / 2
    assert half == pytest.approx(2.3646 * estimate.error, rel=1e-3)
    assert estimate.interval().mean(axis=1) == pytest.approx(estimate.exponent)


def test_number_of_longest_batches():
    for n in (4, 15, 16, 17, 64, 255, 256, 1000):
        assert n_longest_batches(n) == n // list(batch_errors(np.arange(n, dtype=float)[None]))[-1]


def test_regular_orbits_are_consistent_with_zero_and_have_neither_error_bar_nor_interval():
    x0 = lp.sample_states(TOP, 4, seed=1)
    estimate = lyapunov_exponent(lp.Top.kovalevskaya(), x0, t_end=3000, method=FAST)
    assert estimate.is_zero.all()
    assert np.isnan(estimate.interval()).all()
    assert not estimate.converged.any()
    assert np.log(3000 / estimate.time_scale) == pytest.approx(8.0, abs=0.3)
    chaotic = lyapunov_exponent(TOP, x0, t_end=3000, method=FAST)
    assert not chaotic.is_zero.any()
    assert (chaotic.interval()[:, 0] > 0).all()


def test_a_negative_exponent_is_not_consistent_with_zero():
    r"""$x'' + x'/2 + x = 0$: the real part of the eigenvalues is -1/4."""
    damped = lp.VectorField({"x": "y", "y": "-x - y/2"})
    found = lyapunov_exponent(damped, [1, 0], t_end=1000, wanted_error=0.01)
    assert not found.is_zero[0]
    assert found.converged[0]
    assert abs(found.exponent[0] + 0.25) < found.error[0] + 1 / found.time[0]


def test_mean_and_distribution_are_those_of_the_values():
    estimate = lyapunov_exponent(TOP, lp.sample_states(TOP, 12, seed=1), t_end=1280, block=20, method=FAST)
    mean = estimate.mean
    assert mean.value == pytest.approx(estimate.exponent.mean())
    assert mean.standard_error == pytest.approx(estimate.exponent.std(ddof=1) / np.sqrt(12))
    assert mean.high - mean.value == pytest.approx(stats.t.ppf(0.975, 11) * mean.standard_error, rel=1e-3)
    assert mean.contains(mean.value)
    windows = estimate.finite_time(320)
    assert windows.shape == (12, 4)
    assert windows.mean(axis=1) == pytest.approx(estimate.exponent)
    assert estimate.quantiles(0.5, duration=320) == pytest.approx(np.median(windows))
    density, edges = estimate.histogram(10)
    assert density @ np.diff(edges) == pytest.approx(1)
    one = lyapunov_exponent(TOP, np.ones(9), t_end=1280, method=FAST)
    assert one.mean[:2] == (one.exponent[0], one.error[0])  # of one orbit it is the error over its time


@pytest.mark.thorough
def test_exponents_energy_by_energy_are_those_of_the_starts():
    leaf = lp.Leaf(TOP, {"C1": 1.0, "C2": 0.2, "C3": 1.0})
    profile = exponents_by_energy(TOP, leaf=leaf, energies=[0.0, 1.0], n_starts=8, t_end=200, seed=3, method=FAST)
    x0 = leaf.sample(8, seed=3, energy=1.0)
    decided = decide(TOP, x0, t_end=200, seed=3, method=FAST)
    assert np.array_equal(profile.exponent[1], decided.exponent)
    assert np.array_equal(profile.verdict[1], decided.verdict)
    assert profile.mean[1].value == pytest.approx(decided.exponent.mean())
    assert profile.mean[1].standard_error == pytest.approx(decided.exponent.std(ddof=1) / np.sqrt(8))
    assert profile.chaotic[1] == decided.fraction("chaotic")
    assert profile.undecided[1] == decided.fraction("undecided")


def _ensemble(law, members=2000, seed=0):
    """Curves whose mean is a law of time, each with a walk of its own: t lambda(t) sums independent stretchings."""
    time = np.geomspace(10, 400, 60)
    steps = np.diff(time, prepend=0.0)
    walk = np.cumsum(np.random.default_rng(seed).standard_normal((members, len(time))) * np.sqrt(steps), axis=1)
    return time, law(time) + 0.5 * walk / time


def test_goodness_accepts_the_law_and_its_p_value_is_uniform():
    def law(t):
        return 0.12 + 0.15 / np.sqrt(t) + 0.3 / t

    values = [fit_goodness(*_ensemble(law, 300, seed)).p_value for seed in range(30)]
    assert 0.35 < np.mean(values) < 0.65  # uniform: 0.5 +- 0.053
    assert np.mean(np.array(values) < 0.1) < 0.25


def test_goodness_refuses_another_law():
    goodness = fit_goodness(*_ensemble(lambda t: 0.12 + 0.02 * np.sin(3 * np.log(t))))
    assert goodness.p_value < 1e-3
    assert goodness.n_degrees == 6


@pytest.mark.parametrize("p", [1, 2, 3, 12])
@pytest.mark.parametrize("q", [1, 2, 11, 20_000])
def test_tail_of_the_f_distribution_is_exact(p, q):
    ratios = [0.0, 1e-300, 1e-38, 1e-36, 1e-9, 1e-3, 0.5, 0.9, 1.0, 1.1, 2.0, 5.0, 8.0, 20.0, 1e3]
    expected = stats.f.sf(ratios, p, q)
    got = np.array([_f_tail(ratio, p, q) for ratio in ratios])
    kept = expected > 1e-300
    # what logarithms of Gamma(q/2) lose: 1e-16 of 1e5; measured 3.7e-11 for q = 20,000
    assert np.abs(got / np.where(kept, expected, 1) - 1)[kept].max() < 1e-9
    assert (got[~kept] < 1e-290).all()
