"""Samples by a population of Markov chains: the parts of an energy surface have the shares that the measure gives."""

import warnings

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import MixingWarning
from liepoisson.leaf import chain_sampling

BODY = lp.System(lp.so(3) @ lp.trivial(), "l1^2/2 + l2^2/4 + l3^2/6 + 3*l1/20")
DEVIATIONS = 4.5
"""Standard errors; chance exceeds them once in 150 000 tries, and the seeds are fixed."""


@pytest.fixture(params=[512, pytest.param(2048, marks=pytest.mark.slow)])
def n_chains(request, monkeypatch):
    """The states of the population, each of which is looked at."""
    monkeypatch.setattr(chain_sampling, "N_CHAINS", request.param)
    return request.param


def standard_error(halvings, n_chains):
    """Of a share of one half, that was fixed so many halvings before the end."""
    return 0.5 * np.sqrt(halvings / n_chains)


@pytest.mark.thorough
def test_two_closed_curves_have_their_shares_whatever_the_state_of_the_leaf(n_chains):
    """The surface is one curve around e1 and one around -e1.  Uniform points on the sphere, in a window of energy."""
    energy, noise = 0.3, np.random.default_rng(1).standard_normal((500_000, 3))
    sphere = noise / np.linalg.norm(noise, axis=-1, keepdims=True)
    near = sphere[np.abs(BODY.functions.energy(sphere) - energy) < 0.005]
    expected = (near[:, 0] > 0).mean()  # 0.495
    first, other = (lp.Leaf.through(BODY, [l1, 0, 0]).sample(n_chains, seed=1, energy=energy) for l1 in (1.0, -1.0))
    assert np.abs((first[:, 0] > 0).mean() - expected) < DEVIATIONS * standard_error(6, n_chains)
    assert np.array_equal(first, other)


@pytest.mark.thorough
def test_states_below_an_energy_have_the_shares_of_the_caps():
    """Around e3, the longest axis, and -e3: two caps of one area each, uniform in energy but for the curvature."""
    body = lp.System(lp.so(3) @ lp.trivial(), "l1^2/2 + l2^2/4 + l3^2/6")
    x = lp.Leaf.through(body, [0, 0, 1]).sample(2048, seed=3, energy_below=0.17)
    assert body.functions.energy(x).max() <= 0.17
    assert abs((x[:, 2] > 0).mean() - 0.5) < DEVIATIONS * standard_error(8, 2048)
    noise = np.random.default_rng(1).standard_normal((500_000, 3))
    sphere = noise / np.linalg.norm(noise, axis=-1, keepdims=True)
    cap = sphere[body.functions.energy(sphere) <= 0.17]
    for k in (0, 1):
        assert np.mean(x[:, k] ** 2) == pytest.approx(np.mean(cap[:, k] ** 2), rel=0.15)


@pytest.mark.thorough
def test_sheets_between_which_proposals_leap_have_equal_shares(n_chains):
    """The two sheets of a hyperboloid, l3^2 - l1^2 - l2^2 = 1: no path on it connects them, Newton's method does."""
    hyperbolic = lp.System(lp.so(2, 1) @ lp.trivial(), "l1^2 + l2^2 + l3^2")
    x = lp.Leaf.through(hyperbolic, [0, 0, 1]).sample(n_chains, seed=1, energy=2.0)
    assert abs((x[:, 2] > 0).mean() - 0.5) < DEVIATIONS * 0.5 / np.sqrt(n_chains)


@pytest.mark.thorough
def test_a_ball_off_the_origin_is_filled_evenly():
    """H = (|p|^2 + |q|^2)/2 + k q1 <= E is a ball of radius R, R^2 = 2E + k^2, about q1 = -k in R^(2n).

    The mean of q1 is -k, and its variance R^2/(2n + 2).  All starts lie on one side of it.
    """
    n, k, energy = 8, 30, 50.0
    system = lp.System(lp.canonical(n), f"dot(p, p)/2 + dot(q, q)/2 + {k}*q1")
    x = lp.Leaf(system, {}).sample(2048, seed=1, energy_below=energy)
    radius = np.sqrt(2 * energy + k**2)
    halvings = 10  # states that were doubled last are not independent yet
    assert abs(x[:, 0].mean() + k) < DEVIATIONS * radius / np.sqrt((2 * n + 2) * 2048 / halvings)
    centred = x + k * np.eye(2 * n)[0]
    assert np.mean(np.sum(centred**2, axis=1)) == pytest.approx(radius**2 * 2 * n / (2 * n + 2), rel=0.01)


def test_a_population_that_moves_in_one_direction_is_seen():
    rng = np.random.default_rng(0)
    x, y = rng.standard_normal((2, 2048, 3))
    chain = lp.Leaf.through(BODY, [1, 0, 0])
    chain = chain_sampling._Chain(chain.equations, chain.system.functions.energy, None)
    assert chain_sampling._drift(chain, x, y) < 4
    assert chain_sampling._drift(chain, x, y + np.array([0.2, 0, 0])) > 4
    assert chain_sampling._drift(chain, x, y * [1, 1.2, 1]) > 4
    assert chain_sampling._drift(chain, np.ones((5, 3)), np.ones((5, 3))) == 0


@pytest.mark.thorough
def test_chains_that_remember_their_starts_are_warned_of(monkeypatch):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        lp.Leaf.through(BODY, [1, 0, 0]).sample(10, seed=1)
    monkeypatch.setattr(chain_sampling, "_BURN_IN", 1)
    monkeypatch.setattr(chain_sampling, "_DOUBLINGS", 0)
    hyperbolic = lp.System(lp.so(2, 1) @ lp.trivial(), "l1^2 + l2^2 + l3^2")
    with pytest.warns(MixingWarning, match="where their chains were"):
        lp.Leaf.through(hyperbolic, [0, 0, 1]).sample(10, seed=1, energy=2.0)


@pytest.mark.thorough
@pytest.mark.parametrize("size", [0.6])
def test_steps_of_any_size_keep_the_measure(size):
    """On a level of the energy of a free body the measure is uniform in time: its mean of l1^2 stays what it is.

    Measured: 0.7 and 0.8 standard errors; 4.1 and 16 where the length of a proposal is weighed wrongly, and 5.8 at 0.6
    where the Newton steps of a proposal may end earlier on the way back.
    """
    body = lp.System(lp.so(3) @ lp.trivial(), "l1^2/2 + l2^2/4 + 2*l3^2")
    x0 = np.array([0.9, 1.2, 0.25])
    crossings = lp.section(body, x0, surface="l3", direction=1, n_crossings=2, t_end=100)
    begin, end = crossings.time
    start = lp.integrate(body, x0, times=[0, begin]).state[0, -1]
    states = lp.integrate(body, start, times=np.linspace(0, end - begin, 4097)).state[0, :-1]  # one period
    energy = body.functions.energy
    equations = lp.Leaf.through(body, x0).equations.with_function(energy, float(energy(x0)))
    chain, rng = chain_sampling._Chain(equations, energy, None), np.random.default_rng(6)
    x = np.repeat(states, 2, axis=0)
    for _ in range(60):
        x, _ = chain.step(rng, x, size)
    squares = x[:, 0] ** 2
    error = squares.std() / np.sqrt(len(squares))
    assert abs(squares.mean() - (states[:, 0] ** 2).mean()) < DEVIATIONS * error
