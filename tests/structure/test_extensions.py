import pickle
from fractions import Fraction
from itertools import product

import pytest
import sympy as sp
from sympy import expand

from liepoisson.errors import ParameterError
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import EXTENSIONS, crmhd, leibniz, normal_form, semidirect, trivial


def test_the_trivial_extension_is_the_real_line():
    assert trivial().tensor == (((1,),),)
    assert trivial().unit() == (1,)


def test_reduced_mhd_has_one_cocycle():
    A = crmhd("2/3")
    unit = {(0, k): {k: 1} for k in range(4)}
    assert A.products == unit | {(1, 2): {3: Fraction(-2, 3)}}
    assert A.field_names == ("omega", "v", "p", "psi")
    assert A.name == "CRMHD(beta_e = 2/3)"
    assert crmhd().symbols == {"beta_e"}


@pytest.mark.parametrize(
    "extension", [trivial(), leibniz(6), leibniz(5, "epsilon"), leibniz(4, "-2/7"), semidirect(6), crmhd(), crmhd(0)]
)
def test_named_extensions_are_commutative_and_associative(extension):
    """W_k^{ij} = W_k^{ji}, and e_i(e_j e_k) is symmetric in i, j and k; the constructor says the same."""
    W, n = extension.tensor, range(len(extension.tensor))
    assert all(W[k][i][j] == W[k][j][i] for i, j, k in product(n, n, n))
    twice = {(i, j, k, s): expand(sum(W[s][i][r] * W[r][j][k] for r in n)) for i, j, k, s in product(n, n, n, n)}
    assert all(value == twice[j, i, k, s] for (i, j, k, s), value in twice.items())
    assert Extension(W).tensor == W


def test_no_cocycle_leaves_no_products():
    assert crmhd(0).products == semidirect(4).products == leibniz(4, 0).products


@pytest.mark.parametrize("n", [0, -1, 101, 10**12, 2.0, "3", True])
@pytest.mark.parametrize("constructor", [leibniz, semidirect])
def test_the_number_of_fields_is_bounded(constructor, n):
    with pytest.raises(ParameterError, match=r"n >= 1|at most 100"):
        constructor(n)


def test_normal_forms_are_counted_from_one():
    assert normal_form(3, 1).tensor == leibniz(3).tensor
    assert normal_form(3, 2).tensor == semidirect(3).tensor
    for n, k in product((3, 6, 0), (0, 3, True)):
        with pytest.raises(ParameterError, match=r"counted from 1|dimensions 1 to 5"):
            normal_form(n, k)


def test_files_know_the_constructors_by_name():
    calls = {"trivial": (), "semidirect": (3,), "leibniz": (3, "epsilon"), "crmhd": ("beta_e",), "normal_form": (4, 2)}
    assert set(EXTENSIONS) == set(calls)
    for name, arguments in calls.items():
        assert isinstance(EXTENSIONS[name](*arguments), Extension)


NAMED = [
    (leibniz, (3,), "epsilon"), (leibniz, (4,), "epsilon"), (leibniz, (2,), "epsilon"), (crmhd, (), "beta_e"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "arguments", "name"), NAMED)
@pytest.mark.parametrize("value", [Fraction(1), Fraction(-2, 7), Fraction(0), sp.sqrt(2), sp.Symbol("k") + 1])
def test_a_name_for_a_parameter_is_its_symbol(make, arguments, name, value):
    """The products of a name are made when they are asked for; those of a symbol are there at once."""
    named, symbolic = make(*arguments, name), make(*arguments, sp.Symbol(name))
    fields = [f"m{k}_" for k in range(named.dimension)]
    values = {name: value} if named.symbols else {}
    at_value = [extension.rename(*fields).substitute(values) for extension in (named, symbolic)]
    restored = pickle.loads(pickle.dumps(named.rename(*fields))).substitute(values)
    for first, second in ((named, symbolic), at_value, (restored, at_value[1])):
        assert first.symbols == second.symbols
        assert (first.name, first.field_names) == (second.name, second.field_names)
        assert first.products == second.products
        assert {type(v) for row in first.products.values() for v in row.values()} == {
            type(v) for row in second.products.values() for v in row.values()
        }


def test_a_parameter_that_does_not_occur_is_no_symbol():
    assert leibniz(2, "epsilon").symbols == set()
    assert leibniz(2, "epsilon").name == "Leibniz(2, epsilon)"
