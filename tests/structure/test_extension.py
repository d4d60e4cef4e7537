"""Extensions: products, direct sums, copies, and the structure of the algebra."""

import pickle
import subprocess
import sys
from fractions import Fraction
from itertools import product

import pytest
import sympy as sp
from commutative import algebra

from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import EXTENSIONS, crmhd, leibniz, normal_form, semidirect, trivial

NAMED = [trivial(), leibniz(6), leibniz(5, "epsilon"), leibniz(4, "-2/7"), semidirect(6), crmhd(), crmhd(0)]


@pytest.mark.parametrize("extension", NAMED, ids=str)
def test_named_extensions_are_commutative_and_associative(extension):
    """W_k^{ij} = W_k^{ji}, and e_i(e_j e_k) is symmetric in i, j and k; products are the sparse tensor."""
    W, n = extension.tensor, range(extension.dimension)
    assert all(W[k][i][j] == W[k][j][i] for i, j, k in product(n, n, n))
    twice = {(i, j, k, s): sp.expand(sum(W[s][i][r] * W[r][j][k] for r in n)) for i, j, k, s in product(n, n, n, n)}
    assert all(value == twice[j, i, k, s] for (i, j, k, s), value in twice.items())
    dense = {(m, v): {k: W[k][m][v] for k in n if W[k][m][v] != 0} for m in n for v in n if m <= v}
    assert extension.products == {pair: row for pair, row in dense.items() if row} == Extension(W).products
    assert Extension.from_products(extension.dimension, extension.products).tensor == W
    copy = pickle.loads(pickle.dumps(extension))
    assert (copy.tensor, copy.name, copy.field_names) == (extension.tensor, extension.name, extension.field_names)


@pytest.mark.parametrize(
    ("extension", "beside_the_unit"),
    [
        (trivial(), {}),
        (semidirect(3), {}),
        (crmhd(0), {}),
        (leibniz(4, 0), {}),
        (leibniz(3, "epsilon"), {(1, 1): {2: sp.Symbol("epsilon")}}),
        (leibniz(5), {(1, 1): {2: 1}, (1, 2): {3: 1}, (1, 3): {4: 1}, (2, 2): {4: 1}}),
        (crmhd("2/3"), {(1, 2): {3: Fraction(-2, 3)}}),
        (normal_form(3, 1), {(1, 1): {2: 1}}),
        (normal_form(3, 2), {}),
    ],
    ids=str,
)
def test_products_of_named_extensions(extension, beside_the_unit):
    unit = {(0, k): {k: 1} for k in range(extension.dimension)}
    assert extension.products == unit | beside_the_unit


def test_names():
    assert (crmhd("2/3").field_names, crmhd("2/3").name) == (("omega", "v", "p", "psi"), "CRMHD(beta_e = 2/3)")
    calls = {"trivial": (), "semidirect": (3,), "leibniz": (3, "epsilon"), "crmhd": ("beta_e",)}
    calls |= {"binary_cubic": (0, 1, "c", 0), "normal_form": (4, 2)}
    assert set(EXTENSIONS) == set(calls)
    assert all(isinstance(EXTENSIONS[name](*arguments), Extension) for name, arguments in calls.items())


@pytest.mark.parametrize("n", [4, 11, 12, 100])
def test_no_component_of_a_numbered_field_is_named_like_another_field(n):
    """With x1 and x11 as fields, x11 would be the first component of x1, too."""
    extension = Extension.from_products(n, {}, check=False)
    components = [f"{name}{k}" for name in extension.field_names for k in range(1, 121)]
    assert len({*components, *extension.field_names}) == 121 * n


@pytest.mark.parametrize(
    ("make", "arguments", "name"),
    [(leibniz, (4,), "epsilon"), (leibniz, (2,), "epsilon"), (crmhd, (), "beta_e")],
)
@pytest.mark.parametrize("value", [Fraction(-2, 7), Fraction(0), sp.Symbol("k") + 1])
def test_a_name_for_a_parameter_is_its_symbol(make, arguments, name, value):
    """The products of a name are made when they are asked for; those of a symbol are there at once."""
    named, symbolic = make(*arguments, name), make(*arguments, sp.Symbol(name))
    assert named.symbols == symbolic.symbols == (set() if named.dimension == 2 else {name})
    values = {name: value} if named.symbols else {}
    restored = pickle.loads(pickle.dumps(named.rename(*"abcd"[: named.dimension]))).substitute(values)
    for other in (symbolic.substitute(values), restored):
        here = named.substitute(values)
        assert (here.name, here.symbols, here.products) == (other.name, other.symbols, other.products)
        kinds = [{type(v) for row in e.products.values() for v in row.values()} for e in (here, other)]
        assert kinds[0] == kinds[1]
    texts = Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: f"2*{name}"}}, check=False)
    assert texts.products[0, 1] == {1: 2 * sp.Symbol(name)}


def test_in_a_direct_sum_products_between_the_parts_vanish():
    A, B = leibniz(2), leibniz(3, "epsilon")
    total = A + B
    shifted = {(i + 2, j + 2): {k + 2: v for k, v in row.items()} for (i, j), row in B.products.items()}
    assert total.products == A.products | shifted
    assert total.name == "(Leibniz(2, epsilon = 1) + Leibniz(3, epsilon))"
    assert total.field_names == ("x0", "x1", "x2", "x3", "x4")  # l and alpha would stand twice
    assert (trivial().rename("w") + leibniz(3)).field_names == ("w", "l", "alpha", "beta")


E1, E2 = (0, 1, 0), (0, 0, 1)


@pytest.mark.parametrize(
    ("A", "unit", "nilradical", "maximal", "annihilator"),
    [
        (leibniz(3, "1/2"), (1, 0, 0), {E1, E2}, [[E2, E1]], ()),
        (trivial() + leibniz(2), (1, 1, 0), {E2}, [[E2, E1], [E2, (1, 0, 0)]], ()),
        (Extension([[[0, 0], [0, 0]], [[1, 0], [0, 0]]]), None, {(1, 0), (0, 1)}, [], ((0, 1),)),
    ],
)
def test_structure(A, unit, nilradical, maximal, annihilator):
    assert A.unit() == unit
    assert set(A.nilradical()) == nilradical
    assert sorted(map(sorted, A.maximal_ideals())) == sorted(maximal)
    assert A.annihilator() == annihilator
    assert (A.is_unital, A.is_local) == (unit is not None, len(maximal) == 1)


def test_hilbert_function_socle_and_residue_field():
    local, total = leibniz(3, "1/2"), trivial() + leibniz(2)
    assert (local.hilbert_function(), total.hilbert_function()) == ((1, 1, 1), (2, 1))
    assert set(local.socle()) == {E2}
    assert (local.residue_field, total.residue_field) == ("R", None)


@pytest.mark.parametrize(
    ("q", "field"), [(-3, "C"), (0, "R"), (3, None), (sp.Symbol("q", positive=True), None)]
)  # of q > 0 there are two real places
def test_residue_fields(q, field):
    assert algebra(2, {(1, 1): {0: q}}).residue_field == field


@pytest.mark.skipif(sys.platform == "emscripten", reason="a browser has no processes")
def test_rational_extensions_and_brackets_do_not_load_sympy():
    program = """
import sys
from liepoisson.structure.lie_algebras import so
from liepoisson.structure.extensions import crmhd, leibniz, trivial
A = leibniz(5, "1/3") + trivial() + crmhd(2)
assert A.tensor and A.unit() and A.socle() and A.classify().is_local is False and (so(3) @ A).entries()
sys.exit("sympy" in sys.modules)
"""
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
