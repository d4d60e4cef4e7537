"""The map of first return: back and forth, its times, and why a state has no image."""

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import SurfaceWarning

KOVALEVSKAYA = lp.catalog.system("kovalevskaya")
FREE = lp.Top(inertia=(1, 1, "1/2"), a=(0, 0, 0), name="free symmetric body")
UNITS = (1e-3, 1e-14, 1e100)
"""Sizes of one component beside another of size one."""
FREE_START = np.array([0.5 * np.cos(0.3), -0.5 * np.sin(0.3), 0.6, 1, 0, 0, 0, 1, 0])


@pytest.mark.parametrize("u", UNITS)
def test_first_returns_do_not_depend_on_the_unit_of_one_component(u):
    oscillator = lp.System(lp.canonical(1), f"p1^2/(2*{u!r}) + {u!r}*q1^2/2")
    image = lp.sections.first_return(oscillator, [1.0, 0.3 * u], surface="p1", t_end=100)
    assert image.outcome == "returned"
    assert float(image.time) == pytest.approx(np.arctan(0.3) + np.pi, rel=1e-14)


def test_the_return_map_steps_from_crossing_to_crossing_and_back():
    x0 = lp.sample_states(KOVALEVSKAYA, 4, seed=1)
    orbit = lp.section(KOVALEVSKAYA, x0, surface="l3", t_end=400, direction=1, n_crossings=3)
    points = orbit.state.reshape(4, 3, 6)
    images, times, outcome = lp.sections.first_return(KOVALEVSKAYA, points[:, :2], surface="l3", t_end=400)
    assert (outcome == "returned").all()
    assert outcome.shape == (4, 2)
    np.testing.assert_allclose(images, points[:, 1:], atol=1e-11)
    np.testing.assert_allclose(times, np.diff(orbit.time.reshape(4, 3)), atol=1e-11)
    back = lp.sections.first_return(KOVALEVSKAYA, images, surface="l3", t_end=-400, direction=-1)
    np.testing.assert_allclose(back.state, points[:, :2], atol=1e-11)


def test_points_that_return_late_have_no_image_beside_those_that_do():
    x0 = lp.section(
        KOVALEVSKAYA, lp.sample_states(KOVALEVSKAYA, 6, seed=1), surface="l3", t_end=200, n_crossings=1
    ).state
    all_images, times, _ = lp.sections.first_return(KOVALEVSKAYA, x0, surface="l3", t_end=400)
    late = times > np.median(times)
    assert late[: np.flatnonzero(~late)[-1]].any(), "a missing image must come before one that is there"
    images, _, outcome = lp.sections.first_return(KOVALEVSKAYA, x0, surface="l3", t_end=np.median(times))
    assert np.array_equal(outcome == "no return", late)
    assert np.isnan(images[late]).all()
    assert np.array_equal(images[~late], all_images[~late])


@pytest.mark.parametrize(("offset", "direction"), [(1e-11, 0), (-1e-11, 0), (0.0, -1), (1e-11, 1)])
def test_states_a_little_off_the_surface_return_where_those_on_it_do(offset, direction):
    on = lp.section(
        KOVALEVSKAYA, lp.sample_states(KOVALEVSKAYA, 5, seed=1), surface="l3", t_end=50, n_crossings=1
    ).state
    off = on + offset * np.eye(6)[2]
    exact, near = (
        lp.sections.first_return(KOVALEVSKAYA, x, surface="l3", t_end=100, direction=direction) for x in (on, off)
    )
    assert near.time.min() > 1e-3
    np.testing.assert_allclose(near.state, exact.state, atol=1e-8)
    assert (near.outcome == "returned").all()


def test_the_return_map_says_why_an_orbit_ended():
    x = np.zeros((2, 6))
    x[0] = [1, 0, 0, 0, 0.6, 0.8]
    x[1] = np.nan
    assert lp.sections.first_return(KOVALEVSKAYA, x, surface="l3", t_end=100).outcome.tolist() == [
        "returned",
        "not finite",
    ]


def test_no_return_is_said_only_where_the_surface_was_followed():
    steady = lp.sections.first_return(FREE, FREE_START, surface="l1 - 0.51", t_end=5)
    assert steady.outcome == "no return"
    with pytest.warns(SurfaceWarning, match="could not be followed"):
        fast = lp.sections.first_return(FREE, FREE_START, surface="2 + sin(10^12*l1)", t_end=5)
    assert fast.outcome == "none seen"
