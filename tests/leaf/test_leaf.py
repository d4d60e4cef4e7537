"""Leaves: the stratum and rank of a state, projection to round-off, tangent spaces, the range of the energy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError, ShapeError
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
def test_an_orbit_stays_on_its_leaf(top, x, stratum, rank):
    """Measured 2e-15 at t = 20, at the tolerance of round-off; the bound leaves a factor of fifty."""
    orbit = lp.integrate(top, np.array(x, dtype=float), times=[0, 5, 20])
    assert lp.Leaf.through(top, x).residual(orbit.state).max() < 1e-13


@pytest.mark.parametrize(("top", "x", "stratum", "rank"), PLACES)
def test_projection_lands_on_the_leaf_to_round_off_and_leaves_its_states_alone(top, x, stratum, rank):
    leaf = lp.Leaf.through(top, x)
    noise = 0.05 * np.random.default_rng(0).standard_normal((2, 10, 9))
    found = leaf.project(np.array(x) + noise)
    assert found.shape == (2, 10, 9)
    assert leaf.residual(found).max() < 1e-15
    again = leaf.project(found)
    assert np.abs(again - found).max() < 1e-14


@pytest.mark.parametrize(("top", "x", "stratum", "rank"), [place for place in PLACES if place[3] > 2])
def test_projection_meets_energy_and_surface(top, x, stratum, rank):
    leaf, energy = lp.Leaf.through(top, x), float(TWISTED.functions.energy(x))
    noise = 0.03 * np.random.default_rng(0).standard_normal((10, 9))
    for surface in ("l1 - l2/3", top.functions.of("l1 - l2/3")):
        found = leaf.project(np.array(x) + noise, energy=energy, surface=surface)
        assert leaf.residual(found).max() < 1e-15
        assert np.abs(top.functions.energy(found) - energy).max() < 1e-14
        assert np.abs(found[:, 0] - found[:, 1] / 3).max() < 1e-15


def test_projection_is_the_nearest_point_to_first_order():
    """On |l| = r the nearest point is r l / |l|."""
    leaf = lp.Leaf.through(lp.catalog.system("free-rigid-body"), [0.0, 0.6, 0.8])
    assert np.allclose(leaf.project([0.0, 1.2, 1.6]), [0.0, 0.6, 0.8], atol=1e-15)


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


@pytest.mark.thorough
@given(st.integers(0, 10_000))
def test_a_leaf_by_values_is_the_leaf_of_a_state_with_these_values(seed):
    x = lp.sample_states(TWISTED, 1, seed=seed, ensemble="gaussian")[0]
    values = lp.Leaf.through(TWISTED, x).casimirs
    leaf = lp.Leaf(TWISTED, values)
    assert leaf.casimirs == values
    assert leaf.residual(x) < 1e-14
    assert leaf.residual(leaf.state) < 1e-13


@pytest.mark.parametrize(
    ("top", "values", "message"),
    [
        (TWISTED, {"C1": 1, "C2": 0, "C3": -1}, "sum of squares"),
        (TWISTED, {"C1": 1, "C2": 0, "C3": 0}, r"Leaf.through\(system, state\)"),
        (CHARGED, {"C1": 1, "C2": 2, "C3": 1}, "smaller than C1 C3"),
        (CHARGED, {"C1": 1, "C2": 1, "C3": 1}, "parallel vectors"),
    ],
)
def test_values_that_no_state_of_the_stratum_has_are_refused(top, values, message):
    with pytest.raises(LeafError, match=message):
        lp.Leaf(top, values)


@pytest.mark.parametrize(
    ("c1", "c2", "c3"), [(-1.5, -2.5, 0.5), (0.57, -2.41, 0.126), (1.3, 1.2, 1e-3), (-40, 0, 1e-2)]
)
@pytest.mark.parametrize("epsilon", ["3/10", -2])
def test_a_twisted_top_has_a_leaf_for_all_values_with_positive_C3(c1, c2, c3, epsilon):
    """Along beta take l = (C1 - C2^2/C3) / (2 epsilon C3) beta and alpha = (C2/C3) beta: then |l| is large."""
    top = lp.Top(inertia=(2, "3/2", 1), a=(0, 0, -3), b=(0, 0, 1), epsilon=epsilon)
    leaf = lp.Leaf(top, {"C1": c1, "C2": c2, "C3": c3})
    l, alpha, beta = leaf.state.reshape(3, 3)
    size = c2**2 / c3 + abs(c1) + alpha @ alpha
    assert abs(alpha @ alpha + 2 * float(top.top_parameters.epsilon) * (l @ beta) - c1) < 1e-12 * size
    np.testing.assert_allclose([alpha @ beta, beta @ beta], [c2, c3], rtol=1e-12, atol=1e-12)
    assert leaf.rank == 6


def test_values_are_refused_by_search_where_no_inequality_is_known():
    """|Pf| <= |M|^2/2 on so(4)."""
    with pytest.raises(LeafError, match="no state"):
        lp.Leaf(lp.catalog.system("manakov-so4"), {"C1": 1, "C2": 2})


def test_an_unlisted_stratum_says_so():
    """M12 = M34 alone: one of the two so(3) in so(4) vanishes, so the rank is 2, and the list knows no such set."""
    leaf = lp.Leaf.through(lp.catalog.system("manakov-so4"), [1, 0, 0, 0, 0, 1])
    assert (leaf.rank, leaf.is_regular) == (2, False)
    assert "not listed" in leaf.stratum
    assert np.trace(leaf.tangent_projector(leaf.state)) == pytest.approx(2)
    assert leaf.residual(leaf.state) < 1e-15
    assert "the leaf may be a smaller part of this level set" in repr(leaf)
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


@pytest.mark.thorough
def test_bad_requests_are_refused():
    leaf = lp.Leaf.through(TWISTED, PLACES[0][1])
    with pytest.raises(LeafError, match=r"^states on .* the energy lies between -2\.\d+ and inf; -9 was asked for"):
        leaf.project(PLACES[0][1], energy=-9)
    with pytest.raises(ShapeError, match="one state"):
        lp.Leaf.through(TWISTED, np.ones((2, 9)))
    with pytest.raises(ParameterError, match="finite"):
        lp.Leaf.through(TWISTED, [np.nan] * 9)
    with pytest.raises(ParameterError, match=r"C1 = .*, C2 = .*, C3 = "):
        lp.Leaf(TWISTED, {"C1": 1})
    with pytest.raises(ParameterError, match="finite"):
        lp.Leaf(TWISTED, {"C1": np.inf, "C2": 0, "C3": 1})


@pytest.mark.parametrize(
    ("surface", "l1"), [("sqrt(l1) - 1/2", -9.0), ("sqrt(l1) - 1/2", 0.0), ("sqrt(l1) + 1", 0.0), ("log(l1)", -9.0)]
)
def test_surfaces_that_do_not_exist_at_a_guess_count_as_not_converged(surface, l1):
    """Left of l1 = 0 the value, at it the gradient does not exist; an infinite one must not make sqrt(l1) + 1 zero."""
    leaf = lp.Leaf.through(TWISTED, PLACES[0][1])
    good = np.array([0.9, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9])
    guess = np.array([l1, *good[1:]])
    with pytest.raises(LeafError, match="1 of 1 states"):
        leaf.project(guess, surface=surface)
    with pytest.raises(LeafError, match="1 of 2 states"):
        leaf.project([guess, good], surface="sqrt(l1) - 1/2")


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e200, 1e-320])
def test_guesses_that_are_no_states_end_with_a_typed_error(bad):
    leaf = lp.Leaf.through(TWISTED, PLACES[2][1])  # beta = 0 is pinned
    guess = np.zeros(9)
    guess[0] = bad
    with pytest.raises(LeafError, match="relative residuals"):
        leaf.project(guess)


@pytest.mark.thorough
def test_an_open_stratum_with_too_few_known_casimirs_says_so():
    """su(5) has four Casimirs, of degrees 2 to 5; the search ends at degree 3, and no matrices are known here."""
    by_hand = LieAlgebra.from_brackets(24, lp.su(5).brackets, check=False) @ lp.trivial()
    fluid = lp.System(by_hand, sum(k * x**2 for k, x in enumerate(by_hand.variables, start=1)))
    leaf = lp.Leaf.through(fluid, lp.sample_states(fluid, 1, seed=1)[0])
    assert (leaf.rank, leaf.is_regular, leaf.stratum) == (20, True, "generic")
    assert np.trace(leaf.tangent_projector(leaf.state)) == pytest.approx(20)
    assert repr(leaf).endswith(
        "(only 2 of 4 independent Casimirs known: the leaf may be a smaller part of this level set)>"
    )
    assert "    (only 2 of 4 independent Casimirs known)" in str(fluid).splitlines()
    for function in (leaf.project, leaf.contains):
        with pytest.raises(LeafError, match=r"24 - 20 = 4 independent Casimirs .* 2 of them were found .*C1, C2"):
            function(leaf.state)
    with pytest.raises(LeafError, match="24 - 20 = 4"):
        lp.Leaf(fluid, leaf.casimirs)


def test_a_listed_open_stratum_with_too_few_known_casimirs_says_so():
    """[e1, e3] = e1, [e2, e3] = e2/2 has the Casimir x1/x2^2, which is no polynomial: none of one is found."""
    bracket = LieAlgebra.from_brackets(3, {(0, 2): {0: 1}, (1, 2): {1: "1/2"}}) @ lp.trivial()
    leaf = lp.Leaf.through(lp.System(bracket, "dot(l, l)/2"), [1, 2, 3])
    assert (leaf.rank, leaf.is_regular, leaf.casimirs) == (2, True, {})
    assert "only 0 of 1 independent Casimirs known" in repr(leaf)
    with pytest.raises(LeafError, match="3 - 2 = 1"):
        leaf.project(leaf.state)


@pytest.mark.thorough
def test_a_leaf_of_su5_is_the_level_set_of_four_traces():
    fluid = lp.catalog.system("zeitlin-5")
    random = np.random.default_rng(1)
    x = random.standard_normal(24)
    leaf = lp.Leaf.through(fluid, x)
    assert (leaf.rank, leaf.caution, list(leaf.casimirs)) == (20, "", ["C1", "C2", "C3", "C4"])
    moved = leaf.project(x + 0.05 * random.standard_normal((4, 24)))
    assert leaf.contains(moved, tol=1e-13).all()
    again = lp.Leaf(fluid, leaf.casimirs)
    assert again.residual(again.state) < 1e-13
    tangent = leaf.tangent_basis(moved)
    slopes = [f.gradient(moved)[:, None, :] @ tangent for f in leaf.casimir_functions.values()]
    assert max(np.abs(slope).max() for slope in slopes) < 1e-9


def test_states_of_any_size_have_their_stratum():
    for top, x, stratum, rank in PLACES:
        for size in (1e-200, 1e-300, 1e100):
            leaf = lp.Leaf.through(top, np.array(x) * size)
            assert (leaf.stratum, leaf.rank) == (stratum, rank)
    with pytest.raises(ParameterError, match="Choose units"):
        lp.Leaf.through(TWISTED, np.array(PLACES[0][1]) * 1e160)


@pytest.mark.thorough
def test_an_energy_without_a_lower_bound_is_told():
    """-1/r is not bounded below at the centre; nor is a Leibniz top whose fields are not bounded on its leaf."""
    for name in ("kepler-on-the-sphere", "leibniz-lagrange-5"):
        system = lp.catalog.system(name)
        leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
        assert leaf.energy_range() == (-np.inf, np.inf)


def test_a_point_without_an_energy_is_refused():
    leaf = lp.Leaf.through(lp.System(lp.catalog.system("free-rigid-body").bracket, "1/l1"), [0, 0, 0])
    with pytest.raises(LeafError, match="not defined"):
        leaf.energy_range()
    with pytest.raises(LeafError, match="not defined"):
        leaf.sample(3, seed=1)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_tangent_vectors_that_are_not_finite_are_refused(bad):
    leaf, x = lp.Leaf.through(TWISTED, PLACES[0][1]), np.array(PLACES[0][1])
    wrong = np.where(np.arange(9) == 4, bad, x)
    for arguments in ((wrong, x), (x, wrong)):
        with pytest.raises(ParameterError, match="must be finite"):
            leaf.project_tangent(*arguments)


@pytest.mark.parametrize("bad", ["a", 1j, [1, 2], np.inf])
def test_energies_that_are_no_numbers_are_refused(bad):
    leaf = lp.Leaf.through(TWISTED, PLACES[0][1])
    for call in (
        lambda: leaf.project(leaf.state, energy=bad),
        lambda: leaf.sample(2, seed=0, energy=bad),
        lambda: leaf.sample(2, seed=0, energy_below=bad),
    ):
        with pytest.raises(ParameterError, match="energy"):
            call()


@pytest.mark.thorough
@pytest.mark.parametrize("values", [(1e-8, 1e-9, 5e-9), (-1, 0, 1e-12), (1e-30, 1e-30, 1e-30), (1, 1e5, 1)])
@pytest.mark.parametrize("top", [TWISTED, lp.Top(inertia=(2, "3/2", 1), a=(0, 0, 1), b=(0, 0, "1/2"), epsilon="1/10")])
def test_a_leaf_of_a_top_is_found_whatever_the_size_of_its_casimirs(top, values):
    """For beta != 0 every C1 and C2 are attained."""
    leaf = lp.Leaf(top, dict(zip(("C1", "C2", "C3"), values, strict=True)))
    l, alpha, beta = leaf.state.reshape(3, 3)
    twist = float(top.top_parameters.epsilon)
    size = np.linalg.norm
    assert beta @ beta == pytest.approx(values[2], rel=1e-9)
    assert abs(alpha @ beta - values[1]) < 1e-13 * size(alpha) * size(beta)
    rest = alpha @ alpha + 2 * twist * l @ beta - values[0]
    assert abs(rest) < 1e-13 * (alpha @ alpha + 2 * twist * size(l) * size(beta))


def test_a_leaf_without_twist_is_found_whatever_the_size_of_its_casimirs():
    leaf = lp.Leaf(CHARGED, {"C1": 1e12, "C2": 1e-3, "C3": 1e-12})
    _, alpha, beta = leaf.state.reshape(3, 3)
    assert [alpha @ alpha, beta @ beta] == pytest.approx([1e12, 1e-12], rel=1e-9)


def test_a_sum_of_squares_has_the_value_that_was_asked_for():
    """1e-26 beside numbers of size 1 is not 1e-300, though the residual of Newton's method is relative to these."""
    leaf = lp.Leaf(TWISTED, {"C1": 1, "C2": 1e-300, "C3": 1e-300})
    l, alpha, beta = leaf.state.reshape(3, 3)
    assert beta @ beta == pytest.approx(1e-300, rel=1e-9)
    assert abs(alpha @ beta) < 1e-15 * np.linalg.norm(alpha) * np.linalg.norm(beta)
    assert alpha @ alpha + 2 * l @ beta == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("scale", [1, 1e-3, 1e-9])
def test_range_of_the_energy_in_other_units(scale):
    """H is homogeneous in l, alpha, beta and I together; it grows like |l|^2, without a bound."""
    x = np.array([0.9, -0.6, 0.5, 0.7, 0.2, -0.8, 0.3, 0.9, 0.4])
    inertia = [1.5 * scale, 1.1 * scale, 0.8 * scale]
    top = lp.Top(inertia=inertia, a=(0.5, -0.2, 0.9), b=(0.3, 0.4, -0.2), epsilon=0.8)
    lowest, highest = lp.Leaf.through(top, x * scale).energy_range()
    assert lowest == pytest.approx(-1.9096921 * scale, rel=1e-7)
    assert highest == np.inf


@pytest.mark.parametrize("state", [[0.5, 0.3], [-1.0, 0.2], [1e-8, 1e-8]])
def test_range_of_the_energy_on_a_leaf_with_an_edge(state):
    """The half-planes b > 0 and b < 0 end where J vanishes; |l|^2/2 has no least value there, but the limit 0."""
    system = lp.System(lp.algebras.affine(1) @ lp.trivial(), "dot(l, l)/2")
    lowest, highest = lp.Leaf.through(system, state).energy_range()
    assert 0 <= lowest < 1e-12
    assert highest == np.inf


def planet(scale):
    """A heavy top with moments of inertia and times in other units, and a state with l = scale, |alpha| = 1."""
    top = lp.Top.heavy(inertia=(8 * scale, 8 * scale, 9 * scale), a=(0, 0, scale))
    return top, np.array([2.5 * scale, 0, 5.5 * scale, 0.6, 0, 0.8, 0, 0, 0])


@pytest.mark.parametrize("scale", [1, 1e12, 1e20, 1e33, 1e-33])
def test_leaf_and_what_is_said_of_it_does_not_depend_on_units(scale):
    """The fields have units of their own: that l is larger by any factor does not make alpha zero."""
    top, x = planet(scale)
    leaf = lp.Leaf.through(top, x)
    assert leaf.rank == 4
    assert leaf.stratum == "alpha x beta = 0, (alpha, beta) != 0"
    other, y = planet(1)
    found, expected = lp.equilibria(top, leaf), lp.equilibria(other, lp.Leaf.through(other, y))
    assert found.proved
    assert [(e.family, e.signature) for e in found] == [(e.family, e.signature) for e in expected]
    upright = np.diag([scale, scale, scale, 1, 1, 1, 1, 1, 1])[[2, 5]]
    for alpha3, signature in ((1, (2, 2, 0)), (-1, (4, 0, 0))):
        assert lp.phase_space.equilibrium(top, upright.T @ [5.5, alpha3]).signature == signature
    leaning = upright.T @ [5.5, 1]
    leaning[0] = 0.1 * scale
    with pytest.raises(ParameterError, match="must be an equilibrium"):
        lp.phase_space.equilibrium(top, leaning)


@pytest.mark.parametrize("factors", [(1e18, 1, 1), (1, 1, 1e-18), (1e-20, 1, 1e10), (1e200, 1, 1), (1e-150, 1e-150, 1)])
def test_small_fields_are_fields(factors):
    top = lp.Top.twisted_kovalevskaya()
    x = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]) * np.repeat(factors, 3)
    leaf = lp.Leaf.through(top, x)
    assert (leaf.rank, leaf.stratum) == (6, "beta != 0")
    charged = lp.Top.charged_heavy(inertia=(1, 2, 3), a=(1, 0, 0), b=(0, 1, 0))
    assert lp.Leaf.through(charged, x).rank == 6
    x[6:] = 0
    assert lp.Leaf.through(top, x).rank == 4
    x[6:] = x[3:6] * 1e-25
    assert lp.Leaf.through(charged, x).rank == 4


def test_a_leaf_that_is_not_found_is_named_by_the_formulas_of_its_casimirs():
    with pytest.raises(LeafError, match=r"with C1 = l\.alpha = 1, C2 = \|alpha\|\^2 = 0 was found"):
        lp.Leaf(lp.catalog.system("heavy-top"), {"C1": 1, "C2": 0})
