from itertools import combinations

import pytest
import sympy as sp

from liepoisson.structure.extensions import leibniz, semidirect
from liepoisson.structure.lie_algebras import so
from liepoisson.structure.poisson.parallel_fields import casimirs_on_parallel_fields, vanish_on_parallel_fields
from liepoisson.structure.poisson.pfaffians import PfaffianIdeal
from liepoisson.structure.poisson.polynomials import expression_of

CHARGED, TWISTED = so(3) @ semidirect(3), so(3) @ leibniz(3, "epsilon")
ALPHA, BETA = (3, 4, 5), (6, 7, 8)


@pytest.mark.parametrize("size", [2, 4])
def test_squares_of_pfaffians_are_principal_minors(size):
    bracket = so(3) @ leibniz(2)
    J = bracket.poisson_tensor()
    minors = {J.extract(list(r), list(r)).det().expand() for r in combinations(range(6), size)} - {0}
    pfaffians = PfaffianIdeal(bracket.tensor, size, 3).generators
    # Up to a factor, in which generators of an ideal are free.
    squares = {
        sp.Poly(expression_of(p, bracket.variables, bracket.tensor.field) ** 2).primitive()[1].as_expr()
        for p in pfaffians
    }
    assert squares == {sp.Poly(minor).primitive()[1].as_expr() for minor in minors}


@pytest.mark.parametrize(
    ("bracket", "assumption"), [(so(3) @ leibniz(3), ""), (CHARGED, None), (TWISTED, "epsilon != 0")]
)
def test_powers_of_beta_are_pfaffians_only_with_a_twist(bracket, assumption):
    beta = [{(i,): bracket.tensor.field.one} for i in BETA]
    assert PfaffianIdeal(bracket.tensor, 6, 3).contains_powers_of(beta) == assumption


def test_many_coordinates_leave_the_blocks_with_two_components_of_every_field():
    tensor = (so(3) @ leibniz(4)).tensor  # twelve coordinates
    largest = PfaffianIdeal(tensor, 8, 3)
    assert not largest.is_full
    # J of x1, x2 of four fields is an arrangement of third components: each Pfaffian is a polynomial in these alone
    assert [{i % 3 for monomial in g for i in monomial} for g in largest.generators] == [{0}, {1}, {2}]
    assert PfaffianIdeal(tensor, 6, 3).generators == []


def test_the_rank_of_the_charged_top_drops_on_parallel_fields_and_that_of_the_twisted_top_does_not():
    assert vanish_on_parallel_fields(PfaffianIdeal(CHARGED.tensor, 6, 3).generators, (ALPHA, BETA))
    assert not vanish_on_parallel_fields(PfaffianIdeal(CHARGED.tensor, 4, 3).generators, (ALPHA, BETA))
    assert not vanish_on_parallel_fields(PfaffianIdeal(TWISTED.tensor, 6, 3).generators, (ALPHA, BETA))


def test_the_charged_top_has_five_quadratic_casimirs_there():
    """l.alpha = s l.n and l.beta = t l.n beside those of alpha, beta; alpha_1 beta_2 - alpha_2 beta_1 = 0 is none."""
    l, alpha, beta = CHARGED.fields.values()
    polynomials = casimirs_on_parallel_fields(CHARGED.tensor, (ALPHA, BETA))
    found = {expression_of(p, CHARGED.variables, CHARGED.tensor.field) for p in polynomials}
    assert found == {l.dot(alpha), l.dot(beta), alpha.dot(alpha), alpha.dot(beta), beta.dot(beta)}
