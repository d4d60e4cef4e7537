import pickle

import numpy as np
import pytest
import sympy as sp
from flint import arb

import liepoisson as lp
from liepoisson.algebra.ideals.certified_roots import precision
from liepoisson.compile.field import TopField
from liepoisson.errors import ParameterError
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.system import System
from liepoisson.model.tops import Top
from liepoisson.structure.canonical_bracket import canonical
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebras import so


def typed_by_hand(parameters=None):
    """The twisted top as a user types it, with a tilted a and a charge."""
    inertia, a, b = sp.Matrix([2, 3, sp.Rational(5, 2)]), sp.Matrix([1, -2, 3]), sp.Matrix(sp.symbols("b1:4"))

    def hamiltonian(l, alpha, beta):
        return sum(l[i] ** 2 / (2 * inertia[i]) for i in range(3)) + a.dot(alpha) + b.dot(beta)

    symbols = () if parameters else ("b[3]",)
    return System(so(3) @ leibniz(3, "epsilon"), hamiltonian, parameters, name="by hand", symbols=symbols)


VALUES = {"b1": "1/2", "b2": 0, "b3": 4, "epsilon": 0.3}


def test_a_system_typed_by_hand_matches_the_top():
    top = Top(inertia=(2, 3, "5/2"), a=(1, -2, 3), b=("1/2", 0, 4), epsilon="3/10")
    system = typed_by_hand(VALUES)
    assert system.field() == top.field() == TopField((2.0, 3.0, 2.5), (1.0, -2.0, 3.0), (0.5, 0.0, 4.0), 0.3)
    assert system.top_parameters == top.top_parameters
    assert system.equations == top.equations
    assert system.invariants == top.invariants


def test_numeric_functions_are_vectorised():
    system = typed_by_hand(VALUES)
    x = np.random.default_rng(1).normal(size=(4, 5, 9))
    derivative = system.vector_field(x)
    values = system.invariant_values(x)
    assert derivative.shape == (4, 5, 9)
    assert set(values) == set(system.invariants)
    for name, expression in system.invariants.items():
        assert values[name].shape == (4, 5)
        point = dict(zip(system.variables, x[2, 3], strict=True))
        assert values[name][2, 3] == pytest.approx(float(expression.subs(point)), rel=1e-13)
    np.testing.assert_array_equal(system.vector_field(x[2, 3]), derivative[2, 3])
    assert system.vector_field(np.zeros((0, 9))).shape == (0, 9)


def test_floats_in_a_hamiltonian_are_the_decimals_that_they_print_as():
    """I = 1/(2c) for a kinetic term c l^2; 0.1 is 1/10."""
    bracket = so(3) @ leibniz(3, 1)
    typed = System(bracket, lambda l, a, b: 0.1 * l[0] ** 2 + 0.1 * l[1] ** 2 + 0.7 * l[2] ** 2 + 0.3 * a[2] - b[0])
    assert typed.field() == Top(inertia=(5, 5, "5/7"), a=(0, 0, 0.3), b=(-1, 0, 0), epsilon=1).field()


def test_symbols_with_assumptions_are_the_coordinates():
    """Symbol("l1", real=True) is not Symbol("l1") for SymPy; a derivative must not take it for a constant."""
    bracket = so(3) @ semidirect(2)
    l1, l2, l3 = sp.symbols("l1:4", real=True)
    assert bracket(l1, l2) == -bracket.variables[2]
    system = System(bracket, l1**2 + 2 * l2**2 + 3 * l3**2)
    assert system.equations == System(bracket, "l1^2 + 2*l2^2 + 3*l3^2").equations
    assert not system.is_constant(l1)
    with pytest.raises(ParameterError, match="K must be constant"):
        _ = System(bracket, "l1^2 + 2*l2^2 + 3*l3^2", integrals={"K": l1}).invariants


W = [[list(row) for row in plane] for plane in leibniz(3).tensor]
W[2][1][2] = W[2][2][1] = 1


@pytest.mark.parametrize(
    ("extension", "hamiltonian"),
    [
        (leibniz(3), lambda l, alpha, beta: l.dot(l) / 2 + alpha.dot(alpha)),
        (leibniz(3), lambda l, alpha, beta: l.dot(l) / 2 + l[0] * l[1] / 3),
        (leibniz(3), lambda l, alpha, beta: l.dot(l) / 2 + l[2]),
        (leibniz(3), lambda l, alpha, beta: l.dot(l) / 2 + sp.sqrt(1 + alpha[0] ** 2)),
        (leibniz(3), lambda l, alpha, beta: (l[0] ** 2 + l[1] ** 2) / 2 + alpha[0]),
        *((e, lambda l, *fields: l.dot(l) / 2 + fields[0][0]) for e in (Extension(W, check=False), leibniz(4))),
    ],
)
def test_other_systems_are_no_tops(extension, hamiltonian):
    system = System(so(3) @ extension, hamiltonian)
    assert system.top_parameters is None
    assert system.field().kind in ("quadratic", "tape")


so3 = so(3) @ trivial()
l1, l2, l3 = so3.variables
k = sp.Symbol("k")


@pytest.mark.parametrize(
    "make",
    [
        lambda: System(so3, l1**2 / k, symbols=["k"]),
        lambda: System(so3, lambda l: l[0] ** 2 / k, {"k": 2}),
        lambda: System(so3, l1**2 / sp.Symbol("k1"), {"k": [1, 2]}),
        lambda: System(so3, l1**2 / sp.Symbol("k2"), symbols=["k[2]"]),
        lambda: System(so3, l1**2 / sp.Symbol("k", positive=True), {"k": "m"}),
        lambda: System(so3.with_constant({("l1", "l2"): "k"}), l1**2 * k),
        lambda: System(so3, sp.Symbol("l1", real=True) ** 2 / 3 + sp.pi * sp.erf(l2)),
        lambda: System(so3, (l1 + sp.I * l2) * (l1 - sp.I * l2)),
        lambda: CanonicalSystem(["q"], ["p"], sp.Symbol("p") ** 2 * k, symbols=["k"]),
    ],
)
def test_coordinates_and_declared_parameters_are_read(make):
    assert make().hamiltonian.free_symbols


def test_integrals_that_are_given_and_names_of_invariants():
    """The heavy top with I1 = I2 and a along the third axis keeps l3; |alpha|^2 is a Casimir."""
    bracket, energy = so(3) @ semidirect(2), "l1^2/4 + l2^2/4 + l3^2/2 + alpha3"
    integrals = {"K": "l3^2", "R": "sqrt(1 + dot(alpha, alpha))"}
    system = System(bracket, energy, integrals=integrals, partial_integrals={"M": ("l1", "alpha1")})
    l, alpha = bracket.fields.values()
    wanted = {"H": system.hamiltonian, "C1": l.dot(alpha), "C2": alpha.dot(alpha), "K": l[2] ** 2}
    assert dict(list(system.invariants.items())[:4]) == wanted
    assert list(system.invariants)[4] == "R"
    assert system.partial_integrals["M"] == (l[0], alpha[0])
    assert system.derivative("l1") == system.equations[l[0]]
    slope = system.functions.of("l1 - alpha2/3")
    assert system.expression(slope) == slope.expression
    assert system.functions.of(slope) is slope
    assert system.expression("K") == system.functions.of("K").expression == l[2] ** 2


@pytest.mark.parametrize(
    "change", ["d['a'] = 100", "del d['a']", "d.update(a=100)", "d |= {'a': 100}", "d.pop('a')", "d.clear()"]
)
def test_parameters_cannot_be_changed_in_place(change):
    system = System(canonical(names=("q",)), "p_q^2/2 + a*q^2", {"a": 1})
    for d in (system.parameters, system.values, pickle.loads(pickle.dumps(system)).parameters):
        with pytest.raises(TypeError, match="belong to a system"):
            exec(change, {"d": d})
        assert dict(d) == {"a": 1}


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


def test_balls_have_the_values_of_doubles_and_slopes_beyond_their_range():
    system = lp.System(lp.canonical(names=("q",), momenta=("p",)), "p^2/2 + tanh(q^3)/3 + sqrt(q)*cos(pi*p) - log(q)")
    function, state = system.functions.energy, np.array([1.3, 0.7])
    with precision(300):
        point = [arb(x) for x in state.tolist()]
        assert float(function.value_in_balls(point)) == pytest.approx(float(function(state)), rel=1e-14)
        slopes = [float(slope) for slope in function.gradient_in_balls(point)]
        assert slopes == pytest.approx(function.gradient(state).tolist(), rel=1e-13)
        assert not function.value_in_balls([arb(-1), arb(0)]).is_finite()
        tail = lp.System(lp.canonical(names=("q",), momenta=("p",)), "p + tanh(q^3)").functions.energy
        slope, _ = tail.gradient_in_balls([arb(100), arb(0)])
        assert slope > 0  # 3e4/cosh(1e6)^2
        assert abs(slope.log() + 2e6 - np.log(12e4)) < 1e-9


def test_a_phase_function_is_made_of_all_that_a_system_reads():
    top, state = lp.Top.lagrange(), np.arange(9.0)
    wanted = lp.systems.PhaseFunction(top, top.variables[0] ** 2 + 1)
    for given in ("l1^2 + 1", wanted, top.functions.of("l1^2 + 1")):
        assert lp.systems.PhaseFunction(top, given)(state) == wanted(state)
