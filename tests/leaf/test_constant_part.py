"""Leaves, equilibria, samples, sections and exponents on brackets with a constant part."""

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.equilibrium.critical_points import HamiltonianFields
from liepoisson.errors import ParameterError

K = np.array([1 / 2, 1 / 3, 1 / 4])
CARRIER = lp.catalog.system("gyrostat")
BODY = lp.catalog.system("zhukovsky-volterra-gyrostat")


def twisted():
    """The twisted top in translated coordinates, and x0."""
    x0 = np.array([0.5, -0.25, 1, 0.5, 0, -0.5, 0.25, 1, 0])
    top = lp.Top(inertia=(1, 2, 3), a=(0, 0, 1), epsilon="1/2")
    exact = [sp.Rational(float(v)) for v in x0]
    there = {x: x + v for x, v in zip(top.variables, exact, strict=True)}
    moved = lp.System(top.bracket.translated(exact), top.hamiltonian.subs(there, simultaneous=True), name="moved top")
    return top, moved, x0


def test_the_poisson_tensor_and_its_derivative():
    """J at zero is the constant part; what is computed by steps agrees with the derivatives of J grad H."""
    x = np.array([0.3, -1.2, 0.7])
    tensor = CARRIER.functions.poisson_tensor
    np.testing.assert_allclose(tensor(np.zeros(3))[0, 1], -1 / 4)
    np.testing.assert_allclose(tensor(x) - tensor(np.zeros(3)), BODY.functions.poisson_tensor(x), atol=1e-15)
    fields = HamiltonianFields(CARRIER, [CARRIER.functions.energy])
    np.testing.assert_allclose(fields.poisson(x), tensor(x), atol=1e-15)
    np.testing.assert_allclose(fields.fields(x)[:, 0], CARRIER.vector_field(x), atol=1e-15)
    np.testing.assert_allclose(fields.derivatives(x)[..., 0], CARRIER.functions.jacobian(x), atol=1e-15)


@pytest.mark.thorough
def test_a_translated_top_moves_as_the_top():
    top, moved, x0 = twisted()
    start, t = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4]), np.linspace(0, 10, 5)
    orbit = lp.integrate(moved, start - x0, times=t)
    np.testing.assert_allclose(orbit.state[0] + x0, lp.integrate(top, start, times=t).state[0], atol=1e-12)
    ours, theirs = lp.Leaf.through(moved, start - x0), lp.Leaf.through(top, start)
    assert (
        (ours.rank, ours.is_regular, ours.caution) == (theirs.rank, theirs.is_regular, theirs.caution) == (6, True, "")
    )
    np.testing.assert_array_equal(ours.contains(orbit.state[0]), True)
    assert not ours.contains(orbit.state[0, 0] + 0.01)
    assert lp.Leaf(moved, ours.casimirs).residual(start - x0) < 1e-12


@pytest.mark.thorough
def test_the_equilibria_of_the_gyrostat_are_those_of_the_body_moved():
    """M + k is along omega; on a sphere the signs sum to 2, which is checked."""
    state = np.array([0.5, 1.5, -1.0])
    ours, theirs = (lp.equilibria(s, lp.Leaf.through(s, x)) for s, x in ((CARRIER, state), (BODY, state + K)))
    assert ours.euler_characteristic == 2
    assert len(ours) == len(theirs) == 4
    for mine, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(mine.state + K, other.state, atol=1e-9)
        assert mine.energy == pytest.approx(other.energy)
        assert mine.linear_stability == other.linear_stability
        assert mine.signature == other.signature
        assert mine.growth_rate == pytest.approx(other.growth_rate, abs=1e-9)
        assert np.cross(mine.state + K, mine.state / [1, 2, 2.5]) == pytest.approx(np.zeros(3), abs=1e-9)


@pytest.mark.thorough
def test_samples_have_the_liouville_measure():
    """In the well H = |z|^2/2 the fraction of H < E is (E/E0)^2, and q1^2 has the mean E0/3."""
    harmonic = lp.System(lp.canonical(2), "(dot(p, p) + dot(q, q))/2")
    x = lp.Leaf(harmonic, {}).sample(4000, seed=3, energy_below=2.0)
    energy = harmonic.functions.energy(x)
    assert energy.max() <= 2.0
    assert np.mean(energy < 1.0) == pytest.approx(0.25, abs=0.05)
    assert (x**2).mean(axis=0) == pytest.approx(np.full(4, 2 / 3), abs=0.06)
    shell = lp.Leaf(harmonic, {}).sample(4000, seed=3, energy=2.0)
    assert harmonic.functions.energy(shell) == pytest.approx(np.full(4000, 2.0))
    assert (shell**2).mean(axis=0) == pytest.approx(np.ones(4), abs=0.08)


def test_a_system_with_quadratures_has_no_leaves():
    system = lp.systems.CanonicalSystem(["x"], ["p"], "(x^2 + p^2)/2", quadratures={"area": "x*x"})
    with pytest.raises(ParameterError, match="area besides, found by quadrature"):
        lp.Leaf(system, {})
    assert system.is_constant("x^2 + p^2")
    assert system.derivative("area - x*p") != 0
    assert sp.expand(system.derivative("2*area + x*p") - sp.Symbol("x") ** 2 - sp.Symbol("p") ** 2) == 0
    plain = lp.systems.CanonicalSystem(["x"], ["p"], "(x^2 + p^2)/2 + x^4")
    assert len(lp.equilibria(plain, lp.Leaf(plain, {}))) == 1
