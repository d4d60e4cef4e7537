"""Exponentials beyond the range of doubles in fields that are small there: compared with 60 digits."""

import mpmath
import pytest
import sympy as sp

import liepoisson as lp

POTENTIALS = [
    "exp(-q1^2)",
    "10*exp(-100*(q1 - 3)^2)",
    "q1*exp(-q1^2/7)",
    "1/(1 + exp(q1))",
    "1/(2 + 3*exp(-60*(q1 - 3)))^2",
    "1/sqrt(1 + exp(q1))",
    "1/(1 + exp(q1))^(3/2)",
    "log(1 + exp(q1))",
    "log(1 + exp(-2*q1))",
    "1/cosh(q1)",
    "1/cosh(10*(q1 - 6))^2",
    "1/sinh(q1)",
    "sinh(q1)/cosh(q1)^2",
    "cosh(q1)/sinh(q1)",
    "tanh(q1)",
    "exp(q1)/cosh(q1)",
    "exp(-q1)/(1 + exp(-q1))^2",
    "1/(exp(q1) + 2*exp(-q1) + 1)",
    "1/(3 + exp(q1^2))",
    "exp(q1)/(1 + exp(2*q1))",
    "exp(-q1^2)/(1 + exp(-q1^2))",
    "exp(-300*q1^2)",
    "(exp(q1) - exp(-q1))/(exp(q1) + exp(-q1))^2",
]
PLACES = [-2000.0, -800.0, -390.0, -31.0, -3.1, -0.3, 0.4, 2.7, 33.0, 390.0, 800.0, 2000.0]


@pytest.mark.parametrize("potential", POTENTIALS)
def test_the_force_is_right_wherever_it_fits_into_a_double(potential):
    """The change of p in a time too short for anything else to change, against 60 digits."""
    system = lp.System(lp.canonical(1), f"p1^2/2 + {potential}")
    q = system.variables[0]
    force = sp.lambdify(q, -system.hamiltonian.diff(q), "mpmath")
    for k, place in enumerate(PLACES):
        method = lp.RungeKutta() if k % 2 else lp.Taylor(tol=1e-15)
        with mpmath.workdps(2000):
            right = mpmath.re(force(mpmath.mpf(place)))
            right = float(right) if abs(right) < 1e300 else None
        if right is None:
            continue
        time = 1e-6
        orbit = lp.integrate(system, [place, 0.0], times=[0, time], method=method)
        assert orbit.outcome[0] == "finished", place
        # exp(u) is known up to |u| units; 1 - tanh(u)^2 up to a unit of 1
        assert orbit.state[0, -1, 1] / time == pytest.approx(right, rel=1e-9, abs=1e-14), place


def test_an_exponential_that_leaves_the_doubles_ends_the_orbit():
    system = lp.System(lp.canonical(1), "p1^2/2 + exp(q1)")
    assert lp.integrate(system, [800.0, 0.0], times=[0, 1]).outcome[0] == "not finite"
