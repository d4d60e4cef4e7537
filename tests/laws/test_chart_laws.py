"""Laws of canonical charts: they carry the bracket, exactly, and their motion is that of the top."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import liepoisson as lp
from liepoisson.leaf.chart_orbit import chart_orbit

# without shrinking: a counterexample in rational numbers is readable as it is found
exactly = settings(deadline=None, max_examples=4, derandomize=True, phases=(Phase.generate,))
rational = st.fractions(min_value=-2, max_value=2, max_denominator=5)
positive = st.fractions(min_value=Fraction(1, 5), max_value=2, max_denominator=5)
epsilons = st.sampled_from([Fraction(0), Fraction(1), Fraction(-2, 3)])

GAUGES = ("e3, e1", "e1, e3", (("3/5", "0", "4/5"), (0, 1, 0)), (("2/3", "-1/3", "2/3"), ("2/3", "2/3", "-1/3")))


def top(eps):
    return lp.Top(inertia=("5/4", 1, "4/5"), a=("1/2", "-1/3", "2/3"), b=("1/5", "2/5", "-1/2"), epsilon=eps)


def number(value):
    return sp.Rational(value.numerator, value.denominator)


def defect(chart, system, values):
    """D Pi D^T - J at a point, for the map from canonical to body coordinates."""
    images = sp.Matrix([*chart.angular_momentum, *chart.alpha, *chart.beta])
    n = chart.system.n_degrees
    canonical = sp.Matrix(sp.BlockMatrix([[sp.zeros(n), sp.eye(n)], [-sp.eye(n), sp.zeros(n)]]))
    D = images.jacobian(chart.system.variables).xreplace(values)
    here = dict(zip(system.variables, images.xreplace(values), strict=True))
    return D * canonical * D.T - system.bracket.poisson_tensor().xreplace(here), here


@pytest.mark.thorough
@pytest.mark.parametrize("gauge", GAUGES, ids=str)
@exactly
@given(
    eps=epsilons,
    tangents=st.tuples(rational, positive, positive),
    momenta=st.tuples(rational, rational, rational),
    constants=st.tuples(rational, positive, positive),
)
def test_the_euler_chart_carries_the_bracket_and_the_energy(gauge, eps, tangents, momenta, constants):
    system = top(eps)
    chart = lp.charts.EulerChart(system, gauge=gauge)
    values, variables = {}, chart.system.variables
    for angle, t in zip(variables, map(number, tangents), strict=False):  # t = tan(angle/2)
        values |= {sp.cos(angle): (1 - t * t) / (1 + t * t), sp.sin(angle): 2 * t / (1 + t * t)}
    values |= dict(zip(variables[3:], map(number, momenta), strict=True))
    v, w, r = map(number, constants)
    values |= {sp.Symbol("v"): v, sp.Symbol("w"): w}
    values[sp.Symbol("eta")] = r**2 + 2 * number(eps) * chart.l_dot_beta.xreplace(values)  # the root is r, rational
    residual, here = defect(chart, system, values)
    assert residual == sp.zeros(9, 9)
    assert chart.hamiltonian.xreplace(values) == system.hamiltonian.xreplace(here)


@pytest.mark.thorough
@exactly
@given(
    eps=epsilons,
    q=st.tuples(positive, rational, rational, rational),
    p=st.tuples(rational, rational, rational, rational),
    pair=st.tuples(rational, rational),
    constants=st.tuples(rational, positive, positive),
)
def test_the_quaternion_chart_carries_the_bracket_and_the_energy(eps, q, p, pair, constants):
    system = top(eps)
    chart = lp.charts.QuaternionChart(system)
    X, Y = pair
    point = (*q, X, *p, Y) if eps else (*q, *p)
    values = dict(zip(chart.system.variables, map(number, point), strict=True))
    v, w, r = map(number, constants)
    values |= {sp.Symbol("v"): v, sp.Symbol("w"): w, sp.Symbol("eta"): r**2}
    residual, here = defect(chart, system, values)
    assert residual == sp.zeros(9, 9)
    assert chart.hamiltonian.xreplace(values) == system.hamiltonian.xreplace(here)


def random_cases(seed, n):
    """Tops, starts and all charts, with starts that are well inside the Euler charts: all margins above 0.3."""
    rng = np.random.default_rng(seed)
    found = 0
    while found < n:
        inertia, a, b, x = rng.uniform(0.6, 1.4, 3), rng.normal(size=3), rng.normal(size=3), rng.normal(size=9)
        eps = (0, 1, -0.7, 0.3)[found % 4]
        system = lp.Top(inertia=inertia.tolist(), a=a.tolist(), b=b.tolist(), epsilon=eps)
        charts = [lp.charts.EulerChart(system, state=x, gauge=gauge) for gauge in GAUGES]
        if min(float(min(chart.margins(x).values())) for chart in charts) > 0.3:
            found += 1
            yield system, x, [*charts, lp.charts.QuaternionChart(system, state=x)]


@pytest.mark.thorough
def test_canonical_and_lie_poisson_orbits_agree_to_ten_digits_at_time_ten():
    """In all charts, also where margins on the way fall to 0.016; what an early end cuts off is counted."""
    t = np.linspace(0, 10, 201)
    whole = 0
    for system, x, charts in random_cases(5, 2):
        exact = lp.integrate(system, x, times=t).state[0]
        for chart in charts:
            orbit = chart_orbit(chart, x, times=t)
            reached = t <= orbit.end_time
            error = float(np.abs(orbit.body - exact)[reached].max())
            assert error < 1e-10, f"{chart!r}: error {error:.1e}, {x}"  # measured: 3e-12, with quaternions 2e-13
            whole += orbit.outcome == "finished"
            if isinstance(chart, lp.charts.QuaternionChart):
                assert orbit.outcome == "finished"
            elif orbit.outcome != "finished":
                assert orbit.left_by in chart.conditions
                assert orbit.left_margin < 1e-3
    assert whole >= 9, f"{whole} of 10 orbits ran to t = 10"  # measured: all
