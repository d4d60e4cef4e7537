"""The search for equilibria where no algebra gives them all: families, edges of leaves, units, the check."""

import numpy as np
import pytest
import sympy

import liepoisson as lp
from liepoisson.equilibrium import critical_points as newton
from liepoisson.equilibrium.equilibrium_list import Equilibria, signed_sum
from liepoisson.equilibrium.equilibrium_search import EquilibriumSearch


def searched(system, leaf, n_starts, seed=0):
    search = EquilibriumSearch(leaf, {}, np.zeros(0), seed)
    search.extend(n_starts)
    return search.found


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
@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("momentum", [0.3, 0.0])
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


@pytest.mark.thorough
def test_relative_equilibria_are_listed_once_for_each_turn():
    """The motion along l3 carries each relative equilibrium round a circle."""
    top = lp.Top.twisted_lagrange()
    x = np.random.default_rng(5).normal(size=9)
    found = lp.equilibria(top, lp.Leaf.through(top, x), along=("l3",), values={"l3": x[2]}, n_starts=10)
    assert [e.family for e in found] == ["circle"] * len(found)
    energies = [e.energy for e in found]
    assert np.diff(energies).min() > 1e-6
    assert sum(e.n_found for e in found) > 2 * len(found)


def quadratic(scale, unit):
    """A rigid body with a rotor on so(4), H and all states in other units."""
    bracket = lp.so(4) @ lp.trivial()
    names = bracket.coordinate_names_in_order
    square = " + ".join(f"{(k + 1) * scale / unit**2!r}*{x}^2" for k, x in enumerate(names))
    return lp.System(bracket, f"{square} + {scale / unit!r}*{names[0]} + {0.3 * scale / unit!r}*{names[4]}")


UNITS = [
    (1e5, 1e-5),
    (1.0, 1e5),
    *(pytest.param(*units, marks=pytest.mark.slow) for units in ((1e5, 1.0), (1e-5, 1.0), (1.0, 1e-5))),
]


@pytest.mark.thorough
@pytest.mark.parametrize(("scale", "unit"), UNITS)
def test_units_change_nothing(scale, unit):
    x = np.array([0.3, -0.7, 0.2, 0.5, 0.9, -0.4])
    system, other = quadratic(1.0, 1.0), quadratic(scale, unit)
    first = lp.equilibria(system, lp.Leaf.through(system, x), n_starts=60)
    second = lp.equilibria(other, lp.Leaf.through(other, unit * x), n_starts=60)
    assert first.euler_found == second.euler_found == 4
    assert len(first) == len(second)
    assert [e.signature for e in first] == [e.signature for e in second]
    np.testing.assert_allclose([e.energy / scale for e in second], [e.energy for e in first], rtol=1e-9)


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


def test_result_is_a_sequence_and_prints_a_sentence_and_a_table():
    top = lp.Top.twisted_kovalevskaya()
    found = lp.equilibria(top, {"C1": 1, "C2": 0.2, "C3": 1})
    assert isinstance(found, Equilibria)
    assert len(found) == 6
    assert found[0] is next(iter(found))
    assert found[-1].energy == max(e.energy for e in found)
    assert [e.energy for e in found[1:3]] == [found[1].energy, found[2].energy]
    lines = repr(found).splitlines()
    assert lines[0] == (
        "6 equilibria of 'twisted Kovalevskaya top' on a leaf of dimension 6: these are all (proved by algebra)."
    )
    assert len(lines) == 8
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


@pytest.mark.parametrize(
    ("potential", "critical"),
    [("exp(q)", []), ("tanh(q)", []), ("exp(-q^2)", [0]), ("q^3 + exp(-3*q)", None)],
)
def test_flat_at_infinity_is_no_equilibrium(potential, critical):
    """At q = -38 the slope of exp(q) is below round-off, and that of tanh(q) from q = 19 on; neither has a zero."""
    system = lp.System(lp.canonical(names=("q",), momenta=("p",)), f"p^2/2 + {potential}")
    found = decided(searched(system, lp.Leaf.through(system, np.array([0.5, 0.3])), 4))
    if critical is None:  # 3 q^2 = 3 exp(-3 q)
        assert found
        for equilibrium in found:
            q = equilibrium.state[0]
            assert q**2 == pytest.approx(np.exp(-3 * q), rel=1e-9)
    else:
        assert [e.state[0] for e in found] == pytest.approx(critical, abs=1e-12)


def test_a_lattice_of_toda_on_a_line_has_none():
    """Its first particle never stops accelerating: nothing pulls it back."""
    line = lp.catalog.toda(3, closed=False)
    assert decided(searched(line, lp.Leaf.through(line, np.zeros(6)), 3)) == []


def test_a_lattice_of_toda_on_a_ring_rests_at_equal_distances():
    ring = lp.catalog.toda(3)
    (rest,) = searched(ring, lp.Leaf.through(ring, np.zeros(6)), 4)
    assert rest.family == "family of dimension 1"
    assert rest.energy == pytest.approx(3, abs=1e-12)


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
        "tanh(q + q^3)", "tanh(sinh(q))", "exp(-exp(q))", "exp(-exp(-q))", "1/(1 + exp(exp(-q)))", "q/sqrt(1 + q^2)",
        "exp(q)/1000000000", "exp(-1/q^2)",
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
        ("p^2/2 + 1/(1 + exp(q^3 - 3*q))", [-1, 1]),
        ("p^2/2 + exp(q) - q/1000000", [np.log(1e-6)]),
        ("p^2/2 + exp(q^3/3 - q^2/2000)", [0, 1e-3]),
    ],
)
def test_equilibria_between_steep_tails(text, real):
    assert sorted(e.state[0] for e in potential(text)) == pytest.approx(real, abs=1e-9)


def random_potential(rng):
    """A function of q with tails, the critical points that it has by theory, and the simple ones that doubles show."""
    q = sympy.Symbol("q")
    zeros = [sympy.Rational(int(z), 8) for z in rng.choice(np.arange(-9, 10), rng.integers(0, 3), replace=False)]
    orders = [int(rng.integers(1, 3)) for _ in zeros]
    product = sympy.prod([(q - zero) ** order for zero, order in zip(zeros, orders, strict=True)])
    if rng.integers(2):
        inner = sympy.integrate(sympy.expand(product), q)
        function = rng.choice([sympy.tanh(inner), 1 / (1 + sympy.exp(-2 * inner)), sympy.atan(sympy.sinh(inner))])
        simple = [zero for zero, order in zip(zeros, orders, strict=True) if order == 1]
        return function, zeros, [zero for zero in simple if abs(inner.subs(q, zero)) < 4]
    k = int(rng.choice([2, 4, 6]))
    slope = sympy.Poly(sympy.expand(sympy.diff(product, q) - k * q ** (k - 1) * product), q)
    roots = [(float(root.evalf(20)), order) for root, order in slope.real_roots(multiple=False)]
    return product * sympy.exp(-(q**k)), [x for x, _ in roots], [x for x, n in roots if n == 1 and x**k < 8]


@pytest.mark.parametrize("seed", [*range(8), *(pytest.param(k, marks=pytest.mark.slow) for k in range(8, 40))])
def test_random_functions_with_tails_have_the_equilibria_that_they_have(seed):
    function, real, simple = random_potential(np.random.default_rng(seed))
    found = [e.state[0] for e in potential(f"p^2/2 + {function}".replace("**", "^"), map(float, simple))]
    assert all(min(abs(x - float(zero)) for zero in real) < 1e-9 for x in found), function
    assert all(min(abs(x - float(zero)) for x in found) < 1e-9 for zero in simple), function
    assert len(found) <= len(set(real))


def plane(energy, **integrals):
    """A particle in the plane."""
    return lp.System(lp.canonical(names=("x", "y"), momenta=("px", "py")), energy, integrals=integrals)


TURNING = "x*py - y*px"


@pytest.mark.parametrize("tail", ["exp(-y)", "tanh(y + y^3)", "exp(-exp(y))"])
def test_a_tail_on_a_curved_valley_has_no_equilibrium(tail):
    system = plane(f"px^2/2 + py^2/2 + (x + y^3 - exp(y/4))^2/2 + {tail}")
    assert decided(searched(system, lp.Leaf.through(system, np.full(4, 0.5)), 20)) == []


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


@pytest.mark.parametrize("momentum", [0.9999, 0.999999, 1 - 1e-9])
def test_two_circles_that_nearly_meet_are_two(momentum):
    """They are real roots u = r^2 of 2 u^3 - 3 u^2 + L^2 = 0, 2 sqrt((1 - L^2)/12) apart to first order."""
    (inner, outer), radii = circles(MEETING, momentum)
    gap = np.sqrt((1 - momentum**2) / 3)
    assert radii[1] - radii[0] == pytest.approx(gap, rel=max(1e-2 * gap, 1e-6))
    assert inner.energy < outer.energy
    assert [e.family for e in (inner, outer)] == ["circle", "circle"]
    assert (inner.linear_stability, inner.signature) == ("stable spectrum", (2, 0, 0))
    assert (outer.linear_stability, outer.signature) == ("unstable", (1, 1, 0))
    assert inner.n_found + outer.n_found >= 10


def test_circles_that_have_met_and_vanished_are_none():
    assert circles(MEETING, 1.0001)[0] == []


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("radial", "momentum", "radii", "n_starts"),
    [
        # L^2 = r^3 V'(r) = (r + r^2) exp(-r) for the potential of Yukawa
        ("-exp(-sqrt(r2))/sqrt(r2)", 0.9, [1.272123767, 2.014651463], 60),
        ("-exp(-sqrt(r2))/sqrt(r2)", 1.0, [], 20),  # the largest value of (r + r^2) exp(-r) is 0.8399
        ("-1/sqrt(r2)", 0.8, [0.64], 20),  # r = L^2
        ("-1/r2", 0.8, [], 20),  # L^2 = 2 is wanted
        ("-exp(-r2)", 2.0, [], 20),  # L^2 = 2 r^4 exp(-r^2) is at most 8 exp(-2) = 1.08
    ],
)
def test_circles_in_a_central_force(radial, momentum, radii, n_starts):
    found = decided(circles(radial, momentum, n_starts)[0])
    assert [float(np.hypot(*e.state[:2])) for e in found] == pytest.approx(radii, abs=1e-9)
    assert [e.family for e in found] == ["circle"] * len(radii)
    assert [e.linear_stability for e in found] == ["stable spectrum", "unstable"][: len(radii)]


SPACE = lp.canonical(names=("x", "y", "z"), momenta=("px", "py", "pz"))
MOMENTA = {"Lx": "y*pz - z*py", "Ly": "z*px - x*pz", "Lz": "x*py - y*px"}


@pytest.mark.parametrize("values", [{"Lz": 0.9}, {"Lx": 0.0, "Ly": 0.54, "Lz": 0.72}])
def test_circles_in_space(values):
    """With one component of the angular momentum and with all three, which do not commute: 3 r^4 - 2 r^6 = 0.81."""
    square = "(x^2 + y^2 + z^2)"
    system = lp.System(SPACE, f"(px^2 + py^2 + pz^2)/2 + 3/2*{square} - {square}^2/2", integrals=MOMENTA)
    found = lp.equilibria(system, {}, along=tuple(values), values=values, n_starts=12, most_starts=12)
    radii = [np.linalg.norm(e.state[:3]) for e in found if e.family == "circle"]
    real = np.sqrt([u.real for u in np.roots([-2, 3, 0, -0.81]) if u.real > 0])
    assert radii
    assert all(np.abs(real - r).min() < 1e-9 for r in radii)


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2, 3))])
def test_a_circle_without_a_known_symmetry_is_undecided(seed):
    """V = (r^2 - 1)^2 exp(x) is zero with its slope on r = 1; else y = 0 and 4 x + x^2 - 1 = 0, x = -2 +- sqrt(5)."""
    system = plane("px^2/2 + py^2/2 + (x^2 + y^2 - 1)^2*exp(x)")
    n_starts = 40 if seed == 0 else 200
    found = lp.equilibria(system, {}, seed=seed, n_starts=n_starts, most_starts=n_starts)
    assert found.n_undecided >= 1
    assert f"{found.n_undecided} of them undecided" in found.completeness
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


def test_a_sphere_is_a_family_of_dimension_two_where_its_symmetries_are_known():
    square = "(x^2 + y^2 + z^2)"
    system = lp.System(SPACE, f"(px^2 + py^2 + pz^2)/2 + cosh({square} - 1)", integrals=MOMENTA)
    sphere, middle = lp.equilibria(system, {}, n_starts=20, most_starts=20)
    assert (sphere.family, sphere.signature, middle.family) == ("family of dimension 2", (4, 0, 2), "point")


def test_two_circles_of_one_energy_that_are_close_stay_two():
    """V = sin(pi (r^2 - 1)/0.21)^2 is lowest on r = 1 and r = 1.1, among others, and highest between them."""
    system = plane("px^2/2 + py^2/2 + sin(14.95996501709425*(x^2 + y^2 - 1))^2", L=TURNING)
    search = EquilibriumSearch(lp.Leaf.through(system, np.full(4, 0.5)), {}, np.zeros(0), 0)
    turns = np.linspace(0, 6, 8)
    search.add_from(np.array([[r * np.cos(t), r * np.sin(t), 0, 0] for r in (1.005, 1.095) for t in turns]))
    assert [e.family for e in search.found] == ["circle", "circle"]
    assert sorted(np.hypot(*e.state[:2]) for e in search.found) == pytest.approx([1, 1.1], abs=1e-9)
    assert [e.n_found for e in search.found] == [8, 8]


def leaning_tops(l3):
    """Relative equilibria of Lagrange's top with the momentum of the upright one, and how far they lean.

    With u = tan(theta/2) and l3 = 2 the effective energy is 5 + 2 u^4/(1 + u^2); in general it is critical at u = 0 and
    where alpha_3 = l3 - 1, since Omega = 1 + l3, l = alpha on the perpendicular plane.
    """
    lagrange = lp.catalog.system("lagrange")
    found = lp.equilibria(lagrange, {"C1": l3, "C2": 1}, along=("l3",), values={"l3": l3}, n_starts=60, most_starts=60)
    return list(found), sorted(float(np.hypot(*e.state[3:5])) for e in found)


def test_at_the_limit_of_its_stability_nothing_is_decided_beside_the_sleeping_top():
    """The slope of the effective energy is 8 u^3: in doubles it vanishes up to the tilt of 1e-5."""
    found, tilts = leaning_tops(2)
    assert max(tilts) < 1e-3
    assert {e.family for e in found} == {"point", "undecided"}
    assert all(e.linear_stability == "undecided" for e in found)


@pytest.mark.parametrize("below", [1e-2, 1e-5])
def test_below_the_limit_a_small_circle_of_leaning_tops_exists_and_above_it_none(below):
    leaning, tilts = leaning_tops(2 - below)
    assert tilts == pytest.approx([0, np.sqrt(2 * below - below**2)], rel=1e-4, abs=1e-9)
    verdicts = {e.family: (e.linear_stability, e.nonlinear_stability) for e in leaning}
    assert verdicts["circle"] == ("stable spectrum", "stable")
    found, tilts = leaning_tops(2 + below)
    assert tilts[0] == pytest.approx(0, abs=1e-9)
    upright, *others = sorted(found, key=lambda e: e.family)
    assert (upright.family, upright.linear_stability) == ("point", "stable spectrum")
    assert all(e.family == "undecided" for e in others)


def test_an_equilibrium_at_which_the_slope_of_the_integral_vanishes_is_found():
    """V = cosh(2 r^2) + r^2 is lowest at r = 0, where L and its slope are zero; L = 0 has no other solution."""
    (found,), (r,) = circles("cosh(2*r2) + r2", 0)
    assert r == pytest.approx(0, abs=1e-9)
    assert (found.family, found.signature, found.linear_stability) == ("point", (4, 0, 0), "stable spectrum")


def test_a_tail_on_which_the_integral_is_zero_has_no_equilibrium():
    """V = exp(-r^2) is highest at r = 0, a simple equilibrium, and has a tail beyond."""
    (found,) = decided(circles("exp(-r2)", 0)[0])
    assert np.hypot(*found.state[:2]) == pytest.approx(0, abs=1e-9)
    assert found.linear_stability == "unstable"
