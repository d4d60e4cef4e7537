"""A short, separate check of a certificate of integrability: Python's fractions, and nothing of the search.

    python -m liepoisson.integrability.checker certificate.json

A polynomial is a list of terms [coefficient, exponents], the Poisson matrix one of entries [i, j, polynomial], i < j.
The certificate says: these functions are Casimirs, these commute with H and with each other, and at the point as many
have independent vector fields as half the rank of the matrix, which is the largest possible.
"""
# pyright: basic
# ruff: noqa: D103

import json
import sys
from fractions import Fraction
from pathlib import Path


def polynomial(terms, n):
    if any(len(m) != n or any(type(k) is not int or k < 0 for k in m) for _, m in terms):
        raise ValueError(f"exponents are {n} whole numbers")
    return {tuple(m): Fraction(c) for c, m in terms}


def derivative(f, k):
    return {(*m[:k], m[k] - 1, *m[k + 1 :]): c * m[k] for m, c in f.items() if m[k]}


def product(f, g, sign=1):
    return [(tuple(map(int.__add__, m, n)), sign * c * d) for m, c in f.items() for n, d in g.items()]


def summed(pairs):
    total = {}
    for m, c in pairs:
        total[m] = total.get(m, 0) + c
    return {m: c for m, c in total.items() if c}


def bracket(f, g, matrix):
    """{f, g}, the sum of J_ij (d_i f d_j g - d_j f d_i g) over i < j."""
    pairs = []
    for i, j, entry in matrix:
        inner = product(derivative(f, i), derivative(g, j)) + product(derivative(f, j), derivative(g, i), -1)
        pairs += product(entry, summed(inner))
    return summed(pairs)


def value(f, point):
    total = Fraction(0)
    for m, term in f.items():
        for x, power in zip(point, m, strict=True):
            term *= x**power  # noqa: PLW2901
        total += term
    return total


def rank(rows):
    first = next((row for row in rows if any(row)), None)
    if first is None:
        return 0
    k = next(k for k, entry in enumerate(first) if entry)
    return 1 + rank([[a - row[k] / first[k] * b for a, b in zip(row, first, strict=True)] for row in rows])


def faults(certificate):
    n = len(certificate["variables"])
    x = [polynomial([["1", [int(i == k) for i in range(n)]]], n) for k in range(n)]
    matrix = [(i, j, polynomial(entry, n)) for i, j, entry in certificate["poisson_matrix"]]
    if len({(i, j) for i, j, _ in matrix if 0 <= i < j < n}) < len(matrix):
        yield "the Poisson matrix has not one entry for each i < j"
    for i, j, k in [(a, b, c) for a in range(n) for b in range(a) for c in range(b)]:
        cyclic = [bracket(bracket(x[a], x[b], matrix), x[c], matrix) for a, b, c in ((i, j, k), (j, k, i), (k, i, j))]
        if summed(pair for f in cyclic for pair in f.items()):
            yield f"the Jacobi identity fails for the coordinates {k}, {j}, {i}"
    casimirs = {name: polynomial(f, n) for name, f in certificate["casimirs"].items()}
    commuting = {name: polynomial(f, n) for name, f in certificate["commuting"].items()}
    yield from (f"{name} is no Casimir" for name, f in casimirs.items() if any(bracket(f, y, matrix) for y in x))
    for other, g in [("H", polynomial(certificate["hamiltonian"], n)), *commuting.items()]:
        yield from (f"{name} does not commute with {other}" for name, f in commuting.items() if bracket(f, g, matrix))
    point = [Fraction(c) for c in certificate["point"]]
    at_point = {(i, j): value(entry, point) for i, j, entry in matrix}
    tensor = [[at_point.get((i, j), Fraction(0)) - at_point.get((j, i), 0) for j in range(n)] for i in range(n)]
    slopes = {name: [value(derivative(f, k), point) for k in range(n)] for name, f in {**casimirs, **commuting}.items()}
    fields = [[sum(map(Fraction.__mul__, row, slopes[name])) for row in tensor] for name in commuting]
    if rank(tensor) + rank([slopes[name] for name in casimirs]) != n:
        yield "the point lies on a leaf of lower dimension than others, or Casimirs are missing"
    if 2 * rank(fields) != rank(tensor):
        yield "there are fewer independent commuting integrals than half the dimension of the leaves"


def check(certificate):
    """What is wrong with a certificate, as a text; empty if it is right."""
    return next(faults(certificate), "")


if __name__ == "__main__":
    fault = check(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
    print(f"REFUSED: {fault}" if fault else "accepted: Liouville integrable")
    sys.exit(bool(fault))
