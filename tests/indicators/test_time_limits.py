"""Limits of time: what comes after the end is not begun."""

import time

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.indicators import averages, exponents_by_energy, megno, spectrum
from liepoisson.indicators.averages import average_drift
from liepoisson.numeric import time_scale

TOP = lp.Top.twisted_kovalevskaya()
MANY = lp.sample_states(TOP, 1000, seed=1)  # four pieces of 256
NO_TIME = 1e-9


@pytest.fixture
def calls(monkeypatch):
    """How often a function of a module is called."""
    counts = {}

    def count(module, name):
        function, key = getattr(module, name), f"{module.__name__.rpartition('.')[2]}.{name}"
        counts[key] = 0

        def counted(*args, **kwargs):
            counts[key] += 1
            return function(*args, **kwargs)

        monkeypatch.setattr(module, name, counted)

    count(time_scale, "integrate")
    count(megno, "finite_time_exponents")
    count(averages, "integrate")
    count(spectrum, "mean_error")
    return counts


def test_a_verdict_begins_nothing_after_its_limit(calls):
    verdict = lp.decide(TOP, MANY, t_end=1e5, time_limit=NO_TIME)
    assert calls == {
        "time_scale.integrate": 0, "megno.finite_time_exponents": 1, "averages.integrate": 0, "spectrum.mean_error": 0,
    }  # fmt: skip
    assert (verdict.outcome == "time limit").all()
    assert (verdict.verdict == "undecided").all()
    assert np.isnan(verdict.exponent).all()
    assert np.isnan(verdict.natural_time).all()


def test_members_that_are_not_finite_have_their_own_outcome():
    starts = MANY.copy()
    starts[[500, 700]] = np.nan
    outcome = lp.decide(TOP, starts, t_end=1e5, time_limit=NO_TIME).outcome
    assert np.flatnonzero(outcome == "not finite").tolist() == [500, 700]
    assert (np.delete(outcome, [500, 700]) == "time limit").all()


def test_averages_are_those_of_runs_that_finished():
    drift, outcome = average_drift(TOP, MANY[:3], t_end=1e5, natural_time=1e5, time_limit=NO_TIME)
    assert np.isnan(drift).all()
    assert outcome.tolist() == ["time limit"] * 3


def test_errors_of_a_spectrum_that_did_not_finish_are_not_computed(calls):
    found = lp.lyapunov_spectrum(TOP, MANY[:8], t_end=1e4, transient=100, covariant=True, time_limit=NO_TIME)
    assert calls["spectrum.mean_error"] == 0
    assert np.isnan(found.error).all()


class SlowLeaf:
    """A leaf whose states take their time."""

    def __init__(self, seconds):
        self.casimirs, self.seconds, self.n_sampled = {"C1": 1.0}, seconds, 0

    def sample(self, n_starts, *, seed, energy=None):
        self.n_sampled += 1
        time.sleep(self.seconds)
        return lp.sample_states(TOP, n_starts, seed=seed)


def profile(leaf, time_limit):
    return lp.chaos.exponents_by_energy(
        TOP, leaf=leaf, energies=[0.0, 0.5, 1.0, 2.0], n_starts=3, t_end=50, time_limit=time_limit
    )


def test_energies_share_the_time_that_is_left(monkeypatch):
    limits, decide = [], exponents_by_energy.decide

    def decided(*args, time_limit, **kwargs):
        limits.append(time_limit)
        return decide(*args, time_limit=1e4, **kwargs)

    monkeypatch.setattr(exponents_by_energy, "decide", decided)
    profile(SlowLeaf(0.0), 400.0)
    assert len(limits) == 4
    assert limits[0] <= 100.0
    assert limits[3] > 100.0


def test_energies_that_come_too_late_have_an_outcome_and_no_states():
    leaf = SlowLeaf(0.2)
    found = profile(leaf, 0.1)
    assert leaf.n_sampled == 1
    assert (found.outcome == "time limit").all()
    assert (found.verdict == "undecided").all()
    assert np.isnan(found.exponent).all()
    assert np.isnan(found.chaotic[3].value)
