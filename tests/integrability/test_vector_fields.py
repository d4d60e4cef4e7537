"""Integrals, Darboux polynomials and Painlevé's test of vector fields without a bracket: the answers of the literature.

Lorenz's cases with an invariant surface are those of Llibre and Zhang, Invariant algebraic surfaces of the Lorenz
system, J. Math. Phys. 43 (2002); those that pass Painlevé's test are of Segur (1982); Lotka and Volterra's of three
species that of Grammaticos, Moulin Ollagnier, Ramani, Strelcyn and Wojciechowski (1990).
"""

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ParameterError

darboux_polynomials = lp.integrability.darboux_polynomials
first_integrals = lp.integrability.first_integrals
x, y, z = sp.symbols("x y z")


def lorenz(sigma, rho, beta):
    rates = {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"}
    return lp.VectorField(rates, {"sigma": sigma, "rho": rho, "beta": beta}, name="Lorenz")


def check(found):
    """What was found is what it is said to be, also along an orbit."""
    rate = lambda f: sum(sp.diff(f, v) * e for v, e in found.system.equations.items())  # noqa: E731
    for p in found.found:
        assert sp.expand(rate(p.expression) - p.cofactor * p.expression) == 0
    for r in found.rational_integrals:
        assert sp.cancel(sp.together(rate(r.expression))) == 0
    for e in found.time_dependent_integrals:
        total = sp.diff(e.expression, e.time) + rate(e.expression)
        assert sp.simplify(total / e.expression) == 0


def test_the_integrals_of_rabinovich_for_all_couplings():
    """Two of degree two where nothing is damped, of which all others are polynomials, up to degree five."""
    field = lp.VectorField({"x": "h*y + y*z", "y": "h*x - x*z", "z": "x*y"}, symbols=["h"], name="Rabinovich")
    found = first_integrals(field, degree=5)
    h = sp.Symbol("h")
    assert found.complete
    assert found.parameters == ("h",)
    first, second = (f.expression for f in found.found)
    known = [x**2 + y**2 - 4 * h * z, x**2 - y**2 - 2 * z**2]
    span = sp.Matrix([[sp.Poly(f, x, y, z).coeff_monomial(m) for m in (x**2, y**2, z**2, z)] for f in (first, second)])
    both = sp.Matrix([[sp.Poly(f, x, y, z).coeff_monomial(m) for m in (x**2, y**2, z**2, z)] for f in known])
    assert span.rank() == span.col_join(both).rank() == 2
    assert [f.is_independent for f in found.found] == [True, True]


SURFACES = [
    ((3, 5, 6), x**2 - 6 * z, -6),
    (("1/2", 5, 1), x**2 - z, -1),
    ((3, 0, 1), y**2 + z**2, -2),
    ((1, 3, 1), 3 * x**2 - y**2 - z**2, -2),
    ((1, 3, 4), x**4 - 4 * x**2 * z - 12 * x**2 + 8 * x * y - 4 * y**2 + 32 * z, -4),
    (("1/3", 2, 0), 27 * x**4 - 36 * x**2 * z - 24 * x * y - 12 * y**2 + 72 * x**2, sp.Rational(-4, 3)),
    ((2, 3, 10), x**4 - 8 * x**2 * z - 16 * y**2 + 48 * x * y - 36 * x**2, -8),
]
"""Parameters sigma, rho, beta; the polynomial; its cofactor."""


@pytest.mark.thorough
@pytest.mark.parametrize(("parameters", "surface", "cofactor"), SURFACES)
def test_invariant_surfaces_of_lorenz(parameters, surface, cofactor):
    """Each has a constant cofactor c, and so an integral of the time, surface times exp(-c t)."""
    system = lorenz(*parameters)
    rate = sum(sp.diff(surface, v) * e for v, e in zip((x, y, z), system.equations.values(), strict=True))
    assert sp.expand(rate - cofactor * surface) == 0  # as the literature says
    found = darboux_polynomials(system, degree=sp.Poly(surface, x, y, z).total_degree())
    check(found)
    assert found.complete
    (integral,) = found.time_dependent_integrals
    assert integral.rate == cofactor
    assert sp.expand(sp.cancel(integral.expression / sp.exp(-cofactor * integral.time) / surface)).is_number
    start = [0.4, -0.3, 0.7]
    run = lp.integrate(system, start, t_end=2)
    along = sp.lambdify([x, y, z, integral.time], integral.expression)(*run.state[0].T, run.time)
    assert np.allclose(along, along[0], rtol=1e-11)


@pytest.mark.thorough
def test_lorenz_has_no_invariant_surface_at_the_usual_parameters():
    found = darboux_polynomials(lorenz(10, 28, "8/3"), degree=3)
    assert (found.found, found.complete) == ((), True)
    none = first_integrals(lorenz(10, 28, "8/3"), degree=6)
    assert (none.found, none.known, none.complete) == ((), {}, True)


def test_a_scan_counts_the_integrals_of_each_coupling():
    """x' = y z, y' = k x z, z' = x y has two integrals for each k; with a damping d only where it vanishes."""
    rates = {"x": "y*z - d*x", "y": "k*x*z - d*y", "z": "x*y - d*z"}
    field = lp.VectorField(rates, symbols=["k", "d"])
    scan = lp.integrability.scan_integrals(field, axes={"k": [-1, 2], "d": [0, 1]}, degree=2)
    assert scan.complete
    assert scan.n_further.reshape(2, 2).tolist() == [[2, 0], [2, 0]]


@pytest.mark.thorough
def test_a_damped_rabinovich_system_has_an_integral_of_the_time():
    """With all dampings equal to 1 and h = 0 both squares decay together: cofactor -2."""
    field = lp.VectorField({"x": "y*z - x", "y": "-x*z - y", "z": "x*y - z"})
    found = darboux_polynomials(field, degree=2)
    check(found)
    assert found.complete
    assert not first_integrals(field, degree=4).found
    assert {e.rate for e in found.time_dependent_integrals} == {-2}
    assert [e.is_independent for e in found.time_dependent_integrals] == [True, False, False]
    (ratio,) = (r.expression for r in found.rational_integrals if r.is_independent)
    assert not ratio.is_polynomial(x, y, z)


@pytest.mark.thorough
def test_lotka_and_volterra_of_three_species():
    """x' = x (C y + z) and cyclic: the axes are invariant, and if A B C = -1 there is a linear integral."""
    rates = {"x": "x*(C*y + z)", "y": "y*(x + A*z)", "z": "z*(B*x + y)"}
    field = lp.VectorField(rates, {"A": 2, "B": 3, "C": "-1/6"}, name="Lotka-Volterra")
    found = darboux_polynomials(field, degree=2)
    check(found)
    assert found.complete
    assert {p.expression for p in found.found} == {x, y, z, 6 * x + y - 2 * z}
    assert {r.is_polynomial for r in found.rational_integrals} == {True, False}  # the linear one, and a product of axes
    (linear,) = first_integrals(field, degree=3).found
    assert linear.expression == 6 * x + y - 2 * z
    other = lp.VectorField(rates, {"A": 2, "B": 3, "C": "1/6"})
    assert not first_integrals(other, degree=3).found
    assert {p.expression for p in darboux_polynomials(other, degree=2).found} == {x, y, z}


def test_hamiltonian_equations_have_their_hamiltonian_among_the_integrals():
    """Henon and Heiles' system, and one of the integrable ones beside it, whose second integral is quartic."""
    rates = {"x": "p", "y": "q", "p": "-x - 2*x*y", "q": "-y - x^2 - c*y^2"}
    generic = first_integrals(lp.VectorField(rates, symbols=["c"]), degree=4)
    (H,) = generic.found
    p, q, c = sp.symbols("p q c")
    energy = (p**2 + q**2 + x**2 + y**2) / 2 + x**2 * y + c * y**3 / 3
    assert sp.expand(sp.cancel(H.expression / energy)).free_symbols <= {c}
    assert generic.complete
    kdv = first_integrals(lp.VectorField(rates, {"c": 6}), degree=4)
    assert [f.degree for f in kdv.found] == [3, 4]
    system = lp.System(lp.canonical(names=["x", "y"], momenta=["p", "q"]), "(p^2 + q^2 + x^2 + y^2)/2 + x^2*y + 2*y^3")
    assert [f.degree for f in first_integrals(system, degree=4).found] == [4]  # H is known there


def test_what_is_known_is_not_looked_for_and_levels_are_levels():
    field = lp.VectorField({"x": "y*z", "y": "-2*x*z", "z": "x*y"})
    found = first_integrals(field, degree=2, known={"E": "2*x^2 + y^2"})
    (other,) = found.found
    assert sp.expand(field.derivative(other.expression)) == 0
    with pytest.raises(ParameterError, match="known: wanted integrals; got E"):
        first_integrals(field, degree=2, known={"E": "x^2 + y^2"})
    on_level = first_integrals(field, degree=2, on="2*x^2 + y^2 = 1")
    assert len(on_level.found) == 1
    with pytest.raises(ParameterError, match="on: wanted a level set that orbits do not leave"):
        first_integrals(field, degree=2, on="x = 1")


@pytest.mark.parametrize(
    ("parameters", "verdict"),
    [(("1/2", 0, 1), "passes"), ((1, "1/9", 2), "passes"), (("1/3", 2, 0), "passes"), ((10, 28, "8/3"), "fails")],
)
def test_the_cases_of_lorenz_that_pass_painleves_test(parameters, verdict):
    found = lp.integrability.painleve_test(lorenz(*parameters))
    assert (found.verdict, found.complete) == (verdict, True)


def test_names_of_what_is_found_are_no_coordinates():
    field = lp.VectorField({"P1": "P1*(E1 - 1)", "E1": "E1*(1 - P1)", "R1": "2*R1"})
    found = darboux_polynomials(field, degree=1, known={})
    groups = (found.found, found.rational_integrals, found.time_dependent_integrals)
    names = [one.name for group in groups for one in group]
    assert len(found.found) == 3
    assert len(found.time_dependent_integrals) > 0
    assert not {*names} & {*field.component_names}
    assert len({*names}) == len(names)
