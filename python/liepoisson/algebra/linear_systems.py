"""Small linear systems over a real field: reduced echelon forms and null spaces, dense, with the pivots noted."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from liepoisson.algebra.real_fields import RealField, Scalar


def echelon(field: RealField, vectors: Iterable[Sequence[Scalar]]) -> list[list[Scalar]]:
    """The reduced row echelon form without zero rows; pivots free of symbols are preferred, others are noted."""
    rows = [list(v) for v in vectors]
    done = 0
    for column in range(len(rows[0]) if rows else 0):
        candidates = [r for r in range(done, len(rows)) if rows[r][column]]
        if not candidates:
            continue
        best = next((r for r in candidates if field.is_constant(rows[r][column])), candidates[0])
        rows[done], rows[best] = rows[best], rows[done]
        field.rely_on(rows[done][column])
        pivot = field.one / rows[done][column]
        rows[done] = [value * pivot for value in rows[done]]
        for r, row in enumerate(rows):
            if r != done and row[column]:
                factor = row[column]
                rows[r] = [a - factor * b if b else a for a, b in zip(row, rows[done], strict=True)]
        done += 1
    return rows[:done]


def pivot_column(row: Sequence[Scalar]) -> int:
    """The column of the first nonzero entry."""
    return next(k for k, value in enumerate(row) if value)


def null_space(field: RealField, rows: Iterable[Sequence[Scalar]], n: int) -> list[tuple[Scalar, ...]]:
    """A basis of the vectors of length n that all rows annihilate."""
    pivots = {pivot_column(row): row for row in echelon(field, rows)}
    free = [k for k in range(n) if k not in pivots]
    zero, one = field.zero, field.one
    return [tuple(one if k == f else (-pivots[k][f] if k in pivots else zero) for k in range(n)) for f in free]
