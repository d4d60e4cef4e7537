"""Does an integral survive a twist?  How long does the first order take, beside a plain SymPy script?

`python benchmarks/deformations.py [WEIGHT]`.  The Kovalevskaya top on the twisted bracket: all products of K, l.alpha,
H and Casimirs up to a weight, 8 by default, with every correction of first order.  liepoisson: the whole call, with a
functional as the proof for each product that has no correction.  SymPy: for each weight the derivative of every
monomial and of every product as a polynomial, and the rank of the sparse matrix over the rationals with and without the
products; no gradings but the weight, no proof.  Process times, the least of three and of one.

On a busy machine: weight 8 in 0.08 s and 4.8 s, 60 times; weight 6 in 0.03 s and 0.3 s, 12 times.
"""

from __future__ import annotations

import sys
from itertools import product

import sympy
from sympy import QQ, Poly
from sympy.polys.matrices import DomainMatrix

import liepoisson as lp
from measure import timed

REPEATS = 3
WEIGHTS = (1, 1, 1, 2, 2, 2, 3, 3, 3)
TOP = lp.System(lp.so(3) @ lp.leibniz(3, "epsilon"), "dot(l, inv(I)*l)/2 - alpha1", {"I": [2, 2, 1]})


def main() -> None:
    """One line for both."""
    weight = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    lp.deformations(TOP, weight=3, order=1)  # imports
    found, seconds = timed(lambda: lp.deformations(TOP, weight=weight, order=1), REPEATS)
    (n_products, n_surviving), plain = timed(lambda: by_sympy(weight), 1)
    assert n_products - n_surviving == len(found.obstructions), "both must find the same"
    print(f"weight {weight}: {found.n_starts} products, {len(found.obstructions)} obstructions")
    print(f"liepoisson {seconds:.2f} s, SymPy {plain:.1f} s, {plain / seconds:.0f} times")


def by_sympy(most: int) -> tuple[int, int]:
    """How many products of integrals there are up to a weight, independent ones, and how many have corrections."""
    x = sympy.symbols("l1:4 alpha1:4 beta1:4")
    l, alpha, beta = (sympy.Matrix(x[k : k + 3]) for k in (0, 3, 6))
    a = sympy.Matrix([-1, 0, 0])
    omega = sympy.Matrix([l[0] / 2, l[1] / 2, l[2]])
    equations = [*(l.cross(omega) + alpha.cross(a)), *alpha.cross(omega), *beta.cross(omega)]
    rates = [Poly(f, *x, domain=QQ) for f in equations]
    twist = [Poly(f, *x, domain=QQ) for f in [0, 0, 0, *beta.cross(a), 0, 0, 0]]
    energy = l.dot(omega) / 2 + alpha.dot(a)
    quartic = ((l[0] ** 2 - l[1] ** 2) / 4 + alpha[0]) ** 2 + (l[0] * l[1] / 2 + alpha[1]) ** 2
    known = [
        (2, energy), (3, l.dot(alpha)), (4, quartic), (4, alpha.dot(alpha)), (5, alpha.dot(beta)), (6, beta.dot(beta)),
    ]  # fmt: skip

    def along(f: Poly, field: list[Poly]) -> Poly:
        return sum((f.diff(v) * rate for v, rate in zip(x, field, strict=True)), Poly(0, *x, domain=QQ))

    n_products = n_surviving = 0
    for weight in range(1, most + 1):
        chosen = [
            powers
            for powers in product(*(range(weight // w + 1) for w, _ in known))
            if sum(k * w for k, (w, _) in zip(powers, known, strict=True)) == weight
        ]
        starts = [
            Poly(sympy.prod(f**k for k, (_, f) in zip(powers, known, strict=True)), *x, domain=QQ) for powers in chosen
        ]
        monomials = [Poly({m: 1}, *x, domain=QQ) for m in of_weight(weight)]
        images = [along(m, rates) for m in monomials]
        targets = [along(f, twist) for f in starts]
        # corrections of an integral are determined up to integrals: what counts is the rank
        without, together = rank(images), rank([*images, *targets])
        trivial = sum(powers[1] == powers[2] == 0 for powers in chosen)
        n_products += len(chosen) - trivial
        n_surviving += len(chosen) - trivial - (together - without)
    return n_products, n_surviving


def of_weight(weight: int) -> list[tuple[int, ...]]:
    """All exponents of one weight."""
    found = [()]
    for w in WEIGHTS:
        found = [(*m, k) for m in found for k in range(weight // w + 1)]
        found = [m for m in found if sum(a * b for a, b in zip(m, WEIGHTS, strict=False)) <= weight]
    return [m for m in found if sum(a * b for a, b in zip(m, WEIGHTS, strict=True)) == weight]


def rank(columns: list[Poly]) -> int:
    """The rank of polynomials as vectors."""
    rows = {m: k for k, m in enumerate(dict.fromkeys(m for column in columns for m in column.monoms()))}
    entries = {
        k: {rows[m]: c for m, c in zip(column.monoms(), map(QQ.convert, column.coeffs()), strict=True)}
        for k, column in enumerate(columns)
        if column
    }
    return DomainMatrix(entries, (len(columns), len(rows)), QQ).rank()


if __name__ == "__main__":
    main()
