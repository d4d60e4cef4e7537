from itertools import combinations_with_replacement

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.structure.extensions import leibniz, trivial
from liepoisson.structure.lie_algebras import se, sl, so
from liepoisson.structure.poisson.casimir_search import CasimirSearch, n_independent, products_of_degree
from liepoisson.structure.poisson.polynomials import expression_of, multiply

BRACKETS = {"twisted": so(3) @ leibniz(3), "se(3)": se(3) @ trivial(), "sl(2)": sl(2) @ leibniz(2)}


@pytest.mark.thorough
@settings(deadline=None, max_examples=25, derandomize=True)
@given(st.sampled_from(sorted(BRACKETS)), st.data())
def test_images_are_j_grad_c(name, data):
    bracket = BRACKETS[name]
    search, field = CasimirSearch(bracket.tensor), bracket.tensor.field
    monomials = list(combinations_with_replacement(range(bracket.dimension), 2))
    drawn = data.draw(st.dictionaries(st.sampled_from(monomials), st.integers(1, 5), min_size=1, max_size=4))
    images = [sp.S.Zero] * bracket.dimension
    for (i, monomial), c in search.image({m: field.number(c) for m, c in drawn.items()}).items():
        images[i] += field.to_sympy(c) * sp.Mul(*(bracket.variables[k] for k in monomial))
    C = sum((c * bracket.variables[i] * bracket.variables[j] for (i, j), c in drawn.items()), sp.S.Zero)
    assert [sp.expand(value) for value in images] == list(bracket.vector_field(C))


@pytest.mark.thorough
def test_blocks_by_weight_lose_nothing():
    # One system with all quadratic monomials at once, solved by SymPy.
    for bracket in BRACKETS.values():
        x = bracket.variables
        monomials = [a * b for a, b in combinations_with_replacement(x, 2)]
        images = [[sp.Poly(v, *x) for v in bracket.vector_field(m)] for m in monomials]
        keys = sorted({(i, p) for image in images for i, v in enumerate(image) for p in v.monoms()})
        matrix = sp.Matrix([[image[i].coeff_monomial(p) for image in images] for i, p in keys])
        assert len(CasimirSearch(bracket.tensor).of_degree(2)) == len(monomials) - matrix.rank()


def test_products_and_new_generators():
    bracket = so(3) @ leibniz(2)
    search = CasimirSearch(bracket.tensor)
    quadratic = [(2, p) for p in search.of_degree(2)]
    products = list(products_of_degree(quadratic, 4))
    assert len(products) == 3
    assert search.new_generators(search.of_degree(4), products) == []
    assert len(search.new_generators(search.of_degree(4), products[:2])) == 1
    assert not list(products_of_degree(quadratic, 2))


def test_multiplication():
    bracket = so(3) @ trivial()
    one = bracket.tensor.field.one
    total = multiply({(0,): one, (1,): one}, {(0,): one, (1,): -one})
    x = bracket.variables
    assert expression_of(total, bracket.variables, bracket.tensor.field) == x[0] ** 2 - x[1] ** 2


def test_independence_is_not_linear_independence():
    bracket = so(3) @ leibniz(2)
    first, second = CasimirSearch(bracket.tensor).of_degree(2)
    assert n_independent([first, second, multiply(first, second)], bracket.tensor) == 2
