from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from liepoisson.algebra.exact_numbers import exact
from liepoisson.algebra.symbol_polynomials import SymbolPolynomial
from liepoisson.errors import LiePoissonError
from liepoisson.formula.coefficients import coefficient, parameter
from liepoisson.formula.expression import evaluate
from liepoisson.formula.grammar import parse
from liepoisson.formula.scope import Scope

SCOPE = Scope(parameters={"I": [2, 3, "5/2"]}, symbols=["k[3]", "m"])


def read(text):
    return coefficient(parse(text), text, SCOPE)


@pytest.mark.parametrize(
    "text",
    [
        *(
            "k[3]",
            "-k1",
            "2*m",
            "m/3",
            "-2*m/3",
            "2*m/3 - k2",
            "m^2*k1 + m",
            "3*(m - k1)/7",
            "m*k1*m",
            "I[1]*m",
            "(m)^1 + 2",
        ),
        *("sqrt(2)", "1/sqrt(2)", "3/(2*sqrt(2/3))", "sqrt(8)*m + 1", "2^(1/2)", "1 + sqrt(5)", "m*sqrt(I[2])"),
        *("pi", "1/pi", "pi/4", "3/(4*pi)*sin(2*pi/3)", "cos(pi/5)", "m*cos(9*pi/14)", "sin(-pi/7)", "sin(40*pi/7)"),
    ],
)
def test_polynomials_in_names_and_one_number_wait_for_sympy(text):
    found = read(text)
    assert isinstance(found, SymbolPolynomial)
    wanted = evaluate(parse(text), text, SCOPE)
    assert exact(found) == wanted
    assert str(found) == str(wanted)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("m - m + 2/3", Fraction(2, 3)),
        ("sqrt(2)*sqrt(2)", Fraction(2)),
        ("sqrt(4/9)", Fraction(2, 3)),
        ("sin(pi/6) + cos(pi/3) + cos(pi)", Fraction(0)),
        ("sqrt(8) - 2*sqrt(2)", Fraction(0)),
        ("I[1]*I[3]", Fraction(5)),
    ],
)
def test_what_is_rational_is_a_fraction(text, value):
    assert read(text) == value
    assert isinstance(read(text), Fraction)


@pytest.mark.parametrize(
    "text",
    ["1/m", "(m + k1)*k2", "(m + k1)^2", "sqrt(2) + sqrt(3)", "sqrt(m)", "exp(1)", "pi*pi", "dot(k, k)", "sin(1)"],
)
def test_all_else_is_read_by_sympy(text):
    found = read(text)
    assert isinstance(found, sp.Expr)
    assert found == evaluate(parse(text), text, SCOPE)


@pytest.mark.parametrize("text", ["n", "k", "m[1]", "1/(m - m)", "sqrt(-2)", "log(0)", "pi(2)", "k[4]", "2^1000"])
def test_refusals_are_those_of_formulas(text):
    with pytest.raises(LiePoissonError) as found:
        read(text)
    with pytest.raises(LiePoissonError) as wanted:
        evaluate(parse(text), text, SCOPE)
    assert str(found.value) == str(wanted.value)


LEAVES = st.sampled_from(["m", "k1", "2", "1/3", "sqrt(2)", "sqrt(12)", "pi", "sin(2*pi/7)", "cos(pi/5)", "0.25"])


def combined(inner):
    pairs = st.tuples(inner, st.sampled_from("+-*/"), inner)
    return st.one_of(
        pairs.map(lambda parts: f"({parts[0]} {parts[1]} {parts[2]})"),
        inner.map(lambda part: f"(-{part})"),
        inner.map(lambda part: f"{part}^2" if part[0] == "(" else part),
    )


@given(st.recursive(LEAVES, combined, max_leaves=6))
def test_nothing_is_read_otherwise_than_by_sympy(text):
    try:
        wanted = evaluate(parse(text), text, SCOPE)
    except LiePoissonError:
        return
    found = read(text)
    assert isinstance(found, Fraction) == isinstance(wanted, Fraction)
    assert str(exact(found)) == str(wanted)
    assert exact(found) == wanted


def test_every_name_of_a_parameter_is_that_of_a_symbol():
    assert exact(parameter("2*epsilon - n")) == 2 * sp.Symbol("epsilon") - sp.Symbol("n")
