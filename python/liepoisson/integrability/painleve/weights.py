r"""Weights for which the singular part of a polynomial vector field is quasi-homogeneous.

A solution with poles of orders $g_i$, $x_i = c_i\,\tau^{-g_i} + \dots$, is dominated by the terms of
$\dot x_i = f_i(x)$ that are of weight $g_i + 1$, if no term is of a larger one:

$$\sum_j m_j g_j \le g_i + 1 \quad\text{for each term } x^m \text{ of } f_i .$$

These inequalities, with $g\ge0$, describe a polyhedron. Poles that are of lower orders than g are among the series for
g, with leading coefficients that vanish, so that only maximal weights are wanted. Where the largest value of each
weight fits all inequalities, there is one choice. A weight that may be as large as one likes belongs to coordinates
that follow the others linearly; it is taken as large as the largest of the others.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.integrability.derivation import Derivation

_MOST_NODES = 200_000
"""Partial choices of whole weights that are tried where there is no largest one."""

Row = tuple[Fraction, ...]


def inequalities(derivation: Derivation) -> list[Row]:
    r"""The rows of $m - e_i$, whose products with the weights are at most 1."""
    rows: set[Row] = set()
    for i, component in enumerate(derivation.components):
        for monomial in component:
            row = [Fraction(m) for m in monomial]
            row[i] -= 1
            if any(x > 0 for x in row):
                rows.add(tuple(row))
    return sorted(rows)


def excess(rows: Iterable[Row], weights: Sequence[Fraction]) -> Fraction:
    """The largest product of a row with the weights; 0 if there are no rows."""
    return max(
        (sum((r * w for r, w in zip(row, weights, strict=True)), Fraction(0)) for row in rows), default=Fraction()
    )


def maximal_weights(derivation: Derivation) -> tuple[tuple[Fraction, ...], ...]:
    """All maximal weights; where there is no largest choice, all whole ones that are maximal.

    Raises:
        ParameterError: there are too many to try.
    """
    rows = inequalities(derivation)
    n = len(derivation.variables)
    tops = [_largest(rows, k, n) for k in range(n)]
    if any(top is None for top in tops):
        cap = max([top for top in tops if top is not None], default=Fraction(1)) or Fraction(1)
        limits = [tuple(Fraction(int(j == k)) / cap for j in range(n)) for k in range(n) if tops[k] is None]
        rows = [*rows, *limits]
        tops = [_largest(rows, k, n) for k in range(n)]
    bounds = [top for top in tops if top is not None]
    if excess(rows, bounds) <= 1:
        return (tuple(bounds),)
    return _maximal_whole(rows, bounds)


def _largest(rows: Sequence[Row], k: int, n: int) -> Fraction | None:
    """The largest value of one weight, by the simplex method with Bland's rule; None if there is none."""
    m = len(rows)
    table: list[list[Fraction]] = []
    for i, row in enumerate(rows):
        checkpoint("the weights")
        table.append([*row, *(Fraction(int(i == j)) for j in range(m)), Fraction(1)])
    cost = [Fraction(int(j == k)) for j in range(n)] + [Fraction(0)] * (m + 1)
    basis = list(range(n, n + m))
    while True:
        column = next((j for j in range(n + m) if cost[j] > 0), None)
        if column is None:
            return -cost[-1]
        ratios = [(row[-1] / row[column], basis[i], i) for i, row in enumerate(table) if row[column] > 0]
        if not ratios:
            return None
        _, _, pivot = min(ratios)
        scale = table[pivot][column]
        table[pivot] = [x / scale for x in table[pivot]]
        for i, row in enumerate(table):
            checkpoint("the weights")
            if i != pivot and row[column]:
                table[i] = [x - row[column] * y for x, y in zip(row, table[pivot], strict=True)]
        cost = [x - cost[column] * y for x, y in zip(cost, table[pivot], strict=True)]
        basis[pivot] = column


def _maximal_whole(rows: Sequence[Row], bounds: Sequence[Fraction]) -> tuple[tuple[Fraction, ...], ...]:
    """The maximal ones among whole weights that satisfy the inequalities."""
    n, nodes = len(bounds), 0
    found: list[tuple[Fraction, ...]] = []
    chosen: list[Fraction] = []

    def fits() -> bool:
        for row in rows:
            least = Fraction(0)
            for k, r in enumerate(row):
                least += r * chosen[k] if k < len(chosen) else min(r, Fraction(0)) * bounds[k]
            if least > 1:
                return False
        return True

    def search() -> None:
        nonlocal nodes
        nodes += 1
        checkpoint("the weights")
        if nodes > _MOST_NODES:
            raise ParameterError(
                f"weights: wanted equations with few choices of weights for their singular part; after {_MOST_NODES:,} "
                "attempts there are more. Give the weights of the coordinates"
            )
        if any(all(w <= v for w, v in zip([*chosen, *bounds[len(chosen) :]], other, strict=True)) for other in found):
            return
        if len(chosen) == n:
            found.append(tuple(chosen))
            return
        for value in range(int(bounds[len(chosen)]), -1, -1):
            chosen.append(Fraction(value))
            if fits():
                search()
            chosen.pop()

    search()
    return tuple(w for w in found if not any(w != v and all(a <= b for a, b in zip(w, v, strict=True)) for v in found))
