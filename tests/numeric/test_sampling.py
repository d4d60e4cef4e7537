"""Random starts: trajectories do not depend on the number of trajectories, and have the stated distribution."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.numeric.sampling import ENSEMBLES, sample_alignment_vectors, sample_tangents

TOP = lp.Top.twisted_kovalevskaya()


@pytest.mark.thorough
@given(st.integers(0, 600), st.integers(0, 600), st.integers(0, 5), st.sampled_from(sorted(ENSEMBLES)))
def test_a_member_is_the_same_in_every_piece(first, n, seed, ensemble):
    everything = lp.sample_states(TOP, 1200, seed=seed, ensemble=ensemble)
    piece = lp.sample_states(TOP, n, seed=seed, ensemble=ensemble, first=first)
    assert np.array_equal(piece, everything[first : first + n])


def test_no_two_members_are_equal_and_states_differ_from_tangents():
    states = lp.sample_states(TOP, 1000, seed=1, ensemble="gaussian")
    tangents = sample_tangents(9, 1000, seed=1)
    assert len(np.unique(states[:, 0])) == 1000
    assert len(np.intersect1d(states, tangents)) == 0


@pytest.mark.parametrize("n_vectors", [1, 3])
def test_alignment_vectors_are_none_of_the_tangents(n_vectors):
    """SALI votes beside indicators made of `sample_tangents`, with the same seed."""
    vectors = sample_alignment_vectors(9, 300, n_vectors, seed=1)
    assert vectors.shape == (300, n_vectors, 9)
    assert np.abs(np.linalg.norm(vectors, axis=-1) - 1).max() < 1e-15
    assert len(np.intersect1d(vectors, sample_tangents(9, 300 * n_vectors, seed=1))) == 0
    part = sample_alignment_vectors(9, 40, n_vectors, seed=1, first=230)
    assert np.array_equal(part, vectors[230:270])


def test_unit_vectors_are_unit_and_uniform():
    """z uniform in [-1,1]: mean 0 +- 1/sqrt(3n), mean square 1/3 +- sqrt(4/45/n); 5 sigma: 1e-6 to be wrong, each."""
    n = 40_000
    vectors = lp.sample_states(TOP, n, seed=2).reshape(n, 3, 3)
    assert np.abs(np.linalg.norm(vectors, axis=-1) - 1).max() < 1e-15
    assert np.abs(vectors.mean(axis=0)).max() < 5 / np.sqrt(3 * n)
    assert np.abs((vectors**2).mean(axis=0) - 1 / 3).max() < 5 * np.sqrt(4 / 45 / n)
    # independent vectors: products of components of different vectors average to 0 with deviation 1/(3 sqrt n)
    assert np.abs(np.einsum("ni,nj->ij", vectors[:, 0], vectors[:, 2]) / n).max() < 5 / 3 / np.sqrt(n)


def test_cube_and_gaussian_have_their_moments():
    """Mean squares 1/3 and 1, with deviations sqrt(4/45/n) and sqrt(2/n); 5 sigma."""
    n = 40_000
    cube = lp.sample_states(TOP, n, seed=2, ensemble="cube")
    assert np.abs(cube).max() <= 1
    assert np.abs((cube**2).mean(axis=0) - 1 / 3).max() < 5 * np.sqrt(4 / 45 / n)
    gaussian = lp.sample_states(TOP, n, seed=2, ensemble="gaussian")
    assert np.abs((gaussian**2).mean(axis=0) - 1).max() < 5 * np.sqrt(2 / n)
