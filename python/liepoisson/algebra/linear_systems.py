"""Small linear systems over a field, dense: matrices are lists of rows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from liepoisson.algebra.echelon import Echelon, dense, null_vectors, sparse
from liepoisson.algebra.echelon import eliminated as by_columns
from liepoisson.algebra.number_fields import Element, NumberField
from liepoisson.algebra.real_fields import RealField, Scalar

Matrix = list[list[Element]]


@dataclass(frozen=True)
class Solved:
    """What elimination says about M x = R with several right-hand sides.

    Attributes:
        kernel: A basis of the solutions of M x = 0.
        particular: A solution for each right-hand side, a matrix of the shape of R; meant where all conditions vanish.
        conditions: Combinations of the rows of R that vanish if there are solutions.
    """

    kernel: list[list[Element]]
    particular: Matrix
    conditions: Matrix


def eliminated(matrix: Matrix, right: Matrix, field: NumberField) -> Solved:
    """The kernel of a square matrix, and what solves M x = R.

    Raises:
        TimeLimitError: the deadline of the call has passed.
    """
    n, m = len(matrix), len(right[0]) if right else 0
    zero, columns = field.zero, range(n)
    form, left = by_columns((sparse([*row, *side]) for row, side in zip(matrix, right, strict=True)), n, field)
    reduced = form.basis()
    kernel = null_vectors(({k: x for k, x in row.items() if k < n} for row in reduced), n, field.one)
    particular = [[zero] * m for _ in columns]
    for row in reduced:
        particular[min(row)] = dense(row, range(n, n + m), zero)
    return Solved(
        [dense(vector, columns, zero) for vector in kernel],
        particular,
        [dense(row, range(n, n + m), zero) for row in left],
    )


def solved(matrix: Matrix, right: Matrix, field: NumberField) -> Matrix:
    """The solution of M x = R for an invertible matrix."""
    return eliminated(matrix, right, field).particular


def independent_columns(columns: Sequence[Sequence[Element]], field: NumberField, n: int) -> list[int]:
    """The numbers of the first n linearly independent columns."""
    form, _ = by_columns(map(sparse, zip(*columns, strict=True)), len(columns), field)
    return sorted(form.rows)[:n]


def echelon(field: RealField, vectors: Iterable[Sequence[Scalar]]) -> list[list[Scalar]]:
    """The reduced row echelon form without zero rows; pivots free of symbols are preferred, others are noted."""
    rows = list(vectors)
    n = len(rows[0]) if rows else 0
    return [dense(row, range(n), field.zero) for row in _noted(field, rows, n).basis()]


def null_space(field: RealField, rows: Iterable[Sequence[Scalar]], n: int) -> list[tuple[Scalar, ...]]:
    """A basis of the vectors of length n that all rows annihilate; pivots as in `echelon`."""
    return [tuple(dense(vector, range(n), field.zero)) for vector in _noted(field, rows, n).null_space(n)]


def pivot_column(row: Sequence[Scalar]) -> int:
    """The column of the first nonzero entry."""
    return next(k for k, value in enumerate(row) if value)


def _noted(field: RealField, rows: Iterable[Sequence[Scalar]], n: int) -> Echelon:
    form, _ = by_columns(map(sparse, rows), n, field, field.is_constant)
    for pivot in form.pivots:
        field.rely_on(pivot)
    return form
