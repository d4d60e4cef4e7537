"""How long does cohomology of Lie algebras take, and how much longer does a plain script of the same linear algebra?

`python benchmarks/lie_cohomology.py [--quick]`.  H^2 with adjoint coefficients: the whole call with representatives and
proof, without the imports, the least of five.  Beside it a plain script with SymPy: the two matrices of Chevalley and
Eilenberg's complex from their definition, as sparse ones over the rationals (`DomainMatrix`), cocycles, coboundaries,
and a basis of the ones modulo the others; once.  Seconds are those of the process.  With --quick only small cases are
run by SymPy.

On two cores of a busy machine: 1 to 30 ms for so(4), sl(3), so(5), so(6) and so(7), 7 to 50 times less than SymPy; 10,
33 and 92 ms for so(3) with leibniz(4), (6) and (8), 10 to 25 times less.  SymPy's sparse elimination with FLINT's
numbers gains from the same zeros.  Most of the rest of the time here goes into lists and weights in Python.
"""

from __future__ import annotations

import sys
from itertools import combinations
from typing import Any

import liepoisson as lp
from measure import timed

REPEATS = 5
CASES: dict[str, tuple[Any, bool]] = {
    "so(4)": (lp.so(4), True),
    "sl(3)": (lp.sl(3), True),
    "so(5)": (lp.so(5), True),
    "so(6)": (lp.so(6), False),
    "so(7)": (lp.so(7), False),
    "so(3) x leibniz(4)": (lp.algebras.current_algebra(lp.so(3) @ lp.leibniz(4)), True),
    "so(3) x leibniz(6)": (lp.algebras.current_algebra(lp.so(3) @ lp.leibniz(6)), False),
    "so(3) x leibniz(8)": (lp.algebras.current_algebra(lp.so(3) @ lp.leibniz(8)), False),
}
"""Algebras, and whether they are small."""


def main() -> None:
    """One line for each case."""
    quick = "--quick" in sys.argv[1:]
    lp.algebras.cohomology(lp.so(3), 2, "adjoint")  # imports
    plain_classes(lp.so(3))
    print("H^2(g, g) of           cochains  dimension  liepoisson       SymPy   ratio")
    for name, (algebra, is_short) in CASES.items():
        found, seconds = timed(lambda: lp.algebras.cohomology(algebra, 2, "adjoint"), REPEATS)  # noqa: B023
        n = algebra.dimension
        line = f"{name:<20} {n * n * (n - 1) // 2:10}  {found.dimension:9}  {seconds:8.4f} s"
        if quick and not is_short:
            print(f"{line}     not run")
            continue
        dimension, plain = timed(lambda: plain_classes(algebra), 1)  # noqa: B023
        assert dimension == found.dimension, "both must find the same dimension"
        print(f"{line}  {plain:8.2f} s  {plain / seconds:6.0f}")


def plain_classes(algebra: Any) -> int:
    """H^2(g, g) as a textbook says it: a basis of cocycles, and those of them that are independent of coboundaries."""
    n, c = algebra.dimension, algebra.structure_constants
    cocycles = plain_differential(n, c, 2).nullspace()
    coboundaries = plain_differential(n, c, 1).transpose().rref()[0]
    both = coboundaries.vstack(cocycles.to_sparse())
    _, pivots = both.transpose().rref()
    return sum(pivot >= coboundaries.shape[0] for pivot in pivots)


def plain_differential(n: int, c: Any, k: int) -> Any:
    """The matrix of d on k-cochains with adjoint coefficients, sparse, over the rationals."""
    from sympy import QQ
    from sympy.polys.matrices import DomainMatrix

    place = {s: r for r, s in enumerate(combinations(range(n), k))}
    rows: dict[int, dict[int, Any]] = {}

    def add(row: int, arguments: tuple[int, ...], a: int, value: Any) -> None:
        """Add value times the component a of f(arguments)."""
        if len(set(arguments)) < k:
            return
        swaps = sum(x > y for r, x in enumerate(arguments) for y in arguments[r + 1 :])
        column = place[tuple(sorted(arguments))] * n + a
        entries = rows.setdefault(row, {})
        entries[column] = entries.get(column, QQ(0)) + (-1) ** swaps * QQ(value.numerator, value.denominator)

    larger = list(combinations(range(n), k + 1))
    for r, xs in enumerate(larger):
        for b in range(n):
            for i, x in enumerate(xs):
                for a in range(n):
                    if c[x][a][b]:
                        add(r * n + b, (*xs[:i], *xs[i + 1 :]), a, (-1) ** i * c[x][a][b])
            for i, j in combinations(range(k + 1), 2):
                rest = tuple(x for s, x in enumerate(xs) if s not in (i, j))
                for l in range(n):
                    if c[xs[i]][xs[j]][l]:
                        add(r * n + b, (l, *rest), b, (-1) ** (i + j) * c[xs[i]][xs[j]][l])
    rows = {r: kept for r, row in rows.items() if (kept := {s: v for s, v in row.items() if v})}
    return DomainMatrix(rows, (len(larger) * n, len(place) * n), QQ)


if __name__ == "__main__":
    main()
