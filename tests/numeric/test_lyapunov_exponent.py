"""Largest exponents with errors, exponents energy by energy, goodness of the fit."""

import time as clock

import numpy as np
import pytest
from scipy import stats

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.indicators.exponents_by_energy import exponents_by_energy
from liepoisson.indicators.fit_goodness import _f_tail, fit_goodness
from liepoisson.indicators.lyapunov_exponent import _is_done, lyapunov_exponent
from liepoisson.indicators.mean_error import batch_errors, mean_error, n_longest_batches, proportion, student_quantile
from liepoisson.indicators.verdict import decide
from liepoisson.numeric.time_scale import zero_threshold

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
    assert 0.6 < spread / predicted < 1.5  # 32 members know a spread to 13%, the error to some 30%; measured 0.98


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
    assert str(estimate).count("error not as wanted") == 2


def test_a_run_stops_only_when_its_halves_agree_too():
    """Rates 0.1 and 0.2 of the two halves with little noise: the error of 64 batches is small, the halves differ."""
    noise = 1e-4 * np.random.default_rng(0).standard_normal((1, 256))
    steady, jump = 0.15 + noise, np.where(np.arange(256) < 128, 0.1, 0.2) + noise
    assert mean_error(jump)[0] < 0.05
    assert list(_is_done(np.concatenate([steady, jump]), 20.0, 0.05, np.ones(2))) == [True, False]
    assert not _is_done(steady, 20.0, 1e-7, np.ones(1))[0]


def test_intervals_have_the_quantile_of_student():
    """256 blocks make 8 longest batches, 7 degrees of freedom: 2.3646 for 95%."""
    estimate = lyapunov_exponent(TOP, lp.sample_states(TOP, 2, seed=1), t_end=5120, block=20, method=FAST)
    half = np.diff(estimate.interval(), axis=1)[:, 0] / 2
    assert half == pytest.approx(2.3646 * estimate.error, rel=1e-3)
    assert estimate.interval().mean(axis=1) == pytest.approx(estimate.exponent)


@pytest.mark.parametrize("n_degrees", [7, 10, 14])
@pytest.mark.parametrize("probability", [0.005, 0.16, 0.5, 0.975, 0.995])
def test_quantiles_of_student(n_degrees, probability):
    expected = stats.t.ppf(probability, n_degrees)
    assert student_quantile(probability, n_degrees) == pytest.approx(expected, abs=1e-3)


def test_number_of_longest_batches():
    for n in (4, 15, 16, 17, 64, 255, 256, 1000):
        assert n_longest_batches(n) == n // list(batch_errors(np.arange(n, dtype=float)[None]))[-1]


def test_regular_orbits_are_consistent_with_zero_and_have_neither_error_bar_nor_interval():
    x0 = lp.sample_states(TOP, 4, seed=1)
    estimate = lyapunov_exponent(lp.Top.kovalevskaya(), x0, t_end=3000, method=FAST)
    assert estimate.is_zero.all()
    assert np.isnan(estimate.interval()).all()
    assert not estimate.converged.any()
    assert "consistent with zero at t = 3000: below 3 ln(t/T) / t = 8." in str(estimate)
    assert np.log(3000 / estimate.time_scale) == pytest.approx(8.0, abs=0.3)
    chaotic = lyapunov_exponent(TOP, x0, t_end=3000, method=FAST)
    assert not chaotic.is_zero.any()
    assert (chaotic.interval()[:, 0] > 0).all()


@pytest.mark.thorough
def test_a_sticky_orbit_is_consistent_with_zero_until_it_leaves_its_island():
    """So the threshold bounds no exponent: 0.011 at t = 2,000, and the exponent is 0.076 at t = 20,000."""
    top = lp.Top.heavy(inertia=(2, 2, 1.2), a=(-1, 0, 0))
    start = lp.sample_states(top, 1, seed=100, first=424)
    early, late = (lyapunov_exponent(top, start, t_end=t) for t in (2000, 20000))
    assert early.is_zero[0]
    assert not late.is_zero[0]
    assert late.interval()[0, 0] > zero_threshold(2000, early.time_scale)[0]


@pytest.mark.thorough
def test_a_regular_orbit_goes_on_until_its_threshold_is_small_enough():
    """3 ln t / t is 0.0050 at the first look, t = 5,120, and 0.0035 at the second, t = 7,680."""
    x0 = lp.sample_states(TOP, 1, seed=1)
    estimate = lyapunov_exponent(lp.Top.kovalevskaya(), x0, wanted_error=0.004, method=FAST)
    assert estimate.is_zero.all()
    assert estimate.time[0] == pytest.approx(7680)


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
    with pytest.raises(ParameterError, match="duration: wanted a time from 20 to 1280"):
        estimate.finite_time(5)
    one = lyapunov_exponent(TOP, np.ones(9), t_end=1280, method=FAST)
    assert one.mean[:2] == (one.exponent[0], one.error[0])  # of one orbit it is the error over its time


def test_a_trajectory_that_fails_is_an_outcome():
    estimate = lyapunov_exponent(TOP, np.array([np.ones(9), np.full(9, 1e200)]), t_end=1280, method=FAST)
    assert list(estimate.outcome) == ["finished", "not finite"]
    assert np.isnan(estimate.exponent[1])
    assert not estimate.converged[1]
    assert "no value" in str(estimate)
    assert np.isfinite(estimate.exponent[0])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "wanted t_end, wanted_error, or both"),
        ({"wanted_error": 0}, "wanted_error: wanted a positive number"),
        ({"wanted_error": np.nan}, "wanted_error: wanted a positive number"),
        ({"t_end": 100, "block": 20}, "at least 64 blocks"),
        ({"t_end": 100, "block": 0}, "block: wanted a positive finite time"),
        ({"t_end": -1}, "t_end: wanted a positive finite time"),
        ({"t_end": 1e12}, "t_end: wanted at most 10000000 intervals"),
        ({"t_end": 1e300}, "t_end: wanted at most 10000000 intervals"),
        ({"wanted_error": 0.01, "block": 1e-9}, "longer block"),
        ({"wanted_error": 0.01, "transient": 1e300}, "transient: wanted at most 10000000 intervals"),
    ],
)
def test_bad_arguments_are_refused(arguments, words):
    with pytest.raises(ParameterError, match=words):
        lyapunov_exponent(TOP, np.ones(9), **arguments)


@pytest.mark.thorough
@pytest.mark.parametrize("run", [{"t_end": 1e8}, {"t_end": 1e4, "transient": 1e8}])
def test_a_time_limit_ends_runs_of_millions_of_blocks(run):
    start = clock.monotonic()
    estimate = lyapunov_exponent(TOP, np.ones(9), time_limit=0.3, method=FAST, **run)
    assert clock.monotonic() - start < 5
    assert list(estimate.outcome) == ["time limit"]
    assert not estimate.converged.any()


def test_quantiles_and_histograms_of_wrong_numbers_are_refused():
    estimate = lyapunov_exponent(TOP, lp.sample_states(TOP, 2, seed=1), t_end=1280, method=FAST)
    for q in (2, np.nan, "x", None, [0.5, -1]):
        with pytest.raises(ParameterError, match="q: wanted numbers from 0 to 1"):
            estimate.quantiles(q)
    for bins in (0, "x", 1e12, 10**12):
        with pytest.raises(ParameterError, match="bins: wanted a whole number"):
            estimate.histogram(bins)
    failed = lyapunov_exponent(TOP, np.full((2, 9), 1e200), t_end=1280, method=FAST)
    for distribution in (lambda: failed.quantiles(0.5), failed.histogram):
        with pytest.raises(ParameterError, match="trajectories with a value"):
            distribution()


@pytest.mark.thorough
def test_leaves_of_other_systems_and_bad_numbers_are_refused():
    leaf = lp.Leaf(TOP, {"C1": 1.0, "C2": 0.2, "C3": 1.0})
    run = {"energies": [0.0], "n_starts": 2, "t_end": 5.0}
    same = exponents_by_energy(lp.Top.twisted_kovalevskaya(), leaf=leaf, **run)
    assert np.array_equal(same.exponent, exponents_by_energy(TOP, leaf=leaf, **run).exponent)
    # another bracket, another field, another number of components
    for other in (lp.Top.kovalevskaya(), lp.Top.twisted_lagrange(), lp.catalog.system("manakov-so4")):
        with pytest.raises(ParameterError, match="leaf: wanted a leaf of the system"):
            exponents_by_energy(other, leaf=leaf, **run)
    for wrong, words in (
        ({"leaf": None}, "leaf: wanted a Leaf"),
        ({"rule": 0.02}, "rule: wanted a Rule"),
        ({"n_starts": 10**12}, "n_starts: wanted a whole number from 1 to 10000000"),
    ):
        with pytest.raises(ParameterError, match=words):
            exponents_by_energy(TOP, **({"leaf": leaf} | run | wrong))


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
    assert "C2 = 0.2" in str(profile)
    with pytest.raises(ShapeError, match="one or more energies"):
        exponents_by_energy(TOP, leaf=leaf, energies=[], n_starts=2, t_end=10)


@pytest.mark.thorough
def test_integrable_top_has_no_chaotic_energy():
    top = lp.Top.twisted_lagrange()
    leaf = lp.Leaf(top, {"C1": 1.0, "C2": 0.2, "C3": 1.0})
    profile = exponents_by_energy(top, leaf=leaf, energies=[1.0, 2.0], n_starts=8, t_end=1000, method=FAST)
    assert [share.value for share in profile.chaotic] == [0.0, 0.0]
    assert all(0.2 < share.high < 0.4 for share in profile.chaotic)  # Wilson: z^2/(n + z^2) = 0.32


def test_wilson_interval_solves_its_quadratic():
    """The ends are where (p - f)^2 = z^2 f (1 - f)/n."""
    z, n, p = 1.959964, 40, 0.3
    interval = proportion(12, n)
    for f in (interval.low, interval.high):
        assert (p - f) ** 2 == pytest.approx(z**2 * f * (1 - f) / n, rel=1e-5)
    assert proportion(0, 8).low == 0
    assert proportion(8, 8).high == 1
    with pytest.raises(ParameterError):
        proportion(9, 8)


def _ensemble(law, members=2000, seed=0):
    """Curves whose mean is a law of time, each with a walk of its own: t lambda(t) sums independent stretchings."""
    time = np.geomspace(10, 400, 60)
    steps = np.diff(time, prepend=0.0)
    walk = np.cumsum(np.random.default_rng(seed).standard_normal((members, len(time))) * np.sqrt(steps), axis=1)
    return time, law(time) + 0.5 * walk / time


@pytest.mark.thorough
def test_intervals_of_white_noise_are_wider_than_their_name():
    """The coverage that the documents state; 4,000 runs know it to 0.003."""
    values = np.random.default_rng(0).standard_normal((4000, 256))
    error = mean_error(values)
    quantile = student_quantile(0.975, n_longest_batches(256) - 1)
    assert 0.97 < np.mean(np.abs(values.mean(axis=1)) < quantile * error) < 0.995  # measured 0.982
    assert 1.05 < np.sqrt(np.mean(error**2)) * 16 < 1.15  # measured 1.10


def test_goodness_accepts_the_law_and_its_p_value_is_uniform():
    def law(t):
        return 0.12 + 0.15 / np.sqrt(t) + 0.3 / t

    values = [fit_goodness(*_ensemble(law, 300, seed)).p_value for seed in range(60)]
    assert 0.35 < np.mean(values) < 0.65  # uniform: 0.5 +- 0.037
    assert np.mean(np.array(values) < 0.1) < 0.25


def test_goodness_refuses_another_law():
    goodness = fit_goodness(*_ensemble(lambda t: 0.12 + 0.02 * np.sin(3 * np.log(t))))
    assert goodness.p_value < 1e-3
    assert "the law is refused (p < 1e-06)" in str(goodness)  # the tail of F says nothing of members so far out
    assert goodness.n_degrees == 6


@pytest.mark.parametrize("p", [1, 2, 3, 6, 12])
@pytest.mark.parametrize("q", [1, 2, 11, 60, 600, 20_000])
def test_tail_of_the_f_distribution_is_exact(p, q):
    ratios = [0.0, 1e-9, 1e-3, 0.5, 0.9, 1.0, 1.1, 2.0, 5.0, 8.0, 20.0, 1e3]
    expected = stats.f.sf(ratios, p, q)
    got = np.array([_f_tail(ratio, p, q) for ratio in ratios])
    kept = expected > 1e-300
    assert np.abs(got / np.where(kept, expected, 1) - 1)[kept].max() < 1e-9
    assert (got[~kept] < 1e-290).all()


def test_goodness_of_the_law_is_not_refused_in_words():
    goodness = fit_goodness(*_ensemble(lambda t: 0.12 + 0.1 / t))
    assert f"the law is not refused (p = {goodness.p_value:.2g})" in str(goodness)


@pytest.mark.parametrize("members", ["same", "law", "one-kind", "round-off"])
def test_goodness_wants_members_that_differ(members):
    time = np.geomspace(5, 200, 60)
    kinds = {"same": np.sin(time) * np.ones((100, 1)), "law": np.tile(0.1 + 1 / time, (100, 1))}
    kinds["one-kind"] = np.random.default_rng(0).standard_normal((100, 1)) * np.sin(time)
    kinds["round-off"] = 0.1 + 1e-17 * np.random.default_rng(0).integers(-3, 4, (100, 60))
    with pytest.raises(ParameterError, match="members that differ from each other in all 6 degrees"):
        fit_goodness(time, kinds[members])


def test_goodness_does_not_depend_on_the_unit_of_time():
    """A p-value is the same if all exponents are multiplied by a number: t -> c t, lambda -> lambda/c."""
    time, curves = _ensemble(lambda t: 0.12 + 0.1 / t)
    expected = fit_goodness(time, curves, window=(20, 200)).p_value
    assert fit_goodness(time * 1e9, curves / 1e9).p_value == pytest.approx(fit_goodness(time, curves).p_value)
    for c in (1e-9, 1e9):
        assert fit_goodness(time * c, curves / c, window=(20 * c, 200 * c)).p_value == pytest.approx(expected)


def test_goodness_wants_enough_members():
    time, curves = _ensemble(lambda t: 0.1 + 0 * t, 30)
    with pytest.raises(ParameterError, match="at least 60 members"):
        fit_goodness(time, curves)
