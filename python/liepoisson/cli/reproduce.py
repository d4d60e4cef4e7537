"""The command `liepoisson reproduce`: a paper, computed again."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from liepoisson.cli.exit import INTERRUPTED
from liepoisson.cli.options import QuietOption, SeedOption
from liepoisson.cli.progress import progress_bar
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_threads
from liepoisson.studies import STUDIES, check_study

QUICK_MEMBERS, QUICK_END_TIME = 1000, 200.0


def reproduce(
    study: Annotated[str, typer.Argument(help=f"Which paper: {', '.join(STUDIES)}.")],
    *,
    members: Annotated[int | None, typer.Option(help="Random starts per ensemble.  [default: 20000]")] = None,
    end_time: Annotated[float | None, typer.Option(help="Time of the main runs.  [default: 1000]")] = None,
    seed: SeedOption = 0,
    threads: Annotated[int | None, typer.Option(help="Worker threads.  [default: all cores]")] = None,
    # Text, because an empty one would read as the working folder.
    out: Annotated[str | None, typer.Option(metavar="PATH", help="Output folder.  [default: results/STUDY]")] = None,
    quick: Annotated[
        bool,
        typer.Option(
            "--quick", help=f"{QUICK_MEMBERS} trajectories to t = {QUICK_END_TIME:g}: seconds, coarse errors."
        ),
    ] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Discard stored work in the output folder first.")] = False,
    quiet: QuietOption = False,
) -> None:
    """Compute a paper again: figures, fits with error bars, and a verdict on each of its claims.

    Finished work is stored as it comes; after an interruption the same command goes on from there.
    """
    from liepoisson.studies.twisted_top.runs import Settings
    from liepoisson.studies.twisted_top.study import reproduce as run_study
    from liepoisson.studies.twisted_top.study import summary

    name = check_study(study)
    folder = _folder(out, Path("results") / (f"{name}-quick" if quick else name))
    default = Settings(QUICK_MEMBERS, QUICK_END_TIME) if quick else Settings()
    settings = Settings(
        members=default.members if members is None else members,
        end_time=default.end_time if end_time is None else end_time,
        seed=seed,
        threads=None if threads is None else as_threads(threads),
    )
    try:
        with progress_bar(quiet=quiet) as progress:
            result = run_study(settings, folder, fresh=fresh, progress=progress)
    except KeyboardInterrupt:
        print(
            f"interrupted; what is finished is kept in {folder}. Run the same command again to go on.",
            file=sys.stderr,
        )
        raise typer.Exit(INTERRUPTED) from None
    print(summary(result))


def _folder(out: str | None, default: Path) -> Path:
    if out is None:
        return default
    if not out.strip():
        raise ParameterError(
            f"--out must name a folder; got {out!r}. Leave it out to use {default}, or give . for the working folder."
        )
    return Path(out)
