"""A good surface of section, by exact arithmetic and along orbits; states on leaf, energy surface and section."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.poincare.surfaces import section_state

TWISTED = lp.Top.twisted_kovalevskaya()
SURFACE = lp.sections.good_surface(TWISTED)


@pytest.mark.parametrize("a", [(-1, 0, 0), ("sqrt(2)", 0.5, 1)])
def test_the_surface_is_the_product_of_a_alpha_and_beta(a):
    top = lp.Top(inertia=(1, 1, 2), a=a, epsilon=1)
    text = lp.sections.good_surface(top)
    product = " + ".join(
        f"({value})*(alpha{i}*beta{j} - alpha{j}*beta{i})"
        for value, (i, j) in zip(a, ((2, 3), (3, 1), (1, 2)), strict=True)
        if value != 0
    )
    assert (top.expression(text) - top.expression(product)).expand() == 0


START = np.array([0.3, -0.5, 0.4, 0.6, 0.2, -0.3, 0.5, 0.1, 0.8])

numbers = st.integers(-3, 3)
vectors = st.tuples(numbers, numbers, numbers)
moments = st.tuples(*(st.integers(2, 3) for _ in range(3)))  # any three fulfil the triangle inequality


def derivative(top, function):
    """Along the flow."""
    return sum(function.diff(v) * rate for v, rate in zip(top.variables, top.equations.values(), strict=True))


@pytest.mark.thorough
@settings(max_examples=12)
@given(moments, vectors.filter(any), vectors, numbers)
def test_the_surface_is_minus_the_derivative_of_l_beta_and_its_own_derivative_is_as_stated(inertia, a, b, epsilon):
    top = lp.Top(inertia=inertia, a=a, b=b, epsilon=epsilon)
    l, alpha, beta = (sp.Matrix(top.variables[k : k + 3]) for k in (0, 3, 6))
    s = top.expression(lp.sections.good_surface(top))
    assert sp.expand(derivative(top, l.dot(beta)) + s) == 0
    centre, omega = sp.Matrix(a), sp.Matrix([m / i for m, i in zip(l, inertia, strict=True)])
    stated = alpha.cross(beta).dot(omega.cross(centre)) + epsilon * centre.cross(beta).dot(centre.cross(beta))
    assert sp.expand(derivative(top, s) - stated) == 0


def test_parallel_fields_cross_the_surface_in_the_direction_of_epsilon():
    """Where alpha || beta, ds/dt = epsilon |a x beta|^2, whatever l."""
    for epsilon in (1, -1):
        top = lp.Top.twisted_kovalevskaya(epsilon)
        x = np.array([0.4, -0.2, 0.7, 0.4, 0.2, -0.6, 0.2, 0.1, -0.3])
        slope = top.functions.of(lp.sections.good_surface(top)).gradient(x) @ top.vector_field(x)
        assert slope == pytest.approx(epsilon * (0.1**2 + 0.3**2))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "surface"), [("twisted-kovalevskaya", None), ("twisted-lagrange", None), ("kirchhoff", "m1")]
)
def test_random_starts_lie_on_leaf_energy_surface_and_section(name, surface):
    system = lp.catalog.system(name)
    surface = surface or lp.sections.good_surface(system)
    leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
    energy = leaf.energy_range()[0] + 1.5
    x = lp.sections.section_starts(leaf, surface, energy=energy, n_starts=5, seed=3)
    assert np.array_equal(x, lp.sections.section_starts(leaf, surface, energy=energy, n_starts=5, seed=3))
    assert x.shape == (5, len(system.variables))
    assert leaf.residual(x).max() < 1e-13
    np.testing.assert_allclose(system.functions.energy(x), energy, rtol=1e-13)
    assert np.abs(system.functions.of(surface)(x)).max() < 1e-12


@pytest.mark.thorough
def test_starts_of_one_direction_return_in_that_direction():
    leaf = lp.Leaf.through(TWISTED, START)
    slope = TWISTED.functions.of(SURFACE).gradient
    for direction in (1, -1):
        x = lp.sections.section_starts(leaf, SURFACE, energy=1.0, n_starts=30, seed=3, direction=direction)
        rates = np.einsum("ij,ij->i", slope(x), TWISTED.vector_field(x))
        assert (direction * rates > 0).all()


@pytest.mark.thorough
def test_a_state_of_the_section_with_given_coordinates():
    leaf = lp.Leaf.through(TWISTED, START)
    there = lp.sections.section_starts(leaf, SURFACE, energy=1.5, n_starts=1, seed=1)[0]
    wanted = {"l3": there[2], "alpha1": there[3], "beta2": there[7], "dot(l, beta)": there[:3] @ there[6:]}
    x = section_state(leaf, SURFACE, 1.5, wanted, guess=there + 0.02)
    np.testing.assert_allclose(x, there, atol=1e-9)
    x = section_state(leaf, SURFACE, 1.5, {"l3": 0.2, "alpha1": 0.1})
    assert leaf.residual(x) < 1e-13
    assert TWISTED.functions.energy(x) == pytest.approx(1.5, abs=1e-13)
    assert TWISTED.functions.of(SURFACE)(x) == pytest.approx(0, abs=1e-13)
    np.testing.assert_allclose(x[[2, 3]], [0.2, 0.1], atol=1e-13)


def test_spread_starts_are_on_the_section_and_far_from_each_other():
    system = lp.catalog.system("kovalevskaya")
    leaf = lp.Leaf(system, {"C1": 0.5, "C2": 1})
    x = lp.sections.section_starts(leaf, "alpha2", energy=1, n_starts=12, seed=2, direction=1, spread=True)
    assert leaf.residual(x).max() < 1e-13
    assert np.abs(system.functions.energy(x) - 1).max() < 1e-12
    assert (system.vector_field(x)[:, 4] > 0).all()
    distances = np.linalg.norm(x[:, None] - x, axis=-1)
    nearest = [distances[k, :k].min() for k in range(1, 12)]
    # each is the farthest from those before, so that these distances can only fall
    assert (np.diff(nearest) <= 0).all()
    assert nearest[-1] > 0.3


@pytest.mark.parametrize("spread", [False, True])
def test_starts_are_on_the_leaf_whatever_function_of_a_casimir_is_in_the_hamiltonian(spread):
    """H + 2 C1^2 has the equations of H on each leaf; far away in l its terms hid what was left of the Casimirs."""
    bracket = lp.catalog.system("kovalevskaya").bracket
    system = lp.System(bracket, "l1^2/4 + l2^2/6 + l3^2/2 - alpha1 + 2*dot(l, alpha)^2")
    leaf = lp.Leaf(system, {"C1": 0.3, "C2": 1})
    starts = lp.sections.section_starts(leaf, "alpha2", energy=1.18, n_starts=24, spread=spread)
    assert leaf.contains(starts).all()
    np.testing.assert_allclose(system.functions.energy(starts), 1.18, rtol=0, atol=1e-12)
