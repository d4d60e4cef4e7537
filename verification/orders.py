r"""Which order does each method have?  The error of the state at the end against the step, on two nonlinear tops.

Methods with a step: the slope of $\ln$ error against $\ln h$.  Taylor's method takes its steps from a tolerance; at a
fixed order N of the series its error is set against the mean step that it took, and against the tolerance.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import contenders
import figures
import liepoisson as lp
from fits import measured_order
from problems import NONLINEAR, TOPS, Array, integrate, relative_error, starts
from references import exact_flow
from settings import Settings
from store import Piece, Store

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contenders import Contender

T_END = 4.0
TAYLOR_T_END = 20.0
"""Later, since Taylor's steps are so long that a few of them would not make a mean."""
LOW, HIGH = 10**-11.5, 1e-2
"""Between round-off, amplified a little by T_END, and what is no longer asymptotic."""
COUNTS = (8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 80, 96, 128, 192, 256, 384, 512, 768, 1024, 2048, 4096)
"""Numbers of steps; every method has several whose errors lie between the two bounds."""
TAYLOR_ORDERS = (8, 12, 16, 20)
TOLERANCES = tuple(float(tol) for tol in np.geomspace(1e-2, 1e-14, 25))


def measure(settings: Settings, store: Store) -> dict[str, Any]:
    """Errors and fitted orders of every method on every top."""
    n = settings.choose(quick=4, full=16)
    curves: list[dict[str, Any]] = []
    for top in NONLINEAR:
        for contender in contenders.WITH_STEPS:
            data = store.piece(
                f"orders-{contender.name}-{top}",
                {"top": top, "method": contender.name, "n": n, "t": T_END, "counts": COUNTS},
                lambda top=top, contender=contender: _against_step(top, contender, n),
            )
            curves.append(_curve(top, contender.name, contender.order, data))
        for order in TAYLOR_ORDERS:
            data = store.piece(
                f"orders-taylor-{order}-{top}",
                {"top": top, "order": order, "n": n, "t": TAYLOR_T_END, "tolerances": TOLERANCES},
                lambda top=top, order=order: _taylor(top, order, n),
            )
            curve = _curve(top, f"Taylor, N = {order}", order, data)
            against_tolerance = measured_order(np.array(TOLERANCES), data["error"], LOW, HIGH)
            curves.append(curve | {"tolerance": figures.power(against_tolerance)})
    return {"t_end": T_END, "taylor t_end": TAYLOR_T_END, "starts": n, "low": LOW, "high": HIGH, "curves": curves}


def _against_step(top: str, contender: Contender, n: int) -> Piece:
    methods = [contender.make(contenders.exactly(T_END, count)) for count in COUNTS]
    return {"step": T_END / np.array(COUNTS)} | _errors(top, methods, n, T_END)


def _taylor(top: str, order: int, n: int) -> Piece:
    found = _errors(top, [lp.Taylor(tol=tol, order=order) for tol in TOLERANCES], n, TAYLOR_T_END)
    return found | {"step": TAYLOR_T_END / found["n_steps"]}


def _errors(top: str, methods: list[Any], n: int, t_end: float) -> Piece:
    """Relative errors of the state and numbers of steps, shape (start, method)."""
    x0, (high, low) = starts(top, n), exact_flow(top, n, t_end)
    orbits = [integrate(TOPS[top], x0, [0.0, t_end], method) for method in methods]
    errors = [relative_error(orbit.state[:, -1], high[:, :9], low[:, :9]) for orbit in orbits]
    return {"error": np.stack(errors, axis=1), "n_steps": np.stack([orbit.n_steps for orbit in orbits], axis=1)}


def _curve(top: str, name: str, order: int | None, data: dict[str, Any]) -> dict[str, Any]:
    steps = np.broadcast_to(data["step"], data["error"].shape)
    return {
        "top": top,
        "method": name,
        "declared": order,
        "measured": figures.power(measured_order(steps, data["error"], LOW, HIGH)),
        "step": figures.numbers(np.exp(np.log(steps).mean(axis=0))),
        "error": figures.numbers(_geometric_mean(data["error"])),
    }


def _geometric_mean(errors: Array) -> Array:
    return np.asarray(np.exp(np.log(np.maximum(errors, 1e-18)).mean(axis=0)))


def table(result: dict[str, Any]) -> str:
    """Measured against declared orders."""
    lines = [
        "| method | declared | " + " | ".join(f"{top} top" for top in NONLINEAR) + " |",
        "|---|---|" + "---|" * len(NONLINEAR),
    ]
    for name in dict.fromkeys(curve["method"] for curve in result["curves"]):
        row = [next(c for c in result["curves"] if c["method"] == name and c["top"] == top) for top in NONLINEAR]
        cells = [figures.with_error(curve["measured"]) for curve in row]
        lines.append(f"| {name} | {row[0]['declared']} | " + " | ".join(cells) + " |")
    slopes = [c["tolerance"]["value"] for c in result["curves"] if c.get("tolerance")]
    lines += ["", f"Taylor's error against its tolerance: powers from {min(slopes):.2f} to {max(slopes):.2f}."]
    return "\n".join(lines)


def draw(result: dict[str, Any]) -> Figure:
    """Error against step: above the methods with a step, below Taylor's at fixed orders of the series."""
    from liepoisson.plot.style import new_figure

    figure = new_figure(7.4, 6.6)
    axes = figure.subplots(2, 2, sharey=True)
    steps = {contender.name: contender.style for contender in contenders.WITH_STEPS}
    taylor = {
        f"Taylor, N = {order}": contenders.TAYLOR.style | {"marker": marker}
        for order, marker in zip(TAYLOR_ORDERS, "os^D", strict=True)
    }
    for column, top in enumerate(NONLINEAR):
        for row, styles in enumerate((steps, taylor)):
            _panel(axes[row, column], result, top, styles)
        axes[0, column].set_title(f"{top} top")
        axes[1, column].set_xlabel("(mean) step $h$")
    for row in (0, 1):
        t_end = result["taylor t_end" if row else "t_end"]
        axes[row, 0].set_ylabel(rf"error of the state at $t = {t_end:g}$")
        axes[row, 1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _panel(ax: Axes, result: dict[str, Any], top: str, styles: dict[str, dict[str, Any]]) -> None:
    ax.axhspan(result["low"], result["high"], color="#f4f2ea", linewidth=0)  # what the fits use
    for curve in result["curves"]:
        if curve["top"] == top and curve["method"] in styles:
            errors = np.array(curve["error"], dtype=np.float64)
            ax.loglog(curve["step"], errors, markersize=3.2, label=curve["method"], **styles[curve["method"]])
    ax.set_ylim(1e-17, 10)
    figures.without_minor_labels(ax)


FIGURES = {"orders": draw}
