"""The definition of Chevalley and Eilenberg, written out with SymPy: the independent answer of the tests."""

from itertools import combinations

import sympy as sp
from sympy.polys.matrices import DomainMatrix


def action_of(algebra, coefficients):
    """Matrices of the module: rho[i][b, a] is the component along v_b of e_i v_a."""
    n = algebra.dimension
    c = algebra.structure_constants
    if coefficients == "trivial":
        return [sp.zeros(1, 1)] * n
    if coefficients == "adjoint":
        return [sp.Matrix(n, n, lambda b, a, i=i: sp.sympify(c[i][a][b])) for i in range(n)]
    if coefficients == "coadjoint":
        return [-sp.Matrix(n, n, lambda b, a, i=i: sp.sympify(c[i][b][a])) for i in range(n)]
    return [sp.Matrix(rho) for rho in coefficients]


def differential(algebra, coefficients, k):
    """The matrix of d on k-cochains: f(x_S)_a by (S, a), in the order of combinations."""
    n, rho = algebra.dimension, action_of(algebra, coefficients)
    m, c = rho[0].rows, algebra.structure_constants
    place = {s: r for r, s in enumerate(combinations(range(n), k))}
    larger = list(combinations(range(n), k + 1))
    matrix = sp.zeros(len(larger) * m, len(place) * m)

    def add(row, arguments, b, a, value):
        """Add value * f(arguments)_a to the component b of the row."""
        if len(set(arguments)) < len(arguments):
            return
        sign = sp.LeviCivita(*(sorted(arguments).index(x) for x in arguments)) if k > 1 else 1
        matrix[row * m + b, place[tuple(sorted(arguments))] * m + a] += sign * value

    for row, xs in enumerate(larger):
        for i, x in enumerate(xs):
            for b in range(m):
                for a in range(m):
                    if rho[x][b, a]:
                        add(row, (*xs[:i], *xs[i + 1 :]), b, a, (-1) ** i * rho[x][b, a])
        for i, j in combinations(range(k + 1), 2):
            rest = tuple(x for r, x in enumerate(xs) if r not in (i, j))
            for l, value in enumerate(c[xs[i]][xs[j]]):
                if value:
                    for a in range(m):
                        add(row, (l, *rest), a, a, (-1) ** (i + j) * sp.sympify(value))
    return matrix


def rank(matrix):
    return DomainMatrix.from_Matrix(matrix).to_field().rank() if matrix.rows and matrix.cols else 0


def dimension(algebra, k, coefficients="trivial"):
    """Of H^k, and of the cocycles and coboundaries."""
    cochains = differential(algebra, coefficients, k).cols
    below = rank(differential(algebra, coefficients, k - 1)) if k else 0
    cocycles = cochains - rank(differential(algebra, coefficients, k))
    return cocycles - below, cocycles, below
