from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.structure.extensions import leibniz, semidirect, trivial
from liepoisson.structure.lie_algebras import se, sine, so, su
from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor

# Brackets and the ranks of their generic leaves: dimension minus number of Casimirs.
RANKS = {
    "free rigid body": (so(3) @ trivial(), 2),
    "heavy top": (so(3) @ semidirect(2), 4),
    "twisted top": (so(3) @ leibniz(3, "epsilon"), 6),
    "underwater vehicle": (se(3) @ trivial(), 4),
    "su(3)": (su(3) @ trivial(), 6),
    "Zeitlin's fluid on su(3)": (sine(3) @ trivial(), 6),
}


def dense(rows):
    return sp.Matrix(len(rows), len(rows), lambda i, j: sp.sympify(rows[i].get(j, 0)))


@pytest.mark.thorough
@settings(deadline=None, max_examples=20, derandomize=True)
@given(st.lists(st.fractions(-3, 3, max_denominator=5), min_size=6, max_size=6))
def test_the_matrix_at_a_point_is_that_of_sympy(point):
    bracket = so(3) @ semidirect(2)
    substituted = bracket.poisson_tensor().subs(dict(zip(bracket.variables, map(sp.sympify, point), strict=True)))
    assert dense(bracket.tensor.at(point)) == substituted


@pytest.mark.parametrize(("bracket", "rank"), RANKS.values(), ids=RANKS)
def test_the_rank_at_a_point_is_that_of_the_generic_leaf(bracket, rank):
    assert bracket.tensor.generic_rank.rank == bracket.tensor.rank_at_a_point == rank
    assert len(bracket.tensor.generic_rank.point) == bracket.dimension


def test_the_rank_is_found_without_images_modulo_primes():
    # x' = (a log(2) + sqrt(a)) y: a field that SymPy only simplifies in.
    a = sp.Symbol("a", positive=True)
    c = a * sp.log(2) + sp.sqrt(a)
    tensor = LinearPoissonTensor.of(3, [(0, 1, 2, c), (1, 0, 2, -c)])
    assert tensor.generic_rank is None
    assert tensor.rank_at_a_point == 2


def test_terms_that_vanish_are_dropped_and_the_others_given_back():
    terms = [(0, 1, 2, Fraction(3)), (1, 0, 2, Fraction(-3)), (0, 2, 1, Fraction(0))]
    tensor = LinearPoissonTensor.of(3, terms)
    assert sorted(tensor.terms()) == terms[:2]


def test_where_beta_vanishes_the_twisted_top_is_a_heavy_top():
    twisted, heavy = (so(3) @ leibniz(3)).tensor, (so(3) @ semidirect(2)).tensor
    assert twisted.restricted(range(6)).rows == heavy.rows
    # The coordinates (l, beta) have the same brackets; in another order they do not.
    assert twisted.restricted([0, 1, 2, 6, 7, 8]).rows == heavy.rows
    assert twisted.restricted([6, 7, 8, 0, 1, 2]).rows != heavy.rows
