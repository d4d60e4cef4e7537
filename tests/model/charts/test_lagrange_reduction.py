"""Reduced Lagrange tops: printed Hamiltonians, round trips, cyclic angles, and what is refused."""

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ChartError, ParameterError, ShapeError

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


def test_a_leaf_and_l3_give_the_reduction():
    reduced, by_state = (
        lp.charts.ReducedLagrange(top(), **given)
        for given in ({"leaf": lp.Leaf.through(top(), X), "l3": 0.5}, {"state": X})
    )
    assert (reduced.l3, reduced.chart.leaf) == (by_state.l3, by_state.chart.leaf)
    # C1 = 0.62 - 0.26, C2 = 0.13, C3 = 0.98
    constants = f"v = {0.13 / 0.98**0.5:.6g}, w = {0.98**0.5:.6g}, eta = {0.36 - 0.13**2 / 0.98:.6g}"
    assert repr(reduced) == f"<ReducedLagrange of {top().name!r}: l3 = 0.5, {constants}>"
    with pytest.raises(ParameterError, match="needs l3 beside the leaf"):
        lp.charts.ReducedLagrange(top(), leaf=lp.Leaf.through(top(), X))


def test_without_psi_it_is_given_beside_the_state():
    system = top()
    reduced, full = (lp.charts.ReducedLagrange(system, state=X, with_cyclic_angle=flag) for flag in (False, True))
    z, psi = reduced.from_body(X), full.from_body(X)[4]
    assert reduced.system.component_names == ("phi", "theta", "p_phi", "p_theta")
    np.testing.assert_allclose(reduced.to_body(z, psi=psi), X, atol=1e-15)
    with pytest.raises(ParameterError, match="not at all"):
        reduced.to_body(z)
    with pytest.raises(ParameterError, match="twice"):
        full.to_body(full.from_body(X), psi=psi)
    with pytest.raises(ShapeError, match="psi must have shape"):
        reduced.to_body(np.array([z, z]), psi=[1.0, 2.0, 3.0])


@pytest.mark.thorough
def test_the_integral_p_is_one_in_the_reduced_coordinates():
    # P = l.(a3 alpha + b3 beta) + epsilon a3^2 I1 beta3 commutes with the reduced Hamiltonian
    reduced = lp.charts.ReducedLagrange(symbolic())
    chart = reduced.chart
    P = chart.angular_momentum.dot(a3 * chart.alpha + b3 * chart.beta) + epsilon * a3**2 * I1 * chart.beta[2]
    P = P.xreplace({sp.Symbol("p_psi"): l3})
    names = {"phi": "0.3", "theta": "1.1", "p_phi": "0.2", "p_theta": "-0.4", "psi": "0.7"}
    numbers = {"l3": "0.6", "v": "0.4", "w": "1.3", "eta": "1.7", "epsilon": "0.9"}
    numbers |= {"I1": "1.2", "I3": "0.7", "a3": "0.8", "b3": "-0.5"}
    point = {sp.Symbol(k): sp.Rational(n) for k, n in (names | numbers).items()}
    assert abs(sp.N(reduced.system.bracket(P, reduced.hamiltonian).subs(point), 50)) < 1e-40
    assert abs(sp.N(P.diff(phi).subs(point), 20)) > 0.1  # and is not trivially constant


def test_the_ordinary_top_nutates_in_its_effective_potential():
    system = top(0.6)
    reduced = lp.charts.OrdinaryLagrange(system, state=ORDINARY, with_cyclic_angle=True)
    z = reduced.from_body(ORDINARY)
    np.testing.assert_allclose(reduced.to_body(z), ORDINARY, atol=1e-15)
    np.testing.assert_allclose(reduced.system.functions.energy(z), system.functions.energy(ORDINARY), atol=1e-15)
    t = np.linspace(0, 10, 11)
    run, exact = lp.integrate(reduced.system, z, times=t).state, lp.integrate(system, ORDINARY, times=t).state
    np.testing.assert_allclose(reduced.to_body(run), exact, rtol=0, atol=1e-12)  # measured 5e-15


def condition(function, *arguments):
    with pytest.raises(ChartError) as caught:
        function(*arguments)
    return caught.value.condition


def test_states_of_another_reduction_are_refused():
    turn, raised = np.zeros(9), np.zeros(9)
    turn[2] = raised[3] = 0.1
    reduced, ordinary = lp.charts.ReducedLagrange(top(), state=X), lp.charts.OrdinaryLagrange(top(), state=ORDINARY)
    assert condition(reduced.from_body, X + turn) == "l3"
    assert condition(reduced.from_body, X * [1, 1, 1, 1, 1, 1, 1.1, 1.1, 1.1]) == "on the leaf"
    assert condition(ordinary.from_body, ORDINARY + turn) == "l3"
    assert condition(ordinary.from_body, X) == "beta = 0"
    assert condition(ordinary.from_body, ORDINARY + raised) == "on the leaf"
    assert condition(ordinary.from_body, [0, 0, 0.5, 0, 0, 1, 0, 0, 0]) == "sin(theta) != 0"
    assert condition(ordinary.from_body, [0, 0, 0.5, 0, 0, 0, 0, 0, 0]) == "alpha != 0"
    assert condition(ordinary.to_body, [0.0, 0.1], 0.0) == "sin(theta) != 0"


def test_wrong_input_is_refused():
    with pytest.raises(ParameterError, match="needs a Lagrange top"):
        lp.charts.ReducedLagrange(lp.Top.kovalevskaya())
    with pytest.raises(ParameterError, match="Leave l3 out"):
        lp.charts.ReducedLagrange(top(), state=X, l3=1)
    with pytest.raises(ParameterError, match="needs l3"):
        lp.charts.ReducedLagrange(top(), leaf={"C1": 1, "C2": 0, "C3": 1})
    with pytest.raises(ParameterError, match="needs l3, l_n and alpha"):
        lp.charts.OrdinaryLagrange(top(), l3=1)
    with pytest.raises(ChartError, match="beta = 0"):
        lp.charts.OrdinaryLagrange(top(), state=X)
    with pytest.raises(ChartError, match=r"OrdinaryLagrange"):
        lp.charts.ReducedLagrange(top(), state=ORDINARY)
    with pytest.raises(ShapeError, match="one state"):
        lp.charts.OrdinaryLagrange(top(), state=[ORDINARY])
