r"""Products and cochains in another basis, $e'_i = \sum_j P_{ij} e_j$, exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import Exact
from liepoisson.algebra.matrices import eliminated
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.structure.extension import Products

Rows: TypeAlias = Sequence[Sequence[Exact]]
"""The matrix P: one row for each new basis element."""


def in_basis(products: Mapping[tuple[int, int], Mapping[int, Exact]], rows: Rows) -> Products:
    """A bilinear map in the basis of the rows, by its coordinates there."""
    return _moved(products, rows, inverse(rows))


def from_basis(products: Mapping[tuple[int, int], Mapping[int, Exact]], rows: Rows) -> Products:
    """The bilinear map that is given in the basis of the rows."""
    return _moved(products, inverse(rows), rows)


def inverse(rows: Rows) -> list[list[Exact]]:
    """The inverse of a matrix of exact numbers.

    Raises:
        ParameterError: there is none.
    """
    field, ((matrix,), _) = _read([rows], {})
    n = range(len(rows))
    identity = [[field.one if i == j else field.zero for j in n] for i in n]
    found = eliminated(matrix, identity, field)
    if found.kernel:
        raise ParameterError(
            "wanted a change of fields that has an inverse; got one that has none, as at a pole of the products of a "
            "deformation. Take other values of its parameters."
        )
    return [[field.write(value) for value in row] for row in found.particular]


def multiplied(first: Rows, second: Rows) -> list[list[Exact]]:
    """The product of two matrices of exact numbers."""
    field, ((left, right), _) = _read([first, second], {})
    n = range(len(second))
    products = [[[row[k] * right[k][j] for k in n] for j in range(len(right[0]))] for row in left]
    return [[field.write(sum(terms, field.zero)) for terms in row] for row in products]


def identity(n: int) -> list[list[Exact]]:
    """The identity."""
    return [[Fraction(int(i == j)) for j in range(n)] for i in range(n)]


def _moved(products: Mapping[tuple[int, int], Mapping[int, Exact]], rows: Rows, back: Rows) -> Products:
    field, ((P, Q), table) = _read([rows, back], products)
    n, found = len(rows), Products()
    for i in range(n):
        for j in range(i, n):
            checkpoint("a change of basis")
            total = [field.zero] * n
            for (a, b), row in table.items():
                weight = P[i][a] * P[j][b] + (P[i][b] * P[j][a] if a != b else field.zero)
                for k, value in row.items() if weight else ():
                    total[k] = total[k] + weight * value
            image = [sum((total[m] * Q[m][k] for m in range(n)), field.zero) for k in range(n)]
            if row := {k: field.write(value) for k, value in enumerate(image) if value}:
                found[i, j] = row
    return found


def _read(
    matrices: Sequence[Rows], products: Mapping[tuple[int, int], Mapping[int, Exact]]
) -> tuple[Coefficients, tuple[list[list[list[Any]]], dict[tuple[int, int], dict[int, Any]]]]:
    """All entries as elements of one field."""
    values = [value for matrix in matrices for row in matrix for value in row]
    field = Coefficients.containing([*values, *(value for row in products.values() for value in row.values())])
    read = [[[field.read(value) for value in row] for row in matrix] for matrix in matrices]
    return field, (read, {pair: {k: field.read(v) for k, v in row.items()} for pair, row in products.items()})
