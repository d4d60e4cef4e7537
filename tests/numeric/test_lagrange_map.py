"""The discrete Lagrange top: an explicit Poisson map with the integrals of its Lax pair, proved in rational numbers."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import liepoisson as lp

FRACTIONS = st.fractions(min_value=-2, max_value=2, max_denominator=5)
VECTORS = st.tuples(FRACTIONS, FRACTIONS, FRACTIONS).map(np.array)
POSITIVE = st.fractions(min_value=Fraction(1, 5), max_value=3, max_denominator=5)
AXIS = np.array([Fraction(0), Fraction(0), Fraction(1)])


def cross(u, v):
    return np.array([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])


def kick_and_turn(l, alpha, beta, *, inertia, a3, epsilon, h):
    """The map in rational numbers, from its definition; the spin about the axis, which commutes, left out."""
    later = alpha + h * epsilon * a3 * cross(beta, AXIS)
    l = l + h / 2 * a3 * cross(alpha + later, AXIS)
    v = h / inertia * l
    c = 1 / (1 + v @ v / 4)

    def turn(u):
        return u + c * cross(u, v) + c / 2 * cross(cross(u, v), v)

    return l, turn(later), turn(beta)


def spectrum(l, alpha, beta, *, inertia, a3, epsilon, h):
    """Coefficients of |L(z)|^2."""
    s, u, k = a3 * inertia, epsilon * a3**2 * inertia**2, -h / (2 * inertia)
    terms = [AXIS + k * cross(l, AXIS) + k**2 * s * alpha, l + k**2 * u * beta, s * alpha, u * beta]
    return [sum(terms[i] @ terms[m - i] for i in range(4) if 0 <= m - i < 4) for m in range(7)]


PARAMETERS = st.fixed_dictionaries({"inertia": POSITIVE, "a3": POSITIVE, "epsilon": FRACTIONS, "h": POSITIVE})


@pytest.mark.thorough
@given(VECTORS, VECTORS, VECTORS, PARAMETERS)
def test_the_spectrum_of_the_lax_matrix_is_constant_exactly(l, alpha, beta, parameters):
    state = l, alpha, beta
    before = spectrum(*state, **parameters)
    assert spectrum(*kick_and_turn(*state, **parameters), **parameters) == before


@pytest.mark.parametrize(("epsilon", "b3"), [(0.0, 0.0), (-0.7, 0.4)])
def test_integrals_are_constant_over_long_times(epsilon, b3):
    top = lp.Top(inertia=(1.5, 1.5, 0.8), a=(0, 0, 0.9), b=(0, 0, b3), epsilon=epsilon)
    method = lp.methods.LagrangeMap(step=0.25)
    x0 = lp.sample_states(top, 6, seed=1)
    # times that are whole numbers of steps, or the step would be shorter than the one of the integrals
    orbit = lp.integrate(top, x0, times=[0, 1, 600], method=method)
    values = method.integrals(top, orbit.state)
    # 2,400 steps of a few units of round-off each, whose sum is no random walk alone
    assert np.abs(values - values[:, :1]).max() < 1e-10
    energy = top.invariant_values(orbit.state)["H"]
    assert 1e-5 < np.abs(energy - energy[:, :1]).max() < 0.1  # the energy of the top itself is not constant


def test_it_is_a_poisson_map():
    top = lp.Top(inertia=(1.5, 1.5, 0.8), a=(0, 0, 0.9), b=(0, 0, 0.3), epsilon=0.7)
    x0 = lp.sample_states(top, 4, seed=2)
    orbit = lp.integrate(top, x0, times=[0, 3], tangents=np.eye(9), method=lp.methods.LagrangeMap(step=0.5))

    def hat(u):
        return np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])

    def poisson_tensor(x):
        l, alpha, beta, none = hat(x[:3]), hat(x[3:6]), hat(x[6:]), np.zeros((3, 3))
        return np.block([[l, alpha, beta], [alpha, 0.7 * beta, none], [beta, none, none]])

    for start, end, tangents in zip(x0, orbit.state[:, -1], orbit.tangent[:, -1], strict=True):
        D = tangents.T
        defect = D @ poisson_tensor(start) @ D.T - poisson_tensor(end)
        assert np.abs(defect).max() < 1e-13 * np.abs(D).max() ** 2
