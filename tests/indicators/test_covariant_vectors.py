"""Covariant Lyapunov vectors: carried into themselves, growing with the exponents, placed as the integrals demand."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.indicators.spectrum import lyapunov_spectrum

TOP = lp.Top.twisted_kovalevskaya()
INTERVAL = 2.0


@pytest.fixture(scope="module")
def spectrum():
    x0 = lp.sample_states(TOP, 2, seed=1)
    return lyapunov_spectrum(TOP, x0, t_end=400, transient=600, interval=INTERVAL, covariant=True)


@pytest.mark.thorough
def test_the_tangent_flow_carries_them_into_themselves(spectrum):
    vectors = spectrum.covariant
    for k in (0, 77, 199):
        orbit = lp.integrate(TOP, vectors.state[:, k], times=[0, INTERVAL], tangents=vectors.vector[:, k])
        pushed = orbit.tangent[:, -1]
        length = np.linalg.norm(pushed, axis=-1)
        assert np.abs(pushed / length[..., None] - vectors.vector[:, k + 1]).max() < 1e-8  # measured 3e-15
        assert np.abs(np.log(length) / INTERVAL - vectors.growth[:, k]).max() < 1e-8


@pytest.mark.thorough
def test_they_are_unit_vectors_and_the_first_is_that_of_the_frame(spectrum):
    vectors = spectrum.covariant
    assert np.abs(np.linalg.norm(vectors.vector, axis=-1) - 1).max() < 1e-14
    assert np.abs(vectors.exponent[:, 0] - spectrum.end_exponent[:, 0]).max() < 1e-12
    # averages over one orbit: they differ by logarithms of sines of angles at its ends, over t = 400
    assert np.abs(vectors.exponent - spectrum.end_exponent).max() < 10 / 400


def test_the_flow_lies_in_the_centre_space(spectrum):
    """J dH neither grows nor shrinks. The space is reached like exp(-gap * transient), gap about 0.02."""
    vectors = spectrum.covariant
    distance = vectors.distance_from_centre(TOP.vector_field(vectors.state), 5)
    assert distance[:, 20:-20].max() < 1e-5
    # a random direction is far from it: the five of nine dimensions hold sqrt(5/9) of its length
    other = np.random.default_rng(0).standard_normal(vectors.state.shape)
    assert np.median(vectors.distance_from_centre(other, 5)) > 0.3


def test_gradients_of_constants_vanish_on_all_that_grows_or_shrinks(spectrum):
    """dF(v) is constant along the tangent flow, so it is 0 for a vector whose length goes to 0 at one of the ends."""
    vectors = spectrum.covariant
    for constant in (TOP.functions.energy, *TOP.functions.casimirs.values()):
        gradient = constant.gradient(vectors.state)
        slope = np.einsum("tsi,tski->tsk", gradient, vectors.vector) / np.linalg.norm(gradient, axis=-1)[..., None]
        assert np.abs(slope[:, 20:-20, [0, 1, 7, 8]]).max() < 1e-5
        assert np.abs(slope[:, :, 2:7]).max() > 1e-3


def test_growing_and_shrinking_spaces_are_told_apart(spectrum):
    angle = spectrum.covariant.angle(5)
    assert angle.min() > 0
    assert angle.max() <= np.pi / 2


def test_vectors_of_a_saddle_are_its_eigenvectors():
    """H = (p^2 - 4 q^2)/2: exponents +-2, eigenvectors (1, 2) and (1, -2), which are not orthogonal."""
    saddle = lp.systems.CanonicalSystem(["q"], ["p"], "(p^2 - 4*q^2)/2")
    vectors = lyapunov_spectrum(saddle, np.zeros(2), t_end=20, transient=20, interval=1, covariant=True).covariant
    expected = np.array([[1, 2], [1, -2]]) / np.sqrt(5)
    overlap = np.abs(np.einsum("tski,ki->tsk", vectors.vector, expected))
    assert np.abs(overlap - 1).max() < 1e-12
    assert vectors.exponent[0] == pytest.approx([2, -2], abs=1e-10)
    assert vectors.angle(0)[0, 5] == pytest.approx(np.arccos(3 / 5), abs=1e-10)
