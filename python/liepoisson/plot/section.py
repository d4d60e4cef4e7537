r"""Figures of surfaces of section: points in a plane of two coordinates, a colour for each trajectory."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from textwrap import wrap
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ExpressionError, ParameterError, ShapeError
from liepoisson.formula.scalars import as_array, as_count, as_number, as_positive
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import as_scalar, listed
from liepoisson.inputs.names import ANGLE
from liepoisson.inputs.refusals import check_choice, not_a
from liepoisson.numeric.systems import has_functions
from liepoisson.plot.labels import formula, label, name_of_system, number, plain
from liepoisson.plot.style import (
    as_colours,
    axes_or_new,
    check_title_of_figure,
    house_style,
    new_figure,
    set_heading,
)
from liepoisson.poincare.section_arguments import modulus_of_surface
from liepoisson.poincare.section_coordinates import (
    Levels,
    component_axes,
    default_axes,
    figure_axes,
    levels_of,
    levels_through,
)
from liepoisson.poincare.section_sheets import DIRECTION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from xarray import Dataset

    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.system import System
    from liepoisson.poincare.section import Section as SectionResult

FloatArray: TypeAlias = NDArray[np.float64]
SectionLike: TypeAlias = "SectionResult | Dataset"

_GOOD_COVERAGE = 0.14
"""Share of the axes that points may cover in all, were none above another."""
_LARGEST, _SMALLEST = 2.6, 0.25
"""Diameters of points in printer's points."""
_ROUND_OFF = 1e-9
"""Relative width of a figure below which it would show nothing but errors."""
_TURNED = 100
"""States at which it is tried whether a coordinate is an angle."""
_PLACES = 20
"""Values at which it is tried for each of them."""
_BY_CHANCE = 0.01
"""A gap between angles counts if independent ones would leave one as large at most this often."""
_SHOWN = "liepoisson_shown"
"""The attribute of the dots of a trajectory that says what the two axes show."""
_LONGEST_LINE = 60
"""Characters of a title that fit above the axes of a new figure; of a formula, characters of its text."""


@explains_its_arguments
def section(
    points: SectionLike,
    x: str | ArrayLike | None = None,
    y: str | ArrayLike | None = None,
    *,
    xlabel: str | None = None,
    ylabel: str | None = None,
    title: str | None = None,
    sign: int = 0,
    trajectories: Sequence[int] | None = None,
    colour: str | Sequence[str] | None = None,
    size: float | None = None,
    window: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    r"""Crossings of a surface of section, in the plane of two coordinates.

    Only where the section itself is a surface (two degrees of freedom) do the points of one orbit on a torus lie on a
    curve.  In higher dimension this is a projection: a filled region proves no chaos, and a curve no torus.  Curves of
    orbits with other energies or Casimirs lie on another surface and cross in the plane; above a new figure stands
    on how many levels the orbits lie (`liepoisson.sections.section_starts` draws starts of one).

    An angle is drawn within one turn: "atan2(b, a)", or a component that leaves $(-\pi, \pi)$ and after whole turns of
    which the rates are the same.  Where a System says which coordinates are angles, and which period time has, a
    formula that changes by a constant m after each turn, as "2*b" does by $4\pi$, is drawn modulo m.  The turn begins
    in the middle of the largest gap g that the n angles leave, if chance would hardly leave one as large,
    $n\,2^{-g/d} \le 0.01$, so that islands stay whole; else at $-\pi$, or $-m/2$.  Here d is the median of the
    $\sqrt n$ gaps on one side or the other, whichever is larger: n independent angles as dense as there leave so many
    gaps as large.  The command `section` draws by the same rule.

    Axes that were drawn into before keep their coordinates, labels and turn; of a title that was ours the lines stay
    that are true of both sections.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> system = lp.catalog.system("henon-heiles")
        >>> crossings = lp.section(system, {"y": 0.1, "p_x": 0.3}, surface="x", t_end=200, direction=1)
        >>> axes = lp.plot.section(crossings, "y", "p_y")
        >>> sum(len(line.get_xdata()) for line in axes.lines) == len(crossings.time)  # a point for each crossing
        True
        >>> plt.close(axes.figure)

    Args:
        points: Result of `liepoisson.section`, or its Dataset.
        x: Horizontal: the name of a coordinate that was kept, values, shape (crossing,), or, where whole states of a
            System were kept, a formula such as "atan2(alpha2, alpha1)".  By default what the axes show, if a section is
            in them.  Else of a section of dimension 2 what makes it a graph: an angle of two components with its
            momentum, coordinate and momentum, or other components and angles; where none do, but each of two sheets is
            a graph, both are drawn, side by side in a new figure.
            Else the last component of the state that acts on others, of coordinates and momenta the last coordinate, of
            kept functions the first.  A Dataset does not know what acts, and has the last component.
        y: Vertical, likewise.  Else the second component, the momentum of x, or the last of kept functions.  Where one
            of both is constant on the section, the two before them are taken: on y = 0 not y and p_y, but x and p_x.
        xlabel: By default the name as mathematical text.
        ylabel: Likewise.
        title: Above the axes.  By default, in a new figure, system, surface and direction, and the values of energy and
            Casimirs or, where the orbits do not share them, how many there are; given axes keep the title they have.
        sign: Only crossings with this sign of the change of the surface function; 0: all.
        trajectories: Only these.
        colour: Of all points, or of the trajectories in turn; by default the six colours of the style, so that the
            seventh trajectory has that of the first.  By verdict: `colour=[hue[kind] for kind in
            decide(system, starts, t_end=...).verdict]` with `hue = {"regular": "C0", "chaotic": "C1", "undecided":
            "gray"}`.
        size: Diameter of a point in printer's points; by default it follows from their number.
        window: Where the turn of an angle begins, in radians; by default as above.

    Returns:
        The axes; of two sheets those of the first.

    Raises:
        ExpressionError: a formula cannot be read.
        ParameterError: no such coordinate, trajectory, sign or colour, no trajectory at all, a size that is not
            positive, one coordinate only and no choice of axes, a window without an angle or other than that of the
            axes, or axes that show another coordinate under our label, or one of two sheets.
        ShapeError: values that are not one per crossing.
    """
    if not hasattr(points, "state") or not hasattr(points, "sign"):
        raise not_a("what section returns", points, "points", 'try section(system, starts, surface="l3", t_end=100)')
    before = None if ax is None else _shown_in(ax)
    x, y, sheets = _chosen(points, x, y) if before is None else (*before.axes_for(x, y, (xlabel, ylabel)), "")
    member, signs = _member(points), np.asarray(points.sign)
    chosen = np.ones(len(member), bool)
    check_choice(sign, "sign", (1, -1, 0), "0 takes both")
    if sign:
        chosen &= signs == sign
    if trajectories is not None:
        chosen &= np.isin(member, _as_trajectories(trajectories, points, member))
    colours = as_colours(colour)
    diameter = None if size is None else as_positive(size, "size", "a positive number of printer's points", example=2)
    check_title_of_figure(title)
    plane = _plane(points, (x, y), chosen, window=window, before=before)
    heading = _heading(points, np.unique(member[plane.shown])) if title is None else title
    panels = _panels(points, sheets) if ax is None else [("", np.ones(len(member), bool))]
    with house_style():
        is_new, ax = ax is None, axes_or_new(ax, width=5.2 if len(panels) == 1 else 9.0, height=4.6)
        drawn = _side_by_side(ax, len(panels))
        present = ("", "") if before is None else (ax.get_xlabel(), ax.get_ylabel())
        own = [_kept_label(*both) for both in zip((x, y), plane.labels, present, strict=True)]
        labels = [label if given is None else given for label, given in zip(own, (xlabel, ylabel), strict=True)]
        begins = tuple(None if turn is None else turn.begin for turn in plane.turns)
        shown = _Shown((_name_of(x), _name_of(y)), begins, sheets if len(panels) > 1 else "")
        filled = plane._replace(labels=labels)
        _fill(
            zip(drawn, (of for _, of in panels), strict=True),
            filled,
            member,
            colours,
            diameter,
            shown=shown,
            mark=is_new,
        )
        if title is None and len(panels) == 1:
            set_heading(ax, heading or "", is_new=is_new)
        else:
            for one, (words, _) in zip(drawn, panels, strict=True):
                one.set_title("\n".join(line for line in (heading if one is drawn[0] else None, words) if line))
    return ax


def titled_section(
    run: SectionResult,
    leaf: Leaf,
    surface: str,
    axes: tuple[str, str],
    energy: float | None = None,
    *,
    sheets: str = "",
) -> Figure:
    """Crossings of orbits on one leaf, with system, surface, energy and values of the Casimirs above them.

    `axes` are across and up, coordinates that were kept or formulas of the state; `sheets` tells two sheets apart,
    which are drawn side by side (`SectionAxes`).
    """
    from liepoisson.structure.casimirs import shortage

    system = leaf.system
    with house_style():
        panels = _panels(run, sheets)
        figure = new_figure(6.0 if len(panels) == 1 else 10.0, 5.4)
        drawn = _side_by_side(figure.add_subplot(), len(panels))
        # An orbit that escaped would leave no room for the others.
        stayed = np.isin(run.outcome, ("finished", "time limit"))[run.trajectory]
        plane = _plane(run, axes, stayed if stayed.any() else ~stayed)
        _fill(zip(drawn, (of for _, of in panels), strict=True), plane, run.trajectory, as_colours(None))
        named = ({} if energy is None else {"H": energy}) | leaf.casimirs
        missing = shortage(system.bracket)
        name = wrap(f"{plain(system.name)}:", _LONGEST_LINE)
        own_line = len("".join(name)) > _LONGEST_LINE // 2 or len(name[-1]) + len(surface) > _LONGEST_LINE
        of = f"section {_shown_surface(surface)}{_in_words(run.direction)}"
        heading = "\n".join(name) + ("\n" if own_line else " ") + of
        lines = [heading, f"{_shown_values(named)}{f' ({missing})' if missing else ''}"]
        for ax, (words, _) in zip(drawn, panels, strict=True):
            ax.set_title("\n".join([*(lines if ax is drawn[0] else ()), *filter(None, [words])]), fontsize=10.5)
    return figure


def _panels(points: SectionLike, sheets: str) -> list[tuple[str, NDArray[np.bool_]]]:
    """What stands above each part of a figure, and which crossings are in it: all, or those of two sheets."""
    signs = np.asarray(points.sign)
    if not sheets:
        return [("", np.ones(len(signs), bool))]
    if sheets == DIRECTION:
        return [("increasing", signs > 0), ("decreasing", signs < 0)]
    system: Any = points.system  # pyright: ignore[reportAttributeAccessIssue]  # what has sheets is the result of a run
    values = system.functions.of(sheets)(points.state)
    return [(f"{formula(sheets)} $> 0$", values > 0), (f"{formula(sheets)} $< 0$", values < 0)]


def _side_by_side(ax: Axes, n: int) -> list[Axes]:
    """Axes, and beside them others of the same limits."""
    if n == 1:
        return [ax]
    grid = ax.figure.add_gridspec(1, n)  # pyright: ignore[reportAttributeAccessIssue]  # no subfigure
    ax.set_subplotspec(grid[0])
    return [ax, *(ax.figure.add_subplot(grid[k], sharex=ax, sharey=ax) for k in range(1, n))]


class _Turn(NamedTuple):
    """Where a turn begins, and its length, as a number and as mathematical text."""

    begin: float
    length: float
    text: str


class _Plane(NamedTuple):
    """The two coordinates of each crossing, their labels, the turns of angles, and what is shown."""

    values: FloatArray
    labels: Sequence[str]
    turns: tuple[_Turn | None, ...]
    shown: NDArray[np.bool_]


def _plane(
    points: SectionLike,
    axes: tuple[str | ArrayLike, str | ArrayLike],
    chosen: NDArray[np.bool_],
    *,
    window: float | None = None,
    before: _Shown | None = None,
) -> _Plane:
    """Two coordinates of crossings, angles within one turn: a given one, that of the axes, or the best one."""
    given = [_values(points, axis, len(chosen), which) for axis, which in zip(axes, "xy", strict=True)]
    shown = chosen & np.isfinite(given[0]) & np.isfinite(given[1])
    wanted = None if window is None else as_number(window, "window", "an angle in radians")
    turns = tuple(
        _turn(points, axis, v[shown], wanted, None if before is None else (before.begins[k],))
        for k, (axis, v) in enumerate(zip(axes, given, strict=True))
    )
    if wanted is not None and (turns == (None, None) or not np.isfinite(wanted)):
        raise ParameterError(
            f"window must be where the turn of an angle that is drawn begins; got {wanted!r}. Leave it out."
        )
    values = [v if turn is None else _in_turn(v, turn.begin, turn.length) for v, turn in zip(given, turns, strict=True)]
    labels = [_axis_label(axis, turn) for axis, turn in zip(axes, turns, strict=True)]
    return _Plane(np.stack(values), labels, turns, shown)


def _turn(
    points: SectionLike,
    axis: str | ArrayLike,
    values: FloatArray,
    wanted: float | None,
    drawn: tuple[float | None] | None,
) -> _Turn | None:
    """The turn in which an angle is drawn; None for what is no angle, or a component or formula that stays in one.

    `drawn` is where that of the axes begins, the middle one where it says None; None without axes.
    """
    if not isinstance(axis, str):
        return None
    length, text = 2 * np.pi, r"2\pi"
    if not _is_angle_formula(axis):
        declared = _declared_period(points, axis)
        length, text = (length, text) if declared is None else declared
        begin = -length / 2 if drawn is None or drawn[0] is None else drawn[0]
        stays = wanted is None and np.array_equal(_in_turn(values, begin, length), values)
        if stays or (declared is None and not _is_angular_component(points, axis)):
            return None
    old = None if drawn is None else -length / 2 if drawn[0] is None else drawn[0]
    if wanted is not None and old not in {None, wanted}:
        raise ParameterError(
            f"window must be {old!r}, where the turn of these axes begins; got {wanted!r}. Leave it out."
        )
    begin = old if wanted is None else wanted
    if begin is None:
        unit = length / (2 * np.pi)
        begin = unit * _best_turn(values / unit)
    return _Turn(begin, length, text)


def _declared_period(points: SectionLike, axis: str) -> tuple[float, str] | None:
    """The number modulo which a formula in angles and periodic time is given; None where there is none."""
    system: Any = getattr(points, "system", None)
    if not _has_states_of_a_system(points) or not getattr(system, "periods", None):
        return None
    from sympy import latex

    try:
        period: Any = modulus_of_surface(system, axis)
    except ParameterError:  # no function on the circles: it is drawn as it is
        return None
    if period is None or period.free_symbols:
        return None
    return float(period), latex(period).replace(r" \pi", r"\pi")


def _is_angular_component(points: SectionLike, axis: str) -> bool:
    """Whether an axis is a component after whole turns of which the rates are the same."""
    if not _has_states_of_a_system(points) or axis not in _names(points):
        return False
    states = _states(points.state, len(_names(points)))
    system: Any = getattr(points, "system", None)
    return _is_angle(system, _names(points).index(axis), states)


@np.errstate(all="ignore")
def _is_angle(system: System, k: int, states: FloatArray) -> bool:
    """Whether the rates are the same after whole turns of a component, wherever it is, and not after other shifts."""
    some = states[:: max(1, len(states) // _TURNED)]
    rng = np.random.default_rng(0)

    def rates(angle: FloatArray) -> FloatArray:
        moved = some.copy()
        moved[:, k] = angle
        return system.vector_field(moved)

    def same(one: FloatArray, other: FloatArray) -> bool:
        return np.allclose(one, other, rtol=0, atol=_ROUND_OFF * np.abs(one).max(initial=0))

    low, high = some[:, k].min() - 2 * np.pi, some[:, k].max() + 2 * np.pi
    if not np.isfinite(high - low):
        return False
    places = [some[:, k], *(rng.uniform(low, high, len(some)) for _ in range(_PLACES))]
    turned = all(same(rates(place), rates(place + turn)) for place in places for turn in (2 * np.pi, -4 * np.pi))
    return turned and not all(same(rates(place), rates(place + 1.0)) for place in places)


def _is_angle_formula(text: str) -> bool:
    """Whether a formula is the angle of two functions, and nothing else."""
    from liepoisson.formula.grammar import Call, parse

    if ANGLE not in text:
        return False
    try:
        whole = parse(text)
    except ExpressionError:  # refused where it is evaluated
        return False
    return isinstance(whole, Call) and whole.function == ANGLE


def _best_turn(angles: FloatArray) -> float:
    """Where the turn begins that leaves islands whole: in the middle of the largest gap; without one, at -pi."""
    places = np.unique(np.mod(angles, 2 * np.pi))
    gaps = np.diff(places, append=places[:1] + 2 * np.pi)
    n = len(gaps)
    if n < 2:
        return -np.pi
    k, beside = int(np.argmax(gaps)), min(math.ceil(math.sqrt(n)), n - 1)
    near = max(np.median(gaps[(k + side * np.arange(1, beside + 1)) % n]) for side in (-1, 1))
    if math.log2(n / _BY_CHANCE) > gaps[k] / near:
        return -np.pi
    return float(np.mod(places[k] + gaps[k] / 2, 2 * np.pi) - 2 * np.pi)  # its middle is from -pi to pi


@np.errstate(invalid="ignore")
def _in_turn(angles: FloatArray, begin: float, length: float) -> FloatArray:
    """Angles within the turn that begins there; those that are there stay as they are."""
    inside = (begin <= angles) & (angles <= begin + length)
    return np.where(inside, angles, begin + np.mod(angles - begin, length))


class _Shown(NamedTuple):
    """What two axes show: functions by name, "" for values; where turns begin, or None; of which sheets one is."""

    names: tuple[str, str]
    begins: tuple[float | None, ...]
    sheets: str

    def axes_for(
        self, x: str | ArrayLike | None, y: str | ArrayLike | None, labels: tuple[str | None, str | None]
    ) -> tuple[str | ArrayLike, str | ArrayLike]:
        """The axes of what is drawn into these, by default the same; others only under a label of the caller's."""
        if self.sheets:
            raise ParameterError(
                "ax: these axes show one of the two sheets of a section, which no other section has. Leave ax out, or "
                "draw both sections with x and y given."
            )
        found: list[str | ArrayLike] = []
        for axis, given, name, label_ in zip("xy", (x, y), self.names, labels, strict=True):
            wanted = (name or None) if given is None else given
            if wanted is None:
                raise ParameterError(f"{axis} must be given: these axes show values without a name. Give {axis}=...")
            if isinstance(wanted, str) and name and label_ is None and formula(wanted) != formula(name):
                raise ParameterError(
                    f"{axis} must be {name!r:.80}, which these axes show; got {wanted!r:.80}. Leave it out, give "
                    f"{axis}label, or draw into other axes."
                )
            found.append(wanted)
        return found[0], found[1]


def _shown_in(ax: Axes) -> _Shown | None:
    """What axes show, as the crossings that were drawn there say; None where there are none."""
    return next((getattr(line, _SHOWN) for line in getattr(ax, "lines", ()) if hasattr(line, _SHOWN)), None)


def _name_of(axis: str | ArrayLike) -> str:
    return axis if isinstance(axis, str) else ""


def _kept_label(axis: str | ArrayLike, own: str, present: str) -> str:
    """The label that is there, unless it is ours: then the new one, which may say that there is a turn."""
    return own if present in {"", formula(_name_of(axis))} else present


def _mark_parts_of_pi(axis: Axis) -> None:
    """Ticks at multiples of pi, of pi/2 or of pi/4, the widest of which three fit; narrower axes keep their numbers."""
    from matplotlib.ticker import MultipleLocator

    low, high = axis.get_view_interval()
    for parts in (1, 2, 4):
        step = np.pi / parts
        if np.floor(high / step) - np.ceil(low / step) >= 2:
            axis.set_major_locator(MultipleLocator(step))
            axis.set_major_formatter(lambda value, _: _in_pi(round(value * 4 / np.pi)))
            return


def _in_pi(quarters: int) -> str:
    """A multiple of pi/4 as mathematical text."""
    part = Fraction(abs(quarters), 4)
    sign, times = "-" if quarters < 0 else "", "" if part.numerator == 1 else str(part.numerator)
    if not quarters:
        return "$0$"
    return rf"${sign}{times}\pi{'' if part.denominator == 1 else f'/{part.denominator}'}$"


def _shown_values(named: Mapping[str, float]) -> str:
    """Functions and their values, as in a title."""
    return ", ".join(f"{label(name)} = ${number(value)}$" for name, value in named.items())


def _in_words(direction: int) -> str:
    """The direction of a crossing, behind the surface in a title."""
    return {1: ", increasing", -1: ", decreasing"}.get(direction, "")


def _widen(ax: Axes) -> None:
    """Show points that agree to round-off, as those of periodic orbits do, as one point."""
    for limits, set_limits in ((ax.get_xlim(), ax.set_xlim), (ax.get_ylim(), ax.set_ylim)):
        low, high = limits
        middle, size = (low + high) / 2, max(abs(low), abs(high), 1e-3)
        if high - low < _ROUND_OFF * size:
            set_limits(middle - size / 2, middle + size / 2)


def _fill(
    parts: Iterable[tuple[Axes, NDArray[np.bool_]]],
    plane: _Plane,
    member: NDArray[np.int64],
    colours: Sequence[str],
    size: float | None = None,
    *,
    shown: _Shown | None = None,
    mark: bool = True,
) -> None:
    """Draw crossings into axes side by side, with labels and, if wanted, ticks of angles."""
    parts = list(parts)
    for ax, panel in parts:
        of = plane.shown & panel
        for line in _draw(ax, plane.values[:, of], member[of], colours, size):
            setattr(line, _SHOWN, shown)
        ax.set_xlabel(plane.labels[0])
        ax.set_ylabel(plane.labels[1])
        ax.margins(0.04)
        _widen(ax)
    for axis, turn in zip((parts[0][0].xaxis, parts[0][0].yaxis), plane.turns, strict=True):
        if mark and turn is not None and r"\pi" in turn.text:  # axes side by side share their ticks
            _mark_parts_of_pi(axis)


def _draw(
    ax: Axes, xy: FloatArray, member: NDArray[np.int64], colours: Sequence[str], size: float | None
) -> list[Line2D]:
    """One line of dots for each trajectory; in an .svg or .pdf file the dots are pixels, as their number is large."""
    extent = ax.get_window_extent().transformed(ax.figure.dpi_scale_trans.inverted())
    area = 72.0**2 * extent.width * extent.height
    fitting = float(np.sqrt(4 / np.pi * _GOOD_COVERAGE * area / max(1, len(member))))
    diameter = float(np.clip(fitting, _SMALLEST, _LARGEST)) if size is None else size
    dots: list[Line2D] = []
    for k in np.unique(member):
        dots += ax.plot(
            *xy[:, member == k],
            linestyle="none",
            marker="o",
            markersize=diameter,
            markeredgewidth=0,
            color=colours[k % len(colours)],
            rasterized=True,
        )
    return dots


def _member(points: SectionLike) -> NDArray[np.int64]:
    """The trajectory of each crossing; a Dataset has it under another name, as `trajectory` is one of its axes."""
    found = getattr(points, "crossing_trajectory", None)
    return np.asarray(getattr(points, "trajectory") if found is None else found)  # noqa: B009  # one of the two


def _chosen(
    points: SectionLike, x: str | ArrayLike | None, y: str | ArrayLike | None
) -> tuple[str | ArrayLike, str | ArrayLike, str]:
    """The axes, as given or by default, and what tells the sheets of a section apart that has no axes as a graph."""
    names = _names(points)
    if x is None and y is None and _has_states_of_a_system(points):
        found = figure_axes(points)  # pyright: ignore[reportArgumentType]  # it is the result of a run
        return found.x, found.y, found.sheets
    across, up = (
        component_axes(points)  # pyright: ignore[reportArgumentType]  # it is the result of a run
        if _has_states_of_a_system(points)
        else default_axes(
            names, _states(points.state, len(names)), _beside(points, len(names)), surface=_about(points)[1]
        )
        if _is_whole(points)
        else (names[0], names[-1])
    )
    axes = across if x is None else x, up if y is None else y
    if (x is None or y is None) and all(isinstance(axis, str) for axis in axes) and axes[0] == axes[1]:
        raise ParameterError(
            f"a plane must have two coordinates; got {axes[0]!r:.80} for both, one of them by default. Give x and y, "
            "for example y=points.time."
        )
    return *axes, ""


def _is_whole(points: SectionLike) -> bool:
    """Whether whole states were kept."""
    components = getattr(points, "components", getattr(points, "component", ()))
    return _names(points) == tuple(map(str, np.asarray(components)))


def _has_states_of_a_system(points: SectionLike) -> bool:
    """Whether functions of the crossings can be read from texts."""
    return _is_whole(points) and has_functions(getattr(points, "system", None))


def _states(states: Any, n: int) -> FloatArray:
    return np.asarray(states, np.float64).reshape(-1, n)


def _beside(points: SectionLike, n: int) -> FloatArray | None:
    """Where the orbits start and end, if that is known."""
    found = [
        _states(states, n) for name in ("start", "end_state") if (states := getattr(points, name, None)) is not None
    ]
    return np.concatenate(found) if found else None


def _heading(points: SectionLike, trajectories: NDArray[np.int64]) -> str | None:
    """System, surface, direction and levels, as far as they are known."""
    system, surface, direction = _about(points)
    if system is None or surface is None:
        return None
    name = plain(system)
    gap = ": " if len(f"{system}: {surface} = 0") <= _LONGEST_LINE else "\n"
    of = f"{name}{gap}{_shown_surface(surface)}{_in_words(direction)}"
    return "\n".join(filter(None, [of, _about_levels(points, trajectories)]))


def _about(points: SectionLike) -> tuple[str | None, str | None, int]:
    """System, surface and direction, as far as they are known: a Dataset has them among its attributes."""
    attributes = getattr(points, "attrs", None)
    if attributes is None:
        system, surface = name_of_system(points), getattr(points, "surface", None)
        direction = getattr(points, "direction", 0)
    else:  # its "surface" is the tape
        recorded = json.loads(attributes.get("run", "{}"))
        system, surface, direction = attributes.get("system"), recorded.get("surface"), recorded.get("direction", 0)
    return system if isinstance(system, str) else None, surface if isinstance(surface, str) else None, direction


def _about_levels(points: SectionLike, trajectories: NDArray[np.int64]) -> str:
    """The energy and the Casimirs of the orbits that are shown, or that they have several."""
    levels = levels_of(points, trajectories) if hasattr(points, "start") else None  # pyright: ignore[reportArgumentType]
    return _shown_levels(levels) + (": their curves cross" if levels is not None and len(levels) > 1 else "")


def _shown_levels(levels: Levels | None) -> str:
    """The values of a level, or how many levels there are; nothing where they are not known."""
    if levels is None or not len(levels):
        return ""
    if len(levels) > 1:
        return f"{len(levels)} levels of {', '.join(map(label, levels.names))}"
    return _shown_values(dict(zip(levels.names, levels.values[0].tolist(), strict=True)))


def heading_of(run: object, trajectory: int | None = None) -> str:
    """The system of a run, and below it energy and Casimirs of its orbits, or of one of them, as far as they are known.

    Where the orbits do not share them, it is said how many levels there are.
    """
    name, start = name_of_system(run), getattr(run, "start", None)
    states = np.zeros((0, 0)) if start is None else np.asarray(start, np.float64)
    chosen = states if trajectory is None else states[trajectory : trajectory + 1]
    levels = levels_through(getattr(run, "system", None), chosen) if len(chosen) else None
    return "\n".join(filter(None, [plain(name) if name else "", _shown_levels(levels)]))


def _shown_surface(surface: str) -> str:
    """The equation of a surface; one that is too long for a line is cut, and then not set as a formula."""
    fits = len(surface) <= _LONGEST_LINE - 4
    return f"{formula(surface) if fits else plain(surface, _LONGEST_LINE - 4)} = 0"


def _names(points: SectionLike) -> tuple[str, ...]:
    names = getattr(points, "coordinates", None)
    if isinstance(names, tuple):
        return tuple(map(str, names))  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
    found = getattr(points, "coordinate", None)
    return tuple(map(str, np.asarray(getattr(points, "component") if found is None else found)))  # noqa: B009


def _values(points: SectionLike, wanted: str | ArrayLike, n: int, which: str) -> FloatArray:
    if isinstance(wanted, str):
        names = _names(points)
        if wanted not in names and _has_states_of_a_system(points):
            return points.system.functions.of(wanted)(points.state)  # pyright: ignore[reportAttributeAccessIssue]
        if wanted not in names:
            raise ParameterError(
                f"{which} must be a coordinate that was kept ({', '.join(names)}) or an array of values; got "
                f"{wanted!r:.80}. For a formula keep it: section(..., keep=[...])."
            )
        return np.asarray(points.state, np.float64)[:, names.index(wanted)]
    values = as_array(wanted, which)
    if values.shape != (n,):
        raise ShapeError(f"{which} must have shape (crossing,), here ({n},); got {values.shape}. Take one coordinate?")
    return values


def _as_trajectories(wanted: Any, points: SectionLike, member: NDArray[np.int64]) -> NDArray[np.int64]:
    """Numbers of trajectories; those without crossings count, too."""
    outcomes = getattr(points, "outcome", None)
    n = int(member.max(initial=-1)) + 1 if outcomes is None else len(outcomes)
    several = listed(wanted, "trajectories")
    given = [as_scalar(wanted)] if several is None else several
    if not len(given):
        raise ParameterError("trajectories must be at least one; got none. Leave it out for all of them.")
    return np.array([as_count(k, "trajectories", most=n - 1) for k in given], dtype=np.int64)


def _axis_label(coordinate: str | ArrayLike, turn: _Turn | None) -> str:
    """The coordinate as mathematical text; of what was brought into one turn the label says so."""
    if not isinstance(coordinate, str):
        return ""
    if turn is None or _is_angle_formula(coordinate):
        return formula(coordinate)
    return f"{formula(coordinate)} (mod ${turn.text}$)"
