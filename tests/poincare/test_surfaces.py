"""A good surface of section, by exact arithmetic and along orbits; states on leaf, energy surface and section."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.errors import LeafError, ParameterError
from liepoisson.poincare.surfaces import section_state

TWISTED = lp.Top.twisted_kovalevskaya()
SURFACE = lp.sections.good_surface(TWISTED)


@pytest.mark.parametrize("a", [(-1, 0, 0), (0, 0, 1), ("3/5", 0, "4/5"), ("sqrt(2)", 0.5, 1)])
def test_the_surface_is_written_out(a):
    """No factor stands in brackets before a bracket, and the numbers of its crossings are those of the product."""
    top = lp.Top(inertia=(1, 1, 2), a=a, epsilon=1)
    text = lp.sections.good_surface(top)
    assert "(1)*" not in text
    assert "(-1)*" not in text
    product = " + ".join(
        f"({value})*(alpha{i}*beta{j} - alpha{j}*beta{i})"
        for value, (i, j) in zip(a, ((2, 3), (3, 1), (1, 2)), strict=True)
        if value != 0
    )
    assert top.function_tape(text) == top.function_tape(product)


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


def test_orbits_come_back_to_the_surface_at_maxima_and_minima_of_l_beta_in_turn():
    x0 = lp.sample_states(TWISTED, 12, seed=4)
    found = lp.section(TWISTED, x0, surface=SURFACE, t_end=300)
    assert found.count.min() > 50
    second = TWISTED.functions.of(derivative(TWISTED, -TWISTED.expression(SURFACE)))(found.state)
    assert np.array_equal(np.sign(second), -found.sign), "s increases where l.beta is largest"
    for k in range(12):
        signs = found.sign[found.trajectory == k]
        assert np.array_equal(signs[1:], -signs[:-1])


def test_a_top_without_such_a_surface_is_refused():
    with pytest.raises(ParameterError, match="constant"):
        lp.sections.good_surface(lp.Top(inertia=(2, 2, 1), a=(0, 0, 0), b=(1, 0, 0), epsilon=1))
    with pytest.raises(ParameterError, match="time derivative of a bounded function"):
        lp.sections.good_surface(lp.catalog.system("manakov-so4"))


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
    assert x.shape == (5, len(system.variables))
    assert leaf.residual(x).max() < 1e-13
    np.testing.assert_allclose(system.functions.energy(x), energy, rtol=1e-13)
    assert np.abs(system.functions.of(surface)(x)).max() < 1e-12


@pytest.mark.thorough
def test_starts_depend_on_the_seed_alone():
    leaf = lp.Leaf.through(TWISTED, START)
    x, again, other = (
        lp.sections.section_starts(leaf, SURFACE, energy=1.0, n_starts=5, seed=seed) for seed in (3, 3, 4)
    )
    assert np.array_equal(x, again)
    assert not np.allclose(x, other)


@pytest.mark.thorough
def test_starts_of_one_direction_return_in_that_direction():
    leaf = lp.Leaf.through(TWISTED, START)
    slope = TWISTED.functions.of(SURFACE).gradient
    for direction in (1, -1):
        x = lp.sections.section_starts(leaf, SURFACE, energy=1.0, n_starts=30, seed=3, direction=direction)
        rates = np.einsum("ij,ij->i", slope(x), TWISTED.vector_field(x))
        assert (direction * rates > 0).all()
    with pytest.raises(ParameterError, match="direction"):
        lp.sections.section_starts(leaf, SURFACE, energy=1.0, n_starts=3, seed=3, direction=2)


@pytest.mark.thorough
def test_energies_and_surfaces_out_of_reach_are_refused():
    leaf = lp.Leaf.through(TWISTED, START)
    with pytest.raises(LeafError, match="On this leaf the energy lies between"):
        lp.sections.section_starts(leaf, SURFACE, energy=leaf.energy_range()[0] - 1, n_starts=3, seed=1)
    with pytest.raises(LeafError, match="converged from 0 of 192 guesses, 0 %"):
        lp.sections.section_starts(leaf, "norm(beta) - 5", energy=1.0, n_starts=3, seed=1)
    with pytest.raises(ParameterError, match="seed"):
        lp.sections.section_starts(leaf, SURFACE, energy=1.0, n_starts=3, seed=-1)


def test_starts_need_no_markov_chain(monkeypatch):
    """Six components: 24 starts took 3 to 12 s through the chain of `Leaf.sample`, and take 20 ms without."""
    monkeypatch.setattr("liepoisson.leaf.leaf_sampling.sample_by_chains", None)
    for name, surface in (("kovalevskaya", "l3"), ("manakov-so4", "M12")):
        system = lp.catalog.system(name)
        leaf = lp.Leaf.through(system, lp.sample_states(system, 1, seed=1)[0])
        energy = float(system.functions.energy(leaf.state))
        x = lp.sections.section_starts(leaf, surface, energy=energy, n_starts=24, seed=3)
        assert leaf.residual(x).max() < 1e-13
        np.testing.assert_allclose(system.functions.energy(x), energy, rtol=1e-12)
        assert np.abs(system.functions.of(surface)(x)).max() < 1e-12
        assert np.ptp(x, axis=0).max() > 0.5


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


@pytest.mark.thorough
def test_an_energy_out_of_reach_is_told_before_the_surface_is_blamed():
    leaf = lp.Leaf(lp.catalog.system("kovalevskaya"), {"C1": 0.5, "C2": 1})
    for call in (
        lambda: lp.sections.section_starts(leaf, "l3", energy=-9, n_starts=3, seed=2),
        lambda: lp.sections.section_starts(leaf, "l3", energy=-9, n_starts=3, seed=2, direction=1, spread=True),
        lambda: section_state(leaf, "l3", -9, {"alpha1": 0.2}),
        lambda: leaf.project(leaf.state, energy=-9, surface="l3"),
        lambda: leaf.sample(3, seed=2, energy=-9),
    ):
        with pytest.raises(LeafError, match=r"^states on <Leaf .* the energy lies between .* -9 was asked for\.$"):
            call()


@pytest.mark.thorough
def test_coordinates_that_no_state_has_are_refused():
    leaf = lp.Leaf.through(TWISTED, START)
    with pytest.raises(LeafError, match=r"beta1 = 7.*least residual reached from 65 guesses"):
        section_state(leaf, SURFACE, 1.5, {"beta1": 7})
    with pytest.raises(LeafError, match="from 1 guess "):
        section_state(leaf, SURFACE, 1.5, {"beta1": 7}, guess=START)
    with pytest.raises(ParameterError, match="finite"):
        section_state(leaf, SURFACE, 1.5, {"l3": np.nan})


def test_the_section_of_a_leaf_of_lower_rank():
    """The heavy top within the twisted one: beta = 0."""
    leaf = lp.Leaf.through(TWISTED, [0.3, -0.5, 0.4, 0.6, 0.2, -0.3, 0, 0, 0])
    x = section_state(leaf, "l3", 1.0, {"alpha3": 0.4})
    assert np.array_equal(x[6:], np.zeros(3))
    assert leaf.residual(x) < 1e-13
    assert x[5] == pytest.approx(0.4)


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


@pytest.mark.thorough
def test_spread_starts_of_an_energy_out_of_reach_are_refused_with_those_in_reach():
    leaf = lp.Leaf(lp.catalog.system("kovalevskaya"), {"C1": 0.5, "C2": 1})
    with pytest.raises(LeafError, match=r"^states on .* the energy lies between -\d\.\d+ and inf; -9 was asked for"):
        lp.sections.section_starts(leaf, "alpha2", energy=-9, n_starts=3, seed=2, spread=True)
    with pytest.raises(ParameterError, match="direction"):
        lp.sections.section_starts(leaf, "alpha2", energy=1, n_starts=3, seed=2, direction=np.ones(2))


def test_an_energy_is_wanted():
    """None would leave the energy free, and each start would have its own."""
    leaf = lp.Leaf.through(TWISTED, START)
    for bad in (None, np.nan, "x"):
        for spread in (False, True):
            with pytest.raises(ParameterError, match="energy"):
                lp.sections.section_starts(leaf, SURFACE, energy=bad, n_starts=4, seed=0, spread=spread)
        with pytest.raises(ParameterError, match="energy"):
            section_state(leaf, SURFACE, bad, {"l3": 0.2})
