"""Expressions in private symbols: values as SymPy has them, whatever the variables are called."""

import numpy as np
import pytest
import sympy as sp

from liepoisson.compile.private_symbols import in_private_symbols, numpy_function
from liepoisson.errors import ParameterError

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
    private, [expression] = in_private_symbols((first, second), [first - 2 * second])
    assert tuple(map(str, private)) == ("_1", "_0")
    assert expression == private[0] - 2 * private[1]


def test_a_function_is_compiled_once():
    assert numpy_function([X, Y], [X + Y]) is numpy_function((X, Y), (X + Y,))
    assert numpy_function([Y, X], [X - Y])(1.0, 3.0) == [2.0]
    assert numpy_function([X, Y], [X - Y])(1.0, 3.0) == [-2.0]


def test_symbols_that_are_printed_alike_are_different():
    other = sp.Symbol("e", positive=True)
    with pytest.raises(ParameterError, match="every parameter must be a number for numerical work; e has none"):
        numpy_function((X, Y), [X + other])
    assert numpy_function((Y, other), [Y - 2 * other])(1.0, 3.0) == [-5.0]
