"""Small linear systems over a real field, dense, with the pivots noted."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from liepoisson.algebra.echelon import Echelon, dense, eliminated, sparse
from liepoisson.algebra.real_fields import RealField, Scalar


def echelon(field: RealField, vectors: Iterable[Sequence[Scalar]]) -> list[list[Scalar]]:
    """The reduced row echelon form without zero rows; pivots free of symbols are preferred, others are noted."""
    rows = list(vectors)
    n = len(rows[0]) if rows else 0
    return [dense(row, range(n), field.zero) for row in _eliminated(field, rows, n).basis()]


def null_space(field: RealField, rows: Iterable[Sequence[Scalar]], n: int) -> list[tuple[Scalar, ...]]:
    """A basis of the vectors of length n that all rows annihilate."""
    return [tuple(dense(vector, range(n), field.zero)) for vector in _eliminated(field, rows, n).null_space(n)]


def pivot_column(row: Sequence[Scalar]) -> int:
    """The column of the first nonzero entry."""
    return next(k for k, value in enumerate(row) if value)


def _eliminated(field: RealField, rows: Iterable[Sequence[Scalar]], n: int) -> Echelon:
    form, _ = eliminated(map(sparse, rows), n, field, field.is_constant)
    for pivot in form.pivots:
        field.rely_on(pivot)
    return form
