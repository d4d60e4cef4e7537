r"""Figures of Lyapunov spectra: how the exponents settle, and what they come to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import shown
from liepoisson.numeric.time_scale import zero_threshold
from liepoisson.plot.labels import plain
from liepoisson.plot.style import INK, MUTED, SEQUENCE, house_style, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liepoisson.indicators.spectrum import Spectrum


@explains_its_arguments
def spectrum(result: Spectrum, *, trajectory: int = 0, enlarged: bool = True) -> Figure:
    r"""Running Lyapunov exponents of one trajectory against time, and their last values with error bars.

    All axes are linear.  Below, the middle of the same is enlarged, so that zeros can be told from small exponents.
    The shaded band is $|\lambda| \le 3\ln(t/T)/t$: what is inside is consistent with zero at that time.  Error bars on
    the right are one standard error over the time of this orbit; open circles are the mirror images $-\lambda_k$, which
    fall on the others where the spectrum comes in pairs.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> result = lp.lyapunov_spectrum(top, lp.sample_states(top, 1, seed=1), t_end=200)
        >>> figure = lp.plot.spectrum(result, enlarged=False)
        >>> print(figure.axes[0].get_ylabel(), "against", figure.axes[0].get_xlabel())
        $\lambda_k(t)$ against $t$

    Args:
        result: What `lyapunov_spectrum` returns.
        trajectory: Which trajectory.
        enlarged: Whether to add the lower row, from -2 to 2 times the last width of the band.

    Raises:
        ParameterError: no spectrum, no such trajectory, or it did not finish.
    """
    from liepoisson.indicators.spectrum import Spectrum

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
    curves = result.exponent[trajectory]
    largest = 1.15 * float(np.abs(curves[len(curves) // 10 :]).max())
    near = 2.0 * float(zero_threshold(result.time[-1], result.time_scale[trajectory]))
    rows = [largest, near] if enlarged and near < 0.9 * largest else [largest]
    with house_style():
        figure = new_figure(8.0, 4.2 if len(rows) == 1 else 6.8)
        panels = np.atleast_2d(figure.subplots(len(rows), 2, sharey="row", sharex="col", width_ratios=(2.2, 1)))
        for (left, right), size in zip(panels, rows, strict=True):
            _draw_running(left, result, trajectory)
            _draw_last(right, result, trajectory)
            left.set_ylim(-size, size)
        panels[0, 0].set_title(plain(result.system.name))
        panels[0, 1].set_title(f"at $t = {result.time[-1]:g}$\n± standard error")
        for ax, words in zip(panels[-1], (r"$t$", r"$k$"), strict=True):
            ax.set_xlabel(words)
        if len(rows) > 1:
            panels[1, 0].set_title(f"the same, enlarged {largest / near:.2g} times")
    return figure


def _draw_running(ax: Axes, result: Spectrum, trajectory: int) -> None:
    curves = result.exponent[trajectory]
    bound = zero_threshold(result.time, result.time_scale[trajectory])
    ax.fill_between(result.time, -bound, bound, color=MUTED, alpha=0.13, linewidth=0)
    for k, curve in enumerate(curves.T):
        ax.plot(result.time, curve, color=_colour(k, curves.shape[1]), linewidth=1.1)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.set_xlim(0.0, result.time[-1])
    ax.set_ylabel(r"$\lambda_k(t)$")


def _draw_last(ax: Axes, result: Spectrum, trajectory: int) -> None:
    values, errors = result.end_exponent[trajectory], result.error[trajectory]
    bound = float(zero_threshold(result.time[-1], result.time_scale[trajectory]))
    ax.axhspan(-bound, bound, color=MUTED, alpha=0.13, linewidth=0)
    numbers = np.arange(1, len(values) + 1)
    for k, number in enumerate(numbers):
        colour = _colour(k, len(values))
        ax.errorbar(number, values[k], yerr=errors[k], color=colour, marker="o", markersize=4, elinewidth=1.0)
    if len(values) == len(result.components):
        ax.plot(numbers, -values[::-1], "o", markersize=8, markerfacecolor="none", markeredgecolor=MUTED, linestyle="")
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.set_xticks(numbers)


def _colour(k: int, n: int) -> str:
    """Partners have the same colour; the middle is grey."""
    pair = min(k, n - 1 - k)
    return SEQUENCE[pair] if pair < min(2, n // 2) else MUTED
