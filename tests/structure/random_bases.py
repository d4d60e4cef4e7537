"""Lie algebras in other bases, written out: what does not depend on a basis must not change."""

from fractions import Fraction
from random import Random

import numpy as np
import sympy as sp

from liepoisson.structure.lie_algebra import LieAlgebra


def unimodular(n, random):
    """A matrix of integers with the determinant 1 and its inverse: products of triangular ones."""
    lower, upper = sp.eye(n), sp.eye(n)
    for i in range(n):
        for j in range(i):
            lower[i, j], upper[j, i] = random.randint(-1, 1), random.randint(-1, 1)
    P = lower * upper
    return P, P.inv()


def in_another_basis(algebra, random):
    r"""The algebra in the basis $f_i = P_{ij} e_j$: $c'_{ij}{}^k = P_{ip} P_{jq} c_{pq}{}^r (P^{-1})_{rk}$."""
    P, inverse = unimodular(algebra.dimension, random)
    p, q = np.array(P.tolist(), dtype=object), np.array(inverse.tolist(), dtype=object)
    c = np.array([[[sp.sympify(v) for v in row] for row in plane] for plane in algebra.structure_constants])
    moved = np.tensordot(np.tensordot(p, np.tensordot(p, c, (1, 1)), (1, 1)), q, (2, 0))  # i, j, k
    return LieAlgebra([[[exact(v) for v in row] for row in plane] for plane in moved]), P


def exact(value):
    value = sp.expand(value)
    return Fraction(int(value.p), int(value.q)) if value.is_Rational else value


def bases(algebra, n=3, seed=1):
    """The algebra in some random bases."""
    random = Random(seed)
    return [in_another_basis(algebra, random)[0] for _ in range(n)]
