r"""Figures of one orbit: its vectors in time and on their spheres, and how well the invariants are kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import as_array, as_count
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import at_times, by_name
from liepoisson.inputs.refusals import not_a
from liepoisson.numeric.run import KeepsInvariants
from liepoisson.numeric.systems import has_invariants
from liepoisson.plot.labels import label, vector_of, vector_symbol
from liepoisson.plot.section import heading_of
from liepoisson.plot.style import (
    ANGULAR_MOMENTUM,
    FIRST_FIELD,
    GRID,
    INK,
    MUTED,
    SECOND_FIELD,
    SEQUENCE,
    check_title_of_figure,
    house_style,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

    from liepoisson.noise.noisy_orbits import NoisyOrbits
    from liepoisson.numeric.integrate import Orbit

FloatArray: TypeAlias = NDArray[np.float64]
OrbitLike: TypeAlias = "Orbit | NoisyOrbits | Dataset"

_COLOURS = {"l": ANGULAR_MOMENTUM, "alpha": FIRST_FIELD, "beta": SECOND_FIELD}
_TINTS = (-0.45, 0.0, 0.5)
"""Towards ink (negative) or white (positive), for the first, second and third component of a vector."""
_AZIMUTH, _ELEVATION = np.radians(35.0), np.radians(24.0)
"""From where the spheres are seen: all three axes of the body point towards the reader."""
_LARGEST = 1e150
"""Size of numbers that are drawn at most: their squares are still finite."""
_CONSTANT_LENGTH = 1e-6
"""Relative change of a length below which the vector is drawn on a sphere; far above errors, far below motion."""


_MOST_CURVES, _MOST_ROWS = 6, 8
"""Curves of a panel, as many as there are colours, and vectors of a figure: the largest ones are drawn."""


@explains_its_arguments
def orbit(
    run: OrbitLike,
    *,
    invariants: Mapping[str, ArrayLike] | None = None,
    trajectory: int = 0,
    title: str | None = None,
) -> Figure:
    r"""One orbit: a row for each vector of the state, and one for the invariants.

    Left, the components against time; right, the path of the vector in the body frame, seen from the direction
    (0.75, 0.52, 0.41).  A vector of constant length is drawn on its sphere, the far side paler; another one inside
    the circle of its greatest length, paler where it is farther away.  The dot is the start.  The last row is the
    largest change of each invariant so far, $\max_{s\le t}|f(s) - f(0)|$.

    Of a vector with more than six components those with the largest values are drawn, of more than eight vectors the
    largest ones, and of more than six invariants those that change most; the figure says so.

    Example:
        >>> run = lp.integrate(lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}, t_end=20)
        >>> figure = lp.plot.orbit(run)
        >>> print(*(axes.get_ylabel() for axes in figure.axes[:6:2]))  # a row for each vector; the invariants are below
        $\ell$ $\alpha$ $\beta$

    Args:
        run: Result of `integrate`, or its Dataset.
        invariants: Values along the trajectory, shape (time,), by name, for the last row.  By default those of
            `Orbit.invariants`; a Dataset has none.  `{}` leaves the row out.
        trajectory: Which one; a figure shows one.
        title: Above the figure; by default the name of the system, and the values of energy and Casimirs.

    Returns:
        A figure that no window system knows of; `liepoisson.plot.save_figure` writes it.

    Raises:
        ShapeError: an invariant does not have shape (time,).
        ParameterError: there is no such trajectory, it has fewer than two states, or numbers beyond 1e150.
    """
    check_title_of_figure(title)
    time, state, components = _arrays(run, trajectory)
    curves = _changes(_own_invariants(run, trajectory) if invariants is None else invariants, run, len(time))
    found = _vectors(components)
    vectors = _largest(found, {name: state[:, columns] for name, columns in found.items()}, _MOST_ROWS)
    heading, *level = (heading_of(run, trajectory) if title is None else title).split("\n", 1)
    if heading and len(vectors) < len(found):
        heading += f" ({_note(len(vectors), len(found))})"
    with house_style():
        figure, rows, last = _panels([len(columns) for columns in vectors.values()], bool(curves))
        for k, (name, columns) in enumerate(vectors.items()):
            colour = _COLOURS.get(name, SEQUENCE[k % len(SEQUENCE)])
            in_time, in_space = rows[k]
            _in_time(in_time, time, state[:, columns], [components[c] for c in columns], colour)
            sign = vector_symbol(components[columns[0]])
            in_time.set_ylabel(f"${sign}$", rotation=0, ha="right", va="center")
            if in_space is not None:
                _in_space(in_space, state[:, columns], sign, colour)
        if last is not None:
            _draw_changes(last, time, curves)
        (last or rows[-1][0]).set_xlabel(r"$t$")
        if heading:
            figure.suptitle("\n".join([heading, *level]), x=0.012, ha="left", fontsize=12.5, color=INK)
    return figure


def _arrays(run: OrbitLike, trajectory: int) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Times, states and names of the components, up to where the trajectory ended."""
    if not hasattr(run, "state") or not hasattr(run, "time"):
        raise not_a("what integrate returns", run, "run", "try integrate(system, starts, t_end=100)")
    states, time = np.asarray(run.state, np.float64), np.asarray(run.time, np.float64)
    state = states[as_count(trajectory, "trajectory", most=len(states) - 1)]
    good = np.isfinite(state).all(axis=1)
    if good.sum() < 2:
        raise ParameterError(
            f"a figure must have at least two states; trajectory {trajectory} has {good.sum()}. "
            "Ask for more times, or look at its outcome."
        )
    if (size := np.abs(state[good]).max()) > _LARGEST:
        raise ParameterError(
            f"a figure must have numbers up to {_LARGEST:g}; trajectory {trajectory} reaches {size:.3g}. Measure the "
            "states in larger units."
        )
    names = getattr(run, "components", None)
    if names is None:
        names = np.asarray(getattr(run, "component"), str)  # noqa: B009  # a Dataset's coordinate
    return time[good], state[good], tuple(map(str, names))


def _own_invariants(run: OrbitLike, trajectory: int) -> Mapping[str, ArrayLike]:
    """What a result knows to be constant along one of its trajectories."""
    if not isinstance(run, KeepsInvariants) or not has_invariants(run.system):
        return {}
    return {name: values[trajectory] for name, values in run.invariants.items()}


def _largest(found: Mapping[str, Any], values: Mapping[str, FloatArray], most: int) -> dict[str, Any]:
    """Those with the largest values, in the order in which they came."""
    sizes = {name: float(np.nanmax(np.abs(values[name]), initial=0.0)) for name in found}
    kept = sorted(found, key=lambda name: -sizes[name])[:most]
    return {name: item for name, item in found.items() if name in kept}


def _note(n: int, of: int) -> str:
    return f"{n} largest of {of}"


def _changes(invariants: Mapping[str, ArrayLike], run: OrbitLike, n: int) -> dict[str, FloatArray]:
    """The largest change of each invariant so far."""
    times, changes = np.asarray(run.time), dict[str, FloatArray]()
    n_times = len(times)
    given = by_name(invariants, "invariants", "values along the orbit", '{"K": values}')
    for name, values in given.items():
        what = f"invariants[{name!r}]"
        curve = as_array(at_times(values, what, times.tolist()), what)
        if curve.shape != (n_times,):
            raise ShapeError(
                f"invariants[{name!r}] must have shape (time,), here ({n_times},); got {curve.shape}. "
                "Take those of one trajectory?"
            )
        changes[name] = np.maximum.accumulate(np.abs(curve - curve[0])[:n])
    return changes


def _vectors(components: Sequence[str]) -> dict[str, list[int]]:
    """The places of the components of each vector: l1, l2, l3 belong to l."""
    places: dict[str, list[int]] = {}
    for k, component in enumerate(components):
        places.setdefault(vector_of(component), []).append(k)
    return places


def _panels(sizes: Sequence[int], with_last: bool) -> tuple[Figure, list[tuple[Axes, Axes | None]], Axes | None]:
    """Axes for each vector, in time and (with three components) in space, and those below them."""
    from liepoisson.plot.style import new_figure

    n = len(sizes)
    figure = new_figure(8.6, 0.5 + 2.05 * n + (1.55 if with_last else 0.0))
    heights = [2.05] * n + ([1.45] if with_last else [])
    grid = figure.add_gridspec(n + with_last, 2, width_ratios=(2.8, 1.0), height_ratios=heights)
    rows: list[tuple[Axes, Axes | None]] = []
    for k, size in enumerate(sizes):
        place = grid[k, 0] if size == 3 else grid[k, :]
        in_time = figure.add_subplot(place, sharex=rows[0][0] if rows else None)
        in_space = figure.add_subplot(grid[k, 1]) if size == 3 else None
        in_time.tick_params(labelbottom=k == n - 1 and not with_last)
        rows.append((in_time, in_space))
    last = figure.add_subplot(grid[n, 0 if 3 in sizes else slice(None)], sharex=rows[0][0]) if with_last else None
    return figure, rows, last


def _in_time(ax: Axes, time: FloatArray, vector: FloatArray, components: Sequence[str], colour: str) -> None:
    colours = [_mixed(colour, tint) for tint in _TINTS] if len(components) == 3 else SEQUENCE
    curves = _largest({c: c for c in components}, dict(zip(components, vector.T, strict=True)), _MOST_CURVES)
    for k, component in enumerate(curves):
        values = vector[:, components.index(component)]
        ax.plot(time, values, color=colours[k % len(colours)], linewidth=1.0, label=label(component))
    ax.set_xlim(time[0], time[-1])
    ax.legend(ncols=len(curves), loc="lower right", bbox_to_anchor=(1.0, 0.99), handlelength=1.2)
    if len(curves) < len(components):
        _write_note(ax, _note(len(curves), len(components)))


def _write_note(ax: Axes, words: str) -> None:
    """Small, above the axes, where the legend leaves room."""
    ax.text(0.0, 1.02, words, transform=ax.transAxes, ha="left", va="bottom", color=MUTED, fontsize=9)


def _in_space(ax: Axes, path: FloatArray, sign: str, colour: str) -> None:
    """The path of a vector in parallel projection, the nearer the darker."""
    from matplotlib.collections import LineCollection

    lengths = np.linalg.norm(path, axis=1)
    radius = float(lengths.max())
    on_sphere = radius > 0 and np.ptp(lengths) < _CONSTANT_LENGTH * radius
    size = radius or 1.0
    _draw_ball(ax, size, graticule=on_sphere)
    points = path @ _view()
    nearness = (points[1:, 2] + points[:-1, 2]) / (2 * size)
    strength = np.where(nearness >= 0, 0.9, 0.22) if on_sphere else 0.25 + 0.65 * (1 + nearness) / 2
    order = np.argsort(nearness, kind="stable")  # what is nearer is drawn over what is farther
    segments = np.stack([points[:-1, :2], points[1:, :2]], axis=1)[order]
    rgba: Any = np.column_stack(
        [np.tile(_rgb(colour), (len(order), 1)), np.broadcast_to(strength, len(points) - 1)[order]]
    )
    lines: Any = segments
    ax.add_collection(LineCollection(lines, colors=rgba, linewidths=0.8, zorder=3))
    ax.plot(*points[0, :2], "o", color=INK, markersize=3.2, zorder=5)
    length = f"$|{sign}| = {radius:.3g}$"
    words = length if on_sphere else f"max {length}"
    ax.text(0.5, -0.02, words, transform=ax.transAxes, ha="center", va="top", color=MUTED, fontsize=9)


def _draw_ball(ax: Axes, radius: float, *, graticule: bool) -> None:
    """The outline of a ball, its axes, and the graticule of its near side."""
    angle = np.linspace(0, 2 * np.pi, 181)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    ax.plot(*(radius * ring[:, :2].T), color=MUTED, linewidth=0.7, linestyle="-" if graticule else (0, (4, 3)))
    if graticule:
        for circle in _graticule(ring):
            points = radius * circle @ _view()
            points[points[:, 2] < 0] = np.nan
            ax.plot(*points[:, :2].T, color=GRID, linewidth=0.7, zorder=1)
    for k, axis in enumerate(_view()):
        tip = 1.16 * radius * axis[:2]
        ax.plot([0, tip[0]], [0, tip[1]], color=MUTED, linewidth=0.6, zorder=2)
        ax.text(1.12 * tip[0], 1.12 * tip[1], str(k + 1), color=MUTED, fontsize=8.5, ha="center", va="center", zorder=6)
    ax.set(aspect="equal", xlim=(-1.32 * radius, 1.32 * radius), ylim=(-1.32 * radius, 1.32 * radius))
    ax.set_axis_off()


def _graticule(ring: FloatArray) -> list[FloatArray]:
    """Six meridians and five parallels of the unit sphere, about the third axis."""
    meridians = [
        np.stack([ring[:, 0] * np.cos(a), ring[:, 0] * np.sin(a), ring[:, 1]], axis=1)
        for a in np.linspace(0, np.pi, 6, endpoint=False)
    ]
    latitudes = np.radians([-60, -30, 0, 30, 60])
    return meridians + [np.cos(b) * ring + np.array([0, 0, np.sin(b)]) for b in latitudes]


def _view() -> FloatArray:
    """The unit vectors of the body as rows: to the right, up, and towards the reader."""
    right = np.array([-np.sin(_AZIMUTH), np.cos(_AZIMUTH), 0])
    near = np.array([*(np.cos(_ELEVATION) * np.array([np.cos(_AZIMUTH), np.sin(_AZIMUTH)])), np.sin(_ELEVATION)])
    return np.stack([right, np.cross(near, right), near], axis=1)


def _draw_changes(ax: Axes, time: FloatArray, changes: Mapping[str, FloatArray]) -> None:
    """Whole decades of changes; nothing is drawn where there is none."""
    shown = _largest(changes, changes, _MOST_CURVES)
    for k, (name, change) in enumerate(shown.items()):
        positive = np.where(change > 0, change, np.nan)
        words = label(name)
        ax.plot(time, positive, color=SEQUENCE[(k + 3) % len(SEQUENCE)], linewidth=1.1, label=words)
    ax.set_yscale("log")
    ax.yaxis.set_minor_formatter("")
    ax.set_ylabel("largest\nchange", linespacing=0.95)
    sizes = np.concatenate([change[change > 0] for change in shown.values()])
    if sizes.size:
        ax.set_ylim(10 ** np.floor(np.log10(sizes.min()) - 0.01), 10 ** np.ceil(np.log10(sizes.max()) + 0.01))
    else:  # a logarithmic axis without data has no limits of its own
        ax.set_ylim(1e-17, 1e-15)
    if len(shown) < len(changes):
        _write_note(ax, _note(len(shown), len(changes)))
    ax.legend(ncols=len(shown), loc="lower right", bbox_to_anchor=(1.0, 0.98), handlelength=1.2)


def _rgb(colour: str) -> tuple[float, float, float]:
    from matplotlib.colors import to_rgb

    return to_rgb(colour)


def _mixed(colour: str, tint: float) -> tuple[float, float, float]:
    other = np.ones(3) if tint > 0 else np.array(_rgb(INK))
    red, green, blue = (1 - abs(tint)) * np.array(_rgb(colour)) + abs(tint) * other
    return float(red), float(green), float(blue)
