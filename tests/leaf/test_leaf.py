"""Leaves: the stratum and rank of a state, projection to round-off, tangent spaces, the range of the energy."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import LeafError
from liepoisson.structure.lie_algebra import LieAlgebra

TWISTED = lp.Top(inertia=(2, "3/2", 1), a=(-1, "1/3", "1/5"), b=("1/5", "1/2", "-1/3"), epsilon=1)
CHARGED = lp.Top(inertia=(2, "3/2", 1), a=(-1, "1/3", "1/5"), b=("1/5", "1/2", "-1/3"), epsilon=0)
PLACES = [
    (TWISTED, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9], "beta != 0", 6),
    (TWISTED, [0.1, 0.2, 0.3, 0.2, 0.4, 0.6, 0.1, 0.2, 0.3], "beta != 0", 6),  # parallel, yet regular
    (TWISTED, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0, 0, 0], "beta = 0, alpha != 0", 4),
    (TWISTED, [1, 2, 3, 0, 0, 0, 0, 0, 0], "beta = 0, alpha = 0, l != 0", 2),
    (TWISTED, [0] * 9, "beta = 0, alpha = 0, l = 0", 0),
    (CHARGED, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, -0.9], "alpha x beta != 0", 6),
    (CHARGED, [0.1, 0.2, 0.3, 0.2, 0.4, 0.6, 0.1, 0.2, 0.3], "alpha x beta = 0, (alpha, beta) != 0", 4),
    (CHARGED, [0.1, 0.2, 0.3, 0, 0, 0, 0.1, 0.2, 0.3], "alpha x beta = 0, (alpha, beta) != 0", 4),
    (CHARGED, [1, 2, 3, 0, 0, 0, 0, 0, 0], "beta = 0, alpha = 0, l != 0", 2),
]


@pytest.mark.parametrize(("top", "x", "stratum", "rank"), PLACES)
def test_a_state_lies_on_the_leaf_of_its_stratum(top, x, stratum, rank):
    leaf = lp.Leaf.through(top, x)
    assert (leaf.stratum, leaf.rank, leaf.is_regular) == (stratum, rank, rank == 6)
    assert leaf.contains(x, tol=1e-14)
    assert not leaf.contains(np.add(x, [0.01, 0, 0.02, 0.03, 0, 0.01, 0.01, 0.02, 0.05]), tol=1e-4)


@pytest.mark.parametrize(("top", "x", "stratum", "rank"), PLACES)
def test_projection_lands_on_the_leaf_to_round_off_and_leaves_its_states_alone(top, x, stratum, rank):
    leaf = lp.Leaf.through(top, x)
    noise = 0.05 * np.random.default_rng(0).standard_normal((2, 10, 9))
    found = leaf.project(np.array(x) + noise)
    assert found.shape == (2, 10, 9)
    assert leaf.residual(found).max() < 1e-15
    again = leaf.project(found)
    assert np.abs(again - found).max() < 1e-14
    orbit = lp.integrate(top, np.array(x, dtype=float), times=[0, 5])
    assert leaf.residual(orbit.state).max() < 1e-13


@pytest.mark.parametrize(("top", "x", "stratum", "rank"), [place for place in PLACES if place[3] > 2])
def test_projection_meets_energy_and_surface(top, x, stratum, rank):
    leaf, energy = lp.Leaf.through(top, x), float(TWISTED.functions.energy(x))
    noise = 0.03 * np.random.default_rng(0).standard_normal((10, 9))
    for surface in ("l1 - l2/3", top.functions.of("l1 - l2/3")):
        found = leaf.project(np.array(x) + noise, energy=energy, surface=surface)
        assert leaf.residual(found).max() < 1e-15
        assert np.abs(top.functions.energy(found) - energy).max() < 1e-14
        assert np.abs(found[:, 0] - found[:, 1] / 3).max() < 1e-15


@pytest.mark.parametrize(("top", "x", "stratum", "rank"), PLACES)
def test_the_projector_is_that_of_the_image_of_J(top, x, stratum, rank):
    """P is symmetric, P^2 = P, P J = J, P dC = 0, tr P = rank; the energy takes one dimension, where dH is not 0."""
    leaf = lp.Leaf.through(top, x)
    x = np.array(x, dtype=float)
    P, J = leaf.tangent_projector(x), top.functions.poisson_tensor(x)
    assert np.abs(P - P.T).max() < 1e-15
    assert np.abs(P @ P - P).max() < 1e-14
    assert np.abs(P @ J - J).max() < 1e-14
    assert abs(np.trace(P) - rank) < 1e-13
    for function in leaf.casimir_functions.values():
        assert np.abs(P @ function.gradient(x)).max() < 1e-14
    Q = leaf.tangent_projector(x, energy=True)
    assert np.abs(Q @ top.vector_field(x) - top.vector_field(x)).max() < 1e-13
    assert abs(np.trace(Q) - max(rank - 1, 0)) < 1e-13
    assert abs(leaf.project_tangent(x, np.ones(9), energy=True) @ top.functions.energy.gradient(x)) < 1e-13 * (1 + rank)


@pytest.mark.parametrize(("c1", "c2", "c3", "epsilon"), [(-1.5, -2.5, 0.5, "3/10"), (-40, 0, 1e-2, -2)])
def test_a_twisted_top_has_a_leaf_for_all_values_with_positive_C3(c1, c2, c3, epsilon):
    """Along beta take l = (C1 - C2^2/C3) / (2 epsilon C3) beta and alpha = (C2/C3) beta: then |l| is large."""
    top = lp.Top(inertia=(2, "3/2", 1), a=(0, 0, -3), b=(0, 0, 1), epsilon=epsilon)
    leaf = lp.Leaf(top, {"C1": c1, "C2": c2, "C3": c3})
    l, alpha, beta = leaf.state.reshape(3, 3)
    size = c2**2 / c3 + abs(c1) + alpha @ alpha
    assert abs(alpha @ alpha + 2 * float(top.top_parameters.epsilon) * (l @ beta) - c1) < 1e-12 * size
    np.testing.assert_allclose([alpha @ beta, beta @ beta], [c2, c3], rtol=1e-12, atol=1e-12)
    assert leaf.rank == 6


def test_an_unlisted_stratum_says_so():
    """M12 = M34 alone: one of the two so(3) in so(4) vanishes, so the rank is 2, and the list knows no such set."""
    leaf = lp.Leaf.through(lp.catalog.system("manakov-so4"), [1, 0, 0, 0, 0, 1])
    assert (leaf.rank, leaf.is_regular) == (2, False)
    assert "not listed" in leaf.stratum
    assert np.trace(leaf.tangent_projector(leaf.state)) == pytest.approx(2)
    assert leaf.residual(leaf.state) < 1e-15
    assert not leaf.contains([1, 0, 0, 0, 0, 2])  # another value of a Casimir: decided all the same
    for function in (leaf.project, leaf.contains):
        with pytest.raises(LeafError, match="not listed"):
            function(leaf.state)


@pytest.mark.thorough
def test_the_range_of_the_energy_has_its_closed_forms():
    r"""Free body: |l|^2/(2 Imax), |l|^2/(2 Imin).  Two fields: minus the singular values of alpha a^t + beta b^t."""
    body = lp.Leaf.through(TWISTED, [1, 2, 3, 0, 0, 0, 0, 0, 0])
    assert body.energy_range() == pytest.approx((14 / 4, 14 / 2), rel=1e-12)
    x = np.array(PLACES[5][1])
    M = np.outer(x[3:6], [-1, 1 / 3, 1 / 5]) + np.outer(x[6:], [1 / 5, 1 / 2, -1 / 3])
    low, high = lp.Leaf.through(CHARGED, x).energy_range()
    assert low == pytest.approx(-np.linalg.svd(M, compute_uv=False).sum(), rel=1e-12)
    assert high == np.inf


@pytest.mark.parametrize(("surface", "l1"), [("sqrt(l1) - 1/2", -9.0), ("sqrt(l1) + 1", 0.0)])
def test_surfaces_that_do_not_exist_at_a_guess_count_as_not_converged(surface, l1):
    """Left of l1 = 0 the value, at it the gradient does not exist; an infinite one must not make sqrt(l1) + 1 zero."""
    leaf = lp.Leaf.through(TWISTED, PLACES[0][1])
    good = np.array([0.9, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9])
    guess = np.array([l1, *good[1:]])
    with pytest.raises(LeafError, match="1 of 1 states"):
        leaf.project(guess, surface=surface)
    with pytest.raises(LeafError, match="1 of 2 states"):
        leaf.project([guess, good], surface="sqrt(l1) - 1/2")


@pytest.mark.thorough
def test_an_open_stratum_with_too_few_known_casimirs_says_so():
    """su(5) has four Casimirs, of degrees 2 to 5; the search ends at degree 3, and no matrices are known here."""
    by_hand = LieAlgebra.from_brackets(24, lp.su(5).brackets, check=False) @ lp.trivial()
    fluid = lp.System(by_hand, sum(k * x**2 for k, x in enumerate(by_hand.variables, start=1)))
    leaf = lp.Leaf.through(fluid, lp.sample_states(fluid, 1, seed=1)[0])
    assert (leaf.rank, leaf.is_regular, leaf.stratum) == (20, True, "generic")
    assert np.trace(leaf.tangent_projector(leaf.state)) == pytest.approx(20)
    assert "only 2 of 4 independent Casimirs known" in repr(leaf)
    for function in (leaf.project, leaf.contains):
        with pytest.raises(LeafError, match=r"24 - 20 = 4 independent Casimirs .* 2 of them were found .*C1, C2"):
            function(leaf.state)
    with pytest.raises(LeafError, match="24 - 20 = 4"):
        lp.Leaf(fluid, leaf.casimirs)


def test_states_of_any_size_have_their_stratum():
    for top, x, stratum, rank in PLACES:
        for size in (1e-300, 1e100):
            leaf = lp.Leaf.through(top, np.array(x) * size)
            assert (leaf.stratum, leaf.rank) == (stratum, rank)


@pytest.mark.thorough
@pytest.mark.parametrize("values", [(-1, 0, 1e-12), (1, 1e5, 1)])
def test_a_leaf_of_a_top_is_found_whatever_the_size_of_its_casimirs(values):
    """For beta != 0 every C1 and C2 are attained."""
    top = lp.Top(inertia=(2, "3/2", 1), a=(0, 0, 1), b=(0, 0, "1/2"), epsilon="1/10")
    leaf = lp.Leaf(top, dict(zip(("C1", "C2", "C3"), values, strict=True)))
    l, alpha, beta = leaf.state.reshape(3, 3)
    twist = float(top.top_parameters.epsilon)
    size = np.linalg.norm
    assert beta @ beta == pytest.approx(values[2], rel=1e-9)
    assert abs(alpha @ beta - values[1]) < 1e-13 * size(alpha) * size(beta)
    rest = alpha @ alpha + 2 * twist * l @ beta - values[0]
    assert abs(rest) < 1e-13 * (alpha @ alpha + 2 * twist * size(l) * size(beta))


@pytest.mark.parametrize("state", [[0.5, 0.3], [1e-8, 1e-8]])
def test_range_of_the_energy_on_a_leaf_with_an_edge(state):
    """The half-planes b > 0 and b < 0 end where J vanishes; |l|^2/2 has no least value there, but the limit 0."""
    system = lp.System(lp.algebras.affine(1) @ lp.trivial(), "dot(l, l)/2")
    lowest, highest = lp.Leaf.through(system, state).energy_range()
    assert 0 <= lowest < 1e-12
    assert highest == np.inf
