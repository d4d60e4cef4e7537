import pytest
import sympy as sp

from liepoisson.formula.expression import read_expression
from liepoisson.model.constructors import read_algebra, read_extension
from liepoisson.model.hamiltonian import scope_of


@pytest.mark.parametrize(
    ("text", "dimension", "first"),
    [("so(3)", 3, 1), ("so(2, 1)", 3, -1), ("so(1+2)", 3, 1), ("sine(3)", 8, None), ("so(3) + so(3)", 6, 1)],
)  # fmt: skip
def test_algebras_are_built_by_name(text, dimension, first):
    """[e_1, e_2] = -e_3 with the metric diag(1, 1, -1), + e_3 with diag(1, 1, 1)."""
    algebra = read_algebra(text)
    assert algebra.dimension == dimension
    assert first in (None, algebra.structure_constants[0][1][2])


@pytest.mark.parametrize(
    ("text", "names", "entry"),
    [
        ("leibniz(3, -2*epsilon/3)", ["epsilon"], -2 * sp.Symbol("epsilon") / 3),
        ("leibniz(3, 0.5)", [], sp.Rational(1, 2)),
        ("leibniz(4, a[2])", ["a[3]"], sp.Symbol("a2")),
        *((f"leibniz(3, {name})", [name], sp.Symbol(name)) for name in ("nan", "Infinity")),  # free to be names
    ],
)
def test_extensions_are_built_by_name_with_numbers_and_symbols(text, names, entry):
    assert sp.sympify(read_extension(text, names).tensor[2][1][1]) == entry
    assert repr(read_extension("trivial + semidirect(2)")) == repr(read_extension("trivial() + semidirect(2)"))


def test_the_text_of_a_hamiltonian_fits_the_bracket():
    bracket = read_algebra("so(4)") @ read_extension("trivial()").rename("M")
    assert read_expression("M12 + M[6]", scope_of(bracket)) == sp.Symbol("M12") + sp.Symbol("M34")
