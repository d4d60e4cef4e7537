"""The command `liepoisson orbit`: one orbit from a given start, or from a leaf and an energy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from liepoisson.cli.options import Common, Files, SeedOption, SystemArgument, Where
from liepoisson.cli.output import announce, result_files
from liepoisson.cli.runs import (
    HowToRoundOff,
    TimeLimitOption,
    check_end_time,
    check_limits,
    running,
    unit_of_time,
    write_and_print,
)
from liepoisson.cli.starts import find_start, read_numeric_system, start_lines
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from liepoisson.model.system import System
    from liepoisson.numeric.integrate import Orbit

_MOST_POINTS = 10_000_000
_TIME = 100.0
"""Default time of the run, in natural times of the orbit."""
T_END_HELP = (
    "Time of the run, the t of the system's equations; a negative one runs backwards.  "
    "[default: 100 times the natural time of the orbit]"
)
_STEP_ROUNDING = 1e-9
"""A step that is longer than the time between kept points by this part of it is the same."""


def orbit(
    system: SystemArgument,
    where: Where,
    *,
    seed: SeedOption = 0,
    t_end: Annotated[float | None, typer.Option(help=T_END_HELP)] = None,
    points: Annotated[int, typer.Option(help="Times at which the state is kept, evenly spaced.")] = 2001,
    how: HowToRoundOff,
    time_limit: TimeLimitOption = TIME_LIMIT,
    files: Files,
    common: Common,
) -> None:
    """Print where an orbit begins, how it ended and how well its invariants are kept.

    Without --start, a random state is taken; --leaf and --energy move it onto the symplectic leaf with these values
    of the Casimirs and to this energy.
    """
    from liepoisson.numeric.integrate import integrate

    chosen = read_numeric_system(system, common.values)
    check_end_time(t_end, forwards=False)
    if not 2 <= points <= _MOST_POINTS:
        raise ParameterError(f"--points must be from 2 to {_MOST_POINTS}; got {points}. Try 2001.")
    check_limits(seed=seed, time_limit=time_limit)
    data, stem = result_files(files, chosen, common.values, "orbit")
    how.named()  # refused before anything is computed
    begin = find_start(chosen, where, seed)
    unit = unit_of_time(chosen, begin.state)
    method, t_end = how.named(unit), _TIME * unit if t_end is None else t_end
    head = f"{chosen.name}: one orbit to t = {t_end:g}, {points} points"
    announce("\n".join([head, *start_lines(chosen, begin)]), (data, stem))
    with running("integrating", abs(t_end), quiet=common.quiet) as listen:
        times = np.linspace(0.0, t_end, points)
        run = integrate(chosen, begin.state, times=times, method=method, time_limit=time_limit, progress=listen)
    write_and_print(run, data, stem, draw=lambda: _drawn(run), lines=lambda: run_lines(chosen, run))


@np.errstate(all="ignore")
def run_lines(system: System, run: Orbit) -> list[str]:
    """What the command prints about the run: the method, the outcome, the largest change of each invariant."""
    from liepoisson.structure.casimirs import shortage

    lines = [
        f"method   {run.method}, order {run.order}, {run.field.kind} kernel ({run.kernel})",
        f"outcome  {run.outcome[0]} at t = {run.end_time[0]:g}, {run.n_steps[0]} steps",
    ]
    longest, step = float(np.abs(np.diff(run.time)).max()), getattr(run.method, "step", None)
    if step is not None and step > (1 + _STEP_ROUNDING) * longest:
        lines.append(f"step     {longest:g}, not {step:g}: steps end at the times that are kept (see --points)")
    if (n := int(np.isfinite(run.state[0]).all(axis=1).sum())) < 2:
        return [*lines, "drift    not known: no state beyond the start was reached"]
    lines.append(f"drift    largest change along {n} points")
    drift = run.drift
    width = max(map(len, drift))
    lines += [f"  {name:<{width}}  {change[0]:.0e}" for name, change in drift.items()]
    return lines + ([f"  {missing}"] if (missing := shortage(system.bracket)) else [])


def _drawn(run: Orbit) -> Figure:
    from liepoisson.plot.orbits import orbit as draw

    return draw(run)
