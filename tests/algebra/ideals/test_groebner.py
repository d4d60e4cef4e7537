"""Gröbner bases against SymPy's, against systems whose number of solutions is known, and against false candidates."""

import pytest
import sympy as sp
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from known_systems import cyclic, katsura

from liepoisson.algebra.ideals import groebner
from liepoisson.algebra.ideals.groebner import degree, dimension, groebner_basis, rational_context, standard_monomials
from liepoisson.algebra.ideals.limits import Limits, NotDecidedError
from liepoisson.algebra.residues import PRIME, primes

X, Y, Z = symbols = sp.symbols("x y z")
CONTEXT = rational_context(["x", "y", "z"])
LEX = rational_context(["x", "y", "z"], lexicographic=True)


def in_flint(expression, context=CONTEXT):
    terms = sp.Poly(expression, *symbols).terms()
    return context.from_dict({m: fmpq(int(c.p), int(c.q)) for m, c in terms})


def in_sympy(p):
    terms = {tuple(map(int, m)): sp.Rational(int(c.p), int(c.q)) for m, c in p.terms()}
    return sp.Poly.from_dict(terms, *symbols).as_expr()


monomials = st.tuples(*[st.integers(0, 2)] * 3)
coefficients = st.fractions(-5, 5, max_denominator=7).map(lambda c: sp.Rational(c.numerator, c.denominator))
polynomials = st.dictionaries(monomials, coefficients, min_size=1, max_size=4).map(
    lambda terms: sp.Add(*(c * X**i * Y**j * Z**k for (i, j, k), c in terms.items()))
)


@pytest.mark.thorough
@given(st.lists(polynomials, min_size=1, max_size=3), st.booleans())
@settings(max_examples=15, deadline=None)
def test_reduced_bases_are_those_of_sympy(expressions, lexicographic):
    context = LEX if lexicographic else CONTEXT
    try:
        found = groebner_basis([in_flint(e, context) for e in expressions], Limits(work=2_000_000))
    except NotDecidedError:
        return
    expected = sp.groebner(expressions, *symbols, order="lex" if lexicographic else "grevlex", domain=sp.QQ)
    expected = {sp.Poly(e, *symbols, domain=sp.QQ).as_expr() for e in expected.exprs if e != 0}
    order = sp.polys.orderings.monomial_key("lex" if lexicographic else "grevlex")
    expected = {sp.expand(e / sp.Poly(e, *symbols).LC(order=order)) for e in expected}
    assert {sp.expand(in_sympy(p)) for p in found.polynomials} == expected


@pytest.mark.parametrize(
    ("equations", "dim", "deg"),
    [(cyclic(3), 0, 6), (cyclic(4), 1, 4), (cyclic(5), 0, 70), *((katsura(n), 0, 2**n) for n in (2, 3, 5))],
)
def test_solutions_are_as_many_as_known(equations, dim, deg):
    basis = groebner_basis(equations)
    assert (basis.dimension, basis.degree) == (dim, deg)
    if dim == 0:
        assert len(basis.standard_monomials()) == deg


def test_a_prime_that_gives_another_ideal_does_no_harm():
    # x y = 1 and x = -p y: y^2 = -1/p, and modulo the first prime, which is p, there is no solution
    p = PRIME
    assert next(primes()) == p
    x, y, _ = CONTEXT.gens()
    basis = groebner_basis([x * y - 1, x + p * y])
    assert [str(q) for q in basis.polynomials] == [f"x + {p}*y", f"y^2 + 1/{p}"]


def test_without_a_proof_there_is_no_basis(monkeypatch):
    x, y, _ = CONTEXT.gens()
    monkeypatch.setattr(groebner, "are_groebner", lambda *_: False)
    with pytest.raises(NotDecidedError):
        groebner_basis([x * y - 1, x + y], Limits(work=20_000))


def test_work_that_is_too_much_is_not_decided():
    with pytest.raises(NotDecidedError, match=r"not decided within 1e\+04 units of work"):
        groebner_basis(katsura(5), Limits(work=10_000))


@pytest.mark.parametrize(
    ("leads", "n", "dim", "deg"),
    [
        ([], 3, 3, 1),
        ([(1, 1, 0), (1, 0, 1)], 3, 2, 1),  # x = 0 and the line y = z = 0
        ([(2, 0, 0), (0, 3, 0), (0, 0, 5)], 3, 0, 30),
        ([(2, 0), (1, 1), (0, 2)], 2, 0, 3),
        ([(3, 0, 0)], 3, 2, 3),
        ([(0, 0)], 2, -1, 0),
    ],
)
def test_dimension_and_degree_of_monomial_ideals(leads, n, dim, deg):
    assert (dimension(leads, n), degree(leads, n)) == (dim, deg)
    if dim <= 0:
        assert len(standard_monomials(leads, n)) == deg
