"""The rule of the core, for Python and for the page: its indicators are the formulas, its votes the thresholds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from liepoisson import _core
from liepoisson.indicators.verdict import Rule

LONG = 1e4


def rows(seed: int, *shape: int) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(shape)


@given(st.integers(0, 2**32), st.integers(1, 5), st.integers(20, 700))
def test_growth_power_is_the_slope_of_least_squares(seed, n, n_times):
    time = np.arange(1, n_times + 1) * 0.37
    growth = rows(seed, n, n_times).cumsum(axis=1)
    last = time >= 0.0999999 * time[-1]
    wanted = np.polyfit(np.log(time[last]), growth[:, last].T, 1)[0]
    np.testing.assert_allclose(_core.growth_powers(time, growth.ravel()), wanted, rtol=1e-9, atol=1e-11)


@given(st.floats(0.2, 3.0), st.integers(50, 400))
def test_megno_of_exponential_growth(rate, n):
    """ln|v| = lambda t: Y = lambda t, and its mean is half of that."""
    time = np.arange(1, n + 1) / n
    linear, mean = _core.megno(time, rate * time)
    np.testing.assert_allclose(linear, rate * time, rtol=1e-12)
    np.testing.assert_allclose(mean, rate * time / 2, rtol=1e-12)


@given(st.integers(0, 2**32), st.integers(2, 12))
def test_sali_is_the_shorter_one_of_sum_and_difference(seed, n):
    pairs = rows(seed, 6, 2, n)
    pairs /= np.linalg.norm(pairs, axis=-1, keepdims=True)
    pairs[0, 1] = -pairs[0, 0]  # parallel: as small as can be told
    one, other = pairs[:, 0], pairs[:, 1]
    wanted = np.minimum(np.linalg.norm(one - other, axis=-1), np.linalg.norm(one + other, axis=-1))
    np.testing.assert_allclose(_core.sali(pairs.ravel(), n), np.maximum(wanted, 1e-16), rtol=1e-12)


@given(st.integers(0, 2**32), st.integers(1, 4))
def test_change_of_averages_is_that_of_windowed_squares(seed, n):
    values = rows(seed, 3, 1000, n).cumsum(axis=1)
    values[:, :, 0] = 2.0 + 1e-14 * values[:, :, 0] / 1000  # as constant as round-off: no change
    squares, part = values**2, 600
    weights = np.sin(np.pi * (np.arange(part) + 0.5) / part) ** 4
    first, last = (np.average(some, axis=1, weights=weights) for some in (squares[:, :part], squares[:, -part:]))
    moved = np.abs(first - last)[:, 1:] / squares.std(axis=1)[:, 1:]
    wanted = moved.max(axis=1, initial=0.0)
    np.testing.assert_allclose(_core.average_changes(values.ravel(), 3, n), wanted, rtol=1e-8, atol=1e-12)


ORDER = (-1, -1, -1, -1)
CHAOS = (1, 1, 1, 0)


@pytest.mark.parametrize(
    ("votes", "time", "kind"),
    [
        (ORDER, LONG, "regular"),
        ((-1, 0, -1, -1), LONG, "regular"),
        ((-1, -1, -1, 0), LONG, "undecided"),  # averages still change
        ((-1, -1, 1, -1), LONG, "undecided"),  # one against it
        ((-1, 0, 0, -1), LONG, "undecided"),  # one alone
        (CHAOS, LONG, "chaotic"),
        ((0, 1, 1, -1), LONG, "chaotic"),
        ((1, 1, -1, 0), LONG, "undecided"),
        (ORDER, 99.0, "undecided"),  # too short
        (CHAOS, np.nan, "undecided"),  # no time scale
    ],
)
def test_verdicts_that_votes_make(votes, time, kind):
    assert Rule().kinds(np.array([votes], np.int8), np.array([time])).tolist() == [kind]


@given(st.lists(st.tuples(*[st.one_of(st.floats(0, 10), st.just(np.nan))] * 2), min_size=1, max_size=5))
def test_votes_are_by_the_thresholds(values):
    rule = Rule()
    power, mean = np.array(values).T
    sali, averages = 10.0 ** (-2 * power), mean / 1000
    wanted = [
        np.where(power < rule.growth_power[0], -1, np.where(power > rule.growth_power[1], 1, 0)),
        np.where(mean < rule.megno[0], -1, np.where(mean > rule.megno[1], 1, 0)),
        np.where(sali > rule.sali[0], -1, np.where(sali < rule.sali[1], 1, 0)),
        np.where(averages < rule.averages, -1, 0),
    ]
    np.testing.assert_array_equal(rule.votes(power, mean, sali, averages), np.stack(wanted, axis=-1))
