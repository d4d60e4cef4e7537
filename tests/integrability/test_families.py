"""Families: the classical conditions, completely."""

import re

import pytest
from sympy import Rational, Symbol, sympify

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability.families import integrable_families


def heavy_top():
    return lp.System(
        lp.so(3) @ lp.semidirect(2),
        "(J1*l1^2 + J2*l2^2 + J3*l3^2)/2 + a1*alpha1 + a2*alpha2 + a3*alpha3",
        symbols=["J1", "J2", "J3", "a1", "a2", "a3"],
    )


def sets(found):
    return {frozenset(case.conditions) for case in found.cases}


def as_sets(*texts):
    return {frozenset(sympify(text) for text in case.split(",")) for case in texts}


EULER = "a1, a2, a3"
SPHERICAL = "J1 - J2, J1 - J3"
LAGRANGE = ("a2, a3, J2 - J3", "a1, a3, J1 - J3", "a1, a2, J1 - J2")
KOVALEVSKAYA = ("a3, 2*J1 - J3, J1 - J2", "a2, 2*J1 - J2, J1 - J3", "a1, J1 - 2*J3, J1 - 2*J2")


@pytest.mark.parametrize(
    ("degree", "cases"),
    [
        (1, (SPHERICAL, *LAGRANGE)),
        (2, (EULER, SPHERICAL, *LAGRANGE)),
        pytest.param(4, (EULER, SPHERICAL, *LAGRANGE, *KOVALEVSKAYA), marks=pytest.mark.slow),
    ],
)
def test_the_general_heavy_top(degree, cases):
    """J_i = 1/I_i: up to degree 4 the tops of Euler, Lagrange (about each axis) and Kovalevskaya, and the spherical."""
    found = integrable_families(heavy_top(), degree=degree, positive=["J1", "J2", "J3"])
    assert found.complete
    assert sets(found) == as_sets(*cases)
    assert all(case.integrals for case in found.cases)


GORYACHEV_CHAPLYGIN = ("a3, J1 - J2, 4*J1 - J3", "a2, J1 - J3, 4*J1 - J2", "a1, J1 - 4*J2, J1 - 4*J3")


def test_a_level_has_the_top_of_goryachev_and_chaplygin_besides():
    """I1 = I2 = 4 I3 and a3 = 0, about each axis: a cubic integral on l.alpha = 0 alone (Chaplygin 1901)."""
    found = integrable_families(heavy_top(), degree=3, on="C1 = 0", positive=["J1", "J2", "J3"])
    assert found.complete
    assert sets(found) == as_sets(EULER, SPHERICAL, *LAGRANGE, *GORYACHEV_CHAPLYGIN)
    cubic = next(case for case in found.cases if frozenset(case.conditions) in as_sets(GORYACHEV_CHAPLYGIN[0]))
    (integral,) = cubic.integrals
    member = heavy_top().hamiltonian.xreplace(cubic.example)
    system = lp.System(heavy_top().bracket, member)
    remainder = sympify(str(system.derivative(integral))).subs(system_level(system))
    assert remainder.expand() == 0
    assert system.derivative(integral).expand() != 0
    assert "on alpha1*l1 + alpha2*l2 + alpha3*l3 = 0" in str(found)


def system_level(system):
    """l1 from l.alpha = 0, with l1 alpha1 for the rest."""
    l1, l2, l3, a1, a2, a3 = (Symbol(str(v)) for v in system.variables)
    return {l1: -(l2 * a2 + l3 * a3) / a1}


KIRCHHOFF = ("h11 - h22, h14 - h25, h44 - h55", "h22 - h33, h25 - h36, h55 - h66", "h11 - h33, h14 - h36, h44 - h66")


def test_all_quadratic_hamiltonians_on_e3_with_the_symmetry_of_a_box():
    """H = sum h_ii m_i^2 + h_i,i+3 m_i p_i + h_i+3,i+3 p_i^2: Kirchhoff, Clebsch, Steklov, Lyapunov, and no other case.

    A. V. Borisov and I. S. Mamaev, Rigid Body Dynamics (2001), section 3.1.
    """
    system = box()
    assert system.hamiltonian == sympify("h11*m1**2 + h22*m2**2 + h33*m3**2 + h14*m1*p1 + h25*m2*p2 + h36*m3*p3"
                                         "+ h44*p1**2 + h55*p2**2 + h66*p3**2")  # fmt: skip
    found = integrable_families(system, degree=2, positive=["h11", "h22", "h33"])
    assert found.complete
    assert all(case.integrals for case in found.cases)
    assert as_sets(*KIRCHHOFF) <= sets(found)
    assert len(found.cases) == 7
    # h_ii = a_i/2, h_i,i+3 = -mu a1 a2 a3/a_i + nu, h_i+3,i+3 = mu^2 a_i (a_j - a_k)^2/2 + nu', as in the catalog
    a, mu, nu, shift = (2, 3, 7), Rational(5, 3), 4, 11
    steklov = values(
        [Rational(c, 2) for c in a],
        [-mu * a[(k + 1) % 3] * a[(k + 2) % 3] + nu for k in range(3)],
        [mu**2 * a[k] * (a[(k + 1) % 3] - a[(k + 2) % 3]) ** 2 / 2 + shift for k in range(3)],
    )
    # h_ii = 1/2, h_i,i+3 = mu a_i + nu, h_i+3,i+3 = mu^2 (a_j - a_k)^2/2 + nu'
    lyapunov = values(
        [Rational(1, 2)] * 3,
        [mu * c + nu for c in a],
        [mu**2 * (a[(k + 1) % 3] - a[(k + 2) % 3]) ** 2 / 2 + shift for k in range(3)],
    )
    # (c2 - c3)/a1 + (c3 - c1)/a2 + (c1 - c2)/a3 = 0
    clebsch = values(a, [nu] * 3, [5, 8, Rational(80, 7)])
    for member in (steklov, lyapunov, clebsch):
        assert sum(case.holds_at(member) for case in found.cases) == 1
        assert not any(case.holds_at(member | {"h44": 13}) for case in found.cases)


def box(**options):
    turns = [{"m1": "-m1", "m2": "-m2", "p1": "-p1", "p2": "-p2"}, {"m2": "-m2", "m3": "-m3", "p2": "-p2", "p3": "-p3"}]
    e3 = lp.so(3) @ lp.semidirect(2).rename("m", "p")
    return lp.integrability.general_system(e3, symmetries=turns, **options)


def values(*rows):
    names = ("h11", "h22", "h33", "h14", "h25", "h36", "h44", "h55", "h66")
    return dict(zip(names, (value for row in rows for value in row), strict=True))


def test_polynomials_in_h_and_the_casimirs_whose_highest_terms_cancel_are_no_further_integrals():
    """At equal moments k.l = H - a C1/2; at two equal ones, with k along the axis, l3 is new."""
    body = lp.System(
        lp.so(3) @ lp.trivial(),
        "(a1*l1^2 + a2*l2^2 + a3*l3^2)/2 + k1*l1 + k2*l2 + k3*l3",
        symbols=["a1", "a2", "a3", "k1", "k2", "k3"],
    )
    for degree in (1, 2):
        found = integrable_families(body, degree=degree, positive=["a1", "a2", "a3"])
        equal = {"a1": 1, "a2": 1, "a3": 1, "k1": 1, "k2": -2, "k3": 5}
        assert found.complete
        assert not any(case.holds_at(equal) for case in found.cases)
        axial = {"a1": 1, "a2": 1, "a3": 3, "k1": 0, "k2": 0, "k3": 5}
        assert any(case.holds_at(axial) for case in found.cases)


def test_integrals_that_there_are_for_all_parameters_are_not_listed_again():
    top = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2 + J*l3^2)/2 + a*alpha3", symbols=["J", "a"])
    found = integrable_families(top, degree=2)
    assert [str(f) for f in found.general] == ["l3"]
    assert sets(found) == as_sets("a, J - 1")
    assert [str(f) in ("l1", "l2") for f in found.cases[0].integrals] == [True]
    assert found.cases[0].holds_at({"a": 0, "J": "1"})
    assert not found.cases[0].holds_at({"a": "1/1000", "J": 1})
    with pytest.raises(ParameterError, match="got none for J"):
        found.cases[0].holds_at({"a": 0})


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ParameterError, match="symbols for parameters"):
        integrable_families(lp.catalog.system("kovalevskaya"))
    with pytest.raises(ParameterError, match=r"^positive: wanted names of .*; got .I1.$"):
        integrable_families(heavy_top(), positive=["I1"])
    with pytest.raises(ParameterError, match=r"^nonzero: wanted names of .*; got .zz.$"):
        integrable_families(heavy_top(), nonzero=["zz"])
    with pytest.raises(ParameterError, match="take a smaller one"):
        integrable_families(heavy_top(), degree=30)


@pytest.mark.parametrize("number", ["exp(a)", "log(6)", "sqrt(2)"])
def test_other_numbers_than_rational_ones_are_named(number):
    """They are no free parameters: log(6) = log(2) + log(3), exp(a) is never zero."""
    body = lp.System(lp.so(3) @ lp.semidirect(2), f"({number})*l1^2 + l2^2 + J*l3^2 + a*alpha3", symbols=["J", "a"])
    with pytest.raises(ParameterError, match=f"got {re.escape(number)} in"):
        integrable_families(body, degree=1)


def test_casimirs_of_special_parameters_do_not_count():
    """The extension is a semidirect product at epsilon = 0, with two more Casimirs; inside of it l3 is an integral."""
    bracket = lp.so(3) @ lp.leibniz(4, "epsilon")
    x = [str(v) for v in bracket.variables]
    linear = f"{x[3]} + 2*{x[4]} + 3*{x[5]} + {x[6]} - {x[7]} + 2*{x[8]} - 3*{x[9]} + {x[10]} + 5*{x[11]}"
    family = lp.System(bracket, f"({x[0]}^2 + 2*{x[1]}^2 + 3*{x[2]}^2)/2 + {linear}", symbols=["epsilon"])
    found = integrable_families(family, degree=2)
    assert found.complete
    assert not found.cases
    (casimirs,) = found.casimirs
    assert str(casimirs.conditions[0]) == "epsilon"
    assert len(casimirs.casimirs) > len(bracket.casimirs())
    assert "more Casimirs, which do not count, if epsilon = 0" in str(found)
    inside = lp.System(bracket, f"({x[0]}^2 + {x[1]}^2 + J*{x[2]}^2)/2 + {x[5]} + 2*{x[8]}", symbols=["epsilon", "J"])
    found = integrable_families(inside, degree=1)
    assert [str(f) for f in found.general] == [x[2]]


def test_integrals_for_all_parameters_have_no_denominators():
    """b l2/a + l1 is none at a = 0; a l1 + b l2 is."""
    top = lp.System(lp.so(3) @ lp.semidirect(2), "dot(l, l)/2 + a*l1 + b*l2", symbols=["a", "b"])
    assert [str(f) for f in lp.integrability.integrable_families(top, degree=1).general] == ["a*l1 + b*l2"]
