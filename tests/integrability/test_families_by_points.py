"""Families against null spaces at single parameters: no case is missing, and none is false.

At each point the dimension of the integrals up to a degree is compared with that of polynomials in H and the Casimirs,
both by exact linear algebra of their own: products up to a high degree, minus the rank of their parts above the degree.
"""

import random
from itertools import combinations_with_replacement, product

import pytest
from flint import fmpq, fmpq_mat
from sympy import Poly, Rational, Symbol, cancel, expand, fraction, sympify, together

import liepoisson as lp
from liepoisson.integrability.families import integrable_families

BRACKETS = {
    "so(3)": (lp.so(3) @ lp.trivial(), 2, (1, 2, 3)),
    "e(3)": (lp.so(3) @ lp.semidirect(2).rename("l", "alpha"), 2, (1, 2)),
    "canonical(1)": (lp.canonical(1), 4, (1, 2, 3, 4)),
    "canonical(2)": (lp.canonical(2), 3, (1, 2, 3)),
    "heisenberg": (lp.algebras.heisenberg(1) @ lp.trivial(), 2, (1, 2, 3)),
}
GRID = (-2, -1, 0, 1, 2, Rational(1, 2))


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


def random_family(rng):
    name = rng.choice(list(BRACKETS))
    bracket, degree_of_h, degrees = BRACKETS[name]
    names = ["a", "b", "c"][: rng.choice((1, 2, 2, 3))]

    def coefficient():
        v, w, k = rng.choice(names), rng.choice(names), rng.choice((-2, -1, 1, 2))
        forms = (v, v, v, f"{v}*{w}", f"({v} + {k})", f"({v}^2 - {k**2})", f"({v}*{w} - 1)", f"({v} + {w})", "1", "2")
        return rng.choice((*forms, f"({v}^2 + {w})"))

    chosen = rng.sample(monomials(len(bracket.variables), degree_of_h), rng.randint(2, 4))
    parts = [
        f"{coefficient()}*" + "*".join(f"{x}^{k}" for x, k in zip(bracket.variables, m, strict=True) if k)
        for m in chosen
    ]
    if name == "canonical(2)" and rng.random() < 0.7:
        parts += ["p1^2/2", f"{coefficient()}*p2^2"]
    if name == "so(3)" and rng.random() < 0.4:
        parts.append(f"{coefficient()}*(l1^2 + l2^2 + l3^2)")
    text = " + ".join(parts)
    used = [x for x in names if Symbol(x) in sympify(text.replace("^", "**")).free_symbols]
    return (lp.System(bracket, text, symbols=used), rng.choice(degrees)) if used else random_family(rng)


THOROUGH = [pytest.param(k, marks=pytest.mark.thorough) for k in range(12, 60)]


@pytest.mark.parametrize(
    "seed", [*range(12), *THOROUGH, *(pytest.param(k, marks=pytest.mark.slow) for k in range(60, 120))]
)
def test_random_families_at_points(seed):
    rng = random.Random(seed)
    system, degree = random_family(rng)
    if not any(system.equations.values()):
        return
    x, n = system.variables, len(system.variables)
    found = integrable_families(system, degree=degree)
    assert found.complete
    points = list(product(GRID, repeat=len(found.parameters)))
    points = [dict(zip(found.parameters, p, strict=True)) for p in rng.sample(points, min(len(points), 20))]
    points += [case.example for case in found.cases if case.example]
    generic = {s: Rational(rng.randint(1000, 9999), rng.randint(100, 999)) for s in found.parameters}
    at = lambda f, values: terms(sympify(f).subs(values), x)  # noqa: E731
    usual = n_integrals([at(rate, generic) for rate in system.equations.values()], n, degree)
    # limits of the integrals for all parameters, where these are defined by their numerators
    known = [system.hamiltonian, *system.bracket.casimirs(), *(fraction(cancel(together(g)))[0] for g in found.general)]
    for point in points:
        here = n_integrals([at(rate, point) for rate in system.equations.values()], n, degree)
        is_further = here > usual and here > n_polynomials_in([at(f, point) for f in known], degree)
        holds = any(case.holds_at({str(s): v for s, v in point.items()}) for case in found.cases)
        is_limit = any(all(expand(c.subs(point)) == 0 for c in case.conditions) for case in found.cases)
        where = (str(system.hamiltonian), degree, point, str(found))
        assert is_limit or not is_further, where
        assert is_further or not holds or found.general, where
