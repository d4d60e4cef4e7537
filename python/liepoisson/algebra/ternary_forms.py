r"""Ternary quadratic forms over the rationals: when a multiple is $x^2+y^2+z^2$ or has a zero, and how to see it.

A lattice on which a multiple of the form is integral with determinant +-1 exists unless the form is anisotropic at an
odd prime; it is found prime by prime.  On it, a definite form is $x^2+y^2+z^2$, and an indefinite form has a short
vector of length zero: both are read from a reduced basis.

References: Simon, "Solving quadratic equations using reduced unimodular quadratic forms", Math. Comp. 74 (2005) 1531;
Serre, A Course in Arithmetic, chapters IV and V.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations, product
from math import gcd
from typing import Any, TypeAlias

from liepoisson.algebra.diagonal_forms import diagonalise, restricted, value
from liepoisson.algebra.echelon import Echelon, sparse
from liepoisson.algebra.matrices import determinant
from liepoisson.algebra.number_fields import PrimeField
from liepoisson.algebra.real_fields import RealRationals

RationalVector: TypeAlias = list[Fraction]
IntegerMatrix: TypeAlias = list[list[int]]

_FACTOR_BITS = 128  # a determinant with two large prime factors would take minutes beyond that
_SHORT = 3  # coefficients of short vectors in a reduced basis


def three_equal_squares(form: Sequence[Sequence[Fraction]]) -> list[RationalVector] | None:
    """Three orthogonal rational vectors with one common value of a definite form, or None if there are none.

    None also if the determinant is too hard to factor.
    """
    basis = unimodular_basis(form)
    if basis is None:
        return None
    sign = 1 if form[0][0] > 0 else -1
    positive = [[sign * c for c in row] for row in form]
    gram = restricted(positive, basis)
    unit = determinant(gram, 0)  # the form is u times one of determinant 1, and this is the cube of u
    vectors = [v for v in _short_vectors(basis, gram) if value(positive, v, v) ** 3 == unit]
    found = next((t for t in combinations(vectors, 3) if not any(value(form, u, v) for u, v in combinations(t, 2))), ())
    return list(found) or None


def zero_vector(form: Sequence[Sequence[Fraction]]) -> RationalVector | None:
    """A rational vector with q(v, v) = 0 of an indefinite form, or None if there is none.

    None also if the determinant is too hard to factor.
    """
    basis = unimodular_basis(form)
    if basis is None:
        return None
    vectors = _short_vectors(basis, _majorant(restricted(form, basis)))
    return next((v for v in vectors if not value(form, v, v)), None)


def unimodular_basis(form: Sequence[Sequence[Fraction]]) -> list[RationalVector] | None:
    """A basis in which a multiple of a nondegenerate form has integer entries and determinant +-1, if there is one."""
    from flint import fmpz

    basis: list[RationalVector] = [[Fraction(int(i == j)) for j in range(3)] for i in range(3)]
    gram = _primitive(form)
    size = abs(determinant(gram, 0))
    if size.bit_length() > _FACTOR_BITS:
        return None
    for prime in [int(p) for p, _ in fmpz(size).factor()]:
        while determinant(gram, 0) % prime == 0:
            change = _smaller(gram, prime)
            if change is None:
                return None
            basis = [_combination(row, basis) for row in change]
            gram = _primitive(restricted(form, basis))
    return basis


def _smaller(gram: IntegerMatrix, p: int) -> list[RationalVector] | None:
    """A change of basis that lowers the power of p in the determinant; None if the form is anisotropic at p."""
    frame, size = _kernel_first(gram, p)
    G = restricted(gram, frame)
    e, f, g = ([Fraction(c) for c in row] for row in frame)
    if size == 2:
        return [e, f, [p * c for c in g]]
    if G[0][0] % p**2 == 0:
        return [[c / p for c in e], f, g]
    pair = _zero_modulo(G[1][1], G[1][2], G[2][2], p)
    if pair is None:
        return None
    u = [pair[0] * a + pair[1] * b for a, b in zip(f, g, strict=True)]
    return [[c / p for c in e], [c / p for c in u], g if pair[0] else f]


def _kernel_first(gram: IntegerMatrix, p: int) -> tuple[IntegerMatrix, int]:
    """A basis of Z^3 whose first vectors are the kernel modulo p, and their number, 1 or 2."""
    field = PrimeField(p)
    form = Echelon(field, (sparse(map(field.number, row)) for row in gram))
    form.basis()  # reduces the rows
    free = [k for k in range(3) if k not in form.rows]
    kernel = [[-int(form.rows[k].get(f, 0)) if k in form.rows else int(k == f) for k in range(3)] for f in free]
    return [*kernel, *([int(k == j) for k in range(3)] for j in form.rows)], len(free)


def _zero_modulo(a: int, b: int, c: int, p: int) -> tuple[int, int] | None:
    """A zero (x, y) != 0 of a x^2 + 2 b x y + c y^2 modulo the prime p, if there is one."""
    from flint import fmpz

    if c % p == 0:
        return 0, 1
    if p == 2:
        return 1, a % 2
    discriminant = (b * b - a * c) % p
    if pow(discriminant, (p - 1) // 2, p) == p - 1:  # Euler: not a square modulo p
        return None
    root = int(fmpz(discriminant).sqrtmod(fmpz(p)))
    return 1, (root - b) * pow(c, -1, p) % p


def _short_vectors(basis: Sequence[RationalVector], positive: Sequence[Sequence[Fraction]]) -> list[RationalVector]:
    """Combinations of a lattice basis that are short in a positive form, one of each pair +-v, the shortest first."""
    from flint import fmpz_mat

    gram: Any = fmpz_mat(3, 3, [c for row in _primitive(positive) for c in row])
    _, change = gram.lll(transform=True, rep="gram")
    reduced = [[Fraction(int(change[i, j])) for j in range(3)] for i in range(3)]
    weights = [w for w in product(range(-_SHORT, _SHORT + 1), repeat=3) if w > (0, 0, 0)]
    short = sorted((_combination(w, reduced) for w in weights), key=lambda v: value(positive, v, v))
    return [_combination(v, basis) for v in short]


def _combination(weights: Sequence[Fraction | int], vectors: Sequence[RationalVector]) -> RationalVector:
    return [sum((w * v[k] for w, v in zip(weights, vectors, strict=True)), Fraction(0)) for k in range(3)]


def _majorant(form: Sequence[Sequence[Fraction]]) -> list[RationalVector]:
    """A positive form that bounds |q|: the squares of a diagonal form with positive signs."""
    result = [[Fraction(0)] * 3 for _ in range(3)]
    for u, q in diagonalise(RealRationals(), form):  # the coordinate of v along u is q(u, v)/q(u, u)
        image = [value(form, u, [Fraction(int(i == j)) for j in range(3)]) for i in range(3)]
        for i, j in product(range(3), repeat=2):
            result[i][j] += image[i] * image[j] / abs(q)
    return result


def _primitive(form: Sequence[Sequence[Fraction | int]]) -> IntegerMatrix:
    """The multiple with coprime integer entries, up to sign."""
    entries = [Fraction(c) for row in form for c in row]
    scale = 1
    for c in entries:
        scale = scale * c.denominator // gcd(scale, c.denominator)
    divisor = gcd(*(int(c * scale) for c in entries))
    return [[int(Fraction(c) * scale) // divisor for c in row] for row in form]
