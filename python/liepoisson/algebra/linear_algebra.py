r"""Exact linear algebra: null spaces and ranks of sparse matrices over Q and over fields with parameters.

A matrix is a list of rows, each a dictionary from column to nonzero entry.  Over Q an echelon form is computed modulo
a large prime, its null vectors are reconstructed as rationals and multiplied with the matrix exactly.  This proves
the whole null space: a rank modulo p is at most the rank over Q, so there are no more null vectors than were found.

References: von zur Gathen and Gerhard, Modern Computer Algebra, section 5.10 (rational reconstruction).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib.util import find_spec
from itertools import pairwise
from math import inf, isqrt, lcm
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.residues import PRIME
from liepoisson.inputs.deadline import checkpoint

if TYPE_CHECKING:
    from liepoisson.algebra.coefficients import Coefficients

Row: TypeAlias = "Mapping[int, Any]"
Vector: TypeAlias = "dict[int, Any]"
_Arithmetic: TypeAlias = "tuple[Callable[[Any], Any], Callable[[Vector, Row, Any], None], Callable[[Any], bool]]"

_MAX_PRIMES = 40  # numerators and denominators of up to 40 * 61 / 2 bits; longer ones are left to exact elimination

_CORE_BELOW = 2**62
"""The compiled elimination takes odd primes below this."""
_CORE_FROM = 10
"""Columns from which the compiled elimination is faster than Python, with odd primes."""
_CORE_FROM_WITHOUT_NUMPY = 40
"""The same where NumPy, which brings the arrays, would have to be loaded first: that takes 0.07 s, and Python
0.015 s for a full matrix of 40 columns."""


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
    one = field.one
    vectors, pivots = _nullspace(rows, n_columns, one, (lambda value: one / value, _subtract, bool))
    return NullSpace(tuple(vectors), () if field.is_rational else pivots)


def nullspace_mod(rows: Iterable[Row], n_columns: int, p: int) -> list[dict[int, int]]:
    """A basis of the null space modulo the prime p, in the reduced form of `NullSpace`; entries are integers."""
    reduced = _reduced_mod(rows, p)
    if _is_for_core(n_columns, p):
        return _nullspace_of_core(reduced, n_columns, p)
    return _nullspace_mod(reduced, n_columns, p)


def _nullspace_mod(rows: list[Row], n_columns: int, p: int) -> list[dict[int, int]]:
    """The same in Python, for small matrices and all primes."""
    arithmetic = (lambda value: pow(value, -1, p), _subtraction_mod(p), lambda value: bool(value % p))
    vectors, _ = _nullspace(rows, n_columns, 1, arithmetic)
    return [{c: v % p for c, v in vector.items()} for vector in vectors]


def _nullspace_of_core(rows: list[Row], n_columns: int, p: int) -> list[dict[int, int]]:
    """The same by the compiled elimination, whose basis has the same form."""
    found = _eliminated_by_core(rows, n_columns, p)
    ends, places, values = found["indptr"].tolist(), found["columns"].tolist(), found["residues"].tolist()
    return [dict(zip(places[i:j], values[i:j], strict=True)) for i, j in pairwise(ends)]


def _is_for_core(n_columns: int, p: int) -> bool:
    """Whether the compiled elimination is there, takes this prime and is worth its call."""
    least = _CORE_FROM if "numpy" in sys.modules else _CORE_FROM_WITHOUT_NUMPY
    return bool(p % 2) and p < _CORE_BELOW and n_columns >= least and _has_core()


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
    return _core.modular_null_space(starts, columns, residues, n_columns, p, None, inf, None)


def _nullspace(
    rows: Sequence[Row], n_columns: int, one: Any, arithmetic: _Arithmetic
) -> tuple[list[Vector], tuple[Any, ...]]:
    """Null vectors and pivots, from the shortest rows, to which rows are added that do not annihilate them yet.

    Overdetermined systems are the rule here; most of their rows only have to be multiplied with the result.
    """
    invert, subtract, is_nonzero = arithmetic
    sample = sorted(rows, key=len)[: 4 * n_columns + 20]
    columns = _by_column(rows)
    while True:
        echelon, pivots = _eliminate(sample, invert, subtract)
        vectors = list(_null_vectors(echelon, n_columns, one, subtract))
        if len(sample) >= len(rows):
            return vectors, pivots
        wrong = [rows[i] for i in _not_annihilating(columns, vectors, is_nonzero)]
        if not wrong:
            return vectors, pivots
        sample += sorted(wrong, key=len)[: 2 * n_columns]


def _by_column(rows: Sequence[Row]) -> dict[int, list[tuple[int, Any]]]:
    columns: dict[int, list[tuple[int, Any]]] = {}
    for i, row in enumerate(rows):
        for column, value in row.items():
            columns.setdefault(column, []).append((i, value))
    return columns


def _not_annihilating(
    columns: Mapping[int, Sequence[tuple[int, Any]]], vectors: Sequence[Vector], is_nonzero: Callable[[Any], bool]
) -> list[int]:
    """The numbers of the rows that do not annihilate all vectors.

    Column by column, as most rows have no column in common with a sparse vector.
    """
    wrong: set[int] = set()
    for vector in vectors:
        totals: dict[int, Any] = {}
        for column, x in vector.items():
            for i, value in columns.get(column, ()):
                if i not in wrong:
                    totals[i] = totals[i] + value * x if i in totals else value * x
        wrong.update(i for i, total in totals.items() if is_nonzero(total))
    return sorted(wrong)


def echelon_form(rows: Iterable[Row], field: Coefficients) -> tuple[set[int], tuple[Any, ...]]:
    """The columns of the leading (leftmost nonzero) entries of an echelon form, and what was divided by.

    The number of columns is the rank.  Over fields with parameters they are the same after inserting values, except
    where a numerator or a denominator of a divisor vanishes.
    """
    one = field.one
    leading, pivots = _eliminate(list(rows), lambda value: one / value, _subtract)
    return set(leading), () if field.is_rational else pivots


def echelon_columns(rows: Iterable[Row], field: Coefficients) -> set[int]:
    """The columns of the leading entries of an echelon form; see `echelon_form`."""
    return echelon_form(rows, field)[0]


def rank(rows: Sequence[Row], field: Coefficients) -> int:
    """The rank of a sparse matrix over the field, exact."""
    if not field.is_rational:
        return len(echelon_columns(rows, field))
    from flint import fmpz_mat

    integer = [row for row in _integer_rows(rows) if row]
    columns = {c: k for k, c in enumerate(sorted({c for row in integer for c in row}))}
    matrix = fmpz_mat(len(integer), len(columns))
    for i, row in enumerate(integer):
        for c, value in row.items():
            matrix[i, columns[c]] = value
    return int(matrix.rank()) if integer else 0


def rank_mod(rows: Sequence[Mapping[int, int]], n_columns: int, p: int = PRIME) -> int:
    """The rank modulo a prime of an integer matrix, at most its rank over Q."""
    reduced = _reduced_mod(rows, p)
    if _is_for_core(n_columns, p):
        return _eliminated_by_core(reduced, n_columns, p)["rank"]
    return len(_eliminate(reduced, lambda value: pow(value, -1, p), _subtraction_mod(p))[0])


def solve(columns: Sequence[Row], target: Row, field: Coefficients) -> list[Any] | None:
    """Coefficients c with sum c_k columns[k] = target, or None if there are none; exact.

    Args:
        columns: The columns of the matrix, dictionaries from row to entry.
        target: The right-hand side, in the same form.
        field: Where the entries live.
    """
    n = len(columns)
    rows: dict[int, Vector] = {}
    for k, column in enumerate((*columns, target)):
        for i, value in column.items():
            rows.setdefault(i, {})[k] = value
    last = [v for v in nullspace(list(rows.values()), n + 1, field).vectors if n in v]
    if not last:
        return None
    return [-last[0][k] if k in last[0] else field.one - field.one for k in range(n)]


def _eliminate(
    rows: Iterable[Row], invert: Callable[[Any], Any], subtract: Callable[[Vector, Row, Any], None]
) -> tuple[dict[int, Vector], tuple[Any, ...]]:
    """An echelon form by leading column, leading entries one, and what was divided by."""
    echelon: dict[int, Vector] = {}
    pivots: list[Any] = []
    for given in sorted(rows, key=len):
        row = dict(given)
        while row:
            checkpoint("an elimination")
            column = min(row)
            if column in echelon:
                subtract(row, echelon[column], row[column])
                continue
            pivots.append(row[column])
            scale = invert(row[column])
            echelon[column] = {c: value * scale for c, value in row.items()}
            break
    return echelon, tuple(pivots)


def _null_vectors(
    echelon: dict[int, Vector], n_columns: int, one: Any, subtract: Callable[[Vector, Row, Any], None]
) -> Iterator[Vector]:
    """Back substitution, then one vector for each column that leads no row."""
    for column in sorted(echelon, reverse=True):
        checkpoint("an elimination")
        row = echelon[column]
        for other in [c for c in row if c != column and c in echelon]:
            subtract(row, echelon[other], row[other])
    for free in range(n_columns):
        if free not in echelon:
            vector = {column: -row[free] for column, row in sorted(echelon.items()) if free in row}
            yield {**vector, free: one}


def _subtract(row: Vector, other: Row, factor: Any) -> None:
    """Row -= factor * other, in place, dropping what vanishes."""
    for column, value in other.items():
        difference = row[column] - factor * value if column in row else -factor * value
        if difference:
            row[column] = difference
        else:
            row.pop(column, None)


def _subtraction_mod(p: int) -> Callable[[Vector, Row, Any], None]:
    def subtract(row: Vector, other: Row, factor: Any) -> None:
        for column, value in other.items():
            difference = (row.get(column, 0) - factor * value) % p
            if difference:
                row[column] = difference
            else:
                row.pop(column, None)

    return subtract


def _reduced_mod(rows: Iterable[Row], p: int) -> list[Row]:
    return [{c: v % p for c, v in row.items() if v % p} for row in rows]


def _integer_rows(rows: Iterable[Row]) -> list[dict[int, int]]:
    """The rows multiplied by their common denominators."""
    result: list[dict[int, int]] = []
    for row in rows:
        scale = lcm(*(value.denominator for value in row.values()))
        result.append({c: int(value * scale) for c, value in row.items() if value})
    return result


def _rational_nullspace(rows: list[dict[int, int]], n_columns: int) -> list[dict[int, Fraction]] | None:
    """The null space over Q from those modulo primes, checked exactly; None if its entries are too long for that."""
    best: list[dict[int, int]] | None = None
    modulus = 1
    for _, p in zip(range(_MAX_PRIMES), _primes(), strict=False):
        found = nullspace_mod(rows, n_columns, p)
        # Modulo an unlucky prime the null space is larger or its free columns come earlier: take the other one.
        if best is None or _shape(found) < _shape(best):
            best, modulus = found, p
        elif _shape(found) == _shape(best):
            best, modulus = [_lift(u, v, modulus, p) for u, v in zip(best, found, strict=True)], modulus * p
        vectors = [_reconstruct(vector, modulus) for vector in best]
        if all(vector is not None for vector in vectors):
            rational = [vector for vector in vectors if vector is not None]
            if all(_annihilates(rows, vector) for vector in rational):
                return rational
    return None


def _primes() -> Iterator[int]:
    yield PRIME
    from flint import fmpz

    yield from (p for p in range(PRIME - 2, 2, -2) if fmpz(p).is_probable_prime())


def _shape(vectors: list[dict[int, int]]) -> tuple[int, list[int]]:
    return len(vectors), [-max(vector) for vector in vectors]


def _lift(first: dict[int, int], second: dict[int, int], m: int, p: int) -> dict[int, int]:
    """Chinese remainders of two vectors."""
    inverse = pow(m, -1, p)
    lifted: dict[int, int] = {}
    for column in first.keys() | second.keys():
        u = first.get(column, 0)
        lifted[column] = u + m * ((second.get(column, 0) - u) * inverse % p)
    return lifted


def _reconstruct(vector: dict[int, int], modulus: int) -> dict[int, Fraction] | None:
    """Entries u/v with |u|, v below sqrt(modulus / 2), by Euclid's algorithm."""
    bound = isqrt(modulus // 2)
    result: dict[int, Fraction] = {}
    for column, residue in vector.items():
        r0, r1, t0, t1 = modulus, residue % modulus, 0, 1
        while r1 > bound:
            quotient = r0 // r1
            r0, r1, t0, t1 = r1, r0 - quotient * r1, t1, t0 - quotient * t1
        if t1 == 0 or abs(t1) > bound:
            return None
        if r1:
            result[column] = Fraction(r1, t1)
    return result


def _annihilates(rows: list[dict[int, int]], vector: dict[int, Fraction]) -> bool:
    scale = lcm(*(value.denominator for value in vector.values()))
    integer = {c: int(value * scale) for c, value in vector.items()}
    return not any(sum(value * integer[c] for c, value in row.items() if c in integer) for row in rows)
