from itertools import combinations_with_replacement

import sympy as sp

from liepoisson.structure.extensions import leibniz, trivial
from liepoisson.structure.lie_algebras import se, sl, so
from liepoisson.structure.poisson.casimir_search import CasimirSearch, n_independent, products_of_degree
from liepoisson.structure.poisson.polynomials import multiply

BRACKETS = {"twisted": so(3) @ leibniz(3), "se(3)": se(3) @ trivial(), "sl(2)": sl(2) @ leibniz(2)}


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
    first, second = (p for _, p in quadratic)
    assert n_independent([first, second, multiply(first, second)], bracket.tensor) == 2
