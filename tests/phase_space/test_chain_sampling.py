"""Samples by a population of Markov chains: the parts of an energy surface have the shares that the measure gives."""

import warnings

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import MixingWarning
from liepoisson.phase_space import chain_sampling
from liepoisson.phase_space.chain_sampling import sample_by_chains
from liepoisson.phase_space.top_sampling import Shell

BODY = lp.System(lp.so(3) @ lp.trivial(), "l1^2/2 + l2^2/4 + l3^2/6 + 3*l1/20")
DEVIATIONS = 4.5
"""Standard errors; chance exceeds them once in 150 000 tries, and the seeds are fixed."""


def standard_error(halvings, n_chains=chain_sampling.N_CHAINS):
    """Of a share of one half, that was fixed so many halvings before the end."""
    return 0.5 * np.sqrt(halvings / n_chains)


@pytest.mark.thorough
@pytest.mark.parametrize("energy", [0.3, 0.27])
def test_two_closed_curves_have_their_shares_whatever_the_state_of_the_leaf(energy):
    """The surface is one curve around e1 and one around -e1.  Uniform points on the sphere, in a window of energy."""
    noise = np.random.default_rng(1).standard_normal((2_000_000, 3))
    sphere = noise / np.linalg.norm(noise, axis=-1, keepdims=True)
    near = sphere[np.abs(BODY.functions.energy(sphere) - energy) < 0.005]
    expected = (near[:, 0] > 0).mean()  # 0.495 and 0.49
    first, other = (lp.Leaf.through(BODY, [l1, 0, 0]).sample(2048, seed=1, energy=energy) for l1 in (1.0, -1.0))
    assert np.abs((first[:, 0] > 0).mean() - expected) < DEVIATIONS * standard_error(6)
    assert np.array_equal(first, other)


@pytest.mark.thorough
def test_mirrored_wells_of_a_top_have_equal_shares():
    """The wells at (l2, beta2) and (-l2, -beta2), 0.176 below the pass between them, 0.006 above their bottom.

    The volume of the well grows with the third power of the energy: 3 log2(0.176/0.006) = 15 halvings, and 5 of the
    window.
    """
    top = lp.Top.twisted_kovalevskaya()
    leaf = lp.Leaf(top, {"C1": 1, "C2": 0.2, "C3": 1})
    x = sample_by_chains(leaf, 2048, 2, Shell(-1.48, is_filled=False))
    assert leaf.residual(x).max() < 1e-12
    assert np.abs(top.functions.energy(x) + 1.48).max() < 1e-12
    assert abs((x[:, 1] < 0).mean() - 0.5) < DEVIATIONS * standard_error(20)


@pytest.mark.thorough
def test_states_below_an_energy_have_the_shares_of_the_caps():
    """Around e3, the longest axis, and -e3: two caps of one area each, uniform in energy but for the curvature."""
    body = lp.System(lp.so(3) @ lp.trivial(), "l1^2/2 + l2^2/4 + l3^2/6")
    x = lp.Leaf.through(body, [0, 0, 1]).sample(2048, seed=3, energy_below=0.17)
    assert body.functions.energy(x).max() <= 0.17
    assert abs((x[:, 2] > 0).mean() - 0.5) < DEVIATIONS * standard_error(8)
    noise = np.random.default_rng(1).standard_normal((2_000_000, 3))
    sphere = noise / np.linalg.norm(noise, axis=-1, keepdims=True)
    cap = sphere[body.functions.energy(sphere) <= 0.17]
    for k in (0, 1):
        assert np.mean(x[:, k] ** 2) == pytest.approx(np.mean(cap[:, k] ** 2), rel=0.15)


@pytest.mark.thorough
def test_sheets_between_which_proposals_leap_have_equal_shares():
    """The two sheets of a hyperboloid, l3^2 - l1^2 - l2^2 = 1: no path on it connects them, Newton's method does."""
    hyperbolic = lp.System(lp.so(2, 1) @ lp.trivial(), "l1^2 + l2^2 + l3^2")
    x = lp.Leaf.through(hyperbolic, [0, 0, 1]).sample(2048, seed=1, energy=2.0)
    assert abs((x[:, 2] > 0).mean() - 0.5) < DEVIATIONS * 0.5 / np.sqrt(2048)


@pytest.mark.thorough
def test_chains_that_remember_their_starts_are_warned_of(monkeypatch):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        lp.Leaf.through(BODY, [1, 0, 0]).sample(10, seed=1)
    monkeypatch.setattr(chain_sampling, "_BURN_IN", 1)
    monkeypatch.setattr(chain_sampling, "_MOST_BURN_INS", 1)
    hyperbolic = lp.System(lp.so(2, 1) @ lp.trivial(), "l1^2 + l2^2 + l3^2")
    with pytest.warns(MixingWarning, match="where their chains began"):
        lp.Leaf.through(hyperbolic, [0, 0, 1]).sample(10, seed=1, energy=2.0)


def test_memory_is_the_largest_correlation():
    rng = np.random.default_rng(0)
    x, y = rng.standard_normal((2, 2000, 3))
    assert chain_sampling._memory(x, y) < 0.1
    assert chain_sampling._memory(x, np.column_stack([y[:, :2], x[:, 2]])) == pytest.approx(1)
    assert chain_sampling._memory(x, np.column_stack([y[:, :2], np.abs(x[:, 2])])) > 0.9, "by the square"
    assert chain_sampling._memory(np.ones((5, 2)), np.ones((5, 2))) == 0, "constant coordinates say nothing"


@pytest.mark.thorough
@pytest.mark.parametrize("size", [0.6, 1.5])
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
