r"""The figure of an elastic rod: its shape with a stripe that shows the twist, the field, and profiles along it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.plot.style import (
    ANGULAR_MOMENTUM,
    CENTRE_OF_MASS,
    FIRST_FIELD,
    GRID,
    INK,
    MUTED,
    SECOND_FIELD,
    house_style,
    new_figure,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from liepoisson.rigid_body.rod import Rod

_FACETS = 18
"""Facets around the tube."""
_STRIPE = 4
"""How many of them carry the stripe."""
_MOST_RINGS = 1500
"""Rings along the tube that are drawn at most: more are finer than a printed line."""
_LIGHT = np.array([0.35, -0.55, 0.76])
"""Direction to the light, in space."""
_HEIGHT, _PROFILES = 4.4, 3.4
"""Height of a figure, and the width of the profiles in it, in inches."""


@explains_its_arguments
def rod(
    rod: Rod,
    *,
    trajectory: int = 0,
    radius: float | None = None,
    profiles: bool = True,
    elevation: float = 18.0,
    azimuth: float = -60.0,
    figure: Figure | None = None,
) -> Figure:
    r"""A rod in space, with its curvature, twist and tension along the arclength.

    The tube is drawn about the centre line with equal scales on all axes; the stripe follows the director d1, so it
    winds about a twisted rod.  The arrow shows the direction of I B, current times magnetic field, if there is one; a
    dot is the beginning.

    Example:
        >>> system = lp.System(lp.so(3) @ lp.semidirect(2), "(l1^2 + l2^2 + l3^2/2)/2 + alpha3")
        >>> figure = lp.plot.rod(lp.orbits.rod(system, [0, 1, 0.5, 0, 0, -1], length=10))
        >>> print(*(axes.get_title(loc="left") or axes.get_title() for axes in figure.axes[1:]), sep=", ")
        curvature $\kappa$, twist $u_3$, tension $\mathbf{n}\cdot\mathbf{d}_3$

    Args:
        rod: Result of `liepoisson.rod`.
        trajectory: Which of its rods.
        radius: Of the tube, in units of length; by default 1/70 of the largest extent.  Only drawn: the rod of the
            equations is thin.
        profiles: Whether to draw curvature, twist and tension beside it.
        elevation: Of the eye above the horizontal plane, in degrees.
        azimuth: Of the eye, in degrees.
        figure: An empty figure to draw into, by default a new one.

    Returns:
        The figure; its first axes are those of the rod.

    Raises:
        ParameterError: there is no such trajectory, it has fewer than two finite points, the radius is not
            positive, or an angle is no finite number.
    """
    count = len(np.asarray(rod.centre_line))
    if not np.issubdtype(type(trajectory), np.integer) or not -count <= trajectory < count:
        raise ParameterError(f"trajectory: wanted one of {count}; got {trajectory!r:.60}; they count from 0")
    if radius is not None and not (_is_number(radius) and radius > 0):
        raise ParameterError(f"radius: wanted a positive length; got {radius!r:.60}; leave it out")
    for name, angle in (("elevation", elevation), ("azimuth", azimuth)):
        if not _is_number(angle):
            raise ParameterError(f"{name}: wanted an angle in degrees; got {angle!r:.60}; leave it out")
    r = np.asarray(rod.centre_line, dtype=np.float64)[trajectory]
    good = np.isfinite(r).all(axis=-1)
    if good.sum() < 2:
        raise ParameterError("rod: wanted two or more finite points to draw; got fewer; look at rod.outcome")
    directors = np.asarray(rod.directors, dtype=np.float64)[trajectory]
    with house_style():
        width = _width(r[good], elevation, azimuth)
        figure = new_figure(width + _PROFILES if profiles else 4.6, _HEIGHT) if figure is None else figure
        ax = _axes_of_the_rod(figure, width, width / (width + _PROFILES) if profiles else 1.0)
        extent = float(np.ptp(r[good], axis=0).max())
        _draw_tube(ax, r[good], directors[good], extent / 70 if radius is None else radius)
        _draw_field(ax, r[good], np.asarray(rod.field, dtype=np.float64)[trajectory][good][0])
        _dress(ax, r[good], elevation, azimuth)
        if profiles:
            _draw_profiles(figure, figure.add_gridspec(3, 2, width_ratios=[width, _PROFILES]), rod, trajectory)
    return figure


def _half_box(r: NDArray[np.float64]) -> NDArray[np.float64]:
    """Half the sides of the box about a rod; a flat one still needs some depth."""
    extent = np.ptp(r, axis=0)
    return np.maximum(extent / 2, 0.12 * extent.max()) + 0.06 * extent.max()


def _width(r: NDArray[np.float64], elevation: float, azimuth: float) -> float:
    """The width in inches that the box about a rod and its ticks take, as it is seen, in a figure of our height."""
    (x, y, z), (up, turn) = _half_box(r), np.radians([elevation, azimuth])
    across = x * abs(np.sin(turn)) + y * abs(np.cos(turn))
    high = z * abs(np.cos(up)) + (x * abs(np.cos(turn)) + y * abs(np.sin(turn))) * abs(np.sin(up))
    return float(np.clip(_HEIGHT * across / high + 1.1, 2.2, _HEIGHT))


def _axes_of_the_rod(figure: Figure, needed: float, share: float) -> Any:
    """Square axes in the middle of a share of the width: beside a slim box they are empty, and reach behind others."""
    width, height = figure.get_figwidth(), figure.get_figheight()
    side = _HEIGHT * min(height / _HEIGHT, width * share / needed)
    place = ((width * share - side) / 2 / width, (height - side) / 2 / height + 0.025, side / width, side / height)
    return figure.add_axes(place, projection="3d", computed_zorder=False, facecolor="none")


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.number)) and bool(np.isfinite(value))


def tube(r: NDArray[np.float64], directors: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    r"""Corners of the facets of a tube, $r + \rho(\cos\varphi\, d_1 + \sin\varphi\, d_2)$.

    Of the centre line, shape (point, 3), and the directors, shape (point, 3, 3): shape (point - 1, facet, corner, 3).
    d1 points to the middle of the first four facets, the stripe.
    """
    angles = 2 * np.pi * (np.arange(_FACETS + 1) - _STRIPE / 2) / _FACETS
    spokes = np.cos(angles)[:, None] * directors[:, None, 0] + np.sin(angles)[:, None] * directors[:, None, 1]
    ring = r[:, None] + radius * spokes
    return np.stack([ring[:-1, :-1], ring[1:, :-1], ring[1:, 1:], ring[:-1, 1:]], axis=2)


def _draw_tube(ax: Any, r: NDArray[np.float64], directors: NDArray[np.float64], radius: float) -> None:
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    every = max(1, -(-len(r) // _MOST_RINGS))
    facets = tube(r[::every], directors[::every], radius)
    normals = np.cross(facets[..., 3, :] - facets[..., 1, :], facets[..., 2, :] - facets[..., 0, :])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True) + 1e-300
    # Half the light comes from everywhere, so that the far side stays readable in print.
    bright = np.clip(0.70 + 0.36 * normals @ _LIGHT, 0, 1)[..., None]
    colour = np.broadcast_to(np.array(to_rgb("#c9d3e0")), normals.shape).copy()
    colour[:, :_STRIPE] = to_rgb(ANGULAR_MOMENTUM)
    shaded = (bright * colour).reshape(-1, 3)
    collection = Poly3DCollection(facets.reshape(-1, 4, 3), facecolors=shaded, edgecolors=shaded, linewidths=0.15)
    collection.set_zorder(2)
    ax.add_collection3d(collection)
    ax.plot(*r[:1].T, marker="o", markersize=4.5, color=INK, zorder=3, linestyle="none", label="beginning")


def _draw_field(ax: Any, r: NDArray[np.float64], field: NDArray[np.float64]) -> None:
    """An arrow beside the rod in the direction of the field, a third of the rod's extent long."""
    size = float(np.linalg.norm(field))
    if size == 0:
        return
    low, high = r.min(axis=0), r.max(axis=0)
    arrow = field / size * (high - low).max() / 3
    foot = np.array([high[0], high[1], (low[2] + high[2]) / 2]) - arrow / 2
    ax.quiver(*foot, *arrow, color=SECOND_FIELD, linewidth=2.0, arrow_length_ratio=0.22, zorder=1)
    ax.text(*(foot + 1.18 * arrow), r"$I\,\mathbf{B}$", color=SECOND_FIELD, fontsize=13, ha="center", va="center")


def _dress(ax: Any, r: NDArray[np.float64], elevation: float, azimuth: float) -> None:
    """Equal scales, light panes, and few ticks."""
    from matplotlib.ticker import MaxNLocator

    half, middle = _half_box(r), (r.max(axis=0) + r.min(axis=0)) / 2
    ax.set(xlim=(middle[0] - half[0], middle[0] + half[0]))
    ax.set(ylim=(middle[1] - half[1], middle[1] + half[1]), zlim=(middle[2] - half[2], middle[2] + half[2]))
    ax.set_box_aspect(half, zoom=0.9)
    ax.view_init(elev=elevation, azim=azimuth)
    for axis, name, size in zip((ax.xaxis, ax.yaxis, ax.zaxis), "xyz", half, strict=True):
        axis.set_pane_color("#fbfaf7")
        axis.line.set_color(MUTED)
        axis._axinfo["grid"].update(color=GRID, linewidth=0.5)
        axis.set_major_locator(MaxNLocator(nbins=max(2, round(6 * size / half.max())), integer=True))
        axis.set_tick_params(labelsize=8, pad=-1)
        axis.labelpad = (
            -5 if name != "z" else -2
        )  # the default leaves room for longer numbers and puts the labels outside a tall box
        axis.set_label_text(f"${name}$", color=INK)


def _draw_profiles(figure: Figure, grid: Any, rod: Rod, trajectory: int) -> None:
    curves = (
        (rod.curvature, r"curvature $\kappa$", FIRST_FIELD),
        (rod.twist, r"twist $u_3$", ANGULAR_MOMENTUM),
        (rod.tension, r"tension $\mathbf{n}\cdot\mathbf{d}_3$", CENTRE_OF_MASS),
    )
    s = np.asarray(rod.arclength, dtype=np.float64)
    first: Any = None
    for row, (values, title, colour) in enumerate(curves):
        ax: Any = figure.add_subplot(grid[row, 1], sharex=first)
        first = ax if first is None else first
        y = np.asarray(values, dtype=np.float64)[trajectory]
        ax.plot(s, y, color=colour)
        ax.set_title(title, fontsize=10, pad=3)
        ax.tick_params(labelbottom=row == 2, labelsize=8.5)
        ax.margins(x=0)
        # A constant is drawn as a level line, not as magnified round-off.
        middle, spread = float(np.nanmean(y)), float(np.nanmax(y) - np.nanmin(y))
        if spread < 1e-6 * max(1.0, abs(middle)):
            ax.set_ylim(min(0.0, 1.6 * middle) - 0.1, max(0.0, 1.6 * middle) + 0.1)
    first.set_xlim(s.min(), s.max())
    figure.axes[-1].set_xlabel("arclength $s$")
