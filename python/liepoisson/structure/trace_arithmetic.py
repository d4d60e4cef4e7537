"""Products of matrices modulo a prime, over the rationals and over cyclotomic fields, behind one set of functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from operator import mul
from typing import Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.number_fields import as_fmpq
from liepoisson.algebra.residues import Residues
from liepoisson.structure.lie.defining_matrices import sparse_product


@dataclass(frozen=True)
class Arithmetic:
    """How matrices are multiplied, and in what the results are.

    Attributes:
        number: An entry of the F^k, or a coordinate, as a number of the matrices.
        matrix: A matrix from its number of rows and its nonzero entries.
        entry: An entry of a matrix.
        times: The product of two matrices.
        result: A number of the matrices as a result.
        coefficient: An element of the field of the bracket as a result.
    """

    number: Callable[[Any], Any]
    matrix: Callable[[int, dict[tuple[int, int], Any]], Any]
    entry: Callable[[Any, int, int], Any]
    times: Callable[[Any, Any], Any]
    result: Callable[[Any], Any]
    coefficient: Callable[[Any], Any]


def modular_arithmetic(residues: Residues) -> Arithmetic:
    """Modulo the prime of the residues, by python-flint."""
    from flint import nmod, nmod_mat

    def matrix(m: int, entries: dict[tuple[int, int], Any]) -> Any:
        return nmod_mat([[int(entries.get((i, j), 0)) for j in range(m)] for i in range(m)], residues.p)

    def number(value: Any) -> Any:
        return nmod(residues(value), residues.p)

    return Arithmetic(number, matrix, lambda M, i, j: M[i, j], mul, int, lambda c: nmod(residues(c), residues.p))


def rational_arithmetic(field: Coefficients) -> Arithmetic:
    """In rational matrices, by python-flint; results are elements of the field."""
    from flint import fmpq_mat

    def matrix(m: int, entries: dict[tuple[int, int], Any]) -> Any:
        return fmpq_mat([[entries.get((i, j), 0) for j in range(m)] for i in range(m)])

    def number(value: Any) -> Any:
        return as_fmpq(Fraction(value))

    def result(value: Any) -> Any:
        return field.number(Fraction(int(value.p), int(value.q)))

    return Arithmetic(number, matrix, lambda M, i, j: M[i, j], mul, result, lambda c: c)


def cyclotomic_arithmetic(field: Coefficients) -> Arithmetic:
    """In sparse matrices of elements of a cyclotomic field."""
    zero = field.zero

    def number(value: Any) -> Any:
        return field.number(value) if isinstance(value, (int, Fraction)) else value

    return Arithmetic(
        number, lambda _m, entries: entries, lambda M, i, j: M.get((i, j), zero), sparse_product, lambda c: c, number
    )
