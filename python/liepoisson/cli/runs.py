"""Commands that follow orbits: the method by name, limits, progress, what is written, and how they end."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from dataclasses import MISSING, asdict, dataclass, fields, replace
from typing import TYPE_CHECKING, Annotated, Any, Self, TypeAlias

import typer

from liepoisson.cli.exit import INTERRUPTED
from liepoisson.cli.output import result_files, write_figure, write_result
from liepoisson.cli.progress import listening
from liepoisson.cli.systems import read_shaken_equations
from liepoisson.errors import ParameterError, UnknownNameError, did_you_mean
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_threads, as_time_limit
from liepoisson.numeric.method.method import Method, precisions
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import CHOICES, Auto

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from liepoisson.cli.options import Common, Files

DEFAULT_STEP = 0.1
"""In natural times of the orbits (`time_scale`)."""

N_STARTS = 64
"""Default number of random starts."""

NO_RUN = 1
"""Exit code of a command that has nothing to report, as no run finished."""

_TOLERANCES = {"taylor": 1e-13}
"""Where many orbits need another tolerance than the one that is the method's own default."""

_KEEP_HINT = "With --time-limit SECONDS a run ends by itself and keeps what is done by then."


def _words(names: list[str], last: str) -> str:
    return f" {last} ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def _options_of(kind: type[Method | Auto]) -> dict[str, Any]:
    """The options of the commands that a method has, with its defaults."""
    return {field.name: field.default for field in fields(kind) if field.name in ("tol", "step", "order", "precision")}


def _with(option: str) -> list[str]:
    return [name for name, kind in CHOICES.items() if option in _options_of(kind)]


def _precisions_help() -> str:
    takers: dict[str, list[str]] = {}
    for name in _with("precision"):
        for precision in precisions(CHOICES[name])[1:]:
            takers.setdefault(precision, []).append(name)
    return "; ".join(["double", *(f"{precision} ({', '.join(names)})" for precision, names in takers.items())]) + "."


_HELP = {
    "method": _words(list(CHOICES), "or") + ".  [default: taylor; with noise splitting]",
    "tol": f"Tolerance of {_words(_with('tol'), 'and')}.",
    "step": "Step of the methods with equal steps.  [default: a tenth of a natural time of the orbits]",
    "order": "Order of the method, where it has several.",
    "precision": _precisions_help(),
    "threads": "Worker threads.  [default: all cores]",
    "time limit": "Seconds that the runs may take, all together.",
    "t_end": "Time of each run, the t of the system's equations.  [default: 1000 times the natural time of the median "
    "orbit]",
    "starts": f"Random starts.  [default: {N_STARTS}]",
    "ensemble": "How starts are drawn where no leaf is asked for: unit-vectors, cube or gaussian.  "
    "[default: unit-vectors]",
}
"""What `--help` says of each."""

PrecisionOption: TypeAlias = Annotated[str, typer.Option(help=_HELP["precision"])]
EndTimeOption: TypeAlias = Annotated[float | None, typer.Option(help=_HELP["t_end"])]
StartsOption: TypeAlias = Annotated[int | None, typer.Option(help=_HELP["starts"])]
EnsembleOption: TypeAlias = Annotated[str | None, typer.Option(help=_HELP["ensemble"])]
TimeLimitOption: TypeAlias = Annotated[float, typer.Option(help=_HELP["time limit"])]


@dataclass(frozen=True)
class How:
    """The method of integration by name, with its options; None stands for an option that was not given."""

    method: Annotated[str | None, typer.Option(help=_HELP["method"])] = None
    tol: Annotated[float | None, typer.Option(help=f"{_HELP['tol']}  [default: 1e-13, 1e-8]")] = None
    step: Annotated[float | None, typer.Option(help=_HELP["step"])] = None
    order: Annotated[int | None, typer.Option(help=_HELP["order"])] = None

    def named(self, unit: float = 1.0, **more: Any) -> Method | Auto:
        """The method, as `named_method` makes it."""
        options = {"tol": self.tol, "step": self.step, "order": self.order} | more
        return named_method(self.method or "taylor", unit=unit, **options)

    def of_system(self, system: Any) -> Self:
        """The same; where none was named, with the one method whose steps noise can enter, if there is noise."""
        return replace(self, method="splitting") if self.method is None and hasattr(system, "noise") else self


@dataclass(frozen=True)
class HowToRoundOff(How):
    """The same for one orbit, which costs little: to round-off where nothing else is said."""

    tol: Annotated[float | None, typer.Option(help=f"{_HELP['tol']}  [default: 1e-15, 1e-8]")] = None

    def named(self, unit: float = 1.0, **more: Any) -> Method | Auto:
        """The method, as `named_method` makes it."""
        is_exact = self.tol is None and self.method in (None, "taylor")
        return super().named(unit, **({"tol": Taylor().tol} if is_exact else {}), **more)


@dataclass(frozen=True)
class Limits:
    """How much of the machine a run may take."""

    threads: Annotated[int | None, typer.Option(help=_HELP["threads"])] = None
    time_limit: TimeLimitOption = TIME_LIMIT


def named_method(name: str, *, unit: float = 1.0, **options: Any) -> Method | Auto:
    """The method of this name with the options that were given; a default step is a tenth of the `unit` of time."""
    if name not in CHOICES:
        hint = did_you_mean(name, CHOICES).strip() or "Try taylor."
        raise UnknownNameError(f"--method must be one of {', '.join(CHOICES)}; got {name!r:.60}. {hint}")
    known = _options_of(CHOICES[name])
    given = {key: value for key, value in options.items() if value is not None}
    if given.get("precision") == "double":
        del given["precision"]
    if foreign := sorted(given.keys() - known.keys()):
        allowed = ", ".join(f"--{key}" for key in known if key in options)
        others = f", which has {allowed}" if allowed else ""
        raise ParameterError(f"--{foreign[0]} is not an option of {name}{others}. Leave it out.")
    if name in _TOLERANCES:
        given.setdefault("tol", _TOLERANCES[name])
    if known.get("step") is MISSING:
        given.setdefault("step", float(f"{DEFAULT_STEP * unit:.1e}"))
    return CHOICES[name](**given)


def check_limits(*, seed: int = 0, time_limit: float = TIME_LIMIT, threads: int | None = None) -> None:
    """Refuse a seed, a number of threads or a time limit that no run can have."""
    as_count(seed, "--seed", most=2**128 - 1)
    as_time_limit(time_limit, "--time-limit")
    as_threads(threads, "--threads")


def read_run(
    system: str, what: str, *, seed: int, limits: Limits, files: Files, common: Common
) -> tuple[Any, Path | None, Path | None]:
    """What a command follows, perhaps with noise, and the files that are wanted, called by `what` without a name.

    What no run can have is refused before anything is computed.
    """
    check_limits(seed=seed, **asdict(limits))
    chosen: Any = read_shaken_equations(system, common.values)
    return chosen, *result_files(files, chosen, common.values, what)


def check_end_time(t_end: float | None, *, forwards: bool = True) -> None:
    """Refuse an end time that is not finite and positive, or not 0 if not `forwards`; None stands for the default."""
    if t_end is None or (math.isfinite(t_end) and (t_end > 0 or (t_end < 0 and not forwards))):
        return
    wanted = "a positive finite time" if forwards else "a finite time other than 0"
    raise ParameterError(f"--t-end must be {wanted}; got {t_end:g}. Leave it out.")


def unit_of_time(system: Any, states: NDArray[np.float64]) -> float:
    """The natural time of the median orbit, in which commands take their default times and steps."""
    from liepoisson.numeric.time_scale import N_MEDIAN, time_scale
    from liepoisson.numeric.time_scale import unit_of_time as unit

    return unit(time_scale(system, states[:N_MEDIAN]))


@contextmanager
def running(activity: str, total: float, *, quiet: bool) -> Generator[Callable[[float], None] | None]:
    """The block of a run, with a listener for its progress; Ctrl-C ends the command: nothing is written."""
    try:
        with listening(activity, total, quiet=quiet) as listen:
            yield listen
    except KeyboardInterrupt:
        print(f"interrupted; nothing was written. {_KEEP_HINT}", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None


def write_and_print(
    result: Any,
    data: Path | None,
    stem: Path | None,
    *,
    draw: Callable[[], Figure],
    lines: Callable[[], Sequence[str]],
    about: Callable[[], Sequence[str]] = tuple,
) -> None:
    """Write the files that are wanted and print the lines, whatever becomes of the files; `about` a figure after it."""
    written: list[Path] = []
    try:  # first, as nobody may read what is printed
        if data is not None:
            written.append(write_result(result, data))
        if stem is not None:
            written += write_figure(draw(), stem)
    finally:
        print("\n".join(lines()), flush=True)
    if stem is not None:
        print("".join(f"{line}\n" for line in about()), end="")
    for path in written:
        print(f"wrote    {path}")


def noise_lines(run: Any) -> list[str]:
    """What shakes a run, if something does, and the seed of its paths."""
    if not hasattr(run, "noises"):
        return []
    damped = f"; inverse temperature {run.inverse_temperature:g}" if run.inverse_temperature else ""
    return [f"noise    {', '.join(run.noises) or 'none'}{damped}; seed {run.seed}"]


_REASONS = {
    "step too small": "all orbits left every bounded region, or ran into a singularity (step too small): take a lower "
    "energy, other starts, or an earlier --t-end",
    "step too large": "the steps are not short beside the times in which the damping relaxes (step too large): take "
    "a smaller --step",
}
"""What is said where all runs ended in the same way."""


def check_that_some_finished(outcome: NDArray[Any]) -> None:
    """End the command where no run finished, with the reason on standard error."""
    names = sorted({str(name) for name in outcome})
    if "finished" in names:
        return
    reason = _REASONS.get(names[0]) if len(names) == 1 else None
    if reason is None:
        reason = f"no run finished ({', '.join(names)})"
    print(f"liepoisson: {reason}.", file=sys.stderr)
    raise typer.Exit(NO_RUN)
