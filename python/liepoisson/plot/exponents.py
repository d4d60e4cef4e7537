r"""Figures of finite-time exponents: convergence of an ensemble, distribution, dependence on the fit window."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ShapeError
from liepoisson.formula.scalars import as_array, as_count, as_number
from liepoisson.indicators.finite_time_fit import FiniteTimeFit, LogFit, MeanCurve, mean_curve
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import listed, sequence
from liepoisson.inputs.refusals import not_a
from liepoisson.plot.section import heading_of
from liepoisson.plot.style import INK, MUTED, as_colour, axes_or_new, house_style, set_heading

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

    from liepoisson.indicators.finite_time_exponents import FiniteTimeExponents

FloatArray: TypeAlias = NDArray[np.float64]
GrowthLike: TypeAlias = "FiniteTimeExponents | Dataset"


@explains_its_arguments
def convergence(
    growth: GrowthLike | MeanCurve,
    *,
    fit: FiniteTimeFit | LogFit | None = None,
    label: str | None = None,
    colour: str | None = None,
    confidence: float = 0.95,
    ax: Axes | None = None,
) -> Axes:
    r"""Mean finite-time exponent of an ensemble against time, with its confidence band and a fit.

    The dark band is the confidence of the mean; for thousands of trajectories it is about as wide as the line.  When
    the curves of all trajectories are given, a light band holds the middle 90% of them.  Without label and fit the
    legend says so.  A fit is drawn solid inside its window and dotted outside.  Of one orbit there is one curve and no
    band.  Above a new figure stand the system and the energy and Casimirs of the orbits, or how many levels of these
    there are; of this the lines stay that are true of all that is drawn into it later.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 20, seed=1), t_end=100)
        >>> axes = lp.plot.convergence(growth, label="20 starts")
        >>> axes.get_xscale(), axes.get_legend().get_texts()[0].get_text()
        ('log', '20 starts')
        >>> plt.close(axes.figure)

    Args:
        growth: Result of `finite_time_exponents`, or a `MeanCurve`.
        fit: Result of `finite_time_fit` or `log_fit` for the same ensemble.
        label: Name of the ensemble in the legend.
        colour: Of the curve, by default the next of the cycle.
        confidence: Pointwise coverage of the dark band.

    Returns:
        The axes, with a logarithmic time axis.

    Raises:
        ShapeError: exponents not (trajectory, time).
        ParameterError: no trajectory finished, or fewer than two where a fit is to be drawn.
    """
    colour = as_colour(colour)
    with house_style():
        is_new, ax = ax is None, axes_or_new(ax)
        set_heading(ax, heading_of(growth), is_new=is_new)
        if not isinstance(growth, MeanCurve) and len(alone := _finished(growth)) == 1 and fit is None:
            return _draw_one(ax, np.asarray(growth.time), alone[0], label, colour)
        curve = growth if isinstance(growth, MeanCurve) else _mean_of(growth, confidence)
        explained = label is None and fit is None
        (line,) = ax.plot(curve.time, curve.mean, color=colour, label="mean" if explained else label, zorder=3)
        colour = cast("Any", line.get_color())
        if not isinstance(growth, MeanCurve):
            low, high = np.nanquantile(np.asarray(growth.exponent, np.float64), [0.05, 0.95], axis=0)
            words = "middle 90% of the orbits" if explained else None
            ax.fill_between(curve.time, low, high, color=colour, alpha=0.10, linewidth=0, zorder=1, label=words)
        words = f"{100 * curve.confidence:g}% interval of the mean" if explained else None
        ax.fill_between(curve.time, curve.low, curve.high, color=colour, alpha=0.35, linewidth=0, zorder=2, label=words)
        if fit is not None:
            draw_fit(ax, fit, curve.time)
        ax.set_xscale("log")
        time_axis(ax, curve.time[0], curve.time[-1])
        ax.set_ylabel(r"$\langle\lambda(t)\rangle$")
        ax.legend()
    return ax


def _finished(growth: GrowthLike) -> FloatArray:
    """The curves of the trajectories that finished; none where there are no curves of trajectories."""
    curves = np.asarray(growth.exponent, np.float64)
    return curves[np.isfinite(curves).all(axis=1)] if curves.ndim == 2 else curves[:0]


def _draw_one(ax: Axes, time: FloatArray, curve: FloatArray, label: str | None, colour: str | None) -> Axes:
    """The exponent of one orbit."""
    ax.plot(time, curve, color=colour, label=label, zorder=3)
    ax.set_xscale("log")
    time_axis(ax, time[0], time[-1])
    ax.set_ylabel(r"$\lambda(t)$")
    if label is not None:
        ax.legend()
    return ax


def _mean_of(growth: GrowthLike, confidence: float) -> MeanCurve:
    return mean_curve(growth.time, growth.exponent, confidence=confidence)


def draw_fit(ax: Axes, fit: FiniteTimeFit | LogFit, time: FloatArray) -> None:
    """A fitted law: solid inside its window, dotted where it is continued."""
    low, high = fit.window
    inside = np.geomspace(low, high, 200)
    law = fit_formula(fit)
    ax.plot(inside, fit.curve(inside), color=INK, linewidth=0.9, zorder=4, label=law)
    for start, end in ((max(time[0], low / 4), low), (high, time[-1])):
        if end > start:
            outside = np.geomspace(start, end, 100)
            ax.plot(outside, fit.curve(outside), color=INK, linewidth=0.9, linestyle=(0, (1, 2)), zorder=4)


def fit_formula(fit: FiniteTimeFit | LogFit) -> str:
    """The fitted law with its numbers, as mathematical text for a legend."""
    if isinstance(fit, LogFit):
        return rf"fit $({fit.A:.2f} + {fit.B:.3f}\,\ln t)/t$"
    return rf"fit ${fit.lambda_:.4f} {fit.c1:+.3f}/\sqrt{{t}} {fit.c0:+.2f}/t$"


def time_axis(ax: Axes, first: float, last: float) -> None:
    """Label a logarithmic time axis with plain numbers."""
    ax.set(xlim=(first, last), xlabel=r"$t$")
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter("")


@explains_its_arguments
def exponent_distribution(
    exponents: ArrayLike | GrowthLike,
    *,
    label: str | None = None,
    colour: str | None = None,
    bins: int | Sequence[float] = 80,
    filled: bool = True,
    ax: Axes | None = None,
) -> Axes:
    r"""Probability density of the exponents of the trajectories at one time.

    An ensemble of random starts mixes regular and chaotic orbits of many energies: its mean is not one exponent.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 50, seed=1), t_end=100)
        >>> axes = lp.plot.exponent_distribution(growth, bins=10)
        >>> print(f"{axes.get_ylabel()} of {axes.get_xlabel()}")
        probability density of $\lambda$
        >>> plt.close(axes.figure)

    Args:
        exponents: One exponent per trajectory, shape (trajectory,), in inverse time; those not finite are left out.  Of
            what `finite_time_exponents` returns, the exponents at the last time.
        label: Name in the legend.
        colour: Of the histogram.
        bins: Number of bins, or their edges.
        filled: Whether to shade the area under the outline.

    Raises:
        ShapeError: not one number per trajectory.
    """
    curves = getattr(exponents, "exponent", None)
    values = as_array(cast("ArrayLike", exponents), "exponents") if curves is None else np.asarray(curves)[:, -1]
    if values.ndim != 1:
        raise ShapeError(
            f"exponents must have shape (trajectory,), one number per trajectory; got {values.shape}. "
            "Take the last time, exponent[:, -1]?"
        )
    values = values[np.isfinite(values)]
    several, colour = listed(bins, "bins"), as_colour(colour)
    edges = as_count(bins, "bins", least=1) if several is None else as_array(several, "bins")
    with house_style():
        ax = axes_or_new(ax)
        density, edges = np.histogram(values, bins=edges, density=True)
        outline = np.concatenate([[0.0], np.repeat(density, 2), [0.0]])
        (line,) = ax.plot(np.repeat(edges, 2), outline, color=colour, linewidth=1.2, label=label, zorder=3)
        if filled:
            ax.fill_between(np.repeat(edges, 2), outline, color=line.get_color(), alpha=0.13, linewidth=0, zorder=2)
        ax.set(xlabel=r"$\lambda$", ylabel="probability density")
        ax.set_ylim(bottom=0)
        if label is not None:
            ax.legend()
    return ax


@explains_its_arguments
def window_scan(
    fits: Sequence[FiniteTimeFit],
    *,
    reference: float | None = None,
    reference_label: str = "as printed",
    ax: Axes | None = None,
) -> Axes:
    r"""The fitted $\lambda$ against the start of the window, one line per end of the window, with error bars.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 50, seed=1), t_end=500)
        >>> fits = lp.fits.window_scan(growth.time, growth.exponent, windows=[(20, 200), (50, 500)], n_bootstrap=100)
        >>> axes = lp.plot.window_scan(fits)
        >>> print(axes.get_ylabel(), "against the", axes.get_xlabel())
        fitted $\lambda$ against the start of the window
        >>> plt.close(axes.figure)

    Args:
        fits: Result of `liepoisson.fits.window_scan`.
        reference: A value to compare with, drawn as a horizontal line.
        reference_label: Its name in the legend.
    """
    fits = sequence(fits, "fits", "fits", "window_scan(time, exponent)")
    for fit in fits:
        if not isinstance(fit, FiniteTimeFit):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise not_a("fits of finite-time exponents", fit, "fits", "write fits.window_scan(time, exponent)")
    level = None if reference is None else as_number(reference, "reference", "a number")
    ends = sorted({fit.window[1] for fit in fits})
    with house_style():
        ax = axes_or_new(ax)
        if level is not None:
            ax.axhline(level, color=MUTED, linewidth=1.0, linestyle=(0, (5, 3)), label=reference_label, zorder=1)
        for k, end in enumerate(ends):
            line = sorted((fit for fit in fits if fit.window[1] == end), key=lambda fit: fit.window[0])
            # Shifted a little sideways, so that error bars of different ends stay apart.
            starts = np.array([fit.window[0] for fit in line]) * 1.025 ** (k - (len(ends) - 1) / 2)
            values = np.array([fit.lambda_ for fit in line])
            bars = np.array([fit.intervals["lambda"] for fit in line]).T
            ax.errorbar(
                starts,
                values,
                yerr=np.abs(bars - values),
                marker="o",
                markersize=3.6,
                linewidth=0.9,
                elinewidth=0.9,
                capsize=0,
                label=f"to $t = {end:g}$",
                zorder=3,
            )
        starts = sorted({fit.window[0] for fit in fits})
        ax.set_xscale("log")
        time_axis(ax, 0.85 * starts[0], 1.18 * starts[-1])
        ax.set_xticks(starts, minor=False)
        ax.minorticks_off()
        ax.set(xlabel="start of the window", ylabel=r"fitted $\lambda$")
        ax.legend()
    return ax
