"""Exponents of flows that keep no volume and have no bracket: Lorenz's, known to five digits."""

import numpy as np
import pytest

import liepoisson as lp

RATES = {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"}
LORENZ = lp.VectorField(RATES, {"sigma": 10, "rho": 28, "beta": "8/3"}, name="Lorenz")
KNOWN = [0.90563, 0.0, -14.57230]
"""Sprott, Chaos and Time-Series Analysis (2003), page 431: 0.9056, 0, -14.5723; Viswanath (1998): 0.90563."""
ROUNDING = 5e-6
SPREAD = 0.2
"""Errors of the mean of n orbits to the time t are at most this over the root of n t; 0.14 to 0.17 was measured."""


def starts(n):
    """States on the attractor: where random ones are after a while."""
    given = 10 * lp.sample_states(LORENZ, n, seed=3) + [0, 0, 25]
    return lp.integrate(LORENZ, given, times=[0, 30]).end_state


@pytest.mark.parametrize(
    ("n", "t_end"),
    [(8, 200), pytest.param(64, 2000, marks=pytest.mark.thorough), pytest.param(64, 20_000, marks=pytest.mark.slow)],
)
def test_the_spectrum_of_lorenz(n, t_end):
    found = lp.lyapunov_spectrum(LORENZ, starts(n), t_end=t_end, transient=20, seed=1)
    mean, error = found.mean
    # the largest and the smallest within three of their errors, and the one along the flow below what passes for zero
    assert (np.abs(mean - KNOWN) < 3 * error + ROUNDING)[[0, 2]].all()
    assert (error < SPREAD / np.sqrt(n * t_end)).all()
    assert (np.abs(found.end_exponent[:, 1]) < found.residuals.zero_threshold).all()
    # frames are made orthogonal with the volumes that the flow has: the sum is the divergence, -(sigma + 1 + beta)
    assert np.abs(found.end_exponent.sum(axis=1) + 41 / 3).max() < 1e-12
    assert found.structure is None
    assert found.check().splitlines()[0].startswith("sum of all exponents: -13.66666667, the divergence of the field")


@pytest.mark.thorough
def test_one_exponent_agrees_with_the_spectrum_and_the_rule_says_chaotic():
    found = lp.lyapunov_exponent(LORENZ, starts(4), t_end=200)
    assert (np.abs(found.exponent - KNOWN[0]) < 4 * found.error).all()
    assert set(lp.decide(LORENZ, starts(4), t_end=100).verdict) == {"chaotic"}
    quiet = lp.VectorField(RATES, {"sigma": 10, "rho": 14, "beta": "8/3"})  # all orbits end at rest
    assert lp.lyapunov_exponent(quiet, [1, 1, 10], t_end=100).exponent[0] < 0


def test_the_sum_is_the_mean_divergence_where_that_is_no_number():
    """Van der Pol's oscillator: the sum is the mean of the divergence, mu (1 - x^2), along the cycle."""
    field = lp.VectorField({"x": "y", "y": "mu*(1 - x^2)*y - x"}, {"mu": 1})
    found = lp.lyapunov_spectrum(field, [2, 0], t_end=200, transient=50)
    assert "the mean divergence along orbits computed apart, within" in found.check()
    assert found.mean_divergence[0] == pytest.approx(found.end_exponent[0].sum(), abs=1e-12)
    assert abs(found.end_exponent[0, 0]) < found.residuals.zero_threshold[0]
    assert found.end_exponent[0, 1] == pytest.approx(-1.0590, abs=2e-3)
