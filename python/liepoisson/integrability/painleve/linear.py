"""Linear algebra over the field of a balance: matrices are lists of rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from liepoisson.inputs.deadline import checkpoint
from liepoisson.integrability.painleve.coefficient_fields import Element, Field

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
    zero, one = field.number(0), field.number(1)
    rows = [[*row, *side] for row, side in zip(matrix, right, strict=True)]
    pivots: list[int] = []
    at = 0
    for column in range(n):
        checkpoint("an elimination")
        found = next((k for k in range(at, n) if rows[k][column]), None)
        if found is None:
            continue
        rows[at], rows[found] = rows[found], rows[at]
        scale = field.inverse(rows[at][column])
        rows[at] = [x * scale if x else zero for x in rows[at]]
        for k in range(n):
            if k != at and rows[k][column]:
                factor = rows[k][column]
                rows[k] = [x - factor * y if y else x for x, y in zip(rows[k], rows[at], strict=True)]
        pivots.append(column)
        at += 1
    kernel: list[list[Element]] = []
    for column in (c for c in range(n) if c not in pivots):
        vector = [zero] * n
        vector[column] = one
        for k, pivot in enumerate(pivots):
            vector[pivot] = -rows[k][column]
        kernel.append(vector)
    particular = [[zero] * m for _ in range(n)]
    for k, pivot in enumerate(pivots):
        particular[pivot] = rows[k][n:]
    return Solved(kernel, particular, [row[n:] for row in rows[at:]])


def solved(matrix: Matrix, right: Matrix, field: Field) -> Matrix:
    """The solution of M x = R for an invertible matrix."""
    return eliminated(matrix, right, field).particular


def characteristic_polynomial(matrix: Matrix, field: Field) -> list[Element]:
    r"""The coefficients of $\det(r - M)$ by powers of r, by the algorithm of Faddeev and Le Verrier.

    Raises:
        TimeLimitError: the deadline of the call has passed.
    """
    n = len(matrix)
    zero, one = field.number(0), field.number(1)
    found = [zero] * n + [one]
    current: Matrix = [[zero] * n for _ in range(n)]
    for k in range(1, n + 1):
        checkpoint("a characteristic polynomial")
        for i in range(n):
            current[i][i] = current[i][i] + found[n - k + 1]
        current = _product(matrix, current, zero)
        trace = zero
        for i in range(n):
            trace = trace + current[i][i]
        found[n - k] = -trace * field.number(Fraction(1, k))
    return found


def _product(left: Matrix, right: Matrix, zero: Element) -> Matrix:
    columns = range(len(right[0]))
    found: Matrix = []
    for row in left:
        total = [zero] * len(columns)
        for x, other in zip(row, right, strict=True):
            if x:
                total = [t + x * y if y else t for t, y in zip(total, other, strict=True)]
        found.append(total)
    return found


def polynomial_quotient(
    dividend: Sequence[Element], divisor: Sequence[Element], field: Field
) -> tuple[list[Element], list[Element]]:
    """The quotient and the remainder of two polynomials in one variable, by powers."""
    rest, zero = list(dividend), field.number(0)
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
