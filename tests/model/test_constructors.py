import re

import pytest
import sympy as sp

from liepoisson.errors import ExpressionError
from liepoisson.formula.expression import read_expression
from liepoisson.model.constructors import read_algebra, read_extension
from liepoisson.structure.bracket_scope import scope_of


@pytest.mark.parametrize(
    ("text", "dimension"),
    [("so(3)", 3), ("so(2, 1)", 3), ("so(4)", 6), ("su(3)", 8), ("so(3) + so(3)", 6), ("sine(3)", 8), ("so(1+2)", 3)],
)
def test_algebras_are_built_by_name(text, dimension):
    assert read_algebra(text).dimension == dimension


def test_an_algebra_by_name_is_the_one_of_its_constructor():
    # [e_1, e_2] = -e_3 with the metric diag(1, 1, -1), + e_3 with diag(1, 1, 1)
    assert read_algebra("so(3)").structure_constants[0][1][2] == 1
    assert read_algebra("so(2,1)").structure_constants[0][1][2] == -1


def test_extensions_are_built_by_name_with_numbers_and_symbols():
    epsilon = sp.Symbol("epsilon")
    assert read_extension("leibniz(3, epsilon)", ["epsilon"]).tensor[2][1][1] == epsilon
    assert read_extension("leibniz(3, -2*epsilon/3)", ["epsilon"]).tensor[2][1][1] == -2 * epsilon / 3
    assert read_extension("leibniz(3, 0.5)").tensor[2][1][1] * 2 == 1
    assert read_extension("leibniz(4, a[2])", ["a[3]"]).symbols == {"a2"}
    for name in ("nan", "inf", "Infinity"):  # no numbers in formulas, and so free to be names
        assert read_extension(f"leibniz(3, {name})", [name]).tensor[2][1][1] == sp.Symbol(name)
    assert read_extension("trivial() + semidirect(2)").dimension == 3
    assert repr(read_extension("trivial + semidirect(2)")) == repr(read_extension("trivial() + semidirect(2)"))
    assert read_extension("crmhd(1/2)").field_names == ("omega", "v", "p", "psi")


@pytest.mark.parametrize(
    ("text", "position", "message"),
    [
        ("so", 0, r"Write for example so\(\.\.\.\)"),
        ("3", 0, r"Write for example so\(3\)"),
        ("sos(3)", 0, "Did you mean so"),
        ("so(3) + eval(1)", 8, "'eval' is unknown"),
        ("so(3) - so(3)", 6, "direct sum"),
        ("so(3)*so(3)", 5, "must be a name with its arguments"),
        ("so()", 0, "arguments"),
        ("so(1, 2, 3)", 0, "so"),
        ("su(n)", 3, "'n' is unknown"),
        ("su(1/2)", 0, "su"),
        ("su(10^9)", 0, "1000 dimensions"),
        ("so(-3)", 0, "so"),
    ],
)
def test_a_mistake_in_the_name_of_an_algebra_has_a_position(text, position, message):
    with pytest.raises(ExpressionError) as caught:
        read_algebra(text)
    assert re.search(message, str(caught.value))
    assert caught.value.position == position


@pytest.mark.parametrize("text", ["leibniz(0, 1)", "leibniz(3, epsilon)", "leibniz", "leibnitz(3)", "leibniz(10^8)"])
def test_a_mistake_in_the_name_of_an_extension_is_refused(text):
    with pytest.raises(ExpressionError):
        read_extension(text)


def test_the_text_of_a_hamiltonian_fits_the_bracket():
    bracket = read_algebra("so(4)") @ read_extension("trivial()").rename("M")
    scope = scope_of(bracket)
    assert read_expression("M12 + M[6]", scope) == sp.Symbol("M12") + sp.Symbol("M34")
