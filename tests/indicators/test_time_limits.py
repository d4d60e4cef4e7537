"""Limits of time: what comes after the end is not begun."""

import time

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.indicators import averages, megno, spectrum
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


def test_energies_that_come_too_late_have_an_outcome_and_no_states():
    leaf = SlowLeaf(0.2)
    found = profile(leaf, 0.1)
    assert leaf.n_sampled == 1
    assert (found.outcome == "time limit").all()
    assert (found.verdict == "undecided").all()
    assert np.isnan(found.exponent).all()
    assert np.isnan(found.chaotic[3].value)
