"""The Euler chart: the paper's formulas, gauges, the maps both ways, and where the chart ends."""

import numpy as np
import pytest
import sympy as sp

import liepoisson as lp
from liepoisson.errors import ChartError, ParameterError, ShapeError

X = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4])
GAUGES = ("e3, e1", "e1, e3", "e2, e3", ((0.6, 0.0, 0.8), (0.0, 1.0, 0.0)), ((np.cos(1), np.sin(1), 0), (0, 0, 1)))

phi, psi, theta, p_phi, p_psi, p_theta = sp.symbols("phi psi theta p_phi p_psi p_theta")
v, w, eta, epsilon, I1, I3, a3 = sp.symbols("v w eta epsilon I1 I3 a3")


def top(eps=0.7):
    return lp.Top(inertia=(1.3, 0.9, 0.7), a=(0.3, -0.5, 0.8), b=(0.2, 0.1, -0.4), epsilon=eps)


def lagrange():
    return lp.Top(inertia=("I1", "I1", "I3"), a=(0, 0, "a3"), epsilon="epsilon")


def vanishes(expression):
    return sp.simplify(sp.trigsimp(expression)) == 0


def test_the_hamiltonian_of_the_first_gauge_is_the_papers():
    chart = lp.charts.EulerChart(lagrange(), gauge="e3, e1")
    T = (
        p_theta**2 / (2 * I1)
        + (p_phi - p_psi * sp.cos(theta)) ** 2 / (2 * I1 * sp.sin(theta) ** 2)
        + p_psi**2 / (2 * I3)
    )
    V = a3 * (v * sp.cos(theta) + sp.sqrt(eta - 2 * epsilon * p_phi) * sp.sin(theta) * sp.sin(phi))
    assert vanishes(chart.hamiltonian.subs(w, 1) - T - V)
    assert str(chart.potential.subs(w, 1)) == ("a3*(v*cos(theta) + sqrt(-2*epsilon*p_phi + eta)*sin(phi)*sin(theta))")
    assert sp.latex(chart.potential.subs(w, 1)) == (
        r"a_{3} \left(v \cos{\left(\theta \right)} + \sqrt{- 2 \epsilon p_{\phi} + \eta} "
        r"\sin{\left(\phi \right)} \sin{\left(\theta \right)}\right)"
    )


def test_the_potential_of_the_second_gauge_is_the_papers():
    chart = lp.charts.EulerChart(lagrange(), gauge="e1, e3")
    cot, csc = sp.cos(theta) / sp.sin(theta), 1 / sp.sin(theta)
    l_beta = -p_phi * cot * sp.sin(phi) + p_psi * csc * sp.sin(phi) + p_theta * sp.cos(phi)
    V = a3 * (v * sp.sin(theta) * sp.sin(phi) + sp.sqrt(eta - 2 * epsilon * l_beta) * sp.cos(theta))
    assert vanishes(chart.l_dot_beta.subs(w, 1) - l_beta)
    assert vanishes(chart.potential.subs(w, 1) - V)


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


@pytest.mark.parametrize("eps", [1, "-1/3", 0])
def test_casimirs_are_those_of_the_bracket(eps):
    system = top(eps)
    values = {name: float(function(X)) for name, function in system.functions.casimirs.items()}
    by_values, by_state = lp.charts.EulerChart(system, leaf=values), lp.charts.EulerChart(system, state=X)
    np.testing.assert_allclose(by_values.leaf.numbers, by_state.leaf.numbers, rtol=1e-14)
    np.testing.assert_allclose(by_values.to_body(by_state.from_body(X)), X, atol=1e-14)


@pytest.mark.parametrize("kind", [lp.charts.EulerChart, lp.charts.QuaternionChart])
@pytest.mark.parametrize("eps", [1, "-1/3", 0])
def test_a_leaf_gives_the_chart_of_its_states(kind, eps):
    leaf = lp.Leaf.through(top(eps), X)
    assert kind(top(eps), leaf=leaf).leaf == kind(top(eps), state=X).leaf
    np.testing.assert_allclose(kind(top(eps), leaf=leaf).to_body(kind(top(eps), state=X).from_body(X)), X, atol=1e-14)


def test_a_leaf_by_its_casimirs_gives_their_chart():
    values = {"C1": 1.0, "C2": 0.2, "C3": 1.5}
    by_leaf, by_values = (
        lp.charts.EulerChart(top(), **given) for given in ({"leaf": lp.Leaf(top(), values)}, {"leaf": values})
    )
    np.testing.assert_allclose(by_leaf.leaf.numbers, by_values.leaf.numbers, rtol=1e-13)


def test_other_leaves_are_refused():
    leaf = lp.Leaf.through(top(), X)
    with pytest.raises(ParameterError, match="got both"):
        lp.charts.EulerChart(top(), leaf=leaf, state=X)
    with pytest.raises(ParameterError, match=r"with epsilon = 0\.5; it has epsilon = 0\.7"):
        lp.charts.EulerChart(top(0.5), leaf=leaf)
    with pytest.raises(ParameterError, match=r"leaf must be a Leaf; got 'C1'"):
        lp.charts.EulerChart(top(), leaf="C1")
    with pytest.raises(ChartError, match="integrate the top itself") as caught:
        lp.charts.EulerChart(top(), leaf=lp.Leaf.through(top(), [*X[:6], 0, 0, 0]))
    assert caught.value.condition == "beta != 0"


def test_reprs_are_decimals_on_one_line():
    constants = "v = 0.353553, w = 1.41421, eta = 0.875"  # 1/(2 sqrt 2), sqrt 2, 1 - 1/8
    casimirs = {"C1": 1, "C2": "1/2", "C3": 2}
    assert repr(lp.charts.EulerChart(top(1), leaf=casimirs).leaf) == f"<LeafConstants {constants}, epsilon = 1>"
    name = top(1).name
    assert (
        repr(lp.charts.EulerChart(top(1), leaf=casimirs))
        == f"<EulerChart of {name!r} in the gauge e3, e1: {constants}>"
    )
    assert repr(lp.charts.QuaternionChart(top(1), leaf=casimirs)) == f"<QuaternionChart of {name!r}: {constants}>"
    assert repr(lp.charts.EulerChart(lagrange(), gauge=(("3/5", "4/5", 0), (0, 0, 1)))) == (
        f"<EulerChart of {name!r} in the gauge (3/5, 4/5, 0), e3: v = v, w = w, eta = eta>"
    )
    assert (
        max(
            len(repr(value))
            for value in (lp.charts.EulerChart(top(1), state=X), lp.charts.EulerChart(top(1), state=X).leaf)
        )
        < 100
    )


def refusal(chart, function, states):
    with pytest.raises(ChartError) as caught:
        function(chart, states)
    return caught.value


def test_each_end_of_the_chart_is_named():
    chart = lp.charts.EulerChart(top(), state=X)
    to_body, from_body = lp.charts.EulerChart.to_body, lp.charts.EulerChart.from_body
    z = chart.from_body(X)

    parallel = np.array([0.1, 0.2, 0.3, 0.2, 1.8, 0.8, 0.1, 0.9, 0.4])
    assert refusal(lp.charts.EulerChart(top(), state=parallel), from_body, parallel).condition == "alpha x beta != 0"
    hint = str(refusal(chart, from_body, parallel))
    assert "QuaternionChart" in hint
    assert "gauge" not in hint  # alpha x beta = 0 in every gauge

    no_beta = np.array([0.1, 0.2, 0.3, 0.2, 1.8, 0.8, 0, 0, 0])
    assert refusal(chart, from_body, no_beta).condition == "beta != 0"
    assert "QuaternionChart has the same limit" in str(refusal(chart, from_body, no_beta))
    with pytest.raises(ChartError, match=r"OrdinaryLagrange"):
        lp.charts.EulerChart(top(), state=no_beta)
    with pytest.raises(ChartError, match="C3 = 0"):
        lp.charts.EulerChart(top(), leaf={"C1": 1, "C2": 0, "C3": 0})

    upright = np.array([0.1, 0.2, 0.3, 1.0, 0.0, 0.5, 0, 0, 2.0])
    pole = refusal(lp.charts.EulerChart(top(), state=upright), from_body, upright)
    assert pole.condition == "sin(theta) != 0"
    assert "another gauge" in str(pole)
    lp.charts.EulerChart(top(), state=upright, gauge="e1, e3").from_body(
        [upright]
    )  # another gauge has its poles elsewhere
    assert refusal(chart, to_body, z * [1, 1, 0, 1, 1, 1]).condition == "sin(theta) != 0"

    beyond = z + np.array([0, 0, 0, 50.0, 0, 0])
    error = refusal(chart, to_body, np.array([z, beyond, beyond]))
    assert error.condition == "eta - 2 epsilon l.beta > 0"
    assert "at state 1 (2 of 3 such)" in str(error)

    assert refusal(chart, from_body, 1.01 * X).condition == "on the leaf"


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


@pytest.mark.parametrize("shape", [(9,), (2, 1, 9)])
def test_margins_are_arrays_of_the_shape_of_the_states(shape):
    states = np.broadcast_to(X, shape)
    charts = (
        lp.charts.EulerChart(top(), state=X),
        lp.charts.QuaternionChart(top(), state=X),
        lp.charts.OrdinaryLagrange(lp.Top.lagrange()),
    )
    for chart in charts:
        for margin in chart.margins(states).values():
            assert type(margin) is np.ndarray
            assert margin.shape == shape[:-1]


def test_what_failed_stays_not_a_number():
    chart = lp.charts.EulerChart(top(), state=X)
    states = np.array([X, np.full(9, np.nan)])
    z = chart.from_body(states)
    assert np.isnan(z[1]).all()
    assert np.isnan(chart.to_body(z)[1]).all()


@pytest.mark.parametrize(
    ("gauge", "message"),
    [
        ("e3, e4", "two of the axes"),
        ("e3", "two of the axes"),
        ("e3, e3", r"e_par.e_perp = 1"),
        (((1, 1, 0), (0, 0, 1)), r"e_par.e_par = 2"),
        (((1, 0, 0), (1e-9, 1, 0)), "orthonormal"),
        (3, "two of the axes"),
    ],
)
def test_a_gauge_is_orthonormal(gauge, message):
    with pytest.raises(ParameterError, match=message):
        lp.charts.EulerChart(top(), gauge=gauge)


def test_wrong_input_is_refused():
    with pytest.raises(ParameterError, match="got both"):
        lp.charts.EulerChart(top(), state=X, leaf={"C1": 1, "C2": 0, "C3": 1})
    with pytest.raises(ParameterError, match="C1, C2 and C3"):
        lp.charts.EulerChart(top(), leaf={"C1": 1})
    for casimirs in ([1, 2, 3], 3, "C1"):
        with pytest.raises(ParameterError, match="C1, C2 and C3"):
            lp.charts.EulerChart(top(), leaf=casimirs)
    for factor in (1e300, np.inf):
        with pytest.raises(ParameterError, match="other units"):
            lp.charts.EulerChart(top(), state=X).from_body(X * factor)
    with pytest.raises(ShapeError, match=r"one state of shape \(9,\)"):
        lp.charts.EulerChart(top(), state=[X, X])
    with pytest.raises(ParameterError, match="charged and the twisted top"):
        lp.charts.EulerChart(lp.catalog.system("manakov-so4"))
    with pytest.raises(ShapeError, match="6 components"):
        lp.charts.EulerChart(top(), state=X).to_body(X)
    with pytest.raises(ParameterError, match="v must be a number"):
        lp.charts.EulerChart(top()).from_body(X)
    with pytest.raises(ParameterError, match="eta"):
        lp.charts.EulerChart(top()).system.field()
