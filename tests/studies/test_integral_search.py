"""The count of polynomial integrals."""

import numpy as np
import sympy as sp

import liepoisson as lp
from liepoisson.studies.twisted_top.claims.integral_search import independent_products, monomials_of_weight, nullity

WEIGHTS = (1, 1, 1, 2, 2, 2, 3, 3, 3)


def test_monomials_of_a_weight_are_all_there():
    assert [len(list(monomials_of_weight(WEIGHTS, w))) for w in (4, 6, 8)] == [48, 182, 555]
    assert all(np.dot(m, WEIGHTS) == 5 for m in monomials_of_weight(WEIGHTS, 5))


def test_the_search_finds_the_integrals_of_the_twisted_lagrange_top():
    top = lp.Top.twisted_lagrange()
    equations = list(top.equations.values())
    weights = {"H": 2, "C1": 4, "C2": 5, "C3": 6, "l3": 1, "P": 3}
    known = {name: (top.invariants[name], weight) for name, weight in weights.items()}
    for weight in range(1, 7):
        found = nullity(equations, top.variables, WEIGHTS, weight)
        assert found == len(independent_products(known, top.variables, weight))
        assert found > len(independent_products({k: known[k] for k in ("H", "C1", "C2", "C3")}, top.variables, weight))


def test_products_of_dependent_integrals_are_counted_once():
    x, y = sp.symbols("x y")
    known = {"f": (x, 1), "g": (y, 1), "h": (x + y, 1)}
    assert len(independent_products(known, (x, y), 1)) == 2
    assert len(independent_products(known, (x, y), 2)) == 3
