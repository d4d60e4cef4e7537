"""The constants v, w, eta of a leaf and its Casimirs determine each other."""

from fractions import Fraction

import pytest
from sympy import symbols

import liepoisson as lp
from liepoisson.model.charts.leaf_constants import LeafConstants

TOP = lp.Top.twisted_kovalevskaya()


@pytest.mark.parametrize("values", [(Fraction(17, 10), Fraction(-3, 4), Fraction(9, 4)), (-2, 3, 5)])
def test_casimirs_lead_to_the_constants_and_back(values):
    """v = C2/w, w = sqrt(C3), eta = C1 - v^2."""
    given = dict(zip(("C1", "C2", "C3"), values, strict=True))
    leaf = LeafConstants.of(TOP, TOP.top_parameters, None, given)
    assert leaf.casimirs == values
    v, w, eta = symbols("v w eta")
    assert LeafConstants(1, v, w, eta).casimirs == (eta + v**2, v * w, w**2)
