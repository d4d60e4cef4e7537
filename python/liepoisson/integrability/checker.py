"""A short, separate check of a certificate of integrability: Python's fractions, and nothing of the search.

    python -m liepoisson.integrability.checker certificate.json

A polynomial is a list of terms [coefficient, exponents]; the Poisson matrix is a list of entries [i, j, polynomial], i < j.
The certificate says: these functions are Casimirs, these commute with H and with each other, and at the point there are
as many with independent vector fields as half the rank of the matrix, which is the largest possible.
"""

import json
import sys
from fractions import Fraction
from pathlib import Path


def polynomial(terms):
    return {tuple(m): Fraction(c) for c, m in terms}


def derivative(f, k):
    return {(*m[:k], m[k] - 1, *m[k + 1 :]): c * m[k] for m, c in f.items() if m[k]}


def add_product(total, f, g, sign=1):
    for m, c in f.items():
        for n, d in g.items():
            key = tuple(a + b for a, b in zip(m, n))
            total[key] = total.get(key, 0) + sign * c * d


def bracket(f, g, matrix):
    """{f, g} = sum_ij J_ij d_i f d_j g."""
    total = {}
    for i, j, entry in matrix:
        for first, second, sign in ((i, j, 1), (j, i, -1)):
            inner = {}
            add_product(inner, derivative(f, first), derivative(g, second))
            add_product(total, entry, inner, sign)
    return {m: c for m, c in total.items() if c}


def value(f, x):
    total = Fraction(0)
    for m, c in f.items():
        for base, power in zip(x, m):
            c *= base**power
        total += c
    return total


def rank(rows):
    rows, found = [list(row) for row in rows], 0
    for column in range(len(rows[0]) if rows else 0):
        pivot = next((k for k in range(found, len(rows)) if rows[k][column]), None)
        if pivot is None:
            continue
        rows[found], rows[pivot] = rows[pivot], rows[found]
        for k in range(found + 1, len(rows)):
            factor = rows[k][column] / rows[found][column]
            rows[k] = [a - factor * b for a, b in zip(rows[k], rows[found])]
        found += 1
    return found


def check(certificate):
    """What is wrong with a certificate, as a text; empty if it is right."""
    n = len(certificate["variables"])
    x = [polynomial([["1", [int(i == k) for i in range(n)]]]) for k in range(n)]
    matrix = [(i, j, polynomial(entry)) for i, j, entry in certificate["poisson_matrix"]]
    if any(not 0 <= i < j < n for i, j, _ in matrix) or len({(i, j) for i, j, _ in matrix}) < len(matrix):
        return "the Poisson matrix is not one entry for each i < j"
    for i in range(n):
        for j in range(i):
            for k in range(j):
                total = {}
                for a, b, c in ((i, j, k), (j, k, i), (k, i, j)):
                    add_product(total, bracket(bracket(x[a], x[b], matrix), x[c], matrix), {(0,) * n: Fraction(1)})
                if any(total.values()):
                    return f"the Jacobi identity fails for {i}, {j}, {k}"
    casimirs = {name: polynomial(f) for name, f in certificate["casimirs"].items()}
    commuting = {name: polynomial(f) for name, f in certificate["commuting"].items()}
    hamiltonian = polynomial(certificate["hamiltonian"])
    for name, f in casimirs.items():
        if any(bracket(f, y, matrix) for y in x):
            return f"{name} is no Casimir"
    for name, f in commuting.items():
        if bracket(f, hamiltonian, matrix):
            return f"{name} does not commute with H"
        if wrong := [other for other, g in commuting.items() if bracket(f, g, matrix)]:
            return f"{name} does not commute with {wrong[0]}"
    point = [Fraction(c) for c in certificate["point"]]
    tensor = [[Fraction(0)] * n for _ in range(n)]
    for i, j, entry in matrix:
        tensor[i][j], tensor[j][i] = value(entry, point), -value(entry, point)
    slopes = {name: [value(derivative(f, k), point) for k in range(n)] for name, f in (casimirs | commuting).items()}
    fields = [[sum(a * b for a, b in zip(row, slopes[name])) for row in tensor] for name in commuting]
    if rank(tensor) != n - rank([slopes[name] for name in casimirs]):
        return "the point lies on a leaf of lower dimension than others, or Casimirs are missing"
    if 2 * rank(fields) != rank(tensor):
        return "there are fewer independent commuting integrals than half the dimension of the leaves"
    return ""


if __name__ == "__main__":
    wrong = check(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
    print(f"REFUSED: {wrong}" if wrong else "accepted: Liouville integrable")
    sys.exit(bool(wrong))
