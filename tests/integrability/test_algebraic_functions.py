"""Roots, exponentials and trigonometric functions as further variables: integrals of the literature, and relations."""

import pytest
import sympy as sp
from sympy import cos, exp, sin, sqrt

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability.algebraic_functions import algebraic_equations
from liepoisson.integrability.level import level_of

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


@pytest.mark.thorough
def test_two_centres_have_eulers_integral():
    system = lp.System(PLANE, "(p_x^2 + p_y^2)/2 - 1/sqrt((x - 1)^2 + y^2) - 2/sqrt((x + 1)^2 + y^2)", name="Euler")
    (found,) = found_in(system, degree=4)
    near, far = sqrt((X - 1) ** 2 + Y**2), sqrt((X + 1) ** 2 + Y**2)
    about_both = ((X - 1) * Q - Y * P) * ((X + 1) * Q - Y * P)
    euler = about_both + 2 * ((X - 1) * -1 / near + 2 * (X + 1) / far)
    points = [{X: 3, Y: 4, P: 1, Q: 2}, {X: -1, Y: 2, P: 2, Q: 1}, {X: 5, Y: 1, P: -1, Q: 3}, {X: 2, Y: 7, P: 4, Q: 0}]
    energy = system.hamiltonian
    rows = sp.Matrix([[sp.N(f.subs(point), 40) for f in (found, euler, energy)] + [1] for point in points])
    assert abs(rows.det()) < 1e-30


def test_a_spherical_pendulum_in_angles():
    system = lp.System(lp.canonical(names=("theta", "phi")), "(p_theta^2 + p_phi^2/sin(theta)^2)/2 + cos(theta)")
    assert [str(f) for f in found_in(system, degree=3)] == ["p_phi"]
    assert first_integrals(system, degree=3).functions == tuple(
        f.subs(sp.Symbol("theta"), system.variables[0])
        for f in (sin(sp.Symbol("theta")), cos(sp.Symbol("theta")), 1 / sin(sp.Symbol("theta")))
    )


def test_separated_functions_of_several_kinds():
    system = lp.System(lp.canonical(names=("x", "y", "z")), "(p_x^2 + p_y^2 + p_z^2)/2 + exp(x) - cos(y) + 1/z^2")
    x, y, _, px, py, _ = system.variables
    assert found_in(system, degree=2) == [px**2 + 2 * exp(x), py**2 - 2 * cos(y)]


@pytest.mark.slow
def test_three_vortices_have_their_moments():
    distance = "log((x{0} - x{1})^2 + (p_x{0} - p_x{1})^2)"
    energy = " + ".join(distance.format(i, j) for i, j in ("12", "13", "23"))
    system = lp.System(lp.canonical(names=("x1", "x2", "x3")), energy, name="vortices")
    found = first_integrals(system, degree=2)
    x, p = system.variables[:3], system.variables[3:]
    assert {sp.expand(f.expression) for f in found.found} >= {sum(x), sum(p)}
    assert len(found.independent) == 3  # both moments and the angular one; others are functions of these and of H
    assert found.known["H"] == system.hamiltonian
    report = lp.integrability.integrability_report(system, degree=2)
    assert (report.verdict, len(report.integrals)) == ("superintegrable", 4)


@pytest.mark.parametrize("system", [KEPLER, OTHER, lp.catalog.system("toda"), lp.catalog.system("double-pendulum")])
def test_the_equations_are_those_of_the_functions(system):
    equations, _ = algebraic_equations(system)
    point = {x: sp.Rational(k + 2, 7) for k, x in enumerate(system.variables)}
    values = {v: f.subs(point) for v, f in (equations.functions | {x: x for x in system.variables}).items()}

    def at_point(polynomial):
        return sp.N(equations.derivation.expression(polynomial).subs(values), 30)

    assert all(abs(at_point(relation)) < 1e-25 for relation in equations.relations)
    for variable, rate in zip(equations.derivation.variables, equations.derivation.components, strict=True):
        along = system.bracket(equations.functions.get(variable, variable), system.hamiltonian)
        assert abs(at_point(rate) - sp.N(along.subs(point), 30)) < 1e-25, variable


@pytest.mark.parametrize("system", [KEPLER, OTHER, lp.catalog.system("toda"), lp.catalog.system("double-pendulum")])
def test_the_relations_are_invariant(system):
    equations, _ = algebraic_equations(system)
    assert level_of(equations.derivation, equations.relations).basis


@pytest.mark.parametrize(
    ("terms", "n_functions", "n_relations"),
    [
        ("exp(x) + exp(2*x) + exp(3*x/2)", 1, 0),
        ("exp(x) + exp(-x)", 2, 1),
        ("exp(x + y) + exp(x) + exp(y)", 3, 1),
        ("exp(x + y) + exp(x - y) + exp(x) + exp(y)", 4, None),
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


def test_relations_of_exponentials_are_all_found():
    system = lp.System(PLANE, "(p_x^2 + p_y^2)/2 + exp(x + y) + exp(x - y) + exp(2*x) + exp(x)")
    known = {"zero": "exp(x + y)*exp(x - y) - exp(x)^2", "also": "exp(2*x) - exp(x)^2"}
    found = first_integrals(system, degree=2, known=known)  # both vanish, or their derivatives would not
    assert found.complete
    assert all(f.expression != 0 for f in found.found)


@pytest.mark.parametrize(
    ("potential", "words"),
    [
        ("x*log(y)", r"got log\(y\)"),
        ("exp(x^2)", "x\\*\\*2"),
        ("sin(sqrt(2)*x)", "linear forms with rational coefficients"),
        ("cos(x + 1)", "x \\+ 1"),
        ("sqrt(x + sin(y))", "sqrt"),
        ("sqrt(x) + sqrt(y) + sqrt(x*y)", "no product is a polynomial"),
        ("x^(1/3)", "linear forms"),
        ("atan(x)*y", "atan"),
    ],
)
def test_other_functions_are_refused_with_what_applies(potential, words):
    system = lp.System(PLANE, f"(p_x^2 + p_y^2)/2 + {potential}")
    with pytest.raises(ParameterError, match=words):
        first_integrals(system, degree=1)


def test_sines_of_large_multiples_of_a_form_are_refused_at_once():
    """cos(1.234 x) and cos(x) are polynomials of degrees 617 and 500 in cos(x/500)."""
    system = lp.System(PLANE, "(p_x^2 + p_y^2)/2 + cos(1.234*x) + cos(x) + y^2")
    with pytest.raises(ParameterError, match="at most 100 times a common form"):
        first_integrals(system)
