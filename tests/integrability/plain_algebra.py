"""Integrals of a degree by exact linear algebra alone: null spaces on all monomials, and products of functions."""

from itertools import combinations_with_replacement

from flint import fmpq, fmpq_mat
from sympy import Poly, expand


def monomials(n, degree):
    found = []
    for k in range(1, degree + 1):
        for places in combinations_with_replacement(range(n), k):
            found.append(tuple(places.count(i) for i in range(n)))
    return found


def terms(expression, variables):
    e = expand(expression)
    return {m: fmpq(int(c.p), int(c.q)) for m, c in Poly(e, *variables).terms()} if e != 0 else {}


def times(a, b):
    total = {}
    for m, c in a.items():
        for k, d in b.items():
            key = tuple(map(sum, zip(m, k, strict=True)))
            total[key] = total.get(key, fmpq(0)) + c * d
    return {m: c for m, c in total.items() if c}


def rank(polynomials):
    keys = sorted({m for f in polynomials for m in f})
    if not keys:
        return 0
    matrix, places = fmpq_mat(len(polynomials), len(keys)), {m: k for k, m in enumerate(keys)}
    for row, f in enumerate(polynomials):
        for m, c in f.items():
            matrix[row, places[m]] = c
    return matrix.rank()


def n_integrals(rates, n, degree):
    images = []
    for m in monomials(n, degree):
        total = {}
        for k, power in enumerate(m):
            lowered = {(*m[:k], power - 1, *m[k + 1 :]): fmpq(power)} if power else {}
            for key, c in times(lowered, rates[k]).items():
                total[key] = total.get(key, fmpq(0)) + c
        images.append({key: c for key, c in total.items() if c})
    return len(images) - rank(images)


def n_polynomials_in(functions, degree):
    """The dimension of what polynomials in some functions give up to a degree."""
    functions = [f for g in functions if (f := {m: c for m, c in g.items() if any(m)})]
    if not functions:
        return 0
    sizes, best = [max(map(sum, f)) for f in functions], 0
    for highest in range(degree, 3 * degree + max(sizes) + 3):
        products = []

        def extend(start, left, factor, products=products):
            if factor is not None:
                products.append(factor)
            for k in range(start, len(functions)):
                if sizes[k] <= left:
                    extend(k, left - sizes[k], functions[k] if factor is None else times(factor, functions[k]))

        extend(0, highest, None)
        if len(products) > 250:
            break
        above = [{m: c for m, c in f.items() if sum(m) > degree} for f in products]
        best = max(best, rank(products) - rank(above))
    return best
