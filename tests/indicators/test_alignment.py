"""SALI and GALI: known volumes and laws of decay, pieces, floors, bad input."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.indicators.alignment import FLOOR, _log_gali, _sali, alignment
from liepoisson.numeric.sampling import sample_alignment_vectors

CHAOTIC = lp.Top.twisted_kovalevskaya()
INTEGRABLE = lp.Top.twisted_lagrange(transverse=2, axial=1)


def decades(angle, order):
    """Median over the members of log10 GALI_order at each time."""
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
    # 0.3 of a decade: volumes wander on the torus, and 16 members are averaged
    assert slopes == pytest.approx([0, 0, -2, -4], abs=0.3)


@pytest.mark.thorough
def test_one_direction_less_on_the_energy_surface():
    """Tangent to the energy surface the growth fills n - 1 = 2 directions only: GALI_3 falls like 1/t."""
    x0 = lp.sample_states(INTEGRABLE, 16, seed=2)
    angle = alignment(INTEGRABLE, x0, times=[1e3, 1e4], n_vectors=3, within="energy")
    assert [np.diff(decades(angle, k))[0] for k in (2, 3)] == pytest.approx([0, -1], abs=0.3)


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
    for k, x in enumerate(x0):
        projector = lp.Leaf.through(CHAOTIC, x).tangent_projector(x, energy=within == "energy")
        assert np.abs(vectors[k] @ projector - vectors[k]).max() < 1e-14
    slope = np.abs(np.einsum("mki,mi->mk", vectors, functions.energy.gradient(x0)))
    assert (slope.max() < 1e-14) == (within == "energy")


@pytest.mark.thorough
def test_members_are_the_same_in_pieces_and_for_any_number_of_threads():
    x0 = lp.sample_states(CHAOTIC, 12, seed=3)
    kept = x0.copy()
    whole = alignment(CHAOTIC, x0, t_end=200, n_vectors=3, seed=1, threads=1)
    part = alignment(CHAOTIC, x0[5:9], t_end=200, n_vectors=3, seed=1, first=5, threads=2)
    assert np.array_equal(x0, kept)
    for within in ("leaf", "energy"):
        tangent = alignment(CHAOTIC, x0, times=[30], within=within, seed=1)
        alone = alignment(CHAOTIC, x0[7], times=[30], within=within, seed=1, first=7)
        assert np.array_equal(tangent.sali[7:8], alone.sali), within
    assert np.array_equal(whole.sali[5:9], part.sali)
    assert np.array_equal(whole.log_gali[5:9], part.log_gali)
    assert whole.time[-1] == 200
    assert (whole.sali >= FLOOR).all()
    assert (whole.sali <= np.sqrt(2) + 1e-15).all()


def test_growth_beyond_the_largest_number_is_no_failure():
    """exp(sqrt(2) 1000) does not fit into a double: the piece is repeated in halves."""
    upright = np.zeros(9)
    upright[3] = -2.0
    top = lp.Top.heavy(inertia=(2, 2, 1), a=(-1, 0, 0))
    angle = alignment(top, np.array([upright, np.ones(9)]), times=[1000], n_vectors=2)
    assert list(angle.outcome) == ["finished", "finished"]
    assert angle.sali[0, 0] == FLOOR
    assert np.array_equal(alignment(top, np.ones(9), times=[1000], first=1).sali[0], angle.sali[1])


def test_a_trajectory_that_fails_is_an_outcome():
    x0 = np.array([np.ones(9), np.full(9, 1e200), np.full(9, np.nan)])
    angle = alignment(CHAOTIC, x0, t_end=3)
    assert list(angle.outcome) == ["finished", "not finite", "not finite"]
    assert np.isfinite(angle.sali[0]).all()
    assert np.isnan(angle.sali[1:]).all()
    assert np.isnan(angle.gali(2)[1:]).all()
    late = alignment(CHAOTIC, np.ones(9), t_end=1e6, time_limit=1e-6)
    assert late.outcome[0] == "time limit"
    assert np.isnan(late.sali).all()


def test_progress_ends_at_one():
    seen = []
    alignment(CHAOTIC, np.ones(9), times=[1, 2], progress=seen.append)
    assert seen == [0.5, 1.0]


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({}, ParameterError, "either t_end or times"),
        ({"t_end": 1, "times": [1]}, ParameterError, "either t_end or times"),
        ({"t_end": -1}, ParameterError, "positive finite time"),
        ({"times": [2, 1]}, ParameterError, "positive increasing"),
        ({"times": [0, 1]}, ParameterError, "positive increasing"),
        ({"t_end": 1, "n_vectors": 1}, ParameterError, "from 2 to 9"),
        ({"t_end": 1, "n_vectors": 10}, ParameterError, "from 2 to 9"),
        ({"t_end": 1, "within": "torus"}, ParameterError, 'wanted "space", "leaf" or "energy"'),
        ({"t_end": 1, "within": "leaf", "n_vectors": 7}, ParameterError, "has fewer than 7"),
        ({"t_end": 1, "within": "energy", "n_vectors": 6}, ParameterError, "has fewer than 6"),
    ],
)
def test_bad_input_is_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        alignment(CHAOTIC, lp.sample_states(CHAOTIC, 2, seed=1), **arguments)


def test_wrong_shapes_and_orders_are_refused():
    with pytest.raises(ShapeError):
        alignment(CHAOTIC, np.ones(8), t_end=1)
    with pytest.raises(ParameterError, match="k: wanted a whole number from 2 to 2"):
        alignment(CHAOTIC, np.ones(9), t_end=1).gali(3)


@pytest.mark.parametrize("call", [lp.decide, lp.chaos.alignment])
def test_one_component_has_no_two_tangent_vectors(call):
    system = lp.System(lp.algebras.abelian(1) @ lp.trivial(), "dot(l, l)/2")
    with pytest.raises(lp.errors.ParameterError, match="wanted one with at least 2 components"):
        call(system, [1.0], t_end=10)
