r"""Quadratic forms over a real field up to a factor: diagonal form, signature, and bases of the standard shapes.

A form q with symmetric matrix Q is brought to a multiple of $xy$, $x^2+y^2$, $xy+z^2/2$ or $x^2+y^2+z^2$ (that is, the
products $q(x, y)$ of the basis vectors become 0 or one common value), with as few square roots as we know how.

Over the rationals it is decided whether a form of three variables needs any. A lattice on which a multiple of the form
is integral with determinant +-1 exists unless the form is anisotropic at an odd prime; it is found prime by prime. On
it, a definite form is $x^2+y^2+z^2$, and an indefinite form has a short vector of length zero: both are read from a
reduced basis.

References: Simon, "Solving quadratic equations using reduced unimodular quadratic forms", Math. Comp. 74 (2005) 1531;
Serre, A Course in Arithmetic, chapters IV and V.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations, product
from math import gcd
from typing import Any, TypeAlias

from liepoisson.algebra.echelon import Echelon, sparse
from liepoisson.algebra.matrices import determinant, null_space
from liepoisson.algebra.number_fields import PrimeField
from liepoisson.algebra.real_fields import RealField, RealRationals, Scalar, Surd

SurdCoordinates: TypeAlias = list[Surd]


def signature(field: RealField, diagonal: Sequence[tuple[Coordinates, Scalar]]) -> tuple[int, int]:
    """Numbers of squares of the two signs, the larger one first: the form counts up to a factor."""
    signs = [field.sign(q / diagonal[0][1]) for _, q in diagonal]
    positive = signs.count(1)
    return max(positive, len(signs) - positive), min(positive, len(signs) - positive)


def hyperbolic_pair(field: RealField, form: Form) -> tuple[SurdCoordinates, SurdCoordinates]:
    """Vectors x, y with q(x, x) = q(y, y) = 0 of a nondegenerate indefinite binary form."""
    for v in ([field.one, field.zero], [field.zero, field.one]):
        if not value(form, v, v):
            other = [v[1], v[0]]
            weight = -(value(form, other, other) / (value(form, v, other) * field.number(2)))
            field.rely_on(value(form, v, other))
            pair = _lifted(v), _lifted(combined(other, v, weight))
            return pair if v[0] else (pair[1], pair[0])
    (u, a), (w, b) = diagonalise(field, form)
    root = Surd.root(field, -(a * b))  # q(root u +- a w) = root^2 a + a^2 b = 0
    left, right = [root * c for c in _lifted(u)], _lifted([a * c for c in w])
    return [x + y for x, y in zip(left, right, strict=True)], [x - y for x, y in zip(left, right, strict=True)]


def equal_squares(field: RealField, form: Form) -> list[SurdCoordinates]:
    """Orthogonal vectors with one common value of a definite form of two or three variables."""
    if len(form) == 3 and isinstance(field, RealRationals):
        found = three_equal_squares(form)
        if found is not None:
            return [_lifted(v) for v in found]
    (first, a), *others = diagonalise(field, form)
    result = [_lifted(first)]
    for u, b in others:  # (root / b)^2 b = a
        root = Surd.root(field, a * b) * (field.one / b)
        result.append([root * c for c in _lifted(u)])
    return result


def hyperbolic_triple(field: RealField, form: Form) -> tuple[SurdCoordinates, SurdCoordinates, SurdCoordinates]:
    """Vectors x, y, z with q(x, y) = q(z, z) and all other products zero, of an indefinite ternary form."""
    x, y, z = _isotropic_frame(field, form)
    q_xy, q_zz = _surd_value(form, x, y), _surd_value(form, z, z)
    ratio = q_zz.field_value() / q_xy.field_value()
    return x, [c * ratio for c in y], z


def _isotropic_frame(field: RealField, form: Form) -> tuple[SurdCoordinates, SurdCoordinates, SurdCoordinates]:
    isotropic = _rational_isotropic(field, form)
    if isotropic is not None:
        partner = next(v for v in _unit_vectors(field, 3) if value(form, isotropic, v))
        q = value(form, isotropic, partner)
        field.rely_on(q)
        weight = -(value(form, partner, partner) / (q * field.number(2)))
        y = combined(partner, isotropic, weight)
        (z,) = null_space(field, [_sum_of(isotropic, form), _sum_of(y, form)], 3)
        return _lifted(isotropic), _lifted(y), _lifted(list(z))
    diagonal = diagonalise(field, form)
    pairs = [(i, j) for i, j in ((0, 1), (0, 2), (1, 2)) if field.sign(-(diagonal[i][1] * diagonal[j][1])) > 0]
    i, j = min(pairs, key=lambda pair: _root_size(field, -(diagonal[pair[0]][1] * diagonal[pair[1]][1])))
    plane = [diagonal[i][0], diagonal[j][0]]
    x, y = hyperbolic_pair(field, restricted(form, plane))
    k = 3 - i - j
    return _expanded(x, plane), _expanded(y, plane), _lifted(diagonal[k][0])


def _rational_isotropic(field: RealField, form: Form) -> Coordinates | None:
    """A vector with q = 0 over the field itself: one of the basis, or over Q a zero if there is one."""
    for v in _unit_vectors(field, 3):
        if not value(form, v, v):
            return v
    return zero_vector(form) if isinstance(field, RealRationals) else None


def _root_size(field: RealField, radicand: Scalar) -> tuple[bool, int]:
    square_free = field.extract_square(radicand)[1]
    return square_free != field.one, len(str(square_free))


def _unit_vectors(field: RealField, n: int) -> list[Coordinates]:
    return [[field.one if i == j else field.zero for j in range(n)] for i in range(n)]


def _sum_of(coefficients: Coordinates, vectors: Sequence[Sequence[Scalar]]) -> Coordinates:
    columns = list(zip(*vectors, strict=True))
    return [sum((c * x for c, x in zip(coefficients, column, strict=True)), coefficients[0] * 0) for column in columns]


def _lifted(u: Coordinates) -> SurdCoordinates:
    return [Surd.of(c) for c in u]


def _expanded(u: SurdCoordinates, vectors: Sequence[Coordinates]) -> SurdCoordinates:
    columns = list(zip(*vectors, strict=True))
    return [sum((c * x for c, x in zip(u, column, strict=True)), Surd({})) for column in columns]


def _surd_value(form: Form, u: SurdCoordinates, v: SurdCoordinates) -> Surd:
    terms = (a * q * b for a, row in zip(u, form, strict=True) for q, b in zip(row, v, strict=True))
    return sum(terms, Surd({}))


Form: TypeAlias = Sequence[Sequence[Scalar]]
"""The symmetric matrix of a form."""

Coordinates: TypeAlias = list[Scalar]
"""A vector, by its coordinates."""


def value(form: Form, u: Sequence[Scalar], v: Sequence[Scalar]) -> Scalar:
    """The bilinear form q(u, v)."""
    terms = [a * q * b for a, row in zip(u, form, strict=True) for q, b in zip(row, v, strict=True) if a and q and b]
    return sum(terms[1:], terms[0]) if terms else form[0][0] - form[0][0]


def restricted(form: Form, vectors: Sequence[Sequence[Scalar]]) -> list[list[Scalar]]:
    """The matrix of the form in a basis."""
    return [[value(form, u, v) for v in vectors] for u in vectors]


def diagonalise(field: RealField, form: Form) -> list[tuple[Coordinates, Scalar]]:
    """Orthogonal vectors u and their values q(u, u) != 0, as many as the rank of the form."""
    n = len(form)
    vectors = [[field.one if i == j else field.zero for j in range(n)] for i in range(n)]
    found: list[tuple[Coordinates, Scalar]] = []
    while (u := _anisotropic(field, form, vectors)) is not None:
        q = value(form, u, u)
        field.rely_on(q)
        found.append((u, q))
        rest = [combined(v, u, -(value(form, u, v) / q)) for v in vectors]
        vectors = [v for v in rest if any(v)]
    return found


def _anisotropic(field: RealField, form: Form, vectors: Sequence[Coordinates]) -> Coordinates | None:
    candidates = [v for v in vectors if value(form, v, v)]
    if not candidates:
        pairs = ((u, v) for u, v in product(vectors, repeat=2) if value(form, u, v))
        candidates = [combined(u, v, field.one) for u, v in pairs]
    return next((v for v in candidates if field.is_constant(value(form, v, v))), candidates[0] if candidates else None)


def combined(u: Coordinates, v: Coordinates, factor: Scalar) -> Coordinates:
    """U + factor v."""
    return [a + factor * b for a, b in zip(u, v, strict=True)]


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
