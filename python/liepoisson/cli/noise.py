"""The commands `stationary` and `passages`: laws and first passages of systems with noise."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import numpy as np
import typer

from liepoisson.cli.options import Common, Files, Format, FormatOption, SeedOption, SystemArgument, Where, show
from liepoisson.cli.output import write_figure, write_result
from liepoisson.cli.runs import (
    DEFAULT_STEP,
    N_STARTS,
    NO_RUN,
    EnsembleOption,
    Limits,
    check_end_time,
    check_that_some_finished,
    named_method,
    noise_lines,
    read_run,
    running,
    unit_of_time,
)
from liepoisson.cli.starts import Starts, find_starts, start_of
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_count, as_double
from liepoisson.noise.noisy_system import NoisySystem

if TYPE_CHECKING:
    from pathlib import Path

    from liepoisson.inputs.arrays import Array
    from liepoisson.model.system import System
    from liepoisson.noise.first_passages import FirstPassages
    from liepoisson.noise.stationary_law import StationaryLaw

_MOST_BINS = 2**20
_QUANTILES = {"least": 0.0, "median": 0.5, "largest": 1.0}
TRAJECTORIES_HELP = (
    "Trajectories, each on a path of its own: from one start with --start, else from random ones.  "
    f"[default: {N_STARTS}]"
)
T_END_HELP = "Time of each trajectory, the t of the equations."
STEP_HELP = f"Largest step of the splitting.  [default: {DEFAULT_STEP} natural times of the median orbit without noise]"
EDGES_HELP = "Edges of the bins, --edges -1,0,1; or bins of one width, --edges -1:1:20 for twenty of them."

FunctionArgument: TypeAlias = Annotated[str, typer.Argument(help="A function of the state.", metavar="FUNCTION")]
EndOption: TypeAlias = Annotated[float, typer.Option(help=T_END_HELP)]


@dataclass(frozen=True)
class Paths:
    """The trajectories, each on a path of its own, and their steps."""

    trajectories: Annotated[int, typer.Option(help=TRAJECTORIES_HELP)] = N_STARTS
    ensemble: EnsembleOption = None
    seed: SeedOption = 0
    step: Annotated[float | None, typer.Option(help=STEP_HELP)] = None


def stationary(
    system: SystemArgument,
    function: FunctionArgument,
    *,
    edges: Annotated[str, typer.Option(metavar="NUMBERS", help=EDGES_HELP)],
    t_end: EndOption,
    transient: Annotated[float, typer.Option(help="Time before the first sample.")] = 0.0,
    samples: Annotated[int, typer.Option(help="Samples of each trajectory, at equal times.")] = 1000,
    where: Where,
    paths: Paths,
    limits: Limits,
    files: Files,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Print the law of a function along trajectories with noise, a histogram with its errors.

    SYSTEM is a file with a table [noise].  The errors are from the spread of the trajectories; nothing tells whether
    the transient was long enough.  The exit code is 1 where no run finished.
    """
    from liepoisson.noise.stationary_law import stationary_law

    more: dict[str, Any] = {"edges": _edges(edges), "transient": transient, "n_samples": samples}
    plan = _planned(system, "law", where, paths, t_end=t_end, limits=limits, files=files, common=common)
    with running("sampling", paths.trajectories * t_end, quiet=common.quiet) as listen:
        found = stationary_law(plan.system, plan.drawn.states, function, **more, **plan.options, progress=listen)
    written = _written(found, plan.path, plan.stem)
    show(found, format_, law_record, text=lambda _: "\n".join([*law_lines(found, plan.drawn), *written]))
    check_that_some_finished(found.outcome)


def passages(
    system: SystemArgument,
    function: FunctionArgument,
    *,
    t_end: EndOption,
    where: Where,
    paths: Paths,
    limits: Limits,
    files: Files,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Print when trajectories with noise first pass the surface where a function is zero.

    SYSTEM is a file with a table [noise].  The function is looked at after each step, so times are too late by an
    amount that falls like the root of the step: it is estimated.  The exit code is 1 where no trajectory passed.
    """
    from liepoisson.noise.first_passages import first_passages

    plan = _planned(system, "passages", where, paths, t_end=t_end, limits=limits, files=files, common=common)
    with running("integrating", paths.trajectories * t_end, quiet=common.quiet) as listen:
        found = first_passages(plan.system, plan.drawn.states, function=function, **plan.options, progress=listen)
    some = bool(found.passed.any())
    written = _written(found, plan.path, plan.stem if some else None)
    show(found, format_, passages_record, text=lambda _: "\n".join([*passage_lines(found, plan.drawn), *written]))
    check_that_some_finished(found.outcome)
    if not some:
        raise typer.Exit(NO_RUN)


@dataclass(frozen=True)
class _Plan:
    """What a run is of, where its trajectories start, its options, and the files that are wanted of it."""

    system: System
    drawn: Starts
    options: dict[str, Any]
    path: Path | None
    stem: Path | None


def _planned(
    system: str, what: str, where: Where, paths: Paths, *, t_end: float, limits: Limits, files: Files, common: Common
) -> _Plan:
    """All that is known before a run; what it cannot be made of is refused."""
    check_end_time(t_end)
    as_count(paths.trajectories, "--trajectories", least=1, most=2**31, hint=f"try {N_STARTS}")
    noisy, path, stem = read_run(system, what, seed=paths.seed, limits=limits, files=files, common=common)
    if not isinstance(noisy, NoisySystem):
        raise ParameterError(
            f"SYSTEM must be a file with a table [noise]; {noisy.name} has no noise. Write a system file with for "
            'example noises = ["l1/2"] below [noise].'
        )
    method = {} if paths.step is None else {"step": paths.step}
    named_method("splitting", **method)  # refused before anything is computed
    drawn = _drawn(noisy.system, where, paths)
    chosen = named_method("splitting", unit=unit_of_time(noisy.system, drawn.states), **method)
    options = {**noisy.noise, "t_end": t_end, "method": chosen, "seed": paths.seed, **asdict(limits)}
    return _Plan(noisy.system, drawn, options, path, stem)


def _drawn(system: System, where: Where, paths: Paths) -> Starts:
    """Where the trajectories start: one start stands for all, each with a path of its own."""
    n, ensemble = paths.trajectories, paths.ensemble
    if not where.start:
        return find_starts(system, where, starts=n, default=N_STARTS, ensemble=ensemble, seed=paths.seed)
    if ensemble is not None:
        raise ParameterError("--ensemble and --start exclude each other: nothing is drawn. Leave --ensemble out.")
    begin = start_of(system, where, paths.seed)
    return Starts(np.tile(begin.state, (n, 1)), f"{n} trajector{'y' if n == 1 else 'ies'} from one start", begin)


def _edges(text: str) -> Array:
    """Edges of bins, one by one, or two ends and a count."""
    ends = text.split(":")
    if len(ends) == 1:
        return np.array([as_double(one, "--edges") for one in text.split(",")])
    if len(ends) != 3 or not ends[2].strip().isdecimal():
        raise ParameterError(
            f"--edges must be numbers, or LOW:HIGH:COUNT; got {text!r:.60}. Write for example -1:1:20."
        )
    low, high = (as_double(one, "--edges") for one in ends[:2])
    count = as_count(int(ends[2]), "--edges: the count", least=1, most=_MOST_BINS, hint="try 20")
    return np.linspace(low, high, count + 1)


def _written(found: StationaryLaw | FirstPassages, path: Path | None, stem: Path | None) -> list[str]:
    """Write the files that are wanted, before anything is printed, as nobody may read that; which they are."""
    written = [] if path is None else [write_result(found, path)]
    if stem is not None:
        from liepoisson.plot.results import draw

        written += write_figure(draw(found), stem)
    return [f"wrote    {one}" for one in written]


def _head(found: Any, what: str, drawn: Starts) -> list[str]:
    return [
        f"{found.system.name}: {what}, {drawn.words}",
        *drawn.lines(found.system),
        f"method   {found.method}",
        *noise_lines(found),
        "outcomes: " + ", ".join(f"{name} {np.sum(found.outcome == name)}" for name in np.unique(found.outcome)),
    ]


def law_lines(found: StationaryLaw, drawn: Starts) -> list[str]:
    """The density in each bin with its error, and what lies outside of the bins."""
    lines = _head(found, f"law of {found.function} from t = {found.transient:g} to {found.t_end:g}", drawn)
    if not np.isfinite(found.density).all():
        return lines
    outside = 1.0 - float(np.nansum(found.density * np.diff(found.edges)))
    return [
        *lines,
        "      from          to   density     error",
        *(
            f"{low:10.6g}  {high:10.6g}  {density:8.4f}  {error:8.4f}"
            for low, high, density, error in zip(
                found.edges[:-1], found.edges[1:], found.density, found.error, strict=True
            )
        ),
        f"outside of the bins: {max(0.0, outside):.4f} of the samples",
    ]


def passage_lines(found: FirstPassages, drawn: Starts) -> list[str]:
    """How many passed, the mean time, by how much it is too late, and quantiles."""
    lines = _head(found, f"first passages of {found.function} = 0 until t = {found.t_end:g}", drawn)
    n, passed = len(found.time), int(found.passed.sum())
    lines.append(f"passed   {passed} of {n}")
    if not passed:
        return lines
    under = "" if passed == n else ", under the condition that the passage is before the end"
    lines.append(f"mean     t = {found.mean}{under}")
    if np.isfinite(found.step_bias.value):
        lines.append(f"         too late by {found.step_bias}, as passages within a step are not seen")
    times = found.time[found.passed]
    return [*lines, *(f"{name:<8} t = {np.quantile(times, share):.6g}" for name, share in _QUANTILES.items())]


def law_record(found: StationaryLaw) -> dict[str, Any]:
    """The law as data that JSON can write."""
    return _record(found) | {
        "function": found.function,
        "transient": found.transient,
        "n_samples": found.n_samples,
        "edges": found.edges.tolist(),
        "density": [_or_null(value) for value in found.density],
        "error": [_or_null(value) for value in found.error],
    }


def passages_record(found: FirstPassages) -> dict[str, Any]:
    """The passages as data that JSON can write; the time of a trajectory that did not pass is null."""
    estimates = {"mean": found.mean, "step_bias": found.step_bias}
    return (
        _record(found)
        | {"function": found.function, "passed": int(found.passed.sum())}
        | {
            name: {"value": _or_null(one.value), "error": _or_null(one.standard_error)}
            for name, one in estimates.items()
        }
        | {"time": [_or_null(value) for value in found.time]}
    )


def _record(found: StationaryLaw | FirstPassages) -> dict[str, Any]:
    return {
        "system": found.system.name,
        "method": str(found.method),
        "noises": list(found.noises),
        "inverse_temperature": found.inverse_temperature,
        "seed": found.seed,
        "t_end": found.t_end,
        "outcome": found.outcome.tolist(),
    }


def _or_null(value: float) -> float | None:
    """A number that JSON has."""
    return float(value) if math.isfinite(value) else None
