r"""Quadratic forms over a real field up to a factor: diagonal form, signature, and bases of the standard shapes.

A form q with symmetric matrix Q is brought to a multiple of $xy$, $x^2+y^2$, $xy+z^2/2$ or $x^2+y^2+z^2$ (that is, the
products $q(x, y)$ of the basis vectors become 0 or one common value), with as few square roots as we know how.
Over the rationals `ternary_forms` decides whether a form of three variables needs any.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from liepoisson.algebra.diagonal_forms import Coordinates, Form, combined, diagonalise, restricted, value
from liepoisson.algebra.linear_systems import null_space
from liepoisson.algebra.real_fields import RealField, RealRationals, Scalar, Surd
from liepoisson.algebra.ternary_forms import three_equal_squares, zero_vector

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
