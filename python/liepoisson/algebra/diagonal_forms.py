"""Quadratic forms over a real field: their values, and orthogonal bases."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TypeAlias

from liepoisson.algebra.real_fields import RealField, Scalar

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
