"""Roots, exponentials and trigonometric functions as further variables: integrals of the literature, and relations."""

import pytest
import sympy as sp
from sympy import cos, sin, sqrt

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability.algebraic_functions import algebraic_equations
from liepoisson.integrability.derivation import level_of

first_integrals = lp.integrability.first_integrals
PLANE = lp.canonical(names=("x", "y"))
KEPLER = lp.System(PLANE, "(p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)", name="Kepler")
OTHER = lp.System(
    PLANE,
    "(p_x^2 + p_y^2)/2 + tan(x/2) + sin(x + y)^2 + cosh(3*y) + exp(-y) + sqrt(1 + x^2)*y/(1 + cos(x)*x)",
    name="other",
)
X, Y, P, Q = KEPLER.variables


def found_in(system, **scope):
    found = first_integrals(system, **scope)
    assert found.complete
    assert all(system.is_constant(f.expression) for f in found.found)
    assert all(f.expression.free_symbols <= set(system.variables) for f in found.found)
    return [f.expression for f in found.found]


def test_the_runge_lenz_vector_is_found():
    momentum, *vector = found_in(KEPLER, degree=3)
    assert sp.expand(momentum - (X * Q - Y * P)) == 0
    r = sqrt(X**2 + Y**2)
    wanted = {Q * momentum - X / r, P * momentum + Y / r}
    assert all(any(sp.expand(v - w) == 0 or sp.expand(v + w) == 0 for w in wanted) for v in vector)
    assert len(vector) == 2
    assert [f.is_independent for f in first_integrals(KEPLER, degree=3).found] == [True, True, False]


def test_the_toda_lattice_has_henons_integrals():
    system = lp.catalog.system("toda")
    found = found_in(system, degree=3)
    assert [sp.simplify(f - k) for f, k in zip(found, system.integrals.values(), strict=True)] == [0, 0]


def test_a_spherical_pendulum_in_angles():
    system = lp.System(lp.canonical(names=("theta", "phi")), "(p_theta^2 + p_phi^2/sin(theta)^2)/2 + cos(theta)")
    assert [str(f) for f in found_in(system, degree=3)] == ["p_phi"]
    theta = system.variables[0]
    assert first_integrals(system, degree=3).functions == (sin(theta), cos(theta), 1 / sin(theta))


@pytest.mark.parametrize("system", [KEPLER, OTHER, lp.catalog.system("toda"), lp.catalog.system("double-pendulum")])
def test_the_equations_are_those_of_the_functions(system):
    equations, _ = algebraic_equations(system)
    assert level_of(equations.derivation, equations.relations).basis
    point = {x: sp.Rational(k + 2, 7) for k, x in enumerate(system.variables)}
    values = {v: f.subs(point) for v, f in (equations.functions | {x: x for x in system.variables}).items()}

    def at_point(polynomial):
        return sp.N(equations.derivation.expression(polynomial).subs(values), 30)

    assert all(abs(at_point(relation)) < 1e-25 for relation in equations.relations)
    for variable, rate in zip(equations.derivation.variables, equations.derivation.components, strict=True):
        along = system.bracket(equations.functions.get(variable, variable), system.hamiltonian)
        assert abs(at_point(rate) - sp.N(along.subs(point), 30)) < 1e-25, variable


@pytest.mark.parametrize(
    ("terms", "n_functions", "n_relations"),
    [
        ("exp(x) + exp(2*x) + exp(3*x/2)", 1, 0),
        ("exp(x + y) + exp(x) + exp(y)", 3, 1),
        ("sin(2*x) + cos(3*x)", 2, 1),
        ("sin(x) + sin(y) + cos(x - 2*y + pi/3)", 4, 2),
        ("sqrt(1 + x^2) + 1/sqrt(4 + 4*x^2) + 1/(1 + x^2)", 2, 2),
        ("1/(x*y) + 1/x^3", 2, 2),
    ],
)
def test_as_few_new_variables_as_needed(terms, n_functions, n_relations):
    equations, _ = algebraic_equations(lp.System(PLANE, f"(p_x^2 + p_y^2)/2 + {terms}"))
    assert len(equations.functions) == n_functions
    assert n_relations in (None, len(equations.relations))


@pytest.mark.parametrize(
    ("potential", "words"),
    [
        ("x*log(y)", r"got log\(y\)"),
        ("exp(x^2)", "x\\*\\*2"),
        ("sin(sqrt(2)*x)", "linear forms with rational coefficients"),
        ("cos(1.234*x) + cos(x) + y^2", "at most 100 times a common form"),
        ("sqrt(x) + sqrt(y) + sqrt(x*y)", "no product is a polynomial"),
        ("x^(1/3)", "linear forms"),
    ],
)
def test_other_functions_are_refused_with_what_applies(potential, words):
    system = lp.System(PLANE, f"(p_x^2 + p_y^2)/2 + {potential}")
    with pytest.raises(ParameterError, match=words):
        first_integrals(system, degree=1)
