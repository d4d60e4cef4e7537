"""All equilibria of tops: the proof against independent algebra, the search, and the sum of the signs."""

import warnings

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.equilibrium.equilibrium_search import EquilibriumSearch

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


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(k, marks=pytest.mark.slow) for k in range(100, 140))])
def test_exceptional_leaves_of_tops_with_parallel_vectors(seed):
    check(*parallel_top_on_its_exceptional_leaf(np.random.default_rng(seed)), 30)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [0, 2, *(pytest.param(k, marks=pytest.mark.slow) for k in range(100, 250))])
def test_signs_of_all_equilibria_sum_to_the_euler_characteristic_and_the_search_finds_no_other(seed):
    rng = np.random.default_rng(seed)
    top = random_top(rng)
    check(top, random_leaf(rng, top), 20)


@pytest.mark.thorough
@pytest.mark.parametrize("n_fields", [1, 2])
@pytest.mark.parametrize("seed", [0, 1])
def test_heavy_tops_of_six_components_and_rigid_bodies_of_three(seed, n_fields):
    rng = np.random.default_rng(seed)
    top = random_small_top(rng, n_fields)
    found = check(top, random_small_leaf(rng, top), 20)
    assert found.euler_characteristic == 2


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


@pytest.mark.parametrize(
    ("top", "values", "kinds"),
    [
        (((2, 3, 1), (0, 1, 0), (0, 0, 0), 1), (0, 0, 1), ["degenerate"] * 2 + ["point"] * 4),
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
