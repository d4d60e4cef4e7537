r"""The characteristic polynomial of a matrix of entries, by Faddeev and LeVerrier's recursion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from liepoisson.integrability.lax.entries import Element, EntryArithmetic

Rows: TypeAlias = "Sequence[Sequence[Element]]"


def matrix_product(first: Rows, second: Rows, arithmetic: EntryArithmetic) -> list[list[Element]]:
    """The product of two square matrices, in canonical form."""
    n, zero = len(first), arithmetic.number(0)
    columns = [[row[j] for row in second] for j in range(n)]
    return [
        [arithmetic.canonical(sum((a * b for a, b in zip(row, c, strict=True) if a and b), zero)) for c in columns]
        for row in first
    ]


def commutator(first: Rows, second: Rows, arithmetic: EntryArithmetic) -> list[list[Element]]:
    """The matrix AB - BA."""
    ab, ba = matrix_product(first, second, arithmetic), matrix_product(second, first, arithmetic)
    return [[x - y for x, y in zip(r, s, strict=True)] for r, s in zip(ab, ba, strict=True)]


def characteristic_coefficients(matrix: Rows, arithmetic: EntryArithmetic) -> list[Element]:
    r"""The coefficients $c_k$ of $\det(w - A) = \sum_k c_k w^{n-k}$, with $c_0 = 1$.

    $M_1 = 1$, $c_k = -\operatorname{tr}(A M_k)/k$, $M_{k+1} = A M_k + c_k$.
    """
    n = len(matrix)
    found = [arithmetic.number(1)]
    m = [[arithmetic.number(int(i == j)) for j in range(n)] for i in range(n)]
    for k in range(1, n + 1):
        m = matrix_product(matrix, m, arithmetic)
        trace = sum((m[i][i] for i in range(n)), arithmetic.number(0))
        c = arithmetic.canonical(trace * arithmetic.number(-1, k))
        found.append(c)
        for i in range(n):
            m[i][i] = m[i][i] + c
    return found
