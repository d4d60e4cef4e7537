"""The figure of a rod: its data, labels and scales; pixels are looked at by eye."""

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import liepoisson as lp
from liepoisson.errors import ParameterError
from liepoisson.plot.rigid_body import rod as draw_rod
from liepoisson.plot.rigid_body import tube
from liepoisson.plot.style import ANGULAR_MOMENTUM, SECOND_FIELD

LAGRANGE = lp.Top.twisted_lagrange(axial="2/3")
ANISOTROPIC = lp.Top(inertia=(2, 1.5, 1), a=(0, 0, 1), epsilon=1)
X0 = [[0.9, 0.2, 0.6, 0.5, 0, 0.3, 0, 0.3, 1], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]]


@pytest.fixture(scope="module")
def rod():
    return lp.orbits.rod(ANISOTROPIC, X0, length=8, n_points=81, attitude="beta")


def test_tube_has_its_radius_and_its_stripe_along_the_first_director(rod):
    r, directors = rod.centre_line[0], rod.directors[0]
    facets = tube(r, directors, 0.1)
    spokes = facets[:, :, 0] - r[:-1, None]
    assert np.abs(np.linalg.norm(spokes, axis=-1) - 0.1).max() < 1e-15
    assert np.abs(np.einsum("pfi,pi->pf", spokes, directors[:-1, 2])).max() < 1e-15
    middle = facets[:, 2, 0] - r[:-1]  # the edge between the second and the third of the four facets of the stripe
    assert np.abs(middle - 0.1 * directors[:-1, 0]).max() < 1e-15


def test_profiles_are_those_of_the_rod(rod):
    figure = draw_rod(rod, trajectory=1)
    curves = [axes.lines[0].get_data() for axes in figure.axes[1:]]
    for (s, values), wanted in zip(curves, (rod.curvature, rod.twist, rod.tension), strict=True):
        np.testing.assert_array_equal(s, rod.arclength)
        np.testing.assert_array_equal(values, wanted[1])
    titles = [axes.get_title("left") for axes in figure.axes[1:]]
    assert ["curvature" in titles[0], "twist" in titles[1], "tension" in titles[2]] == [True] * 3
    assert figure.axes[-1].get_xlabel() == "arclength $s$"


def test_rod_is_drawn_with_equal_scales_a_stripe_and_its_field(rod):
    ax = draw_rod(rod).axes[0]
    widths = np.array([np.ptp(limits) for limits in (ax.get_xlim3d(), ax.get_ylim3d(), ax.get_zlim3d())])
    ratio = widths / np.asarray(ax._box_aspect)
    assert np.ptp(ratio) < 1e-12 * ratio.max()
    body, arrow = ax.collections
    stripe = np.array(to_rgb(ANGULAR_MOMENTUM))
    colours = body._facecolor3d[:, :3].reshape(80, 18, 3)  # as given, before they are sorted by depth
    hue = colours / np.linalg.norm(colours, axis=-1, keepdims=True)
    like = np.abs(hue - stripe / np.linalg.norm(stripe)).max(axis=-1) < 1e-6
    assert like[:, :4].all()
    assert not like[:, 4:].any()
    assert tuple(arrow.get_color()[0][:3]) == pytest.approx(to_rgb(SECOND_FIELD))
    (shaft, *_) = arrow._segments3d
    tip, foot = shaft
    along = tip - foot
    assert along / np.linalg.norm(along) == pytest.approx([0, 0, 1], abs=1e-12), "the field was put upright"
    assert [text.get_text() for text in ax.texts] == [r"$I\,\mathbf{B}$"]
    assert [axis.get_label_text() for axis in (ax.xaxis, ax.yaxis, ax.zaxis)] == ["$x$", "$y$", "$z$"]
    start = np.array(ax.lines[0].get_data_3d()).ravel()
    np.testing.assert_array_equal(start, [0, 0, 0])


def test_axes_are_square_and_in_the_middle_of_a_narrow_figure(rod):
    ax = draw_rod(rod, profiles=False, figure=Figure(figsize=(2, 6))).axes[0]
    left, bottom, width, height = ax.get_position(original=True).bounds
    assert 2 * width == pytest.approx(6 * height, rel=1e-12)
    assert left + width / 2 == pytest.approx(0.5, rel=1e-12)
    assert bottom + height / 2 == pytest.approx(0.525, rel=1e-12), "a little above the middle"


def test_what_can_not_be_drawn_is_refused(rod):
    with pytest.raises(ParameterError, match="one of 2"):
        draw_rod(rod, trajectory=2)
    with pytest.raises(ParameterError, match="one of 2"):
        draw_rod(rod, trajectory="first")
    with pytest.raises(ParameterError, match="radius"):
        draw_rod(rod, radius=-1.0)
    start = np.array(X0)
    start[0, 0] = np.nan
    with pytest.raises(ParameterError, match="outcome"):
        draw_rod(lp.orbits.rod(ANISOTROPIC, start, length=1), trajectory=0)


@pytest.mark.parametrize("options", [{"radius": "a"}, {"radius": [1]}, {"elevation": np.nan}, {"azimuth": "left"}])
def test_lengths_and_angles_that_are_none_are_refused(rod, options):
    with pytest.raises(ParameterError, match=f"{next(iter(options))}: wanted"):
        draw_rod(rod, **options)
