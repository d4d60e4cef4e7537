from itertools import combinations

import pytest
import sympy as sp

from liepoisson.structure.extensions import leibniz, semidirect
from liepoisson.structure.lie_algebras import so
from liepoisson.structure.poisson.pfaffians import PfaffianIdeal
from liepoisson.structure.poisson.polynomials import expression_of


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


def test_powers_of_beta_are_pfaffians_only_with_a_twist():
    one = (so(3) @ leibniz(3)).tensor.field.one
    beta = [{(i,): one} for i in (6, 7, 8)]
    assert PfaffianIdeal((so(3) @ leibniz(3)).tensor, 6, 3).contains_powers_of(beta) == ""
    assert PfaffianIdeal((so(3) @ semidirect(3)).tensor, 6, 3).contains_powers_of(beta) is None


def test_the_assumption_on_parameters_is_named():
    tensor = (so(3) @ leibniz(3, "epsilon")).tensor
    beta = [{(i,): tensor.field.one} for i in (6, 7, 8)]
    assert PfaffianIdeal(tensor, 6, 3).contains_powers_of(beta) == "epsilon != 0"


def test_many_coordinates_leave_the_blocks_with_two_components_of_every_field():
    tensor = (so(3) @ leibniz(4)).tensor  # twelve coordinates
    largest = PfaffianIdeal(tensor, 8, 3)
    assert not largest.is_full
    # J of x1, x2 of four fields is an arrangement of third components: each Pfaffian is a polynomial in these alone
    assert [{i % 3 for p in (g,) for monomial in p for i in monomial} for g in largest.generators] == [{0}, {1}, {2}]
    assert PfaffianIdeal(tensor, 6, 3).generators == []
