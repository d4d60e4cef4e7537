"""The rule regular / chaotic / undecided, its agreement matrix, and Wilson's interval."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import liepoisson as lp
from liepoisson.indicators.mean_error import proportion
from liepoisson.indicators.verdict import INDICATORS, Rule, agreement, decide

CHAOTIC = lp.Top.twisted_kovalevskaya()
MIXED = lp.Top.heavy(inertia=(2, 2, 1.2), a=(-1, 0, 0))

INTEGRABLE = {
    "twisted Lagrange": lp.Top.twisted_lagrange,
    "Kovalevskaya": lp.Top.kovalevskaya,
}


@pytest.fixture(scope="module")
def mixed():
    return decide(MIXED, lp.sample_states(MIXED, 120, seed=3), t_end=1000)


@pytest.mark.thorough
@pytest.mark.parametrize("name", INTEGRABLE)
def test_integrable_tops_are_never_chaotic(name):
    """0 of 1,800 in docs/chaos.md.  Averages of many tori have not settled at t = 1,000."""
    system = INTEGRABLE[name]()
    verdict = decide(system, lp.sample_states(system, 32, seed=11), t_end=1000, seed=12)
    assert not (verdict.verdict == "chaotic").any(), str(verdict)
    assert (verdict.verdict == "regular").mean() > 0.2


@pytest.mark.thorough
def test_twisted_kovalevskaya_is_chaotic():
    verdict = decide(CHAOTIC, lp.sample_states(CHAOTIC, 32, seed=11), t_end=1000, seed=12)
    assert (verdict.verdict == "chaotic").sum() >= 31  # 99.8% in docs/chaos.md
    assert (verdict.exponent > 0.01).all()  # measured: 0.0167 to 0.18


@pytest.mark.thorough
def test_verdicts_agree_with_a_long_run(mixed):
    x0 = lp.sample_states(MIXED, 120, seed=3)
    long_run = 1e4 * lp.finite_time_exponents(MIXED, x0, times=[1e4], seed=5).exponent[:, 0]
    assert not ((mixed.verdict == "chaotic") & (long_run < 15)).any()
    missed = (mixed.verdict == "regular") & (long_run > 30)
    assert missed.sum() <= 3  # 5% of 61; measured here: 0, and 5 without the vote of the averages


def test_votes_follow_the_thresholds():
    power = np.array([1.0, 3.0, 9.0, np.nan])
    mean = np.array([2.0, 4.0, 9.0, np.nan])
    sali = np.array([0.5, 1e-6, 1e-12, np.nan])
    averages = np.array([1e-3, 1e-2, 1.0, np.nan])
    votes = Rule().votes(power, mean, sali, averages)
    assert votes.tolist() == [[-1] * 4, [0] * 4, [1, 1, 1, 0], [0] * 4]
    assert Rule().kinds(votes, np.full(4, 1e3)).tolist() == ["regular", "undecided", "chaotic", "undecided"]
    assert Rule().kinds(votes, np.full(4, 99.0)).tolist() == ["undecided"] * 4


def test_regular_needs_averages_that_have_settled_and_chaotic_does_not():
    votes = np.array([[-1, -1, -1, 0], [-1, -1, 0, -1], [1, 1, 0, -1], [-1, 1, 1, 0], [-1, 0, 0, -1]], np.int8)
    kinds = Rule().kinds(votes, np.full(5, 1e3)).tolist()
    assert kinds == ["undecided", "regular", "chaotic", "undecided", "undecided"]


@pytest.mark.parametrize("t_end", [5, 50])
def test_a_short_run_decides_nothing(t_end):
    """All orbits of this top are chaotic; by their tangent vectors 50, 47 and 17 of these 50 would be regular."""
    x0 = lp.sample_states(CHAOTIC, 50, seed=1)
    assert (decide(CHAOTIC, x0, t_end=t_end).verdict == "undecided").all()
    by_votes = decide(CHAOTIC, x0, t_end=t_end, rule=Rule(least_time=0, averages=1e9))
    assert (by_votes.verdict == "regular").sum() >= 15


def test_growth_power_and_megno_of_exponential_growth():
    """ln|v| = c t/T: the slope against ln t over [T/10, T] is 0.424 c, the mean MEGNO c/2.

    An upright heavy top has |v| = cosh(sqrt 2 t) and the like; I = (2, 2, 1), alpha = (-2, 0, 0).
    """
    upright = np.zeros(9)
    upright[3] = -2.0
    top = lp.Top.heavy(inertia=(2, 2, 1), a=(-1, 0, 0))
    verdict = decide(top, upright, t_end=1000)
    growth = np.sqrt(2) * 1000
    # 2e-3 and 5e-3: the first unit of time, in which other directions matter, and samples of ln t
    assert verdict.growth_power[0] == pytest.approx(0.424 * growth, rel=2e-3)
    assert verdict.mean_megno[0] == pytest.approx(growth / 2, rel=5e-3)


def test_a_sticky_orbit_is_regular_at_first_and_chaotic_later():
    x0 = lp.sample_states(MIXED, 1, seed=100, first=424)
    assert [decide(MIXED, x0, t_end=t).verdict[0] for t in (1000, 4000)] == ["regular", "chaotic"]


def test_agreement_counts_and_lists_every_disagreement(mixed):
    report = agreement(mixed)
    assert report.indicators == INDICATORS
    assert report.n == 120
    assert report.same.diagonal().tolist() == [120] * 4
    assert report.contrary.diagonal().tolist() == [0] * 4
    one, other = mixed.votes[:, :, None], mixed.votes[:, None]
    assert np.array_equal(report.same, (one == other).sum(axis=0))
    assert np.array_equal(report.contrary, (one.astype(int) * other == -1).sum(axis=0))
    split = [k for k, votes in enumerate(mixed.votes.tolist()) if len(set(votes[:3])) > 1]
    assert [d.member for d in report.disagreements] == split
    first = report.disagreements[0]
    assert first.values["sali"] == mixed.sali[split[0]]
    assert first.values["megno"] == mixed.mean_megno[split[0]]


@pytest.mark.parametrize("unit", [1000])
def test_without_an_end_a_run_takes_1000_natural_times_of_the_median_orbit(unit):
    """A top that is 1000 times slower, by its moments of inertia, is followed 1000 times longer."""
    top = lp.Top.heavy(inertia=(2 * unit, 2 * unit, 1.2 * unit), a=(-1 / unit, 0, 0))
    starts = lp.sample_states(MIXED, 5, seed=3)
    verdict = decide(top, starts)
    assert np.median(verdict.natural_time) == pytest.approx(1000, rel=0.05)  # of a unit to two digits
    assert verdict.verdict.tolist() == decide(MIXED, starts).verdict.tolist()
    assert verdict.arguments()["t_end"] == verdict.t_end


def test_fraction_is_a_proportion(mixed):
    k = int((mixed.verdict == "chaotic").sum())
    assert mixed.fraction("chaotic") == proportion(k, 120)


def test_wilson_interval_solves_its_equation():
    """Its ends are the p with (k/n - p)^2 = z^2 p (1 - p)/n; at k = 0 they are 0 and z^2/(n + z^2)."""
    z = 1.959963984540054
    for k, n in ((3, 10), (999, 1000)):
        estimate = proportion(k, n)
        for p in (estimate.low, estimate.high):
            assert (k / n - p) ** 2 == pytest.approx(z**2 * p * (1 - p) / n, rel=1e-9)
        assert estimate.low < k / n < estimate.high
    assert proportion(0, 1000).low == 0.0
    assert proportion(0, 1000).high == pytest.approx(z**2 / (1000 + z**2))
    assert proportion(5, 5).high == 1.0


FORCED = lp.System(
    lp.canonical(names=["x"], angles=["x"]), "p_x^2/2 - cos(x) + 3*cos(x)*cos(7*t/5)/10", period="10*pi/7"
)
TURNING, LIBRATING, WANDERING = {"p_x": 4.0}, {"p_x": 0.5}, {"p_x": 1.9}


def exponent_by_scipy(momentum, t_end):
    """The exponent of a forced pendulum from its variational equation, by another integrator."""

    def rates(t, z):
        strength = 1 - 0.3 * np.cos(1.4 * t)
        return [z[1], -np.sin(z[0]) * strength, z[3], -np.cos(z[0]) * strength * z[2]]

    total, z = 0.0, np.array([0, momentum, 1.0, 0])
    for k in range(int(t_end / 50)):
        z = solve_ivp(rates, (50.0 * k, 50.0 * (k + 1)), z, method="DOP853", rtol=1e-9, atol=1e-9).y[:, -1]
        size = np.hypot(*z[2:])
        total, z[2:] = total + np.log(size), z[2:] / size
    return total / t_end


@pytest.mark.thorough
def test_verdicts_of_a_forced_pendulum_agree_with_another_integrator():
    starts = [TURNING, LIBRATING, {"p_x": 1.0}, {"p_x": 3.3}, WANDERING, {"p_x": 2.0}]
    found = lp.decide(FORCED, starts, t_end=6000)
    assert found.verdict.tolist() == ["regular"] * 4 + ["chaotic"] * 2
    exponents = [exponent_by_scipy(start["p_x"], 1500) for start in starts]
    assert max(exponents[:4]) < 0.01  # ln(t)/t is 0.005
    assert min(exponents[4:]) > 0.1
    largest = lp.chaos.lyapunov_spectrum(FORCED, WANDERING, t_end=6000).end_exponent[0]
    np.testing.assert_allclose(largest[0], exponents[4], rtol=0.25)
    np.testing.assert_allclose(largest + largest[::-1], 0, atol=5e-3)


def test_an_orbit_that_turns_is_regular_on_the_circle_and_undecided_on_the_line():
    energy = "p_x^2/2 - cos(x)"
    angle, line = (lp.System(lp.canonical(names=["x"], angles=angles), energy) for angles in (["x"], []))
    found = lp.decide(angle, [TURNING, {"p_x": -2.2}], t_end=1000)
    assert found.verdict.tolist() == ["regular"] * 2
    assert found.average_drift.max() < 1e-4
    assert lp.decide(line, TURNING, t_end=1000).verdict.tolist() == ["undecided"]


def test_quasi_periodic_forcing_needs_no_period():
    force = "p_x^2/2 - cos(x) + cos(x)*(cos(t) + cos(sqrt(2)*t))/20"
    forced = lp.System(lp.canonical(names=["x"], angles=["x"]), force)
    found = lp.decide(forced, [TURNING, {"p_x": 0.9}, {"p_x": 2.0}], t_end=2000)
    assert found.verdict.tolist() == ["regular", "regular", "chaotic"]


def test_orbits_in_a_plane_are_regular_however_long_the_run():
    pendulum = lp.System(lp.canonical(names=["d"], angles=["d"]), "p_d^2/2 - cos(d)")
    found = decide(pendulum, [{"p_d": p} for p in (1, 3, 100)], t_end=5000)
    assert found.sali.min() < 1e-8  # it falls like 1/t^2: the area that two vectors span is kept, and both grow like t
    assert found.verdict.tolist() == ["regular"] * 3
    body = lp.System(lp.so(3) @ lp.trivial(), "l1^2/2 + l2^2/4 + l3^2/6")  # leaves of dimension two
    assert decide(body, [1, 0.2, 1], t_end=5000).votes[0].tolist() == [-1, -1, 0, -1]


def test_an_orbit_without_a_time_scale_says_why_it_is_undecided():
    flees = lp.VectorField({"x": "1 + x^2", "y": "-y"})  # x = tan(t)
    found = decide(flees, [0, 1], t_end=1)
    assert np.isnan(found.natural_time[0])
    assert found.outcome.tolist() == ["finished"]
    assert str(found).endswith("1 undecided because the orbit has no time scale: its first stretch did not finish")
