"""How long does a search for first integrals take, and what does the sparse elimination modulo a prime gain?

`python benchmarks/integrals.py [--quick]`.  All polynomial integrals of a generic top up to degree 4, 5 and 6, and of
weight 12 of the twisted Kovalevskaya top, each with the proof that there are no others: the whole call, without the
imports; the least of five.  Beside it: `nmod_mat.nullspace` of python-flint for the same matrices as dense ones,
without making them, once.  With --quick matrices of over 2500 columns, which take minutes, are left out.

On two cores of a busy machine: degree 4, 5, 6 and weight 12 in 0.01, 0.03, 0.09 and 0.26 s, and 0.3, 5, 70 and 1.3 s.
The process needs 0.1 GB of memory for each; for degrees 8, 9 and 10 0.2, 0.3 and 0.5 GB.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import liepoisson as lp
from liepoisson.integrability.derivation import (
    derivation_of,
    gradings,
    in_blocks,
    of_degree,
    of_weight,
    positive_grading,
)

REPEATS = 5
MANY_COLUMNS = 2500
GENERIC = lp.Top(inertia=(2, 3, 5), a=(1, 2, 3), b=(3, -1, 2), epsilon=1)
CASES: dict[str, tuple[Any, dict[str, Any]]] = {
    "degree 4": (GENERIC, {"degree": 4}),
    "degree 5": (GENERIC, {"degree": 5}),
    "degree 6": (GENERIC, {"degree": 6}),
    "weight 12": (lp.Top.twisted_kovalevskaya(), {"weight": 12}),
}


def main() -> None:
    """One line for each case."""
    quick = "--quick" in sys.argv[1:]
    lp.integrability.first_integrals(GENERIC, degree=1)  # imports
    print("case        columns  integrals  liepoisson    FLINT, dense")
    for name, (system, size) in CASES.items():
        found, seconds = timed(lambda: lp.integrability.first_integrals(system, **size), REPEATS)  # noqa: B023
        assert found.complete
        assert not found.found
        matrices = dense_matrices(system, size)
        if quick and max(matrix.ncols() for matrix in matrices) > MANY_COLUMNS:
            beside = "not run"
        else:
            nullities, flint = timed(lambda: [int(matrix.nullspace()[1]) for matrix in matrices], 1)  # noqa: B023
            assert sum(nullities) == found.n_integrals, "both must find the same dimension"
            beside = f"{flint:.2f} s"
        print(f"{name:<10} {found.n_monomials:8}  {found.n_integrals:9}  {seconds:8.3f} s  {beside:>14}")


def timed(call: Callable[[], Any], repeats: int) -> tuple[Any, float]:
    """The last result, and the least time."""
    times: list[float] = []
    result = None
    for _ in range(repeats):
        began = time.perf_counter()
        result = call()
        times.append(time.perf_counter() - began)
    return result, min(times)


def dense_matrices(system: Any, size: dict[str, int]) -> list[Any]:
    """The matrices of the blocks modulo the same prime."""
    from flint import nmod_mat

    flow = derivation_of(system)[0]
    residues, found = flow.field.residues(seed=1), gradings(flow)
    assert residues is not None
    if "weight" in size:
        grading = positive_grading(found)
        assert grading is not None
        monomials = list(of_weight(grading.weights, size["weight"]))
    else:
        monomials = [m for d in range(1, size["degree"] + 1) for m in of_degree(len(flow.variables), d)]
    matrices: list[Any] = []
    for block in in_blocks(iter(monomials), found).values():
        rows: dict[tuple[int, ...], dict[int, int]] = {}
        for column, monomial in enumerate(block):
            for key, value in flow({monomial: flow.field.one}).items():
                rows.setdefault(key, {})[column] = residues(value)
        matrix = nmod_mat(len(rows), len(block), residues.p)
        for i, row in enumerate(rows.values()):
            for column, value in row.items():
                matrix[i, column] = value
        matrices.append(matrix)
    return matrices


if __name__ == "__main__":
    main()
