"""Figures in the house style, and numbers as they stand in tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liepoisson.plot.style import house_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fits import Power


def save(draw: Callable[[dict[str, Any]], Figure], result: dict[str, Any], svg: Path, png: Path) -> None:
    """Draw a result, once as vectors for the page and once as pixels for a look.

    Raises:
        OSError: A file could not be written.
    """
    with house_style():
        figure = draw(result)
        for path in (svg, png):
            path.parent.mkdir(parents=True, exist_ok=True)
            # A date in the file would make every run differ.
            figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else {})


def without_minor_labels(ax: Axes) -> None:
    """Label whole powers of ten only; on an axis that spans hardly more than one, plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for axis in (ax.xaxis, ax.yaxis):
        low, high = sorted(axis.get_view_interval())
        axis.set_minor_formatter(NullFormatter())
        if high / low < 100:
            axis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def number(value: Any) -> float | None:
    """A measured number for JSON: five digits, and null for what is not finite."""
    return float(f"{value:.4e}") if math.isfinite(value) else None


def numbers(values: Iterable[Any]) -> list[float | None]:
    """Measured numbers for JSON."""
    return [number(value) for value in values]


def power(measured: Power | None) -> dict[str, Any] | None:
    """A fitted power for JSON."""
    if measured is None:
        return None
    return {"value": number(measured.exponent), "error": number(measured.error), "points": measured.n_points}


def scientific(value: float | None, digits: int = 1) -> str:
    """A number in a table, like 3.1e-14; a dash where there is none."""
    return "–" if value is None else f"{value:.{digits}e}"


def with_error(measured: Mapping[str, Any] | None) -> str:
    """A measured number and its standard error."""
    return "–" if measured is None else f"{measured['value']:.2f} ± {measured['error']:.2f}"


def setting(knob: str, value: float) -> str:
    """The tolerance or step of a method, as in tables and legends."""
    return f"{'tol' if knob == 'tol' else 'h'} = {value:.4g}".replace("e-0", "e-")
