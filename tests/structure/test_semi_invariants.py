"""Semi-invariants of linear brackets and rational Casimirs."""

from itertools import combinations_with_replacement
from random import Random

import pytest
import sympy as sp
from random_bases import bases

import liepoisson as lp
from liepoisson.algebras import bianchi, low_dimensional
from liepoisson.errors import BracketError, ParameterError


def test_rational_casimirs_are_quotients_of_semi_invariants_of_one_weight():
    """ad x = 1 on the plane: l2 and l3 have the weight 1."""
    bracket = bianchi("V") @ lp.trivial()
    assert [(str(one.function), one.weight) for one in bracket.semi_invariants(2)] == [
        ("l2", {"l1": 1}),
        ("l3", {"l1": 1}),
    ]
    assert [str(c) for c in bracket.rational_casimirs(1)] == ["l3/l2"]
    assert bracket.casimirs() == []


def test_weights_that_differ_need_powers():
    """A4,5 with a = 1/2, b = -1/3: l2^2/l1 and l1 l3^3 are Casimirs, of degree 2 and 4."""
    bracket = low_dimensional("A4,5", "-1/3", "1/2") @ lp.trivial()
    assert [len(bracket.rational_casimirs(degree)) for degree in (1, 2, 3, 4)] == [0, 1, 1, 2]
    assert [str(c) for c in bracket.rational_casimirs(4)] == ["l1*l2**3", "l3**2/l1"]


CASES = [
    (bianchi("III") @ lp.semidirect(2), 2, 2),
    (bianchi("V") @ lp.semidirect(2), 2, 2),
    (bianchi("V") @ lp.leibniz(2), 2, 2),
    (bianchi("VI", 2) @ lp.trivial(), 3, 1),
    (bianchi("VII", 1) @ lp.trivial(), 4, 0),  # a spiral: no rational one
    (low_dimensional("A4,4") @ lp.trivial(), 2, 1),
    (lp.so(3) @ lp.leibniz(3, "epsilon"), 2, 3),
    (lp.algebras.gl(2) @ lp.trivial(), 2, 2),
    ((lp.so(3) @ lp.trivial()).with_constant({("l1", "l2"): 3}), 2, 1),
    (lp.canonical(1), 2, 0),
]


@pytest.mark.parametrize(("bracket", "degree", "n"), CASES, ids=repr)
def test_what_is_found_is_what_it_is_said_to_be(bracket, degree, n):
    for one in bracket.semi_invariants(degree):
        for name, x in zip(bracket.coordinate_names_in_order, bracket.variables, strict=True):
            assert sp.expand(bracket(x, one.function) - one.weight.get(name, 0) * one.function) == 0
    found = bracket.rational_casimirs(degree)
    assert all(bracket.casimir_certificate(casimir).proved for casimir in found)
    assert len(found) == n
    jacobian = sp.Matrix(found).jacobian(bracket.variables) if found else sp.zeros(1, 1)
    point = {x: sp.Rational(k + 2, 7) ** (k + 1) for k, x in enumerate(bracket.variables)}
    assert jacobian.subs(point).subs("epsilon", 3).rank() == n


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["A3,3", "A3,4", "A4,4", "A4,8", "A3,3+A1"])
def test_a_change_of_basis_changes_no_number_of_rational_casimirs(name):
    algebra = low_dimensional(name)
    wanted = len((algebra @ lp.trivial()).rational_casimirs(2))
    assert wanted
    for one in bases(algebra, 2):
        bracket = one @ lp.trivial()
        found = bracket.rational_casimirs(2)
        assert len(found) == wanted
        assert all(map(bracket.is_casimir, found))


@pytest.mark.parametrize("seed", range(6))
def test_all_semi_invariants_of_degree_two_are_found(seed):
    r"""$\{x, F\} = \lambda F$ for R x acting on R^2 by M: F has the weights of symmetric powers of M, by SymPy."""
    random = Random(seed)
    m = sp.zeros(2, 2)
    while m.det() == 0:
        m = sp.Matrix(2, 2, lambda i, j: random.randint(-2, 2))
    bracket = (
        lp.LieAlgebra.from_brackets(3, {(0, 1): {1: m[0, 0], 2: m[1, 0]}, (0, 2): {1: m[0, 1], 2: m[1, 1]}})
        @ lp.trivial()
    )
    l1, l2, l3 = bracket.variables
    monomials = [a * b for a, b in combinations_with_replacement((l2, l3), 2)]
    images = [sp.Poly(bracket(l1, f), l2, l3) for f in monomials]
    square = sp.Matrix(3, 3, lambda r, c: images[c].coeff_monomial(monomials[r]))
    for value, _, vectors in square.eigenvects():
        if value.is_rational:
            generated = [
                a.function * b.function
                for a, b in combinations_with_replacement(bracket.semi_invariants(1), 2)
                if a.weight.get("l1", 0) + b.weight.get("l1", 0) == value
            ]
            generated += [
                one.function
                for one in bracket.semi_invariants(2)
                if one.degree == 2 and one.weight.get("l1", 0) == value
            ]
            rows = [[sp.Poly(f, l2, l3).coeff_monomial(one) for one in monomials] for f in generated]
            assert sp.Matrix(rows).rank() == len(vectors)


def test_a_linear_tensor_has_them_too():
    tensor = lp.PoissonTensor(["x", "y", "z"], {("x", "y"): "y", ("x", "z"): "z"})
    assert [str(c) for c in tensor.rational_casimirs(1)] == ["z/y"]


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: lp.PoissonTensor(["x", "y"], {("x", "y"): "x*y"}).semi_invariants(1), BracketError, "that is linear"),
        (lambda: (lp.so(3) @ lp.trivial()).rational_casimirs(0), ParameterError, "at least 1; got 0"),
        (lambda: (lp.so(3) @ lp.trivial()).semi_invariants("2"), ParameterError, "at least 1; got '2'"),
        (lambda: (lp.so(6) @ lp.trivial()).rational_casimirs(12), ParameterError, "Lower the degree"),
    ],
)
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()
