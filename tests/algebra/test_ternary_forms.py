from fractions import Fraction
from itertools import combinations
from math import gcd, lcm

import pytest
from flint import fmpz_mat
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from sympy import legendre_symbol, primefactors

from liepoisson.algebra.ternary_forms import three_equal_squares, unimodular_basis, zero_vector

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


@pytest.mark.thorough
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


@pytest.mark.thorough
@settings(max_examples=25, deadline=None)
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


def test_the_lattice_is_unimodular():
    for form in (diagonal(3, -50, 6), diagonal(2, 3, 6), diagonal(1, 1, -5)):
        basis = unimodular_basis(form)
        gram = [[value(form, u, v) for v in basis] for u in basis]
        scale = lcm(*(entry.denominator for row in gram for entry in row))
        whole = [[int(entry * scale) for entry in row] for row in gram]
        common = gcd(*(entry for row in whole for entry in row))
        assert abs(fmpz_mat(whole).det()) == common**3
