r"""The figures of the study, from reduced runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import liepoisson as lp
from liepoisson.studies.twisted_top import PRINTED
from liepoisson.studies.twisted_top.measurements import RunResult
from liepoisson.studies.twisted_top.runs import ENSEMBLES, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Results = Mapping[str, RunResult]

TWISTED, ORDINARY, THIRD, VIOLET = "#d1571b", "#1668b8", "#0b8f5f", "#7a4fa3"
INK, MUTED = "#1d2433", "#6b7280"
ENSEMBLE_COLOURS = dict(zip(ENSEMBLES, (TWISTED, ORDINARY, THIRD), strict=True))
ENSEMBLE_LABELS = {"unit-vectors": "unit vectors", "cube": "cube", "gaussian": "Gaussian"}
PRINTED_FORMULA = r"$0.122 + 0.113/\sqrt{t} + 0.497/t$"
_DASHES = (0, (5, 2.5))
_WHITE_BOX = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0}


def printed_fit(time: FloatArray) -> FloatArray:
    r"""The function printed in the caption of the paper's figure, $0.497/t + 0.113/\sqrt t + 0.122$."""
    return PRINTED["lambda"] + PRINTED["c1"] / np.sqrt(time) + PRINTED["c0"] / time


def new_figure(width: float, height: float) -> Figure:
    """An empty figure, in inches, that no window system knows of."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


def time_axis(ax: Axes, first: float, last: float) -> None:
    """Label a logarithmic time axis with plain numbers."""
    ax.set(xlim=(first, last), xlabel=r"$t$")
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter("")


def lyapunov(results: Results) -> Figure:
    r"""The paper's figure, made again: both tops, our fit and the printed one; beside it, what the eye cannot see.

    Upper right: the mean of the twisted top minus our fit, with its confidence band, and the printed fit minus ours.
    Lower right: $t\langle\lambda(t)\rangle$ of the ordinary top, a straight line in $\ln t$ if it is regular.
    """
    twisted, ordinary = results["twisted-unit-vectors"], results["ordinary-unit-vectors"]
    with lp.plot.house_style():
        figure = new_figure(7.6, 3.0)
        grid = figure.add_gridspec(2, 2, width_ratios=(1.5, 1))
        _draw_both_tops(figure.add_subplot(grid[:, 0]), twisted, ordinary)
        _draw_residual(figure.add_subplot(grid[0, 1]), twisted)
        _draw_power_of_growth(figure.add_subplot(grid[1, 1]), ordinary)
    return figure


def _draw_both_tops(ax: Axes, twisted: RunResult, ordinary: RunResult) -> None:
    time = twisted.curve.time
    for result, colour, name, fit in (
        (twisted, TWISTED, "twisted", twisted.fit),
        (ordinary, ORDINARY, "ordinary", None),
    ):
        ax.fill_between(time, *result.spread, color=colour, alpha=0.08, linewidth=0)
        drawn = len(ax.lines)
        lp.plot.convergence(result.curve, fit=fit, colour=colour, label=f"{name} Kovalevskaya top", ax=ax)
        ax.lines[drawn].set_linewidth(2.2)
    late = time[time >= 3]
    ax.plot(late, printed_fit(late), color=MUTED, linestyle=_DASHES, label=rf"fit as printed {PRINTED_FORMULA}")
    ax.set(ylim=(-0.02, 0.52), xlim=(1.0, time[-1]))
    top, fitted, other, printed = zip(*ax.get_legend_handles_labels(), strict=True)
    ax.legend(*zip(top, other, fitted, printed, strict=True), loc="upper right")
    ax.set_title("(a)")


def _draw_residual(ax: Axes, twisted: RunResult) -> None:
    curve, fit = twisted.curve, twisted.fit
    keep = curve.time >= 10
    time = curve.time[keep]
    fitted = fit.curve(time)
    ax.axvspan(*fit.window, color=MUTED, alpha=0.10, linewidth=0)
    ax.axhline(0.0, color=INK, linewidth=0.9)
    ax.fill_between(
        time,
        curve.low[keep] - fitted,
        curve.high[keep] - fitted,
        color=TWISTED,
        alpha=0.25,
        linewidth=0,
        label="95% band",
    )
    ax.plot(time, curve.mean[keep] - fitted, color=TWISTED, linewidth=1.1, label="mean")
    ax.plot(time, printed_fit(time) - fitted, color=MUTED, linestyle=_DASHES, linewidth=1.1, label="printed fit")
    ax.set_xscale("log")
    time_axis(ax, time[0], time[-1])
    ax.set_ylabel(r"$\langle\lambda\rangle - {}$fit")
    # Beside the title: inside, it would cover a curve of one run or another.
    ax.legend(
        loc="lower right", bbox_to_anchor=(1.03, 0.98), ncols=3, fontsize=7.2, handlelength=1.1, handletextpad=0.35,
        columnspacing=0.6,
    )  # fmt: skip
    ax.set_title("(b)  twisted")


def _draw_power_of_growth(ax: Axes, ordinary: RunResult) -> None:
    curve, fit = ordinary.curve, ordinary.log_fit
    keep = curve.time >= 5
    time = curve.time[keep]
    ax.axvspan(*fit.window, color=MUTED, alpha=0.10, linewidth=0)
    ax.plot(time, time * curve.mean[keep], color=ORDINARY, linewidth=2.2)
    ax.fill_between(time, time * curve.low[keep], time * curve.high[keep], color=ORDINARY, alpha=0.3, linewidth=0)
    ax.plot(time, time * fit.curve(time), color=INK, linewidth=0.9, label=rf"${fit.A:.2f} + {fit.B:.3f}\,\ln t$")
    ax.set_xscale("log")
    time_axis(ax, time[0], time[-1])
    ax.set_ylabel(r"$t\,\langle\lambda(t)\rangle$")
    ax.legend(loc="upper left")
    ax.set_title("(c)  ordinary")


def windows(results: Results) -> Figure:
    """The fitted exponent of the twisted top for every window of the scan, one panel per ensemble."""
    with lp.plot.house_style():
        figure = new_figure(7.2, 3.4)
        panels = figure.subplots(1, len(ENSEMBLES), sharey=True)
        for k, (ax, ensemble) in enumerate(zip(panels, ENSEMBLES, strict=True)):
            lp.plot.window_scan(results[f"twisted-{ensemble}"].scan, reference=PRINTED["lambda"], ax=ax)
            ax.set_title(f"({'abc'[k]})  {ENSEMBLE_LABELS[ensemble]}")
            ax.legend().remove()
            if k > 0:
                ax.set_ylabel("")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
        _limit_to_precise(panels[0], [fit for name in ENSEMBLES for fit in results[f"twisted-{name}"].scan])
    return figure


def _limit_to_precise(ax: Axes, fits: Sequence[lp.results.FiniteTimeFit]) -> None:
    # Windows that start late have errors many times the effect; their bars may leave the panel.
    precise = sorted(fits, key=lambda fit: fit.standard_errors["lambda"])[: max(2, 3 * len(fits) // 4)]
    low = min(fit.intervals["lambda"][0] for fit in precise)
    high = max(fit.intervals["lambda"][1] for fit in precise)
    ax.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))


def distribution(results: Results) -> Figure:
    """Exponents of the trajectories at the end: their density for the three ensembles, and against the energy."""
    twisted, ordinary = results["twisted-unit-vectors"], results["ordinary-unit-vectors"]
    highest = max(float(results[f"twisted-{name}"].final_exponent.max()) for name in ENSEMBLES)
    bins = np.linspace(0.0, 1.02 * highest, 90)
    with lp.plot.house_style():
        figure = new_figure(7.2, 3.3)
        left, right = figure.subplots(1, 2)
        for name in ENSEMBLES:
            lp.plot.exponent_distribution(
                results[f"twisted-{name}"].final_exponent,
                bins=bins.tolist(),
                label=ENSEMBLE_LABELS[name],
                colour=ENSEMBLE_COLOURS[name],
                filled=name == ENSEMBLES[0],
                ax=left,
            )
        _mark_ordinary(left, ordinary)
        left.set_xlabel(rf"$\lambda(t)$ at $t = {twisted.run.end_time:g}$")
        left.set_ylim(top=1.6 * left.dataLim.y1)
        left.set_title("(a)")
        left.legend(loc="upper right")
        _draw_energy(right, twisted, ordinary)
    return figure


def _mark_ordinary(ax: Axes, ordinary: RunResult) -> None:
    low, high = np.quantile(ordinary.final_exponent, [0.005, 0.995])
    ax.axvspan(low, high, color=MUTED, alpha=0.35, linewidth=0, label="ordinary top (99% of starts)")


def _draw_energy(ax: Axes, twisted: RunResult, ordinary: RunResult) -> None:
    from matplotlib.colors import LinearSegmentedColormap, LogNorm

    pale_to_dark = LinearSegmentedColormap.from_list("twisted", ["#f8e4da", TWISTED, "#4a1703"])
    energy_range = np.quantile(twisted.energy, [0.0005, 0.9995])
    counts, x_edges, y_edges = np.histogram2d(
        twisted.energy, twisted.final_exponent, bins=(70, 70), range=(energy_range, (0, twisted.final_exponent.max()))
    )
    mesh = ax.pcolormesh(
        x_edges,
        y_edges,
        np.ma.masked_less(counts.T, 1),
        cmap=pale_to_dark,
        norm=LogNorm(1, max(2.0, counts.max())),
        rasterized=True,
    )
    bar = ax.figure.colorbar(mesh, ax=ax, pad=0.02, aspect=30)
    bar.set_label("twisted starts per cell")
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.yaxis.set_minor_formatter("")
    shown = slice(0, None, max(1, len(ordinary.energy) // 1500))
    ax.plot(
        ordinary.energy[shown],
        ordinary.final_exponent[shown],
        ".",
        markersize=1.2,
        color=ORDINARY,
        rasterized=True,
    )
    ax.annotate("ordinary top", (0.03, 0.06), xycoords="axes fraction", color=ORDINARY, fontsize=9.5, bbox=_WHITE_BOX)
    ax.set_xlim(*energy_range)
    ax.set_ylim(bottom=0)
    ax.set(xlabel="energy $H$", ylabel=r"$\lambda(t)$", title="(b)")


def scalings(results: Results) -> Figure:
    """What the printed ratios of inertia allow, and what they would have given."""
    twisted = (
        ("twisted-unit-vectors", TWISTED, r"$I = (2, 2, 1)$"),
        ("twisted-halved-unit-vectors", THIRD, r"$I = (1, 1, \frac{1}{2})$"),
        ("twisted-as-printed-unit-vectors", VIOLET, r"$I = (1, 1, 2)$, as printed"),
    )
    ordinary = (
        ("ordinary-unit-vectors", ORDINARY, r"$I = (2, 2, 1)$"),
        ("ordinary-as-printed-unit-vectors", VIOLET, r"$I = (1, 1, 2)$, as printed"),
    )
    end = results["ordinary-as-printed-unit-vectors"].run.end_time
    with lp.plot.house_style():
        figure = new_figure(7.2, 3.2)
        left, right = figure.subplots(1, 2, sharey=True)
        for ax, readings, title in ((left, twisted, "(a)  twisted"), (right, ordinary, "(b)  ordinary")):
            for name, colour, label in readings:
                lp.plot.convergence(results[name].curve, colour=colour, label=label, ax=ax)
            time_axis(ax, 1.0, end)
            ax.set_title(title)
        late = np.geomspace(5, end, 200)
        left.plot(late, printed_fit(late), color=MUTED, linestyle=_DASHES, linewidth=1.1, label="fit as printed")
        left.set_ylim(0, 0.52)
        left.legend(loc="upper right")
        right.legend(loc="upper right")
        right.set_ylabel("")
    return figure


FIGURES: Mapping[str, Callable[[Results], Figure]] = {
    "lyapunov": lyapunov,
    "windows": windows,
    "distribution": distribution,
    "scalings": scalings,
}


def draw_all(results: Results, out: Path, tell: Callable[[str], None]) -> dict[str, Path]:
    """Draw every figure as PNG, SVG and PDF into `out`; returns the SVG of each."""
    paths: dict[str, Path] = {}
    for name, draw in FIGURES.items():
        tell(f"drawing {name}")
        lp.plot.save_figure(draw(results), out / name)
        paths[name] = out / f"{name}.svg"
    return paths
