from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from liepoisson.algebra.exact_numbers import as_float, exceeds_sum, is_negative, is_zero
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.parameters import read_parameter, read_vector


@pytest.mark.parametrize(
    ("given", "read"),
    [
        (2, Fraction(2)),
        (np.int64(-3), Fraction(-3)),
        (0.1, Fraction(1, 10)),
        (np.float64(0.1), Fraction(1, 10)),
        (np.float32(0.1), Fraction(1, 10)),
        (1e-3, Fraction(1, 1000)),
        (Fraction(2, 3), Fraction(2, 3)),
        ("1/3", Fraction(1, 3)),
        (" -0.25 ", Fraction(-1, 4)),
        ("1e2", Fraction(100)),
        (sp.Rational(5, 7), Fraction(5, 7)),
        (sp.Integer(4), Fraction(4)),
        (sp.Float("0.1"), Fraction(1, 10)),
        ("(1 + 2)/9", Fraction(1, 3)),
        ("exp(1)/2", sp.E / 2),
        ("epsilon", sp.Symbol("epsilon")),
        ("sqrt(2)*k*m/3", sp.sqrt(2) * sp.Symbol("k") * sp.Symbol("m") / 3),
        (sp.sqrt(2), sp.sqrt(2)),
    ],
)
def test_parameters_are_read_exactly(given, read):
    result = read_parameter(given, "p")
    assert result == read
    assert isinstance(result, Fraction if isinstance(read, Fraction) else sp.Expr)


VECTOR = "(a1, a2, a3)"


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        *((lambda bad=bad: read_parameter(bad, "mass"), ParameterError, "^mass must be .*got") for bad in (
            float("nan"), float("inf"), np.float64("-inf"), "nan", "1/0", "", "2*inf", "-nan", "2*sin", "x[1]",
            "__import__('os')", np.timedelta64(1, "s"), "9" * 300, "1e999999999", None, True, 1j, sp.nan, sp.oo, sp.I,
            [1], object(), sp.Matrix([1]))),
        *((lambda bad=bad: read_parameter(bad, "x"), ParameterError, r'Write for example .*"sqrt\(2\)"')
          for bad in ("sqrt(-1)", "sqrt(2", "dot(1, 2)", "abs(-1)")),
        *((lambda bad=bad: read_vector(bad, "a", VECTOR), ShapeError, r"a must be 3 numbers \(a1, a2, a3\); got")
          for bad in ((1, 2), (1, 2, 3, 4), [], 5, "abc", None, {1: 2, 2: 3, 3: 4}, np.eye(3), [[1], [2], [3]])),
        (lambda: read_vector((float("nan"), 0, 0), "a", VECTOR), ParameterError, "^a1 must be"),
        (lambda: read_vector((1, 2, "1/0"), "inertia", "(I1, I2, I3)"), ParameterError, "^I3 must be"),
        (lambda: as_float(2 * sp.Symbol("kappa"), "epsilon"), ParameterError, "epsilon must be .*free symbol kappa"),
        (lambda: as_float(Fraction(10) ** 400, "a[0]"), ParameterError, "double"),
    ],
)  # fmt: skip
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_questions_about_symbols_are_answered_only_when_decided():
    x, y = sp.symbols("x y")
    assert is_zero((x + 1) ** 2 - x**2 - 2 * x - 1)
    assert is_zero(sp.sqrt(2) ** 2 - 2)
    assert not is_zero(x)
    assert not is_negative(x)
    assert is_negative(-sp.sqrt(2))
    assert exceeds_sum(x + y + 1, x, y)
    assert not exceeds_sum(x, y, y)
    assert exceeds_sum(Fraction(3), Fraction(1), Fraction(1))


@pytest.mark.parametrize(
    "number",
    [
        sp.cos(sp.pi / 7) - sp.cos(2 * sp.pi / 7) + sp.cos(3 * sp.pi / 7) - sp.Rational(1, 2),
        sp.sqrt(2) * sp.sqrt(3) - sp.sqrt(6),
        sp.sin(1) ** 2 + sp.cos(1) ** 2 - 1,
        sp.sqrt(sp.sin(1) ** 2 + sp.cos(1) ** 2 - 1),
    ],
)
def test_coefficients_that_vanish_without_showing_it_are_zero(number):
    x, y = sp.symbols("x y")
    assert is_zero(number)
    assert is_zero(number * x + number * x * y**2)
    assert not is_zero(number * x + y)
    assert not is_zero(number + sp.Rational(1, 10**20))
