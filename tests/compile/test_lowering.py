"""Lowering: the plain data that the core integrates is the field that the bracket gives."""

import json
import math

import numpy as np
import pytest
import sympy as sp
from plain_fields import derivative

import liepoisson as lp
from liepoisson.compile.field import QuadraticField, TapeField, TopField, field_of, record_of
from liepoisson.compile.lowering import lower, tape_of_equations
from liepoisson.compile.symbols import in_compiler_symbols, numpy_function
from liepoisson.errors import ParameterError, UnsupportedFieldError
from liepoisson.model.system import System
from liepoisson.structure.extensions import leibniz
from liepoisson.structure.lie_algebras import so

HAMILTONIANS = {
    "top": lambda l, alpha, beta: l[0] ** 2 / 4 + l[1] ** 2 / 6 + l[2] ** 2 / 2 + alpha[0] - beta[2] / 3,
    "quadratic": lambda l, alpha, beta: (l[0] + l[1]) ** 2 / 3 + l[2] + alpha.dot(beta) - alpha[1] ** 2,
    "cubic": lambda l, alpha, beta: l.dot(l) * alpha[0] + sp.Rational(2, 7) * beta[1] ** 3,
    "sqrt": lambda l, alpha, beta: l.dot(l) / 2 + sp.sqrt(1 + alpha.dot(alpha)),
    "quotient": lambda l, alpha, beta: l.dot(l) / (2 + beta[0] ** 2) - alpha[2] / (3 + sp.cos(l[1])) ** 2,
    "functions": lambda l, alpha, beta: (
        sp.exp(alpha[0] / 3)
        + sp.log(3 + sp.sin(beta[1]))
        + sp.tan(l[0] / 5)
        + sp.sinh(l[1] / 4) * sp.cosh(beta[0])
        + sp.tanh(alpha[2])
        + sp.atan(l[2])
        + sp.asin(alpha[1] / 9)
        + sp.acos(beta[2] / 9)
    ),
    "powers": lambda l, alpha, beta: (4 + l.dot(l)) ** sp.Rational(-3, 2) + (5 + alpha[0]) ** sp.pi + 2 ** beta[0],
    "variable exponent": lambda l, alpha, beta: (5 + l[0]) ** (alpha[1] / 4),
    "constant": lambda l, alpha, beta: sp.Integer(3) + 0 * l[0],
}
KINDS = {"top": TopField, "quadratic": QuadraticField, "constant": QuadraticField}


@pytest.mark.parametrize("name", HAMILTONIANS)
def test_a_lowered_field_is_the_derived_field(name):
    system = System(so(3) @ leibniz(3, "3/2"), HAMILTONIANS[name], name=name)
    field = system.field()
    assert isinstance(field, KINDS.get(name, TapeField))
    assert field_of(json.loads(json.dumps(record_of(field)))) == field
    for x in np.random.default_rng(3).uniform(-1, 1, (5, 9)):
        np.testing.assert_allclose(derivative(field, x), system.vector_field(x), rtol=1e-12, atol=1e-13)


def test_irrational_coefficients_are_rounded_once():
    """H = sqrt(2) l1 l2 on so(3): l' = l x grad H, so l1' = -sqrt(2) l1 l3 and l3' = sqrt(2) (l1^2 - l2^2)."""
    system = System(so(3) @ leibniz(1), lambda l: sp.sqrt(2) * l[0] * l[1])
    found = {(i, j, k): c for i, j, k, c in system.field().quadratic}
    root = math.sqrt(2)
    assert found == {(0, 0, 2): -root, (1, 1, 2): root, (2, 0, 0): root, (2, 1, 1): -root}


def test_a_subexpression_is_written_once():
    x, y = sp.symbols("x y")
    field = tape_of_equations((x, y), (sp.sin(x + y) * x, sp.sin(x + y) * y))
    assert [name for name, _, _ in field.instructions].count("sin") == 1


MOST = lp.so(3) @ lp.semidirect(2)
l1, alpha1 = MOST.variables[0], MOST.variables[3]


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        *((lambda f=f: lower(MOST, l1**2 / 2 + l1 * f(alpha1)), UnsupportedFieldError, "smooth expression")
          for f in (sp.Abs, sp.sign, sp.floor, sp.Heaviside, sp.gamma, sp.Function("f"))),
        (lambda: System(so(3) @ leibniz(3, "epsilon"), "l1^2/m", symbols=["m"]).field(), ParameterError, "epsilon, m"),
        *((lambda p=p: System(lp.canonical(1), f"p1^2/2 + 1e-400*q1^{p}").field(), ParameterError, "smaller number")
          for p in (2, 4)),  # no double holds 1e-400, and it is no zero
        (lambda: System(MOST, "sqrt(1 + l1^2)").pieces(), UnsupportedFieldError, "polynomial"),
        (lambda: System(MOST, "mass*dot(l, l)", symbols=["mass"]).pieces(), ParameterError, "mass"),
        *((lambda r=r: field_of(r), (ValueError, KeyError), "") for r in (
            {"kind": "pendulum"},
            {"kind": "quadratic", "n_components": 0, "constant": [], "linear": [], "quadratic": []},
            {"kind": "quadratic", "n_components": 2, "constant": [], "linear": [[0, 2, 1.0]], "quadratic": []},
            {"kind": "quadratic", "n_components": 2, "constant": [[0, math.inf]], "linear": [], "quadratic": []},
            {"kind": "tape", "n_components": 1, "instructions": [["sin", [1], []]], "outputs": [0]},
            {"kind": "tape", "n_components": 1, "instructions": [], "outputs": [1]},
            {"kind": "top", "inertia": [1, 1], "a": [0, 0, 0], "b": [0, 0, 0], "epsilon": 0})),
        *((lambda f=f: numpy_function(MOST.variables[:1], [f]), UnsupportedFieldError, "")
          for f in (sp.gamma(l1), sp.zeta(l1), sp.besselj(0, l1), sp.Function("exp")(l1))),
        (lambda: numpy_function([l1], [sp.Symbol("l1", positive=True)]), ParameterError, "work; got none for l1"),
    ],
)  # fmt: skip
def test_refusals(call, error, words):
    with pytest.raises(error, match=words or None):
        call()


@pytest.mark.parametrize(
    "energy",
    [
        "dot(l, l)^2",
        "sin(dot(l, l))",
        "sqrt(1 + dot(l, l))",
        "(dot(l, l) + dot(l, l)^2)^5",
        "log(2 + dot(l, l) + dot(l, l)^4)/(3 + dot(l, l)^2)",
    ],
)
def test_function_of_casimirs_moves_nothing_at_all(energy):
    """Its terms cancel; added in doubles they would leave round-off, and an orbit a time scale of 1e16."""
    system = System(lp.so(3) @ lp.trivial(), energy)
    x = np.random.default_rng(0).normal(size=(5, 3)) * 1e3
    np.testing.assert_array_equal(lp.orbits.time_scale(system, x), np.inf)
    assert len(system.field().instructions) == 1


X, Y = sp.symbols("pi e")
FUNCTIONS = [
    sp.E * X + sp.pi * Y + sp.EulerGamma, sp.sqrt(X), sp.exp(Y), sp.E**X, sp.log(X), sp.sin(X), sp.cos(Y), sp.tan(X),
    sp.sinh(X), sp.cosh(X), sp.tanh(X), sp.asin(X), sp.acos(Y), sp.atan(X * Y), sp.Abs(X), sp.Max(X, Y), sp.atan2(X, Y),
    sp.Integer(0), sp.Rational(1, 3), sp.sin(X * Y) ** 2 + sp.sin(X * Y),
]  # fmt: skip


@pytest.mark.parametrize("expression", FUNCTIONS, ids=str)
def test_compiled_functions_have_the_values_of_sympy(expression):
    x, y = np.array([0.2, 0.7]), np.array([0.9, 0.4])
    found = np.broadcast_to(numpy_function((X, Y), [expression])(x, y)[0], 2)
    wanted = [float(expression.subs({X: a, Y: b}, simultaneous=True)) for a, b in zip(x, y, strict=True)]
    np.testing.assert_allclose(found, wanted, rtol=1e-14)


def test_variables_that_are_called_like_private_ones_are_exchanged_at_once():
    first, second = sp.symbols("_0 _1")
    private, [expression] = in_compiler_symbols((first, second), [first - 2 * second])
    assert tuple(map(str, private)) == ("_1", "_0")
    assert expression == private[0] - 2 * private[1]


def test_a_function_is_compiled_once():
    assert numpy_function([X, Y], [X + Y]) is numpy_function((X, Y), (X + Y,))
    assert numpy_function([Y, X], [X - Y])(1.0, 3.0) == [2.0]
    assert numpy_function([X, Y], [X - Y])(1.0, 3.0) == [-2.0]


def test_symbols_that_are_printed_alike_are_different():
    other = sp.Symbol("e", positive=True)
    with pytest.raises(ParameterError, match="every parameter must be a number for numerical work; got none for e"):
        numpy_function((X, Y), [X + other])
    assert numpy_function((Y, other), [Y - 2 * other])(1.0, 3.0) == [-5.0]
