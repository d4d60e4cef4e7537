"""The definition of Chevalley and Eilenberg, written out with SymPy: the independent answer of the tests."""

from itertools import combinations
from itertools import product as cartesian

import sympy as sp
from sympy import QQ
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
    """The matrix of d on k-cochains, rational: f(x_S)_a by (S, a), in the order of combinations."""
    n, rho = algebra.dimension, action_of(algebra, coefficients)
    m, c = rho[0].rows, algebra.structure_constants
    place = {s: r for r, s in enumerate(combinations(range(n), k))}
    larger = list(combinations(range(n), k + 1))
    rows = {}

    def add(row, arguments, b, a, value):
        """Add value * f(arguments)_a to the component b of the row."""
        if len(set(arguments)) < len(arguments):
            return
        sign = sp.LeviCivita(*(sorted(arguments).index(x) for x in arguments)) if k > 1 else 1
        entries, column = rows.setdefault(row * m + b, {}), place[tuple(sorted(arguments))] * m + a
        entries[column] = entries.get(column, QQ(0)) + QQ.from_sympy(sign * sp.sympify(value))

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
    return sparse(rows, len(larger) * m, len(place) * m)


def sparse(rows, n_rows, n_columns):
    kept = {r: row for r, row in ((r, {k: v for k, v in row.items() if v}) for r, row in rows.items()) if row}
    return DomainMatrix(kept, (n_rows, n_columns), QQ)


def dimension(algebra, k, coefficients="trivial"):
    """Of H^k, and of the cocycles and coboundaries."""
    outgoing = differential(algebra, coefficients, k)
    below = differential(algebra, coefficients, k - 1).rank() if k else 0
    cocycles = outgoing.shape[1] - outgoing.rank()
    return cocycles - below, cocycles, below


def of_commutative(extension):
    """Dimensions of Der(A), of Harrison's H^2(A, A), and of the skew forms with f(ab, c) + cyclic = 0."""
    n, W = extension.dimension, extension.tensor
    product = [[[W[l][a][b] for l in range(n)] for b in range(n)] for a in range(n)]

    def rows_of(equations, n_columns):
        rows = {}
        for r, equation in enumerate(equations):
            row = rows.setdefault(r, {})
            for column, value in equation:
                row[column] = row.get(column, QQ(0)) + QQ.from_sympy(sp.sympify(value))
        return sparse(rows, len(rows), n_columns)

    pairs = {}
    for a in range(n):
        for b in range(a, n):
            pairs[a, b] = pairs[b, a] = len({*pairs.values()})

    def f(a, b, k):
        return pairs[a, b] * n + k

    derivations, closed = [], []
    for a in range(n):
        for b in range(n):
            for k in range(n):  # a g(b) - g(ab) + g(a) b, with g(e_a)_k in column a n + k
                equation = [(b * n + j, product[a][j][k]) for j in range(n)] + [
                    (a * n + j, product[j][b][k]) for j in range(n)
                ]
                derivations.append(equation + [(j * n + k, -product[a][b][j]) for j in range(n)])
            for c in range(n):
                for k in range(n):  # a f(b, c) - f(ab, c) + f(a, bc) - f(a, b) c
                    equation = [(f(b, c, j), product[a][j][k]) for j in range(n)]
                    equation += [(f(j, c, k), -product[a][b][j]) for j in range(n)]
                    equation += [(f(a, j, k), product[b][c][j]) for j in range(n)]
                    closed.append(equation + [(f(a, b, j), -product[j][c][k]) for j in range(n)])
    size = n * (n + 1) // 2 * n
    exact = rows_of(derivations, n * n).rank()
    cocycles = size - rows_of(closed, size).rank()
    skew = {pair: r for r, pair in enumerate(combinations(range(n), 2))}

    def form(a, b, value):
        return [] if a == b else [(skew[min(a, b), max(a, b)], value if a < b else -value)]

    cyclic = [
        [
            term
            for x, y, z in (t, t[1:] + t[:1], t[2:] + t[:2])
            for j in range(n)
            for term in form(j, z, product[x][y][j])
        ]
        for t in cartesian(range(n), repeat=3)
    ]
    forms = len(skew) - rows_of(cyclic, max(len(skew), 1)).rank()
    return n * n - exact, cocycles - exact, forms
