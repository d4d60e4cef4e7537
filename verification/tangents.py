r"""Are tangent vectors the derivative of the flow?  Against finite differences in extended precision.

The derivative of the exact flow along $v$ is $(\varphi(x + \delta v) - \varphi(x - \delta v)) / 2\delta$ up to
$\delta^2$.  With the reference integrator in 60 digits and $\delta = 10^{-20}$ both truncation and round-off are near
$10^{-40}$, and the equations of tangent vectors are used nowhere.  Each method's tangent vector is compared with
that, and its state with the exact one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb

import contenders
import figures
import liepoisson as lp
from problems import NONLINEAR, TOPS, first_tangents, integrate, relative_error, starts
from reference import DIGITS, agreed_digits, as_two_doubles, decimal_digits, flow
from settings import Settings
from store import Piece, Store

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contenders import Contender

T_END = 10.0
DELTA = "1e-20"
METHODS = (
    *contenders.SPLITTING.values(),
    *contenders.GAUSS.values(),
    contenders.FIXED,
    *contenders.WITH_TOLERANCES,
    contenders.MIXED,
)
STEPS = tuple(2.0**-k for k in range(1, 8))
TOLERANCES = tuple(10.0**-k for k in range(3, 16, 2))


def measure(settings: Settings, store: Store) -> dict[str, Any]:
    """Errors of state and tangent vector of every method, and the digits to which the two exact derivatives agree."""
    n = settings.choose(quick=2, full=8)
    points: list[dict[str, Any]] = []
    digits: list[int] = []
    for top in NONLINEAR:
        exact = [
            store.piece(f"differences-{top}-{k}", {"top": top, "k": k, "t": T_END}, lambda top=top, k=k: _exact(top, k))
            for k in range(n)
        ]
        digits += [int(piece["digits"]) for piece in exact]
        points += [
            _point(top, contender, value, exact)
            for contender in METHODS
            for value in (STEPS if contender.knob == "step" else TOLERANCES)
        ]
    return {"t_end": T_END, "starts": n, "agreed digits": min(digits), "points": points}


def _exact(top: str, k: int) -> dict[str, Any]:
    """State and derivative of one member, sums of two doubles, and the digits to which the tangent equation agrees."""
    field = TOPS[top].field()
    assert isinstance(field, lp.fields.TopField)
    x0, v0 = starts(top, k + 1)[k].tolist(), first_tangents(k + 1)[k].tolist()
    (both,) = flow(field, [*x0, *v0], [T_END])
    with decimal_digits(DIGITS):
        delta = arb(DELTA)
        moved = [[arb(x) + sign * delta * arb(v) for x, v in zip(x0, v0, strict=True)] for sign in (1, -1)]
        (plus,), (minus,) = (flow(field, [c.mid() for c in start], [T_END]) for start in moved)
        difference = [((p - q) / (2 * delta)).mid() for p, q in zip(plus, minus, strict=True)]
    high, low = as_two_doubles([both[:9], difference])
    return {"high": high, "low": low, "digits": agreed_digits(both[9:], difference)}


def _point(top: str, contender: Contender, value: float, exact: list[Piece]) -> dict[str, Any]:
    """Median and largest errors over the starts of one method at one setting."""
    n = len(exact)
    orbit = integrate(
        TOPS[top], starts(top, n), [0.0, T_END], contender.make(value), tangents=first_tangents(n)[:, None]
    )
    found: dict[str, Any] = {"top": top, "method": contender.name, "knob": contender.knob, "value": value}
    for k, (name, got) in enumerate((("state", orbit.state[:, -1]), ("tangent", orbit.tangent[:, -1, 0]))):
        high, low = (np.stack([piece[part][k] for piece in exact]) for part in ("high", "low"))
        errors = relative_error(got, high, low)
        found[name] = {"median": figures.number(np.median(errors)), "largest": figures.number(errors.max())}
    return found


def table(result: dict[str, Any]) -> str:
    """Errors at the finest setting of each method: medians, and the largest."""
    best: dict[str, dict[str, dict[str, Any]]] = {}
    for point in result["points"]:  # settings are in order, the finest last
        best.setdefault(point["method"], {})[point["top"]] = point
    tops = list(dict.fromkeys(point["top"] for point in result["points"]))
    titles = [f"{top} top: {part}" for top in tops for part in ("state", "tangent vector")]
    lines = [f"| method | {' | '.join(titles)} |", "|---|" + "---|" * len(titles)]
    for method, found in best.items():
        point = found[tops[0]]
        errors = [
            f"{figures.scientific(found[top][part]['median'])} ({figures.scientific(found[top][part]['largest'])})"
            for top in tops
            for part in ("state", "tangent")
        ]
        lines.append(f"| {method}, {figures.setting(point['knob'], point['value'])} | " + " | ".join(errors) + " |")
    lines += [
        "",
        f"Differences and the tangent equation, both in extended precision, agree to {result['agreed digits']} digits.",
    ]
    return "\n".join(lines)


def draw(result: dict[str, Any]) -> Figure:
    """Error of the tangent vector against that of the state; the line is where they are equal."""
    from liepoisson.plot.style import INK, new_figure

    figure = new_figure(8.2, 3.9)
    axes = figure.subplots(1, len(NONLINEAR), sharex=True, sharey=True)
    for ax, top in zip(axes, NONLINEAR, strict=True):
        for contender in METHODS:
            points = [p for p in result["points"] if p["top"] == top and p["method"] == contender.name]
            state, tangent = (
                np.array([p[part]["median"] for p in points], dtype=np.float64) for part in ("state", "tangent")
            )
            style = contender.style | {"linestyle": "none"}
            ax.loglog(state, tangent, markersize=3.6, label=contender.name, **style)
        ends = np.array([1e-16, 10.0])
        ax.loglog(ends, ends, color=INK, linewidth=0.8)
        ax.set_title(f"{top} top")
        ax.set_xlabel(f"error of the state at $t = {result['t_end']:g}$")
        figures.without_minor_labels(ax)
    axes[0].set_ylabel("error of the tangent vector")
    axes[-1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


FIGURES = {"tangents": draw}
