"""Finite-time exponents: known answers, pieces, seeds, bad input."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError
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


def test_pieces_of_an_ensemble_are_the_ensemble():
    x0 = lp.sample_states(TOP, 70, seed=3)
    whole = lp.finite_time_exponents(TOP, x0, t_end=20, seed=1)
    pieces = [lp.finite_time_exponents(TOP, x0[k : k + 25], t_end=20, seed=1, first=k) for k in range(0, 70, 25)]
    assert np.array_equal(np.concatenate([piece.exponent for piece in pieces]), whole.exponent)


def test_other_seeds_give_other_tangent_vectors():
    x0 = lp.sample_states(TOP, 4, seed=3)
    one, two = (lp.finite_time_exponents(TOP, x0, t_end=5, seed=seed).exponent for seed in (1, 2))
    assert (one != two).all()


def test_given_tangent_vectors_are_used_and_zero_is_refused():
    x0 = lp.sample_states(TOP, 4, seed=3)
    drawn = lp.finite_time_exponents(TOP, x0, t_end=5, seed=1)
    given = lp.finite_time_exponents(TOP, x0, t_end=5, seed=2, tangents=drawn.start_tangent)
    assert np.array_equal(given.exponent, drawn.exponent)
    # only the direction counts: a power of two leaves every bit but those of the logarithms
    longer = lp.finite_time_exponents(TOP, x0, t_end=5, tangents=8 * drawn.start_tangent)
    assert np.abs(longer.exponent - drawn.exponent)[:, -1].max() < 1e-15
    with pytest.raises(ParameterError, match="tangent vector of member 0"):
        lp.finite_time_exponents(TOP, x0, t_end=5, tangents=np.zeros(9))


def test_default_times_end_exactly_at_t_end():
    growth = lp.finite_time_exponents(TOP, lp.sample_states(TOP, 1, seed=0), t_end=123.4)
    assert growth.time[-1] == 123.4
    assert growth.time[0] == pytest.approx(0.1234)
    assert growth.exponent.shape == (1, 200)


@pytest.mark.thorough
def test_regular_and_chaotic_ensembles_differ():
    """Kovalevskaya: the mean falls like ln t / t. Twisted: it stays near 0.13. 64 starts, fixed seeds."""
    regular, chaotic = (
        lp.finite_time_exponents(top, lp.sample_states(top, 64, seed=5), times=[50, 500, 5000]).exponent.mean(axis=0)
        for top in (lp.Top.kovalevskaya(), TOP)
    )
    assert regular[2] < 0.006  # ln(5000)/5000 = 0.0017; measured 0.0015
    assert chaotic[2] > 0.1


@pytest.mark.parametrize("arguments", [{}, {"t_end": 1.0, "times": [1.0]}])
def test_one_of_t_end_and_times_is_wanted(arguments):
    with pytest.raises(ParameterError, match="either t_end or times"):
        lp.finite_time_exponents(TOP, np.ones(9), **arguments)


@pytest.mark.parametrize("t_end", [0.0, -5.0, np.nan, np.inf])
def test_exponent_over_no_or_negative_time_is_refused(t_end):
    with pytest.raises(ParameterError, match="positive finite time"):
        lp.finite_time_exponents(TOP, np.ones(9), t_end=t_end)


@pytest.mark.parametrize("times", [[-1.0, 1.0], [0.0, 1.0], [2.0, 1.0], [-1.0], [-2.0, -1.0]])
def test_times_that_are_not_positive_and_increasing_are_refused(times):
    with pytest.raises(ParameterError, match="positive increasing"):
        lp.finite_time_exponents(TOP, np.ones(9), times=times)


def test_a_trajectory_that_fails_is_an_outcome():
    x0 = np.array([np.ones(9), np.full(9, 1e200)])
    growth = lp.finite_time_exponents(TOP, x0, t_end=3)
    assert list(growth.outcome) == ["finished", "not finite"]
    assert np.isnan(growth.exponent[1]).all()
    assert np.isfinite(growth.exponent[0]).all()
