"""The figures of the drift: RMS and largest errors of the long runs, energy and a Casimir of the others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import contenders
import figures

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SYMBOLS = {"H": "$H$", "C1": "$C_1$", "C2": "$C_2$", "C3": "$C_3$", "l3": r"$\ell_3$", "P": "$P$"}
DASHES: dict[str, Any] = {
    "H": "-",
    "C1": (0, (5, 2)),
    "C2": (0, (3, 1, 1, 1)),
    "C3": (0, (1, 1)),
    "l3": (0, (9, 2)),
    "P": (0, (5, 1, 1, 1, 1, 1)),
}
METHODS = {
    contender.name: contender
    for contender in (*contenders.WITH_STEPS, contenders.COMPENSATED, *contenders.WITH_TOLERANCES, contenders.MIXED)
}


def long_runs(result: dict[str, Any]) -> Figure:
    """Errors of all invariants under the long runs: rows are tops, left the RMS over members, right the largest."""
    from liepoisson.plot.style import INK

    curves = [curve for curve in result["curves"] if curve["long"]]
    figure, axes = _grid(curves)
    for row, top in zip(axes, dict.fromkeys(curve["top"] for curve in curves), strict=True):
        for ax, measure in zip(row, ("rms", "largest"), strict=True):
            _all_quantities(ax, [curve for curve in curves if curve["top"] == top], measure)
            figures.without_minor_labels(ax)
    for ax, title in zip(axes[0], ("RMS over members", "largest of all members"), strict=True):
        ax.set_title(title)
    runs = dict.fromkeys((curve["run"], METHODS[curve["method"]].colour) for curve in curves)
    lines = [_sample(run, color=colour) for run, colour in runs]
    lines.append(_sample(r"$10^{-16}\sqrt{t}$", color=INK, linewidth=0.8))
    lines += [_sample(SYMBOLS[name], color=INK, linestyle=dashes) for name, dashes in DASHES.items()]
    axes[0, -1].legend(handles=lines, loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=3.2)
    return figure


def other_runs(result: dict[str, Any]) -> Figure:
    """RMS of the errors of energy and first Casimir under the shorter runs: rows are tops."""
    curves = [curve for curve in result["curves"] if not curve["long"]]
    figure, axes = _grid(curves)
    for row, top in zip(axes, dict.fromkeys(curve["top"] for curve in curves), strict=True):
        for ax, name in zip(row, ("H", "C1"), strict=True):
            _all_methods(ax, [curve for curve in curves if curve["top"] == top], name)
            figures.without_minor_labels(ax)
    for ax, title in zip(axes[0], ("energy $H$, RMS over members", "Casimir $C_1$, RMS over members"), strict=True):
        ax.set_title(title)
    axes[0, -1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _grid(curves: list[dict[str, Any]]) -> tuple[Figure, Any]:
    """A row for each top, two columns, with what all panels share."""
    from liepoisson.plot.style import new_figure

    tops = list(dict.fromkeys(curve["top"] for curve in curves))
    figure = new_figure(8.6, 6.4)
    axes = figure.subplots(len(tops), 2, sharex=True, sharey="col")
    for row, top in zip(axes, tops, strict=True):
        row[0].set_ylabel(f"{top} top\nrelative error")
    for ax in axes[-1]:
        ax.set_xlabel("$t$")
    return figure, axes


def _all_quantities(ax: Axes, curves: list[dict[str, Any]], measure: str) -> None:
    from liepoisson.plot.style import INK

    for curve in curves:
        colour = METHODS[curve["method"]].colour
        for name, quantity in curve["quantities"].items():
            ax.loglog(curve["time"], quantity[measure], color=colour, linestyle=DASHES[name], linewidth=0.9)
    ends = np.array([min(curve["time"][0] for curve in curves), max(curve["time"][-1] for curve in curves)])
    ax.loglog(ends, 1e-16 * ends**0.5, color=INK, linewidth=0.8)


def _all_methods(ax: Axes, curves: list[dict[str, Any]], name: str) -> None:
    seen: set[str] = set()
    for curve in curves:
        rms = np.array(curve["quantities"][name]["rms"])
        dashes = "--" if curve["method"] in seen else "-"  # a second setting of the same method
        seen.add(curve["method"])
        ax.loglog(
            curve["time"],
            np.where(rms > 0, rms, np.nan),
            markersize=3,
            markevery=4,
            linestyle=dashes,
            label=curve["run"],
            **METHODS[curve["method"]].style,
        )


def _sample(label: str, **style: Any) -> Any:
    """A line for a legend."""
    from matplotlib.lines import Line2D

    return Line2D([], [], label=label, **style)
