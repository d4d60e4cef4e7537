from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from liepoisson.algebra.exact_numbers import as_float, exceeds_sum, is_negative, is_zero
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.parameters import read_parameter, read_vector

# Text that would fill the memory, and things that are not real numbers.
HARMFUL = ("9" * 300, "1e999999999", None, True, 1j, sp.nan, sp.oo, sp.I, [1], object(), sp.Matrix([1]))


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
        ("epsilon", sp.Symbol("epsilon")),
        ("2*epsilon", 2 * sp.Symbol("epsilon")),
        ("-m", -sp.Symbol("m")),
        ("sqrt(2)*k*m/3", sp.sqrt(2) * sp.Symbol("k") * sp.Symbol("m") / 3),
        (sp.sqrt(2), sp.sqrt(2)),
    ],
)
def test_parameters_are_read_exactly(given, read):
    result = read_parameter(given, "p")
    assert result == read
    assert isinstance(result, Fraction if isinstance(read, Fraction) else sp.Expr)


@pytest.mark.parametrize(
    "bad",
    [
        float("nan"),
        float("inf"),
        np.float64("-inf"),
        "nan",
        "inf",
        "1/0",
        "",
        "2*inf",
        "-nan",
        "2*sin",
        "x[1]",
        "__import__('os')",
        np.timedelta64(1, "s"),
        *HARMFUL,
    ],
)
def test_what_is_not_a_finite_number_or_name_is_refused(bad):
    with pytest.raises(ParameterError, match=r"^mass must be .*got"):
        read_parameter(bad, "mass")


@pytest.mark.parametrize(
    "bad", [(1, 2), (1, 2, 3, 4), [], 5, "abc", None, {1: 2, 2: 3, 3: 4}, np.eye(3), [[1], [2], [3]]]
)
def test_a_vector_has_three_components(bad):
    with pytest.raises(ShapeError, match=r"a must be 3 numbers \(a1, a2, a3\); got"):
        read_vector(bad, "a", "(a1, a2, a3)")


def test_a_component_is_called_as_it_is_written():
    with pytest.raises(ParameterError, match=r"^a1 must be"):
        read_vector((float("nan"), 0, 0), "a", "(a1, a2, a3)")
    with pytest.raises(ParameterError, match=r"^I3 must be"):
        read_vector((1, 2, "1/0"), "inertia", "(I1, I2, I3)")


def test_sequences_of_every_kind_are_vectors():
    expected = (Fraction(1), Fraction(1, 2), Fraction(3))
    for given in ([1, 0.5, 3], (1, "1/2", 3), np.array([1, 0.5, 3]), sp.Matrix([1, sp.Rational(1, 2), 3])):
        assert read_vector(given, "a", "(a1, a2, a3)") == expected


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


def sines(n):
    """A polynomial in n variables with coefficients that are products of sin(k pi / 7)."""
    x = sp.symbols(f"x1:{n + 1}")
    return sum(
        sp.sin((j + 1) * sp.pi / 7) * sp.sqrt(k + 2) / sp.pi * x[j] * x[k] ** 2 for j in range(n) for k in range(n)
    )


def test_a_polynomial_that_does_not_vanish_is_not_simplified(monkeypatch):
    """`simplify` takes minutes for a derivative of a Zeitlin system."""

    def refused(*_):
        raise AssertionError("simplify was called")

    monkeypatch.setattr(sp, "simplify", refused)
    monkeypatch.setattr(sp.Expr, "equals", refused)
    x, y = sp.symbols("x y")
    tiny = sp.sqrt(2) - sp.Rational(14142135623730950488016887, 10**25)
    for value in (x + y, (x + y) ** 6 - x**6, sines(6), tiny * x, tiny, sp.sqrt(2) + sp.sin(1)):
        assert not is_zero(value)
    assert is_zero((x + y) ** 2 - x**2 - 2 * x * y - y**2)


@pytest.mark.thorough
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


@pytest.mark.thorough
def test_what_is_no_polynomial_is_simplified():
    x, y = sp.symbols("x y")
    assert is_zero(1 / (x + y) - (x - y) / (x**2 - y**2))
    assert is_zero(sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1)
    assert not is_zero(1 / (x + y) - 1 / (x - y))


def test_a_symbolic_parameter_has_no_float_and_is_named():
    with pytest.raises(ParameterError, match=r"epsilon must be a number.*free symbol kappa"):
        as_float(2 * sp.Symbol("kappa"), "epsilon")
    with pytest.raises(ParameterError, match="double"):
        as_float(Fraction(10) ** 400, "a[0]")
    assert as_float(sp.sqrt(2), "a[0]") == np.sqrt(2)


def test_a_formula_is_exact():
    for text in ("sqrt(2)", "sqrt(2)/2", "pi", "exp(1)", "2*(1/3)", "-sqrt(3)"):
        assert read_parameter(text, "x") == sp.sympify(text)
    assert read_parameter("(1 + 2)/9", "x") == Fraction(1, 3)
    for text in ("2*sin", "sqrt(-1)", "sqrt(2", "dot(1, 2)", "abs(-1)"):
        with pytest.raises(ParameterError, match=r'Write for example .*"sqrt\(2\)"'):
            read_parameter(text, "x")
