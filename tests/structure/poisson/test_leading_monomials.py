from itertools import combinations_with_replacement

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.structure.extensions import leibniz
from liepoisson.structure.lie_algebras import so
from liepoisson.structure.poisson.casimir_search import CasimirSearch
from liepoisson.structure.poisson.leading_monomials import leading, monic, place, size

L1, L2, ALPHA1, ALPHA2, BETA1, BETA2 = 0, 1, 3, 4, 6, 7


def test_late_fields_are_large_and_first_coordinates_are():
    falling = [(BETA1, BETA1), (BETA2, BETA2), (ALPHA1, BETA1), (ALPHA1, ALPHA1), (ALPHA2, ALPHA2), (L1, BETA1)]
    assert sorted(falling, key=lambda m: size(m, 3), reverse=True) == falling
    assert leading({(L1, BETA1): 2, (ALPHA1, ALPHA1): 1, (ALPHA2, ALPHA2): 1}, 3) == (ALPHA1, ALPHA1)


def test_with_one_field_the_first_coordinates_decide():
    assert leading([(0, 3), (0, 0), (2, 2)], 6) == (0, 0)
    assert sorted([(1, 1), (0, 5), (0, 0)], key=lambda m: place(m, 6)) == [(0, 0), (0, 5), (1, 1)]


@settings(max_examples=30)
@given(st.integers(1, 3), st.integers(1, 3), st.integers(1, 4))
def test_the_order_is_total(block, fields, degree):
    monomials = list(combinations_with_replacement(range(block * fields), degree))
    assert len({size(m, block) for m in monomials}) == len({place(m, block) for m in monomials}) == len(monomials)


@pytest.mark.thorough
def test_bases_are_reduced_at_their_leading_monomials():
    search = CasimirSearch((so(3) @ leibniz(4, "epsilon")).tensor)
    basis = search.of_degree(4)
    leads = [leading(polynomial, 3) for polynomial in basis]
    assert len(set(leads)) == len(basis) == 10
    one = search.tensor.field.one
    for k, polynomial in enumerate(basis):
        assert [polynomial.get(m) for m in leads] == [one if j == k else None for j in range(len(basis))]
        assert monic({m: c * 7 for m, c in polynomial.items()}, 3) == polynomial
