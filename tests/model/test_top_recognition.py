"""Tops are recognised without SymPy as with it, and their known integrals are the same functions, as accurate."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.algebra.rational_polynomials import expression_of, values_of
from liepoisson.compile.private_symbols import evaluated
from liepoisson.formula.arithmetic import expanded_terms
from liepoisson.model.known_integrals import known_integrals, known_polynomials
from liepoisson.model.top_recognition import MOST_TERMS, match_polynomial_top, match_top, recognised_top
from liepoisson.model.tops import Top

TOPS = {
    "free, spherical": Top.free_rigid_body((2, 2, 2)),
    "heavy": Top.heavy((2, 3, 4), (1, 2, 3)),
    "Lagrange, first axis": Top(inertia=(1, 2, 2), a=(3, 0, 0), epsilon=2),
    "Lagrange, second axis, charged": Top(inertia=(2, 1, 2), a=(0, 3, 0), b=(0, 5, 0), epsilon=2),
    "Kovalevskaya": Top.kovalevskaya(),
    "two-field Kovalevskaya": Top(inertia=(4, 4, 2), a=(1, 2, 0), b=(3, -1, 0)),
    "parallel fields": Top(inertia=(2, 2, 1), a=(1, 2, 0), b=("2/3", "4/3", 0)),
    "spherical, two fields": Top(inertia=(3, 3, 3), a=(1, 2, -1), b=(0, 1, 4)),
    "spherical, tilted": Top(inertia=(3, 3, 3), a=(1, 2, -1), b=(2, 4, -2), epsilon=2),
    "beta only": Top(inertia=(2, 2, 1), b=(1, 2, 0), epsilon=2),
    "twisted": Top.twisted((2, 3, 4), (1, "-1/3", "2/7"), (0, 0, 1), "-5/3"),
}


def text_of(top, fields=3):
    """The Hamiltonian of the first fields as a user types it."""
    quadratic = [f"l{k}^2/(2*({moment}))" for k, moment in enumerate(top.inertia, start=1)]
    vectors = [("alpha", top.a), ("beta", top.b)][: fields - 1]
    linear = [f"({c})*{name}{k}" for name, vector in vectors for k, c in enumerate(vector, start=1)]
    return " + ".join([*quadratic, *linear])


def value_of(polynomial, state):
    """The exact value, and the size of what is added up."""
    x = [Fraction(float(component)) for component in state]
    terms = [c * np.prod([x[k] for k in monomial], initial=Fraction(1)) for monomial, c in polynomial.expanded.items()]
    return sum(terms, Fraction(0)), sum(map(abs, terms), Fraction(0))


@pytest.mark.parametrize("name", TOPS)
def test_known_integrals_are_those_of_sympy_and_as_accurate(name):
    top = TOPS[name]
    typed = lp.System(lp.so(3) @ lp.leibniz(3, top.epsilon), text_of(top))
    assert typed.top_parameters == top.top_parameters
    polynomials = known_polynomials(top.top_parameters)
    expressions = known_integrals(top.top_parameters, *top.bracket.fields.values())
    assert list(polynomials) == list(expressions)
    assert list(typed.polynomial_invariants) == list(typed.invariants)
    states = np.random.default_rng(1).standard_normal((12, 9))
    theirs = evaluated(top.variables, list(expressions.values()), states)
    mine = values_of(polynomials.values(), states) if polynomials else theirs
    for k, (polynomial, expression) in enumerate(zip(polynomials.values(), expressions.values(), strict=True)):
        assert expression_of(polynomial, top.variables) == sp.expand(expression)
        exact = [value_of(polynomial, state) for state in states]
        errors = [
            max(abs(float((Fraction(float(v)) - e) / size)) for v, (e, size) in zip(values[:, k], exact, strict=True))
            for values in (mine, theirs)
        ]
        assert errors[0] <= 1.5 * errors[1] + 1e-16, (name, list(polynomials)[k], errors)


def random_numbers(rng, n):
    return [Fraction(int(p), int(q)) for p, q in zip(rng.integers(-3, 4, n), rng.integers(1, 4, n), strict=True)]


@pytest.mark.parametrize("fields", [1, 2, 3])
@pytest.mark.parametrize("term", ["", " + l1*l2/5", " + alpha1*l3", " + l1^3", " + l2", " + (l1 + l2)^2 - l1^2"])
def test_the_same_tops_are_found_as_with_sympy(fields, term):
    """Tops with random numbers, as they are and with a term that no top has."""
    if "alpha" in term and fields == 1:
        term = " + l1^2"
    rng = np.random.default_rng(fields)
    moments = [9 + moment for moment in random_numbers(rng, 3)]
    vectors = [random_numbers(rng, 3) if k < fields else [0, 0, 0] for k in (1, 2)]
    top = Top(inertia=moments, a=vectors[0], b=vectors[1])
    system = lp.System(lp.so(3) @ lp.leibniz(fields, "2/3"), text_of(top, fields) + term)
    found = match_polynomial_top(system.bracket, system.polynomial_rates)
    assert found == match_top(system.bracket, system.equations) == recognised_top(system)
    if not term:
        assert found is not None
    if fields == 3:
        assert system.top_parameters == found


def test_tops_are_not_looked_for_in_long_hamiltonians():
    """A power of a sum counts with all terms that it may have, as where SymPy reads the formula."""
    sums = "(l1 + l2 + l3 + alpha1 + alpha2 + alpha3)^2*(l1 - l2 + l3 - alpha1 + alpha2 + beta1)^2"
    energy = f"l1^2/2 + l2^2 + l3^2 + {sums}"
    system = lp.System(lp.so(3) @ lp.semidirect(3), energy)
    assert system.polynomial_hamiltonian.written_out[0] == expanded_terms(system.hamiltonian) == 3 + 21**2 > MOST_TERMS
    assert recognised_top(system) is None
