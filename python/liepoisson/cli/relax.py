"""The command `relax`: the equilibrium to which damping leads a state on its leaf."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from liepoisson.cli.options import (
    Common,
    FigureOption,
    FoundOption,
    PlotOption,
    SeedOfStartOption,
    SystemArgument,
    Where,
)
from liepoisson.cli.output import announce, data_file, figure_stem, name_of_files
from liepoisson.cli.progress import progress_bar
from liepoisson.cli.runs import NO_RUN, TimeLimitOption, check_end_time, check_limits, write_and_print
from liepoisson.cli.starts import assignments, find_start, seed_of_start, start_lines
from liepoisson.cli.systems import read_numeric_equations
from liepoisson.formula.scalars import TIME_LIMIT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from liepoisson.equilibrium.relaxation import Relaxation

_ALONG = "An integral, by name or formula, with the rate of a steady rotation along its flow: l3=1/2."
_T_END = "Time after which it is given up, the t of the equations.  [default: 10,000 times the natural time]"


def relax(
    system: SystemArgument,
    where: Where,
    *,
    along: Annotated[list[str] | None, typer.Option(metavar="INTEGRAL=RATE", help=_ALONG)] = None,
    seed: SeedOfStartOption = None,
    t_end: Annotated[float | None, typer.Option(help=_T_END)] = None,
    time_limit: TimeLimitOption = TIME_LIMIT,
    out: FoundOption = None,
    plot: PlotOption = False,
    figure: FigureOption = None,
    common: Common,
) -> None:
    """Print the equilibrium to which damping leads a state on its leaf, a minimum of the energy, and its stability.

    A system is damped by the double bracket of the identity; a file with a table [damping] has its own.  Without
    --start, a random state is taken; --leaf and --energy move it.  With --out, the way there is written; a figure has
    the energy above that of the equilibrium.

    The exit code is 1 where it does not arrive.
    """
    from liepoisson.damping.damped_system import DampedSystem
    from liepoisson.equilibrium.relaxation import relax as find

    chosen: Any = read_numeric_equations(system, common.values)
    check_end_time(t_end)
    drawn = seed_of_start(where, seed)
    check_limits(seed=drawn, time_limit=time_limit)
    name = f"{name_of_files(chosen, common.values)}-relaxation"
    data, stem = data_file(out, f"{name}.nc"), figure_stem(plot, figure, name)
    own = chosen.undamped if isinstance(chosen, DampedSystem) else chosen
    begin = find_start(own, where, drawn)
    announce("\n".join([f"{chosen.name}: relaxation", *start_lines(own, begin)]), (data, stem))
    with progress_bar(quiet=common.quiet) as bar:
        if bar is not None:  # nobody knows how far it is
            bar("relaxing", 0.0, 1.0)
        found = find(
            chosen,
            begin.state,
            along=cast("Any", assignments(along or (), "--along", "--along l3=1/2", "integral") or None),
            t_end=t_end,
            time_limit=time_limit,
        )
    write_and_print(found, data, stem, draw=lambda: _drawn(found), lines=lambda: relaxation_lines(found))
    if found.outcome != "arrived":
        print(f"liepoisson: {_reason(found)}", file=sys.stderr)
        raise typer.Exit(NO_RUN)


def _drawn(found: Relaxation) -> Figure:
    from liepoisson.plot.results import draw

    return draw(found)


def relaxation_lines(found: Relaxation) -> list[str]:
    """The outcome, the way down and the equilibrium."""
    lines = [
        f"outcome  {found.outcome} at t = {found.time[-1]:g}",
        f"falls    H from {found.energy[0]:.9g} to {found.energy[-1]:.9g}",
    ]
    if (one := found.equilibrium) is None:
        return lines
    return [
        *lines,
        f"{'ends at ' if found.is_at_rest else 'nearby  '} {', '.join(f'{value:.9g}' for value in one.state)}",
        f"         {one!r}",
        f"         within {found.gap:.0e} of the end of the orbit; error at most {one.distance:.0e} of its length",
        *([_approach(found.decay)] if found.outcome == "arrived" else []),
    ]


def _approach(decay: float) -> str:
    return f"approach like exp(-{decay:.6g} t)" if decay > 0 else "approach not exponential"


def _reason(found: Relaxation) -> str:
    if found.outcome == "saddle":
        return "it stays at an equilibrium that is no minimum: start beside it."
    if found.outcome == "undecided":
        return "it is at rest, but second derivatives do not tell whether at a minimum: start beside it."
    if found.outcome == "not arrived":
        return "it did not arrive: take a longer --t-end; at a degenerate minimum the approach is not exponential."
    if found.outcome == "time limit":
        return "it did not arrive within the time limit: take a longer --time-limit."
    return f"the orbit ended ({found.outcome}): the energy has no minimum that it could reach on this leaf."
