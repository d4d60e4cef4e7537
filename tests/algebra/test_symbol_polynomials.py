import pickle
from fractions import Fraction

import pytest
import sympy as sp

from liepoisson import _core
from liepoisson.algebra.exact_numbers import exact, is_zero, product_of, substituted, symbols_of, to_sympy
from liepoisson.algebra.symbol_polynomials import Irrational, SymbolPolynomial

k, m = SymbolPolynomial.of("k"), SymbolPolynomial.of("m")
ROOT = SymbolPolynomial.of(Irrational("sqrt", Fraction(2)))
SINE = SymbolPolynomial.of(Irrational("sin", Fraction(2, 7)))
COSINE = SymbolPolynomial.of(Irrational("cos", Fraction(1, 5)))
ABOVE_PI = SymbolPolynomial.of(Irrational("pi", Fraction(-1)))


def test_sums_and_products_are_those_of_sympy():
    third = Fraction(1, 3)
    K, M = sp.symbols("k m")
    found = (third - k * m + ROOT) * (k - third) + 2 * SINE * ABOVE_PI - (-m)
    wanted = sp.expand((sp.Rational(1, 3) - K * M + sp.sqrt(2)) * (K - sp.Rational(1, 3)))
    assert to_sympy(found) == wanted + 2 * sp.sin(2 * sp.pi / 7) / sp.pi + M
    assert symbols_of(found) == {"k", "m"}
    assert to_sympy(product_of(k, third)) == K / 3


@pytest.mark.parametrize(
    ("value", "vanishes"),
    [
        (k - k, True),
        (k * m - m * k, True),
        (k - m, False),
        (k * ROOT - k, False),
        (ROOT * ROOT - Fraction(2), True),
        (COSINE * COSINE * 4 - COSINE * 2 - Fraction(1), True),
        (COSINE * COSINE * 4 - COSINE * 2 - Fraction(2), False),
    ],
)
def test_what_vanishes(value, vanishes):
    assert is_zero(value) is vanishes


def test_values_are_inserted_all_at_once():
    assert substituted(k * m - m, {"k": Fraction(3), "m": Fraction(1, 2)}) == Fraction(1)
    assert substituted(k * m - m, {"k": Fraction(3)}) == 2 * m
    assert substituted(k - m, {"k": m, "m": k}) == m - k
    assert substituted(k * k, {"k": ROOT}) == 2  # which SymPy knows
    assert exact(substituted(k + m, {"k": sp.pi})) == sp.pi + sp.Symbol("m")


def test_the_formula_is_the_number():
    parts = (Fraction(1, 3) - ROOT * 5, SINE * ABOVE_PI, COSINE - Fraction(2))
    record = _core.printed_functions(1, [], [part.formula() for part in parts])
    numbers = [record["instructions"][place - 1][2][-1] for place in record["outputs"]]
    assert numbers == [float(to_sympy(part)) for part in parts]


def test_pickles_are_equal_and_have_hashes_of_their_process():
    value = k * m - ROOT
    hash(value)
    again = pickle.loads(pickle.dumps(value))
    assert again == value
    assert again._hash is None
    assert hash(again) == hash(value)
