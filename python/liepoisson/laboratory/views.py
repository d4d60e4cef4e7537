"""The laboratory in a cell of a notebook, for Jupyter and marimo."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from liepoisson.errors import MissingPackageError, ParameterError
from liepoisson.laboratory.pages import page_of
from liepoisson.numeric.integrate import Orbit
from liepoisson.numeric.section import Section

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from liepoisson.laboratory.widget import View

PANELS = ("two", "all")
HEIGHTS = {"two": 460, "all": 820}
"""Pixels, for each choice of panels."""


def view(
    shown: Any,
    *,
    start: ArrayLike | None = None,
    surfaces: Sequence[Any] = (),
    state: Mapping[str, Any] | None = None,
    playing: bool = True,
    panels: str = "two",
    height: int | None = None,
) -> View:
    """The laboratory as a widget of a notebook: the moving system, computed in the browser, with its state in Python.

    It is the page that `liepoisson lab` opens, in a frame of its own. It needs no network. What is done in it, such as
    a click on a crossing, is in `widget.start`, `widget.time` and `widget.state`; setting one changes the view.

    Args:
        shown: A system or a `Top`; or an orbit or a section, which the page computes again and compares.
        start: Where the orbit of a system begins, shape (component,); by default member 0 of the random unit vectors.
        surfaces: Functions whose zeros can be chosen as surface of section, besides the components.
        state: What the page begins with, by name: `surface`, `direction`, `axes`, `view`, `tol`, `theme`, `time`,
            `speed`; for tops also `parameters`, `preset` and `shadow`, and for others `projection` and `series`.
        playing: Whether the motion begins to play; where *reduced motion* is set in the system it waits.
        panels: "two" shows the motion and the section, "all" the whole laboratory.
        height: Of the widget, in pixels.

    Returns:
        A widget (anywidget) with the traits `state`, `start`, `time`, `playing`, `height` and `address`, and with
        `system`, what it shows now.

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
    if panels not in PANELS:
        raise ParameterError(f"panels must be {' or '.join(map(repr, PANELS))}; got {panels!r:.40}.")
    page, system = _page(shown, start, surfaces)
    try:
        from liepoisson.laboratory.widget import View, checked_height
    except ImportError as error:
        raise MissingPackageError(
            "a view in a notebook needs the package anywidget, which is not installed. "
            'Run pip install "liepoisson[notebook]".'
        ) from error
    size = checked_height(HEIGHTS[panels] if height is None else height)
    return View(page, system, state=state or {}, playing=bool(playing), panels=panels, height=size)


def _page(shown: Any, start: Any, surfaces: Sequence[Any]) -> tuple[Any, Any]:
    """The page, and the system on it."""
    if isinstance(shown, Orbit | Section):
        if start is not None or surfaces:
            raise ParameterError("start and surfaces are those of the result. Leave them out, or view its system.")
        return page_of(shown.system, result=shown), shown.system
    if isinstance(shown, type) or not callable(getattr(shown, "field", None)):
        kind = type(shown).__name__
        of = "its `.system`" if hasattr(shown, "system") else "lp.Top, lp.System or lp.catalog.system"
        raise ParameterError(
            f"what can be viewed is a system, a top, an orbit or a section; got {kind!r:.40}. View {of} instead."
        )
    return page_of(shown, start=start, surfaces=surfaces), shown
