r"""Exact linear algebra: null spaces and ranks of sparse matrices over Q and over fields with parameters.

A matrix is a list of rows, each a dictionary from column to nonzero entry.  Over Q an echelon form is computed modulo
a large prime, its null vectors are reconstructed as rationals and multiplied with the matrix exactly.  This proves
the whole null space: a rank modulo p is at most the rank over Q, so there are no more null vectors than were found.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib.util import find_spec
from itertools import islice, pairwise
from math import inf, lcm
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.echelon import Echelon, Row, Vector, null_vectors, transposed
from liepoisson.algebra.residues import PRIME, Lift, primes
from liepoisson.inputs.deadline import checkpoint, passed, seconds_left

if TYPE_CHECKING:
    from liepoisson.algebra.coefficients import Coefficients

_MAX_PRIMES = 40  # numerators and denominators of up to 40 * 61 / 2 bits; longer ones are left to exact elimination

_CORE_BELOW = 2**62
"""The compiled elimination takes odd primes below this."""
_CORE_FROM = 40
"""Columns from which it is faster than FLINT, whose matrices are dense, once NumPy is loaded."""


@dataclass(frozen=True)
class NullSpace:
    """The null space of a matrix.

    Attributes:
        vectors: A basis in reduced form: each vector ends in a 1, in a column where all the others have 0; these
            columns increase.
        pivots: What the elimination divided by (only over fields with parameters): where no numerator or denominator
            of these vanishes, the null space has the same dimension after inserting values.
    """

    vectors: tuple[Vector, ...]
    pivots: tuple[Any, ...] = ()

    @property
    def dimension(self) -> int:
        """Number of basis vectors."""
        return len(self.vectors)


def nullspace(rows: Sequence[Row], n_columns: int, field: Coefficients) -> NullSpace:
    """The null space of a sparse matrix over the field, proved.

    Args:
        rows: Dictionaries from column to entry, all entries elements of the field.
        n_columns: Number of columns.
        field: Where the entries live.
    """
    if field.is_rational and (vectors := _rational_nullspace(_integer_rows(rows), n_columns)) is not None:
        return NullSpace(tuple(vectors))
    return _nullspace(rows, n_columns, field)


def nullspace_mod(rows: Iterable[Row], n_columns: int, p: int) -> list[dict[int, int]]:
    """A basis of the null space modulo the prime p, in the reduced form of `NullSpace`; entries are integers."""
    reduced = _reduced_mod(rows, p)
    if n_columns >= _CORE_FROM and _has_core() and p % 2 and p < _CORE_BELOW:
        return _nullspace_of_core(reduced, n_columns, p)
    return _nullspace_of_flint(reduced, n_columns, p)


def _nullspace_of_core(rows: list[Row], n_columns: int, p: int) -> list[dict[int, int]]:
    """The null space by the compiled elimination, for sparse matrices."""
    found = _eliminated_by_core(rows, n_columns, p)
    ends, places, values = found["indptr"].tolist(), found["columns"].tolist(), found["residues"].tolist()
    return [dict(zip(places[i:j], values[i:j], strict=True)) for i, j in pairwise(ends)]


def _nullspace_of_flint(rows: list[Row], n_columns: int, p: int) -> list[dict[int, int]]:
    """The same by FLINT, for small matrices and all primes."""
    reduced, n_pivots = _matrix_mod(rows, n_columns, p).rref()
    echelon = [{c: v for c, v in enumerate(row) if v} for row in reduced.tolist()[:n_pivots]]
    return [{c: int(v) for c, v in vector.items()} for vector in null_vectors(echelon, n_columns, 1)]


def _matrix_mod(rows: list[Row], n_columns: int, p: int) -> Any:
    from flint import nmod_mat

    checkpoint("an elimination")
    matrix = nmod_mat(len(rows), n_columns, p)
    for i, row in enumerate(rows):
        for column, value in row.items():
            matrix[i, column] = value
    return matrix


@cache
def _has_core() -> bool:
    """A browser's Python may have neither the compiled core nor NumPy; exact algebra needs none of them."""
    return all(find_spec(name) is not None for name in ("numpy", "liepoisson._core"))


def _eliminated_by_core(rows: list[Row], n_columns: int, p: int) -> Any:
    import numpy as np

    from liepoisson import _core

    starts = np.cumsum([0, *map(len, rows)]).astype(np.uint64)
    columns = np.array([c for row in rows for c in row], dtype=np.uint32)
    residues = np.array([v for row in rows for v in row.values()], dtype=np.uint64)
    found = _core.modular_null_space(starts, columns, residues, n_columns, p, None, seconds_left(inf), None)
    if not found["complete"]:
        raise passed("an elimination")
    return found


def _nullspace(rows: Sequence[Row], n_columns: int, field: Coefficients) -> NullSpace:
    """The null space from the shortest rows, to which rows are added that do not annihilate it yet.

    Overdetermined systems are the rule here; most of their rows only have to be multiplied with the result.
    """
    sample = sorted(rows, key=len)[: 4 * n_columns + 20]
    columns = _by_column(rows)
    while True:
        echelon = Echelon(field, sorted(sample, key=len))
        vectors = echelon.null_space(n_columns)
        wrong = [] if len(sample) >= len(rows) else [rows[i] for i in _not_annihilating(columns, vectors)]
        if not wrong:
            return NullSpace(tuple(vectors), () if field.is_rational else tuple(echelon.pivots))
        sample += sorted(wrong, key=len)[: 2 * n_columns]


def _by_column(rows: Sequence[Row]) -> dict[int, list[tuple[int, Any]]]:
    columns: dict[int, list[tuple[int, Any]]] = {}
    for i, row in enumerate(rows):
        for column, value in row.items():
            columns.setdefault(column, []).append((i, value))
    return columns


def _not_annihilating(columns: Mapping[int, Sequence[tuple[int, Any]]], vectors: Sequence[Vector]) -> list[int]:
    """The numbers of the rows that do not annihilate all vectors.

    Column by column, as most rows have no column in common with a sparse vector.
    """
    wrong: set[int] = set()
    for vector in vectors:
        checkpoint("an elimination")
        totals: dict[int, Any] = {}
        for column, x in vector.items():
            for i, value in columns.get(column, ()):
                if i not in wrong:
                    totals[i] = totals[i] + value * x if i in totals else value * x
        wrong.update(i for i, total in totals.items() if total)
    return sorted(wrong)


def rank(rows: Sequence[Row], field: Coefficients) -> int:
    """The rank of a sparse matrix over the field, exact."""
    if not field.is_rational:
        return len(Echelon(field, sorted(rows, key=len)))
    from flint import fmpz_mat

    integer = [row for row in _integer_rows(rows) if row]
    columns = {c: k for k, c in enumerate(sorted({c for row in integer for c in row}))}
    matrix = fmpz_mat(len(integer), len(columns))
    for i, row in enumerate(integer):
        for c, value in row.items():
            matrix[i, columns[c]] = value
    return int(matrix.rank()) if integer else 0


def rank_mod(rows: Sequence[Row], n_columns: int, p: int = PRIME) -> int:
    """The rank modulo a prime of an integer matrix, at most its rank over Q."""
    reduced = _reduced_mod(rows, p)
    if n_columns >= _CORE_FROM and _has_core() and p % 2 and p < _CORE_BELOW:
        return _eliminated_by_core(reduced, n_columns, p)["rank"]
    return int(_matrix_mod(reduced, n_columns, p).rank())


def solve(columns: Sequence[Row], target: Row, field: Coefficients) -> list[Any] | None:
    """Coefficients c with sum c_k columns[k] = target, or None if there are none; exact.

    Args:
        columns: The columns of the matrix, dictionaries from row to entry.
        target: The right-hand side, in the same form.
        field: Where the entries live.
    """
    n = len(columns)
    last = [v for v in nullspace(transposed((*columns, target)), n + 1, field).vectors if n in v]
    if not last:
        return None
    return [-last[0][k] if k in last[0] else field.zero for k in range(n)]


def _reduced_mod(rows: Iterable[Row], p: int) -> list[Row]:
    return [{c: residue for c, v in row.items() if (residue := int(v) % p)} for row in rows]


def _integer_rows(rows: Iterable[Row]) -> list[dict[int, int]]:
    """The rows multiplied by their common denominators."""
    result: list[dict[int, int]] = []
    for row in rows:
        scale = lcm(*(value.denominator for value in row.values()))
        result.append({c: value.numerator * (scale // value.denominator) for c, value in row.items() if value})
    return result


def _rational_nullspace(rows: list[dict[int, int]], n_columns: int) -> list[dict[int, Fraction]] | None:
    """The null space over Q from those modulo primes, checked exactly; None if its entries are too long for that."""
    best: list[dict[int, int]] | None = None
    lifts: list[Lift] = []
    columns = _by_column(rows)
    for p in islice(primes(), _MAX_PRIMES):
        found = nullspace_mod(rows, n_columns, p)
        # Modulo an unlucky prime the null space is larger or its free columns come earlier: take the other one.
        if best is None or _shape(found) < _shape(best):
            best, lifts = found, [Lift() for _ in found]
        elif _shape(found) > _shape(best):
            continue
        for lift, vector in zip(lifts, found, strict=True):
            lift.add(vector, p)
        vectors: list[dict[int, Fraction]] = []
        for lift in lifts:
            if (lifted := lift.lifted()) is None:
                break
            vector = {column: Fraction(int(c.p), int(c.q)) for column, c in lifted.items()}
            scale = lcm(*(value.denominator for value in vector.values()))
            if _not_annihilating(columns, [{c: int(value * scale) for c, value in vector.items()}]):
                break
            vectors.append(vector)
        else:
            return vectors
    return None


def _shape(vectors: list[dict[int, int]]) -> tuple[int, list[int]]:
    return len(vectors), [-max(vector) for vector in vectors]
