r"""What does accuracy cost?  Errors of state and tangent vector at t = 20 against CPU time, method by method.

Errors are those of the trajectory and its tangent vector against the reference in 32 digits, as medians and 95%
quantiles over members: energy would flatter methods that keep it.  Times are CPU seconds of one thread for a unit of
time of one trajectory with one tangent vector, medians of repeats in which all settings take turns; on a shared
machine they compare methods, no more.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np

import contenders
import figures
from problems import NONLINEAR, TOPS, Array, first_tangents, integrate, relative_error, starts
from references import exact_flow
from settings import Settings
from store import Piece, Store

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contenders import Contender

T_END = 20.0
STEPS = tuple(2.0 ** (-k / 2) for k in range(1, 12))
TOLERANCES = tuple(10.0 ** (-k / 2) for k in range(4, 31))
METHODS = (
    *contenders.SPLITTING.values(),
    *contenders.GAUSS.values(),
    contenders.FIXED,
    contenders.ADAPTIVE,
    contenders.TAYLOR,
    contenders.MIXED,
    contenders.SINGLE_SPLITTING,
    contenders.SINGLE_RUNGE_KUTTA,
)
LEVELS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
N_TIMED = 512
"""Trajectories of a timed run: the members over and over, so that starting a run does not count."""


def measure(settings: Settings, store: Store) -> dict[str, Any]:
    """Errors and CPU times of all settings of all methods."""
    n, repeats = settings.choose(quick=(8, 3), full=(64, 9))
    points: list[dict[str, Any]] = []
    for top in NONLINEAR:
        runs = [(contender, value) for contender in METHODS for value in _values(contender)]
        question = {
            "top": top,
            "n": n,
            "repeats": repeats,
            "t": T_END,
            "timed": N_TIMED,
            "runs": [(c.name, v) for c, v in runs],
        }
        data = store.piece(f"work-{top}", question, lambda top=top, runs=runs: _measure(top, runs, n, repeats))
        points += [_point(top, *run, data, k) for k, run in enumerate(runs)]
    return {"t_end": T_END, "members": n, "repeats": repeats, "levels": LEVELS, "points": points}


def _values(contender: Contender) -> list[float]:
    """Settings from coarse to fine; a step divides the time, near the one in the list."""
    if contender.knob == "tol":
        return [tol for tol in TOLERANCES if tol > 1e-14 or contender is contenders.TAYLOR]
    return [contenders.exactly(T_END, round(T_END / step)) for step in STEPS]


def _measure(top: str, runs: list[tuple[Contender, float]], n: int, repeats: int) -> dict[str, Array]:
    """Errors, shape (run, member), and CPU seconds for a unit of time of one trajectory, shape (run, repeat)."""
    methods = [contender.make(value) for contender, value in runs]
    x0, v0, (high, low) = starts(top, n), first_tangents(n)[:, None], exact_flow(top, n, T_END)
    state, tangent = [], []
    for method in methods:
        orbit = integrate(TOPS[top], x0, [0.0, T_END], method, tangents=v0)
        state.append(relative_error(orbit.state[:, -1], high[:, :9], low[:, :9]))
        tangent.append(relative_error(orbit.tangent[:, -1, 0], high[:, 9:], low[:, 9:]))
    many = [np.resize(array, (N_TIMED, *array.shape[1:])) for array in (x0, v0)]
    seconds = [[_cpu_seconds(top, method, *many) for method in methods] for _ in range(repeats)]
    return {"state": np.stack(state), "tangent": np.stack(tangent), "seconds": np.array(seconds).T}


def _cpu_seconds(top: str, method: Any, x0: Array, v0: Array) -> float:
    began = time.process_time()
    integrate(TOPS[top], x0, [0.0, T_END], method, tangents=v0, threads=1)
    return (time.process_time() - began) / (N_TIMED * T_END)


def _point(top: str, contender: Contender, value: float, data: Piece, k: int) -> dict[str, Any]:
    found: dict[str, Any] = {
        "top": top,
        "method": contender.name,
        "knob": contender.knob,
        "value": value,
        "seconds": figures.number(np.median(data["seconds"][k])),
    }
    for name in ("state", "tangent"):
        errors = data[name][k]
        found[name] = {
            "median": figures.number(np.median(errors)),
            "95%": figures.number(np.quantile(errors, 0.95)) if np.isfinite(errors).all() else None,
        }
    return found


def table(result: dict[str, Any]) -> str:
    """The least CPU time at which the median errors of state and tangent vector are both at most a level."""
    header = " | ".join(f"{level:.0e}" for level in result["levels"])
    lines = [f"| top | method | {header} |", "|---|---|" + "---|" * len(result["levels"])]
    for top in NONLINEAR:
        for contender in METHODS:
            points = [p for p in result["points"] if p["top"] == top and p["method"] == contender.name]
            cells = [cheapest(points, level) for level in result["levels"]]
            lines.append(f"| {top} | {contender.name} | " + " | ".join(cells) + " |")
    return "CPU nanoseconds for a unit of time, and the step or tolerance:\n\n" + "\n".join(lines)


def cheapest(points: list[dict[str, Any]], level: float) -> str:
    """The least time at which both errors are at most a level, and the setting."""
    good = [p for p in points if all((p[name]["median"] or np.inf) <= level for name in ("state", "tangent"))]
    if not good:
        return "–"
    best = min(good, key=lambda point: point["seconds"])
    return f"{1e9 * best['seconds']:.0f} ({figures.setting(best['knob'], best['value']).split()[-1]})"


def draw(result: dict[str, Any]) -> Figure:
    """CPU time against the error: rows are tops; left the state, right the tangent vector; bars reach to 95%."""
    from liepoisson.plot.style import new_figure

    figure = new_figure(9.0, 7.0)
    axes = figure.subplots(2, 2, sharex=True, sharey=True)
    for row, top in zip(axes, NONLINEAR, strict=True):
        for ax, name in zip(row, ("state", "tangent"), strict=True):
            for contender in METHODS:
                _curve(
                    ax,
                    [p for p in result["points"] if p["top"] == top and p["method"] == contender.name],
                    name,
                    contender,
                )
            figures.without_minor_labels(ax)
        row[0].set_ylabel(f"{top} top\nCPU seconds per unit of time")
    for ax, title in zip(axes[0], ("state", "tangent vector"), strict=True):
        ax.set_title(title)
    for ax in axes[1]:
        ax.set_xlabel(f"relative error at $t = {result['t_end']:g}$, median to 95%")
    axes[0, 0].set_xlim(1e-15, 3.0)
    axes[0, 1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _curve(ax: Any, points: list[dict[str, Any]], name: str, contender: Contender) -> None:
    median, high = (np.array([p[name][key] for p in points], dtype=np.float64) for key in ("median", "95%"))
    seconds = [p["seconds"] for p in points]
    ax.loglog(median, seconds, markersize=3, label=contender.name, **contender.style)
    ax.hlines(seconds, median, high, color=contender.colour, linewidth=0.5, alpha=0.5)


FIGURES = {"work-precision": draw}
