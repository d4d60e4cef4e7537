r"""Is the numerical flow a Poisson map?  The defect $D\,J(x)\,D^T - J(\varphi(x))$, with $D$ the derivative of the map.

The columns of $D$ are nine tangent vectors that start as the identity.  The defect is the largest entry relative to
the largest entry of $J(\varphi(x))$, over one step and over many, for random tops and starts.  Round-off in it grows
with $|D|^2$.

For a method whose tangent vectors are the exact derivative of its map, as splitting and the Gauss methods have, this
is a property of the map.  An adaptive method's tangent vectors belong to the exact flow, of which the tolerance
leaves an error.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import contenders
import figures
import liepoisson as lp
from fits import measured_order
from problems import Array, integrate, poisson_tensor
from settings import Settings
from store import Store

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contenders import Contender

T_END = 8.0
HALVINGS = tuple(range(1, 8))
TOLERANCES = tuple(10.0**-k for k in range(3, 16))
LOW = {"one": 10**-12.5, "many": 1e-11}
HIGH = 1e-2
"""Defects between which powers are fitted: above round-off, which many steps add up, and small."""


def random_tops(n: int) -> list[lp.Top]:
    """Twisted tops: moments of random bodies, two of them equal in every other one; random vectors and cocycle."""
    rng = np.random.default_rng(2)
    tops: list[lp.Top] = []
    for k in range(n):
        p, q, r = rng.uniform(0.3, 1.0, 3)  # the sums of squares that make up the moments of a body
        inertia = (p + q, p + q, 2 * p) if k % 2 else (p + q, q + r, r + p)
        a, b = rng.uniform(-1, 1, (2, 3))
        tops.append(lp.Top.twisted(inertia=inertia, a=a.tolist(), b=b.tolist(), epsilon=float(rng.uniform(-1, 1))))
    return tops


def measure(settings: Settings, store: Store) -> dict[str, Any]:
    """Defects of every method against its step or tolerance, and the powers of the step."""
    n_tops, n_starts = settings.choose(quick=(4, 4), full=(16, 8))
    curves: list[dict[str, Any]] = []
    for contender in (*contenders.WITH_STEPS, *contenders.WITH_TOLERANCES):
        stepping = contender.knob == "step"
        values = [2.0**-k for k in HALVINGS] if stepping else TOLERANCES
        data = store.piece(
            f"defect-{contender.name}",
            {"method": contender.name, "values": values, "t": T_END, "tops": n_tops, "starts": n_starts},
            lambda contender=contender, values=values: _defects(contender, values, n_tops, n_starts),
        )
        curves.append(_curve(contender, np.array(values), data))
    return {"t_end": T_END, "tops": n_tops, "starts": n_starts, "curves": curves}


def _defects(contender: Contender, values: Any, n_tops: int, n_starts: int) -> dict[str, Array]:
    """Defects over one step (of methods that have one) and until T_END, shape (top and start, value)."""
    spans = {"many": lambda _: T_END} | ({"one": lambda value: value} if contender.knob == "step" else {})
    return {
        name: np.stack(
            [
                np.concatenate(
                    [_defect(top, contender.make(value), span(value), n_starts) for top in random_tops(n_tops)]
                )
                for value in values
            ],
            axis=1,
        )
        for name, span in spans.items()
    }


def _defect(top: lp.Top, method: Any, t_end: float, n_starts: int) -> Array:
    x0 = lp.sample_states(top, n_starts, seed=3)
    orbit = integrate(top, x0, [0.0, t_end], method, tangents=np.eye(9))
    return defect(top, x0, orbit.state[:, -1], orbit.tangent[:, -1])


def defect(top: lp.Top, x0: Array, x: Array, tangents: Array) -> Array:
    """The relative defect of a map from x0 to x, shape (n,), whose derivative has the columns `tangents` (n, 9, 9)."""
    D = np.swapaxes(tangents.astype(np.longdouble), 1, 2)
    before, transposed = poisson_tensor(top, x0), np.swapaxes(D, 1, 2)
    after = poisson_tensor(top, x)
    residual = D @ before @ transposed - after
    return np.asarray(np.abs(residual).max(axis=(1, 2)) / np.abs(after).max(axis=(1, 2)), dtype=np.float64)


def _curve(contender: Contender, values: Array, data: dict[str, Array]) -> dict[str, Any]:
    found: dict[str, Any] = {"method": contender.name, "knob": contender.knob, "value": values.tolist()}
    for name, defects in data.items():
        power = measured_order(values, defects, LOW[name], HIGH)
        found[name] = {
            "median": figures.numbers(np.median(defects, axis=0)),
            "largest": figures.numbers(defects.max(axis=0)),
            "power": figures.power(power),
        }
    return found


def shown(curve: dict[str, Any]) -> int:
    """The place of the step or tolerance that tables show."""
    return curve["value"].index(2.0**-3 if curve["knob"] == "step" else 1e-12)


def table(result: dict[str, Any]) -> str:
    """The defect at one step size or tolerance, and the power of the step, where there is one above round-off."""
    lines = [
        "| method | at | one step: median | largest | power of h | "
        f"until t = {result['t_end']:g}: median | largest | power |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for curve in result["curves"]:
        place = shown(curve)
        at = figures.setting(curve["knob"], curve["value"][place])
        cells: list[str] = []
        for name in ("one", "many"):
            part = curve.get(name)
            cells += (
                [figures.scientific(part[key][place]) for key in ("median", "largest")]
                + [figures.with_error(part["power"])]
                if part
                else ["", "", ""]
            )
        lines.append(f"| {curve['method']} | {at} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def draw(result: dict[str, Any]) -> Figure:
    """The median defect: over one step, until the end, and against the tolerance."""
    from liepoisson.plot.style import new_figure

    figure = new_figure(9.6, 3.7)
    axes = figure.subplots(1, 3, sharey=True)
    styles = {c.name: c.style for c in (*contenders.WITH_STEPS, *contenders.WITH_TOLERANCES)}
    panels = (("one", "step"), ("many", "step"), ("many", "tol"))
    for ax, (name, knob) in zip(axes, panels, strict=True):
        for curve in result["curves"]:
            if curve["knob"] == knob:
                medians = np.array(curve[name]["median"], dtype=np.float64)
                shown = np.where(medians > 0, medians, np.nan)
                ax.loglog(curve["value"], shown, markersize=3.2, label=curve["method"], **styles[curve["method"]])
        ax.set_xlabel("step $h$" if knob == "step" else "tolerance")
        figures.without_minor_labels(ax)
    for ax, title in zip(axes, ("one step", f"until $t = {result['t_end']:g}$", "adaptive methods"), strict=True):
        ax.set_title(title)
    axes[0].set_ylabel("median relative defect of $DJD^T = J\\circ\\varphi$")
    handles = [line for ax in (axes[0], axes[2]) for line in ax.get_lines()]
    axes[2].legend(handles, [str(line.get_label()) for line in handles], loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


FIGURES = {"poisson-defect": draw}
