"""Words in the matrices of several fields: Leibniz extensions in closed form, others by linear algebra."""

from collections import Counter

import pytest
import sympy as sp

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.linear_algebra import rank
from liepoisson.structure.extension import Extension
from liepoisson.structure.extensions import crmhd, leibniz, semidirect
from liepoisson.structure.trace_words import balanced_combinations, canonical, leibniz_combinations

epsilon = sp.Symbol("epsilon")


@pytest.mark.parametrize(("n", "degree"), [(1, 4), (2, 3), (3, 2), (3, 4), (4, 3)])
def test_leibniz_words_are_the_powers_of_z(n, degree):
    """Against the product (epsilon x0 z^(n-1) + ... + x_(n-1))^degree of noncommuting x, multiplied out by SymPy."""
    z = sp.Symbol("z")
    x = sp.symbols(f"x0:{n}", commutative=False)
    first = (epsilon if n > 1 else 1) * x[0] * z ** (n - 1)
    product = sp.expand((first + sum(x[k] * z ** (n - 1 - k) for k in range(1, n))) ** degree)
    for power, found in zip(reversed(range(n)), leibniz_combinations(n, degree, epsilon), strict=True):
        wanted = Counter()
        for term in sp.Add.make_args(product.coeff(z, power)):
            number, factors = term.args_cnc()
            letters = [int(str(sp.Pow(f, 1).as_base_exp()[0])[1:]) for f in factors for _ in range(f.as_base_exp()[1])]
            wanted[canonical(tuple(letters))] += sp.Mul(*number)
        ratio = {sp.cancel(wanted[word] / found[word]) for word in found}
        assert set(wanted) == set(found)
        assert len(ratio) == 1
        assert ratio.pop().is_Integer


@pytest.mark.parametrize(("n", "degree"), [(2, 4), (3, 3)])
def test_linear_algebra_finds_the_powers_of_z(n, degree):
    closed, found = list(leibniz_combinations(n, degree, epsilon)), balanced_combinations(leibniz(n, epsilon), degree)
    assert len(found) == len(closed) == n
    words = sorted({word for combination in (*closed, *found) for word in combination})
    rows = [{words.index(w): sp.sympify(q) for w, q in c.items()} for c in (*closed, *found)]
    field = Coefficients.containing([q for row in rows for q in row.values()])
    assert rank([{k: field.read(q) for k, q in row.items()} for row in rows], field) == n


def test_passive_fields_give_all_their_words():
    """A = R + m with m^2 = 0: every word without l, 2 of 4 letters with two a and two b that are no rotations."""
    found = balanced_combinations(semidirect(3), 4)
    words = {word for combination in found for word in combination}
    assert all(0 not in word for word in words)
    assert {(1, 1, 2, 2), (1, 2, 1, 2)} <= words
    assert len(found) == 6


def test_complex_numbers_double_the_traces():
    """so(3) (x) C = so(3, 1): real and imaginary part of tr X^2."""
    numbers = Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 1): {0: -1}})
    found = balanced_combinations(numbers, 2)
    assert [sorted(c) for c in found] == [[(0, 1)], [(0, 0), (1, 1)]]
    assert sp.cancel(found[1][0, 0] / found[1][1, 1]) == -1
    assert (len(balanced_combinations(crmhd(), 2)), balanced_combinations(crmhd(), 6)) == (4, [])  # too many words
