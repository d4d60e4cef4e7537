"""Numbers with square roots: zeros of quadratic polynomials, and the fields that they generate."""

from fractions import Fraction

import pytest
import sympy as sp

from liepoisson.algebra.coefficients import quadratic_roots, square_root_element, square_root_field


@pytest.mark.parametrize(
    "coefficients", [(1, 0, -2), (1, 1, 1), (3, -2, 7), (Fraction(2, 3), 1, Fraction(-5, 7)), (1, 0, 12)]
)
def test_zeros_of_a_quadratic_polynomial(coefficients):
    x = sp.Symbol("x")
    a, b, c = map(Fraction, coefficients)
    for root in quadratic_roots(a, b, c):
        assert (
            sp.expand(
                sum(sp.Rational(k.numerator, k.denominator) * x**n for n, k in enumerate((c, b, a))).subs(x, root)
            )
            == 0
        )
    assert len(set(quadratic_roots(a, b, c))) == 2


@pytest.mark.parametrize(
    ("values", "degree"),
    [
        ([sp.Rational(1, 2)], 1),
        ([sp.sqrt(2)], 2),
        ([sp.sqrt(2), 1 + sp.sqrt(8)], 2),
        ([sp.sqrt(2), sp.sqrt(3), sp.sqrt(6)], 4),
        ([2 * sp.I, sp.sqrt(-12), sp.sqrt(3)], 4),
        ([sp.I, sp.sqrt(2), sp.sqrt(3)], 8),
    ],
)
def test_fields_have_no_superfluous_roots(values, degree):
    field = square_root_field(values)
    assert (1 if field.is_rational else len(field.domain.mod.to_list()) - 1) == degree
    for value in values:
        image = square_root_element(value, field)
        assert sp.expand(field.to_sympy(image) - value) == 0
        assert sp.expand(field.to_sympy(image * image) - value**2) == 0
