"""One figure for each kind of result: the one that `draw` makes, where a result has no function of its own."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from inspect import get_annotations
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.refusals import shown
from liepoisson.io.display import Found
from liepoisson.io.result import Kept, Result
from liepoisson.plot.exponents import convergence
from liepoisson.plot.families import family
from liepoisson.plot.fits import orbit_fit
from liepoisson.plot.indicators import spectrum
from liepoisson.plot.labels import formula, label, number, plain
from liepoisson.plot.orbits import orbit
from liepoisson.plot.rigid_body import rod
from liepoisson.plot.section import section
from liepoisson.plot.style import ANGULAR_MOMENTUM, FIRST_FIELD, INK, MUTED, SEQUENCE, axes_or_new, house_style
from liepoisson.plot.sweep import sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST_CURVES = 200
_KINDS = {"regular": FIRST_FIELD, "undecided": MUTED, "chaotic": ANGULAR_MOMENTUM}


@explains_its_arguments
def draw(result: Any, **options: Any) -> Figure:
    """The figure of the result of a run, whatever its kind, of a family of orbits, or of a relaxation.

    What else a search found, such as periodic orbits and equilibria, has none: the refusal says what to draw.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> system = lp.catalog.system("henon-heiles")
        >>> run = lp.section(system, {"y": 0.1, "p_x": 0.3}, surface="x", direction=1, t_end=200)
        >>> figure = lp.plot.draw(run)
        >>> print(figure.axes[0].get_title(loc="left"))
        henon-heiles: $x$ = 0, increasing
        $H$ = $0.04967$
        >>> plt.close(figure)

    Args:
        result: What a run returned, or what `liepoisson.load` gave.
        **options: Those of the figure of this kind: `orbit`, `section`, `spectrum`, `convergence`, `rod`, `sweep`,
            `family`; or `ax`, axes to draw into.

    Returns:
        The figure; `.axes` are its axes, `.savefig(path)` writes it.

    Raises:
        ParameterError: it is no result of a run; of a list or an orbit it says how it is drawn.
    """
    figure: Callable[..., Any] | None = None
    if isinstance(result, Kept):
        figure = _KEPT.get(type(result).kind)
    elif isinstance(result, Result):
        figure = _FIGURES.get(type(result).kind, _numbers)
    if figure is None:
        raise ParameterError(f"result: wanted what a run returned; got {_instead(result)}")
    from matplotlib.axes import Axes

    drawn: Any = figure(result, **options)
    return cast("Figure", drawn.get_figure(root=True) if isinstance(drawn, Axes) else drawn)


def _instead(given: Any) -> str:
    """What is not drawn, and what to draw instead."""
    name, is_list = type(given).__name__, isinstance(given, Found)
    one: Any = next(iter(given), None) if is_list else given
    times = next((f"orbit.{word}" for word in ("period", "time") if hasattr(one, word)), "")
    follow = (
        f"lp.plot.orbit(lp.integrate(orbit.system, orbit.start, t_end={times}))"
        if times and hasattr(one, "system") and hasattr(one, "start")
        else ""
    )
    if is_list:
        of_one = f"; or one of its orbits, orbit = found[0]: {follow}" if follow else ""
        return f"{name}, a list: found.columns() are arrays to plot, found.to_dataframe() is a table{of_one}"
    return f"{name}; write {follow}" if follow else f"{shown(given)}; try an Orbit or a Section"


@explains_its_arguments
def profile(result: Any, *, ax: Axes | None = None) -> Axes:
    r"""Exponents at each energy of a leaf: every start by its verdict, and the mean with its interval.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> top = lp.Top.twisted_lagrange()
        >>> leaf = lp.Leaf.through(top, [1, 0, 1, 0, 0, 1, 0, 0, 1])
        >>> profile = lp.chaos.exponents_by_energy(top, leaf=leaf, energies=[1], n_starts=4, t_end=200)
        >>> axes = lp.plot.profile(profile)
        >>> print(f"{axes.get_ylabel()} against {axes.get_xlabel()}")
        $\lambda$ at $t = 200$ against $H$
        >>> plt.close(axes.figure)
    """
    with house_style():
        ax = axes_or_new(ax)
        for kind, colour in _KINDS.items():
            chosen = (result.verdict == kind) & np.isfinite(result.exponent)
            energies = np.broadcast_to(result.energy[:, None], result.exponent.shape)[chosen]
            ax.plot(energies, result.exponent[chosen], ".", color=colour, markersize=4, alpha=0.5, label=kind)
        mean = np.array([[one.value, one.low, one.high] for one in result.mean])
        error = np.abs(mean[:, 1:] - mean[:, :1]).T
        ax.errorbar(
            result.energy, mean[:, 0], np.nan_to_num(error), color=INK, marker="o", markersize=4, capsize=2.5,
            linewidth=1.0, label="mean, with its 95% interval",
        )  # fmt: skip
        ax.set(xlabel=r"$H$", ylabel=rf"$\lambda$ at $t = {result.t_end:g}$")
        leaf = ", ".join(f"{label(name)} = ${number(value)}$" for name, value in result.casimirs.items())
        ax.set_title(f"{plain(result.system.name)}: {leaf}")
        ax.legend(fontsize=8, loc="upper left", bbox_to_anchor=(0.0, -0.16), ncols=4, borderaxespad=0.0)
    return ax


def _over_time(result: Any, *, values: str, ylabel: str, level: float, log: bool, ax: Axes | None = None) -> Axes:
    """Mean MEGNO or SALI against time; dashed is the 2 of a torus, or the round-off."""
    curves = getattr(result, values)
    with house_style():
        ax = axes_or_new(ax)
        for k, curve in enumerate(curves[:_MOST_CURVES]):
            ax.plot(result.time, curve, color=SEQUENCE[k % len(SEQUENCE)], linewidth=1.0)
        ax.axhline(level, color=INK, linewidth=0.8, linestyle="--")
        ax.set_xscale("log")
        if log:
            ax.set_yscale("log")
        else:
            _linear_then_log(ax, "y", np.nanmax(curves, initial=level))
        ax.set_xlim(result.time[0], result.time[-1])
        ax.set(xlabel=r"$t$", ylabel=ylabel, title=plain(result.system.name))
    return ax


def _linear_then_log(ax: Axes, which: str, most: float) -> None:
    """An axis from 0 on that is linear up to 10 and logarithmic beyond."""
    from matplotlib.ticker import FixedLocator, NullLocator, ScalarFormatter

    ticks = [0.0, 2.0, 4.0, 6.0, 10.0]
    while ticks[-1] < most:
        ticks.append(ticks[-1] * (2.0 if f"{ticks[-1]:.0e}"[0] != "2" else 2.5))
    getattr(ax, f"set_{which}scale")("symlog", linthresh=10.0, linscale=1.5)
    axis = getattr(ax, f"{which}axis")
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(ScalarFormatter())
    getattr(ax, f"set_{which}lim")(0.0, max(1.15 * most, 10.0))


def _verdict(result: Any, *, ax: Axes | None = None) -> Axes:
    """Mean MEGNO against the growth power, by verdict; the thresholds of the rule as lines."""
    with house_style():
        ax = axes_or_new(ax, width=5.6, height=4.4)
        for kind, colour in _KINDS.items():
            chosen = result.verdict == kind
            name = f"{kind} ({int(chosen.sum())})"
            ax.plot(result.growth_power[chosen], result.mean_megno[chosen], ".", color=colour, markersize=6, label=name)
        for value in result.rule.growth_power:
            ax.axvline(value, color=MUTED, linewidth=0.7, linestyle="--", zorder=0)
        for value in result.rule.megno:
            ax.axhline(value, color=MUTED, linewidth=0.7, linestyle="--", zorder=0)
        _linear_then_log(ax, "x", np.nanmax(result.growth_power, initial=result.rule.growth_power[1]))
        _linear_then_log(ax, "y", np.nanmax(result.mean_megno, initial=result.rule.megno[1]))
        ax.set(xlabel=r"growth power $p$, $|v| \sim t^p$", ylabel=r"mean MEGNO $\bar Y$")
        ax.set_title(plain(f"{result.system.name}, t = {result.t_end:g}"))
        ax.legend()
    return ax


def _exponents(result: Any, *, ax: Axes | None = None) -> Axes:
    """Exponents with their standard errors, in increasing order; open circles are consistent with zero."""
    with house_style():
        ax = axes_or_new(ax)
        order = np.argsort(result.exponent)
        place, value, zero = np.arange(1, len(order) + 1), result.exponent[order], result.is_zero[order]
        if not zero.all():  # the error as it is printed behind the sign ±
            ax.errorbar(
                place[~zero], value[~zero], np.nan_to_num(result.error[order][~zero]), fmt="o", color=ANGULAR_MOMENTUM,
                markersize=4, capsize=2.5, linewidth=1.0, label="± standard error, over the time of the orbit",
            )  # fmt: skip
        if zero.any():
            ax.plot(place[zero], value[zero], "o", color=FIRST_FIELD, fillstyle="none", label="consistent with zero")
        if len(value):
            ax.legend()
        ax.set_ylim(bottom=min(0.0, np.nanmin(value, initial=0.0)))
        ax.set(xlabel="trajectory, by its exponent", ylabel=r"$\lambda$")
        ax.locator_params(axis="x", integer=True)
        ax.set_title(plain(result.system.name))
    return ax


def _frequencies(result: Any, *, ax: Axes | None = None) -> Axes:
    """The drift of the main frequency between two windows against the frequency."""
    with house_style():
        ax = axes_or_new(ax)
        ax.plot(
            np.abs(result.frequency[:, 0]), np.maximum(result.drift, 1e-16), "o", color=ANGULAR_MOMENTUM, markersize=4
        )
        ax.set(yscale="log", xlabel=rf"frequency $|f_1|$ in $[0, {result.window:g}]$", ylabel=r"drift $|f_2 - f_1|$")
        ax.set_title(plain(result.system.name))
    return ax


def _returns(result: Any, *, ax: Axes | None = None) -> Axes:
    """Starts and their images, in the two components in which the images spread most."""
    start, image = (array.reshape(-1, len(result.components)) for array in (result.start, result.state))
    spread = np.nan_to_num(np.ptp(image[np.isfinite(image).all(axis=1)], axis=0)) if len(image) else []
    x, y = sorted(np.argsort(spread)[-2:].tolist())
    with house_style():
        ax = axes_or_new(ax, width=5.2, height=4.8)
        ax.plot(start[:, x], start[:, y], "o", color=MUTED, fillstyle="none", markersize=4, label="start")
        ax.plot(image[:, x], image[:, y], ".", color=ANGULAR_MOMENTUM, markersize=6, label="image")
        ax.set(xlabel=label(result.components[x]), ylabel=label(result.components[y]))
        ax.set_title(f"{plain(result.system.name)}: return to {formula(result.surface)} = 0")
        ax.legend()
    return ax


def _scan(result: Any, *, ax: Axes | None = None) -> Axes:
    """Points of the grid over its first two axes of several values; discs have further integrals, with their number."""
    names = [name for name in result.parameter if len(result.axes[name]) > 1] or list(result.parameter)
    x, y = ([result.parameter.index(name) for name in names] + [None])[:2]
    values = np.array([[float(Fraction(text)) for text in point] for point in result.value])
    n = result.n_further
    height = n if y is None else values[:, y]
    with house_style():
        ax = axes_or_new(ax, width=6.4 if y is None else 5.6, height=4.0 if y is None else 4.4)
        unknown = n < 0
        ax.plot(values[n == 0, x], height[n == 0], ".", color=MUTED, markersize=5, label="none (proved)")
        for count in np.unique(n[n > 0]):
            here = n == count
            colour = SEQUENCE[(count - 1) % len(SEQUENCE)]
            ax.plot(values[here, x], height[here], "o", color=colour, markersize=7, label=f"{count}")
        if unknown.any():
            place = np.zeros(unknown.sum()) if y is None else height[unknown]
            ax.plot(values[unknown, x], place, "x", color=INK, markersize=5, label="not known")
        ax.set(xlabel=label(names[0]), ylabel="further integrals" if y is None else label(names[1]))
        if y is None:
            ax.locator_params(axis="y", integer=True)
        ax.set_title(f"{plain(result.system.name)}: further integrals up to degree {result.degree}")
        ax.legend(loc="upper left", bbox_to_anchor=(0.0, -0.16), ncols=5, borderaxespad=0.0)
    return ax


def _law(result: Any, *, ax: Axes | None = None) -> Axes:
    """A histogram, as a density with its standard errors."""
    with house_style():
        ax = axes_or_new(ax)
        middle = (result.edges[1:] + result.edges[:-1]) / 2
        ax.stairs(result.density, result.edges, color=ANGULAR_MOMENTUM)
        ax.errorbar(middle, result.density, yerr=result.error, fmt="none", ecolor=ANGULAR_MOMENTUM)
        ax.set(xlabel=plain(result.function), ylabel="density", title=plain(result.system.name))
    return ax


def _passages(result: Any, *, ax: Axes | None = None) -> Axes:
    """The share of the trajectories that have passed, against time."""
    with house_style():
        ax = axes_or_new(ax)
        times, n = np.sort(result.time[result.passed]), len(result.time)
        share = np.append(np.arange(len(times) + 1), len(times)) / n
        ax.step([0.0, *times, result.t_end], share, where="post", color=ANGULAR_MOMENTUM)
        ax.set(xlabel="$t$", ylabel=f"share past {plain(result.function)} = 0", ylim=(0, 1.02))
        ax.set_title(plain(result.system.name))
    return ax


def _relaxation(result: Any, *, ax: Axes | None = None) -> Axes:
    """The energy above that of the equilibrium against time; where there is none, the energy."""
    end = result.equilibrium
    above = result.energy - (0.0 if end is None else end.energy)
    is_log = end is not None and bool((above > 0).any())
    shown = above > 0 if is_log else np.isfinite(above)
    with house_style():
        ax = axes_or_new(ax)
        ax.plot(result.time[shown], above[shown], color=ANGULAR_MOMENTUM, linewidth=1.0)
        if is_log:
            ax.set_yscale("log")
        ax.set(xlabel="$t$", ylabel="energy" if end is None else "energy above the equilibrium")
        ax.set_title(plain(result.flow.undamped.name))
    return ax


def _numbers(result: Any, *, ax: Axes | None = None) -> Axes:
    """The first numbers that the class says of each trajectory, against time if they have one."""
    data, dims = result.dataset, (("trajectory", "time"), ("trajectory",))
    own = [name for name in get_annotations(type(result)) if name in data.data_vars and data[name].dtype.kind in "fi"]
    name = min(
        (name for name in own if data[name].dims in dims), key=lambda name: dims.index(data[name].dims), default=""
    )
    if not name:
        raise ParameterError(
            f"result: wanted numbers of each trajectory; got {shown(result)}; try result.to_dataframe()"
        )
    with house_style():
        ax = axes_or_new(ax)
        if data[name].dims == dims[0]:
            for k, curve in enumerate(data[name].to_numpy()[:_MOST_CURVES]):
                ax.plot(data["time"].to_numpy(), curve, color=SEQUENCE[k % len(SEQUENCE)], linewidth=1.0)
        else:
            ax.plot(data[name].to_numpy(), "o", color=ANGULAR_MOMENTUM, markersize=4)
        ax.set(xlabel="$t$" if data[name].dims == dims[0] else "trajectory", ylabel=data[name].attrs["long_name"])
        ax.set_title(plain(result.system.name))
    return ax


_FIGURES: dict[str, Callable[..., Any]] = {
    "orbit": orbit,
    "noisy orbits": orbit,
    "stationary law": _law,
    "first passages": _passages,
    "orbit fit": orbit_fit,
    "chart orbit": lambda result, **options: orbit(result.run, **options),
    "attitude": lambda result, **options: orbit(result.orbit, **options),
    "growth": convergence,
    "section": section,
    "spectrum": spectrum,
    "rod": rod,
    "sweep": sweep,
    "energy profile": profile,
    "megno": partial(_over_time, values="mean", ylabel=r"mean MEGNO $\bar Y$", level=2.0, log=False),
    "alignment": partial(_over_time, values="sali", ylabel="SALI", level=1e-16, log=True),
    "verdict": _verdict,
    "exponent": _exponents,
    "frequency drift": _frequencies,
    "first return": _returns,
    "integral scan": _scan,
}
_KEPT: dict[str, Callable[..., Any]] = {"orbit family": family, "relaxation": _relaxation}
"""Of what is not repeated from a file."""
