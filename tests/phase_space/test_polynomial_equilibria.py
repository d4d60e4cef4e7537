"""Equilibria of polynomial systems with proof: against the proof for tops, formulas, and the search."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.algebra.ideals.limits import Limits
from liepoisson.equilibrium.equilibrium_search import EquilibriumSearch
from liepoisson.equilibrium.heavy_equilibria import exact_top
from liepoisson.equilibrium.leaf_equilibria import polynomial_equilibria
from liepoisson.equilibrium.top_equilibria import equilibria_of_top


def ordered(states):
    return np.array(sorted(np.round(list(states), 8).tolist()))


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["kovalevskaya", "heavy-top", "goryachev-chaplygin"])
@pytest.mark.parametrize("values", [(0.5, 1.0), (3.0, 1.0), (0.0, 2.0)])
def test_tops_have_the_equilibria_of_their_own_proof(name, values):
    system = lp.catalog.system(name)
    leaf = lp.Leaf(system, {"C1": values[0], "C2": values[1]})
    by_algebra, is_all = equilibria_of_top(leaf, exact_top(system))
    assert is_all
    found = polynomial_equilibria(leaf)
    if any(one.kind != "point" for one in by_algebra):
        assert found is None
    else:
        np.testing.assert_allclose(ordered(found.states), ordered(one.state for one in by_algebra), atol=1e-7)


def test_a_rigid_body_rotates_about_its_axes():
    # l x I^-1 l = 0 on |l| = 2: an eigenvector of I
    found = polynomial_equilibria(lp.Leaf.through(lp.catalog.system("free-rigid-body"), [0, 2.0, 0]))
    assert found.degree == 6
    np.testing.assert_array_equal(ordered(found.states), ordered([s * 2 * e for s in (1, -1) for e in np.eye(3)]))


@pytest.mark.thorough
def test_neumann_rests_at_the_ends_of_the_axes():
    system = lp.catalog.system("neumann")
    found = lp.equilibria(system, lp.Leaf.through(system, [0.3, 0.1, 0, 0, 0, 1.0]))
    assert found.proved
    ends = ordered([s * e for s in (1, -1) for e in np.eye(6)[3:]])
    np.testing.assert_allclose(ordered(e.state for e in found), ends)


@pytest.mark.thorough
def test_a_general_quadratic_hamiltonian_on_so4_has_thirty_six():
    # Milnor's sum on S^2 x S^2 is 4, and -x is an equilibrium where x is one
    so4 = lp.catalog.system("manakov-so4")
    v = [str(x) for x in so4.variables]
    pairs = [(a, b) for i, a in enumerate(v) for b in v[i:]]
    terms = [f"{1 + (5 * k * k + 3 * k) % 11}*{a}*{b}" for k, (a, b) in enumerate(pairs)]
    system = lp.System(so4.bracket, " + ".join(terms), name="general")
    found = lp.equilibria(system, lp.Leaf.through(system, [1, 2, -1, 3, 1, 2]))
    assert found.proved
    assert (found.n_complex, found.euler_found) == (36, 4)
    states = ordered(e.state for e in found)
    np.testing.assert_allclose(states, -states[::-1], atol=1e-7)


@pytest.mark.thorough
def test_kirchhoff_equations_in_general_have_thirty():
    system = lp.catalog.system("kirchhoff-ellipsoid")
    leaf = lp.Leaf(system, {"C1": 0.25, "C2": 1})
    found = lp.equilibria(system, leaf)
    assert found.proved
    assert found.completeness == "these are all (proved by algebra, from 30 complex solutions)"
    assert found.euler_found == found.euler_characteristic == 2
    for e in found:
        assert np.abs(system.vector_field(e.state)).max() < 1e-13
        assert leaf.contains(e.state)
    search = EquilibriumSearch(leaf, {}, np.zeros(0), 0)
    search.extend(30)
    np.testing.assert_allclose(ordered(e.state for e in search.found), ordered(e.state for e in found), atol=1e-7)


@pytest.mark.parametrize("name", ["manakov-so4", "lagrange"])
def test_families_are_left_to_others(name):
    system = lp.catalog.system(name)
    x = np.arange(1.0, 1 + len(system.variables))
    assert polynomial_equilibria(lp.Leaf.through(system, x)) is None


@pytest.mark.thorough
def test_what_costs_too_much_is_not_decided():
    system = lp.catalog.system("kirchhoff-ellipsoid")
    leaf = lp.Leaf(system, {"C1": 0.25, "C2": 1})
    assert polynomial_equilibria(leaf, Limits(work=5000)) is None
    assert polynomial_equilibria(leaf, Limits(degree=29)) is None
    assert polynomial_equilibria(leaf, Limits(degree=30)).degree == 30


@pytest.mark.thorough
def test_singular_leaves_and_irrational_equations_are_not_decided():
    clebsch, sine = lp.catalog.system("clebsch"), lp.catalog.system("zeitlin-3")
    assert polynomial_equilibria(lp.Leaf.through(clebsch, [1, 2, 3, 0, 0, 0])) is None
    assert polynomial_equilibria(lp.Leaf.through(sine, np.arange(1.0, 9.0))) is None
