"""Finite-time exponents: known answers, pieces, seeds, bad input."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.numeric.sampling import sample_tangents

TOP = lp.Top.twisted_kovalevskaya()


def test_exponent_at_an_unstable_equilibrium_is_the_eigenvalue():
    """Upright heavy top, I3 = 1, a = (-1,0,0), alpha = (-2,0,0): l3'' = 2 l3, so the exponent tends to sqrt 2."""
    upright = np.zeros(9)
    upright[3] = -2.0
    growth = lp.finite_time_exponents(lp.Top.heavy(inertia=(2, 2, 1), a=(-1, 0, 0)), upright, times=[100.0, 2000.0])
    # |v| = c exp(t sqrt 2) with a constant c of order one: the bias falls as 1/t
    assert abs(growth.exponent[0, 1] - np.sqrt(2)) < 3 / 2000
    slope = growth.exponent[0, 1] * 2000 - growth.exponent[0, 0] * 100
    assert slope / 1900 == pytest.approx(np.sqrt(2), abs=1e-13)


def test_exponent_is_the_growth_of_the_tangent_vector_of_integrate():
    x0 = lp.sample_states(TOP, 5, seed=3)
    growth = lp.finite_time_exponents(TOP, x0, times=[1, 7.5, 30], seed=9)
    v0 = sample_tangents(9, 5, seed=9)
    assert np.array_equal(growth.start_tangent, v0)
    orbit = lp.integrate(TOP, x0, times=[0, 1, 7.5, 30], tangents=v0[:, None], method=lp.Taylor(tol=1e-13))
    expected = np.log(np.linalg.norm(orbit.tangent[:, 1:, 0], axis=-1)) / growth.time
    assert np.abs(growth.exponent - expected).max() < 1e-14


def test_given_tangent_vectors_are_used():
    x0 = lp.sample_states(TOP, 4, seed=3)
    drawn = lp.finite_time_exponents(TOP, x0, t_end=5, seed=1)
    given = lp.finite_time_exponents(TOP, x0, t_end=5, seed=2, tangents=drawn.start_tangent)
    assert np.array_equal(given.exponent, drawn.exponent)
    # only the direction counts: a power of two leaves every bit but those of the logarithms
    longer = lp.finite_time_exponents(TOP, x0, t_end=5, tangents=8 * drawn.start_tangent)
    assert np.abs(longer.exponent - drawn.exponent)[:, -1].max() < 1e-15


def test_default_times_end_exactly_at_t_end():
    growth = lp.finite_time_exponents(TOP, lp.sample_states(TOP, 1, seed=0), t_end=123.4)
    assert growth.time[-1] == 123.4
    assert growth.time[0] == pytest.approx(0.1234)
    assert growth.exponent.shape == (1, 200)
