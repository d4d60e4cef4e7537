"""The lowered field is the derived one in any units of the fields and of time: no term is small because of its units.

The equations are evaluated exactly, term by term, and the field by its definition in doubles; errors are relative to
the sum of the sizes of the terms of each component.
"""

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_fields import derivative

import liepoisson as lp

ENERGIES = {
    "top": "(l1^2/4 + 5*l2^2/18 + l3^2/2) + alpha1/3 - 2*alpha2/3 + alpha3",
    "quadratic": "(l1^2/4 + 5*l2^2/18 + l3^2/2) + dot(l, alpha)/3 + l1*alpha2 + alpha1^2",
    "a Casimir in H": "dot(l, l)^2 + (l1^2/4 + 5*l2^2/18 + l3^2/2) + alpha1/3 - 2*alpha2/3",
    "a square": "(dot(l, l) + l1/3)^2 + dot(alpha, alpha)^2 + l2*alpha3",
    "a square of mixed terms": "(dot(l, alpha) + alpha1)^2 + (l1^2/4 + 5*l2^2/18 + l3^2/2)",
    "quartic": "(l1^2/2 + 5*l2^2/9 + l3^2)^2 + alpha1^3 + l3*alpha1*alpha2",
    "a square root": "sqrt(1 + dot(alpha, alpha)) + (l1^2/4 + 5*l2^2/18 + l3^2/2) + alpha1",
    "an exponential": "exp(-dot(l, l)) + l1*alpha2^2 + alpha3",
}
BRACKET = lp.so(3) @ lp.semidirect(2)
EPS = 2.0**-53


def exact_terms(equations, values):
    """The terms of each equation at a state of floats, as numbers of 60 digits."""
    state = {x: sp.Rational(Fraction(value)) for x, value in zip(equations, values, strict=True)}
    return [[sp.Float(t.subs(state).evalf(60), 60) for t in sp.Add.make_args(e)] for e in equations.values()]


def check(system, field, state):
    rates = derivative(field, state)
    equations = {x: sp.expand_mul(sp.expand_multinomial(e)) for x, e in system.equations.items()}
    for i, terms in enumerate(exact_terms(equations, state)):
        error, size = abs(sp.Float(float(rates[i]), 60) - sum(terms)), sum(map(abs, terms))
        assert error <= 64 * EPS * size, f"{system.hamiltonian}, component {i}: {float(rates[i])} for {sum(terms)}"


exponents = st.integers(-40, 40)


@pytest.mark.thorough
@settings(deadline=None, max_examples=15)
@given(
    st.sampled_from([*ENERGIES]), st.tuples(exponents, exponents, exponents), st.integers(0, 2**32 - 1), st.booleans()
)
def test_rates_in_any_units_are_those_of_the_equations(name, powers, seed, in_units):
    r"""H(l, alpha) becomes $10^c\,H(10^a\ell, 10^b\alpha)$."""
    of_l, of_alpha, of_time = powers
    plain = lp.System(BRACKET, ENERGIES[name])
    l, alpha = BRACKET.variables[:3], BRACKET.variables[3:]
    ten = sp.Integer(10)
    units = {x: ten**of_l * x for x in l} | {x: ten**of_alpha * x for x in alpha}
    energy = ten**of_time * plain.hamiltonian.subs(units, simultaneous=True)
    system = lp.System(BRACKET, energy)
    state = np.random.default_rng(seed).normal(size=6)
    if in_units or name in ("an exponential", "a square root"):
        state *= np.repeat([10.0**-of_l, 10.0**-of_alpha], 3)
    check(system, system.field(), state)


@pytest.mark.parametrize("mass", [6.64e-26, 1.0, 6.64e26])
def test_a_trapped_ion_is_an_oscillator_in_si_units(mass):
    """Half a period of x = x0 cos(w t); the terms of its equations differ by a factor of 10^38."""
    rate = 2 * math.pi * 1e6
    trap = lp.System(lp.canonical(1), f"p1^2/(2*{mass!r}) + {mass!r}*{rate!r}^2*q1^2/2")
    end = lp.integrate(trap, [1e-6, 0.0], times=[0, 0.5e-6]).end_state[0]
    assert end[0] == pytest.approx(-1e-6, rel=1e-12)
    assert abs(end[1]) < 1e-12 * mass * rate * 1e-6


@pytest.mark.parametrize("algebra", [lp.trivial(), lp.semidirect(2), lp.leibniz(3)])
def test_moments_that_doubles_cannot_tell_apart_keep_their_difference(algebra):
    """l3' = (1/I1 - 1/I2) l1 l2 with 1/I1 = 1 + 1e-20."""
    bracket = lp.so(3) @ algebra
    field = lp.System(bracket, "(1 + 1e-20)*l1^2/2 + l2^2/2 + l3^2/4").field()
    state = np.zeros(bracket.dimension)
    state[:3] = 0.5, -0.75, 1
    assert derivative(field, state)[2] == pytest.approx(0.375e-20, rel=1e-14)


@pytest.mark.parametrize("power", [2, 4])
def test_irrational_coefficients_that_cancel_leave_nothing_beside_small_ones(power):
    """sqrt(3 + 2 sqrt(2)) = 1 + sqrt(2), which SymPy does not see; the other term is smaller than what is rounded."""
    hidden = sp.sqrt(3 + 2 * sp.sqrt(2), evaluate=False) - 1 - sp.sqrt(2)
    small = sp.Rational(1, 10**50)
    system = lp.System(lp.so(3) @ lp.trivial(), lambda l: hidden * l[0] ** power + small * l[1] ** 2)
    rates = derivative(system.field(), np.array([1.0, 2.0, 3.0]))
    np.testing.assert_allclose(rates, [-1.2e-49, 0.0, 4e-50], rtol=1e-14)
