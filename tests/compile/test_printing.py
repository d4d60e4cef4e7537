"""Expressions reach the core as texts: values, sharing and refusals do not depend on how SymPy keeps or names them."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_fields import derivative

import liepoisson as lp
from liepoisson.compile.field import QuadraticField, TapeField
from liepoisson.compile.lowering import field_of_equations, quadratic_of_equations, tape_of_equations, tape_of_functions
from liepoisson.compile.printing import PrintedExpressions
from liepoisson.compile.tape_values import values_of_tape
from liepoisson.errors import ParameterError, UnsupportedFieldError

X, Y, Z = SYMBOLS = sp.symbols("x y z")


def combined(inner):
    return st.one_of(
        st.tuples(inner, inner).map(lambda p: p[0] + p[1]),
        st.tuples(inner, inner).map(lambda p: p[0] * p[1]),
        st.tuples(inner, inner).map(lambda p: p[0] / (2 + p[1] ** 2)),
        st.tuples(inner, st.sampled_from((2, 3, 5))).map(lambda p: p[0] ** p[1]),
        st.tuples(inner, st.sampled_from((sp.Rational(1, 2), sp.Rational(-3, 2), sp.pi / 4, Y / 3))).map(
            lambda p: (2 + sp.cos(p[0])) ** p[1]
        ),
        st.tuples(st.sampled_from((sp.sin, sp.tanh, sp.atan, sp.exp)), inner).map(lambda p: p[0](p[1] / 5)),
    )


NUMBERS = (sp.Rational(-7, 3), sp.sqrt(2), sp.pi, sp.E, sp.EulerGamma, sp.gamma(sp.Rational(1, 3)), sp.sin(1), sp.S(0))
EXPRESSIONS = st.recursive(st.sampled_from((*SYMBOLS, *SYMBOLS, *NUMBERS)), combined, max_leaves=6)


@settings(max_examples=50, deadline=None)
@given(st.lists(EXPRESSIONS, min_size=1, max_size=3), st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_printed_expressions_have_their_values(functions, state):
    values = dict(zip(SYMBOLS, (sp.Rational(value) for value in state), strict=True))
    wanted = np.array([float(function.xreplace(values).evalf(20)) for function in functions])
    found = values_of_tape(tape_of_functions(SYMBOLS, functions), np.array(state))
    np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12 * (1 + np.abs(wanted).max()))


def test_names_change_nothing():
    expressions = [sp.sin(X * Y) * Z + X / (1 + Z**2), sp.exp(X - Y) ** 2 * sp.sqrt(1 + Z**2)]
    renamed = dict(zip(SYMBOLS, sp.symbols("z x1 E"), strict=True))
    others = [expression.xreplace(renamed) for expression in expressions]
    assert tape_of_functions(SYMBOLS, expressions) == tape_of_functions([*renamed.values()], others)


def test_a_part_of_several_expressions_is_printed_once():
    part = sp.sqrt(1 + X**2 + Y**2)
    printed = PrintedExpressions(SYMBOLS, [part * X, part * Y, sp.sin(part)])
    assert sum(text.count("(1/2)") for text in (*printed.parts, *printed.texts)) == 1
    assert len(tape_of_functions(SYMBOLS, [part * X, part * Y, sp.sin(part)]).instructions) == 7


def test_deep_and_long_expressions_are_read():
    nested, wanted = X, 0.5
    for _ in range(300):
        nested, wanted = sp.cos(nested), np.cos(wanted)
    assert values_of_tape(tape_of_functions([X], [nested]), np.array([0.5]))[0] == pytest.approx(wanted, rel=1e-13)
    long = sp.Add(*(sp.Rational(3**400 + k, 7**300) * X**k for k in range(900)))
    scale = float(sp.Rational(3**400, 7**300))
    found = values_of_tape(tape_of_functions([X], [long]), np.array([0.5]))[0]
    assert found == pytest.approx(2 * scale, rel=1e-13)


def test_equations_of_degree_two_are_quadratic_and_others_a_tape():
    rates = [X * Y + sp.sqrt(3) * Z, (X + Y) ** 2 - X**2, sp.Rational(1, 2)]
    field = field_of_equations(SYMBOLS, rates)
    assert field == QuadraticField(3, ((2, 0.5),), ((0, 2, 3**0.5),), ((0, 0, 1, 1.0), (1, 0, 1, 2.0), (1, 1, 1, 1.0)))
    state = np.array([0.3, -0.2, 0.7])
    tape = tape_of_equations(SYMBOLS, rates)
    assert isinstance(tape, TapeField)
    np.testing.assert_allclose(derivative(tape, state), derivative(field, state), rtol=1e-15)
    assert isinstance(field_of_equations(SYMBOLS, [X**3, Y, Z]), TapeField)
    with pytest.raises(UnsupportedFieldError, match="degree at most two"):
        quadratic_of_equations(SYMBOLS, [X**3, Y, Z])


@pytest.mark.parametrize(
    ("expression", "error", "words"),
    [
        (sp.Abs(X), UnsupportedFieldError, "smooth expression"),
        (sp.Function("sin")(X), UnsupportedFieldError, "SymPy's own functions"),
        (sp.sqrt(-2) * X, ParameterError, "finite real number"),
        (sp.Pow(-8, sp.Rational(1, 3)) * X, ParameterError, "finite real number"),
        (sp.asin(2) * X, ParameterError, "finite real number"),
        (sp.oo * X, ParameterError, "finite real number"),
        (sp.exp(1000) * X, ParameterError, "double"),
        (sp.Integer(10) ** 400 * X, ParameterError, "double"),
        (sp.Symbol("k") * X, ParameterError, "got none for k"),
    ],
)
def test_refusals(expression, error, words):
    with pytest.raises(error, match=words):
        tape_of_functions([X], [expression])


def test_an_angle_of_a_pair_is_none_of_a_field():
    angle = sp.atan2(Y, X)
    found = values_of_tape(tape_of_functions(SYMBOLS, [angle]), np.array([-0.3, 0.4, 0.0]))[0]
    assert found == pytest.approx(np.arctan2(0.4, -0.3), rel=1e-15)
    with pytest.raises(UnsupportedFieldError, match="atan2"):
        tape_of_equations(SYMBOLS, [angle, X, Y])


def test_the_field_of_a_text_is_that_of_its_expression():
    """The former is read by the core alone."""
    text = "p_q^2/(2*m) - cos(q) + k*sqrt(1 + q^2) + exp(-q^2)/(1 + exp(-q^2))"
    pendulum = lp.System(lp.canonical(names=["q"]), text, parameters={"m": "3/2", "k": "sqrt(2)/7"})
    same = lp.System(pendulum.bracket, pendulum.hamiltonian)
    for state in np.random.default_rng(2).normal(size=(5, 2)):
        np.testing.assert_allclose(derivative(pendulum.field(), state), derivative(same.field(), state), rtol=1e-14)
