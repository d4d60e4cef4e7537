r"""Figures of rigid bodies: an elastic rod with its twist, field and profiles, and where the sleeping top is stable."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_number, as_positive
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import listed
from liepoisson.plot.style import (
    ANGULAR_MOMENTUM,
    CENTRE_OF_MASS,
    FIRST_FIELD,
    GRID,
    INK,
    MUTED,
    SECOND_FIELD,
    SEQUENCE,
    axes_or_new,
    house_style,
    new_figure,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liepoisson.rigid_body.rod import Rod

FloatArray: TypeAlias = NDArray[np.float64]

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
_WIDE = 3.0
"""Width of a word over its height, in parts of the axes."""


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
    if radius is not None:
        as_positive(radius, "radius", "a positive length", example=0.1)
    for name, angle in (("elevation", elevation), ("azimuth", azimuth)):
        if not np.isfinite(as_number(angle, name, "an angle in degrees")):
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


def _half_box(r: FloatArray) -> FloatArray:
    """Half the sides of the box about a rod; a flat one still needs some depth."""
    extent = np.ptp(r, axis=0)
    return np.maximum(extent / 2, 0.12 * extent.max()) + 0.06 * extent.max()


def _width(r: FloatArray, elevation: float, azimuth: float) -> float:
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


def tube(r: FloatArray, directors: FloatArray, radius: float) -> FloatArray:
    r"""Corners of the facets of a tube, $r + \rho(\cos\varphi\, d_1 + \sin\varphi\, d_2)$.

    Of the centre line, shape (point, 3), and the directors, shape (point, 3, 3): shape (point - 1, facet, corner, 3).
    d1 points to the middle of the first four facets, the stripe.
    """
    angles = 2 * np.pi * (np.arange(_FACETS + 1) - _STRIPE / 2) / _FACETS
    spokes = np.cos(angles)[:, None] * directors[:, None, 0] + np.sin(angles)[:, None] * directors[:, None, 1]
    ring = r[:, None] + radius * spokes
    return np.stack([ring[:-1, :-1], ring[1:, :-1], ring[1:, 1:], ring[:-1, 1:]], axis=2)


def _draw_tube(ax: Any, r: FloatArray, directors: FloatArray, radius: float) -> None:
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


def _draw_field(ax: Any, r: FloatArray, field: FloatArray) -> None:
    """An arrow beside the rod in the direction of the field, a third of the rod's extent long."""
    size = float(np.linalg.norm(field))
    if size == 0:
        return
    low, high = r.min(axis=0), r.max(axis=0)
    arrow = field / size * (high - low).max() / 3
    foot = np.array([high[0], high[1], (low[2] + high[2]) / 2]) - arrow / 2
    ax.quiver(*foot, *arrow, color=SECOND_FIELD, linewidth=2.0, arrow_length_ratio=0.22, zorder=1)
    ax.text(*(foot + 1.18 * arrow), r"$I\,\mathbf{B}$", color=SECOND_FIELD, fontsize=13, ha="center", va="center")


def _dress(ax: Any, r: FloatArray, elevation: float, azimuth: float) -> None:
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


@explains_its_arguments
def sleeping_diagram(
    twists: Sequence[float] = (0.0, 1.0), *, spin: float = 6.0, field: float = 6.0, ax: Axes | None = None
) -> Axes:
    r"""Where the sleeping top has a stable spectrum, in the plane of its spin and its field.

    The axes are $p = \ell_3$ and $q = I_1(a_3\alpha_3 + b_3\beta_3)$; each $u = \epsilon a_3^2I_1^2\beta_3$ has a
    curve, on which $Q(\lambda) = \lambda^3 + p\lambda^2 + q\lambda + u$ has a double root m: $p = u/m^2 - 2m$,
    $q = m^2 - 2u/m$. The region in which Q has three real roots is shaded for the last of them. For $u = 0$
    the curve is the parabola $p^2 = 4q$ of the ordinary top, which is stable outside of it.  The words say on which
    side the spectrum of that last top is stable, and lie where no curve crosses them.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> axes = lp.plot.sleeping_diagram(twists=[0, 1, 2])
        >>> print(axes.get_xlabel(), "and", axes.get_ylabel())
        spin $\ell_3$ and field $I_1(a_3\alpha_3 + b_3\beta_3)$
        >>> plt.close(axes.figure)

    Args:
        twists: The values of u.
        spin: The plane is drawn for $|p|$ up to this.
        field: And for $|q|$ up to this.

    Raises:
        ParameterError: no twist, or a number that is not finite.
    """
    try:
        values = [as_number(u, "twists", "a number") for u in listed(twists, "twists") or ()]
        sound = bool(values) and np.isfinite([*values, spin, field]).all() and spin > 0 and field > 0
    except (TypeError, ValueError):  # no sequence, or no numbers
        values, sound = twists, False
    if not sound:
        raise ParameterError(
            f"twists, spin and field must be finite numbers, at least one twist and positive ranges; got twists = "
            f"{values!r:.80}, spin = {spin!r:.40}, field = {field!r:.40}."
        )
    with house_style():
        ax = axes_or_new(ax, width=5.6, height=4.4)
        _shade(ax, values[-1], spin, field)
        for u, colour in zip(values, SEQUENCE * len(values), strict=False):
            _boundary(ax, u, colour, max(spin, field))
        ax.set(xlim=(-spin, spin), ylim=(-field, field))
        ax.set(xlabel=r"spin $\ell_3$", ylabel=r"field $I_1(a_3\alpha_3 + b_3\beta_3)$")
        ax.legend(loc="upper center")
        for stable, word in ((True, "stable spectrum"), (False, "unstable")):
            if (place := _clear_place(values, spin, field, stable=stable)) is not None:
                words = f"{word}\nfor $u = {values[-1]:g}$"
                ax.text(*place, words, transform=ax.transAxes, color=INK, style="italic", ha="center", va="center")
    return ax


def _clear_place(values: Sequence[float], spin: float, field: float, *, stable: bool) -> tuple[float, float] | None:
    """The point of the region farthest from all curves, the edges and the legend, in parts of the axes."""
    # Middles of cells; a word is about three times as wide as high, so distances across count a third.
    x, y = (grid.ravel() for grid in np.meshgrid((np.arange(60) + 0.5) / 60, (np.arange(60) + 0.5) / 60))
    signs = np.array([_discriminant((2 * x - 1) * spin, (2 * y - 1) * field, u) > 0 for u in values])
    wanted = signs[-1] == stable
    if not wanted.any():
        return None
    edge = np.minimum(np.minimum(x, 1 - x) / _WIDE, np.minimum(y, 1 - y))
    legend = (np.abs(x - 0.5) < 0.3) & (y > 0.82)
    room = np.zeros(len(x))
    for k in np.flatnonzero(wanted & ~legend):
        other = (signs != signs[:, k : k + 1]).any(axis=0) | legend
        distance = np.maximum(np.abs(x[other] - x[k]) / _WIDE, np.abs(y[other] - y[k]))
        room[k] = min(edge[k], distance.min(initial=np.inf))
    best = int(np.argmax(room))
    return float(x[best]), float(y[best])


def _discriminant(p: FloatArray, q: FloatArray, u: float) -> FloatArray:
    """Positive where Q has three real roots; without twist one is 0, and the others are those of the quadratic."""
    return 18 * p * q * u - 4 * p**3 * u + p**2 * q**2 - 4 * q**3 - 27 * u**2 if u else p**2 - 4 * q


def _shade(ax: Axes, u: float, spin: float, field: float) -> None:
    p, q = np.meshgrid(np.linspace(-spin, spin, 801), np.linspace(-field, field, 801))
    ax.contourf(p, q, _discriminant(p, q, u), levels=[0.0, np.inf], colors=[FIRST_FIELD], alpha=0.12)


def _boundary(ax: Axes, u: float, colour: str, extent: float) -> None:
    """The curve of double roots, both branches; the root itself can reach the size of the plane."""
    root = np.geomspace(1e-3, 4 * extent, 4000)
    for m, label in ((-root, rf"$u = \epsilon a_3^2 I_1^2\beta_3 = {u:g}$"), (root, None)):
        ax.plot(u / m**2 - 2 * m, m**2 - 2 * u / m, label=label, color=colour, linestyle="-" if u else "--")
