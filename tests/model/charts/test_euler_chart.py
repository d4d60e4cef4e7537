"""The Euler chart: the paper's formulas, gauges, the maps both ways, and where the chart ends."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ChartError
from liepoisson.model.charts.leaf_constants import LeafConstants

X = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4])
GAUGES = ("e3, e1", "e1, e3", "e2, e3", ((0.6, 0.0, 0.8), (0.0, 1.0, 0.0)), ((np.cos(1), np.sin(1), 0), (0, 0, 1)))

phi, psi, theta, p_phi, p_psi, p_theta = sp.symbols("phi psi theta p_phi p_psi p_theta")
v, w, eta, epsilon, I1, I3, a3 = sp.symbols("v w eta epsilon I1 I3 a3")


def top(eps=0.7):
    return lp.Top(inertia=(1.3, 0.9, 0.7), a=(0.3, -0.5, 0.8), b=(0.2, 0.1, -0.4), epsilon=eps)


def test_the_general_potential_is_the_papers():
    # V = (v a + w b).A e_par + r a.A e_perp, for a general top and a general gauge
    top = lp.Top(inertia=("I1", "I2", "I3"), a=("a1", "a2", "a3"), b=("b1", "b2", "b3"), epsilon="epsilon")
    chart = lp.charts.EulerChart(top, gauge=(("3/5", "4/5", 0), (0, 0, 1)))
    c, s = ({q: f(q) for q in (phi, psi, theta)} for f in (sp.cos, sp.sin))
    A = sp.Matrix(
        [
            [
                c[psi] * c[phi] - c[theta] * s[phi] * s[psi],
                c[psi] * s[phi] + c[theta] * c[phi] * s[psi],
                s[psi] * s[theta],
            ],
            [
                -s[psi] * c[phi] - c[theta] * s[phi] * c[psi],
                -s[psi] * s[phi] + c[theta] * c[phi] * c[psi],
                c[psi] * s[theta],
            ],
            [s[theta] * s[phi], -s[theta] * c[phi], c[theta]],
        ]
    )
    a, b, r = sp.Matrix(sp.symbols("a1:4")), sp.Matrix(sp.symbols("b1:4")), chart.root
    e, f = sp.Matrix([sp.Rational(3, 5), sp.Rational(4, 5), 0]), sp.Matrix([0, 0, 1])
    assert sp.expand(chart.potential - (v * a + w * b).dot(A * e) - r * a.dot(A * f)) == 0
    kinetic = sum(chart.angular_momentum[k] ** 2 / (2 * sp.Symbol(f"I{k + 1}")) for k in range(3))
    assert sp.expand(chart.kinetic_energy - kinetic) == 0


@pytest.mark.parametrize("gauge", GAUGES, ids=str)
@pytest.mark.parametrize("eps", [0, 0.7, -1.5])
def test_round_trips_and_energy(gauge, eps):
    system = top(eps)
    chart = lp.charts.EulerChart(system, state=X, gauge=gauge)
    z = chart.from_body(X)
    np.testing.assert_allclose(chart.to_body(z), X, rtol=0, atol=1e-14)
    np.testing.assert_allclose(chart.system.functions.energy(z), system.functions.energy(X), atol=1e-14)
    orbit = lp.integrate(system, X, times=np.linspace(0, 5, 6)).state
    states = chart.from_body(orbit[:, :, None])
    assert states.shape == (1, 6, 1, 6)
    np.testing.assert_allclose(chart.to_body(states)[:, :, 0], orbit, atol=1e-12)


@pytest.mark.parametrize("kind", [lp.charts.EulerChart, lp.charts.QuaternionChart])
@pytest.mark.parametrize("eps", [1, "-1/3", 0])
def test_a_leaf_its_casimirs_and_its_states_give_one_chart(kind, eps):
    """v = C2/w, w = sqrt(C3), eta = C1 - v^2, and back."""
    system = top(eps)
    values = {name: float(function(X)) for name, function in system.functions.casimirs.items()}
    by_state = kind(system, state=X)
    assert kind(system, leaf=lp.Leaf.through(system, X)).leaf == by_state.leaf
    for leaf in (values, lp.Leaf(system, values)):
        np.testing.assert_allclose(kind(system, leaf=leaf).leaf.numbers, by_state.leaf.numbers, rtol=1e-13)
        np.testing.assert_allclose(kind(system, leaf=leaf).to_body(by_state.from_body(X)), X, atol=1e-14)
    assert LeafConstants(1, v, w, eta).casimirs == (eta + v**2, v * w, w**2)
    given = dict(zip(("C1", "C2", "C3"), (Fraction(17, 10), Fraction(-3, 4), Fraction(9, 4)), strict=True))
    assert LeafConstants.of(system, system.top_parameters, None, given).casimirs == tuple(given.values())


def test_reprs_are_decimals():
    constants = "v = 0.353553, w = 1.41421, eta = 0.875"  # 1/(2 sqrt 2), sqrt 2, 1 - 1/8
    casimirs, name = {"C1": 1, "C2": "1/2", "C3": 2}, top(1).name
    chart = lp.charts.EulerChart(top(1), leaf=casimirs)
    assert repr(chart) == f"<EulerChart of {name!r} in the gauge e3, e1: {constants}>"
    assert repr(chart.leaf) == f"<LeafConstants {constants}, epsilon = 1>"
    assert repr(lp.charts.QuaternionChart(top(1), leaf=casimirs)) == f"<QuaternionChart of {name!r}: {constants}>"


PARALLEL = np.array([0.1, 0.2, 0.3, 0.2, 1.8, 0.8, 0.1, 0.9, 0.4])
NO_BETA = np.array([0.1, 0.2, 0.3, 0.2, 1.8, 0.8, 0, 0, 0])
UPRIGHT = np.array([0.1, 0.2, 0.3, 1.0, 0.0, 0.5, 0, 0, 2.0])


@pytest.mark.parametrize(
    ("start", "call", "condition", "words"),
    [
        (PARALLEL, lambda chart, z: chart.from_body(PARALLEL), "alpha x beta != 0", "QuaternionChart"),
        (X, lambda chart, z: chart.from_body(NO_BETA), "beta != 0", "QuaternionChart has the same limit"),
        (UPRIGHT, lambda chart, z: chart.from_body(UPRIGHT), "sin(theta) != 0", "another gauge"),
        (X, lambda chart, z: chart.to_body(z * [1, 1, 0, 1, 1, 1]), "sin(theta) != 0", ""),
        (X, lambda chart, z: chart.to_body(z + np.outer([0, 1, 1], [0, 0, 0, 50, 0, 0])),
         "eta - 2 epsilon l.beta > 0", "at state 1 (2 of 3 such)"),
        (X, lambda chart, z: chart.from_body(1.01 * X), "on the leaf", ""),
    ],
)  # fmt: skip
def test_each_end_of_the_chart_is_named(start, call, condition, words):
    z = lp.charts.EulerChart(top(), state=X).from_body(X)
    with pytest.raises(ChartError) as caught:
        call(lp.charts.EulerChart(top(), state=start), z)
    assert caught.value.condition == condition
    assert words in str(caught.value)
    lp.charts.EulerChart(top(), state=UPRIGHT, gauge="e1, e3").from_body([UPRIGHT])  # its poles are elsewhere


def test_margins_are_zero_where_the_chart_ends():
    chart = lp.charts.EulerChart(top(), state=X)
    states = np.array([X, [0, 0, 0, 0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 1, 0, 0, 0, 0], [1, 0, 0, 1, 0, 0, 0, 0, 1]], float)
    margins = chart.margins(states)
    assert tuple(margins) == chart.conditions
    normal = np.linalg.norm(np.cross(X[3:6], X[6:]))
    np.testing.assert_allclose(margins["beta != 0"], [np.linalg.norm(X[6:]), 1, 0, 1])
    np.testing.assert_allclose(margins["alpha x beta != 0"], [normal / np.linalg.norm(X[6:]), 0, 0, 1])
    np.testing.assert_allclose(margins["sin(theta) != 0"][1:], [0, 0, 0])
    np.testing.assert_allclose(margins["sin(theta) != 0"][0], np.hypot(0.1, 0.9) / np.linalg.norm(X[6:]))


def test_what_failed_stays_not_a_number():
    chart = lp.charts.EulerChart(top(), state=X)
    states = np.array([X, np.full(9, np.nan)])
    z = chart.from_body(states)
    assert np.isnan(z[1]).all()
    assert np.isnan(chart.to_body(z)[1]).all()
