"""Orbits in charts: where a chart ends inside a run, and what is kept."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ChartError
from liepoisson.leaf.chart_orbit import chart_orbit

GAUGES = ("e3, e1", "e1, e3", ((0.6, 0.8, 0), (0, 0, 1)))
TOP = lp.Top(inertia=(2, 1.5, 1), a=(0, 0, 1), epsilon=1)
COLLINEAR = np.array([0, 0, 0, 0, 0, 0, 1.0, 0, 0])  # l = alpha = 0, beta = e1


def exact(x0, t):
    return lp.integrate(TOP, x0, times=t, method=lp.RungeKutta(tol=1e-13)).state[0]


@pytest.mark.parametrize("gauge", GAUGES, ids=str)
def test_the_euler_chart_refuses_a_collinear_start(gauge):
    with pytest.raises(ChartError) as caught:
        chart_orbit(lp.charts.EulerChart(TOP, state=COLLINEAR, gauge=gauge), COLLINEAR, times=[0, 1])
    assert caught.value.condition == "alpha x beta != 0"


@pytest.mark.thorough
def test_the_quaternion_chart_follows_it_and_it_does_not_stay_collinear():
    # alpha' = epsilon beta x a = -e2 at the start, so that |alpha x beta| = t, to third order
    t = np.array([0, 0.25, 1, 5, 10])
    orbit = chart_orbit(lp.charts.QuaternionChart(TOP, state=COLLINEAR), COLLINEAR, times=t)
    assert (orbit.outcome, orbit.left_by) == ("finished", None)
    np.testing.assert_allclose(orbit.body, exact(COLLINEAR, t), rtol=0, atol=1e-10)  # measured 2e-12
    normal = np.linalg.norm(np.cross(orbit.body[1, 3:6], orbit.body[1, 6:]))
    assert abs(normal - 0.25) < 1e-4


@pytest.mark.thorough
@pytest.mark.parametrize(("gauge", "direction"), [(GAUGES[0], 1), (GAUGES[2], -1)], ids=str)
def test_an_orbit_through_the_collinear_set_leaves_the_euler_chart_there(gauge, direction):
    start = exact(COLLINEAR, [0, -0.5 * direction])[-1]
    t = direction * np.linspace(0, 1, 9)
    orbit = chart_orbit(lp.charts.EulerChart(TOP, state=start, gauge=gauge), start, times=t)
    assert orbit.outcome in ("left the chart", "not finite", "step too small", "max steps")
    assert orbit.left_by == "alpha x beta != 0"
    assert orbit.left_margin < 1e-3
    assert 0.499 < abs(orbit.end_time) <= 0.5001
    np.testing.assert_allclose(orbit.body[:4], exact(start, t)[:4], rtol=0, atol=1e-12)  # kept up to there
    assert np.isnan(orbit.body[5:]).all()
    assert np.isfinite(orbit.end_state).all()
    smooth = chart_orbit(lp.charts.QuaternionChart(TOP, state=start), start, times=t)
    np.testing.assert_allclose(smooth.body, exact(start, t), rtol=0, atol=1e-12)


@pytest.mark.thorough
def test_an_orbit_inside_the_chart_finishes():
    x = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4])
    for chart in (lp.charts.EulerChart(TOP, state=x), lp.charts.QuaternionChart(TOP, state=x)):
        orbit = chart_orbit(chart, x, times=np.linspace(0, 10, 5))
        assert (orbit.outcome, orbit.left_by, orbit.left_margin, orbit.end_time) == ("finished", None, None, 10.0)
        np.testing.assert_allclose(orbit.body, exact(x, np.linspace(0, 10, 5)), atol=1e-10)
        assert all(values.shape == (5,) for values in orbit.margins.values())


@pytest.mark.thorough
def test_a_file_has_the_orbit_in_coordinates_and_in_the_body(tmp_path):
    x = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4])
    chart = lp.charts.EulerChart(TOP, state=x)
    orbit = chart_orbit(chart, x, times=np.linspace(0, 3, 4))
    loaded = lp.load(orbit.save(tmp_path / "orbit.nc"))
    dataset = loaded.dataset
    assert tuple(dataset["component"].to_numpy()) == chart.component_names == orbit.components
    np.testing.assert_array_equal(dataset["state"], orbit.state)
    np.testing.assert_array_equal(dataset["body"].sel(body_component="alpha1"), orbit.body[:, 3])
    for name, margin in orbit.margins.items():
        np.testing.assert_array_equal(dataset["margin"].sel(condition=name), margin)
    assert dataset.attrs["system"] == orbit.system.name == chart.name
    assert (loaded.chart, loaded.left_by) == (repr(chart), None)
    again = lp.rerun(dataset)
    assert again.method == orbit.method
    np.testing.assert_array_equal(again.state[0], orbit.state)


def test_a_budget_of_steps_is_no_end_of_the_chart():
    x = np.array([0.3, -0.4, 0.5, 0.7, 0.2, -0.3, 0.1, 0.9, 0.4])
    orbit = chart_orbit(lp.charts.EulerChart(TOP, state=x), x, times=[0, 100.0], method=lp.Taylor(max_steps=20))
    assert orbit.outcome == "max steps"
    assert 0 < orbit.end_time < 100
