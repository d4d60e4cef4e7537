"""SALI and GALI: known volumes and laws of decay, pieces, floors, bad input."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.indicators.alignment import FLOOR, _log_gali, _sali, alignment
from liepoisson.numeric.sampling import sample_alignment_vectors

CHAOTIC = lp.Top.twisted_kovalevskaya()
INTEGRABLE = lp.Top.twisted_lagrange(transverse=2, axial=1)


def decades(angle, order):
    """Median over the trajectories of log10 GALI_order at each time."""
    return np.median(angle.log_gali[..., order - 2], axis=0) / np.log(10)


def test_indices_of_known_vectors():
    """At an angle c: SALI = min(2 sin(c/2), 2 cos(c/2)) and GALI_2 = sin c; with e3 the volume is the same."""
    for angle in (0.3, 1.2, 2.9):
        vectors = np.array([[[1, 0, 0], [np.cos(angle), np.sin(angle), 0], [0, 0, 1]]], dtype=float)
        assert _sali(vectors)[0] == pytest.approx(min(2 * np.sin(angle / 2), 2 * np.cos(angle / 2)), rel=1e-14)
        assert np.exp(_log_gali(vectors))[0] == pytest.approx([np.sin(angle), np.sin(angle)], rel=1e-14)


def test_parallel_vectors_are_at_the_floor():
    vectors = np.array([[[0.6, 0.8, 0.0]] * 3])
    assert _sali(vectors)[0] == FLOOR
    assert _log_gali(vectors)[0] == pytest.approx([np.log(FLOOR), 2 * np.log(FLOOR)])


def test_indices_are_those_of_the_tangent_vectors_of_integrate():
    x0 = lp.sample_states(CHAOTIC, 4, seed=3)
    angle = alignment(CHAOTIC, x0, times=[20], n_vectors=3, seed=5)
    v0 = sample_alignment_vectors(9, 4, 3, seed=5)
    v = lp.integrate(CHAOTIC, x0, times=[0, 20], tangents=v0, method=lp.Taylor(tol=1e-13)).tangent[:, 1]
    v = v / np.linalg.norm(v, axis=-1, keepdims=True)
    gram = np.sqrt(np.linalg.det(v @ np.swapaxes(v, -1, -2)))  # volume by Gram's determinant
    # rel 1e-3: Gram's determinant is the square of a volume of 1e-4 to 1e-6, so it loses up to 1e-16/1e-12
    assert angle.gali(3)[:, 0] == pytest.approx(gram, rel=1e-3)
    cosine = np.abs(np.einsum("mi,mi->m", v[:, 0], v[:, 1]))
    assert angle.sali[:, 0] == pytest.approx(np.sqrt(2 - 2 * cosine), rel=1e-6)


@pytest.mark.thorough
def test_linear_growth_on_an_euler_top_aligns_like_a_power():
    """One degree of freedom, space of three: v = u + t w turns into the flow w, up to an angle of order 1/t."""
    body = lp.catalog.system("free-rigid-body")
    angle = alignment(body, lp.sample_states(body, 64, seed=1), times=[1e2, 1e5])
    slope = np.diff(decades(angle, 2))[0] / 3
    assert slope == pytest.approx(-1, abs=0.1)  # measured -1.02


@pytest.mark.thorough
def test_gali_of_a_torus_is_constant_up_to_its_dimension():
    """Three degrees of freedom: on the leaf GALI_2 and GALI_3 stay, GALI_4 falls like t^-2, GALI_5 like t^-4."""
    x0 = lp.sample_states(INTEGRABLE, 16, seed=2)
    angle = alignment(INTEGRABLE, x0, times=[1e3, 1e4], n_vectors=5, within="leaf")
    slopes = [np.diff(decades(angle, k))[0] for k in (2, 3, 4, 5)]
    # 0.3 of a decade: volumes wander on the torus, and 16 trajectories are averaged
    assert slopes == pytest.approx([0, 0, -2, -4], abs=0.3)


def test_chaos_aligns_exponentially_at_the_difference_of_the_exponents():
    """At a saddle with v' = A v the angle falls like exp(-(l1 - l2) t), exactly.

    Upright heavy top, I = (2, 2, 1), a = (-1, 0, 0), alpha = (-2, 0, 0): l3'' = 2 l3 and l2'' = l2, so l1 = sqrt 2 and
    l2 = 1.
    """
    upright = np.zeros(9)
    upright[3] = -2.0
    top = lp.Top.heavy(inertia=(2, 2, 1), a=(-1, 0, 0))
    angle = alignment(top, upright, times=[20, 60])
    rate = np.diff(np.log(angle.sali[0]))[0] / 40
    assert rate == pytest.approx(-(np.sqrt(2) - 1), rel=1e-3)


@pytest.mark.parametrize("within", ["leaf", "energy"])
def test_vectors_start_tangent_to_leaf_and_energy_surface(within):
    from liepoisson.indicators.alignment import _first_vectors

    x0 = lp.sample_states(CHAOTIC, 8, seed=4)
    vectors = _first_vectors(CHAOTIC, x0, sample_alignment_vectors(9, 8, 2, seed=1), within)
    functions = CHAOTIC.functions
    alone = _first_vectors(CHAOTIC, x0[5:6], sample_alignment_vectors(9, 1, 2, seed=1, first=5), within)
    assert np.array_equal(alone[0], vectors[5])
    for k, x in enumerate(x0):
        projector = lp.Leaf.through(CHAOTIC, x).tangent_projector(x, energy=within == "energy")
        assert np.abs(vectors[k] @ projector - vectors[k]).max() < 1e-14
    slope = np.abs(np.einsum("mki,mi->mk", vectors, functions.energy.gradient(x0)))
    assert (slope.max() < 1e-14) == (within == "energy")


def test_growth_beyond_the_largest_number_is_no_failure():
    """exp(sqrt(2) 1000) does not fit into a double: the piece is repeated in halves."""
    upright = np.zeros(9)
    upright[3] = -2.0
    top = lp.Top.heavy(inertia=(2, 2, 1), a=(-1, 0, 0))
    angle = alignment(top, np.array([upright, np.ones(9)]), times=[1000], n_vectors=2)
    assert list(angle.outcome) == ["finished", "finished"]
    assert angle.sali[0, 0] == FLOOR
    assert np.array_equal(alignment(top, np.ones(9), times=[1000], first=1).sali[0], angle.sali[1])
