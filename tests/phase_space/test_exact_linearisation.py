"""Linear stability where the coefficients of H differ by many orders of magnitude: compared with 200 digits."""

import random
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.equilibrium.linearisation import LinearFlow, exact_linearisation


def _coefficient(draw):
    return sp.Rational(draw.randint(-5, 5), draw.randint(1, 4)) * sp.Integer(10) ** draw.randint(-8, 8)


def _quadratic(draw, variables):
    return sum(_coefficient(draw) * x * y for i, x in enumerate(variables) for y in variables[: i + 1])


def _eigenvalues(system, state):
    """Of the derivative of the field on the whole space: those on the leaf, and a zero for each Casimir."""
    at = dict(zip(system.variables, map(sp.Rational, state), strict=True))
    with mpmath.workdps(200):
        values = mpmath.eig(mpmath.matrix(system.jacobian.subs(at).tolist()), left=False, right=False)
        size = max(abs(value) for value in values)
        # a double zero scatters by the root of the round-off
        return [value for value in values if abs(value) > mpmath.mpf(10) ** -60 * size]


def _check(system, state):
    values = _eigenvalues(system, state)
    found = lp.phase_space.equilibrium(system, state)
    with mpmath.workdps(200):
        growth = float(max([mpmath.re(v) for v in values if abs(mpmath.re(v)) > 1e-60 * abs(v)], default=0))
    assert found.growth_rate == pytest.approx(growth, rel=1e-12, abs=0)
    assert (found.linear_stability == "unstable") == (growth > 0)
    theirs = sorted(abs(complex(value)) for value in values)
    mine = np.sort(np.abs(found.spectrum))
    np.testing.assert_allclose(mine[len(mine) - len(theirs) :], theirs, rtol=1e-12)
    assert not mine[: len(mine) - len(theirs)].any()
    return found


@pytest.mark.parametrize("seed", range(40))
def test_quadratic_hamiltonians_in_canonical_coordinates(seed):
    bracket = lp.canonical(2)
    draw = random.Random(seed)
    system = lp.System(bracket, _quadratic(draw, lp.System(bracket, "1").variables))
    found = _check(system, [0, 0, 0, 0])
    hessian = sp.hessian(system.hamiltonian, system.variables)
    with mpmath.workdps(100):
        values = mpmath.eigsy(mpmath.matrix(hessian.tolist()), eigvals_only=True)
    assert found.signature == (sum(v > 0 for v in values), sum(v < 0 for v in values), 0)


@pytest.mark.parametrize("seed", range(20))
def test_steady_rotations_of_a_body_in_a_field(seed):
    """On e(3) a Hamiltonian even in the first two components of both vectors is at rest where these vanish."""
    draw = random.Random(seed)
    bracket = lp.so(3) @ lp.semidirect(2)
    l1, l2, l3, g1, g2, g3 = lp.System(bracket, "1").variables
    system = lp.System(bracket, _quadratic(draw, (l1, l2, g1, g2)) + _quadratic(draw, (l3, g3)))
    _check(system, [0, 0, draw.choice([1, -2, 1e5]), 0, 0, draw.choice([1, 1e-3, 7])])


def test_zeros_are_exact():
    """A free particle beside oscillators of very different frequencies."""
    system = lp.System(lp.canonical(3), "p1^2/2 + p2^2/2 + 10^(-24)*q2^2/2 + 10^12*(p3^2 + q3^2)/2")
    found = lp.phase_space.equilibrium(system, np.zeros(6))
    assert (found.linear_stability, found.signature, found.nullity) == ("degenerate", (5, 0, 1), 1)
    np.testing.assert_allclose(found.frequencies, [1e-12, 1e12], rtol=1e-15)


def test_equal_frequencies_of_opposite_energies_are_undecided_and_of_equal_ones_stable():
    verdict = [
        lp.phase_space.equilibrium(lp.System(lp.canonical(2), text), np.zeros(4)).linear_stability
        for text in ("p1^2 + q1^2 - p2^2 - q2^2", "p1^2 + q1^2 + p2^2 + q2^2")
    ]
    assert verdict == ["undecided", "stable spectrum"]


def test_nothing_is_claimed_where_numbers_are_not_exact():
    system = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
    assert exact_linearisation(system, np.zeros(2)) is None
    system = lp.System(lp.canonical(1), "p1^2/2 + (q1 - 1/3)^2")
    assert exact_linearisation(system, np.array([0, float(Fraction(1, 3))])) is None


def test_zeros_that_are_none_are_not_divided_out():
    """p1^2 10^8 + q1^2 10^-8 beside p2 q2: eigenvalues +-1 and +-2i, though the values of S differ by 10^16."""
    hessian = np.diag([2e-8, 0.0, 2e8, 0.0])
    hessian[1, 3] = hessian[3, 1] = 1.0
    form = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    flow = LinearFlow(hessian, form)
    assert flow.has_more_than(flow.without_zeros())
    still = LinearFlow(np.diag([0.0, 1.0, 0.0, 1.0]), form)
    assert not still.has_more_than(still.without_zeros())
