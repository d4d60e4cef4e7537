"""Helpers for the tests of extensions: products in another basis, written without the library."""

from fractions import Fraction
from itertools import product

import sympy as sp
from flint import fmpq, fmpq_mat

from liepoisson.structure.extension import Extension


def algebra(n, products, *, unital=True, **options):
    """An extension from its products; e_0 is the unit unless told otherwise."""
    unit = {(0, k): {k: 1} for k in range(n)} if unital else {}
    return Extension.from_products(n, unit | products, **options)


def rational(values):
    return fmpq_mat(
        len(values), len(values), [fmpq(Fraction(v).numerator, Fraction(v).denominator) for r in values for v in r]
    )


def in_basis(extension, rows):
    """The extension in the basis e'_i = sum_j rows[i][j] e_j, rows rational; None if they are dependent."""
    n, W = extension.dimension, extension.tensor
    matrix = rational(rows)
    if matrix.det() == 0:
        return None
    inverse = [[Fraction(int(c.p), int(c.q)) for c in row] for row in matrix.inv().tolist()]
    tensor = [[[Fraction(0)] * n for _ in range(n)] for _ in range(n)]
    for i, j in product(range(n), repeat=2):
        old = [sum(rows[i][a] * rows[j][b] * W[c][a][b] for a in range(n) for b in range(n)) for c in range(n)]
        for k in range(n):
            tensor[k][i][j] = sum((old[c] * inverse[c][k] for c in range(n)), Fraction(0))
    return Extension(tensor, name="moved")


def assert_normal(extension, classification):
    """The change of basis brings the products of the extension to those of the normal form: SymPy's verdict."""
    n, W, N = extension.dimension, extension.tensor, classification.normal_form.tensor
    P = sp.Matrix(n, n, lambda i, j: sp.sympify(classification.change_of_basis[i][j]))
    assert sp.simplify(P.det()) != 0
    for i, j, c in product(range(n), repeat=3):
        pairs = product(range(n), repeat=2)
        left = sum(P[i, a] * P[j, b] * sp.sympify(W[c][a][b]) for a, b in pairs if W[c][a][b] != 0)
        right = sum(sp.sympify(N[k][i][j]) * P[k, c] for k in range(n))
        assert sp.simplify(left - right) == 0, f"e'_{i} e'_{j} along e_{c}"
