"""The command `liepoisson lyapunov`: exponents and verdicts of random starts."""

from __future__ import annotations

import math
import sys
import time as clock
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liepoisson.cli.limits import check_limits, unit_of_time
from liepoisson.cli.methods import METHOD_HELP, PRECISION_HELP, STEP_HELP, TOL_HELP, named_method
from liepoisson.cli.output import KEEP_HINT, data_file
from liepoisson.cli.progress import INTERRUPTED, progress_bar
from liepoisson.cli.starts import read_numeric_system
from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Callable

    from liepoisson.exact.system import System
    from liepoisson.numeric.estimates import FloatArray
    from liepoisson.numeric.finite_time_exponents import FiniteTimeExponents
    from liepoisson.numeric.methods import Method
    from liepoisson.numeric.spectrum import Spectrum
    from liepoisson.numeric.verdict import Verdict

OUT_HELP = "Also write the curves to this file; a folder that is missing is made."
SPECTRUM_HELP = "All exponents, with errors and the check of pairs and zeros, instead of the largest."
VERDICT_HELP = "Also decide which orbits are regular, chaotic or undecided, with shares of the starts."
T_END_HELP = "Time of each run, in units of the system's own time.  [default: 1000 natural times of the median orbit]"
_TIME = 1000.0
"""Default time of the runs, in natural times of the median orbit."""
_LONG = 1e12
_QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)


def lyapunov(
    system: Annotated[str, typer.Argument(help=SYSTEM_HELP, metavar="SYSTEM")],
    *,
    starts: Annotated[int, typer.Option(help="Random starts.")] = 64,
    t_end: Annotated[float | None, typer.Option(help=T_END_HELP)] = None,
    seed: Annotated[int, typer.Option(help="Seed of starts and tangent vectors.")] = 0,
    ensemble: Annotated[
        str, typer.Option(help="How starts are drawn: unit-vectors, cube or gaussian.")
    ] = "unit-vectors",
    method: Annotated[str, typer.Option(help=METHOD_HELP)] = "taylor",
    tol: Annotated[float | None, typer.Option(help=f"{TOL_HELP}  [default: 1e-13, 1e-8]")] = None,
    step: Annotated[float | None, typer.Option(help=STEP_HELP)] = None,
    order: Annotated[int | None, typer.Option(help="Order of the method, where it has several.")] = None,
    precision: Annotated[str, typer.Option(help=PRECISION_HELP)] = "double",
    time_limit: Annotated[float, typer.Option(help="Seconds that the runs may take, all together.")] = 3600.0,
    spectrum: Annotated[bool, typer.Option("--spectrum", help=SPECTRUM_HELP)] = False,
    verdict: Annotated[bool, typer.Option("--verdict", help=VERDICT_HELP)] = False,
    threads: Annotated[int | None, typer.Option(help="Worker threads.  [default: all cores]")] = None,
    out: Annotated[str | None, typer.Option(metavar="FILE.nc", help=OUT_HELP)] = None,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)] = None,
) -> None:
    """Print Lyapunov exponents of random starts: the largest ones, or whole spectra.

    Finite-time exponents: their mean with its standard error over the starts, quantiles, and how the runs ended.
    """
    if starts < 1:
        raise ParameterError(f"--starts must be at least 1; got {starts}. Try 64.")
    check_limits(seed=seed, threads=threads, time_limit=time_limit)
    data = data_file(out, "exponents.nc", endings=(".nc",))
    chosen = read_numeric_system(system, settings or ())
    if t_end is not None and not 0.0 < t_end < math.inf:
        raise ParameterError(f"--t-end must be a positive finite time; got {t_end:g}. Leave it out.")
    options: dict[str, Any] = {"tol": tol, "step": step, "order": order, "precision": precision}
    named_method(method, **options)  # refused before anything is computed
    from liepoisson.numeric.sampling import sample_states

    states = sample_states(chosen, starts, seed=seed, ensemble=ensemble)
    unit = unit_of_time(chosen, states)
    how, t_end = named_method(method, unit=unit, **options), _TIME * unit if t_end is None else t_end
    decided = None
    try:
        with progress_bar() as bar:
            listen = None if bar is None else (lambda done: bar("integrating", done * starts * t_end, starts * t_end))
            given: dict[str, Any] = {"seed": seed, "method": how, "threads": threads, "progress": listen}
            began = clock.monotonic()
            result = (_spectrum if spectrum else _growth)(chosen, states, t_end, time_limit=time_limit, **given)
            if verdict:
                from liepoisson.numeric.verdict import decide

                left = max(time_limit - (clock.monotonic() - began), 1e-9)
                decided = decide(chosen, states, t_end=t_end, time_limit=left, **given)
    except KeyboardInterrupt:
        print(f"interrupted; nothing was written. {KEEP_HINT}", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    if data is not None:
        result.save(data)
    print("\n".join(summary(result, ensemble, unit)))
    if decided is not None:
        print("\n".join(verdict_lines(decided)))


def verdict_lines(verdict: Verdict) -> list[str]:
    """What the command prints about the verdicts: each kind with its count, its share and Wilson's interval."""
    from liepoisson.numeric.verdict import KINDS

    finished = int((verdict.outcome == "finished").sum())
    if not finished:
        return ["verdicts: none, as no run finished"]
    lines = [f"verdicts at t = {verdict.t_end:g}, of the {finished} finished runs, with 95% intervals over the starts:"]
    for kind in KINDS:
        share = verdict.fraction(kind)
        lines.append(
            f"  {kind:<9} {round(share.value * finished):6}  {share.value:.3f} [{share.low:.3f}, {share.high:.3f}]"
        )
    return lines


def summary(result: FiniteTimeExponents | Spectrum, ensemble: str, unit: float) -> list[str]:
    """The lines that the command prints; `unit` is the natural unit of time of the median orbit."""
    import numpy as np

    from liepoisson.numeric.spectrum import Spectrum

    outcome = result.outcome
    method = f"{result.method}, order {result.order}, {result.field.kind} kernel"
    lines = [
        f"{result.system.name}: {len(outcome)} random starts ({ensemble}, seed {result.seed}) to "
        f"t = {result.time[-1]:g}, "
        f"{_count(result.time[-1] / unit)} natural times",
        f"{method} ({result.kernel})",
        "outcomes: " + ", ".join(f"{name} {np.sum(outcome == name)}" for name in np.unique(outcome)),
    ]
    if not np.any(outcome == "finished"):
        return [*lines, "no run finished: there is no exponent to report"]
    return lines + (_spectrum_lines(result) if isinstance(result, Spectrum) else _growth_lines(result, unit))


def _spectrum_lines(spectrum: Spectrum) -> list[str]:
    """Mean spectrum with its standard error over the starts, the error of one run over its time, and the self-check."""
    import numpy as np

    finished = spectrum.outcome == "finished"
    mean, error = spectrum.mean
    least, largest = spectrum.end_exponent[finished].min(axis=0), spectrum.end_exponent[finished].max(axis=0)
    typical = np.median(spectrum.error[finished], axis=0)
    lines = [
        f"exponents at t = {spectrum.time[-1]:g}, in inverse time, of the {finished.sum()} finished runs:",
        "   k       mean      error      least    largest  error of one run",
    ]
    for k, row in enumerate(zip(mean, error, least, largest, typical, strict=True), start=1):
        lines.append("{:4}  {:9.5f}  {:9.1e}  {:9.5f}  {:9.5f}  {:16.1e}".format(k, *row))
    over = "over the starts, of the mean" if finished.sum() > 1 else "over the time of the one run"
    lines.append(f"error: standard error {over}; error of one run: over its time, the median of the runs")
    return [*lines, spectrum.check()]


def _growth_lines(growth: FiniteTimeExponents, unit: float) -> list[str]:
    import numpy as np

    t_end, finished = growth.time[-1], growth.exponent[growth.outcome == "finished", -1]
    lines: list[str] = []
    lines.append(f"largest exponent at t = {t_end:g}, in inverse time, of the {finished.size} finished runs:")
    lines.append(f"  mean {_mean(finished)}")
    quantiles = zip(_QUANTILES, np.quantile(finished, _QUANTILES), strict=True)
    lines += [f"  {_quantile_name(q):<7} {value:.6f}" for q, value in quantiles]
    lines += [
        "A mean over random starts mixes leaves and energies, chaotic and regular orbits: it is not the exponent of",
        "one orbit. Finite-time values are biased upwards: a regular orbit has one of about ln(t/T)/t"
        + (f" = {math.log(t_end / unit) / t_end:.2g}," if t_end > unit else ",")
        + f" with T = {unit:g}.",
    ]
    return lines


def _growth(
    system: System,
    states: FloatArray,
    t_end: float,
    *,
    seed: int,
    method: Method,
    threads: int | None,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> FiniteTimeExponents:
    from liepoisson.numeric.finite_time_exponents import finite_time_exponents

    return finite_time_exponents(
        system, states, t_end=t_end, seed=seed, method=method, threads=threads, time_limit=time_limit, progress=progress
    )


def _spectrum(
    system: System,
    states: FloatArray,
    t_end: float,
    *,
    seed: int,
    method: Method,
    threads: int | None,
    time_limit: float,
    progress: Callable[[float], object] | None,
) -> Spectrum:
    from liepoisson.numeric.spectrum import lyapunov_spectrum

    return lyapunov_spectrum(
        system, states, t_end=t_end, seed=seed, method=method, threads=threads, time_limit=time_limit, progress=progress
    )


def _mean(exponents: FloatArray) -> str:
    if exponents.size < 2:
        return f"{exponents.mean():.6f} (one run: no standard error)"
    error = exponents.std(ddof=1) / math.sqrt(exponents.size)
    return f"{exponents.mean():.6f}, standard error over starts {error:.2g}"


def _count(value: float) -> str:
    """A number with separators, or its power of ten where it is long."""
    return f"{value:,.0f}" if value < _LONG else f"{value:.3g}"


def _quantile_name(q: float) -> str:
    return {0.0: "least", 0.5: "median", 1.0: "largest"}.get(q, f"{100 * q:g}%")
