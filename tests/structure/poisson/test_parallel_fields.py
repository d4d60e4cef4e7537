import pytest
import sympy as sp

from liepoisson.structure.extensions import leibniz, semidirect
from liepoisson.structure.lie_algebras import so
from liepoisson.structure.poisson.parallel_fields import casimirs_on_parallel_fields, vanish_on_parallel_fields
from liepoisson.structure.poisson.pfaffians import PfaffianIdeal
from liepoisson.structure.poisson.polynomials import expression_of

ALPHA, BETA = (3, 4, 5), (6, 7, 8)


def test_cross_products_vanish_on_parallel_fields_and_scalar_products_do_not():
    one = (so(3) @ semidirect(3)).tensor.field.one
    cross = [{(3, 7): one, (4, 6): -one}, {(4, 8): one, (5, 7): -one}]
    scalar = {(3, 6): one, (4, 7): one, (5, 8): one}
    assert vanish_on_parallel_fields(cross, (ALPHA, BETA))
    assert not vanish_on_parallel_fields([*cross, scalar], (ALPHA, BETA))
    assert not vanish_on_parallel_fields([{(0, 7): one, (1, 6): -one}], (ALPHA, BETA))


def test_the_rank_of_the_charged_top_drops_on_parallel_fields_and_that_of_the_twisted_top_does_not():
    charged, twisted = (so(3) @ semidirect(3)).tensor, (so(3) @ leibniz(3)).tensor
    assert vanish_on_parallel_fields(PfaffianIdeal(charged, 6, 3).generators, (ALPHA, BETA))
    assert not vanish_on_parallel_fields(PfaffianIdeal(charged, 4, 3).generators, (ALPHA, BETA))
    assert not vanish_on_parallel_fields(PfaffianIdeal(twisted, 6, 3).generators, (ALPHA, BETA))


@pytest.mark.parametrize("extension", [semidirect(3), leibniz(3)])
def test_casimirs_there_are_constant_there(extension):
    bracket = so(3) @ extension
    _, alpha, beta = bracket.fields.values()
    s, t, *n = sp.symbols("s t n1:4")
    parallel = dict(zip((*alpha, *beta), (*(s * c for c in n), *(t * c for c in n)), strict=True))
    found = [
        expression_of(p, bracket.variables, bracket.tensor.field)
        for p in casimirs_on_parallel_fields(bracket.tensor, (ALPHA, BETA))
    ]
    for casimir in found:
        assert {sp.expand(value.subs(parallel)) for value in bracket.vector_field(casimir)} == {0}


def test_the_charged_top_has_five_quadratic_casimirs_there():
    # l.alpha = s l.n and l.beta = t l.n beside s^2, s t, t^2 times n.n; alpha_1 beta_2 - alpha_2 beta_1 = 0 is none.
    bracket = so(3) @ semidirect(3)
    l, alpha, beta = bracket.fields.values()
    found = {
        expression_of(p, bracket.variables, bracket.tensor.field)
        for p in casimirs_on_parallel_fields(bracket.tensor, (ALPHA, BETA))
    }
    assert found == {l.dot(alpha), l.dot(beta), alpha.dot(alpha), alpha.dot(beta), beta.dot(beta)}
