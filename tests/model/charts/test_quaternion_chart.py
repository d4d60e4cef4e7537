"""The quaternion chart: round trips everywhere, its gauge, and its momentum map."""

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ChartError
from liepoisson.model.charts.quaternion_chart import body_rotation, shortest_turn

STATES = np.array(
    [
        [0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4],  # anything
        [0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, -0.4],  # the other half of the sphere
        [0.1, 0.2, 0.3, 0.2, 1.8, 0.8, 0.1, 0.9, 0.4],  # alpha parallel to beta
        [0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],  # alpha = 0
        [0.1, 0.2, 0.3, 1.0, 0.0, 0.5, 0.0, 0.0, 2.0],  # a pole of the Euler angles
        [0.1, 0.2, 0.3, 1.0, 0.0, 0.5, 0.0, 0.0, -2.0],  # the other one
    ]
)


def top(eps):
    return lp.Top(inertia=(1.3, 0.9, 0.7), a=(0.3, -0.5, 0.8), b=(0.2, 0.1, -0.4), epsilon=eps)


@pytest.mark.parametrize("eps", [0, 0.7, -1.5])
@pytest.mark.parametrize("x", STATES)
def test_round_trips_energy_and_gauge(eps, x):
    system = top(eps)
    chart = lp.charts.QuaternionChart(system, state=x)
    z = chart.from_body(x)
    assert z.shape == ((10,) if eps else (8,))
    np.testing.assert_allclose(chart.to_body(z), x, rtol=0, atol=1e-14)
    np.testing.assert_allclose(chart.system.functions.energy(z), system.functions.energy(x), atol=1e-14)
    q, p = (z[:4], z[5:9]) if eps else (z[:4], z[4:])
    np.testing.assert_allclose([q @ q, q @ p], [1, 0], atol=1e-15)
    if eps:
        assert (q[3], np.sign(q[0])) == (0, 1) if x[8] >= 0 else (q[2], np.sign(q[1])) == (0, 1)


@pytest.mark.thorough
def test_the_first_casimir_is_the_momentum_map():
    q0, q1, q2, q3, p0, p1, p2, p3, X, Y, v, w, eps = sp.symbols("q0:4 p0:4 X Y v w epsilon")
    system = lp.Top(inertia=("I1", "I2", "I3"), a=("a1", "a2", "a3"), epsilon="epsilon")
    chart = lp.charts.QuaternionChart(system)
    l, alpha, beta = chart.angular_momentum, chart.alpha, chart.beta
    C1 = alpha.dot(alpha) + 2 * eps * l.dot(beta)
    m3 = sp.Rational(1, 2) * (-q3 * p0 - q2 * p1 + q1 * p2 + q0 * p3)  # third component of E p/2
    assert sp.cancel(C1 - v**2 - X**2 - (eps * w * Y) ** 2 - 2 * eps * w * m3) == 0
    assert sp.cancel(alpha.dot(beta) - v * w) == 0
    assert sp.cancel(beta.dot(beta) - w**2) == 0


def test_one_chart_serves_all_leaves_with_the_same_second_and_third_casimir():
    system = top(0.7)
    chart = lp.charts.QuaternionChart(system, state=STATES[0])
    other = STATES[0].copy()
    other[:3] += 1.0
    np.testing.assert_allclose(chart.to_body(chart.from_body(other)), other, atol=1e-14)
    other[6:] *= 1.1
    with pytest.raises(ChartError, match=r"alpha.beta = .* a constant of the chart"):
        chart.from_body(other)


def test_the_shortest_turn_takes_the_third_axis_to_each_unit_vector():
    n = np.array([[0, 0, 1], [0, 0, -1], [1e-9, 0, -1], [0.6, 0, 0.8], [0.48, -0.6, -0.64]])
    q = shortest_turn(n)
    A = np.array([body_rotation(row) for row in q])
    np.testing.assert_allclose(A[:, :, 2], n, rtol=0, atol=1e-15)
    np.testing.assert_allclose(A @ np.swapaxes(A, 1, 2), np.broadcast_to(np.eye(3), A.shape), rtol=0, atol=1e-15)
