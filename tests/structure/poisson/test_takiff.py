import pytest
import sympy as sp

from liepoisson.structure.extensions import crmhd, leibniz, semidirect
from liepoisson.structure.lie_algebras import so, su
from liepoisson.structure.poisson.casimir_search import CasimirSearch
from liepoisson.structure.poisson.polynomials import expression_of
from liepoisson.structure.poisson.takiff import leibniz_strength, lifted


@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_lifts_of_the_scalar_product_are_the_convolutions(n):
    # C_k = sum_{i+j = n-2+k} x_i.x_j, with epsilon for the terms with x_0 (n > 2); half of it for odd n + k.
    epsilon = sp.Symbol("epsilon") if n > 2 else sp.S.One
    bracket = so(3) @ leibniz(n, "epsilon")
    x, field = list(bracket.fields.values()), bracket.tensor.field
    one = field.one
    strength = field.read(epsilon) if n > 2 else one
    for k, lift in enumerate(lifted({(i, i): one for i in range(3)}, 3, n, strength), start=1):
        pairs = [(i, n - 2 + k - i) for i in range(n) if n - 2 + k - i < n]
        whole = sum((x[i].dot(x[j]) * (epsilon if 0 in (i, j) else 1) for i, j in pairs), sp.S.Zero)
        expected = whole / 2 if (n + k) % 2 else whole
        assert sp.expand(expression_of(lift, bracket.variables, bracket.tensor.field) - expected) == 0


def test_lifts_of_a_cubic_are_casimirs():
    base, bracket = su(3) @ leibniz(1), su(3) @ leibniz(3, 2)
    (cubic,) = CasimirSearch(base.tensor).of_degree(3)
    field = bracket.tensor.field
    search = CasimirSearch(bracket.tensor)
    assert not any(search.image(lift) for lift in lifted(cubic, 8, 3, field.number(2)))
    # With another strength the first of them is none.
    assert search.image(lifted(cubic, 8, 3, field.number(3))[0])


def test_leibniz_algebras_are_recognised_by_their_products():
    assert leibniz_strength(leibniz(3, "epsilon")) == sp.Symbol("epsilon")
    assert leibniz_strength(leibniz(2)) == 1
    assert leibniz_strength(semidirect(4)) == 0
    assert leibniz_strength(crmhd(1)) is None
