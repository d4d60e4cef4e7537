import pickle
import subprocess
import sys
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
import sympy as sp

from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.structure.bracket import Bracket
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import crmhd, leibniz, semidirect, trivial
from liepoisson.structure.lie_algebras import so


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
    assert extension.substitute({}) is extension


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
    with pytest.raises(ParameterError, match="extension: wanted an Extension; got 5"):
        so(3) @ 5
    with pytest.raises(ParameterError, match="algebra: wanted a LieAlgebra; got None"):
        Bracket(None, leibniz(3, 1))


def test_products_are_the_sparse_tensor():
    for extension in (leibniz(5, "2/3"), semidirect(4), leibniz(3, "epsilon"), crmhd()):
        W, n = extension.tensor, range(extension.dimension)
        dense = {(m, v): {k: W[k][m][v] for k in n if W[k][m][v] != 0} for m in n for v in n if m <= v}
        assert extension.products == {pair: row for pair, row in dense.items() if row}
        again = Extension.from_products(extension.dimension, extension.products)
        assert again.tensor == W
        assert Extension(W).products == extension.products


def test_products_are_read_in_either_order_and_must_agree():
    assert Extension.from_products(2, {(1, 0): {1: 1}, (0, 0): {0: 1}}).tensor == leibniz(2).tensor
    with pytest.raises(BracketError, match="commutative; got e_1 e_0"):
        Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 0): {1: 2}})
    with pytest.raises(BracketError, match="associative"):
        Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 2}})
    with pytest.raises(ShapeError, match=r"0\.\.1"):
        Extension.from_products(2, {(0, 2): {1: 1}})


def test_in_a_direct_sum_products_between_the_parts_vanish():
    A, B = leibniz(2), leibniz(3, "epsilon")
    total = A + B
    shifted = {(i + 2, j + 2): {k + 2: v for k, v in row.items()} for (i, j), row in B.products.items()}
    assert total.products == A.products | shifted
    assert total.name == "(Leibniz(2, epsilon = 1) + Leibniz(3, epsilon))"
    assert (trivial() + trivial() + trivial()).name == "(trivial + trivial + trivial)"
    assert total.field_names == ("x0", "x1", "x2", "x3", "x4")  # l and alpha would stand twice
    assert (trivial().rename("w") + leibniz(3)).field_names == ("w", "l", "alpha", "beta")
    with pytest.raises(ParameterError, match="an extension to add"):
        A + 1


def test_a_direct_sum_of_lines_gives_two_copies_of_the_algebra():
    J = (so(3) @ (trivial() + trivial())).poisson_tensor()
    single = so(3) @ trivial()
    l, alpha = sp.symbols("l1:4"), sp.symbols("alpha1:4")
    block = single.poisson_tensor()
    assert sp.diag(block, block.subs(dict(zip(l, alpha, strict=True)))) == J


def test_structure_of_the_leibniz_extension():
    A = leibniz(4, "1/2")
    assert A.unit() == (1, 0, 0, 0)
    assert set(A.nilradical()) == {(0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)}
    assert A.socle() == ((0, 0, 0, 1),)
    assert A.annihilator() == ()
    assert A.hilbert_function() == (1, 1, 1, 1)
    assert (A.is_unital, A.is_local, A.residue_field) == (True, True, "R")
    assert A.maximal_ideals() == (A.nilradical(),)


def test_structure_of_a_direct_sum():
    A = trivial() + leibniz(2)
    assert A.unit() == (1, 1, 0)
    assert A.nilradical() == ((0, 0, 1),)
    assert set(A.maximal_ideals()) == {((0, 1, 0), (0, 0, 1)), ((1, 0, 0), (0, 0, 1))}
    assert A.hilbert_function() == (2, 1)
    assert (A.is_unital, A.is_local, A.residue_field) == (True, False, None)


def test_structure_without_a_unit():
    A = Extension([[[0, 0], [0, 0]], [[1, 0], [0, 0]]])  # e0 e0 = e1
    assert A.unit() is None
    assert not A.is_local
    assert A.maximal_ideals() == ()
    assert A.annihilator() == ((0, 1),)
    assert len(A.nilradical()) == 2


def test_residue_fields():
    def quadratic(q):
        return Extension([[[1, 0], [0, q]], [[0, 1], [1, 0]]])  # e1 e1 = q

    assert quadratic(-3).residue_field == "C"
    assert quadratic(0).residue_field == "R"
    assert quadratic(3).residue_field is None  # two real places
    with pytest.raises(ParameterError, match="sign of q"):
        quadratic("q").residue_field  # noqa: B018
    assert quadratic(sp.Symbol("q", positive=True)).residue_field is None


def test_structure_is_not_asked_of_what_is_no_algebra():
    wrong = Extension(changed(leibniz(3), {(2, 0, 2): -1, (2, 2, 0): -1}), check=False)
    with pytest.raises(BracketError, match="associative"):
        wrong.unit()


def test_extensions_travel_between_processes():
    for extension in (leibniz(3), crmhd(), trivial() + leibniz(2)):
        copy = pickle.loads(pickle.dumps(extension))
        assert (copy.tensor, copy.name, copy.field_names) == (extension.tensor, extension.name, extension.field_names)


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform == "emscripten", reason="a browser has no processes")
def test_rational_extensions_do_not_load_sympy():
    program = """
import sys
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import leibniz
from liepoisson.structure.extensions import crmhd, trivial
A = leibniz(5, "1/3") + trivial() + crmhd(2)
assert A.tensor and A.unit() and A.socle() and A.classify().is_local is False
print("sympy" in sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


@pytest.mark.parametrize(
    ("n", "products", "error"),
    [
        (2, {0: 1}, ShapeError),
        (2, {(0, 0): 1}, ShapeError),
        (2, {(0, 0, 0): {0: 1}}, ShapeError),
        (2, {(0, 0.5): {0: 1}}, ShapeError),
        (2, {(0, 0): {"a": 1}}, ShapeError),
        (2, None, ShapeError),
        (10**9, {}, ParameterError),
        (101, {}, ParameterError),
        (0, {}, ParameterError),
        (2.5, {}, ParameterError),
    ],
)
def test_products_of_the_wrong_kind_are_refused(n, products, error):
    with pytest.raises(error, match=r"Write for example|Count from 0|Use"):
        Extension.from_products(n, products)


def test_products_may_be_formulas_in_symbols_as_in_files():
    """The text "2*epsilon" is what SymPy writes 2*Symbol("epsilon")."""
    products = {(0, 0): {0: 1}, (0, 1): {1: 1}, (0, 2): {2: 1}}
    texts = Extension.from_products(3, {**products, (1, 1): {2: "2*epsilon"}})
    assert texts.products == Extension.from_products(3, {**products, (1, 1): {2: 2 * sp.Symbol("epsilon")}}).products
    assert texts.symbols == {"epsilon"}


@pytest.mark.parametrize("n", [4, 10, 11, 12, 100])
def test_no_component_of_a_numbered_field_is_named_like_another_field(n):
    """With x1 and x11 as fields, x11 would be the first component of x1, too."""
    extension = Extension.from_products(n, {}, check=False)
    components = [f"{name}{k}" for name in extension.field_names for k in range(1, 121)]
    assert len({*components, *extension.field_names}) == 121 * n
