from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

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


def test_fields_with_symbols_remember_what_they_relied_on():
    field = real_field([epsilon, sp.Integer(1)])
    field.rely_on(field.read(epsilon * (epsilon**2 + 1) / 2))  # the second factor has no real zero
    field.rely_on(field.read(3 * epsilon))
    assert field.conditions == (epsilon,)
    field.read(1 / (epsilon - 1))
    assert set(field.conditions) == {epsilon, epsilon - 1}


def test_factors_and_real_roots():
    assert Q.factors([Fraction(c) for c in (1, 0, -1)]) == [[1, -1], [1, 1]]
    assert Q.factors([Fraction(c) for c in (2, 0, -4)]) == [[1, 0, -2]]
    assert Q.real_roots([Fraction(c) for c in (1, 0, 0, -2)]) == 1
    assert Q.real_roots([Fraction(c) for c in (1, 0, -3, 1)]) == 3
    with pytest.raises(ParameterError, match="rational coefficients"):
        real_field([sp.sqrt(2)]).real_roots([1, 0, 0, -2])
