"""Linear algebra over the field of a balance: matrices are lists of rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from liepoisson.algebra import echelon
from liepoisson.algebra.number_fields import Element
from liepoisson.integrability.painleve.coefficient_fields import Field

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


def eliminated(matrix: Matrix, right: Matrix, field: Field) -> Solved:
    """The kernel of a square matrix, and what solves M x = R.

    Raises:
        TimeLimitError: the deadline of the call has passed.
    """
    n, m = len(matrix), len(right[0]) if right else 0
    zero, columns = field.zero, range(n)
    rows = (echelon.sparse([*row, *side]) for row, side in zip(matrix, right, strict=True))
    form, left = echelon.eliminated(rows, n, field)
    reduced = form.basis()
    kernel = echelon.null_vectors(({k: x for k, x in row.items() if k < n} for row in reduced), n, field.one)
    particular = [[zero] * m for _ in columns]
    for row in reduced:
        particular[min(row)] = echelon.dense(row, range(n, n + m), zero)
    return Solved(
        [echelon.dense(vector, columns, zero) for vector in kernel],
        particular,
        [echelon.dense(row, range(n, n + m), zero) for row in left],
    )


def solved(matrix: Matrix, right: Matrix, field: Field) -> Matrix:
    """The solution of M x = R for an invertible matrix."""
    return eliminated(matrix, right, field).particular


def independent_columns(columns: Sequence[Sequence[Element]], field: Field, n: int) -> list[int]:
    """The numbers of the first n linearly independent columns."""
    form, _ = echelon.eliminated(map(echelon.sparse, zip(*columns, strict=True)), len(columns), field)
    return sorted(form.rows)[:n]


def polynomial_quotient(
    dividend: Sequence[Element], divisor: Sequence[Element], field: Field
) -> tuple[list[Element], list[Element]]:
    """The quotient and the remainder of two polynomials in one variable, by powers."""
    rest, zero = list(dividend), field.zero
    scale = field.inverse(divisor[-1])
    quotient = [zero] * max(1, len(rest) - len(divisor) + 1)
    while len(rest) >= len(divisor):
        top = rest[-1] * scale
        shift = len(rest) - len(divisor)
        quotient[shift] = top
        if top:
            for k, d in enumerate(divisor):
                rest[shift + k] = rest[shift + k] - top * d
        rest.pop()
    while rest and not rest[-1]:
        rest.pop()
    return quotient, rest


def polynomial_gcd(left: Sequence[Element], right: Sequence[Element], field: Field) -> list[Element]:
    """The greatest common divisor of two polynomials in one variable, the first not zero."""
    a, b = list(left), list(right)
    while b and not b[-1]:
        b.pop()
    while b:
        a, b = b, polynomial_quotient(a, b, field)[1]
    return a
