r"""Figures of chaos indicators: growth of a tangent vector, MEGNO and alignment against time, one curve per orbit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import as_count, as_number
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import sequence, texts
from liepoisson.inputs.refusals import shown
from liepoisson.plot.exponents import time_axis
from liepoisson.plot.style import INK, MUTED, SEQUENCE, axes_or_new, house_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

    from liepoisson.indicators.alignment import Alignment
    from liepoisson.indicators.megno import Megno
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
    labels = None if labels is None else texts(labels, "labels", "texts", 'labels=["regular", "chaotic"]')
    if labels is not None and len(labels) != len(chosen):
        raise ParameterError(f"labels: wanted one for each of {len(chosen)} trajectories; got {len(labels)}")
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
        from liepoisson.indicators.verdict import Rule

        chosen_rule = Rule() if rule is None else rule
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
