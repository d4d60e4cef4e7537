"""Random systems: what a search finds, with products of what is known, spans all integrals, found by plain algebra."""

from itertools import combinations_with_replacement
from math import prod
from random import Random

import pytest
import sympy as sp
from flint import fmpq, fmpq_mat

import liepoisson as lp

so3 = lp.so(3)
BRACKETS = [
    lp.canonical(2),
    lp.canonical(1),
    lp.canonical(3),
    so3 @ lp.trivial(),
    so3 @ lp.semidirect(2),
    so3 @ lp.leibniz(2),
    lp.so(4) @ lp.trivial(),
    lp.algebras.heisenberg(2) @ lp.trivial(),
    lp.so(2, 1) @ lp.trivial(),
    lp.algebras.affine(2) @ lp.trivial(),
    lp.algebras.se(2) @ lp.leibniz(2),
]
DEGREE = {2: 4, 3: 4, 4: 3, 5: 3}
"""Of the search, by the number of coordinates; 2 for more."""


def monomials(n, degree):
    return [m for d in range(1, degree + 1) for m in combinations_with_replacement(range(n), d)]


def random_hamiltonian(x, random):
    """A few terms of low degree; often a sum of functions of different coordinates."""
    split = random.randint(1, len(x))
    groups = [x, x] if random.random() < 0.5 else [x[:split], x[split:] or x]
    terms = [
        random.choice([-3, -2, -1, 1, 1, 1, 2, sp.Rational(1, 2)])
        * prod(random.choices(group, k=random.choice([1, 2, 2, 3])))
        for group in groups
        for _ in range(random.randint(1, 3))
    ]
    return sum(terms)


def rank_of(polynomials, columns):
    rows = []
    for f in polynomials:
        row = [fmpq(0)] * len(columns)
        for m, c in f.terms():
            if any(m):
                row[columns[m]] = fmpq(int(c.p), int(c.q))
        rows.append(row)
    return fmpq_mat(rows).rank() if rows else 0


def nullity(system, degree):
    """The dimension of the null space of the bracket with H on all monomials but 1."""
    x = system.variables
    rows = {}
    chosen = monomials(len(x), degree)
    for column, m in enumerate(chosen):
        image = sp.Poly(sp.expand(system.bracket(prod(x[i] for i in m), system.hamiltonian)), *x)
        for key, value in image.terms():
            if value:
                rows.setdefault(key, {})[column] = value
    matrix = fmpq_mat(max(len(rows), 1), len(chosen))
    for i, row in enumerate(rows.values()):
        for j, value in row.items():
            matrix[i, j] = fmpq(int(value.p), int(value.q))
    return len(chosen) - matrix.rank()


def spanned(found, degree):
    """The dimension of the polynomials up to the degree among combinations of products of the integrals.

    The products are of a higher degree, as terms of H that are functions of Casimirs may cancel.
    """
    x = found.system.variables
    generators = [sp.Poly(g, *x) for g in (*found.known.values(), *(f.expression for f in found.found))]
    generators = [g - g.coeff_monomial(1) for g in generators if g.total_degree() > 0]
    highest = max([degree, *(g.total_degree() + 1 for g in generators)])
    products, parts = [], [(sp.Poly(1, *x), 0)]
    while parts:
        product, start = parts.pop()
        for k in range(start, len(generators)):
            if product.total_degree() + generators[k].total_degree() <= highest:
                products.append(product * generators[k])
                parts.append((products[-1], k))
    high = {m for p in products for m in p.monoms() if sum(m) > degree}
    columns = {m: k for k, m in enumerate(sorted({m for p in products for m in p.monoms()}))}
    tops = [sp.Poly({m: c for m, c in p.terms() if m in high} or {(0,) * len(x): 0}, *x) for p in products]
    return rank_of(products, columns) - rank_of(tops, columns)


@pytest.mark.parametrize("number", range(len(BRACKETS)))
@pytest.mark.parametrize("seed", range(6))
def test_what_is_found_and_known_spans_the_null_space(number, seed):
    random = Random(1000 * number + seed)
    system = lp.System(BRACKETS[number], random_hamiltonian(BRACKETS[number].variables, random))
    degree = DEGREE.get(len(system.variables), 2)
    found = lp.integrability.first_integrals(system, degree=degree)
    wanted = nullity(system, degree)
    assert found.complete
    assert (found.n_integrals, spanned(found, degree)) == (wanted, wanted), (system.hamiltonian, str(found))
    fresh = lp.integrability.first_integrals(system, degree=degree, known={})
    assert (fresh.n_integrals, spanned(fresh, degree)) == (wanted, wanted), (system.hamiltonian, str(fresh))
