r"""Figures of sweeps: a curve with its band along one axis, a map over two."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.plot.labels import label, plain, with_formulas
from liepoisson.plot.style import INK, MUTED, SEQUENCE, as_colour, axes_or_new, house_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from liepoisson.sweeps.result import Sweep
    from liepoisson.sweeps.spec import Axis

FloatArray: TypeAlias = NDArray[np.float64]

_UNDECIDED = 0.25
"""Share of undecided orbits above which the colour of a chaotic fraction is covered: it may be off by as much."""


_LONGEST_LINE = 80
"""Characters of what is held that fit above the axes."""


@explains_its_arguments
def sweep(
    result: Sweep,
    *,
    confidence: float = 0.95,
    vmin: float | None = None,
    vmax: float | None = None,
    show_levels: bool = True,
    label: str | None = None,
    colour: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    r"""What a sweep found: a curve with its confidence band for one axis, a map with a colour bar for two.

    Above the curve of a chaotic fraction a dotted line counts the undecided orbits as chaotic, too.

    In a map dark is small: integrable cases are dark lines.  A point fills the rectangle halfway to its neighbours on
    the grid, and as far beyond the ends of the axes; where it was refined, those of the finer level lie above.  White
    crosses cover points of a chaotic fraction where more than a quarter of the orbits is undecided: their colour counts
    these as not chaotic.  What is not computed is hatched; below a curve crosses mark its points.  Above the axes
    stands how many there are, and above a new figure what is held and the share of orbits that are undecided.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> found = lp.sweep(system="twisted-top", parameters={"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
        ...     axes={"epsilon": [0, 0.5, 1]}, n_starts=4, t_end=50)
        >>> axes = lp.plot.sweep(found)
        >>> print(f"{axes.get_ylabel()} against {axes.get_xlabel()}")
        mean $\lambda(50)$, in inverse time
        (band: 95% interval) against $\epsilon$
        >>> plt.close(axes.figure)

    Args:
        result: Result of `liepoisson.sweep`.
        confidence: Coverage of the band (Wilson's interval of a fraction, Student's of a mean over the starts).
        vmin: Lower end of the colours, by default 0 or the least value.
        vmax: Upper end, by default 1 for a fraction or the largest value.
        show_levels: Mark the points that refinement added: ticks below a curve, dots in a map.
        label: Name of the curve in a legend.
        colour: Of the curve.

    Returns:
        The axes.
    """
    heading = None if ax is not None else "\n".join(_heading(result))
    with house_style():
        if len(result.spec.axes) == 1:
            ax = axes_or_new(ax)
            _curve(result, ax, confidence, show_levels=show_levels, label=label, colour=as_colour(colour))
        else:
            ax = axes_or_new(ax, width=5.8, height=4.4)
            _map(result, ax, vmin, vmax, show_levels=show_levels)
        if heading:
            ax.figure.suptitle(heading, x=0.012, ha="left", fontsize=9.5, color=INK)
        missing = _not_computed(result)
        if missing.any():
            words = f"{missing.sum()} of {len(missing)} points not computed"
            ax.text(1.0, 1.02, words, transform=ax.transAxes, ha="right", va="bottom", color=MUTED, fontsize=9)
    return ax


def _heading(result: Sweep) -> list[str]:
    """What is held, and which share of all orbits is undecided."""
    lines = [part for line in result.held for part in wrap(plain(line), _LONGEST_LINE)]
    known = result.undecided_fraction[np.isfinite(result.undecided_fraction)] if result.spec.is_verdict else []
    return [*lines, f"undecided: {100 * np.mean(known):.3g}% of all orbits"] if len(known) else lines


def _not_computed(result: Sweep) -> NDArray[np.bool_]:
    """The points of which some start was not computed, as the sweep was interrupted or had a limit of time."""
    from liepoisson.sweeps.tasks import NOT_COMPUTED

    return np.asarray((result.outcome_code == NOT_COMPUTED).any(axis=1))


def axis_label(axis: Axis) -> str:
    r"""How an axis is called: its label, or its name as mathematical text."""
    if axis.label is not None:
        return with_formulas(axis.label)
    return "energy $H$" if axis.name == "energy" else label(axis.name)


def statistic_label(result: Sweep) -> str:
    """What the values are, with their unit."""
    t = f"{result.spec.t_end:g}"
    if result.spec.is_verdict:
        return rf"chaotic fraction at $t = {t}$"
    return rf"mean $\lambda({t})$, in inverse time" if result.spec.is_exponent else "mean value"


def _curve(
    result: Sweep, ax: Axes, confidence: float, *, show_levels: bool, label: str | None, colour: str | None
) -> None:
    order = np.argsort(result.points[:, 0])
    x, y = result.points[order, 0], result.statistic[order]
    low, high = (bound[order] for bound in result.interval(confidence))
    colour = SEQUENCE[1] if colour is None else colour
    ax.fill_between(x, low, high, color=colour, alpha=0.22, linewidth=0, zorder=1)
    ax.plot(x, y, color=colour, marker="o", markersize=3.2, linewidth=1.1, label=label, zorder=3)
    # They mark their places, and keep the axis as long as it will be.
    if len(missing := x[_not_computed(result)[order]]):
        style: dict[str, Any] = {
            "color": MUTED,
            "markersize": 3.5,
            "markeredgewidth": 0.7,
            "transform": ax.get_xaxis_transform(),
        }
        ax.plot(missing, np.full(len(missing), 0.03), "x", **style)
    added = result.level[order] > 0
    if show_levels and added.any():
        transform = ax.get_xaxis_transform()
        ax.plot(x[added], np.full(added.sum(), 0.015), "|", color=MUTED, markersize=5, transform=transform, zorder=2)
    if result.spec.is_verdict:
        most = y + result.undecided_fraction[order]
        ax.plot(x, most, color=colour, linewidth=0.9, linestyle=(0, (1, 2)), zorder=2)
        ax.set_ylim(-0.03, 1.03)
    ax.set_xlabel(axis_label(result.spec.axes[0]))
    dotted = "; dotted: with the undecided" if result.spec.is_verdict else ""
    ax.set_ylabel(f"{statistic_label(result)}\n(band: {100 * confidence:g}% interval{dotted})")


def _map(result: Sweep, ax: Axes, vmin: float | None, vmax: float | None, *, show_levels: bool) -> None:
    is_fraction = result.spec.is_verdict
    xs, ys, image = lattice_image(result)
    finite = image[np.isfinite(image)]
    low = vmin if vmin is not None else min(0.0, float(finite.min())) if finite.size else 0.0
    high = vmax if vmax is not None else 1.0 if is_fraction else float(finite.max()) if finite.size else 1.0
    ax.set_facecolor("white")
    ax.patch.set(hatch="////", edgecolor=MUTED, linewidth=0)
    mesh = ax.pcolormesh(xs, ys, np.ma.masked_invalid(image).T, cmap="magma", vmin=low, vmax=high, rasterized=True)
    if is_fraction:
        _cover_the_undecided(ax, xs, ys, lattice_image(result, result.undecided_fraction)[2] > _UNDECIDED)
    if show_levels and result.level.any():
        added = result.points[result.level > 0]
        ax.plot(*added.T, linestyle="none", marker="o", markersize=0.9, markeredgewidth=0, color=MUTED, rasterized=True)
    ax.grid(visible=False)
    ax.set(xlabel=axis_label(result.spec.axes[0]), ylabel=axis_label(result.spec.axes[1]))
    bar: Any = ax.figure.colorbar(mesh, ax=ax, pad=0.02)
    bar.set_label(statistic_label(result), color=INK)
    bar.outline.set_linewidth(0.5)


def _cover_the_undecided(ax: Axes, xs: FloatArray, ys: FloatArray, undecided: NDArray[np.bool_]) -> None:
    """Hatch the cells where too many orbits are undecided, with a legend above the axes."""
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    if not undecided.any():
        return
    cells = [_corners(xs[i : i + 2], ys[j : j + 2]) for i, j in np.argwhere(undecided)]
    style: dict[str, Any] = {"hatch": "xxxx", "edgecolor": "white", "linewidth": 0}
    ax.add_collection(PolyCollection(cells, facecolor="none", label="undecided", **style), autolim=False)
    mark = Patch(facecolor=colormaps["magma"](0.3), label="more than 1/4 of the orbits undecided", **style)
    ax.legend(handles=[mark], loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)


def _corners(x: FloatArray, y: FloatArray) -> list[tuple[float, float]]:
    return [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]


def lattice_image(result: Sweep, values: FloatArray | None = None) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The values on the whole lattice of a sweep over two axes: each point fills what is around it, fine above coarse.

    Edges of the cells along each axis, and the values, shape (first axis, second axis): by default the statistic.
    """
    unit = 2 ** (result.spec.refine.levels if result.spec.refine and result.level.any() else 0)
    scale = 2 ** (result.spec.refine.levels if result.spec.refine else 0) // unit
    shape = tuple((n - 1) * unit + 1 for n in result.spec.shape)
    image, values = np.full(shape, np.nan), result.statistic if values is None else values
    for k in range(int(result.level.max()) + 1):
        half = unit // 2**k / 2
        for point in np.flatnonzero(result.level == k):
            i, j = (place // scale for place in result.places[point])
            rows, columns = (
                slice(max(0, int(np.ceil(m - half))), int(np.floor(m + half - (half >= 1) * 1e-9)) + 1) for m in (i, j)
            )
            image[rows, columns] = values[point]
    edges = [_edges(np.asarray(axis.values), unit) for axis in result.spec.axes]
    return edges[0], edges[1], image


def _edges(values: FloatArray, unit: int) -> FloatArray:
    """Edges of the cells of the lattice: halfway between its points, and as far beyond its ends."""
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    fine = np.interp(np.arange((len(values) - 1) * unit + 1) / unit, np.arange(len(values)), values)
    middle = (fine[1:] + fine[:-1]) / 2
    return np.concatenate([[2 * fine[0] - middle[0]], middle, [2 * fine[-1] - middle[-1]]])
