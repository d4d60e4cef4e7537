r"""Figures of chaos indicators against time, one curve for each orbit, and of Lyapunov spectra."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import as_count, as_number
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import sequence, texts
from liepoisson.inputs.refusals import check_kind, shown
from liepoisson.numeric.time_scale import zero_threshold
from liepoisson.plot.exponents import time_axis
from liepoisson.plot.section import heading_of
from liepoisson.plot.style import INK, MUTED, SEQUENCE, axes_or_new, house_style, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

    from liepoisson.indicators.alignment import Alignment
    from liepoisson.indicators.megno import Megno
    from liepoisson.indicators.spectrum import Spectrum
    from liepoisson.indicators.verdict import Rule

# The axes of growth and MEGNO are linear up to here, so that ln t and 2 can be read, and logarithmic beyond.
_LINEAR_TO = 10.0
# Beyond so many curves a legend would hide them.
_MOST_LABELS = 6


@explains_its_arguments
def indicators(
    growth: Megno | Dataset,
    angle: Alignment | Dataset,
    *,
    members: Sequence[int] | None = None,
    labels: Sequence[str] | None = None,
    decided_at: float | None = None,
    rule: Rule | None = None,
    axes: Sequence[Axes] | None = None,
) -> tuple[Axes, Axes, Axes]:
    r"""Growth $\ln|v|$, mean MEGNO and SALI of orbits against time, in three panels with the same time axis.

    Dashed are $\ln(t/t_0)$ from the first time on, whose rise is that of a torus in any unit of time, the 2 of a torus,
    and the round-off at the foot of SALI; thin lines are the thresholds between which MEGNO and SALI do not vote.  The
    axes of growth and MEGNO are linear up to 10 and logarithmic beyond.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> system, starts = lp.catalog.system("henon-heiles"), [[0, 0.1, 0.3, 0], [0, -0.1, 0.5, 0]]
        >>> growth, angle = lp.chaos.megno(system, starts, t_end=500), lp.chaos.alignment(system, starts, t_end=500)
        >>> top, middle, bottom = lp.plot.indicators(growth, angle, labels=["regular", "chaotic"])
        >>> bottom.get_ylabel(), bottom.get_yscale()
        ('SALI', 'log')
        >>> plt.close(top.figure)

    Args:
        growth: Result of `megno`.
        angle: Result of `alignment` for the same starts.
        members: Which trajectories to draw; by default all.
        labels: A name for each of them, for the legend.
        decided_at: A time to mark, such as the `t_end` of a verdict.
        rule: Whose thresholds to draw; by default those of `decide`.
        axes: Three axes to draw into, by default those of a new figure, one below the other.

    Returns:
        The three axes.

    Raises:
        ShapeError: not three axes, or results for different numbers of trajectories.
        ParameterError: other objects than such results, a trajectory that is not there, or not one label for each.
    """
    _check_results(growth, angle)
    log_growth, mean, sali = (np.asarray(values) for values in (growth.log_growth, growth.mean, angle.sali))
    if len(mean) != len(sali):
        raise ShapeError(f"growth and angle must be of the same trajectories; got {len(mean)} and {len(sali)}.")
    given = range(len(mean)) if members is None else sequence(members, "members", "numbers", "members=[0, 1]")
    chosen = [as_count(k, "members", most=len(mean) - 1) for k in given]
    if not chosen:
        raise ParameterError("members: wanted at least one trajectory; got none; leave it out for all of them")
    labels = None if labels is None else texts(labels, "labels", "texts", 'labels=["regular", "chaotic"]')
    if labels is not None and len(labels) != len(chosen):
        raise ParameterError(f"labels: wanted one for each of {len(chosen)} trajectories; got {len(labels)}")
    from liepoisson.indicators.verdict import as_rule

    chosen_rule = as_rule(rule)
    mark = None if decided_at is None else as_number(decided_at, "decided_at", "a time")
    from matplotlib.ticker import FixedLocator

    t, t_angle = np.asarray(growth.time), np.asarray(angle.time)
    with house_style():
        top, middle, low = _panels(axes)
        for i, k in enumerate(chosen):
            colour, label = SEQUENCE[i % len(SEQUENCE)], None if labels is None else labels[i]
            top.plot(t, log_growth[k], color=colour, label=label)
            middle.plot(t, mean[k], color=colour)
            low.plot(t_angle, sali[k], color=colour)
        first, last = max(t[0], t_angle[0]), min(t[-1], t_angle[-1])
        reference: dict[str, Any] = {"color": MUTED, "linewidth": 0.9, "linestyle": (0, (5, 3)), "zorder": 1}
        torus_time = np.geomspace(first, last, 100)
        top.plot(torus_time, np.log(torus_time / first), label=r"$\ln(t/t_0)$", **reference)
        middle.axhline(2.0, **reference)
        low.axhline(1e-16, **reference)
        for ax, thresholds in ((middle, chosen_rule.megno), (low, chosen_rule.sali)):
            for threshold in thresholds:
                ax.axhline(threshold, color=MUTED, linewidth=0.5, zorder=1)
        scale = f"(linear to {_LINEAR_TO:g}, then log)"
        names = r"$\ln|v(t)|$" "\n" + scale, r"$\overline{Y}(t)$" "\n" + scale, "SALI"
        for ax, name in zip((top, middle, low), names, strict=True):
            ax.set_xscale("log")
            time_axis(ax, first, last)
            ax.set_ylabel(name)
            if mark is not None:
                ax.axvline(mark, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
        for ax in (top, middle):
            ax.set_yscale("symlog", linthresh=_LINEAR_TO)
            ax.set_ylim(bottom=0.0)
            ax.set_xlabel("")
            # 5 lies halfway to 10: so far the axis is linear, and the ticks show it
            ax.yaxis.set_major_locator(FixedLocator([0.0, 5.0, *(10.0**k for k in range(1, 16))]))
            ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        low.set_yscale("log")
        if labels is not None and len(labels) <= _MOST_LABELS:
            top.legend()
    return top, middle, low


def _check_results(growth: object, angle: object) -> None:
    wanted = (
        ("growth", growth, "megno", ("time", "log_growth", "mean")),
        ("angle", angle, "alignment", ("time", "sali")),
    )
    for name, given, function, attributes in wanted:
        if not all(hasattr(given, attribute) for attribute in attributes):
            raise ParameterError(f"{name}: wanted what {function} returns; got {shown(given)}; call {function} first")


def _panels(axes: Sequence[Axes] | None) -> tuple[Axes, Axes, Axes]:
    if axes is None:
        import matplotlib.pyplot as plt

        axes = list(plt.figure(figsize=(6.4, 6.6)).subplots(3, 1, sharex=True))
    axes = sequence(axes, "axes", "axes", "figure.subplots(3)")
    if len(axes) != 3:
        raise ShapeError(f"axes must be three, for growth, MEGNO and SALI; got {len(axes)}.")
    return axes_or_new(axes[0]), axes_or_new(axes[1]), axes_or_new(axes[2])


@explains_its_arguments
def spectrum(result: Spectrum, *, trajectory: int = 0, enlarged: bool = True) -> Figure:
    r"""Running Lyapunov exponents of one trajectory against time, and their last values with error bars.

    All axes are linear.  Below, the middle of the same is enlarged, so that zeros can be told from small exponents.
    The shaded band is $|\lambda| \le 3\ln(t/T)/t$: what is inside is consistent with zero at that time.  Error bars on
    the right are one standard error over the time of this orbit; open circles are the mirror images
    $-\lambda_{n+1-k}$, which fall on the others where the spectrum comes in pairs.  Partners have one colour.  A legend
    says so, and above stand system, energy and Casimirs and, of several trajectories, which one it is.

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

    check_kind(result, Spectrum, "result", "what lyapunov_spectrum returns", "call it first")
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
        figure = new_figure(8.0, 4.6 if len(rows) == 1 else 7.2)
        panels = np.atleast_2d(figure.subplots(len(rows), 2, sharey="row", sharex="col", width_ratios=(2.2, 1)))
        for (left, right), size in zip(panels, rows, strict=True):
            _draw_running(left, result, trajectory)
            _draw_last(right, result, trajectory)
            left.set_ylim(-size, size)
        which = [f"trajectory {result.first + trajectory % n}, one of {n}"] if n > 1 else []
        panels[0, 0].set_title("\n".join(filter(None, [heading_of(result, trajectory), *which])))
        panels[0, 1].set_title(f"at $t = {result.time[-1]:g}$\n± standard error")
        for ax, words in zip(panels[-1], (r"$t$", r"$k$"), strict=True):
            ax.set_xlabel(words)
        if len(rows) > 1:
            panels[1, 0].set_title(f"the same, enlarged {largest / near:.2g} times")
        figure.legend(handles=_explained(result, curves.shape[1]), loc="outside lower center", ncols=3)
    return figure


def _explained(result: Spectrum, n: int) -> list[Any]:
    """What the legend has: the exponents of each colour, the band, and the rings where there are some."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    colours = [_colour(k, result) for k in range(n)]
    handles: list[Any] = []
    for colour in dict.fromkeys(colours):
        places = [k for k in range(n) if colours[k] == colour]
        names = [rf"$\lambda_{{{k + 1}}}$" for k in places]
        in_a_row = len(places) > 2 and places[-1] - places[0] == len(places) - 1
        words = f"{names[0]} to {names[-1]}" if in_a_row else ", ".join(names)
        handles.append(Line2D([], [], color=colour, marker="o", markersize=4, label=words))
    handles.append(Patch(color=MUTED, alpha=0.13, label=r"consistent with zero: $|\lambda| \leq 3\,\ln(t/T)/t$"))
    if _is_whole(result):
        ring: dict[str, Any] = {"markersize": 8, "markerfacecolor": "none", "markeredgecolor": MUTED, "linestyle": ""}
        words = rf"mirror images $-\lambda_{{{n + 1} - k}}$"
        handles.append(Line2D([], [], marker="o", label=words, **ring))
    return handles


def _draw_running(ax: Axes, result: Spectrum, trajectory: int) -> None:
    curves = result.exponent[trajectory]
    bound = zero_threshold(result.time, result.time_scale[trajectory])
    ax.fill_between(result.time, -bound, bound, color=MUTED, alpha=0.13, linewidth=0)
    for k, curve in enumerate(curves.T):
        ax.plot(result.time, curve, color=_colour(k, result), linewidth=1.1)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.set(xlim=(0.0, result.time[-1]), ylabel=r"$\lambda_k(t)$")


def _draw_last(ax: Axes, result: Spectrum, trajectory: int) -> None:
    values, errors = result.end_exponent[trajectory], result.error[trajectory]
    bound = float(zero_threshold(result.time[-1], result.time_scale[trajectory]))
    ax.axhspan(-bound, bound, color=MUTED, alpha=0.13, linewidth=0)
    numbers = np.arange(1, len(values) + 1)
    for k, number in enumerate(numbers):
        colour = _colour(k, result)
        ax.errorbar(number, values[k], yerr=errors[k], color=colour, marker="o", markersize=4, elinewidth=1.0)
    if _is_whole(result):
        ax.plot(numbers, -values[::-1], "o", markersize=8, markerfacecolor="none", markeredgecolor=MUTED, linestyle="")
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.set_xticks(numbers)


def _is_whole(result: Spectrum) -> bool:
    """Whether all exponents were computed, so that each has its partner."""
    return result.exponent.shape[-1] == len(result.components)


def _colour(k: int, result: Spectrum) -> str:
    """Partners have the same colour, the middle is grey; of a part of a spectrum the first ones have their own."""
    n = result.exponent.shape[-1]
    if not _is_whole(result):
        return SEQUENCE[k] if k < len(SEQUENCE) - 1 else MUTED
    pair = min(k, n - 1 - k)
    return SEQUENCE[pair] if pair < min(2, n // 2) else MUTED
