"""Canonical systems: equations, fields, functions, texts, and what is refused."""

import pickle

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ExpressionError, ParameterError, ShapeError

PENDULUM = lp.systems.CanonicalSystem(["theta"], ["p"], "p^2/(2*m) - k*cos(theta)", parameters={"m": 2, "k": "1/3"})


def test_the_equations_are_those_of_hamilton():
    theta, p = PENDULUM.variables
    assert PENDULUM.equations == {theta: p / 2, p: -sp.sin(theta) / 3}
    assert PENDULUM.bracket(theta, p) == 1
    assert PENDULUM.bracket(p**2, theta * p) == -2 * p * p


def test_the_pendulum_at_its_separatrix():
    # theta = 4 atan(tanh(s/2)) with s = t for theta'' = -sin theta, theta(0) = 0, theta'(0) = 2
    pendulum = lp.systems.CanonicalSystem(["theta"], ["p"], "p^2/2 - cos(theta)")
    t = np.linspace(0, 5, 21)
    orbit = lp.integrate(pendulum, [0.0, 2.0], times=t)
    assert orbit.components == ("theta", "p")
    np.testing.assert_allclose(orbit.state[0, :, 0], 4 * np.arctan(np.tanh(t / 2)), rtol=0, atol=1e-12)


def test_a_quadratic_hamiltonian_has_a_quadratic_field_and_any_other_a_tape():
    oscillator = lp.systems.CanonicalSystem(["x", "y"], ["u", "v"], "(x^2 + u^2)/2 + (2*y^2 + v^2)/2")
    assert isinstance(oscillator.field(), lp.fields.QuadraticField)
    assert isinstance(PENDULUM.field(), lp.fields.TapeField)


def test_a_quadrature_follows_the_motion_without_acting_on_it():
    system = lp.systems.CanonicalSystem(["x"], ["p"], "(x^2 + p^2)/2", quadratures={"area": "x*x"})
    orbit = lp.integrate(system, [1.0, 0.0, 0.0], times=[0, 2.0])
    # the integral of cos^2 t is t/2 + sin(2t)/4
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


def test_a_text_becomes_a_tape_for_the_core():
    tape = PENDULUM.function_tape("sin(theta)", "p - m")
    assert (tape.n_components, len(tape.outputs)) == (2, 2)
    with pytest.raises(ExpressionError, match="phi"):
        PENDULUM.function_tape("phi")


def test_it_is_pickled_without_its_compiled_functions():
    _ = PENDULUM.functions.energy([0.1, 0.2])
    copy = pickle.loads(pickle.dumps(PENDULUM))
    assert copy.equations == PENDULUM.equations
    assert copy.field() == PENDULUM.field()


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((["x"], ["p", "u"], "p^2"), ShapeError, "one momentum for each"),
        (([], [], "1"), ShapeError, "one momentum for each"),
        (("x", "p", "p^2"), ShapeError, "one momentum for each"),
        ((None, ["p"], "p^2"), ShapeError, "one momentum for each"),
        ((["x"], 3, "p^2"), ShapeError, "one momentum for each"),
        (([1], ["p"], "p^2"), ShapeError, "one momentum for each"),
        ((["x"], ["x"], "x^2"), ParameterError, "given twice"),
        ((["x 1"], ["p"], "p^2"), ParameterError, "letters, digits"),
        ((["x"], ["p"], "p^2 + abs(x)"), ExpressionError, "not smooth"),
        ((["x"], ["p"], "p^2 + y"), ExpressionError, "unknown"),
        ((["x"], ["p"], 3), ParameterError, "must be a text, a SymPy expression"),
    ],
)
def test_wrong_input_is_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        lp.systems.CanonicalSystem(*arguments)


def test_quadratures_are_a_mapping():
    with pytest.raises(ParameterError, match="quadratures: wanted a mapping from names to rates"):
        lp.systems.CanonicalSystem(["x"], ["p"], "p^2", quadratures=["x"])


def test_a_symbol_without_a_number_is_refused_when_a_field_is_wanted():
    x, p, k = sp.symbols("x p k")
    system = lp.systems.CanonicalSystem(["x"], ["p"], p**2 + k * sp.cos(x), symbols=["k"])
    assert system.equations[p] == k * sp.sin(x)
    with pytest.raises(ParameterError, match="k has none"):
        system.field()


@pytest.mark.parametrize(
    ("hamiltonian", "rate", "what"),
    [
        ("(x^2 + p^2)/2 + a*x", "x", "the Hamiltonian"),
        (sp.Symbol("p") ** 2 / 2 + sp.Symbol("a"), "x", "the Hamiltonian"),
        ("(x^2 + p^2)/2", "x*a", "the rate of a"),
        ("(x^2 + p^2)/2", sp.Symbol("a"), "the rate of a"),
    ],
)
def test_quadratures_do_not_act_on_the_motion(hamiltonian, rate, what):
    """With a in H the equations would be no Hamiltonian system, and H no invariant."""
    with pytest.raises(ParameterError, match=f"{what} must be a function of the coordinates and momenta"):
        lp.systems.CanonicalSystem(["x"], ["p"], hamiltonian, quadratures={"a": rate})
