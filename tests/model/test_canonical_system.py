"""Canonical systems: equations, fields, functions, quadratures."""

import pickle

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.systems import CanonicalSystem

PENDULUM = CanonicalSystem(["theta"], ["p"], "p^2/(2*m) - k*cos(theta)", parameters={"m": 2, "k": "1/3"})


def test_the_equations_are_those_of_hamilton():
    theta, p = PENDULUM.variables
    assert PENDULUM.equations == {theta: p / 2, p: -sp.sin(theta) / 3}
    assert PENDULUM.bracket(p**2, theta * p) == -2 * p * p
    vectors = lp.System(lp.canonical(2), "dot(p, p)/(2*m) + k*dot(q, q)/2 + q[1]*q2", {"m": 2, "k": 3})
    q1, q2, p1, _ = vectors.variables
    assert (vectors.equations[q1], vectors.equations[p1]) == (p1 / 2, -3 * q1 - q2)
    other = lp.System(lp.canonical(names=["theta"], momenta=["p"]), "p^2/(2*m) - k*cos(theta)", {"m": 2, "k": "1/3"})
    assert list(other.equations.items()) == list(PENDULUM.equations.items())
    copy = pickle.loads(pickle.dumps(PENDULUM))
    assert (copy.equations, copy.field()) == (PENDULUM.equations, PENDULUM.field())


def test_the_pendulum_at_its_separatrix():
    """theta = 4 atan(tanh(s/2)) with s = t for theta'' = -sin theta, theta(0) = 0, theta'(0) = 2."""
    pendulum = CanonicalSystem(["theta"], ["p"], "p^2/2 - cos(theta)")
    t = np.linspace(0, 5, 21)
    orbit = lp.integrate(pendulum, [0.0, 2.0], times=t)
    assert orbit.components == ("theta", "p")
    np.testing.assert_allclose(orbit.state[0, :, 0], 4 * np.arctan(np.tanh(t / 2)), rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("hamiltonian", "kind"),
    [("p1^2/2 + q1^3/3 - q1*p1^2", "quadratic"), ("p1^2/2 + q1^4", "tape"), ("p1^2/2 + cos(q1)", "tape")],
)
def test_cubic_hamiltonians_have_quadratic_fields(hamiltonian, kind):
    field = lp.System(lp.canonical(1), hamiltonian).field()
    assert field.kind == kind
    if kind == "quadratic":
        rates = (0, 0, 1, -2.0), (1, 0, 0, -1.0), (1, 1, 1, 1.0)
        assert field == lp.fields.QuadraticField(2, (), ((0, 1, 1.0),), rates)


def test_a_quadrature_follows_the_motion_without_acting_on_it():
    """The integral of cos^2 t is t/2 + sin(2t)/4."""
    system = CanonicalSystem(["x"], ["p"], "(x^2 + p^2)/2", quadratures={"area": "x*x"})
    orbit = lp.integrate(system, [1.0, 0.0, 0.0], times=[0, 2.0])
    np.testing.assert_allclose(orbit.state[0, -1], [np.cos(2), -np.sin(2), 1 + np.sin(4) / 4], atol=1e-14)


def test_functions_of_arrays():
    z = np.array([[0.3, 0.2], [1.0, -0.5]])
    energy = PENDULUM.functions.energy
    np.testing.assert_allclose(energy(z), z[:, 1] ** 2 / 4 - np.cos(z[:, 0]) / 3)
    rates = np.einsum("...ij,...j->...i", PENDULUM.functions.poisson_tensor(z), energy.gradient(z))
    np.testing.assert_allclose(PENDULUM.vector_field(z), rates)
    step = 1e-6 * np.array([0.6, 0.8])
    difference = PENDULUM.vector_field(z + step) - PENDULUM.vector_field(z - step)
    np.testing.assert_allclose(PENDULUM.functions.jacobian(z) @ (2 * step), difference, atol=1e-15)
