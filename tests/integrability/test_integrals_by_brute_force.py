"""Random systems: what a search finds, with products of what is known, spans all integrals, found by plain algebra."""

from math import prod
from random import Random

import pytest
import sympy as sp
from plain_algebra import n_integrals, n_polynomials_in, terms

import liepoisson as lp

so3 = lp.so(3)
BRACKETS = [
    lp.canonical(2),
    lp.canonical(1),
    so3 @ lp.trivial(),
    so3 @ lp.semidirect(2),
    so3 @ lp.leibniz(2),
    lp.so(4) @ lp.trivial(),
    lp.algebras.heisenberg(2) @ lp.trivial(),
    lp.algebras.affine(2) @ lp.trivial(),
    lp.algebras.se(2) @ lp.leibniz(2),
]
DEGREE = {2: 4, 3: 4, 4: 3, 5: 3}
"""Of the search, by the number of coordinates; 2 for more."""


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


@pytest.mark.parametrize("number", range(len(BRACKETS)))
@pytest.mark.parametrize("seed", [0, 1, pytest.param(2, marks=pytest.mark.slow)])
def test_what_is_found_and_known_spans_the_null_space(number, seed):
    random = Random(1000 * number + seed)
    system = lp.System(BRACKETS[number], random_hamiltonian(BRACKETS[number].variables, random))
    x, n = system.variables, len(system.variables)
    degree = DEGREE.get(n, 2)
    wanted = n_integrals([terms(rate, x) for rate in system.equations.values()], n, degree)
    for options in ({}, {"known": {}}):
        found = lp.integrability.first_integrals(system, degree=degree, **options)
        functions = (*found.known.values(), *(f.expression for f in found.found))
        spanned = n_polynomials_in([terms(f, x) for f in functions], degree)
        assert found.complete
        assert (found.n_integrals, spanned) == (wanted, wanted), (system.hamiltonian, str(found))
