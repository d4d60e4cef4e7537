"""Vectors and matrices of exact scalars, as formulas use them; every operation checks shapes and stays bounded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import TypeAlias

from liepoisson.algebra.exact_numbers import Exact
from liepoisson.formula.arithmetic import Arithmetic, RefusedError

MAX_SYMBOLIC_INVERSE = 4
MAX_INVERSE = 40

_ZERO, _ONE = Fraction(0), Fraction(1)


@dataclass(frozen=True, slots=True)
class Vector:
    """A vector, shape (n,)."""

    entries: tuple[Exact, ...]


@dataclass(frozen=True, slots=True)
class Matrix:
    """A matrix by its rows, shape (m, n)."""

    rows: tuple[tuple[Exact, ...], ...]


Value: TypeAlias = "Exact | Vector | Matrix"


def shape_of(value: Value) -> tuple[int, ...]:
    """() for a scalar, (n,) for a vector, (m, n) for a matrix."""
    if isinstance(value, Matrix):
        return len(value.rows), len(value.rows[0])
    return (len(value.entries),) if isinstance(value, Vector) else ()


def kind_of(value: Value) -> str:
    """What a value is, in words for error messages."""
    match shape_of(value):
        case (n,):
            return f"a vector of length {n}"
        case (m, n):
            return f"a {m} x {n} matrix"
        case _:
            return "a scalar"


class TensorArithmetic:
    """Sums, products and functions of vectors and matrices.

    Every method raises RefusedError when shapes do not fit or a result is too large.
    """

    def __init__(self, scalars: Arithmetic) -> None:
        self.scalars = scalars
        self._functions: dict[str, tuple[str, Callable[..., Value]]] = {
            "dot": ("two vectors of one length, dot(u, v)", self._dot),
            "cross": ("two vectors of length 3, cross(u, v)", self._cross),
            "norm": ("one vector, norm(v)", self._norm),
            "diag": ("one vector, diag(v)", self._diagonal),
            "inv": ("one square matrix, or a vector for a diagonal one, inv(M)", self._inverse),
            "transpose": ("one matrix, transpose(M)", self._transpose),
            "trace": ("one square matrix, trace(M)", self._trace),
        }

    def sum(self, terms: Sequence[Value]) -> Value:
        """The sum of terms of one shape."""
        if isinstance(terms[0], Vector):
            columns = zip(*(term.entries for term in terms if isinstance(term, Vector)), strict=True)
            return Vector(tuple(self.scalars.sum(column) for column in columns))
        if isinstance(terms[0], Matrix):
            matrices = [term.rows for term in terms if isinstance(term, Matrix)]
            rows = (zip(*rows, strict=True) for rows in zip(*matrices, strict=True))
            return Matrix(tuple(tuple(self.scalars.sum(entries) for entries in row) for row in rows))
        return self.scalars.sum([term for term in terms if not isinstance(term, (Vector, Matrix))])

    def times(self, scalar: Exact, value: Value) -> Value:
        """A scalar times a value of any shape."""
        if isinstance(value, Vector):
            return Vector(tuple(self.scalars.product([scalar, entry]) for entry in value.entries))
        if isinstance(value, Matrix):
            return Matrix(tuple(tuple(self.scalars.product([scalar, entry]) for entry in row) for row in value.rows))
        return self.scalars.product([scalar, value])

    def product(self, left: Vector | Matrix, right: Vector | Matrix) -> Vector | Matrix:
        """Matrix times vector, or matrix times matrix."""
        if isinstance(left, Vector):
            hint = "dot(u, v), cross(u, v) or diag(u)*v" if isinstance(right, Vector) else "transpose(M)*v"
            raise RefusedError(f"{kind_of(left)} times {kind_of(right)} has no meaning; write {hint}")
        if shape_of(left)[1] != shape_of(right)[0]:
            raise RefusedError(f"{kind_of(left)} times {kind_of(right)} has no meaning; the lengths must agree")
        if isinstance(right, Vector):
            return Vector(tuple(self._inner(row, right.entries) for row in left.rows))
        columns = list(zip(*right.rows, strict=True))
        return Matrix(tuple(tuple(self._inner(row, column) for column in columns) for row in left.rows))

    def as_divisor(self, value: Value) -> Exact:
        """The value, if it is a scalar."""
        if isinstance(value, Vector):
            raise RefusedError(
                f"a divisor must be a scalar; got {kind_of(value)}. Write inv(I)*l for l1/I1, l2/I2, ..."
            )
        if isinstance(value, Matrix):
            raise RefusedError(f"a divisor must be a scalar; got {kind_of(value)}. Write inv(M)*v")
        return value

    def apply(self, function: str, arguments: Sequence[Value]) -> Value:
        """One of `MATRIX_FUNCTIONS` of the arguments."""
        wanted, method = self._functions[function]
        n_wanted = 2 if function in ("dot", "cross") else 1
        if len(arguments) != n_wanted:
            raise RefusedError(f"{function} takes {wanted}; got {len(arguments)} arguments")
        value = method(*arguments)
        if value is _NO_VALUE:
            raise RefusedError(f"{function} takes {wanted}; got {' and '.join(map(kind_of, arguments))}")
        return value

    def _dot(self, u: Value, v: Value) -> Value:
        if not isinstance(u, Vector) or not isinstance(v, Vector) or shape_of(u) != shape_of(v):
            return _NO_VALUE
        return self._inner(u.entries, v.entries)

    def _cross(self, u: Value, v: Value) -> Value:
        if not isinstance(u, Vector) or not isinstance(v, Vector) or shape_of(u) != (3,) or shape_of(v) != (3,):
            return _NO_VALUE
        pairs = ((1, 2), (2, 0), (0, 1))
        return Vector(tuple(self._minor(u.entries, v.entries, i, j) for i, j in pairs))

    def _norm(self, v: Value) -> Value:
        if not isinstance(v, Vector):
            return _NO_VALUE
        return self.scalars.apply("sqrt", self._inner(v.entries, v.entries))

    def _diagonal(self, v: Value) -> Value:
        if not isinstance(v, Vector):
            return _NO_VALUE
        n = len(v.entries)
        return Matrix(tuple(tuple(v.entries[i] if i == j else _ZERO for j in range(n)) for i in range(n)))

    def _transpose(self, matrix: Value) -> Value:
        return Matrix(tuple(zip(*matrix.rows, strict=True))) if isinstance(matrix, Matrix) else _NO_VALUE

    def _trace(self, matrix: Value) -> Value:
        if not isinstance(matrix, Matrix) or not _is_square(matrix):
            return _NO_VALUE
        return self.scalars.sum([row[i] for i, row in enumerate(matrix.rows)])

    def _inverse(self, value: Value) -> Value:
        if isinstance(value, Vector):
            return self._diagonal(Vector(tuple(map(self.scalars.reciprocal, value.entries))))
        if not isinstance(value, Matrix) or not _is_square(value):
            return _NO_VALUE
        rows = value.rows
        if all(entry == 0 for i, row in enumerate(rows) for j, entry in enumerate(row) if i != j):
            return self._inverse(Vector(tuple(row[i] for i, row in enumerate(rows))))
        if all(isinstance(entry, Fraction) for entry in chain.from_iterable(rows)):
            return Matrix(_rational_inverse([list(row) for row in rows]))
        return self._symbolic_inverse(rows)

    def _symbolic_inverse(self, rows: Sequence[Sequence[Exact]]) -> Matrix:
        """Cramer's rule: the cofactors over the determinant."""
        n = len(rows)
        if n > MAX_SYMBOLIC_INVERSE:
            raise RefusedError(
                f"a symbolic matrix must be at most {MAX_SYMBOLIC_INVERSE} x {MAX_SYMBOLIC_INVERSE} to be inverted; "
                f"got {n} x {n}. Give the inverse matrix as a parameter instead"
            )
        determinant = self._determinant(rows)
        if determinant == 0 or determinant.expand() == 0:  # type: ignore[union-attr]
            raise RefusedError("a matrix must have an inverse; the determinant of this one is 0")
        reciprocal = self.scalars.reciprocal(determinant)
        return Matrix(
            tuple(
                tuple(self.scalars.product([reciprocal, self._cofactor(rows, j, i)]) for j in range(n))
                for i in range(n)
            )
        )

    def _determinant(self, rows: Sequence[Sequence[Exact]]) -> Exact:
        if len(rows) == 1:
            return rows[0][0]
        return self.scalars.sum(
            [self.scalars.product([rows[0][j], self._cofactor(rows, 0, j)]) for j in range(len(rows))]
        )

    def _cofactor(self, rows: Sequence[Sequence[Exact]], i: int, j: int) -> Exact:
        if len(rows) == 1:
            return _ONE
        minor = [[entry for q, entry in enumerate(row) if q != j] for p, row in enumerate(rows) if p != i]
        return self.scalars.product([Fraction((-1) ** (i + j)), self._determinant(minor)])

    def _inner(self, u: Sequence[Exact], v: Sequence[Exact]) -> Exact:
        pairs = [(x, y) for x, y in zip(u, v, strict=True) if x != 0 and y != 0]
        return self.scalars.sum([self.scalars.product(pair) for pair in pairs])

    def _minor(self, u: Sequence[Exact], v: Sequence[Exact], i: int, j: int) -> Exact:
        positive = self.scalars.product([u[i], v[j]])
        return self.scalars.sum([positive, self.scalars.product([-_ONE, u[j], v[i]])])


_NO_VALUE = Vector(())
"""What a function returns for arguments of the wrong kind or shape."""


def _is_square(matrix: Matrix) -> bool:
    return len(matrix.rows) == len(matrix.rows[0])


def _rational_inverse(rows: Sequence[Sequence[Exact]]) -> tuple[tuple[Exact, ...], ...]:
    """The inverse of a matrix of Fractions."""
    from flint import fmpq, fmpq_mat

    n = len(rows)
    numbers = [entry for row in rows for entry in row if isinstance(entry, Fraction)]
    longest = max(number.numerator.bit_length() + number.denominator.bit_length() for number in numbers)
    if n * longest > 1000 * MAX_INVERSE:
        raise RefusedError(f"a matrix must be smaller to be inverted; got {n} x {n} with numbers of {longest} bits")
    matrix = fmpq_mat(n, n, [fmpq(number.numerator, number.denominator) for number in numbers])
    if matrix.det() == 0:
        raise RefusedError("a matrix must have an inverse; the determinant of this one is 0")
    inverse = matrix.inv()
    return tuple(tuple(Fraction(int(inverse[i, j].p), int(inverse[i, j].q)) for j in range(n)) for i in range(n))
