"""Rows of a report: not longer than the page, broken where a reader would break them, nothing lost."""

import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from liepoisson.formula.styles import PLAIN, UNICODE
from liepoisson.report.lines import Column, Equation, Name
from liepoisson.report.printing import Formula
from liepoisson.report.wrapping import breakable, wrapped

x = sp.symbols("x1:13")


def rows(formula, width=30, style=PLAIN):
    return wrapped((formula,), style, width)


def test_sums_are_broken_before_signs():
    assert rows(Equation(Name("H"), Formula(sp.Add(*x[:6])))) == ["H = x1 + x2 + x3 + x4 + x5", "    + x6"]


def test_products_are_not_broken():
    product = Formula(x[0] * x[1] * x[2] + x[3] * x[4] * x[5] * x[6])
    assert wrapped((product,), UNICODE, 20) == ["x₁ x₂ x₃", "    + x₄ x₅ x₆ x₇"]


def test_parentheses_are_broken_only_if_they_must_and_between_components_first():
    square = Formula((x[0] + x[1]) ** 2 + (x[2] + x[3]) ** 2)
    assert rows(square, 20) == ["(x1 + x2)^2", "    + (x3 + x4)^2"]
    column = Column((Formula(x[0] + x[1]), Formula(x[2] + x[3]), Formula(x[4])))
    assert rows(column, 20) == ["(x1 + x2, x3 + x4,", "    x5)"]
    assert rows(column, 9) == ["(x1 + x2,", "    x3", "    + x4,", "    x5)"]


def test_where_a_formula_may_be_broken():
    assert breakable("a = b + (c - d, e) f").split(" ") == ["a\x00=\x00b", "+\x00(c\x02-\x00d,\x01e)\x00f"]


@settings(max_examples=40)
@given(st.lists(st.integers(-9, 9), min_size=12, max_size=12), st.integers(12, 60))
def test_nothing_is_lost_and_no_row_is_too_long(weights, width):
    formula = Formula(sp.Add(*(w * v for w, v in zip(weights, x, strict=True))))
    written = rows(formula, width)
    assert " ".join(row.strip() for row in written) == formula.plain
    assert max(map(len, written)) <= width
