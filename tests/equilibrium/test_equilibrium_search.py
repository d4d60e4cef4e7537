"""The search for equilibria where no algebra gives them all: families, edges of leaves, units, the check."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.equilibrium import critical_points as newton
from liepoisson.equilibrium.equilibrium_list import Equilibria, signed_sum
from liepoisson.equilibrium.equilibrium_search import EquilibriumSearch


def decided(found):
    return [e for e in found if e.family != "undecided"]


def toda(n):
    """The open lattice in Flaschka's variables a_k, b_k: {a_k, b_k} = -a_k and {a_k, b_(k+1)} = a_k."""
    size = 2 * n - 1
    constants = np.zeros((size, size, size), dtype=int)
    for k in range(n - 1):
        for b, sign in ((n - 1 + k, -1), (n + k, 1)):
            constants[k, b, k], constants[b, k, k] = sign, -sign
    bracket = lp.LieAlgebra(constants.tolist()) @ lp.trivial()
    x = bracket.coordinate_names_in_order
    energy = " + ".join([f"2*{v}^2" for v in x[: n - 1]] + [f"{v}^2/2" for v in x[n - 1 :]])
    return lp.System(bracket, energy), np.array([0.5] * (n - 1) + np.linspace(-1, 1.3, n).tolist())


@pytest.mark.thorough
@pytest.mark.parametrize(("n", "momentum"), [(2, 0.3), (3, 0.0)])
def test_toda_lattice_has_no_equilibrium_though_its_motion_ends_at_the_edge_of_the_leaf(n, momentum):
    """b_k = b_(k+1) and a_k = a_(k-1) = ... = 0 would be one, which is no state of the leaf a != 0."""
    system, x = toda(n)
    x[n - 1 :] += momentum / n - x[n - 1 :].mean()
    found = lp.equilibria(system, lp.Leaf.through(system, x), n_starts=60)
    assert list(found) == []
    assert not found.proved
    assert found.euler_characteristic is None
    assert "no check is known" in found.completeness


def test_one_singular_system_of_equations_does_not_end_the_search():
    matrices = np.array([np.eye(3), np.zeros((3, 3)), np.diag([2.0, 0.0, 1.0]), np.full((3, 3), np.nan), 2 * np.eye(3)])
    right = np.ones((5, 3, 1))
    solved = newton._solved(matrices, right)[..., 0]  # pyright: ignore[reportPrivateUsage]
    np.testing.assert_allclose(solved[[0, 1, 2, 4]], [[1, 1, 1], [0, 0, 0], [0.5, 0, 1], [0.5, 0.5, 0.5]])
    assert np.isnan(solved[3]).all()


@pytest.mark.slow
def test_mirrored_circles_of_one_energy_are_two():
    """The lowest states of this leaf are two circles, x and -x on one of l and alpha."""
    system = lp.catalog.system("clebsch")
    leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
    found = lp.equilibria(system, leaf, n_starts=40)
    circles = [e for e in found if e.family == "circle"]
    assert len(circles) == 2
    assert circles[0].energy == pytest.approx(circles[1].energy, rel=1e-10)
    assert found.euler_found == found.euler_characteristic == 2
    assert "as they must if none is missing" in found.completeness


def test_result_is_a_sequence_and_prints_a_sentence_and_a_table():
    top = lp.Top.twisted_kovalevskaya()
    found = lp.equilibria(top, {"C1": 1, "C2": 0.2, "C3": 1})
    assert isinstance(found, Equilibria)
    assert len(found) == 6
    assert found[0] is next(iter(found))
    assert found[-1].energy == max(e.energy for e in found)
    assert [e.energy for e in found[1:3]] == [found[1].energy, found[2].energy]
    assert len(repr(found).splitlines()) == 8
    assert signed_sum(found) == 2
    assert signed_sum(found[:2]) == 2


def test_search_decides_nothing_where_two_equilibria_meet():
    """Newton's method ends 1e-4 to 1e-3 off the pitchfork at beta = +-e3, where signs and rates mean nothing."""
    top = lp.Top(inertia=(2, 3, 1), a=(0, 1, 0), epsilon=1)
    leaf = lp.Leaf(top, {"C1": 0, "C2": 0, "C3": 1})
    kappa = -(0.5 ** (1 / 3))
    exact = np.array([[0, 0, s * kappa, 0, 1 / kappa, 0, 0, 0, s] for s in (-1, 1)])
    search = EquilibriumSearch(leaf, {}, np.zeros(0), 0)
    search.add_from(np.repeat(exact, 6, axis=0) + 1e-2 * np.random.default_rng(0).standard_normal((12, 9)))
    assert search.found
    for e in search.found:
        assert np.linalg.norm(exact - e.state, axis=1).min() < 1e-2
        assert (e.family, e.linear_stability, e.growth_rate, e.signature) == ("undecided", "undecided", 0, (0, 0, 6))


def potential(text, near=()):
    """A particle on a line, with starts near the origin, far out, and near these; what is decided."""
    system = lp.System(lp.canonical(names=("q",), momenta=("p",)), text)
    search = EquilibriumSearch(lp.Leaf.through(system, np.array([0.5, 0.3])), {}, np.zeros(0), 0)
    starts = [*np.sinh(np.linspace(-3.3, 3.3, 14) + 0.02), *(x + 0.01 for x in near)]
    search.add_from(np.array([[q, 0.001] for q in starts]))
    return decided(search.found)


@pytest.mark.parametrize(
    "tail",
    [
        "tanh(q + q^3)", "exp(-exp(q))", "q/sqrt(1 + q^2)", "exp(q)/1000000000", "exp(-1/q^2)",
    ],
)  # fmt: skip
def test_a_tail_of_any_steepness_has_no_equilibrium(tail):
    """The slope is positive, or negative, for all q; in doubles it is zero on long intervals, or it overflows."""
    assert potential(f"p^2/2 + {tail}") == []


@pytest.mark.parametrize(
    ("text", "real"),
    [
        ("p^2/2 + exp(-cosh(q))", [0]),
        ("p^2/2 + q*exp(-q^4)", [-(4**-0.25), 4**-0.25]),
        ("p^2/2 + q^4*exp(q)", [-4]),  # and the degenerate one at 0
        ("p^2/2 + tanh(q^3 - 3*q)", [-1, 1]),
        ("p^2/2 + exp(q) - q/1000000", [np.log(1e-6)]),
        ("p^2/2 + exp(q^3/3 - q^2/2000)", [0, 1e-3]),
    ],
)
def test_equilibria_between_steep_tails(text, real):
    assert sorted(e.state[0] for e in potential(text)) == pytest.approx(real, abs=1e-9)


def plane(energy, **integrals):
    """A particle in the plane."""
    return lp.System(lp.canonical(names=("x", "y"), momenta=("px", "py")), energy, integrals=integrals)


TURNING = "x*py - y*px"


def circles(radial, momentum, n_starts=20):
    """Relative equilibria of a particle in the plane in a central force, with their radii."""
    system = plane(f"px^2/2 + py^2/2 + {radial.replace('r2', '(x^2 + y^2)')}")
    found = lp.equilibria(system, {}, along=(TURNING,), values={TURNING: momentum}, n_starts=n_starts)
    return list(found), [float(np.hypot(*e.state[:2])) for e in found]


MEETING = "3*r2/2 - r2^2/2"
"""L^2/(2 r^2) + 3 r^2/2 - r^4/2 is critical where 3 r^4 - 2 r^6 = L^2; for L = 1 this has the double root r = 1."""


def test_where_two_circles_meet_nothing_is_decided():
    (found,), (r,) = circles(MEETING, 1)
    assert r == pytest.approx(1, abs=1e-6)
    assert (found.family, found.linear_stability, found.nonlinear_stability) == ("undecided",) * 3
    assert found.distance < 1e-5


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("radial", "momentum", "radii", "n_starts"),
    [
        # L^2 = r^3 V'(r) = (r + r^2) exp(-r) for the potential of Yukawa
        ("-exp(-sqrt(r2))/sqrt(r2)", 0.9, [1.272123767, 2.014651463], 60),
        ("-exp(-sqrt(r2))/sqrt(r2)", 1.0, [], 20),  # the largest value of (r + r^2) exp(-r) is 0.8399
        ("-1/sqrt(r2)", 0.8, [0.64], 20),  # r = L^2
    ],
)
def test_circles_in_a_central_force(radial, momentum, radii, n_starts):
    found = decided(circles(radial, momentum, n_starts)[0])
    assert [float(np.hypot(*e.state[:2])) for e in found] == pytest.approx(radii, abs=1e-9)
    assert [e.family for e in found] == ["circle"] * len(radii)
    assert [e.linear_stability for e in found] == ["stable spectrum", "unstable"][: len(radii)]


@pytest.mark.parametrize("seed", [0])
def test_a_circle_without_a_known_symmetry_is_undecided(seed):
    """V = (r^2 - 1)^2 exp(x) is zero with its slope on r = 1; else y = 0 and 4 x + x^2 - 1 = 0, x = -2 +- sqrt(5)."""
    system = plane("px^2/2 + py^2/2 + (x^2 + y^2 - 1)^2*exp(x)")
    found = lp.equilibria(system, {}, seed=seed, n_starts=40, most_starts=40)
    assert found.n_undecided >= 1
    assert all(abs(np.hypot(*e.state[:2]) - 1) < 1e-6 for e in found if e.family == "undecided")
    points = decided(found)
    assert sorted(e.state[0] for e in points) == pytest.approx([-2 - 5**0.5, -2 + 5**0.5], abs=1e-9)
    assert [e.family for e in points] == ["point", "point"]


def test_a_circle_is_decided_where_its_symmetry_is_known():
    """V = cosh(r^2 - 1) is lowest on r = 1, highest at 0."""
    system = plane("px^2/2 + py^2/2 + cosh(x^2 + y^2 - 1)", L=TURNING)
    circle, middle = lp.equilibria(system, {}, n_starts=20)
    assert (circle.family, circle.signature, circle.linear_stability) == ("circle", (3, 0, 1), "degenerate")
    assert (middle.family, middle.signature) == ("point", (2, 2, 0))
    assert np.hypot(*circle.state[:2]) == pytest.approx(1, abs=1e-12)
    alone = lp.phase_space.equilibrium(system, circle.state)
    assert (alone.signature, alone.linear_stability) == ((3, 0, 1), "degenerate")


@pytest.mark.thorough
def test_while_the_check_fails_more_starts_are_taken():
    system = lp.catalog.system("manakov-so4")
    leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
    few = lp.equilibria(system, leaf, n_starts=3, most_starts=3)
    assert few.n_starts == 3
    assert few.euler_found != 4
    assert "some are missing or false" in few.completeness
    more = lp.equilibria(system, leaf, n_starts=3, most_starts=400)
    assert more.n_starts > 3
    assert more.euler_found == more.euler_characteristic == 4
    assert not more.proved


@pytest.mark.parametrize("n_starts", [20, 50])
def test_components_that_vanish_are_zero_and_the_verdict_does_not_depend_on_the_starts(n_starts):
    # the other four components are zero: what is left of them, 1e-323, would make an exact equilibrium an undecided one
    waves = lp.catalog.system("three-wave")
    leaf = lp.Leaf.through(waves, lp.sample_states(waves, 1, seed=3)[0])
    (one,) = lp.equilibria(waves, leaf, n_starts=n_starts)
    assert np.count_nonzero(one.state) == 2
    assert (one.family, one.signature, one.nullity) == ("degenerate", (2, 2, 2), 2)
    kirchhoff = lp.catalog.system("kirchhoff")
    found = lp.equilibria(kirchhoff, {"C1": -0.6, "C2": 1.0}, n_starts=n_starts)
    assert all(component == 0 or abs(component) > 1e-300 for e in found for component in e.state)


@pytest.mark.parametrize("name", ["clebsch", "kirchhoff"])
def test_components_below_round_off_are_zero(name):
    """Newton's method converges to zero through ever smaller numbers, and ends at some 1e-323."""
    system = lp.catalog.system(name)
    found = lp.equilibria(system, lp.phase_space.find_start(system).leaf)
    sizes = np.abs([one.state for one in found])
    assert (sizes == 0).sum() > 4
    assert sizes[sizes > 0].min() > np.finfo(float).eps


def test_equilibria_are_counted_on_the_torus_of_angles():
    """Each of two pendulums in a chain hangs or stands, and whole turns make no other state."""
    names = ["a", "b"]
    energy = "(p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - b)^2)) - 2*cos(a) - cos(b)"
    double = lp.System(lp.canonical(names=names, angles=names), energy)
    found = lp.equilibria(double, lp.Leaf(double, {}))
    np.testing.assert_allclose([one.energy for one in found], [-3, -1, 1, 3], atol=1e-12)
    places = np.array([one.state[:2] for one in found]) / np.pi
    np.testing.assert_allclose(places, [[0, 0], [0, 1], [1, 0], [1, 1]], atol=1e-9)


def test_nothing_rests_where_the_hamiltonian_depends_on_time():
    driven = lp.System(lp.canonical(1), "dot(p, p)/2 + q1^2/2 - q1*cos(2*t)", period="pi")
    with pytest.raises(lp.errors.ParameterError, match="wanted one that may rest"):
        lp.equilibria(driven, lp.Leaf(driven, {}))
