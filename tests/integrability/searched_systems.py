"""Systems that several of these tests search."""

import liepoisson as lp

TOP = lp.Top(inertia=(2, 3, 5), a=(1, 2, 3), b=(3, -1, 2), epsilon=1)
"""A twisted top without symmetry."""


def toda():
    """Three particles of the open Toda lattice in Flaschka's variables, {a_i, b_i} = -a_i, {a_i, b_(i+1)} = a_i."""
    brackets = {(0, 2): {0: -1}, (0, 3): {0: 1}, (1, 3): {1: -1}, (1, 4): {1: 1}}
    algebra = lp.LieAlgebra.from_brackets(5, brackets, basis_names=["a1", "a2", "b1", "b2", "b3"])
    bracket = lp.Bracket(algebra, lp.trivial().rename("x"))
    a1, a2, b1, b2, b3 = bracket.variables
    return lp.System(bracket, (b1**2 + b2**2 + b3**2) / 2 + a1**2 + a2**2, name="Toda lattice")


def is_polynomial_in(function, generators, system, *, degree=None, degrees=None, points=None):
    """Whether a function is a combination of products of others of at most its degree, by values at random points.

    Degrees and points are needed for functions that are no polynomials, whose values at the points must be rational.
    """
    from itertools import combinations_with_replacement
    from math import prod

    import sympy as sp
    from flint import fmpq, fmpq_mat

    x = system.variables
    degree = degree or sp.Poly(function, *x).total_degree()
    degrees = degrees or [sp.Poly(g, *x).total_degree() for g in generators]
    products = [
        chosen
        for n in range(degree + 1)
        for chosen in combinations_with_replacement(range(len(generators)), n)
        if sum(degrees[k] for k in chosen) <= degree
    ]
    rows = []
    for point, _ in zip(points or random_points(system), range(len(products) + 5), strict=False):
        values = [g.subs(point) for g in generators]
        row = [prod((values[k] for k in chosen), start=sp.Integer(1)) for chosen in products]
        rows.append([fmpq(int(v.p), int(v.q)) for v in (*row, function.subs(point))])
    return fmpq_mat([row[:-1] for row in rows]).rank() == fmpq_mat(rows).rank()


def random_points(system):
    """Points with whole coordinates."""
    from random import Random

    random = Random(3)
    while True:
        yield {v: random.randint(-9, 9) for v in system.variables}
