"""Arithmetic with entries of Lax pairs, compared with SymPy's."""

from fractions import Fraction

import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.integrability.lax.entries import EntryArithmetic

x, y, z, a = sp.symbols("x y z a")
i = sp.I

LAURENT = [
    (3 * x / 2 - i * y * z + 2 / z, x * z**2 + i / z - a / 3),
    (i * x + y, -i * x + y),
    ((1 + i) * x / a + z, (2 - i) / (a**2 * z**3) + y),
    (sp.exp((x - y) / 2) + z, sp.exp((y - x) / 2) / z + sp.exp(x / 3)),
    (-i * sp.exp(x) * y, i * sp.exp(-x) / 7),
]
OTHERS = [(sp.sqrt(2) * x + z, sp.sqrt(2) * y - 1 / z), (sp.sin(x) * z, sp.sin(x) - i)]


@pytest.mark.parametrize(("f", "g"), LAURENT + OTHERS)
def test_products_and_powers_are_those_of_sympy(f, g):
    arithmetic = EntryArithmetic([f, g])
    assert arithmetic.is_rational == ((f, g) in LAURENT)
    p, q = arithmetic.read(f), arithmetic.read(g)
    for element, expression in (
        (p * q, f * g),
        (p * p * p - q, f**3 - g),
        (p * arithmetic.number(Fraction(-2, 3)), -2 * f / 3),
    ):
        assert sp.expand(arithmetic.write(arithmetic.canonical(element)) - expression) == 0
        assert not arithmetic.vanishes(element)
        collected = sum(arithmetic.write(c) * z**n for n, c in arithmetic.by_power(element, z).items())
        assert sp.expand(collected - expression) == 0
        assert not any(arithmetic.write(c).has(z) for c in arithmetic.by_power(element, z).values())
        real, imaginary = (arithmetic.write(part) for part in arithmetic.parts(element))
        assert sp.expand(real + i * imaginary - expression) == 0
        assert not real.has(i)
        assert not imaginary.has(i)
    assert arithmetic.vanishes(p * q - q * p)
    assert arithmetic.vanishes((p + q) * (p - q) - p * p + q * q)


def test_the_characteristic_polynomial_is_that_of_sympy():
    matrix = sp.Matrix([[x, i * z, 1 / z], [y, -x, a], [z**2, 3, x * y]])
    arithmetic = EntryArithmetic(list(matrix))
    rows = [[arithmetic.read(e) for e in row] for row in matrix.tolist()]
    found = [arithmetic.write(c) for c in arithmetic.characteristic_coefficients(rows)]
    assert [sp.expand(c) for c in matrix.charpoly().all_coeffs()] == [sp.expand(c) for c in found]


@pytest.mark.parametrize("name", ["three-wave", "toda", "kovalevskaya"])
def test_pairs_of_the_catalog_need_no_expressions(name):
    assert lp.integrability.known_lax_pair(name).arithmetic.is_rational
