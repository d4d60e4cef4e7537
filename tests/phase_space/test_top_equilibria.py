"""All equilibria of tops: the proof against independent algebra, the search, and the sum of the signs."""

import pickle
import warnings

import numpy as np
import pytest
from flint import fmpq

import liepoisson as lp
from liepoisson.equilibrium.equilibrium_search import EquilibriumSearch
from liepoisson.equilibrium.heavy_equilibria import exact_top

TEN = {"inertia": (1.81, 0.99, 1.23), "a": (0.91, 0.02, -0.62), "b": (-0.63, -0.99, 0.05), "epsilon": 0.5}


def searched(system, leaf, n_starts, seed=0):
    search = EquilibriumSearch(leaf, {}, np.zeros(0), seed)
    search.extend(n_starts)
    return search.found


def assert_contains(all_of_them, some, tol=1e-6):
    """Every equilibrium in `some` is in the list, or in a family of it; what is undecided claims nothing."""
    for e in (e for e in some if e.family != "undecided"):
        if e.nullity:
            size = 1 + abs(e.energy)
            assert any(o.family != "point" and abs(o.energy - e.energy) < tol * size for o in all_of_them), e
        else:
            size = np.linalg.norm(e.state)
            assert min(np.linalg.norm(o.state - e.state) for o in all_of_them) < tol * size, e


def random_vector(rng):
    kind = rng.integers(5)
    v = np.round(rng.normal(size=3), 2)
    if kind == 0:
        v[:] = 0
    elif kind == 1:
        v = rng.integers(-1, 2, 3).astype(float)
    elif kind == 2:
        v[rng.permutation(3)[:2]] = 0
    elif kind == 3:
        v[rng.integers(3)] = 0
    return tuple(v.tolist())


def random_top(rng):
    """Also with equal moments, vanishing components and parallel vectors."""
    inertia = rng.integers(1, 4, 3) if rng.random() < 0.5 else np.round(rng.uniform(0.5, 2, 3), 2)
    a, b = random_vector(rng), random_vector(rng)
    if rng.random() < 0.2:
        b = tuple(2 * x for x in a)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lp.errors.InertiaWarning)
        return lp.Top(inertia=inertia.tolist(), a=a, b=b, epsilon=float(rng.choice([0, 1, -0.7, 0.35])))


def random_leaf(rng, top):
    """Of any rank above zero, also with C2 = 0."""
    x = rng.normal(size=9) * np.exp(0.5 * rng.normal())
    kind = rng.integers(6)
    if kind == 1:
        x[6:] = 0
    elif kind == 2:
        x[3:] = 0
    elif kind == 3:
        x[6:] = 2 * x[3:6]
    leaf = lp.Leaf.through(top, x)
    if kind == 4 and leaf.is_regular:
        values = leaf.casimirs | {"C2": 0.0}
        return lp.Leaf(top, values)
    return leaf


def random_small_top(rng, n_fields, *, signs=(1,)):
    """The same without beta, or without alpha and beta, typed by hand; moments of these signs."""
    inertia = rng.integers(1, 4, 3) if rng.random() < 0.5 else np.round(rng.uniform(0.5, 2, 3), 2)
    inverse, a = (
        [f"1/({s * x})" for s, x in zip(rng.choice(signs, 3), inertia.tolist(), strict=True)],
        random_vector(rng),
    )
    terms = [f"{inverse[k]}*l{k + 1}^2/2" for k in range(3)]
    if n_fields == 2:
        terms += [f"({a[k]})*alpha{k + 1}" for k in range(3)]
    return lp.System(lp.so(3) @ lp.semidirect(n_fields), " + ".join(terms))


def random_small_leaf(rng, top):
    """Of rank four or two, also with l.alpha = 0."""
    x = rng.normal(size=top.bracket.dimension) * np.exp(0.5 * rng.normal())
    kind = rng.integers(4)
    if kind == 1:
        x[3:] = 0
    leaf = lp.Leaf.through(top, x)
    return lp.Leaf(top, leaf.casimirs | {"C1": 0.0}) if kind == 2 and leaf.rank == 4 else leaf


def check(top, leaf, n_starts):
    found = lp.equilibria(top, leaf)
    assert found.proved, (top.hamiltonian, leaf.casimirs)
    assert found.n_starts == 0
    for e in found:
        assert leaf.contains(e.state, 1e-11)
        assert e.residual < 1e-12
    if found.euler_characteristic is not None and all(e.family != "degenerate" for e in found):
        assert found.euler_found == found.euler_characteristic, (top.hamiltonian, leaf.casimirs)
    if n_starts:
        assert_contains(found, searched(top, leaf, n_starts))
    return found


@pytest.mark.thorough
def test_a_leaf_with_ten_equilibria_of_which_few_starts_find_some():
    top = lp.Top(**TEN)
    leaf = lp.Leaf.through(top, [-5.2, -7.4, -0.9, -5.1, 1.1, 0.6, -0.7, -10.1, -2.2])
    found = check(top, leaf, 30)
    assert len(found) == 10
    assert "these are all" in found.completeness


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(k, marks=pytest.mark.slow) for k in (2, 3))])
def test_other_leaves_of_the_same_top(seed):
    top = lp.Top(**TEN)
    check(top, lp.Leaf.through(top, np.random.default_rng(seed).normal(size=9) * np.repeat([3, 1, 1], 3)), 30)


def parallel_top_on_its_exceptional_leaf(rng):
    """b = rho a, C2 = -rho C3 and C1 C3 = C2^2: one equation of the regular branch does not contain tau there."""
    often_equal = rng.random() < 0.3
    inertia = rng.choice([1, 1.25, 2], 3) if often_equal else np.round(rng.uniform(0.5, 2, 3) * 8) / 8
    a = np.round(rng.normal(size=3) * 4) / 4 * (rng.random(3) < 0.8)
    a = a if a.any() else np.array([0, 0, 1.0])
    rho, c3 = float(rng.integers(-4, 5)) / 2, float(rng.integers(1, 7)) / 2
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lp.errors.InertiaWarning)
        top = lp.Top(inertia=inertia.tolist(), a=a.tolist(), b=(rho * a).tolist(), epsilon=float(rng.choice([1, -0.5])))
    return top, lp.Leaf(top, {"C1": rho**2 * c3, "C2": -rho * c3, "C3": c3})


def test_leaf_on_which_one_equation_fixes_sigma_alone():
    r"""On C = (0, 0, 1) with b = 0 the equation E1 E2^-1 does not contain tau: six equilibria, two of them at rest.

    At rest beta = +-a/|a|, l = alpha = 0, H = 0; the others come in pairs x, -l, alpha, -beta of equal energy.
    """
    top = lp.Top(inertia=(2, 1.5, 1), a=(-1, 0.5, 0.3), epsilon=1)
    found = check(top, lp.Leaf(top, {"C1": 0, "C2": 0, "C3": 1}), 20)
    assert [round(e.energy, 6) for e in found] == [-1.348981, -1.348981, -1.179406, -1.179406, 0, 0]
    assert found.euler_found == 2


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(k, marks=pytest.mark.slow) for k in range(3, 8))])
def test_exceptional_leaves_of_tops_with_parallel_vectors(seed):
    check(*parallel_top_on_its_exceptional_leaf(np.random.default_rng(seed)), 30)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 160))
def test_many_exceptional_leaves(seed):
    check(*parallel_top_on_its_exceptional_leaf(np.random.default_rng(seed)), 60)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [0, 2, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, *range(3, 12)))])
def test_signs_of_all_equilibria_sum_to_the_euler_characteristic_and_the_search_finds_no_other(seed):
    rng = np.random.default_rng(seed)
    top = random_top(rng)
    check(top, random_leaf(rng, top), 20)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 400))
def test_many_random_tops(seed):
    rng = np.random.default_rng(seed)
    top = random_top(rng)
    check(top, random_leaf(rng, top), 60)


@pytest.mark.thorough
@pytest.mark.parametrize("n_fields", [1, 2])
@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(k, marks=pytest.mark.slow) for k in range(3, 12))])
def test_heavy_tops_of_six_components_and_rigid_bodies_of_three(seed, n_fields):
    rng = np.random.default_rng(seed)
    top = random_small_top(rng, n_fields)
    found = check(top, random_small_leaf(rng, top), 20)
    assert found.euler_characteristic == 2


@pytest.mark.slow
@pytest.mark.parametrize("signs", [(1,), (1, -1)])
@pytest.mark.parametrize("seed", range(100, 300))
def test_many_random_heavy_tops(seed, signs):
    rng = np.random.default_rng(seed)
    top = random_small_top(rng, 2, signs=signs)
    check(top, random_small_leaf(rng, top), 60)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [*range(2), *(pytest.param(k, marks=pytest.mark.slow) for k in range(2, 8))])
def test_moments_of_any_sign_typed_by_hand(seed):
    """Where l.alpha = 0 a heavy top with an indefinite kinetic energy has more equilibria than the two at rest."""
    rng = np.random.default_rng(seed)
    top = random_small_top(rng, 2, signs=(1, -1))
    check(top, lp.Leaf(top, {"C1": 0.0, "C2": 1.7}), 30)


@pytest.mark.thorough
def test_states_of_an_indefinite_top_that_turn_about_the_vertical_without_momentum_along_it():
    for extension, rest in ((lp.semidirect(2), []), (lp.leibniz(3), [0, 0, 0])):
        top = lp.System(lp.so(3) @ extension, "l1^2 + l2^2/4 - l3^2/2 + alpha1 + alpha3")
        found = check(top, lp.Leaf.through(top, [1, 0, 0, 0, 1, 0, *rest]), 60)
        assert len(found) == 6
        assert found.euler_characteristic is None
        turning = [e.state for e in found if np.linalg.norm(e.state[:3]) > 0.1]
        assert len(turning) == 4
        for x in turning:
            l, alpha = x[:3], x[3:6]
            assert abs(l @ alpha) < 1e-12
            assert np.linalg.norm(np.cross(l * [2, 0.5, -1], alpha)) < 1e-12


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["heavy-top", "lagrange", "kovalevskaya", "goryachev-chaplygin", "spherical-pendulum"])
def test_heavy_tops_of_the_catalogue_on_all_leaves(name):
    system = lp.catalog.system(name)
    top = lp.Top.heavy(*(list(map(str, v)) for v in (exact_top(system).inertia, exact_top(system).a)))
    for x in ([0.4, 1.1, -0.3, 0.2, 0.9, -0.5], [0.4, 1.1, -0.3, 0, 0, 0], [-6, 3, 2, 0.25, 0.5, -1]):
        found = check(system, lp.Leaf.through(system, x), 20)
        nine = lp.equilibria(top, lp.Leaf.through(top, [*x, 0, 0, 0]))
        np.testing.assert_allclose([e.energy for e in found], [e.energy for e in nine], rtol=1e-10)
        assert [e.family for e in found] == [e.family for e in nine]
    at_rest = check(system, lp.Leaf(system, {"C1": 0, "C2": 4}), 0)
    assert [e.energy for e in at_rest] == pytest.approx([-2, 2], rel=1e-14)


def test_precessions_of_a_lagrange_top_are_a_circle_and_upright_ones_are_points():
    """n3 = (a3/(I3 - I1))/lambda^2 and lambda(I1 + (I3 - I1) n3^2) = l.alpha on |alpha| = 1, I = (1, 1, 1/2)."""
    system = lp.catalog.system("lagrange")
    found = lp.equilibria(system, {"C1": 3, "C2": 1})
    circles, points = ([e for e in found if (e.family == "circle") is given] for given in (True, False))
    assert found.proved
    np.testing.assert_allclose([e.state for e in points], [[0, 0, 3 * s, 0, 0, s] for s in (-1, 1)], atol=1e-14)
    assert len(circles) == 1
    l, n = circles[0].state.reshape(2, 3)
    speed = l[0] / n[0] if n[0] else l[1] / n[1]
    assert n[2] == pytest.approx(-2 / speed**2, rel=1e-13)
    assert speed * (1 - n[2] ** 2 / 2) == pytest.approx(3, rel=1e-13)


@pytest.mark.parametrize("unit", [1e-6, 1e-2, 1e3, 1e6])
def test_units_change_nothing_for_a_heavy_top(unit):
    x = np.array([0.9, -0.6, 2.5, 0.7, 0.2, -0.8])
    system = lp.catalog.system("heavy-top")
    found, other = (lp.equilibria(system, lp.Leaf.through(system, x * np.repeat([s, s**2], 3))) for s in (1.0, unit))
    assert sorted(e.signature for e in found) == sorted(e.signature for e in other)
    scale = np.repeat([unit, unit**2], 3)
    np.testing.assert_allclose([e.state for e in other] / scale, [e.state for e in found], rtol=1e-12, atol=1e-13)


def test_a_heavy_top_depends_on_the_leaf_and_not_on_the_state_it_was_made_from():
    system = lp.catalog.system("heavy-top")
    leaf = lp.Leaf.through(system, [0.4, 1.1, -0.3, 0.2, 0.9, -0.5])
    lists = [lp.equilibria(system, given) for given in (leaf, leaf.casimirs)]
    np.testing.assert_array_equal([e.state for e in lists[0]], [e.state for e in lists[1]])


@pytest.mark.thorough
def test_angular_velocities_are_roots_of_the_polynomial_of_a_groebner_basis():
    """Equations with all gamma_j as unknowns, which includes singular matrices, reduced by SymPy alone to kappa."""
    from sympy import QQ, Poly, groebner, real_roots, symbols

    inertia, a, b, epsilon, (c1, c2, c3) = (1, 2, 3), (1, 0, 0), (0, 1, 0), 1, (2, 0, 1)
    k, s, t, inverse, *g = symbols("k s t inverse g1:4")
    equations = [g[j] * (inertia[j] + s) - (b[j] - t * a[j]) for j in range(3)]
    equations += [
        2 * epsilon * sum(inertia[j] * g[j] ** 2 for j in range(3))
        + epsilon**2 * sum(x * x for x in a) * k
        - (c1 + 2 * c2 * t + c3 * t**2) * k**3,
        epsilon * sum(a[j] * g[j] for j in range(3)) - (c2 + c3 * t) * k**3,
        sum(x**2 for x in g) - c3 * k**4,
        inverse * k - 1,
    ]
    basis = groebner(equations, inverse, *g, s, t, k, order="grevlex", domain=QQ)
    roots = [float(root) for root in real_roots(Poly(basis.fglm("lex").exprs[-1], k))]
    found = lp.equilibria(lp.Top(inertia=inertia, a=a, b=b, epsilon=epsilon), {"C1": c1, "C2": c2, "C3": c3})
    assert found.proved
    kappas = [float(e.state[:3] / inertia @ e.state[6:]) / c3 for e in found]
    assert kappas
    for kappa in kappas:
        assert min(abs(kappa - root) for root in roots) < 1e-9


def test_free_rigid_body_and_its_equal_moments():
    leaf_state = [0.3, -0.4, 1.2, 0, 0, 0, 0, 0, 0]
    kinds = {
        (1, 1.5, 2): ["point"] * 6,
        (1, 1, 1.5): ["point", "point", "circle"],
        (1, 1, 1): ["sphere"],
    }
    for inertia, expected in kinds.items():
        top = lp.Top.free_rigid_body(inertia)
        found = lp.equilibria(top, lp.Leaf.through(top, leaf_state))
        assert sorted(e.family for e in found) == sorted(expected)
        assert found.proved
        assert found.euler_found == 2


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [
        ((1, 0, 0), (0, 1, 0.3), ["point"] * 4),
        ((1, 0, 0), (2, 0, 0), ["circle"] * 2),
        ((0, 0, 0), (0, 0, 0), ["all rotations"]),
    ],
)
def test_charged_tops_have_four_points_two_circles_or_all_rotations(a, b, expected):
    top = lp.Top.charged_heavy((1, 2, 2.5), a, b)
    found = lp.equilibria(top, lp.Leaf.through(top, [0.1, 0.2, -0.3, 1, 0.2, 0, 0.3, 1.1, 0.4]))
    assert [e.family for e in found] == expected
    assert found.proved
    assert (found.euler_found, found.euler_characteristic) == (0, 0)


def test_equal_singular_values_give_two_points_and_a_circle():
    top = lp.Top.charged_heavy((1, 2, 2.5), (1, 0, 0), (0, 1, 0))
    found = lp.equilibria(top, {"C1": 1, "C2": 0, "C3": 1})
    assert sorted(e.family for e in found) == ["circle", "point", "point"]
    assert found.euler_found == 0


def test_heavy_top_on_the_leaf_beta_zero_of_a_twisted_one_is_that_of_the_heavy_top():
    twisted, heavy = lp.Top(**TEN), lp.Top.heavy(TEN["inertia"], TEN["a"])
    x = np.array([0.4, 1.1, -0.3, 0.2, 0.9, -0.5, 0, 0, 0])
    first, second = (lp.equilibria(top, lp.Leaf.through(top, x)) for top in (twisted, heavy))
    np.testing.assert_allclose([e.energy for e in first], [e.energy for e in second], rtol=1e-12)
    assert first.proved
    assert second.proved


@pytest.mark.thorough
@pytest.mark.parametrize(("b", "expected"), [((0, 0, 0), 6), ((-5, 5, 12), 4)])
def test_collinear_fields_up_to_round_off(b, expected):
    """C1 C3 - C2^2 is 1e-17 instead of 0, and two equilibria are almost at rest: far from each other, yet ill posed."""
    top = lp.Top(inertia=(2.25, 0.5, 2.75), a=(-1.25, 1.25, 3), b=b, epsilon=1)
    found = lp.equilibria(top, lp.Leaf(top, {"C1": 0.3**2 / 0.7, "C2": 0.3, "C3": 0.7}))
    assert (found.proved, len(found), found.euler_found) == (True, expected, 2)


def test_exceptional_leaf_with_a_state_of_rest():
    """beta = t a, alpha = t b + s a, l = 0 is an equilibrium; it exists on leaves with one more relation."""
    a, b, t, s = np.array([1.0, 2.0, 0.0]), np.array([0.5, 0.0, 1.0]), 0.5, -0.25
    top = lp.Top(inertia=(1, 2, 2.5), a=a.tolist(), b=b.tolist(), epsilon=1)
    x = np.concatenate([np.zeros(3), t * b + s * a, t * a])
    found = lp.equilibria(top, lp.Leaf.through(top, x))
    assert found.proved
    assert min(np.linalg.norm(e.state - x) for e in found) < 1e-12
    assert found.euler_found == 2


def test_mirrored_equilibria_out_of_the_plane_with_zero_middle_component():
    """C2 = 0, b = 0: the factor A of the equations of the regular branch, and every tau with D = 0."""
    top = lp.Top.twisted_kovalevskaya()
    found = lp.equilibria(top, {"C1": 1, "C2": 0, "C3": 1})
    assert len(found) == 6
    assert found.euler_found == 2
    energies = [e.energy for e in found]
    np.testing.assert_allclose(energies[::2], energies[1::2], rtol=1e-12)


@pytest.mark.thorough
@pytest.mark.parametrize("unit", [1e-5, 1e5, *(pytest.param(u, marks=pytest.mark.slow) for u in (1e-2, 1e3))])
def test_units_change_nothing(unit):
    """t -> t / u: l scales with u, alpha and a with u^p and u^(2-p), ...; and H with a factor of its own."""
    x = np.array([0.9, -0.6, 0.5, 0.7, 0.2, -0.8, 0.3, 0.9, 0.4])
    top = lp.Top(**TEN)
    scale = np.repeat([unit, unit**2, unit**3], 3)
    found = lp.equilibria(top, lp.Leaf.through(top, x))
    rescaled = lp.Top(inertia=TEN["inertia"], a=TEN["a"], b=[float(v / unit) for v in TEN["b"]], epsilon=0.5)
    other = lp.equilibria(rescaled, lp.Leaf.through(rescaled, x * scale))
    assert (found.proved, other.proved) == (True, True)
    assert len(found) == len(other)
    assert sorted(e.signature for e in found) == sorted(e.signature for e in other)
    np.testing.assert_allclose([e.state for e in other] / scale, [e.state for e in found], rtol=1e-9, atol=1e-11)


def test_irrational_parameters_and_other_brackets_are_not_proved():
    from sympy import sqrt

    top = lp.Top(inertia=(1, 2, sqrt(5)), a=(1, 0, 0), epsilon=1)
    assert exact_top(top) is None
    assert exact_top(lp.Top(**TEN)).epsilon == fmpq(1, 2)
    assert exact_top(lp.catalog.system("kirchhoff")) is None


@pytest.mark.parametrize(
    ("top", "values", "kinds"),
    [
        (((2, 3, 1), (0, 1, 0), (0, 0, 0), 1), (0, 0, 1), ["degenerate"] * 2 + ["point"] * 4),
        (((2, 3, 1), (0, 1, 0), (0, -2, 0), 0.5), (4, 2, 1), ["degenerate"] * 2 + ["point"] * 4),
        (((1, 1, 3), (0, 0, 1), (0, 0, -2), 1), (12, 6, 3), ["circle", "point", "point"]),
        (((2, 1.5, 1), (1, 0, 0), (0, 0, 0), 1), (-4, 0, 1), ["degenerate"] * 2 + ["point"] * 8),
    ],
)
def test_numbers_that_are_exactly_zero_do_not_prevent_the_proof(top, values, kinds):
    """Two solutions of one branch coincide, or the free part of beta is zero, where equilibria just meet."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lp.errors.InertiaWarning)
        top = lp.Top(**dict(zip(("inertia", "a", "b", "epsilon"), top, strict=True)))
    leaf = lp.Leaf(top, dict(zip(("C1", "C2", "C3"), values, strict=True)))
    found = lp.equilibria(top, leaf)
    assert found.proved
    assert sorted(e.family for e in found) == kinds
    assert max(e.residual for e in found) < 1e-12
    assert leaf.contains([e.state for e in found], 1e-11).all()
    assert_contains(found, searched(top, leaf, 5))


def test_pitchfork_in_closed_form():
    r"""On C = (0, 0, 1), I = (2, 3, 1), a = e2: beta = +-e3, l = kappa beta, alpha = a/kappa, kappa^3 = -1/2."""
    top = lp.Top(inertia=(2, 3, 1), a=(0, 1, 0), epsilon=1)
    found = [e for e in lp.equilibria(top, {"C1": 0, "C2": 0, "C3": 1}) if e.nullity]
    kappa = -(0.5 ** (1 / 3))
    for e, sign in zip(sorted(found, key=lambda e: e.state[8]), (-1, 1), strict=True):
        np.testing.assert_allclose(e.state, [0, 0, sign * kappa, 0, 1 / kappa, 0, 0, 0, sign], atol=1e-15)
        assert (e.linear_stability, e.growth_rate, e.signature) == ("degenerate", 0, (4, 1, 1))


@pytest.mark.parametrize("first", [1e-16, 1e-17, 1e-30])
def test_leaf_of_a_state_almost_at_rest(first):
    """The Casimirs miss those of rest by a rounding: kappa is 1e-17 there, and sigma 1e52."""
    top = lp.Top(inertia=(1, 2, 1.5), a=(0, 1, 0), epsilon=1)
    found = check(top, lp.Leaf(top, {"C1": first, "C2": 0, "C3": 1}), 0)
    assert len(found) == 6


def test_leaf_through_a_state_at_rest_in_doubles():
    top = lp.Top(inertia=(1.26, 1.19, 0.7), a=(-2.3, -0.2, -1.2), b=(-0.7, -0.5, -0.3), epsilon=1)
    state = [0, 0, 0, -1.25, -0.46, -0.6, -1.8399999999999999, -0.16, -0.96]  # alpha = 0.8 b + 0.3 a, beta = 0.8 a
    found = check(top, lp.Leaf.through(top, state), 0)
    assert [e.signature for e in found] == [(6, 0, 0), (5, 1, 0), (4, 2, 0), (4, 2, 0)]
    assert min(np.linalg.norm(e.state - state) for e in found) < 1e-14


def test_what_the_algebra_decides_is_found_where_it_cannot_decide_all():
    """The state at -3/2 is degenerate and isolated; one start of a search finds neither it nor the other."""
    top = lp.Top(inertia=(3, 1, 2), a=(-1, 0, 0), b=(2, -1, 0), epsilon=1)
    found = lp.equilibria(top, {"C1": 3, "C2": 2, "C3": 1}, n_starts=1, most_starts=1)
    assert not found.proved
    assert [e.family for e in found] == ["degenerate", "point"]
    np.testing.assert_allclose([e.energy for e in found], [-1.5, 0.5], atol=1e-12)


def test_leaf_of_an_equal_system_is_taken():
    first, second = lp.catalog.system("manakov-so4"), lp.catalog.system("manakov-so4")
    x = lp.sample_states(first, 1, seed=1)[0]
    leaf = lp.Leaf.through(second, x)
    found = lp.equilibria(first, leaf, n_starts=3, most_starts=3)
    assert found.leaf is leaf
    top = lp.Top.twisted_kovalevskaya()
    leaf = pickle.loads(pickle.dumps(lp.Leaf(top, {"C1": 1, "C2": 0.2, "C3": 1})))
    assert lp.equilibria(top, leaf).proved
    other = lp.Top.twisted_kovalevskaya(epsilon=2)
    with pytest.raises(lp.errors.ParameterError, match="leaf must be one of"):
        lp.equilibria(other, leaf)


@pytest.mark.parametrize("k", [1.0, 1e-6, 1e-9, 1e-10, 1e-12, 1e-40])
def test_stability_on_a_leaf_by_its_values_does_not_depend_on_the_unit_of_time(k):
    """H -> k^2 H, l -> k l: a slow top.  What state represents the leaf, and of what size, counts for nothing."""
    inertia, a = [1, 2, 2.5], [0.3, 0.2, 0.5]
    slow = {"I": inertia, "a": [value * k * k for value in a]}
    top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, inv(I)*l)/2 + dot(a, alpha)", slow)
    found = lp.equilibria(top, {"C1": 0.7 * k, "C2": 1})
    assert [e.linear_stability for e in found] == ["stable spectrum", "unstable"]
    assert found[0].signature == (4, 0, 0)
    assert found[1].growth_rate / k == pytest.approx(0.55875, rel=1e-4)
