"""Families against null spaces at single parameters: no case is missing, and none is false.

At each point the dimension of the integrals up to a degree is compared with that of polynomials in H and the Casimirs,
both by exact linear algebra of their own: products up to a high degree, minus the rank of their parts above the degree.
"""

import random
from itertools import product

import pytest
from plain_algebra import monomials, n_integrals, n_polynomials_in, terms
from sympy import Rational, Symbol, cancel, expand, fraction, sympify, together

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


THOROUGH = [pytest.param(k, marks=pytest.mark.thorough) for k in range(8, 12)]


@pytest.mark.parametrize(
    "seed", [*range(8), *THOROUGH, *(pytest.param(k, marks=pytest.mark.slow) for k in range(12, 120))]
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
