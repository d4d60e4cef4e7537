"""Long numbers are written as decimals, exactly, with a power of ten instead of many zeros."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from liepoisson.formula.styles import LATEX, PLAIN, UNICODE
from liepoisson.report.decimals import Decimal
from liepoisson.report.printing import Formula


@given(st.integers(-(10**20), 10**20), st.integers(-340, 340))
def test_decimals_are_exact(mantissa, exponent):
    value = Fraction(mantissa) * Fraction(10) ** exponent
    written = Decimal.of(value)
    assert written is not None
    assert Fraction(written.write(PLAIN)) == value
    assert len(written.write(PLAIN)) < 30


def test_a_third_is_no_decimal():
    assert Decimal.of(Fraction(1, 3)) is None


@pytest.mark.parametrize(
    ("value", "style", "text"),
    [
        (10**200, PLAIN, "1e200*x"),
        (sp.Rational(15, 10**321), PLAIN, "1.5e-320*x"),
        (sp.Rational(15, 10**321), UNICODE, "1.5·10⁻³²⁰ x"),
        (10**200, LATEX, "10^{200} x"),
        (sp.Rational(1, 3 * 10**20), PLAIN, "1e-20*x/3"),
        (sp.Rational(1, 1024), PLAIN, "x/1024"),
    ],
)
def test_long_coefficients_of_formulas(value, style, text):
    assert Formula(value * sp.Symbol("x")).write(style) == text
