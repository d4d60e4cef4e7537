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


def test_the_field_is_no_larger_than_the_entries():
    assert real_field([Fraction(1), Fraction(1, 2)]).name == "Q"
    assert real_field([sp.Rational(1, 2), sp.Integer(3)]).name == "Q"
    assert real_field([sp.Integer(1), sp.sqrt(2)]).name == "Q(sqrt(2))"
    assert real_field([sp.Integer(1), epsilon]).name == "Q(epsilon)"


@pytest.mark.thorough
@given(positive, positive)
def test_squares_are_taken_out(d, r):
    root, radicand = Q.extract_square(d * r * r)
    assert root * root * radicand == d * r * r
    assert radicand.denominator == 1
    assert Q.extract_square(d)[1] == radicand  # the square class does not depend on r


def test_squares_of_large_numbers_are_found_without_factoring():
    prime = 2**521 - 1
    assert Q.extract_square(Fraction(prime**2)) == (prime, 1)
    assert Q.extract_square(Fraction(12 * prime**2)) == (2 * prime, 3)


@pytest.mark.thorough
@settings(deadline=None)
@given(positive, positive)
def test_arithmetic_of_surds_is_that_of_real_numbers(a, b):
    x, y = Surd.root(Q, a), Surd.root(Q, b)
    assert (x * x).write(Q) == a
    total = (x + y) * (x - y * Fraction(3))
    exact = sp.expand((sp.sqrt(a) + sp.sqrt(b)) * (sp.sqrt(a) - 3 * sp.sqrt(b)))
    assert sp.simplify(sp.sympify(total.write(Q)) - exact) == 0
    assert not x - x


def test_the_norm_of_a_surd():
    root = Surd.root(Q, Fraction(2))
    assert (root + Surd.of(Fraction(1))).norm() == -1  # (1 + sqrt 2)(1 - sqrt 2)
    assert Surd({}).norm() == 0


def test_fields_with_symbols_remember_what_they_relied_on():
    field = real_field([epsilon, sp.Integer(1)])
    field.rely_on(field.read(epsilon * (epsilon**2 + 1) / 2))  # the second factor has no real zero
    field.rely_on(field.read(3 * epsilon))
    assert field.conditions == (epsilon,)
    field.read(1 / (epsilon - 1))
    assert set(field.conditions) == {epsilon, epsilon - 1}


def test_signs_of_expressions():
    field = real_field([epsilon, sp.Integer(1)])
    assert field.sign(field.read(-(epsilon**2) - 1)) == -1
    assert field.sign(field.read(epsilon**2)) == 1
    with pytest.raises(ParameterError, match="sign of epsilon; got no values for epsilon"):
        field.sign(field.read(epsilon))
    root = real_field([sp.sqrt(2)])
    assert root.sign(root.read(sp.sqrt(2) - sp.Rational(3, 2))) == -1


def test_squares_in_larger_fields():
    field = real_field([epsilon, sp.Integer(1)])
    root, radicand = field.extract_square(field.read(12 * epsilon**3 / 5))
    assert field.write(root * root * radicand) == 12 * epsilon**3 / 5
    assert field.write(radicand) == 15 * epsilon
    number = real_field([sp.sqrt(2)])
    root, radicand = number.extract_square(number.read(3 + 2 * sp.sqrt(2)))  # (1 + sqrt 2)^2
    assert radicand == number.one
    assert root * root == number.read(3 + 2 * sp.sqrt(2))


def test_factors_and_real_roots():
    assert Q.factors([Fraction(c) for c in (1, 0, -1)]) == [[1, -1], [1, 1]]
    assert Q.factors([Fraction(c) for c in (2, 0, -4)]) == [[1, 0, -2]]
    assert Q.real_roots([Fraction(c) for c in (1, 0, 0, -2)]) == 1
    assert Q.real_roots([Fraction(c) for c in (1, 0, -3, 1)]) == 3
    with pytest.raises(ParameterError, match="rational coefficients"):
        real_field([sp.sqrt(2)]).real_roots([1, 0, 0, -2])
