"""Dense matrices over a commutative ring: products, determinants, and over the rationals characteristic polynomials."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TypeAlias

from liepoisson.algebra.number_fields import Element
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
