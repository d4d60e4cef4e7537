"""The command `liepoisson sweep`: one quantity over a grid, from a sweep file."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from liepoisson.cli.exit import INTERRUPTED, TERMINATED, TerminatedError, ends_on_sigterm
from liepoisson.cli.options import Files, QuietOption
from liepoisson.cli.output import data_file, figure_stem, write_figure, write_result
from liepoisson.cli.progress import progress_bar
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from liepoisson.sweeps.result import Sweep

INCOMPLETE = 1
_MOST_ROWS, _LAST_ROWS = 24, 3
"""Rows that are printed, and how many of them are the last ones where some are left out."""


def sweep(
    file: Annotated[str, typer.Argument(help="A sweep file (.toml).", metavar="FILE.toml")],
    *,
    store: Annotated[
        str | None, typer.Option(metavar="DIR.zarr", help="Folder of the results.  [default: beside FILE, as .zarr]")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler whose workers compute: tcp://host:8786.")
    ] = None,
    processes: Annotated[int | None, typer.Option(help="Compute in this many processes of this machine.")] = None,
    threads: Annotated[int | None, typer.Option(help="Compute in this many threads.  [default: all cores]")] = None,
    points_per_piece: Annotated[
        int | None, typer.Option(help="Points of a piece.  [default: as many as take about 0.3 s]")
    ] = None,
    patience: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="Wait so long for a scheduler, or a worker.  [default: 60]"),
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Discard what the folder holds.")] = False,
    allow_code: Annotated[
        bool, typer.Option("--allow-code", help="Import and call the function that FILE gives as its quantity.")
    ] = False,
    files: Files,
    quiet: QuietOption = False,
) -> None:
    """Compute a quantity over a grid of parameters, energies and Casimirs.

    Results are kept piece by piece: a sweep that was interrupted goes on when the same command is given again.  The
    exit code is 1 if a part could not be computed, or if there is a system at no point.
    """
    from liepoisson.catalog import names
    from liepoisson.sweeps.execute import PATIENCE
    from liepoisson.sweeps.run import sweep as run
    from liepoisson.sweeps.spec_file import read_sweep_file
    from liepoisson.sweeps.tasks import NO_SYSTEM

    if file in names() and not Path(file).exists():
        raise ParameterError(
            f"FILE: wanted a sweep file; got the name of a system. Write a file that names it, system = {file!r}, with "
            "axes and t_end; or call lp.sweep(system=...) in Python."
        )
    if store is not None and not store.strip():  # it would be the working folder
        raise ParameterError(
            f"--store must name a folder; got {store!r}. Leave it out for the folder beside FILE, or give its name."
        )
    if patience is not None and scheduler is None and processes is None:
        raise ParameterError("--patience belongs to --scheduler or --processes; add one of them, or leave it out.")
    data = data_file(files.out, f"{Path(file).stem}.csv")
    stem = figure_stem(files.plot, files.figure, Path(file).stem)
    spec = read_sweep_file(file, allow_code=allow_code)
    folder = Path(store) if store is not None else Path(file).with_suffix(".zarr")
    try:
        with ends_on_sigterm(), progress_bar(quiet=quiet) as bar:
            # orbits times their time on the grid, for the rate; refinement adds points that nobody knows before
            work = math.prod(spec.shape) * spec.n_starts * float(spec.t_end)
            result = run(
                spec,
                store=folder,
                scheduler=scheduler,
                processes=processes,
                threads=threads,
                points_per_piece=points_per_piece,
                patience=PATIENCE if patience is None else patience,
                fresh=fresh,
                allow_code=allow_code,
                progress=None if bar is None else (lambda done: bar(spec.name or "sweep", done * work, work)),
            )
    except (KeyboardInterrupt, TerminatedError) as error:
        how, code = ("interrupted", INTERRUPTED) if isinstance(error, KeyboardInterrupt) else ("ended", TERMINATED)
        print(f"{how}; what is finished is in {folder}. The same command goes on with it.", file=sys.stderr)
        raise typer.Exit(code) from None
    written: list[Path] = []
    try:  # first, as nobody may read what is printed
        if data is not None:
            write_result(result, data)
        if stem is not None:
            from liepoisson.plot.sweep import sweep as draw

            written = write_figure(draw(result).get_figure(), stem)  # pyright: ignore[reportArgumentType]
    finally:
        print("\n".join(summary(result)))
    if data is not None:
        print(f"wrote {data}", file=sys.stderr)
    for path in written:
        print(f"figure {path}", file=sys.stderr)
    for line in (*result.remarks, *result.failed):
        print(line, file=sys.stderr)
    if not result.is_complete or (result.outcome_code == NO_SYSTEM).all():
        raise typer.Exit(INCOMPLETE)


def summary(result: Sweep) -> list[str]:
    """The lines that the command prints."""
    spec = result.spec
    lines = [
        f"{spec.name or 'sweep'}: {len(result.points)} points, {spec.n_starts} orbits each to t = {spec.t_end:g}, "
        f"seed {spec.seed}",
        f"method: {result.method}",
        *(f"varied: {line}" for line in spec.formulas()),
        *(f"held: {line}" for line in result.held),
        "outcomes: " + ", ".join(f"{name} {count}" for name, count in result.outcomes.items()),
    ]
    if 0 < (missing := result.outcomes.get("no start", 0)) < sum(result.outcomes.values()):
        lines.append(
            f"no start was found for {missing} orbits: means are over the others, which need not be typical; "
            'sampling = "liouville" below [starts] draws all of them'
        )
    if result.n_reused:
        lines.append(f"{result.n_reused} of {len(result.points)} points were in the store")
    if result.n_damaged:
        lines.append(f"{result.n_damaged} damaged pieces of the store were computed anew")
    low, high = result.interval()
    names = [axis.name for axis in spec.axes]
    what = (
        "chaotic fraction, 95% interval over the starts, undecided"
        if spec.is_verdict
        else ("mean over the starts, 95% interval")
    )
    lines.append("  ".join(f"{name:>10}" for name in names) + f"  {what}")
    undecided = result.undecided_fraction if spec.is_verdict else None

    def row(point: np.intp) -> str:
        place = "  ".join(f"{value:>10.6g}" for value in result.points[point])
        line = f"{place}  {result.statistic[point]:.4f}  [{low[point]:.4f}, {high[point]:.4f}]"
        return line if undecided is None else f"{line}  {undecided[point]:.4f}"

    order = np.arange(len(result.points)) if len(names) == 2 else result.points[:, 0].argsort()
    hidden = len(order) - _MOST_ROWS
    for point in order if hidden <= 0 else order[: _MOST_ROWS - _LAST_ROWS]:
        lines.append(row(point))
    if hidden > 0:
        lines.append(f"... {hidden} more, all in {result.store} ...")
        lines += [row(point) for point in order[-_LAST_ROWS:]]
    return lines
