"""Families: the classical conditions, completely."""

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


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ParameterError, match="symbols for parameters"):
        integrable_families(lp.catalog.system("kovalevskaya"))
    with pytest.raises(ParameterError, match="wanted names of"):
        integrable_families(heavy_top(), positive=["I1"])
    with pytest.raises(ParameterError, match="take a smaller one"):
        integrable_families(heavy_top(), degree=30)


def test_a_limit_of_time_leaves_cases():
    found = integrable_families(heavy_top(), degree=2, positive=["J1", "J2", "J3"], time_limit=1e-9)
    assert not found.complete
    assert "incomplete" in str(found)
