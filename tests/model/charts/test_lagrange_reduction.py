"""Reduced Lagrange tops: printed Hamiltonians, round trips, cyclic angles, and what is refused."""

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ParameterError

X = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4])
ORDINARY = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0, 0, 0])

phi, theta, p_phi, p_theta, l3, l_n, alpha = sp.symbols("phi theta p_phi p_theta l3 l_n alpha")
v, w, eta, epsilon, I1, I3, a3, b3 = sp.symbols("v w eta epsilon I1 I3 a3 b3")


def symbolic():
    return lp.Top(inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), b=(0, 0, "b3"), epsilon="epsilon")


def top(eps=1.0):
    return lp.Top(inertia=(1.2, 1.2, 0.7), a=(0, 0, 0.8), b=(0, 0, -0.4), epsilon=eps)


def test_the_reduced_hamiltonian():
    r = sp.sqrt(eta - 2 * epsilon * w * p_phi)
    wanted = (
        p_theta**2 / (2 * I1)
        + (p_phi - l3 * sp.cos(theta)) ** 2 / (2 * I1 * sp.sin(theta) ** 2)
        + l3**2 / (2 * I3)
        + (a3 * v + b3 * w) * sp.cos(theta)
        + a3 * r * sp.sin(theta) * sp.sin(phi)
    )
    assert sp.expand(lp.charts.ReducedLagrange(symbolic()).hamiltonian - wanted) == 0


def test_the_effective_potential_of_the_ordinary_top():
    wanted = (
        (l_n - l3 * sp.cos(theta)) ** 2 / (2 * I1 * sp.sin(theta) ** 2) + l3**2 / (2 * I3) + a3 * alpha * sp.cos(theta)
    )
    reduced = lp.charts.OrdinaryLagrange(symbolic())
    assert sp.expand(reduced.effective_potential - wanted) == 0
    # psi' = dH/dp_psi, where p_psi = l3
    assert sp.simplify(reduced.rate_of_psi - wanted.diff(l3)) == 0


@pytest.mark.parametrize("eps", [1.0, -0.3, 0.0])
def test_the_reduced_orbit_with_psi_is_that_of_the_top(eps):
    system = top(eps)
    reduced = lp.charts.ReducedLagrange(system, state=X, with_cyclic_angle=True)
    z = reduced.from_body(X)
    np.testing.assert_allclose(reduced.to_body(z), X, atol=1e-15)
    np.testing.assert_allclose(reduced.system.functions.energy(z), system.functions.energy(X), atol=1e-15)
    t = np.linspace(0, 10, 11)
    run, exact = lp.integrate(reduced.system, z, times=t).state, lp.integrate(system, X, times=t).state
    np.testing.assert_allclose(reduced.to_body(run), exact, rtol=0, atol=1e-12)  # measured 1e-14


def test_without_psi_it_is_given_beside_the_state():
    system = top()
    reduced, full = (lp.charts.ReducedLagrange(system, state=X, with_cyclic_angle=flag) for flag in (False, True))
    z, psi = reduced.from_body(X), full.from_body(X)[4]
    assert reduced.system.component_names == ("phi", "theta", "p_phi", "p_theta")
    np.testing.assert_allclose(reduced.to_body(z, psi=psi), X, atol=1e-15)
    with pytest.raises(ParameterError, match="twice"):
        full.to_body(full.from_body(X), psi=psi)


def test_the_ordinary_top_nutates_in_its_effective_potential():
    system = top(0.6)
    reduced = lp.charts.OrdinaryLagrange(system, state=ORDINARY, with_cyclic_angle=True)
    z = reduced.from_body(ORDINARY)
    np.testing.assert_allclose(reduced.to_body(z), ORDINARY, atol=1e-15)
    np.testing.assert_allclose(reduced.system.functions.energy(z), system.functions.energy(ORDINARY), atol=1e-15)
    t = np.linspace(0, 10, 11)
    run, exact = lp.integrate(reduced.system, z, times=t).state, lp.integrate(system, ORDINARY, times=t).state
    np.testing.assert_allclose(reduced.to_body(run), exact, rtol=0, atol=1e-12)  # measured 5e-15
