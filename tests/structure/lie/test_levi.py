"""Radical, nilradical, Levi factor, subalgebras and quotients."""

from fractions import Fraction
from random import Random

import pytest
import sympy as sp
from flint import fmpq, fmpq_mat
from random_bases import bases, in_another_basis

import liepoisson as lp
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.structure.lie_algebra import LieAlgebra
from liepoisson.structure.lie_algebras import affine, bianchi, galilei, gl, heisenberg, poincare, se, sl, so

KNOWN = {  # dimensions of the radical, of the nilradical and of the Levi factor
    so(4): (0, 0, 6),
    se(3): (3, 3, 3),
    gl(3): (1, 1, 8),  # the centre
    affine(2): (3, 2, 3),  # multiples of 1 and translations; translations
    galilei(3): (7, 7, 3),  # rotations are left
    poincare(3): (4, 4, 6),
    heisenberg(2): (5, 5, 0),
    bianchi("VII", 2): (3, 2, 0),
    so(3) + affine(1): (2, 1, 3),
    lp.algebras.current_algebra(sl(2) @ lp.leibniz(3)): (6, 6, 3),  # g (x) z R[z]/z^3
}


@pytest.mark.parametrize("algebra", KNOWN, ids=repr)
def test_radical_nilradical_and_levi_factor_are_known_in_every_basis(algebra):
    for g in [algebra, *bases(algebra, 2)]:
        r, n, s = g.radical(), g.nilradical(), g.levi_factor()
        assert (r.dimension, n.dimension, s.dimension) == KNOWN[algebra]
        if s.dimension:  # g = s + r as vector spaces, and s is semisimple
            assert g.subalgebra(s).is_semisimple
            assert sp.Matrix([*s.basis, *r.basis]).rank() == g.dimension
            assert g.quotient(r).killing_signature() == g.subalgebra(s).killing_signature()
        if r.dimension:
            assert g.subalgebra(r).is_solvable
        if n.dimension:
            assert g.subalgebra(n).is_nilpotent
            assert n.dimension == g.dimension or g.quotient(n).dimension == g.dimension - n.dimension  # an ideal


def trace(matrix):
    """The trace."""
    total = sum((matrix[k, k] for k in range(matrix.nrows())), fmpq(0))
    return sp.Rational(int(total.p), int(total.q))


def associative_radical(g):
    r"""The x with $\operatorname{tr}(\mathrm{ad}_x\, b) = 0$ for all b of the algebra of matrices that 1 and ad g span.

    By Dickson's theorem these ad x are in its radical, and they make the nilradical of g.
    """
    n = g.dimension
    ad = [
        fmpq_mat(n, n, [fmpq(c.numerator, c.denominator) for row in m for c in row]) for m in g.adjoint_representation()
    ]
    unit = fmpq_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])
    span, rank = [unit], 1
    for b in span:  # grows
        for a in ad:
            grown = fmpq_mat([[*m.entries()] for m in (*span, a * b)]).rank()
            if grown > rank:
                span.append(a * b)
                rank = grown
    forms = sp.Matrix([[trace(a * b) for a in ad] for b in span])
    return forms.nullspace()


@pytest.mark.parametrize(
    "algebra",
    [affine(2), bianchi("VI", 3), bianchi("VII", 0), se(2) + affine(1), heisenberg(1) + so(3), gl(2)],
    ids=repr,
)
def test_the_nilradical_is_where_the_associative_algebra_of_ad_has_its_radical(algebra):
    (g,) = bases(algebra, 1)
    other = associative_radical(g)
    own = g.nilradical()
    assert own.dimension == len(other)
    assert sp.Matrix([*own.basis, *(list(v) for v in other)]).rank() == len(other)


def test_an_element_with_equal_weights_does_not_mislead():
    """x acts by diag(1, 0), y by diag(-1, 1): x + y does by diag(0, 1), and both are outside of the nilradical."""
    g = LieAlgebra.from_brackets(4, {(0, 2): {2: 1}, (1, 2): {2: -1}, (1, 3): {3: 1}})
    assert g.nilradical().basis == ((0, 0, 1, 0), (0, 0, 0, 1))


def test_symbols_are_generic():
    g = bianchi("VI", "a")
    assert g.nilradical().basis == ((0, 1, 0), (0, 0, 1))
    assert g.substitute({"a": 0}).nilradical().dimension == 2


def test_a_quotient_has_the_brackets_modulo_the_ideal():
    """galilei(3) modulo boosts and translations is so(3) and the translation of time."""
    g = galilei(3)
    index = {name: k for k, name in enumerate(g.basis_names)}
    unit = [[int(j == index[name]) for j in range(10)] for name in ("K1", "K2", "K3", "P1", "P2", "P3")]
    found = g.quotient(unit)
    assert found.basis_names == ("J1", "J2", "J3", "H")
    assert found.brackets == so(3).brackets
    random = Random(5)
    moved, P = in_another_basis(g, random)
    coordinates = sp.Matrix(unit) * P.inv()
    assert moved.quotient(coordinates.tolist()).killing_signature() == (0, 3, 1)


def test_a_subalgebra_has_the_given_vectors_as_its_basis():
    """In so(4), (12 + 34)/2, (13 - 24)/2, (14 + 23)/2 are a copy of so(3)."""
    half = Fraction(1, 2)
    found = so(4).subalgebra([(half, 0, 0, 0, 0, half), (0, half, 0, 0, -half, 0), (0, 0, half, half, 0, 0)])
    assert found.killing_signature() == (0, 3, 0)
    assert {tuple(row) for row in found.brackets.values()} == {(2,), (1,), (0,)}


def test_the_opposite_algebra_has_minus_the_bracket():
    g = so(3).opposite()
    assert g.bracket((1, 0, 0), (0, 1, 0)) == (0, 0, -1)
    assert g.opposite().brackets == so(3).brackets


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: so(3).subalgebra([(1, 0, 0), (0, 1, 0)]), BracketError, r"vectors\[0\] and vectors\[1\] is outside"),
        (lambda: so(3).subalgebra([(1, 0, 0), (2, 0, 0)]), BracketError, r"independent; vectors\[1\]"),
        (lambda: so(3).subalgebra([(1, 0)]), ShapeError, "3 components"),
        (lambda: so(3).subalgebra(5), ShapeError, "a sequence of vectors with 3 components; got 5"),
        (lambda: so(3).subalgebra([]), ParameterError, "from 1 to"),
        (lambda: se(2).quotient([(1, 0, 0)]), BracketError, r"\(1, 0, 0\) with basis element 1 is outside"),
        (lambda: se(2).quotient([(1, 0, 0), (0, 1, 0), (0, 0, 1)]), BracketError, "must not be all of se"),
    ],
)
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()
