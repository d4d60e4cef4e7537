"""Figures of fits: what was observed with its errors, the fitted orbits, and below them the residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import check_kind
from liepoisson.observations.orbit_fit import OrbitFit, with_error
from liepoisson.plot.labels import formula, label, plain
from liepoisson.plot.style import INK, MUTED, SEQUENCE, check_title_of_figure, house_style, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MOST_COLUMNS, _MOST_PANELS, _MOST_RUNS, _MOST_VALUES = 3, 9, 6, 4
_FEW_SIGMA = 6.0
"""Up to which residuals ticks stand at the edges of the band."""


@explains_its_arguments
def orbit_fit(fit: OrbitFit, *, title: str | None = None) -> Figure:
    r"""What was observed with its errors, the fitted orbits, and below them the residuals in units of the errors.

    A panel for each observable, a colour for each run; of more than nine observables or six runs the first are drawn.
    The band is that of two standard deviations.  Where errors were not given, those are drawn that follow from the
    residuals.  Observed angles are drawn at the turn at which the model has them.

    Example:
        >>> pendulum = lp.System(lp.canonical(1, names=["q"]), "p_q^2/2 - g*cos(q)", {"g": 9})
        >>> observed = {"t": [0.0, 0.25, 0.5, 0.75, 1.0], "q": [0.201, 0.143, 0.003, -0.142, -0.200]}
        >>> fit = lp.fits.orbit_fit(pendulum, observed, ["g", "q", "p_q"], starts={"p_q": 0})
        >>> [axes.get_ylabel() for axes in lp.plot.orbit_fit(fit).axes]
        ['$q$', 'residual / $\\sigma$']

    Args:
        fit: What `orbit_fit` returned.
        title: Above the figure; by default the name of the system and the fitted parameters.

    Returns:
        A figure that no window system knows of; `liepoisson.plot.save_figure` writes it.

    Raises:
        ParameterError: it is no fit, or its search had no trajectory.
    """
    check_title_of_figure(title)
    check_kind(fit, OrbitFit, "fit", "what orbit_fit returned", "make a fit first")
    if not np.isfinite(fit.residual).any():
        raise ParameterError("fit: wanted a fit with a trajectory; got one that has none; take another guess")
    n = min(len(fit.observables), _MOST_PANELS)
    across = min(n, _MOST_COLUMNS)
    down = -(-n // across)
    with house_style():
        figure = new_figure(1.2 + 5.0 * across if across < _MOST_COLUMNS else 12.0, 0.6 + 3.9 * down)
        heights = [3.0, 1.0] * down
        grid: Any = figure.subplots(2 * down, across, sharex="all", squeeze=False, height_ratios=heights)
        curves = [fit.curve(run) for run in range(min(len(fit.runs), _MOST_RUNS))]
        for k in range(across * down):
            above, below = grid[2 * (k // across) : 2 * (k // across) + 2, k % across]
            if k < n:
                _draw(above, below, fit, k, curves)
            else:
                above.remove()
                below.remove()
        for axes in grid[-1, : n - across * (down - 1)]:
            axes.set_xlabel("$t$")
        figure.align_ylabels()
        if title != "":
            figure.suptitle(
                _heading(fit) if title is None else plain(title), x=0.012, ha="left", fontsize=12, color=INK
            )
    return figure


def _draw(above: Any, below: Any, fit: OrbitFit, k: int, curves: list[Any]) -> None:
    """One observable: data and curves, and the residuals."""
    sigma = fit.deviation[:, k] * (1.0 if fit.errors_are_known else fit.scatter)
    below.axhspan(-2, 2, color=MUTED, alpha=0.12, linewidth=0)
    below.axhline(0, color=INK, linewidth=0.7)
    for run, (time, values) in enumerate(curves):
        rows = np.flatnonzero((fit.run_of == run) & np.isfinite(fit.residual[:, k]))
        colour = SEQUENCE[run % len(SEQUENCE)]
        error = np.nan_to_num(sigma[rows])
        above.plot(time, values[:, k], color=colour, linewidth=1.2, label=plain(f"run {fit.runs[run]}"))
        place = fit.predicted[rows, k] + fit.residual[rows, k]
        style = {"fmt": "o", "color": INK, "markerfacecolor": colour, "markeredgewidth": 0.6, "markersize": 3.6}
        bars = {"elinewidth": 0.8, "capsize": 1.6, "capthick": 0.8, "zorder": 3}
        above.errorbar(fit.time[rows], place, error, **style, **bars)
        with np.errstate(all="ignore"):
            ratio = fit.residual[rows, k] / sigma[rows]
        if np.isfinite(ratio).all():
            below.errorbar(fit.time[rows], ratio, np.ones(len(rows)), **style, **bars)
    largest = max((abs(limit) for limit in below.get_ylim()), default=1.0)
    below.set_ylim(-max(largest, 3.0), max(largest, 3.0))
    if largest < _FEW_SIGMA:
        below.set_yticks([-2, 0, 2])
    above.set_ylabel(formula(fit.observables[k]))
    below.set_ylabel(r"residual / $\sigma$")
    if k == 0 and len(curves) > 1:
        above.legend(loc="best")


def _heading(fit: OrbitFit) -> str:
    """The system, how the search ended where it did not converge, and the first fitted values."""
    values = [
        f"{_symbol(name)} = {with_error(value, error)}"
        for name, value, error in zip(fit.unknowns, fit.value, fit.error, strict=True)
    ]
    few = [*values[:_MOST_VALUES], *(["..."] if len(values) > _MOST_VALUES else [])]
    ending = "" if fit.ending == "converged" else f" ({fit.ending})"
    return f"{plain(fit.system.name)}{ending}\n{',  '.join(few)}"


def _symbol(name: str) -> str:
    """An unknown as mathematical text: a component at the start has its time."""
    component, at_start, run = name.partition("(t0)")
    written = label(component)
    if not at_start:
        return written
    return (f"{written[:-1]}(t_0)$" if written.endswith("$") else plain(component + at_start)) + plain(run)
