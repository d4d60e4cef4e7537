from fractions import Fraction
from itertools import combinations

import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from sympy import legendre_symbol, primefactors

from liepoisson.algebra.quadratic_forms import hyperbolic_triple, three_equal_squares, zero_vector
from liepoisson.algebra.real_fields import RealRationals, Surd, real_field
from liepoisson.errors import ParameterError

Q = RealRationals()
positive = st.fractions(min_value=Fraction(1, 50), max_value=50, max_denominator=50)
epsilon = sp.Symbol("epsilon")


@pytest.mark.thorough
@given(positive, positive)
def test_squares_are_taken_out(d, r):
    root, radicand = Q.extract_square(d * r * r)
    assert root * root * radicand == d * r * r
    assert radicand.denominator == 1
    assert Q.extract_square(d)[1] == radicand  # the square class does not depend on r


@settings(deadline=None, max_examples=20)
@given(positive, positive)
def test_arithmetic_of_surds_is_that_of_real_numbers(a, b):
    x, y = Surd.root(Q, a), Surd.root(Q, b)
    assert (x * x).write(Q) == a
    total = (x + y) * (x - y * Fraction(3))
    exact = sp.expand((sp.sqrt(a) + sp.sqrt(b)) * (sp.sqrt(a) - 3 * sp.sqrt(b)))
    assert sp.simplify(sp.sympify(total.write(Q)) - exact) == 0
    assert not x - x
    assert (Surd.root(Q, Fraction(2)) + Surd.of(Fraction(1))).norm() == -1  # (1 + sqrt 2)(1 - sqrt 2)


@pytest.mark.parametrize(
    ("values", "name"),
    [
        ([sp.Rational(1, 2), sp.Integer(3)], "Q"),
        ([sp.Integer(1), sp.sqrt(2)], "Q(sqrt(2))"),
        ([sp.Integer(1), epsilon], "Q(epsilon)"),
    ],
)
def test_the_field_is_no_larger_than_the_entries(values, name):
    assert real_field(values).name == name


@pytest.mark.parametrize(
    ("value", "radicand", "sign"),
    [
        (12 * epsilon**3 / 5, 15 * epsilon, None),
        (epsilon**2, 1, 1),
        (epsilon**5, epsilon, None),
        (-(epsilon**2) - 1, None, -1),
        (3 + 2 * sp.sqrt(2), 1, 1),  # (1 + sqrt 2)^2
        (sp.sqrt(2) - sp.Rational(3, 2), None, -1),
        (sp.Integer(12 * (2**521 - 1) ** 2), 3, 1),  # found without factoring
    ],
)
def test_squares_and_signs(value, radicand, sign):
    field = real_field([value, epsilon] if value.has(epsilon) else [value])
    given = field.read(value)
    if radicand is not None:
        root, left = field.extract_square(given)
        assert sp.expand(field.write(root * root * left) - value) == 0
        assert field.write(left) == radicand
    if sign is not None:
        assert field.sign(given) == sign
    else:
        with pytest.raises(ParameterError, match=r"sign of .*; got no values for epsilon"):
            field.sign(given)


def test_factors_and_real_roots():
    assert Q.factors([Fraction(c) for c in (1, 0, -1)]) == [[1, -1], [1, 1]]
    assert Q.factors([Fraction(c) for c in (2, 0, -4)]) == [[1, 0, -2]]
    assert Q.real_roots([Fraction(c) for c in (1, 0, 0, -2)]) == 1
    assert Q.real_roots([Fraction(c) for c in (1, 0, -3, 1)]) == 3
    with pytest.raises(ParameterError, match="rational coefficients"):
        real_field([sp.sqrt(2)]).real_roots([1, 0, 0, -2])


nonzero = st.integers(-30, 30).filter(bool)


def value(form, u, v):
    return sum(a * form[i][j] * b for i, a in enumerate(u) for j, b in enumerate(v))


def diagonal(*values):
    return [[Fraction(v) if i == j else Fraction(0) for j in range(3)] for i, v in enumerate(values)]


def hilbert_symbol(a, b, p):
    """(a, b)_p for integers and an odd prime: Serre, A Course in Arithmetic, chapter III."""
    (alpha, u), (beta, v) = (divided(number, p) for number in (a, b))
    sign = (-1) ** (alpha * beta * (p - 1) // 2)
    return sign * legendre_symbol(u, p) ** beta * legendre_symbol(v, p) ** alpha


def divided(number, p):
    power = 0
    while number % p ** (power + 1) == 0:
        power += 1
    return power, number // p**power


@settings(max_examples=40, deadline=None)
@given(nonzero, nonzero, nonzero)
def test_a_zero_is_found_exactly_when_there_is_one_modulo_all_primes(a, b, c):
    """Hasse and Minkowski; by the product formula the prime 2 need not be looked at."""
    assume(min(a, b, c) < 0 < max(a, b, c))
    exists = all(hilbert_symbol(-a * c, -b * c, p) == 1 for p in primefactors(a * b * c) if p > 2)
    form = diagonal(a, b, c)
    vector = zero_vector(form)
    assert (vector is not None) == exists
    if vector is not None:
        assert any(vector)
        assert value(form, vector, vector) == 0


@pytest.mark.parametrize("entry", [sp.Integer(3), 1 + sp.sqrt(2), epsilon])
@pytest.mark.parametrize("order", [(0, 1, 2), (1, 0, 2), (1, 2, 0)])
def test_a_basis_vector_of_length_zero_needs_no_root(entry, order):
    field = real_field([entry])
    rows = [[0, 1, 0], [1, entry, 1], [0, 1, 1]]
    form = [[field.read(sp.sympify(rows[i][j])) for j in order] for i in order]
    triple = hyperbolic_triple(field, form)
    x, y, z = ([c.field_value() if c else field.zero for c in vector] for vector in triple)
    assert value(form, x, y) == value(form, z, z) != 0
    assert not any(value(form, u, v) for u, v in ((x, x), (y, y), (x, z), (y, z)))


@settings(max_examples=12, deadline=None)
@given(st.lists(st.fractions(-9, 9, max_denominator=5), min_size=9, max_size=9), st.fractions(-8, 8, max_denominator=7))
def test_a_multiple_of_three_squares_is_recognised(entries, scale):
    rows = [entries[:3], entries[3:6], entries[6:]]
    form = [[scale * sum(a * b for a, b in zip(u, v, strict=True)) for v in rows] for u in rows]
    (a, b, c), (d, e, f), (g, h, i) = form
    assume(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) != 0)
    found = three_equal_squares(form)
    assert found is not None
    assert len({value(form, v, v) for v in found}) == 1
    assert all(value(form, u, v) == 0 for u, v in combinations(found, 2))


@pytest.mark.parametrize(
    ("squares", "are_equal"),
    [
        *((s, True) for s in ((9, 1, 1), (49, 1, 9), (25, 2, 2), (-18, -2, -2))),
        *((s, False) for s in ((1, 1, 3), (1, 1, 7), (1, 2, 5), (1, 1, 21))),  # anisotropic at an odd prime
    ],
)
def test_multiples_of_three_squares_by_hand(squares, are_equal):
    assert (three_equal_squares(diagonal(*squares)) is not None) is are_equal
