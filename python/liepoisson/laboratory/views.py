"""The laboratory in a cell of a notebook, for Jupyter and marimo."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.errors import MissingPackageError, ParameterError
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import by_name
from liepoisson.inputs.refusals import check_choice
from liepoisson.laboratory.drafts import is_typed
from liepoisson.laboratory.pages import Page, page_of
from liepoisson.laboratory.states import HORIZON
from liepoisson.numeric.integrate import Orbit
from liepoisson.poincare.section import Section
from liepoisson.rigid_body.rod import Rod
from liepoisson.sweeps.result import Sweep

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from liepoisson.inputs.arrays import Array
    from liepoisson.laboratory.widget import View

HEIGHTS = {"two": 460, "all": 820}
"""Pixels, for each choice of panels."""


@explains_its_arguments
def view(
    shown: Any = None,
    *,
    start: ArrayLike | Mapping[str, Any] | None = None,
    surfaces: Sequence[Any] = (),
    trajectory: int = 0,
    point: int | None = None,
    state: Mapping[str, Any] | None = None,
    playing: bool = True,
    panels: str = "two",
    height: int | None = None,
) -> View:
    """The laboratory as a widget of a notebook: the moving system, computed in the browser, with its state in Python.

    It is the page that `liepoisson lab` opens, in a frame of its own. It needs no network. What is done in it, such as
    a click on a crossing, is in `widget.start`, `widget.time` and `widget.state`; setting one changes the view.
    Without a system one is typed in the cell, and what is typed is `widget.system`.

    Args:
        shown: A system or a `Top`; an orbit or a section, which the page computes again and compares; a rod of a top;
            or a sweep, of which one orbit is followed.  The address of a system that was typed in the page, or what
            follows its #, opens it; nothing opens the page on which one is typed.
        start: Where the orbit of a system begins, shape (component,), or components by name; by default trajectory 0 of
            the random unit vectors.
        surfaces: Functions whose zeros can be chosen as surface of section, besides the components.
        trajectory: Which orbit of a result; of a sweep, which of those at its point.
        point: Which point of a sweep.
        state: What the page begins with, by name: `surface`, `direction`, `axes`, `view`, `tol`, `theme`, `time`,
            `speed`; for tops also `parameters`, `preset` and `shadow`, and for others `projection` and `series`, with
            `parameters` of systems that can be typed.
        playing: Whether the motion begins to play; where *reduced motion* is set in the system it waits.
        panels: "two" shows the motion and the section, of a system that is typed its fields and sliders, too; "all" the
            whole laboratory.
        height: Of the widget, in pixels.

    Returns:
        A widget (anywidget) with the traits `state`, `start`, `time`, `playing`, `height`, `address` and `message`,
        and with `system`, what it shows now, which can be set to another system.

    Raises:
        MissingPackageError: anywidget is not installed.
        ParameterError: it cannot be viewed, or an argument cannot be.
        UnknownNameError: the state has a name that the page does not know.

    Examples:
        >>> widget = lp.view(lp.Top.twisted_kovalevskaya(), start=[1, 0, 0, 0.8, 0.6, 0, 0, 0, 1])
        >>> widget.state = {"parameters": {"epsilon": "1/3"}, "view": "body", "theme": "light"}
        >>> widget.start
        (1.0, 0.0, 0.0, 0.8, 0.6, 0.0, 0.0, 0.0, 1.0)
        >>> print(widget.system.epsilon)
        1/3
    """
    if not isinstance(playing, bool | np.bool_):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"playing must be True or False; got {playing!r:.40}.")
    check_choice(panels, "panels", tuple(HEIGHTS))
    begin = {} if state is None else by_name(state, "state", "parts", "{'time': 5}")
    made = None
    address = "own=1" if shown is None else shown.rpartition("#")[2] if isinstance(shown, str) else ""
    if is_typed(address):
        _check_that_nothing_else_is_given(start, surfaces, trajectory, point)
    else:
        made = _page(shown, start, surfaces, trajectory, point)
    if isinstance(shown, Rod):
        # backwards is no time of the page
        end = float(np.clip(shown.arclength[-1] - shown.arclength[0], 0.0, HORIZON))
        begin = {"view": "rod", "time": end, **begin}
    try:
        from liepoisson.laboratory.widget import Opening, View, checked_height
    except ImportError as error:
        raise MissingPackageError(
            "a view in a notebook needs the package anywidget, which is not installed. "
            'Run pip install "liepoisson[notebook]".'
        ) from error
    opening = Opening.of_address(address) if made is None else Opening.of_page(*made, surfaces)
    size = checked_height(HEIGHTS[panels] if height is None else height)
    return View(opening, state=begin, playing=bool(playing), panels=panels, height=size)


def _check_that_nothing_else_is_given(start: Any, surfaces: Any, trajectory: Any, point: Any) -> None:
    has_surfaces = not (isinstance(surfaces, Sequence) and len(surfaces) == 0)
    if start is not None or has_surfaces or trajectory != 0 or point is not None:
        raise ParameterError(
            "start, surfaces, trajectory and point belong to a system or a result; got one of them without. Leave "
            "them out, or view a system."
        )


def _page(shown: Any, start: Any, surfaces: Any, trajectory: int, point: int | None) -> tuple[Page, Any]:
    """The page, and the system on it."""
    if point is not None and not isinstance(shown, Sweep):
        raise ParameterError("point is one of a sweep. Leave it out.")
    if isinstance(shown, Orbit | Section | Rod | Sweep):
        if start is not None or surfaces:
            raise ParameterError("start and surfaces are those of the result. Leave them out, or view its system.")
        if isinstance(shown, Sweep):
            return _of_sweep(shown, trajectory, point)
        if isinstance(shown, Rod):
            return _of_rod(shown, trajectory), shown.system
        return page_of(shown.system, result=shown, trajectory=trajectory), shown.system
    if isinstance(shown, type) or not callable(getattr(shown, "field", None)):
        kind = type(shown).__name__
        of = "its `.system`" if hasattr(shown, "system") else "lp.Top(...), lp.System(...) or lp.catalog.system(...)"
        raise ParameterError(
            f"what can be viewed is a system, a top, an orbit, a section, a rod or a sweep; got {kind!r:.40}. "
            f"View {of} instead."
        )
    if as_count(trajectory, "trajectory") != 0:
        raise ParameterError("trajectory is one of a result, and this is a system. Give its start instead.")
    return page_of(shown, start=start, surfaces=surfaces), shown


def _of_rod(rod: Rod, trajectory: int) -> Page:
    starts = rod.attitude.orbit.start[:, : len(rod.system.component_names)]
    page = page_of(rod.system, start=starts[as_count(trajectory, "trajectory", most=len(starts) - 1)])
    if page.record is not None:
        raise ParameterError(
            f"the page draws the rods of tops with parameters that are fractions or decimals; {rod.system.name!r:.60} "
            "is none. Draw it with `lp.plot.rod`, or view its `.system`, which has other views."
        )
    return page


def _of_sweep(sweep: Sweep, trajectory: int, point: int | None) -> tuple[Page, Any]:
    n = len(sweep.points)
    chosen = 0 if point is None and n == 1 else point
    if isinstance(chosen, bool) or not isinstance(chosen, int | np.integer) or not 0 <= chosen < n:
        first, last = (_in_words(sweep, k) for k in (0, n - 1))
        raise ParameterError(
            "a sweep is viewed at one of its points, as each has a system and starts of its own; "
            f"got point={point!r:.40}. Say which: from point=0 ({first}) to point={n - 1} ({last})."
        )
    member = as_count(trajectory, "trajectory", most=sweep.spec.n_starts - 1)
    system, start = _orbit_at(sweep, int(chosen), member)
    return page_of(system, start=start), system


def _orbit_at(sweep: Sweep, point: int, member: int) -> tuple[Any, Array]:
    """The system of a point, and where one of its orbits starts, shape (component,): the numbers of the sweep."""
    from liepoisson.sweeps.points import evaluate_targets
    from liepoisson.sweeps.tasks import FAILED, NO_START, NO_SYSTEM, Piece, is_noisy, system_and_starts

    spec = sweep.spec
    if int(sweep.outcome_code[point, member]) in (NO_START, NO_SYSTEM, FAILED):
        raise ParameterError(
            f"orbit {member} of point {point} ({_in_words(sweep, point)}) cannot be computed again: "
            f"its outcome is {str(sweep.outcome[point, member])!r}. Take another one."
        )
    targets = evaluate_targets(spec, sweep.system, sweep.points[[point]])
    if is_noisy(spec, sweep.system, targets):
        raise ParameterError(
            "a sweep over systems with noise cannot be viewed: the page follows equations of motion, and a path of "
            "noise has none. View a system without its noise, lp.view(noisy.system), or draw the sweep by "
            "lp.plot.sweep."
        )
    system, states = system_and_starts(Piece(0, spec, sweep.system, targets))
    return system, states[member]


def _in_words(sweep: Sweep, point: int) -> str:
    """The values of the axes at a point."""
    pairs = zip(sweep.spec.axes, sweep.points[point], strict=True)
    return ", ".join(f"{axis.name} = {value:.6g}" for axis, value in pairs)
