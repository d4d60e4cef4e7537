"""The commands `lyapunov` and `decide`: exponents of orbits, and which of them are regular, chaotic or undecided."""

from __future__ import annotations

import math
from dataclasses import asdict
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, cast

import numpy as np
import typer

from liepoisson.cli.options import (
    Common,
    Files,
    Format,
    FormatOption,
    OutOption,
    SeedOption,
    SystemArgument,
    Where,
    show,
)
from liepoisson.cli.output import announce, data_file, name_of_files, write_result
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
    noise_lines,
    read_run,
    running,
    unit_of_time,
    write_and_print,
)
from liepoisson.cli.starts import find_starts
from liepoisson.cli.systems import read_numeric_equations
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.figure import Figure

    from liepoisson.cli.starts import Starts
    from liepoisson.indicators.estimates import FloatArray
    from liepoisson.indicators.finite_time_exponents import FiniteTimeExponents
    from liepoisson.indicators.spectrum import Spectrum
    from liepoisson.indicators.verdict import Verdict
    from liepoisson.model.system import System
    from liepoisson.model.vector_field import VectorField
    from liepoisson.noise.noisy_exponents import NoisyExponents
    from liepoisson.numeric.method.method import Method
    from liepoisson.numeric.methods import Auto

SPECTRUM_HELP = "All exponents, with errors and the check of pairs and zeros, instead of the largest."
_TIME = 1000.0
"""Default time of the runs, in natural times of the median orbit."""
_LONG = 1e12
_QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
_MOST_ROWS = 24
"""Orbits whose votes are printed."""


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

    A file with a table [noise] is followed on paths that --seed draws.  The exit code is 1 where no run finished.
    """
    what = "spectrum" if spectrum else "exponents"
    chosen, data, stem = read_run(system, what, seed=seed, limits=limits, files=files, common=common)
    noise: dict[str, Any] | None = getattr(chosen, "noise", None)
    how = how.of_system(chosen)
    if noise is not None and spectrum:
        raise ParameterError("--spectrum has no exponents with noise: only the largest is computed. Leave it out.")
    begin = {"starts": starts, "ensemble": ensemble, "seed": seed}
    chosen = chosen if noise is None else chosen.system
    drawn, unit, method, t_end = _planned(chosen, where, how, begin, t_end=t_end, times=_TIME, precision=precision)
    if lines := drawn.lines(chosen):
        announce("\n".join(lines), (data, stem))
    find = _computed(spectrum, noise)
    with running("integrating", len(drawn.states) * t_end, quiet=common.quiet) as listen:
        options: dict[str, Any] = {"seed": seed, "method": method, "progress": listen, **asdict(limits)}
        result = find(chosen, drawn.states, t_end=t_end, **options)
    write_and_print(
        result,
        data,
        stem if np.any(result.outcome == "finished") else None,
        draw=lambda: _drawn(result),
        lines=lambda: (
            noisy_summary(result, drawn.words)
            if noise
            else summary(result, drawn.words, unit, mixed=drawn.begin is None and hasattr(chosen, "bracket"))
        ),
    )
    check_that_some_finished(result.outcome)


def _planned(
    system: System | VectorField,
    where: Where,
    how: How,
    begin: dict[str, Any],
    *,
    t_end: float | None,
    times: float,
    **options: Any,
) -> tuple[Starts, float, Method | Auto, float]:
    """The starts, the natural time of the median orbit, the method, and the time of the runs, by default so many."""
    check_end_time(t_end)
    how.named(**options)  # refused before anything is computed
    drawn = find_starts(system, where, default=N_STARTS, **begin)
    unit = unit_of_time(system, drawn.states)
    return drawn, unit, how.named(unit, **options), times * unit if t_end is None else t_end


def _computed(spectrum: bool, noise: dict[str, Any] | None) -> Callable[..., Any]:
    """What is computed."""
    if noise is not None:
        from liepoisson.noise.noisy_exponents import noisy_exponents

        return partial(noisy_exponents, **noise)
    if spectrum:
        from liepoisson.indicators.spectrum import lyapunov_spectrum

        return lyapunov_spectrum
    from liepoisson.indicators.finite_time_exponents import finite_time_exponents

    return finite_time_exponents


def _drawn(result: FiniteTimeExponents | Spectrum | NoisyExponents) -> Figure:
    """The mean exponent against time, or the spectrum of the first orbit that finished; with noise the exponents."""
    from liepoisson.indicators.spectrum import Spectrum
    from liepoisson.noise.noisy_exponents import NoisyExponents

    if isinstance(result, NoisyExponents):
        from liepoisson.plot.results import draw as draw_result

        return draw_result(result)
    if isinstance(result, Spectrum):
        from liepoisson.plot.indicators import spectrum as draw

        return draw(result, trajectory=int(np.argmax(result.outcome == "finished")))
    from liepoisson.plot.exponents import convergence
    from liepoisson.plot.section import heading_of
    from liepoisson.plot.style import house_style, new_figure

    with house_style():
        ax = convergence(result, ax=new_figure(6.4, 4.0).add_subplot())
        ax.set_title(heading_of(result))
    return cast("Figure", ax.get_figure())


def summary(result: FiniteTimeExponents | Spectrum, words: str, unit: float, *, mixed: bool = True) -> list[str]:
    """What the command prints of runs with these starts, which may have different energies or leaves (`mixed`)."""
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


def noisy_summary(result: NoisyExponents, words: str) -> list[str]:
    """What the command prints of runs with noise: the exponent of each up to some, and their mean."""
    lines = [
        f"{result.system.name}: {words} to t = {result.t_end:g}",
        f"method   {result.method}",
        *noise_lines(result),
        "outcomes: " + ", ".join(f"{name} {np.sum(result.outcome == name)}" for name in np.unique(result.outcome)),
    ]
    finished = np.flatnonzero(result.outcome == "finished")
    if not len(finished):
        return [*lines, "no run finished: there is no exponent to report"]
    if len(finished) == 1:
        one = finished[0]
        return [
            *lines,
            f"largest exponent {result.exponent[one]:.6f}, standard error over time {result.error[one]:.2g}",
        ]
    return [*lines, f"largest exponent {result.mean}, error from the spread of {_runs(len(finished))}"]


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
    for k, (m, e, low, high, own) in enumerate(zip(mean, error, least, largest, typical, strict=True), start=1):
        lines.append(f"{k:4}  {m:z9.5f}  {e:9.1e}  {low:z9.5f}  {high:z9.5f}  {own:16.1e}")
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


def decide(
    system: SystemArgument,
    where: Where,
    *,
    starts: StartsOption = None,
    ensemble: EnsembleOption = None,
    seed: SeedOption = 0,
    t_end: EndTimeOption = None,
    how: How,
    limits: Limits,
    out: OutOption = None,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Decide which orbits are regular, chaotic or undecided.

    Of random starts; of random starts on the leaf and at the energy of --guess, --leaf and --energy; or of the orbit
    of --start.  Four indicators vote (see `lp.decide`): the growth power, MEGNO, SALI, and averages that settle.

    The exit code is 1 where no run finished.
    """
    from liepoisson.indicators.verdict import TIME
    from liepoisson.indicators.verdict import decide as find_verdicts

    check_limits(seed=seed, **asdict(limits))
    chosen = read_numeric_equations(system, common.values)
    data = data_file(out, f"{name_of_files(chosen, common.values)}-verdicts.csv")
    begin = {"starts": starts, "ensemble": ensemble, "seed": seed}
    drawn, _, method, t_end = _planned(chosen, where, how, begin, t_end=t_end, times=TIME)
    with running("deciding", len(drawn.states) * t_end, quiet=common.quiet) as listen:
        options: dict[str, Any] = {"seed": seed, "method": method, "progress": listen, **asdict(limits)}
        verdict = find_verdicts(chosen, drawn.states, t_end=t_end, **options)
    written = None if data is None else write_result(verdict, data)  # first, as nobody may read what is printed
    wrote = [f"wrote    {written}"] if written else []
    text = lambda _: "\n".join([*verdict_lines(chosen, drawn, verdict), *wrote])  # noqa: E731
    show(verdict, format_, lambda _: verdict_record(chosen, drawn, verdict), text=text)
    check_that_some_finished(verdict.outcome)


def verdict_lines(system: System | VectorField, drawn: Starts, verdict: Verdict) -> list[str]:
    """What the command prints: each kind with its count, its share and Wilson's interval, and the votes of a few."""
    from liepoisson.indicators.verdict import KINDS

    finished = int((verdict.outcome == "finished").sum())
    names, counts = np.unique(verdict.outcome, return_counts=True)
    known = verdict.natural_time[np.isfinite(verdict.natural_time)]
    lines = [
        f"{system.name}: {drawn.words} to t = {verdict.t_end:g}"
        + (f", {np.median(known):.4g} natural times" if len(known) else ""),
        *drawn.lines(system),
        "outcomes: " + ", ".join(f"{name} {n}" for name, n in zip(names, counts, strict=True)),
    ]
    if not finished:
        return [*lines, "verdicts: none, as no run finished"]
    if len(verdict.outcome) > 1:
        lines.append(f"verdicts of the {finished} finished runs, with 95% intervals over the starts:")
        for kind in KINDS:
            share = verdict.fraction(kind)
            interval = f"{share.value:.3f} [{share.low:.3f}, {share.high:.3f}]"
            lines.append(f"  {kind:<9} {round(share.value * finished):6}  {interval}")
    if len(verdict.outcome) <= _MOST_ROWS:
        lines.append("start  verdict    growth power    MEGNO     SALI  averages  exponent")
        lines += [
            f"{k:5}  {row[0]:<9}  {row[1]:12.3g}  {row[2]:7.3g}  {row[3]:7.1g}  {row[4]:8.1g}  {row[5]:8.4f}"
            for k, row in enumerate(zip(*_columns(verdict).values(), strict=True))
        ]
    return lines


def verdict_record(system: System | VectorField, drawn: Starts, verdict: Verdict) -> dict[str, Any]:
    """The verdicts as data that JSON can write; a value that is not finite is null."""
    rows = [
        {name: _plain(value) for name, value in zip(("verdict", *_VALUES), row, strict=True)}
        for row in zip(*_columns(verdict).values(), strict=True)
    ]
    for row, state, outcome in zip(rows, drawn.states.tolist(), verdict.outcome.tolist(), strict=True):
        row |= {"outcome": outcome, "state": state}
    return {"system": system.name, "t_end": verdict.t_end, "seed": verdict.seed, "orbits": rows}


_VALUES = ("growth_power", "mean_megno", "sali", "average_drift", "exponent")


def _columns(verdict: Verdict) -> dict[str, Any]:
    return {name: getattr(verdict, name) for name in ("verdict", *_VALUES)}


def _plain(value: Any) -> str | float | None:
    if isinstance(value, str):
        return str(value)
    return float(value) if np.isfinite(value) else None
