r"""Forward to T and back: how far from the start does a trajectory end?  And what does that say?

A symmetric method ($\Phi_{-h}\circ\Phi_h = 1$: splitting, Gauss) returns to round-off, times the growth of
perturbations, whatever its error on the way.  So the distance is shown beside the error at T: for these methods it
tests the implementation, for the others it measures accuracy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import contenders
import figures
from problems import TOPS, integrate, relative_error, starts
from references import exact_flow
from settings import Settings
from store import Store

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contenders import Contender

TOP = "twisted Kovalevskaya"
TIMES = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)
T_ERROR = 20.0
STEP = 0.125
CONTENDERS: tuple[tuple[Contender, float], ...] = (
    (contenders.TAYLOR, 1e-15),
    (contenders.TAYLOR, 1e-8),
    (contenders.ADAPTIVE, 1e-8),
    *((contender, STEP) for contender in contenders.WITH_STEPS),
)


def measure(settings: Settings, store: Store) -> dict[str, Any]:
    """Distances on return against T, and errors at T_ERROR."""
    n = settings.choose(quick=8, full=64)
    rows: list[dict[str, Any]] = []
    for contender, value in CONTENDERS:
        data = store.piece(
            f"reversal-{contender.name}",
            {"top": TOP, "method": contender.name, "value": value, "n": n, "times": TIMES, "error at": T_ERROR},
            lambda contender=contender, value=value: _distances(contender, value, n),
        )
        rows.append(
            {
                "method": contender.name,
                "at": figures.setting(contender.knob, value),
                "median": figures.numbers(np.median(data["distance"], axis=0)),
                "largest": figures.numbers(data["distance"].max(axis=0)),
                "error": figures.number(np.median(data["error"])),
            }
        )
    return {"top": TOP, "members": n, "times": TIMES, "error at": T_ERROR, "rows": rows}


def _distances(contender: Contender, value: float, n: int) -> dict[str, Any]:
    """Relative distances on return, shape (member, time), and relative errors at T_ERROR, shape (member,)."""
    top, x0, method = TOPS[TOP], starts(TOP, n), contender.make(value)
    out = integrate(top, x0, [0.0, *TIMES], method).state[:, 1:]
    back = [integrate(top, out[:, k], [time, 0.0], method).state[:, -1] for k, time in enumerate(TIMES)]
    distance = np.linalg.norm(np.stack(back, axis=1) - x0[:, None], axis=-1) / np.linalg.norm(x0, axis=-1)[:, None]
    high, low = exact_flow(TOP, n, T_ERROR)
    return {"distance": distance, "error": relative_error(out[:, TIMES.index(T_ERROR)], high[:, :9], low[:, :9])}


def table(result: dict[str, Any]) -> str:
    """Distances at two times beside the error."""
    shown = [result["times"].index(time) for time in (result["error at"], result["times"][-1])]
    lines = [
        "| method | at | "
        + " | ".join(f"back from {result['times'][k]:g}: median | largest" for k in shown)
        + f" | error at t = {result['error at']:g}: median |",
        "|---|---|" + "---|---|" * len(shown) + "---|",
    ]
    for row in result["rows"]:
        cells = [figures.scientific(row[size][k]) for k in shown for size in ("median", "largest")]
        lines.append(
            f"| {row['method']} | {row['at']} | " + " | ".join([*cells, figures.scientific(row["error"])]) + " |"
        )
    return "\n".join(lines)


def draw(result: dict[str, Any]) -> Figure:
    """Median distance on return against T."""
    from liepoisson.plot.style import new_figure

    figure = new_figure(7.2, 4.2)
    ax = figure.add_subplot()
    for (contender, _), row in zip(CONTENDERS, result["rows"], strict=True):
        label = f"{row['method']}, {row['at']}"
        dashes = "--" if label == f"Taylor, {figures.setting('tol', 1e-8)}" else "-"
        medians = np.array(row["median"], dtype=np.float64)
        ax.loglog(result["times"], medians, markersize=3.6, linestyle=dashes, label=label, **contender.style)
    ax.set_xlabel("$T$")
    ax.set_ylabel("median distance from the start after $T$ and back")
    figures.without_minor_labels(ax)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


FIGURES = {"reversal": draw}
