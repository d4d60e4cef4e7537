"""Polynomials on an invariant level set."""

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.integrability.derivation import derivation_of, level_of, real_points, squarefree

SYSTEM = lp.catalog.system("kovalevskaya")


def level(*texts):
    zeros = [SYSTEM.expression(text) for text in texts]
    flow, polynomials = derivation_of(SYSTEM, *zeros)
    return flow, level_of(flow, polynomials)


CASIMIRS = "l1*alpha1 + l2*alpha2 + l3*alpha3 - 1/2", "alpha1^2 + alpha2^2 + alpha3^2 - 1"


@pytest.mark.parametrize("function", ["l1^2*alpha3^3", "l1*l2*alpha1^2*alpha3^2", "1"])
def test_remainders_are_those_of_sympy(function):
    flow, where = level(*CASIMIRS)
    polynomial = derivation_of(SYSTEM, SYSTEM.expression(function))[1][0]
    remainder = flow.expression(where.remainder(polynomial))
    basis = sp.groebner([SYSTEM.expression(c) for c in CASIMIRS], *SYSTEM.variables, order="grevlex")
    assert sp.expand(remainder - basis.reduce(SYSTEM.expression(function))[1]) == 0
    assert all(where.is_standard(m) for m in where.remainder(polynomial))


@pytest.mark.parametrize(
    ("texts", "words"),
    [(("l1",), "not invariant"), (("1",), "contradict"), ((CASIMIRS[1], f"{CASIMIRS[1]} - 1"), "contradict")],
)
def test_levels_that_are_none(texts, words):
    with pytest.raises(ParameterError, match=words):
        level(*texts)


@pytest.mark.parametrize(
    ("function", "part"),
    [
        ("x^2", "x"),
        ("(x + y)^3*(x - y)", "(x + y)*(x - y)"),
        ("(x^2 - 2)^2", "x^2 - 2"),
        ("(x - sqrt(2))^2*y", "(x - sqrt(2))*y"),
        ("x*y + 1", "x*y + 1"),
    ],
)
def test_squarefree_parts(function, part):
    x, y = variables = sp.symbols("x y")
    found = squarefree(sp.sympify(function), variables)
    ratio = sp.cancel(sp.sympify(part) / found)
    assert not ratio.free_symbols & {x, y}
    assert sp.Poly(found, x, y, extension=True).is_sqf


def test_the_partial_integral_of_goryachev_and_chaplygin_on_the_same_level_written_as_a_square():
    # C1^2 = 0 is the set C1 = 0: D F = C1 G there, a multiple of C1 but not of C1^2
    system = lp.catalog.system("goryachev-chaplygin")
    search = lp.integrability.first_integrals
    wanted = search(system, degree=3, on="C1 = 0")
    for level in ("C1^2 = 0", "dot(l, alpha)^2"):
        found = search(system, degree=3, on=level)
        assert [f.expression for f in found.found] == [f.expression for f in wanted.found]
        assert len(found.found) == 1
        assert found.n_integrals == wanted.n_integrals
    family = lp.System(lp.so(3) @ lp.semidirect(2), "l1^2 + l2^2 + 4*l3^2 + a*alpha1", symbols=["a"])
    found = lp.integrability.integrable_families(family, degree=3, on="C1^2")
    assert len(found.general) == 1


def test_levels_without_real_points_are_refused():
    with pytest.raises(ParameterError, match="real points"):
        lp.integrability.first_integrals(SYSTEM, degree=2, on="C2 = -1")
    with pytest.raises(ParameterError, match="real points"):
        lp.integrability.first_integrals(SYSTEM, degree=2, on=["C1", "-3*C2 - 2"])


def test_the_real_points_of_a_sum_of_squares_are_named():
    found = lp.integrability.first_integrals(SYSTEM, degree=1, on="C2 = 0")
    assert "at its real points alpha1 = alpha2 = alpha3 = 0" in str(found)
    x, y, z = variables = sp.symbols("x y z")
    assert real_points(x**2 + y**2 * z**2 + 3 * z**4, variables) == (x, z)
    assert real_points(x**2 - y**2, variables) is None
