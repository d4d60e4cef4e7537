"""Figures of orbits: what is drawn where; pixels are looked at by eye."""

from types import SimpleNamespace

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.plot.orbits import _AZIMUTH, _ELEVATION, _view, orbit

TIME = np.linspace(0, 10, 201)


def turning():
    """A vector l that changes its length, and one of length 2 that turns about the third axis."""
    l = np.stack([np.sin(TIME), np.cos(2 * TIME), 0.1 * TIME], axis=1)
    beta = np.stack([2 * np.cos(TIME), 2 * np.sin(TIME), 0 * TIME], axis=1)
    return np.concatenate([l, beta], axis=1)[None]


@pytest.fixture
def run():
    names = ("l1", "l2", "l3", "beta1", "beta2", "beta3")
    return SimpleNamespace(system="turning", components=names, time=TIME, state=turning())


def test_the_view_is_a_rotation_that_looks_from_its_azimuth_and_elevation():
    view = _view()
    np.testing.assert_allclose(view.T @ view, np.eye(3), atol=1e-15)
    assert np.linalg.det(view) == pytest.approx(1)
    eye = [np.cos(_ELEVATION) * np.cos(_AZIMUTH), np.cos(_ELEVATION) * np.sin(_AZIMUTH), np.sin(_ELEVATION)]
    np.testing.assert_allclose(eye @ view, [0, 0, 1], atol=1e-15)


def test_the_near_side_of_a_sphere_is_darker_and_drawn_last(run):
    figure = orbit(run)
    (path,) = figure.axes[3].collections
    points = run.state[0, :, 3:] @ _view()
    depth = (points[1:, 2] + points[:-1, 2]) / 2
    order = np.argsort(depth, kind="stable")
    np.testing.assert_allclose([segment[0] for segment in path.get_segments()], points[:-1, :2][order])
    strength = path.get_colors()[:, 3]
    assert (strength[depth[order] > 0.01] == 0.9).all()
    assert (strength[depth[order] < -0.01] < 0.5).all()


def test_components_paths_and_changes_are_drawn(run):
    energy = 1 + 1e-12 * np.sin(TIME)
    figure = orbit(run, invariants={"H": energy})
    in_time, path_of_l, second, path_of_beta, changes = figure.axes
    for ax, vector in ((in_time, run.state[0, :, :3]), (second, run.state[0, :, 3:])):
        for line, component in zip(ax.lines, vector.T, strict=True):
            np.testing.assert_array_equal(line.get_ydata(), component)
    labels = [text.get_text() for text in second.get_legend().get_texts()]
    assert labels == [r"$\beta_{1}$", r"$\beta_{2}$", r"$\beta_{3}$"]
    assert path_of_beta.texts[-1].get_text() == r"$|\beta| = 2$"
    assert path_of_l.texts[-1].get_text() == rf"max $|\ell| = {np.linalg.norm(run.state[0, :, :3], axis=1).max():.3g}$"
    largest = np.maximum.accumulate(np.abs(energy - energy[0]))
    np.testing.assert_allclose(changes.lines[0].get_ydata()[1:], largest[1:])
    assert changes.get_yscale() == "log"
    assert changes.get_ylim() == pytest.approx((1e-14, 1e-11))  # from 5e-14 to 1e-12
    assert figure.get_suptitle() == "turning"


def test_a_trajectory_that_failed_is_drawn_up_to_there(run):
    run.state[0, 100:] = np.nan
    figure = orbit(run, invariants={"H": np.where(np.arange(201) < 100, 1.0, np.nan)})
    assert len(figure.axes[0].lines[0].get_xdata()) == 100


def test_of_many_components_vectors_and_invariants_the_largest_are_drawn():
    names = [f"M{k}" for k in range(1, 9)] + list("abdefgh") + ["small"]
    size = np.array([1, 9, 2, 8, 3, 7, 4, 6, 1, 1, 1, 1, 1, 1, 1, 0.1])
    state = size * np.cos(np.outer(TIME, np.ones(16)))
    changes = {f"C{k}": 1 + k * 1e-12 * np.sin(TIME) for k in range(8)}
    figure = orbit(SimpleNamespace(components=names, time=TIME, state=state[None]), invariants=changes, title="many")
    assert len(figure.axes) == 9  # 8 of 9 vectors, and the changes
    assert figure.get_suptitle() == "many (8 largest of 9)"
    first, last = figure.axes[0], figure.axes[-1]
    assert [text.get_text() for text in first.get_legend().get_texts()] == [f"$M_{{{k}}}$" for k in (2, 4, 5, 6, 7, 8)]
    for line, k in zip(first.lines, (1, 3, 4, 5, 6, 7), strict=True):
        np.testing.assert_array_equal(line.get_ydata(), state[:, k])
    assert len({line.get_color() for line in first.lines}) == 6
    assert [text.get_text() for text in first.texts] == ["6 largest of 8"]
    assert [text.get_text() for text in last.get_legend().get_texts()] == [f"$C_{{{k}}}$" for k in range(2, 8)]
    assert [text.get_text() for text in last.texts] == ["6 largest of 8"]


def test_modes_of_a_fluid_are_real_and_imaginary_parts():
    fluid = lp.catalog.zeitlin(5)
    figure = orbit(lp.integrate(fluid, lp.sample_states(fluid, 1, seed=1), times=TIME))
    real, imaginary, _ = figure.axes
    assert [ax.get_ylabel() for ax in (real, imaginary)] == [r"$\mathrm{Re}\,w$", r"$\mathrm{Im}\,w$"]
    assert all(text.get_text().startswith(r"$\mathrm{Re}\,w_{") for text in real.get_legend().get_texts())
    figure.canvas.draw()


def test_an_orbit_has_its_invariants_whichever_trajectory_is_drawn():
    top = lp.Top.kovalevskaya()
    run = lp.integrate(top, lp.sample_states(top, 3, seed=1), times=TIME)
    drawn = {line.get_label(): line.get_ydata() for line in orbit(run, trajectory=2).axes[-1].lines}
    energy = run.invariants["H"][2]
    np.testing.assert_array_equal(np.nan_to_num(drawn["$H$"]), np.maximum.accumulate(np.abs(energy - energy[0])))
    rows = [len(orbit(run, **options).axes) for options in ({}, {"invariants": {}})]
    assert rows == [7, 6]


def test_mistakes_are_refused(run):
    with pytest.raises(ShapeError, match="Take those of one trajectory"):
        orbit(run, invariants={"H": np.ones((1, 201))})
    with pytest.raises(ParameterError, match="trajectory: wanted a whole number from 0 to 0; got 1"):
        orbit(run, trajectory=1)
    run.state[0, 1:] = np.nan
    with pytest.raises(ParameterError, match="at least two states"):
        orbit(run)


def test_numbers_whose_squares_are_no_doubles_are_refused(run):
    run.state = 1e200 * run.state
    with pytest.raises(ParameterError, match=r"up to 1e\+150; trajectory 0 reaches 2e\+200"):
        orbit(run)
