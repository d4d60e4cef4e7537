"""The command `liepoisson orbit`: one orbit from a given start, or from a leaf and an energy."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import numpy as np
import typer

from liepoisson.cli.limits import check_limits, unit_of_time
from liepoisson.cli.methods import METHOD_HELP, STEP_HELP, TOL_HELP, named_method
from liepoisson.cli.output import (
    FIGURE_HELP,
    KEEP_HINT,
    OUT_HELP,
    PLOT_HELP,
    announce,
    data_file,
    figure_stem,
    file_stem,
    write_figure,
    write_result,
)
from liepoisson.cli.progress import INTERRUPTED, QuietOption, progress_bar
from liepoisson.cli.starts import (
    ENERGY_HELP,
    GUESS_HELP,
    LEAF_HELP,
    SEED_HELP,
    START_HELP,
    find_start,
    read_numeric_system,
    start_lines,
)
from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP, setting_words
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from liepoisson.model.system import System
    from liepoisson.numeric.integrate import Orbit

    FloatArray: TypeAlias = NDArray[np.float64]

_MOST_POINTS = 10_000_000
_TIME = 100.0
"""Default time of the run, in natural times of the orbit."""
T_END_HELP = (
    "Time of the run, the t of the system's equations; a negative one runs backwards.  "
    "[default: 100 times the natural time of the orbit]"
)
_ROUND_OFF = 1e-15
"""The tolerance of power series that is the default of `integrate`: one orbit costs little."""


_STEP_ROUNDING = 1e-9
"""A step that is longer than the time between kept points by this part of it is the same."""


def orbit(
    system: Annotated[str, typer.Argument(help=SYSTEM_HELP, metavar="SYSTEM")],
    *,
    start: Annotated[list[str] | None, typer.Option(metavar="STATE", help=START_HELP)] = None,
    guess: Annotated[list[str] | None, typer.Option(metavar="STATE", help=GUESS_HELP)] = None,
    leaf: Annotated[list[str] | None, typer.Option(metavar="C1=VALUE,...", help=LEAF_HELP)] = None,
    energy: Annotated[str | None, typer.Option(metavar="NUMBER", help=ENERGY_HELP)] = None,
    seed: Annotated[int, typer.Option(help=SEED_HELP)] = 0,
    t_end: Annotated[float | None, typer.Option(help=T_END_HELP)] = None,
    points: Annotated[int, typer.Option(help="Times at which the state is kept, evenly spaced.")] = 2001,
    method: Annotated[str, typer.Option(help=METHOD_HELP)] = "taylor",
    tol: Annotated[float | None, typer.Option(help=f"{TOL_HELP}  [default: 1e-15, 1e-8]")] = None,
    step: Annotated[float | None, typer.Option(help=STEP_HELP)] = None,
    order: Annotated[int | None, typer.Option(help="Order of the method, where it has several.")] = None,
    time_limit: Annotated[float, typer.Option(help="Seconds that the run may take.")] = 3600.0,
    out: Annotated[str | None, typer.Option(metavar="FILE", help=OUT_HELP)] = None,
    plot: Annotated[bool, typer.Option("--plot", help=PLOT_HELP)] = False,
    figure: Annotated[str | None, typer.Option(metavar="FILE", help=FIGURE_HELP)] = None,
    quiet: QuietOption = False,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)] = None,
) -> None:
    """Print where an orbit begins, how it ended and how well its invariants are kept.

    Without --start, a random state is taken; --leaf and --energy move it onto the symplectic leaf with these values
    of the Casimirs and to this energy.
    """
    chosen = read_numeric_system(system, settings or ())
    _check_times(t_end, points)
    check_limits(seed=seed, time_limit=time_limit)
    slug = file_stem(chosen.name.removesuffix(setting_words(settings or ())))
    data = data_file(out, f"{slug}-orbit.nc")
    stem = figure_stem(plot, figure, f"{slug}-orbit")
    options: dict[str, Any] = {
        "tol": _ROUND_OFF if tol is None and method == "taylor" else tol,
        "step": step,
        "order": order,
    }
    named_method(method, **options)  # refused before anything is computed
    begin = find_start(chosen, start=start or (), guess=guess or (), leaf=leaf or (), energy=energy, seed=seed)
    unit = unit_of_time(chosen, begin.state)
    how, t_end = named_method(method, unit=unit, **options), _TIME * unit if t_end is None else t_end
    head = f"{chosen.name}: one orbit to t = {t_end:g}, {points} points"
    announce("\n".join([head, *start_lines(chosen, begin)]), (data, stem))
    try:
        run = _integrated(chosen, begin.state, t_end, points, method=how, time_limit=time_limit, quiet=quiet)
    except KeyboardInterrupt:
        print(f"interrupted; nothing was written. {KEEP_HINT}", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    written: list[Path] = []
    try:  # first, as nobody may read what is printed
        written = _written(run, data, stem)
    finally:
        print("\n".join(run_lines(chosen, run)), flush=True)
    for path in written:
        print(f"wrote    {path}")


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


def _integrated(system: System, start: FloatArray, t: float, points: int, *, quiet: bool, **options: Any) -> Orbit:
    from liepoisson.numeric.integrate import integrate

    with progress_bar(quiet=quiet) as bar:
        listen = None if bar is None else (lambda done: bar("integrating", done * abs(t), abs(t)))
        return integrate(system, start, times=np.linspace(0.0, t, points), progress=listen, **options)


def _written(run: Orbit, data: Path | None, stem: Path | None) -> list[Path]:
    """The files that were asked for."""
    written: list[Path] = []
    if data is not None:
        written.append(write_result(run, data))
    if stem is not None:
        from liepoisson.plot.orbits import orbit as draw

        written += write_figure(draw(run), stem)
    return written


def _check_times(t: float | None, points: int) -> None:
    if t is not None and not (math.isfinite(t) and t != 0):
        raise ParameterError(f"--t-end must be a finite time other than 0; got {t:g}. Leave it out.")
    if not 2 <= points <= _MOST_POINTS:
        raise ParameterError(f"--points must be from 2 to {_MOST_POINTS}; got {points}. Try 2001.")
