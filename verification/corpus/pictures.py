"""What each figure shows: labels, titles, legends, the number of artists, and hashes of their data.

Places are rounded to 10 significant digits, so that another order of operations in the drawing does not matter.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from verification.corpus.answer import answer, plain, rounded_digest
from verification.corpus.results import RUNS, STARTS, TIME, curves, result

import liepoisson as lp

FIGURES: dict[str, Callable[[], Any]] = {
    "convergence": lambda: lp.plot.convergence(result("FiniteTimeExponents")),
    "convergence with a fit": lambda: lp.plot.convergence(
        result("MeanCurve"), fit=result("FiniteTimeFit"), label="members"
    ),
    "convergence with a logarithmic fit": lambda: lp.plot.convergence(result("MeanCurve"), fit=result("LogFit")),
    "convergence of one": lambda: lp.plot.convergence(lp.finite_time_exponents(lp.Top.lagrange(), STARTS[0], t_end=50)),
    "exponent distribution": lambda: lp.plot.exponent_distribution(curves()[:, -1], bins=12, label="members"),
    "window scan": lambda: lp.plot.window_scan(
        lp.fits.window_scan(TIME, curves(), windows=[(5, 90), (10, 90), (5, 60)], n_bootstrap=40), reference=0.1
    ),
    "indicators": lambda: lp.plot.indicators(result("Megno"), result("Alignment"), decided_at=30),
    "indicators of two": lambda: lp.plot.indicators(
        result("Megno"), result("Alignment"), members=[2, 0], labels=["two", "zero"]
    ),
    "orbit": lambda: lp.plot.orbit(result("Orbit"), trajectory=1),
    "orbit of the well": lambda: lp.plot.orbit(
        lp.integrate(lp.catalog.system("henon-heiles"), [0, 0.125, 0.25, 0.125], times=np.arange(0.0, 20.0, 0.25)),
        title="a well",
    ),
    "section": lambda: lp.plot.section(result("Section"), "l1", "alpha3"),
    "section by default": lambda: lp.plot.section(result("Section")),
    "section of formulas": lambda: lp.plot.section(result("Section"), "atan2(l2, l1)", "dot(l, l)", sign=1),
    "section of both directions": lambda: lp.plot.section(result("Section of the well")),
    "sleeping diagram": lambda: lp.plot.sleeping_diagram([0.0, 1.0, -2.0]),
    "spectrum": lambda: lp.plot.spectrum(result("Spectrum")),
    "rod": lambda: lp.plot.rod(result("Rod")),
    "rod without profiles": lambda: lp.plot.rod(result("Rod"), profiles=False),
    "profile": lambda: lp.plot.profile(result("EnergyProfile")),
    "sweep": lambda: lp.plot.sweep(result("Sweep"), label="a curve"),
    "map of a sweep": lambda: lp.plot.sweep(result("Sweep of two axes")),
    "files": lambda: saved("orbit"),
}
"""Each function of `lp.plot`, some in several ways; besides, `lp.plot.draw` is asked for each kind of run."""


def record() -> dict[str, Any]:
    """All figures."""
    drawn = {f"draw {name}": (lambda name=name: lp.plot.draw(result(name))) for name in (*RUNS, "MeanCurve")}
    return {name: answer(lambda make=make: shown(make())) for name, make in (FIGURES | drawn).items()}


def saved(stem: str) -> Any:
    """The names and kinds of the files that a figure is saved into."""
    with tempfile.TemporaryDirectory() as folder:
        paths = lp.plot.save_figure(lp.plot.orbit(result("Orbit")), Path(folder) / stem)
        return [path.name for path in paths]


def shown(drawn: Any) -> Any:
    """What is seen of a figure, of axes, or of several axes."""
    import matplotlib.pyplot as plt

    first = drawn[0] if isinstance(drawn, (tuple, list, np.ndarray)) else drawn
    if isinstance(first, str):
        return plain(drawn)
    figure = first if hasattr(first, "savefig") else first.figure
    figure.draw_without_rendering()
    found = {
        "size": plain(figure.get_size_inches()),
        "title": figure.get_suptitle(),
        "texts": [text.get_text() for text in figure.texts],
        "legends": [legend_of(legend) for legend in figure.legends],
        "axes": {str(k): of_axes(ax) for k, ax in enumerate(figure.axes)},
    }
    plt.close(figure)
    return plain(found)


def of_axes(ax: Any) -> dict[str, Any]:
    """One panel."""
    legend = ax.get_legend()
    return {
        "titles": [ax.get_title(loc) for loc in ("left", "center", "right")],
        "labels": [axis.get_label_text() for axis in _axes_of(ax)],
        "scales": [axis.get_scale() for axis in _axes_of(ax)],
        "limits": [[f"{end:.6g}" for end in axis.get_view_interval()] for axis in _axes_of(ax)],
        "ticks": [[text.get_text() for text in axis.get_ticklabels()] for axis in _axes_of(ax)],
        "legend": None if legend is None else legend_of(legend),
        "texts": [text.get_text() for text in ax.texts],
        "lines": [line_of(line) for line in ax.lines],
        "collections": [collection_of(one) for one in ax.collections],
        "patches": [rounded_digest(patch.get_path().vertices) for patch in ax.patches],
        "images": [rounded_digest(image.get_array()) for image in ax.images],
    }


def _axes_of(ax: Any) -> list[Any]:
    return [ax.xaxis, ax.yaxis, *([ax.zaxis] if hasattr(ax, "zaxis") else [])]


def legend_of(legend: Any) -> list[str]:
    """The lines of a legend."""
    return [text.get_text() for text in legend.get_texts()]


def line_of(line: Any) -> str:
    """Look and data of a line; in three dimensions the data are those of space."""
    data = line.get_data_3d() if hasattr(line, "get_data_3d") else line.get_data()
    look = f"{line.get_color()} {line.get_linestyle()} {line.get_marker()} width {line.get_linewidth():g}"
    return f"{look}: {len(data[0])} points {rounded_digest([np.asarray(one, dtype=float) for one in data])}"


def collection_of(one: Any) -> dict[str, Any]:
    """Kind, paths, places, colours of a collection."""
    places, values = np.ma.filled(np.ma.asarray(one.get_offsets(), dtype=float), np.nan), one.get_array()
    return {
        "kind": type(one).__name__,
        "paths": [rounded_digest(path.vertices) for path in one.get_paths()[:200]],
        "offsets": f"{len(places)} {rounded_digest(places)}",
        "colours": f"{len(one.get_facecolor())} {rounded_digest(one.get_facecolor())}",
        "values": None if values is None else rounded_digest(values),
    }
