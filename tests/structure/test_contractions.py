"""Contractions: limits of brackets, of their Casimirs and of integrals."""

import re
import time
from random import Random

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ContractionError, ParameterError, ShapeError, TimeLimitError

contraction = lp.brackets.contraction
TWISTED = lp.so(3) @ lp.leibniz(3)
SPHERES = lp.so(3) @ (lp.trivial() + lp.trivial())


def is_casimir(bracket, function):
    return all(v == 0 for v in bracket.vector_field(function))


def test_the_twist_goes_away_as_the_last_fields_shrink():
    found = contraction(TWISTED, {"alpha": 1, "beta": 1})
    assert found.contracted.entries() == (lp.so(3) @ lp.semidirect(3)).entries()
    assert found.family.jacobi_certificate().holds
    at = found.family.substitute({"t": 1})
    assert at.entries() == TWISTED.entries()
    assert found.casimirs == tuple((lp.so(3) @ lp.semidirect(3)).casimirs())
    assert found.origins == tuple(sp.sympify(f"t^2*C{k}".replace("^", "**")) for k in (1, 2, 3))
    assert found.is_saturated
    assert found.independent == 3


def test_weights_of_fields_are_a_change_of_variables_of_the_bracket():
    found = contraction(TWISTED, [0, 1, 1])
    change = lp.brackets.Automorphism([[1, 0, 0], [0, 3, 0], [0, 0, 3]])
    assert change.is_poisson(TWISTED, found.family.substitute({"t": 3}))
    assert not change.is_poisson(TWISTED, found.family.substitute({"t": 2}))


def test_two_spheres_become_the_heavy_top_and_their_casimirs_stay_independent():
    """so(4) to se(3): both Casimirs begin with |alpha|^2, and their difference gives l.alpha."""
    found = contraction(SPHERES, matrix=[[1, 1], [0, "t"]])
    assert found.contracted.entries() == (lp.so(3) @ lp.semidirect(2)).entries()
    dot = sum(sp.Symbol(f"l{k}") * sp.Symbol(f"alpha{k}") for k in (1, 2, 3))
    norm = sum(sp.Symbol(f"alpha{k}") ** 2 for k in (1, 2, 3))
    assert found.casimirs == (sp.expand(-2 * dot), norm)
    C1, C2, t = sp.symbols("C1 C2 t")
    assert found.origins == (sp.expand(t * (C1 - C2)), t**2 * C2)
    assert found.independent == 2
    assert all(is_casimir(found.contracted, c) for c in found.casimirs)


def test_origins_say_what_the_limits_are_limits_of():
    """Insert the Casimirs in the new variables: what is left at t = 0 is the limit."""
    found = contraction(SPHERES, matrix=[[1, 1], [0, "t"]])
    t = sp.Symbol("t")
    old, new = SPHERES.fields, found.contracted.fields
    values = {}
    for k in range(3):
        values[old["l"][k]] = new["l"][k] - new["alpha"][k] / t
        values[old["alpha"][k]] = new["alpha"][k] / t
    inner = {sp.Symbol(f"C{k + 1}"): c.subs(values, simultaneous=True) for k, c in enumerate(SPHERES.casimirs())}
    for origin, limit in zip(found.origins, found.casimirs, strict=True):
        assert sp.expand(sp.expand(origin.subs(inner)).subs(t, 0) - limit) == 0


def test_components_of_the_lie_algebra_contract_too():
    """Inonu and Wigner: so(3) to se(2)."""
    found = contraction(lp.so(3) @ lp.trivial(), algebra_weights=[1, 1, 0])
    assert found.contracted.algebra.derived_series()[-1].dimension == 0
    assert found.contracted.algebra.is_solvable
    l1, l2 = sp.symbols("l1 l2")
    assert found.casimirs == (l1**2 + l2**2,)
    assert is_casimir(found.contracted, found.casimirs[0])
    assert not is_casimir(found.contracted, found.bracket.casimirs()[0])


def test_a_growing_factor_is_met_by_a_vanishing_one():
    """Powers of A and of g add up: here t^-1 and t, so that the limit is neither abelian nor infinite."""
    bracket = lp.so(3) @ lp.Extension.from_products(2, {(0, 0): {1: 1}})
    found = contraction(bracket, [0, 1], algebra_weights=[1, 1, 1])
    assert found.contracted.entries() == bracket.entries()
    vanishing = contraction(bracket, [1, 1], algebra_weights=[1, 1, 1])
    assert vanishing.contracted.entries() == ()


def test_integrals_have_limits_in_involution():
    """Those of the twisted Lagrange top go to those of the charged one: l3 and l.alpha + a twist that shrinks."""
    l, alpha, beta = (TWISTED.fields[name] for name in ("l", "alpha", "beta"))
    P = l.dot(alpha) + beta[2]
    H = l.dot(l) / 2 + alpha[2]
    assert TWISTED(H, P) == 0
    found = contraction(TWISTED, [0, 1, 1], integrals=[l[2], P])
    assert found.integrals[0] == l[2]
    assert found.independent == 5
    assert found.contracted(*found.integrals) == 0
    assert sp.expand(found.integrals[1] - l.dot(alpha) - beta[2]) == 0


def test_a_constant_part_scales_with_both_of_its_fields():
    bracket = (lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): "k"})
    found = contraction(bracket, algebra_weights=[1, 1, 0])
    assert found.contracted.constant == {}
    k, t = sp.symbols("k t")
    assert found.family.constant == {(0, 1): k * t**2}


def test_what_has_no_limit_is_refused():
    with pytest.raises(ContractionError, match=re.escape("got e_1 e_1 along e_2 like t^-1")) as caught:
        contraction(TWISTED, {"beta": 1})
    assert caught.value.power == -1
    with pytest.raises(ContractionError, match=re.escape("[1, 2] along 3 like t^-1")):
        contraction(TWISTED, algebra_weights=[0, 0, 1])
    plane = lp.so(3) @ lp.Extension.from_products(1, {})  # no products at all, but a constant part
    with pytest.raises(ContractionError, match="the constant part of l1 and l2 like t\\^-1"):
        contraction(plane.with_constant({("l1", "l2"): 1}), algebra_weights=[-1, 0, 0])


def test_refusals():
    with pytest.raises(ParameterError, match="wanted a Bracket"):
        contraction(lp.leibniz(3), [0, 1, 1])
    with pytest.raises(ShapeError, match="weights must be 3 integers"):
        contraction(TWISTED, [0, 1])
    with pytest.raises(ParameterError, match="wanted integers"):
        contraction(TWISTED, [0, 0.5, 1])
    with pytest.raises(ParameterError, match="wanted integers from -1000 to 1000"):
        contraction(TWISTED, [0, 1, 5 * 10**7])
    with pytest.raises(ParameterError, match="wanted the names l, alpha, beta"):
        contraction(TWISTED, {"gamma": 1})
    with pytest.raises(ParameterError, match="weights or a matrix; got both"):
        contraction(TWISTED, [0, 1, 1], matrix=[[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    with pytest.raises(ParameterError, match="determinant of 0"):
        contraction(SPHERES, matrix=[[1, 1], ["t", "t"]])
    with pytest.raises(ShapeError, match="one row per field"):
        contraction(SPHERES, matrix=[[1, 1]])
    with pytest.raises(ParameterError, match="rational functions of t"):
        contraction(SPHERES, matrix=[[1, 1], [0, "sqrt(t)"]])
    with pytest.raises(ParameterError, match="wanted a name that nothing has yet"):
        contraction(TWISTED, [0, 1, 1], parameter="l1")
    with pytest.raises(ParameterError, match="got alpha, a coordinate or field"):
        contraction(SPHERES, matrix=[[1, 1], [0, "alpha*t"]])
    with pytest.raises(ParameterError, match="wanted polynomials in the coordinates"):
        contraction(TWISTED, [0, 1, 1], integrals=[1 / TWISTED.variables[0]])


def test_a_contraction_by_a_dense_matrix_keeps_its_limit():
    """Entries of degree two in t, eight fields: the inverse has entries of degree fourteen, with long coefficients."""
    draw = Random(1)
    rows = [[sum(draw.randint(-3, 3) * sp.Symbol("t") ** k for k in range(3)) for _ in range(8)] for _ in range(8)]
    began = time.process_time()
    with pytest.raises(TimeLimitError):
        contraction(lp.so(3) @ lp.leibniz(8), matrix=rows, time_limit=0.5)
    assert time.process_time() - began < 2.2


def test_a_matrix_of_sympy_is_a_matrix():
    rows = [[1, 1], [0, sp.Symbol("t")]]
    assert contraction(SPHERES, matrix=sp.Matrix(rows)).casimirs == contraction(SPHERES, matrix=rows).casimirs
