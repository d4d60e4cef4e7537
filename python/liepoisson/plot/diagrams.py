"""Bifurcation diagrams: critical values of the integrals of a system, with the numbers of tori; classes of leaves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_number
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import listed, sequence
from liepoisson.inputs.refusals import check_kind, not_a
from liepoisson.plot.labels import label, number, plain
from liepoisson.plot.style import (
    ANGULAR_MOMENTUM,
    FIRST_FIELD,
    INK,
    MUTED,
    axes_or_new,
    house_style,
    named_once,
    new_figure,
    set_heading,
)
from liepoisson.portable import linear

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liepoisson.leaf.leaf import Leaf
    from liepoisson.tori.diagrams import Diagram
    from liepoisson.tori.fibre_regions import Region
    from liepoisson.tori.lagrange_diagrams import LagrangeDiagram

_LINES = {"elliptic": ("-", FIRST_FIELD), "hyperbolic": ("--", ANGULAR_MOMENTUM)}
_CLASSES = {"UU-": (0, 0.1), "UU+": (0, 7.2), "AA": (0, -4.6), "AB": (6.6, 6.4), "AU": (4.9, -1.2)}
"""Where the classes are named in their figure, in the middle of each."""
_POINTS = {"focus-focus": "o", "elliptic, elliptic": "s"}


@explains_its_arguments
def diagram(
    found: Diagram | Sequence[Diagram] | LagrangeDiagram,
    *,
    regions: Sequence[Region] = (),
    l3: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    r"""A bifurcation diagram: the critical values of the integrals.

    Of two integrals, and of a slice, a plane; of several slices a figure in space that can be turned; of the twisted
    Lagrange top one, too, or with `l3` the plane of H and the third integral at this value, with the boundary of the
    image and the threads that pierce it.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> axes = lp.plot.diagram(lp.tori.diagram(leaf, energy_max=2))
        >>> axes.get_xlabel(), axes.get_ylabel()
        ('$\\ell_{3}$', '$H$')
        >>> plt.close(axes.figure)

    Args:
        found: What `diagram` or `lagrange_diagram` returned; or several slices of three integrals on one leaf.
        regions: What `regions` returned for it: the number of tori is written into each that has room for it.
        l3: Of the twisted Lagrange top, the value at which the diagram is cut.

    Raises:
        ParameterError: it is no diagram, an option is meant for another kind, or slices are not of one diagram.
    """
    from liepoisson.tori.diagrams import Diagram
    from liepoisson.tori.fibre_regions import Region
    from liepoisson.tori.lagrange_diagrams import LagrangeDiagram

    slices = tuple(listed(found, "found") or ())
    for one in slices or (found,):
        if not isinstance(one, Diagram if slices else (Diagram, LagrangeDiagram)):
            raise not_a("what lp.tori.diagram or lagrange_diagram returns", one, "found", "call it first")
    regions = sequence(regions, "regions", "regions", "lp.tori.regions(found)")
    for region in regions:
        check_kind(region, Region, "regions", "what lp.tori.regions returns", "write lp.tori.regions(found)")
    with house_style():
        if slices:
            if regions or l3 is not None:
                raise ParameterError("regions, l3: several slices are drawn without them. Leave them out.")
            return _slices(slices, ax)
        if isinstance(found, Diagram):
            if l3 is not None:
                raise ParameterError("l3: only the diagram of the twisted Lagrange top is cut. Leave it out.")
            return _plane(found, regions, ax)
        if regions:
            raise ParameterError("regions: over all regular values of the twisted Lagrange top there is one torus.")
        found = cast("LagrangeDiagram", found)
        return _space(found, ax) if l3 is None else _slice(found, as_number(l3, "l3", "a number"), ax)


def _plane(found: Diagram, regions: Sequence[Region], ax: Axes | None) -> Axes:
    is_new, ax = ax is None, axes_or_new(ax, height=4.8)
    name = named_once(ax)
    for family in found.families:
        style, colour = _LINES[family.type]
        ax.plot(family.values[:, 1], family.values[:, 0], style, color=colour, linewidth=1.4, label=name(family.type))
    for kind in sorted(set(found.rest_types)):
        chosen = found.rest_values[[one == kind for one in found.rest_types]]
        mark, words = _POINTS.get(kind, "D"), name(f"{_rest(found)}: {kind}")
        ax.plot(chosen[:, 1], chosen[:, 0], mark, color=INK, markersize=4, zorder=4, linestyle="none", label=words)
    if len(found.degenerate_values):
        h, other = found.degenerate_values.T
        ax.plot(other, h, ".", color=MUTED, markersize=2, linestyle="none", label=name("degenerate, no curve"))
    ax.set(xlabel=label(found.names[1]), ylabel=label(found.names[0]))
    if "H" not in found.at:
        ax.set_ylim(top=found.energy_max)
    set_heading(ax, _heading(found.leaf, found.at), is_new=is_new)
    ax.legend(loc="upper left", bbox_to_anchor=(0.0, -0.16), ncols=2, borderaxespad=0.0)  # curves may be anywhere
    _number(found, regions, ax)
    return ax


def _number(found: Diagram, regions: Sequence[Region], ax: Axes) -> None:
    """Write the number of tori into each region, at the point that is farthest from what is drawn, where it fits."""
    from liepoisson.tori.diagrams import apart

    counted = [(region.values, region.fibre.n_tori) for region in regions if region.fibre is not None]
    if not counted:
        return
    cast("Figure", ax.get_figure(root=True)).draw_without_rendering()  # the layout decides the size of axes
    box, to_pixels = ax.bbox, ax.transData
    parts = [to_pixels.transform(one.values[:, ::-1]) for one in found.families]
    points = [to_pixels.transform(found.rest_values[:, ::-1])]
    begins = np.concatenate([np.zeros((0, 2)), *(one[:-1] for one in parts), *points])
    ends = np.concatenate([np.zeros((0, 2)), *(one[1:] for one in parts), *points])
    taken = np.zeros((0, 3))

    def room(places: Array) -> Array:
        """How far pixels are from curves, edges of the axes, and circles of other numbers."""
        edges = np.concatenate([places - box.min, box.max - places], axis=1).min(axis=1)
        curves = apart(places[:, None], begins, ends).min(axis=1, initial=np.inf)
        numbers = (linear.norm(places[:, None] - taken[:, :2], axis=2) - taken[:, 2]).min(axis=1, initial=np.inf)
        return np.minimum(np.minimum(edges, curves), numbers)

    for values, n_tori in counted:
        text = ax.annotate(str(n_tori), (0, 0), ha="center", va="center", color=INK, zorder=3)
        need = linear.norm(np.array(text.get_window_extent().size)) / 2
        place, radius = _farthest(room, to_pixels.transform(values[:, ::-1]))
        if radius < need:
            text.remove()
            continue
        text.xy = tuple(to_pixels.inverted().transform(place))
        text.set_position(text.xy)
        taken = np.concatenate([taken, [[*place, need]]])


def _farthest(room: Callable[[Array], Array], places: Array) -> tuple[Array, float]:
    """The place with most room near the best of some, by moves so short that they cross no curve."""
    rooms = room(places)
    place, best = places[rooms.argmax()], float(rooms.max())
    angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    step = best / 2
    while step > 1:
        around = place + step * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        rooms = room(around)
        if rooms.max() > best:
            place, best = around[rooms.argmax()], float(rooms.max())
            step = best / 2
        else:
            step /= 2
    return place, best


def _rest(found: Diagram) -> str:
    return "relative equilibrium" if found.at else "equilibrium"


def _slices(slices: Sequence[Diagram], ax: Any) -> Any:
    """Slices in the space of three integrals, H upwards.

    Raises:
        ParameterError: one is no slice, or of other integrals or another leaf.
    """
    first, is_new = slices[0], ax is None
    for one in slices:
        same = one.momentum.names == first.momentum.names and one.leaf.casimirs == first.leaf.casimirs
        if not one.at or not same or one.leaf.system.name != first.leaf.system.name:
            raise ParameterError(
                f"found: wanted slices of three integrals on one leaf; got {first!r} and {one!r}. Make them by "
                f'lp.tori.diagram(leaf, at={{"l3": 0.3}}).'
            )
    if ax is None:
        ax = new_figure(6.4, 5.2).add_subplot(projection="3d")
    name, names = named_once(ax), first.momentum.names

    def places(found: Diagram, values: Any) -> list[Any]:
        columns = dict(zip(found.names, values.T, strict=True))
        h, x, y = (columns.get(one, np.full(len(values), found.at.get(one))) for one in names)
        return [x, y, h]

    for found in slices:
        for family in found.families:
            style, colour = _LINES[family.type]
            line = places(found, family.values)
            ax.plot(*line, style, color=colour, linewidth=1.2, label=name(family.type))
        for kind in sorted(set(found.rest_types)):
            chosen = places(found, found.rest_values[[one == kind for one in found.rest_types]])
            mark, words = _POINTS.get(kind, "D"), name(f"{_rest(found)}: {kind}")
            ax.plot(*chosen, mark, color=INK, markersize=3, linestyle="none", label=words)
    ax.set(xlabel=label(names[1]), ylabel=label(names[2]), zlabel=label(names[0]))
    set_heading(ax, _heading(first.leaf), is_new=is_new)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 1.02), ncols=2)
    return ax


def _slice(found: LagrangeDiagram, l3: float, ax: Axes | None) -> Axes:
    is_new, ax = ax is None, axes_or_new(ax, height=4.4)
    parts = found.boundary(l3)
    for k, part in enumerate(parts):
        words = "boundary, elliptic" if k == 0 else "_boundary"
        ax.plot(part[:, 1], part[:, 0], color=FIRST_FIELD, linewidth=1.4, label=words)
    pierced = [_crossings(curve.values, l3) for curve in found.threads]
    edges = [_crossings(curve.values, l3) for curve in found.edges]
    for points, mark, words in ((edges, "s", "edge"), (pierced, "o", "thread: focus-focus")):
        places = np.concatenate([*points, np.zeros((0, 2))])
        if len(places):
            ax.plot(places[:, 1], places[:, 0], mark, color=INK, markersize=4, zorder=4, label=words)
    # The image goes to infinity: what matters lies around the edges, threads and special points
    special = np.concatenate([found.hopf_values, found.momentum(np.array([*found.sleeping_tops.values()]))])
    places = np.concatenate([*edges, *pierced])
    places = places if len(places) else special[:, [0, 2]]
    middle = places.mean(axis=0)
    half = 0.75 * np.maximum(np.ptp(places, axis=0), np.ptp(special, axis=0)[[0, 2]] / 2)
    (low, left), (high, right) = middle - half, middle + half
    ax.set(ylim=(low, high), xlim=(left, right))
    ax.set(xlabel=label(found.integrals[2]), ylabel=label("H"))
    heading = f"{_heading(found.leaf)}; class {found.leaf_class}, {label('l3')} = ${number(l3)}$"
    set_heading(ax, heading, is_new=is_new)
    ax.legend(loc="best")
    return ax


def _crossings(values: Any, l3: float) -> Any:
    """Values of H and the third integral where a curve has this l3, by straight lines between its points."""
    before, after = values[:-1], values[1:]
    meets = (before[:, 1] < l3) != (after[:, 1] < l3)
    share = ((l3 - before[meets, 1]) / (after[meets, 1] - before[meets, 1]))[:, None]
    return (before[meets] + share * (after[meets] - before[meets]))[:, [0, 2]]


def _space(found: LagrangeDiagram, ax: Any) -> Any:
    is_new = ax is None
    if ax is None:
        ax = new_figure(6.4, 5.2).add_subplot(projection="3d")
    special = np.concatenate([found.hopf_values, found.momentum(np.array([*found.sleeping_tops.values()]))])
    middle, half = special.mean(axis=0), 1.6 * np.maximum(np.ptp(special, axis=0), 0.5)
    name = named_once(ax)
    for curve in found.curves:
        near = (np.abs(curve.values - middle) <= half).all(axis=1)
        h, spin, third = np.where(near[:, None], curve.values, np.nan).T
        colour, style = (FIRST_FIELD, "-") if curve.kind == "edge" else (ANGULAR_MOMENTUM, "-")
        words = {"edge": "edge: elliptic, elliptic", "thread": "thread: focus-focus"}[curve.kind]
        ax.plot(spin, third, h, style, color=colour, label=name(words))
    for words, values, mark in (
        ("sleeping top", found.momentum(np.array([*found.sleeping_tops.values()])), "o"),
        ("Hamiltonian Hopf", found.hopf_values, "^"),
    ):
        if len(values):
            ax.plot(
                values[:, 1],
                values[:, 2],
                values[:, 0],
                mark,
                color=INK,
                markersize=4,
                label=name(words),
                linestyle="none",
            )
    ax.set(xlabel=label("l3"), ylabel=label(found.integrals[2]), zlabel=label("H"))
    set_heading(ax, f"{_heading(found.leaf)}; class {found.leaf_class}", is_new=is_new)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 1.02), ncols=2)
    return ax


def _heading(leaf: Leaf, at: Mapping[str, float] | None = None) -> str:
    held = {**leaf.casimirs, **(at or {})}
    values = ", ".join(f"{label(name)} = ${number(value)}$" for name, value in held.items())
    return "\n".join(filter(None, [plain(leaf.system.name), values]))


@explains_its_arguments
def leaf_classes(*, ax: Axes | None = None) -> Axes:
    r"""The six classes of leaves of the twisted Lagrange top, in the plane of their two numbers.

    $C_1 = c_1/c_3^{2/3}$ and $C_2 = c_2/c_3^{5/6}$, see `liepoisson.tori.lagrange_leaves`.
    The walls are $e^2c^2 - 4c^3 - 4e^3 + 18ec - 27 = 0$ with $c = \pm C_2$, $e = (C_1 - C_2^2)/2$, where a sleeping top
    changes its stability, and $C_1 = 3 + \tfrac43C_2^2$ for $|C_2| < 3$, where two threads exchange their ends.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> axes = lp.plot.leaf_classes()
        >>> sorted({text.get_text() for text in axes.texts})
        ['AA', 'AB', 'AU', 'BU', 'UU+', 'UU-']
        >>> plt.close(axes.figure)
    """
    with house_style():
        is_new, ax = ax is None, axes_or_new(ax, height=4.6)
        for sign in (1, -1):
            for root in (np.linspace(-4, -0.12, 4000), np.linspace(0.12, 4, 4000)):
                # a double root r: r^3 + e r^2 + c r + 1 = 0 and 3 r^2 + 2 e r + c = 0
                e = (1 - 2 * root**3) / root**2
                c = -3 * root**2 - 2 * e * root
                words = "a sleeping top changes its stability" if sign == 1 and root[0] < 0 else "_"
                ax.plot(sign * c, e, color=FIRST_FIELD, linewidth=1.4, label=words)
        c = np.linspace(-3, 3, 201)
        ax.plot(c, (3 + c**2 / 3) / 2, "--", color=ANGULAR_MOMENTUM, linewidth=1.4, label="two threads exchange ends")
        for name, (x, y) in _CLASSES.items():
            for side in (1, -1) if x else (1,):
                ax.annotate(name, (side * x, y), ha="center", va="center", color=INK)
        for side in (1, -1):  # the narrow ones
            arrow = {"arrowstyle": "-", "color": MUTED, "linewidth": 0.8}
            ax.annotate(
                "BU", (side * 4.2, 4.5), (side * 2.6, 5.2), ha="center", va="center", color=INK, arrowprops=arrow
            )
        ax.set(xlim=(-8, 8), ylim=(-6, 12))
        ax.set(xlabel="$C_2$", ylabel=r"$e = (C_1 - C_2^2)/2$")
        set_heading(ax, "Leaves of the twisted Lagrange top", is_new=is_new)
        ax.legend(loc="lower right")
    return ax
