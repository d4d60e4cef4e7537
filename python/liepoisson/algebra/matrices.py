"""Small dense matrices, lists of rows: products, determinants, characteristic polynomials, and linear systems."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from liepoisson.algebra.echelon import Echelon, dense, null_vectors, sparse
from liepoisson.algebra.echelon import eliminated as by_columns
from liepoisson.algebra.number_fields import Element, NumberField
from liepoisson.algebra.real_fields import RealField, Scalar
from liepoisson.inputs.deadline import checkpoint

Rows: TypeAlias = "Sequence[Sequence[Element]]"


def _unchanged(element: Element) -> Element:
    return element


def product(
    left: Rows, right: Rows, zero: Element, canonical: Callable[[Element], Element] = _unchanged
) -> list[list[Element]]:
    """The product of two matrices.

    Args:
        left: A matrix by its rows.
        right: Another one.
        zero: The number zero.
        canonical: What is done with each entry.
    """
    found: list[list[Element]] = []
    for row in left:
        total = [zero for _ in right[0]]
        for x, other in zip(row, right, strict=True):
            if x:
                total = [t + x * y if y else t for t, y in zip(total, other, strict=True)]
        found.append([canonical(t) for t in total])
    return found


def characteristic_polynomial(
    matrix: Rows, number: Callable[[Fraction | int], Element], canonical: Callable[[Element], Element] = _unchanged
) -> list[Element]:
    r"""The coefficients $c_k$ of $\det(r - A) = \sum_k c_k r^k$, by the algorithm of Faddeev and Le Verrier.

    $M_1 = 1$, $c_{n-k} = -\operatorname{tr}(A M_k)/k$, $M_{k+1} = A M_k + c_{n-k}$.

    Args:
        matrix: A, by its rows.
        number: Makes elements of rational numbers.
        canonical: What is done with each entry of a product.

    Raises:
        TimeLimitError: the deadline of the call has passed.
    """
    n, zero = len(matrix), number(0)
    found = [zero] * n + [number(1)]
    current = [[zero] * n for _ in range(n)]
    for k in range(1, n + 1):
        checkpoint("a characteristic polynomial")
        for i in range(n):
            current[i][i] = current[i][i] + found[n - k + 1]
        current = product(matrix, current, zero, canonical)
        trace = zero
        for i in range(n):
            trace = trace + current[i][i]
        found[n - k] = canonical(trace * number(Fraction(-1, k)))
    return found


def determinant(rows: Rows, zero: Element) -> Element:
    """The determinant by Laplace's expansion, without divisions; each minor of the last rows is computed once.

    Args:
        rows: A square matrix; of n dense rows there are 2^n minors.
        zero: The number zero.
    """
    n = len(rows)
    minors: dict[frozenset[int], Element] = {frozenset(): None}
    for row in reversed(rows):
        wider: dict[frozenset[int], Element] = {}
        for columns, minor in minors.items():
            for k in set(range(n)) - columns:
                if not row[k]:
                    continue
                term = row[k] if minor is None else row[k] * minor
                term = -term if sum(1 for c in columns if c < k) % 2 else term
                key = columns | {k}
                wider[key] = wider[key] + term if key in wider else term
        minors = wider
    return minors.get(frozenset(range(n)), zero)


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
