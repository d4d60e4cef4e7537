"""Cofactors: which monomials they can have, and all of those that occur."""

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.integrability.cofactors import CofactorCases, cofactor_monomials
from liepoisson.integrability.derivation import Level, derivation_of, gradings, of_degree, order


def cases_of(hamiltonian, field="complex"):
    system = lp.System(lp.canonical(1), hamiltonian)
    derivation, _ = derivation_of(system)
    return derivation, CofactorCases(derivation, Level(), [(0, 0), (1, 0), (0, 1)], field)


def block(degree):
    return sorted((m for k in range(degree + 1) for m in of_degree(2, k)), key=order, reverse=True)


def test_monomials_are_bounded_by_the_terms_of_the_equations():
    """Alpha and beta of a top can have weight 2, so that cofactors have l alone."""
    top = lp.Top(inertia=(2, 3, 5), a=(1, 2, 3), b=(3, -1, 2), epsilon=1)
    derivation, _ = derivation_of(top)
    assert [sum(m[:3]) for m in cofactor_monomials(derivation, gradings(derivation), Level())] == [1, 1, 1]
    derivation, _ = derivation_of(lp.System(lp.canonical(1), "q1*p1 + p1^3"))
    # q' = q + 3 p^2, p' = -p: 1 is a shift, and neither q nor p lies between 1 and p^2/q
    assert cofactor_monomials(derivation, (), Level()) == [(0, 0)]


@pytest.mark.parametrize(
    ("hamiltonian", "field", "values"),
    [
        # p' = -q and q' = p: q + i p and its powers, and 1
        ("(p1^2 + q1^2)/2", "complex", {0, sp.I, -sp.I, 2 * sp.I, -2 * sp.I}),
        ("(p1^2 + q1^2)/2", "real", {0}),
        ("(p1^2 - 2*q1^2)/2", "complex", {0, sp.sqrt(2), -sp.sqrt(2), 2 * sp.sqrt(2), -2 * sp.sqrt(2)}),
        ("(p1^2 - 2*q1^2)/2", "real", {0, sp.sqrt(2), -sp.sqrt(2), 2 * sp.sqrt(2), -2 * sp.sqrt(2)}),
        ("(p1^2 - 2*q1^2)/2", "rational", {0}),
        ("(p1^2 - 4*q1^2)/2", "rational", {0, 2, -2, 4, -4}),
    ],
)
def test_an_oscillator(hamiltonian, field, values):
    _, cases = cases_of(hamiltonian, field)
    found = cases.candidates(block(2))
    assert {value[0] for value in found} == values
    assert {value[1:] for value in found} == {(0, 0)}
    assert not cases.left


def test_eigenvalues_that_are_no_square_roots_are_left():
    """q1'' = 2 q2 and q2'' = -q1 have four linear Darboux polynomials, whose cofactors are the fourth roots of -2."""
    system = lp.System(lp.canonical(2), "p1*p2 + q1^2/2 - q2^2")
    found = lp.integrability.darboux_polynomials(system, degree=1)
    x = sp.Symbol("x")
    matrix = sp.Matrix([system.equations[v] for v in system.variables]).jacobian(system.variables)
    assert not found.complete
    (left,) = found.left
    quartic = sp.sympify(left.split(", ")[-1].removesuffix(" = 0").replace("^", "**")).subs("k_0", x)
    assert sp.expand(matrix.charpoly(x).as_expr() - quartic) == 0
