"""The command `liepoisson lyapunov`: exponents and verdicts of random starts."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any, cast

import numpy as np
import typer

from liepoisson.cli.options import Common, Files, SeedOption, SystemArgument, Where
from liepoisson.cli.output import announce, result_files
from liepoisson.cli.runs import (
    N_STARTS,
    EndTimeOption,
    EnsembleOption,
    How,
    Limits,
    PrecisionOption,
    StartsOption,
    check_end_time,
    check_limits,
    check_that_some_finished,
    running,
    unit_of_time,
    write_and_print,
)
from liepoisson.cli.starts import find_starts, read_numeric_system

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.figure import Figure

    from liepoisson.indicators.estimates import FloatArray
    from liepoisson.indicators.finite_time_exponents import FiniteTimeExponents
    from liepoisson.indicators.spectrum import Spectrum

SPECTRUM_HELP = "All exponents, with errors and the check of pairs and zeros, instead of the largest."
_TIME = 1000.0
"""Default time of the runs, in natural times of the median orbit."""
_LONG = 1e12
_QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)


def lyapunov(
    system: SystemArgument,
    where: Where,
    *,
    starts: StartsOption = None,
    ensemble: EnsembleOption = None,
    seed: SeedOption = 0,
    t_end: EndTimeOption = None,
    how: How,
    precision: PrecisionOption = "double",
    spectrum: Annotated[bool, typer.Option("--spectrum", help=SPECTRUM_HELP)] = False,
    limits: Limits,
    files: Files,
    common: Common,
) -> None:
    """Print Lyapunov exponents: the largest ones, or whole spectra.

    Of random starts; of random starts on the leaf and at the energy of --guess, --leaf and --energy; or of the orbit
    of --start.  Finite-time exponents: their mean with its standard error over the starts, quantiles, and how the runs
    ended.

    The exit code is 1 where no run finished.
    """
    check_limits(seed=seed, **asdict(limits))
    chosen = read_numeric_system(system, common.values)
    data, stem = result_files(files, chosen, common.values, "exponents")
    check_end_time(t_end)
    how.named(precision=precision)  # refused before anything is computed
    drawn = find_starts(chosen, where, starts=starts, default=N_STARTS, ensemble=ensemble, seed=seed)
    unit = unit_of_time(chosen, drawn.states)
    method, t_end = how.named(unit, precision=precision), _TIME * unit if t_end is None else t_end
    if lines := drawn.lines(chosen):
        announce("\n".join(lines), (data, stem))
    with running("integrating", len(drawn.states) * t_end, quiet=common.quiet) as listen:
        options: dict[str, Any] = {"seed": seed, "method": method, "progress": listen, **asdict(limits)}
        result = _computed(spectrum)(chosen, drawn.states, t_end=t_end, **options)
    write_and_print(
        result,
        data,
        stem if np.any(result.outcome == "finished") else None,
        draw=lambda: _drawn(result),
        lines=lambda: summary(result, drawn.words, unit, mixed=drawn.begin is None),
    )
    check_that_some_finished(result.outcome)


def _computed(spectrum: bool) -> Callable[..., FiniteTimeExponents | Spectrum]:
    """What is computed."""
    if spectrum:
        from liepoisson.indicators.spectrum import lyapunov_spectrum

        return lyapunov_spectrum
    from liepoisson.indicators.finite_time_exponents import finite_time_exponents

    return finite_time_exponents


def _drawn(result: FiniteTimeExponents | Spectrum) -> Figure:
    """The mean exponent against time, or the spectrum of the first orbit that finished."""
    from liepoisson.indicators.spectrum import Spectrum

    if isinstance(result, Spectrum):
        from liepoisson.plot.spectrum import spectrum as draw

        return draw(result, trajectory=int(np.argmax(result.outcome == "finished")))
    from liepoisson.plot.exponents import convergence
    from liepoisson.plot.section import heading_of
    from liepoisson.plot.style import house_style, new_figure

    with house_style():
        ax = convergence(result, ax=new_figure(6.4, 4.0).add_subplot())
        ax.set_title(heading_of(result))
    return cast("Figure", ax.get_figure())


def summary(result: FiniteTimeExponents | Spectrum, words: str, unit: float, *, mixed: bool = True) -> list[str]:
    """The lines that the command prints.

    Args:
        result: What was computed.
        words: What the starts are.
        unit: Natural unit of time of the median orbit.
        mixed: Whether the starts have different energies or leaves.
    """
    from liepoisson.indicators.spectrum import Spectrum

    outcome = result.outcome
    method = f"{result.method}, order {result.order}, {result.field.kind} kernel"
    lines = [
        f"{result.system.name}: {words} to t = {result.time[-1]:g}, {_count(result.time[-1] / unit)} natural times",
        f"{method} ({result.kernel})",
        "outcomes: " + ", ".join(f"{name} {np.sum(outcome == name)}" for name in np.unique(outcome)),
    ]
    if not np.any(outcome == "finished"):
        return [*lines, "no run finished: there is no exponent to report"]
    return lines + (
        _spectrum_lines(result, mixed=mixed)
        if isinstance(result, Spectrum)
        else _growth_lines(result, unit, mixed=mixed)
    )


def _spectrum_lines(spectrum: Spectrum, *, mixed: bool) -> list[str]:
    """Mean spectrum with its standard error over the starts, the error of one run over its time, and the self-check."""
    finished = spectrum.outcome == "finished"
    mean, error = spectrum.mean
    least, largest = spectrum.end_exponent[finished].min(axis=0), spectrum.end_exponent[finished].max(axis=0)
    typical = np.median(spectrum.error[finished], axis=0)
    lines = [
        f"exponents at t = {spectrum.time[-1]:g}, in inverse time, of the {_runs(finished.sum())}:",
        "   k       mean      error      least    largest  error of one run",
    ]
    for k, row in enumerate(zip(mean, error, least, largest, typical, strict=True), start=1):
        lines.append("{:4}  {:9.5f}  {:9.1e}  {:9.5f}  {:9.5f}  {:16.1e}".format(k, *row))
    over = "over the starts, of the mean" if finished.sum() > 1 else "over the time of the one run"
    lines.append(f"error: standard error {over}; error of one run: over its time, the median of the runs")
    if finished.sum() > 1:
        lines.append(_mixes(mixed=mixed) + " one orbit.")
    return [*lines, spectrum.check()]


def _growth_lines(growth: FiniteTimeExponents, unit: float, *, mixed: bool) -> list[str]:
    t_end, finished = growth.time[-1], growth.exponent[growth.outcome == "finished", -1]
    lines: list[str] = []
    lines.append(f"largest exponent at t = {t_end:g}, in inverse time, of the {_runs(finished.size)}:")
    lines.append(f"  mean {_mean(finished)}")
    if finished.size > 1:
        quantiles = zip(_QUANTILES, np.quantile(finished, _QUANTILES), strict=True)
        lines += [f"  {_quantile_name(q):<7} {value:.6f}" for q, value in quantiles]
        lines.append(_mixes(mixed=mixed))
    lines.append(
        ("one orbit. " if finished.size > 1 else "")
        + "Finite-time values are biased upwards: a regular orbit has one of about ln(t/T)/t"
        + (f" = {math.log(t_end / unit) / t_end:.2g}," if t_end > unit else ",")
        + f" with T = {unit:g}."
    )
    return lines


def _mixes(*, mixed: bool) -> str:
    what = "leaves and energies, " if mixed else ""
    return f"A mean over random starts mixes {what}chaotic and regular orbits: it is not the exponent of"


def _mean(exponents: FloatArray) -> str:
    if exponents.size < 2:
        return f"{exponents.mean():.6f} (one run: no standard error)"
    error = exponents.std(ddof=1) / math.sqrt(exponents.size)
    return f"{exponents.mean():.6f}, standard error over starts {error:.2g}"


def _runs(n: int) -> str:
    return "one finished run" if n == 1 else f"{n} finished runs"


def _count(value: float) -> str:
    """A number with separators, or its power of ten where it is long."""
    return f"{value:,.0f}" if value < _LONG else f"{value:.3g}"


def _quantile_name(q: float) -> str:
    return {0.0: "least", 0.5: "median", 1.0: "largest"}.get(q, f"{100 * q:g}%")
