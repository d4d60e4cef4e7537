from fractions import Fraction
from itertools import product

import numpy as np
import pytest
import sympy as sp

from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.exact.bracket import Bracket
from liepoisson.exact.extension import Extension, leibniz, semidirect
from liepoisson.exact.lie_algebra import so


def products(extension):
    """The nonzero products as a dictionary (mu, nu) -> {lam: coefficient}."""
    W, n = extension.tensor, extension.dimension
    table = {(m, v): {k: W[k][m][v] for k in range(n) if W[k][m][v] != 0} for m, v in product(range(n), repeat=2)}
    return {pair: value for pair, value in table.items() if value}


def test_leibniz_three_has_one_cocycle():
    epsilon = sp.Symbol("epsilon")
    unit = {(0, m): {m: 1} for m in range(3)} | {(m, 0): {m: 1} for m in range(3)}
    assert products(leibniz(3, "epsilon")) == unit | {(1, 1): {2: epsilon}}
    assert products(semidirect(3)) == unit


def test_leibniz_of_order_n_multiplies_powers():
    for n in range(1, 6):
        assert products(leibniz(n)) == {(m, v): {m + v: 1} for m in range(n) for v in range(n) if m + v < n}


def test_no_cocycle_is_semidirect():
    for n in range(1, 5):
        assert leibniz(n, 0).tensor == semidirect(n).tensor


def changed(extension, entries):
    W = [[list(row) for row in plane] for plane in extension.tensor]
    for (lam, mu, nu), value in entries.items():
        W[lam][mu][nu] = value
    return W


def test_commutativity_is_required_and_the_entry_named():
    with pytest.raises(BracketError, match=r"symmetric.*W\[1\]\[0\]\[1\] = -1 and W\[1\]\[1\]\[0\] = 1"):
        Extension(changed(leibniz(3), {(1, 0, 1): -1}))


def test_associativity_is_required_and_the_entry_named():
    with pytest.raises(BracketError, match=r"associative; \(e_\d e_\d\) e_\d and .* differ by -?\d+ along e_\d"):
        Extension(changed(leibniz(3), {(2, 0, 2): -1, (2, 2, 0): -1}))


def test_an_unchecked_extension_can_be_wrong_on_purpose():
    wrong = Extension(changed(leibniz(3), {(1, 0, 1): -1}), check=False)
    assert wrong.tensor[1][0][1] == -1


def test_values_for_symbols():
    extension = leibniz(3, "epsilon")
    assert extension.symbols == {"epsilon"}
    assert extension.substitute({"epsilon": Fraction(2, 3)}).tensor == leibniz(3, "2/3").tensor
    assert extension.substitute({"kappa": Fraction(1)}) is extension


def test_wrong_sizes_are_refused():
    with pytest.raises(ParameterError, match="n >= 1"):
        leibniz(0)
    with pytest.raises(ShapeError, match="field_names must be 2 names; got 1"):
        Extension(leibniz(2).tensor, field_names=("l",))


@pytest.mark.parametrize("n", ["a", 2.5, None, True])
def test_a_number_of_fields_is_whole(n):
    with pytest.raises(ParameterError, match="n >= 1"):
        leibniz(n, 1)


@pytest.mark.parametrize("tensor", [None, 5, "abc", [None], [[1]], ["a"], [[None]], np.array(1)])
def test_a_tensor_has_three_axes(tensor):
    with pytest.raises((ShapeError, ParameterError), match="W"):
        Extension(tensor, "x")


@pytest.mark.parametrize("names", [5, "l", [1]])
def test_field_names_are_a_sequence_of_names(names):
    with pytest.raises(ShapeError, match="field_names must be a sequence"):
        Extension([[[1]]], field_names=names)


def test_a_bracket_is_made_of_an_algebra_and_an_extension():
    with pytest.raises(ParameterError, match="extension must be of type Extension; got one of type int"):
        so(3) @ 5
    with pytest.raises(ParameterError, match="algebra must be of type LieAlgebra"):
        Bracket(None, leibniz(3, 1))
