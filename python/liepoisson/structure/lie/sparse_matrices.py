"""Matrices with exact entries, sparse: how they are read, their commutators, and the algebra that they span."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any, TypeAlias, cast

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, Vector
from liepoisson.algebra.exact_numbers import Exact, is_sympy, is_zero
from liepoisson.algebra.number_fields import Element
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.formula.parameters import listed_rows, read_parameter
from liepoisson.formula.tensors import Brackets
from liepoisson.inputs.given import listed

SparseMatrix: TypeAlias = dict[int, dict[int, Any]]
"""A matrix by its nonzero rows, each by its nonzero entries."""

PairMatrix: TypeAlias = list[list[tuple[Exact, Exact]]]
"""A matrix by its rows, with the real and the imaginary part of each entry."""

_IMAGINARY = re.compile(r"(?<![A-Za-z_])[iIj](?!\w)")
"""What others write for the imaginary unit; in a text these are names of parameters."""


def brackets_of_matrices(matrices: Sequence[object], *, hermitian: bool = False) -> Brackets:
    r"""The $c_{ij}^k$ of $M_i M_j - M_j M_i = c_{ij}^k M_k$, for i < j, the nonzero ones.

    Hermitian ones have $M_i M_j - M_j M_i = i\,c_{ij}^k M_k$, the commutators of $-i M_k$.

    Each commutator is reduced by the echelon form of the matrices, which carry a tag each: the tags that remain are its
    coordinates.

    Raises:
        ShapeError: not a sequence of square matrices of one size.
        BracketError: linearly dependent, or a commutator outside of the span.
    """
    pairs = read_pairs(matrices, "matrices")
    if hermitian:
        check_hermitian(pairs, "matrices")
        pairs = [times_minus_i(matrix) for matrix in pairs]
    found, outside = _brackets(*as_real(pairs))
    if outside is not None:
        i, j = outside
        raise BracketError(
            f"matrices must be closed under commutators; that of matrices {i} and {j} is outside of their real span. "
            + (
                "Hermitian generators are closed after multiplication by -i: write hermitian=True."
                if _brackets(*as_real([times_minus_i(matrix) for matrix in pairs]))[1] is None
                else "Add it to them; algebras.closure adds all that are missing."
            )
        )
    return found


def _brackets(read: list[SparseMatrix], size: int) -> tuple[Brackets, tuple[int, int] | None]:
    """The brackets, and the first pair whose commutator is outside of the span; None if there is none."""
    field = Coefficients.containing(entries_of(read))
    basis = [in_field(matrix, field) for matrix in read]
    end = size * size
    span = Echelon(field)
    for i, matrix in enumerate(basis):
        left = span.reduce(_flat(matrix, size))
        if not any(position < end for position in left):
            combination = ", ".join(str(k - end) for k in sorted(left))
            raise BracketError(
                f"matrices must be linearly independent; matrix {i} is a combination of the matrices before it "
                f"({combination or 'it is zero'}). Leave it out."
            )
        span.insert({**_flat(matrix, size), end + i: field.one})
    result: Brackets = {}
    for i, j in combinations(range(len(basis)), 2):
        left = span.reduce(_flat(commutator(basis[i], basis[j], field), size))
        if any(position < end for position in left):
            return result, (i, j)
        if left:
            result[i, j] = {position - end: field.write(-value, 1) for position, value in sorted(left.items())}
    return result, None


def read_matrices(matrices: object, name: str) -> tuple[list[SparseMatrix], int]:
    """Read square matrices of one size, sparse; complex ones become real ones of twice the size.

    Raises:
        ShapeError: not a nonempty sequence of square matrices of one size.
        ParameterError: an entry is not exact.
    """
    return as_real(read_pairs(matrices, name))


def read_pairs(matrices: object, name: str) -> list[PairMatrix]:
    """The matrices by the real and imaginary parts of their entries."""
    items = listed(matrices, name)
    if not items:
        raise ShapeError(f"{name} must be a sequence of square matrices; got {matrices!r}. Give at least one.")
    rows = [_read_rows(item, f"{name}[{i}]") for i, item in enumerate(items)]
    sizes = {len(matrix) for matrix in rows}
    if len(sizes) > 1:
        raise ShapeError(f"{name} must have one size; got the sizes {sorted(sizes)}. Choose one.")
    return [[[_parts(v, f"{name}[{i}]") for v in row] for row in matrix] for i, matrix in enumerate(rows)]


def as_real(matrices: list[PairMatrix]) -> tuple[list[SparseMatrix], int]:
    """Real matrices as they are, complex ones as real ones of twice the size; and the size."""
    m = len(matrices[0])
    if any(imaginary != 0 for matrix in matrices for row in matrix for _, imaginary in row):
        return [_real_form(matrix, m) for matrix in matrices], 2 * m
    return [_sparse([[real for real, _ in row] for row in matrix]) for matrix in matrices], m


def times_minus_i(matrix: PairMatrix) -> PairMatrix:
    """-i times a matrix."""
    return [[(imaginary, -real) for real, imaginary in row] for row in matrix]


def check_hermitian(pairs: Sequence[PairMatrix], name: str) -> None:
    """Refuse matrices that are not hermitian.

    Raises:
        ParameterError: one of them is not.
    """
    for k, matrix in enumerate(pairs):
        for i, row in enumerate(matrix):
            for j, (real, imaginary) in enumerate(row[: i + 1]):
                if not is_zero(real - matrix[j][i][0]) or not is_zero(imaginary + matrix[j][i][1]):
                    raise ParameterError(
                        f"{name}[{k}]: wanted a hermitian matrix; got one whose entries ({i}, {j}) and ({j}, {i}) are "
                        "not conjugate to each other. Correct it, or leave out hermitian=True."
                    )


def _read_rows(matrix: object, name: str) -> list[list[object]]:
    rows = [listed(row, name) for row in listed_rows(matrix, name) or ()]
    if not rows or any(row is None or len(row) != len(rows) for row in rows):
        raise ShapeError(f"{name} must be a square matrix; got {matrix!r}. Give as many rows as columns.")
    return cast("list[list[object]]", rows)


def _parts(value: object, name: str) -> tuple[Exact, Exact]:
    """Real and imaginary part of an entry, exact."""
    if isinstance(value, str) and _IMAGINARY.search(value):
        raise ParameterError(
            f"{name}: {value!r:.60} has a name that may mean the imaginary unit, which texts do not have. Write "
            "sympy.I/2 or 0.5j without quotes for a complex entry, or give the parameter another name."
        )
    if isinstance(value, complex):
        return read_parameter(value.real, name), read_parameter(value.imag, name)
    if not is_sympy(value):
        return read_parameter(value, name), Fraction(0)
    from sympy import Expr, I

    expanded = value.expand() if isinstance(value, Expr) else value
    if not isinstance(expanded, Expr) or not expanded.has(I):
        return read_parameter(value, name), Fraction(0)
    imaginary = expanded.coeff(I)
    return read_parameter((expanded - I * imaginary).expand(), name), read_parameter(imaginary, name)


def _real_form(matrix: PairMatrix, m: int) -> SparseMatrix:
    """The matrix [[Re, -Im], [Im, Re]] of a complex one."""
    real = [[a for a, _ in row] for row in matrix]
    imaginary = [[b for _, b in row] for row in matrix]
    upper = [real[r] + [-b for b in imaginary[r]] for r in range(m)]
    return _sparse(upper + [imaginary[r] + real[r] for r in range(m)])


def _sparse(rows: Sequence[Sequence[Exact]]) -> SparseMatrix:
    sparse = {r: {c: value for c, value in enumerate(row) if value != 0} for r, row in enumerate(rows)}
    return {r: row for r, row in sparse.items() if row}


def entries_of(matrices: list[SparseMatrix]) -> list[Exact]:
    """The nonzero entries of all the matrices."""
    return [value for matrix in matrices for row in matrix.values() for value in row.values()]


def in_field(matrix: SparseMatrix, field: Coefficients) -> SparseMatrix:
    """The matrix with its entries as elements of the field."""
    return {r: {c: field.read(value) for c, value in row.items()} for r, row in matrix.items()}


def _flat(matrix: SparseMatrix, size: int) -> Vector:
    return {r * size + c: value for r, row in matrix.items() for c, value in row.items()}


def commutator(a: SparseMatrix, b: SparseMatrix, field: Coefficients) -> SparseMatrix:
    """The matrix ab - ba."""
    result: SparseMatrix = {}
    _add_product(result, a, b, field.one)
    _add_product(result, b, a, -field.one)
    kept = {r: {c: v for c, v in row.items() if not field.vanishes(v)} for r, row in result.items()}
    return {r: row for r, row in kept.items() if row}


def _add_product(target: SparseMatrix, a: SparseMatrix, b: SparseMatrix, factor: Element) -> None:
    for r, row in a.items():
        for s, value in row.items():
            if s in b:
                add_multiple(target, {r: b[s]}, factor * value)


def add_multiple(target: SparseMatrix, matrix: SparseMatrix, factor: Element) -> None:
    """Add a multiple of a matrix to the target, in place."""
    for r, row in matrix.items():
        into = target.setdefault(r, {})
        for c, value in row.items():
            into[c] = into[c] + factor * value if c in into else factor * value
