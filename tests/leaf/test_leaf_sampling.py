"""Samples of leaves: on the leaf and the energy surface, with moments by quadrature, invariant under the flow.

Deviations are given in standard errors of n independent draws; chance exceeds the bound of 5 once in 1.7 million.
"""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.leaf import chain_sampling, leaf_sampling
from liepoisson.leaf.chain_sampling import sample_by_chains
from liepoisson.leaf.leaf_sampling import acceptance

INERTIA, A, B = np.array([2, 1.5, 1]), np.array([-1, 0.25, 0.5]), np.array([0.25, 0.5, -0.125])
TWISTED, CHARGED = (lp.Top(inertia=tuple(INERTIA), a=tuple(A), b=tuple(B), epsilon=epsilon) for epsilon in (1, 0))
SIX = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, -0.9])
FOUR = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0, 0, 0])
TWO = np.array([1.0, 2, 3, 0, 0, 0, 0, 0, 0])
LEAVES = {
    "twisted": lp.Leaf.through(TWISTED, SIX),
    "two fields": lp.Leaf.through(CHARGED, SIX),
    "one direction": lp.Leaf.through(TWISTED, FOUR),
    "parallel": lp.Leaf.through(CHARGED, [0.1, 0.2, 0.3, 0.2, 0.4, 0.6, 0.1, 0.2, 0.3]),
    "sphere": lp.Leaf.through(TWISTED, TWO),
}


def deviations(values, expected):
    """Distances of the means from what is expected, in standard errors."""
    return np.abs(values.mean(axis=0) - expected) / (values.std(axis=0, ddof=1) / np.sqrt(len(values)) + 1e-13)


def energy_above_the_least(leaf):
    return leaf.energy_range()[0] + 1.2


@pytest.mark.thorough
@pytest.mark.parametrize("name", LEAVES)
@pytest.mark.parametrize("kind", ["energy", "energy_below"])
def test_states_lie_on_the_leaf_and_have_the_energy(name, kind):
    leaf = LEAVES[name]
    energy = energy_above_the_least(leaf)
    x = leaf.sample(500, seed=1, **{kind: energy})
    assert x.shape == (500, 9)
    assert leaf.residual(x).max() < 2e-15
    values = leaf.system.functions.energy(x)
    if kind == "energy":
        assert np.abs(values - energy).max() < 1e-14
    else:
        assert values.max() <= energy + 1e-14
        assert values.min() < energy - 0.3


@pytest.mark.thorough
@pytest.mark.parametrize("name", LEAVES)
def test_the_microcanonical_measure_is_invariant_under_the_flow(name):
    """Means and mean squares of all components before, and after t = 10, of the same 2000 orbits."""
    leaf = LEAVES[name]
    x = leaf.sample(2000, seed=2, energy=energy_above_the_least(leaf))
    y = lp.integrate(leaf.system, x, times=[0, 10]).end_state
    assert np.abs(y - x).max() > 0.1
    assert deviations(y - x, 0).max() < 5
    assert deviations(y**2 - x**2, 0).max() < 5


def test_a_sphere_is_uniform():
    """Archimedes: each component is uniform in [-r, r], mean square r^2/3, fourth moment r^4/5."""
    z = LEAVES["sphere"].sample(20_000, seed=3)[:, :3] / np.sqrt(14)
    for power, expected in ((1, 0), (2, 1 / 3), (4, 1 / 5)):
        assert deviations(z**power, expected).max() < 5


@pytest.mark.parametrize(("kind", "power"), [("energy", 0), ("energy_below", 1)])
def test_a_heavy_top_has_the_moments_of_quadrature(kind, power):
    r"""The density of n is $k_+^0/\sqrt{n\cdot In}$ or $k_+/\sqrt{n\cdot In}$, integrated on a grid of 300 x 300."""
    leaf = LEAVES["one direction"]
    energy = energy_above_the_least(leaf)
    z = (np.arange(300) + 0.5) / 150 - 1
    phi = (np.arange(300) + 0.5) * np.pi / 150
    n = np.stack([np.sqrt(1 - z[:, None] ** 2) * f(phi) for f in (np.cos, np.sin)] + [z[:, None] + 0 * phi], axis=-1)
    size = np.sqrt(0.77)
    parallel, moment = 0.32 / size, n**2 @ INERTIA
    k = energy - size * (n @ A) - parallel**2 / (2 * moment)
    weight = np.where(k > 0, np.maximum(k, 0) ** power, 0) / np.sqrt(moment)
    x = leaf.sample(20_000, seed=4, **{kind: energy})[:, 3:6] / size
    for exponent in (1, 2):
        expected = np.einsum("ij,ijk->k", weight, n**exponent) / weight.sum()
        assert deviations(x**exponent, expected).max() < 5


@pytest.mark.thorough
@pytest.mark.parametrize("n", [512, pytest.param(2048, marks=pytest.mark.slow)])
def test_the_two_samplers_agree(monkeypatch, n):
    """Independent states against the Markov chains, whose states are correlated: 5 becomes 8."""
    leaf = LEAVES["twisted"]
    energy = energy_above_the_least(leaf)
    monkeypatch.setattr(chain_sampling, "N_CHAINS", n)  # the population of the chains itself
    x = leaf.sample(n, seed=7, energy=energy)
    y = sample_by_chains(leaf, n, 7, leaf_sampling._shell(energy, None))
    assert leaf.residual(y).max() < 1e-12
    assert np.abs(leaf.system.functions.energy(y) - energy).max() < 1e-12
    for power in (1, 2):
        error = np.sqrt((x**power).var(axis=0) / n + (y**power).var(axis=0) / n)
        assert (np.abs((x**power).mean(axis=0) - (y**power).mean(axis=0)) / error).max() < 8


def test_the_first_states_do_not_depend_on_their_number():
    leaf = LEAVES["twisted"]
    energy = energy_above_the_least(leaf)
    everything = leaf.sample(3000, seed=9, energy=energy)
    assert np.array_equal(leaf.sample(10, seed=9, energy=energy), everything[:10])
    assert not np.array_equal(leaf.sample(10, seed=10, energy=energy), everything[:10])
    assert len(leaf.sample(0, seed=9, energy=energy)) == 0


@pytest.mark.parametrize("name", LEAVES)
def test_proposals_are_not_wasted(name):
    """Measured 0.02 (twisted) to 0.6 at this energy."""
    assert acceptance(LEAVES[name], energy=energy_above_the_least(LEAVES[name])) > 0.01


def test_a_point_is_its_own_sample():
    point = lp.Leaf.through(TWISTED, np.zeros(9))
    assert np.array_equal(point.sample(3, seed=0), np.zeros((3, 9)))
