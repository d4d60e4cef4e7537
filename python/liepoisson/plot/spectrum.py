r"""Figures of Lyapunov spectra: how the exponents settle, and what they come to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.numeric._checks import shown
from liepoisson.numeric.exponent_estimate import zero_threshold
from liepoisson.numeric.spectrum import Spectrum
from liepoisson.plot.labels import plain
from liepoisson.plot.style import INK, MUTED, SEQUENCE, house_style, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def spectrum(result: Spectrum, *, trajectory: int = 0, logarithmic: bool = True) -> Figure:
    r"""Running Lyapunov exponents of one trajectory against time, and their last values with error bars.

    The shaded band is $|\lambda| \le 3\ln t/t$: what is inside is consistent with zero at that time.  On the right,
    open circles are the mirror images $-\lambda_k$; they fall on the others where the spectrum comes in pairs.

    Args:
        result: What `lyapunov_spectrum` returns.
        trajectory: Which trajectory.
        logarithmic: Whether the axis of exponents is linear up to the band's last width and logarithmic beyond, so that
            zeros can be told from small exponents.

    Raises:
        ParameterError: no spectrum, no such trajectory, or it did not finish.
    """
    if not isinstance(result, Spectrum):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"result: wanted what lyapunov_spectrum returns; got {shown(result)}; call it first")
    n = len(result.outcome)
    if not isinstance(trajectory, int | np.integer) or not -n <= trajectory < n:  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"trajectory: wanted a number from 0 to {n - 1}; got {shown(trajectory)}")
    if not np.isfinite(result.exponent[trajectory]).all():
        raise ParameterError(
            f"trajectory: wanted one that finished; {trajectory} ended with {str(result.outcome[trajectory])!r}; "
            "take another"
        )
    with house_style():
        figure = new_figure(8.0, 4.2)
        left, right = figure.subplots(1, 2, sharey=True, width_ratios=(2.2, 1))
        _draw_running(left, result, trajectory)
        _draw_last(right, result, trajectory)
        if logarithmic:
            _scale(left, float(zero_threshold(result.time[-1])))
    return figure


def _scale(ax: Axes, bound: float) -> None:
    """Linear within the bound of the zeros, logarithmic beyond."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    ax.set_yscale("symlog", linthresh=bound, linscale=0.6)
    top = ax.get_ylim()[1]
    decades = [10.0**p for p in range(-12, 12) if bound <= 10.0**p <= top]
    ax.yaxis.set_major_locator(FixedLocator([*(-d for d in decades[::-1]), 0.0, *decades]))
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.yaxis.set_minor_locator(NullLocator())


def _draw_running(ax: Axes, result: Spectrum, trajectory: int) -> None:
    curves = result.exponent[trajectory]
    bound = zero_threshold(result.time)
    ax.fill_between(result.time, -bound, bound, color=MUTED, alpha=0.13, linewidth=0)
    for k, curve in enumerate(curves.T):
        ax.plot(result.time, curve, color=_colour(k, curves.shape[1]), linewidth=1.1)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    largest = 1.15 * np.abs(curves[len(curves) // 10 :]).max()
    ax.set_ylim(-largest, largest)
    ax.set_xlim(0.0, result.time[-1])
    ax.set_xlabel(r"$t$")
    ax.set_ylabel(r"$\lambda_k(t)$")
    ax.set_title(plain(result.system))


def _draw_last(ax: Axes, result: Spectrum, trajectory: int) -> None:
    values, errors = result.exponents[trajectory], result.error[trajectory]
    bound = float(zero_threshold(result.time[-1]))
    ax.axhspan(-bound, bound, color=MUTED, alpha=0.13, linewidth=0)
    numbers = np.arange(1, len(values) + 1)
    for k, number in enumerate(numbers):
        colour = _colour(k, len(values))
        ax.errorbar(number, values[k], yerr=errors[k], color=colour, marker="o", markersize=4, elinewidth=1.0)
    if len(values) == len(result.components):
        ax.plot(numbers, -values[::-1], "o", markersize=8, markerfacecolor="none", markeredgecolor=MUTED, linestyle="")
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.set_xticks(numbers)
    ax.set_xlabel(r"$k$")


def _colour(k: int, n: int) -> str:
    """Partners have the same colour; the middle is grey."""
    pair = min(k, n - 1 - k)
    return SEQUENCE[pair] if pair < min(2, n // 2) else MUTED
