"""The command `liepoisson decide`: which orbits are regular, chaotic or undecided."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.cli.options import Common, Format, FormatOption, OutOption, SeedOption, SystemArgument, Where, show
from liepoisson.cli.output import data_file, name_of_files, write_result
from liepoisson.cli.runs import (
    N_STARTS,
    EndTimeOption,
    EnsembleOption,
    How,
    Limits,
    StartsOption,
    check_end_time,
    check_limits,
    check_that_some_finished,
    running,
    unit_of_time,
)
from liepoisson.cli.starts import find_starts, read_numeric_system

if TYPE_CHECKING:
    from liepoisson.cli.starts import Starts
    from liepoisson.indicators.verdict import Verdict
    from liepoisson.model.system import System

_MOST_ROWS = 24


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
    chosen = read_numeric_system(system, common.values)
    data = data_file(out, f"{name_of_files(chosen, common.values)}-verdicts.csv")
    check_end_time(t_end)
    how.named()  # refused before anything is computed
    drawn = find_starts(chosen, where, starts=starts, default=N_STARTS, ensemble=ensemble, seed=seed)
    unit = unit_of_time(chosen, drawn.states)
    method, t_end = how.named(unit), TIME * unit if t_end is None else t_end
    with running("deciding", len(drawn.states) * t_end, quiet=common.quiet) as listen:
        options: dict[str, Any] = {"seed": seed, "method": method, "progress": listen, **asdict(limits)}
        verdict = find_verdicts(chosen, drawn.states, t_end=t_end, **options)
    written = None if data is None else write_result(verdict, data)  # first, as nobody may read what is printed
    wrote = [f"wrote    {written}"] if written else []
    text = lambda _: "\n".join([*verdict_lines(chosen, drawn, verdict), *wrote])  # noqa: E731
    show(verdict, format_, lambda _: record(chosen, drawn, verdict), text=text)
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
