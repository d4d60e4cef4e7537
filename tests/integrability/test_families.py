"""Families: the classical conditions, completely."""

import re

import pytest
from sympy import Rational, Symbol, expand, symbols, sympify

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
        pytest.param(4, (EULER, SPHERICAL, *LAGRANGE, *KOVALEVSKAYA), marks=pytest.mark.thorough),
    ],
)
def test_the_general_heavy_top(degree, cases):
    """J_i = 1/I_i: up to degree 4 the tops of Euler, Lagrange (about each axis) and Kovalevskaya, and the spherical."""
    found = integrable_families(heavy_top(), degree=degree, positive=["J1", "J2", "J3"])
    assert found.complete
    assert sets(found) == as_sets(*cases)
    assert all(case.integrals for case in found.cases)


def test_the_diagonal_kirchhoff_hamiltonian_gives_the_condition_of_clebsch():
    """(c2 - c3)/a1 + (c3 - c1)/a2 + (c1 - c2)/a3 = 0."""
    system = lp.System(
        lp.so(3) @ lp.semidirect(2),
        "(a1*l1^2 + a2*l2^2 + a3*l3^2)/2 + (c1*alpha1^2 + c2*alpha2^2 + c3*alpha3^2)/2",
        symbols=["a1", "a2", "a3", "c1", "c2", "c3"],
    )
    found = integrable_families(system, degree=2, positive=["a1", "a2", "a3"])
    a1, a2, a3, c1, c2, c3 = symbols("a1:4 c1:4")
    (case,) = found.cases
    clebsch = expand(a1 * a2 * a3 * ((c2 - c3) / a1 + (c3 - c1) / a2 + (c1 - c2) / a3))
    assert found.complete
    assert case.conditions[0] in (clebsch, -clebsch)
    assert len(case.conditions) == 1
    assert case.integrals


def test_the_diagonal_hamiltonian_on_so4_gives_the_condition_of_manakov():
    """One cubic, which b_ij = (p_i - p_j)/(J_i - J_j) solves; besides, two rigid bodies: b12 = b34 and so on."""
    base = lp.catalog.system("manakov-so4")
    names = [f"b{v.name[1:]}" for v in base.variables]
    terms = " + ".join(f"{b}*{v}^2/2" for b, v in zip(names, base.variables, strict=True))
    found = integrable_families(lp.System(base.bracket, terms, symbols=names), degree=2, positive=names)
    assert found.complete
    by_size = sorted(found.cases, key=lambda case: len(case.conditions))
    assert [len(case.conditions) for case in by_size] == [1, 3]
    p, j = (3, 5, -2, 7), (1, 2, 4, 9)
    manakov = {
        Symbol(f"b{i}{k}"): Rational(p[i - 1] - p[k - 1], j[i - 1] - j[k - 1])
        for i in range(1, 5)
        for k in range(i + 1, 5)
    }
    assert by_size[0].conditions[0].xreplace(manakov) == 0
    assert {frozenset(by_size[1].conditions)} == as_sets("b12 - b34, b13 - b24, b14 - b23")


GORYACHEV_CHAPLYGIN = ("a3, J1 - J2, 4*J1 - J3", "a2, J1 - J3, 4*J1 - J2", "a1, J1 - 4*J2, J1 - 4*J3")


def test_a_level_has_the_top_of_goryachev_and_chaplygin_besides():
    """I1 = I2 = 4 I3 and a3 = 0, about each axis: a cubic integral on l.alpha = 0 alone (Chaplygin 1901)."""
    found = integrable_families(heavy_top(), degree=3, on="C1 = 0", positive=["J1", "J2", "J3"])
    assert found.complete
    assert sets(found) == as_sets(EULER, SPHERICAL, *LAGRANGE, *GORYACHEV_CHAPLYGIN)
    cubic = next(case for case in found.cases if frozenset(case.conditions) in as_sets(GORYACHEV_CHAPLYGIN[0]))
    # l3 (l1^2 + l2^2) - (alpha3/J3') (a1 l1 + a2 l2), up to a factor, with the scale of the example
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


def test_scalings_are_those_of_the_level():
    """A central z: on z = c the coefficient of l1^2 is c, and two equal ones give a linear integral."""
    brackets = {(0, 1): {2: 1}, (1, 2): {0: 1}, (2, 0): {1: 1}}
    algebra = lp.LieAlgebra.from_brackets(4, brackets, basis_names=["l1", "l2", "l3", "z"])
    bracket = lp.Bracket(algebra, lp.trivial().rename("x"))
    l1, l2, l3, z = bracket.variables
    b, c, d = symbols("b c d")
    system = lp.System(bracket, z * l1**2 + b * l2**2 + d * l3**2, symbols=["b", "c", "d"])
    found = integrable_families(system, degree=1, on=[z - c], nonzero=["b", "c", "d"])
    assert found.complete
    assert sets(found) == as_sets("b - c", "c - d", "b - d")


def test_levels_with_parameters():
    """On l.alpha = c with c generic there is no integral of Goryachev and Chaplygin."""
    e3 = lp.so(3) @ lp.semidirect(2)
    top = lp.System(e3, "(l1^2 + l2^2 + J*l3^2)/2 + c*alpha1 + alpha2", symbols=["J", "c"])
    found = integrable_families(top, degree=3, on="C1 = c", positive=["J"])
    assert found.complete
    # J = 4 needs c = 0, and J = 1 is the spherical top
    assert sets(found) == as_sets("J - 1", "c, J - 4")
    with pytest.raises(ParameterError, match="several without parameters"):
        integrable_families(top, degree=1, on=["C1 = c", "C2 = 1"])
    with pytest.raises(ParameterError, match="not invariant"):
        integrable_families(top, degree=1, on="l1 = c")


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


def test_casimirs_in_the_hamiltonian_change_no_condition():
    found = integrable_families(box(), degree=2, positive=["h11", "h22", "h33"])
    for case in found.cases:
        shifted = dict(case.example)
        for name in ("h14", "h25", "h36"):
            shifted[Symbol(name)] += 3
        for name in ("h44", "h55", "h66"):
            shifted[Symbol(name)] -= 5
        assert all(c.xreplace(shifted) == 0 for c in case.conditions)


def test_modulo_casimirs_there_are_the_same_cases():
    """The bodies of revolution about each axis among them: h14 = h44 = 0, what is left of h14 = h36 and h44 = h66."""
    reduced = box(modulo_casimirs=True)
    assert len(reduced.hamiltonian.free_symbols - set(reduced.variables)) == 7
    whole = integrable_families(box(), degree=2, positive=["h11", "h22", "h33"])
    found = integrable_families(reduced, degree=2, positive=["h11", "h22", "h33"])
    assert found.complete
    for case in whole.cases:
        at = dict(case.example)
        for first, *others in (("h14", "h25", "h36"), ("h44", "h55", "h66")):
            shift = at.pop(Symbol(first))
            at |= {Symbol(name): at[Symbol(name)] - shift for name in others}
        assert any(all(c.xreplace(at) == 0 for c in other.conditions) for other in found.cases), case


def test_so4_from_its_symmetry():
    """Changes of sign of each axis leave squares alone; Manakov's condition for any signs, and two rigid bodies."""
    bracket = lp.so(4) @ lp.trivial()
    names = [str(v) for v in bracket.variables]
    signs = [{v: f"-{v}" for v in names if str(axis) in v} for axis in range(1, 5)]
    system = lp.integrability.general_system(bracket, symmetries=signs)
    assert system.hamiltonian == sum(Symbol(f"h{k}{k}") * v**2 for k, v in enumerate(bracket.variables, start=1))
    found = integrable_families(system, degree=2)
    assert found.complete
    assert sorted(len(case.conditions) for case in found.cases) == [1, 3]
    assert as_sets("h11 - h66, h22 - h55, h33 - h44") <= sets(found)


def test_powers_of_h_are_no_further_integrals_where_its_degree_drops():
    # where J = 0 the square of H has degree two
    body = lp.System(lp.so(3) @ lp.trivial(), "l3 + J*(l1^2 + 2*l2^2)", symbols=["J"])
    assert "never" in str(integrable_families(body, degree=2))
    # a scattering potential of degree 4, cubic at a = 0: H^2 has degree 6
    potential = "q1^2 + 3*q2^2 + q1^2*q2 + 5*q2^3 + q1^3 + a*(q1^4 + 7*q1^2*q2^2 + q1*q2^3)"
    family = lp.System(lp.canonical(2), f"p1^2/2 + p2^2/2 + {potential}", symbols=["a"])
    assert "never" in str(integrable_families(family, degree=6))
    # H itself, at b = 0 and a multiple of a l3 - 4 l2
    body = lp.System(lp.so(3) @ lp.trivial(), "a*l3 + (b^2 - 4)*l2 + b^2*l1*l2", symbols=["a", "b"])
    assert not any(case.holds_at({"a": 1, "b": 0}) for case in integrable_families(body, degree=1).cases)


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


def test_where_the_integral_of_a_case_becomes_h_it_is_excepted():
    # l3 is no polynomial in H = b l3^2 + c l3 at a = 0, but at b = 0, unless c = 0, too
    body = lp.System(lp.so(3) @ lp.trivial(), "a*l1^2 + b*l3^2 + c*l3", symbols=["a", "b", "c"])
    found = integrable_families(body, degree=1)
    assert found.complete
    holds = lambda **at: any(case.holds_at(at) for case in found.cases)  # noqa: E731
    assert holds(a=0, b=1, c=1)
    assert holds(a=0, b=1, c=0)
    assert not holds(a=0, b=0, c=1)
    assert holds(a=0, b=0, c=0)
    assert "a = 0, where b is not 0" in str(found)


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


def test_separable_cases_show_the_integral():
    family = lp.System(lp.canonical(2), "p1^2/2 + p2^2/2 + q1^4 + 3*q2^2 + c*q1^2*q2", symbols=["c"])
    (case,) = integrable_families(family, degree=2).cases
    assert [str(c) for c in case.conditions] == ["c"]
    assert len(case.integrals) == 1


def test_functions_of_the_known_integrals_are_not_shown_as_new():
    # a free symmetric body: l3 is constant, and a root of a sum of H and |l|^2
    body = lp.System(lp.so(3) @ lp.trivial(), "(l1^2 + l2^2 + 3*l3^2)/2 + a*l1", symbols=["a"])
    (case,) = integrable_families(body, degree=1).cases
    assert (str(case.conditions[0]), case.integrals) == ("a", ())
    assert (case.is_independent, case.remark) == (False, "a function of the known ones")
    assert case.remark in str(case)


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


@pytest.mark.parametrize("number", ["exp(a)", "log(6)", "sqrt(2)", "pi", "sin(1)^2 + cos(1)^2", "sqrt(a)"])
def test_other_numbers_than_rational_ones_are_named(number):
    """They are no free parameters: log(6) = log(2) + log(3), exp(a) is never zero."""
    body = lp.System(lp.so(3) @ lp.semidirect(2), f"({number})*l1^2 + l2^2 + J*l3^2 + a*alpha3", symbols=["J", "a"])
    named = "cos(1), sin(1)" if "sin" in number else number
    with pytest.raises(ParameterError, match=f"got {re.escape(named)} in"):
        integrable_families(body, degree=1)


def test_a_limit_of_time_leaves_cases():
    found = integrable_families(heavy_top(), degree=2, positive=["J1", "J2", "J3"], time_limit=1e-9)
    assert not found.complete
    assert "incomplete" in str(found)
    assert "incomplete" in repr(found)
    assert "never" not in str(found)
    assert "all parameters" in found.left
