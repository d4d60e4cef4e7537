"""The command `liepoisson decide`: which orbits are regular, chaotic or undecided."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from liepoisson.cli.limits import MEDIAN_T_END_HELP, check_end_time, check_limits, unit_of_time
from liepoisson.cli.methods import STEP_HELP, named_method
from liepoisson.cli.outcomes import check_that_some_finished
from liepoisson.cli.output import FORMAT_HELP, KEEP_HINT, OUT_HELP, Format, data_file, file_stem, write_result
from liepoisson.cli.progress import INTERRUPTED, QuietOption, progress_bar
from liepoisson.cli.starts import (
    ENERGY_HELP,
    ENSEMBLE_HELP,
    GUESS_HELP,
    LEAF_HELP,
    START_HELP,
    STARTS_HELP,
    find_starts,
    read_numeric_system,
)
from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP, setting_words

if TYPE_CHECKING:
    from liepoisson.cli.starts import Starts
    from liepoisson.indicators.verdict import Verdict
    from liepoisson.model.system import System

N_STARTS = 64
_MOST_ROWS = 24


def decide(
    system: Annotated[str, typer.Argument(help=SYSTEM_HELP, metavar="SYSTEM")],
    *,
    start: Annotated[list[str] | None, typer.Option(metavar="STATE", help=START_HELP)] = None,
    guess: Annotated[list[str] | None, typer.Option(metavar="STATE", help=GUESS_HELP)] = None,
    leaf: Annotated[list[str] | None, typer.Option(metavar="C1=VALUE,...", help=LEAF_HELP)] = None,
    energy: Annotated[str | None, typer.Option(metavar="NUMBER", help=ENERGY_HELP)] = None,
    starts: Annotated[int | None, typer.Option(help=f"{STARTS_HELP}  [default: {N_STARTS}]")] = None,
    ensemble: Annotated[str | None, typer.Option(help=ENSEMBLE_HELP)] = None,
    seed: Annotated[int, typer.Option(help="Seed of starts and tangent vectors.")] = 0,
    t_end: Annotated[float | None, typer.Option(help=MEDIAN_T_END_HELP)] = None,
    method: Annotated[str, typer.Option(help="taylor, runge-kutta, splitting or gauss.")] = "taylor",
    tol: Annotated[
        float | None, typer.Option(help="Tolerance of taylor and runge-kutta.  [default: 1e-13, 1e-8]")
    ] = None,
    step: Annotated[float | None, typer.Option(help=STEP_HELP)] = None,
    order: Annotated[int | None, typer.Option(help="Order of the method, where it has several.")] = None,
    threads: Annotated[int | None, typer.Option(help="Worker threads.  [default: all cores]")] = None,
    time_limit: Annotated[float, typer.Option(help="Seconds that the runs may take, all together.")] = 3600.0,
    out: Annotated[str | None, typer.Option(metavar="FILE", help=OUT_HELP)] = None,
    format_: Annotated[Format, typer.Option("--format", help=FORMAT_HELP)] = Format.TEXT,
    quiet: QuietOption = False,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)] = None,
) -> None:
    """Decide which orbits are regular, chaotic or undecided.

    Of random starts; of random starts on the leaf and at the energy of --guess, --leaf and --energy; or of the orbit
    of --start.  Four indicators vote (see `lp.decide`): the growth power, MEGNO, SALI, and averages that settle.

    The exit code is 1 where no run finished.
    """
    from liepoisson.indicators.verdict import TIME
    from liepoisson.indicators.verdict import decide as find_verdicts

    check_limits(seed=seed, threads=threads, time_limit=time_limit)
    chosen = read_numeric_system(system, settings or ())
    data = data_file(out, f"{file_stem(chosen.name.removesuffix(setting_words(settings or ())))}-verdicts.csv")
    check_end_time(t_end)
    options: dict[str, Any] = {"tol": tol, "step": step, "order": order}
    named_method(method, **options)  # refused before anything is computed
    where: dict[str, Any] = {"start": start or (), "guess": guess or (), "leaf": leaf or (), "energy": energy}
    drawn = find_starts(chosen, starts=starts, default=N_STARTS, ensemble=ensemble, seed=seed, **where)
    unit = unit_of_time(chosen, drawn.states)
    how, t_end = named_method(method, unit=unit, **options), TIME * unit if t_end is None else t_end
    total = len(drawn.states) * t_end

    try:
        with progress_bar(quiet=quiet) as bar:
            listen = None if bar is None else (lambda done: bar("deciding", done * total, total))
            given: dict[str, Any] = {"method": how, "threads": threads, "time_limit": time_limit, "progress": listen}
            verdict = find_verdicts(chosen, drawn.states, t_end=t_end, seed=seed, **given)
    except KeyboardInterrupt:
        print(f"interrupted; nothing was written. {KEEP_HINT}", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    written = None if data is None else write_result(verdict, data)  # first, as nobody may read what is printed
    if format_ is Format.JSON:
        print(json.dumps(record(chosen, drawn, verdict), indent=2))
    else:
        print("\n".join([*verdict_lines(chosen, drawn, verdict), *([f"wrote    {written}"] if written else [])]))
    check_that_some_finished(verdict.outcome)


def verdict_lines(system: System, drawn: Starts, verdict: Verdict) -> list[str]:
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


def record(system: System, drawn: Starts, verdict: Verdict) -> dict[str, Any]:
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
