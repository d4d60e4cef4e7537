"""Figures of sweeps show the numbers of the sweep."""

from dataclasses import replace

import numpy as np
import pytest

from liepoisson.plot.sweep import axis_label, lattice_image
from liepoisson.plot.sweep import sweep as draw
from liepoisson.sweeps.run import sweep
from liepoisson.sweeps.spec import Axis
from liepoisson.sweeps.tasks import NOT_COMPUTED


def top(x, y=0.0):
    import liepoisson as lp

    return lp.Top.heavy((2, 2, 1), (x, y, 0))


def disc(system, x0, **_):
    x, y = (float(v) for v in system.a[:2])
    return np.full(len(x0), float(x**2 + y**2 < 0.5))


def slope(system, x0, **_):
    return float(system.a[0]) + np.linspace(-1, 1, len(x0))


@pytest.mark.thorough
def test_a_curve_and_its_band():
    result = sweep(system=top, axes={"x": [0.0, 1.0, 2.0]}, quantity=slope, n_starts=5, t_end=1.0)
    ax = draw(result)
    (line,) = ax.lines
    np.testing.assert_allclose(line.get_xydata(), [[0, 0], [1, 1], [2, 2]], atol=1e-15)
    low, high = result.interval()
    band = ax.collections[0].get_paths()[0].vertices[:, 1]
    assert band.min() == pytest.approx(low.min())
    assert band.max() == pytest.approx(high.max())
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$x$", "mean value\n(band: 95% interval)")
    assert axis_label(Axis("energy", (0.0, 1.0))) == "energy $H$"
    assert axis_label(Axis("x", (0.0, 1.0), "own label")) == "own label"


@pytest.mark.parametrize("axes", [{"x": [0.0, 1.0, 2.0, 3.0]}, {"x": [0.0, 1.0, 2.0, 3.0], "y": [0.0, 1.0]}])
def test_a_part_of_a_sweep_says_what_is_missing(axes):
    whole = sweep(system=top, axes=axes, quantity=slope, n_starts=5, t_end=1.0)
    code, value = whole.outcome_code.copy(), whole.value.copy()
    last = whole.points[:, 0] > 1.5
    code[last], value[last] = NOT_COMPUTED, np.nan
    part = draw(replace(whole, outcome_code=code, value=value))
    assert [text.get_text() for text in part.texts] == [f"{last.sum()} of {len(last)} points not computed"]
    assert part.get_xlim() == pytest.approx(draw(whole).get_xlim())
    assert not draw(whole).texts


def test_a_map_paints_each_point():
    result = sweep(system=top, axes={"x": [0.0, 1.0, 2.0], "y": [0.0, 0.5]}, quantity=slope, n_starts=3, t_end=1.0)
    xs, ys, image = lattice_image(result)
    np.testing.assert_allclose(image, [[0, 0], [1, 1], [2, 2]], atol=1e-15)
    np.testing.assert_allclose(xs, [-0.5, 0.5, 1.5, 2.5])
    np.testing.assert_allclose(ys, [-0.25, 0.25, 0.75])
    ax = draw(result)
    assert len(ax.figure.axes) == 2  # the map and its colour bar
    np.testing.assert_allclose(ax.collections[0].get_array(), image.T)


def test_cells_with_many_undecided_orbits_are_covered():
    """One of eight chaotic and six undecided is no dark cell: the true fraction is up to seven eighths."""
    axes = {"epsilon": [0.0, 0.5, 1.0], "energy": [0.0, 1.0]}
    starts = {"C1": 1, "C2": 0.1, "C3": 1}
    parameters = {"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]}
    found = sweep(
        system="twisted-top", parameters=parameters, axes=axes, starts=starts, quantity="chaotic_fraction",
        n_starts=8, t_end=5,
    )  # fmt: skip
    value = np.full_like(found.value, -1.0)
    value[1, :7] = [1, 0, 0, 0, 0, 0, 0]
    value[3, :2] = 0  # a quarter is not more than a quarter
    ax = draw(replace(found, value=value))
    held = "parameters: I = (2, 2, 1), a = (-1, 0, 0), b = (0, 0, 0)\nof the starts: C1 = 1, C2 = 0.1, C3 = 1\n"
    assert ax.figure.get_suptitle().startswith(held)
    assert ax.figure.get_suptitle().endswith("undecided: 16.7% of all orbits")
    covered = next(c for c in ax.collections if c.get_label() == "undecided")
    (cell,) = covered.get_paths()
    assert (cell.vertices.min(axis=0).tolist(), cell.vertices.max(axis=0).tolist()) == ([-0.25, 0.5], [0.25, 1.5])
    assert covered.get_hatch()
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["more than 1/4 of the orbits undecided"]
    assert ax.get_xlim() == (-0.25, 1.25)  # half a step beyond the ends
    assert draw(replace(found, value=np.ones_like(value))).get_legend() is None


def test_a_refined_map_has_the_right_value_at_every_point():
    grid = np.linspace(0, 1, 5)
    result = sweep(
        system=top,
        axes={"x": grid, "y": grid},
        quantity=disc,
        n_starts=1,
        t_end=1.0,
        refine={"levels": 2, "difference": 0.5},
    )
    assert set(result.level) == {0, 1, 2}
    xs, ys, image = lattice_image(result)
    assert image.shape == (17, 17)
    assert np.isfinite(image).all()
    x, y = (xs[1:] + xs[:-1]) / 2, (ys[1:] + ys[:-1]) / 2
    wanted = (x[:, None] ** 2 + y[None, :] ** 2 < 0.5).astype(float)
    coarse = np.repeat(np.repeat(wanted[::4, ::4], 4, 0), 4, 1)[2:-1, 2:-1]
    assert np.mean(image != wanted) < 0.06 < np.mean(coarse != wanted)
    draw(result)
