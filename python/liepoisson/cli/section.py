"""The command `liepoisson section`: where orbits of one leaf and one energy cross a surface."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from dataclasses import asdict
from enum import StrEnum
from functools import cache
from typing import TYPE_CHECKING, Annotated, cast

import numpy as np
import typer

from liepoisson.cli.options import Common, Files, SeedOption, SystemArgument, Where
from liepoisson.cli.output import announce, result_files
from liepoisson.cli.runs import (
    HowToRoundOff,
    Limits,
    check_end_time,
    check_limits,
    running,
    unit_of_time,
    write_and_print,
)
from liepoisson.cli.starts import PlainStart, leaf_lines, start_lines, start_of
from liepoisson.cli.systems import read_numeric_equations
from liepoisson.errors import ParameterError, SurfaceWarning
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.method.runge_kutta import RungeKutta
from liepoisson.numeric.methods import Auto

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from liepoisson.leaf.starts import Start
    from liepoisson.model.system import System
    from liepoisson.model.vector_field import VectorField
    from liepoisson.poincare.section import Section
    from liepoisson.poincare.section_sheets import SectionAxes


NO_CROSSING = 1
N_STARTS, N_CROSSINGS = 24, 500
_MOST_STARTS, _MOST_CROSSINGS = 100_000, 1_000_000_000
_TIME = 100.0
"""Time for each crossing that is wanted, in natural times: the tops of the catalog need some 5 to 50."""
SURFACE_HELP = (
    "The function that is zero on the surface, as in 'dot(l, beta)'.  [default: a.(alpha x beta) for a top "
    "with two fields, else the rate of a coordinate]"
)
T_END_HELP = (
    "Time, the t of the system's equations, at which an orbit ends at the latest.  "
    "[default: 100 times the natural time for each crossing]"
)
KEEP_HELP = "Keep this function of each crossing, and not the state.  Repeat it for more."

ACROSS_HELP = (
    "Across in the figure, as in 'atan2(alpha2, alpha1)'.  [default: what makes the section a graph, else the last "
    "component; of coordinates and momenta the last coordinate]"
)
UP_HELP = "Up in the figure.  [default: likewise, else the second component; or the momentum of --x]"


class Direction(StrEnum):
    """Which crossings count: the function increases, decreases, or either."""

    UP = "up"
    DOWN = "down"
    BOTH = "both"

    @property
    def sign(self) -> int:
        """The direction as `lp.section` takes it."""
        return {"up": 1, "down": -1, "both": 0}[self.value]


def section(
    system: SystemArgument,
    *,
    surface: Annotated[str | None, typer.Option(metavar="FORMULA", help=SURFACE_HELP)] = None,
    direction: Annotated[Direction, typer.Option(help="Of the function at a crossing.")] = Direction.UP,
    where: Where,
    starts: Annotated[
        int | None, typer.Option(help=f"Random starts on leaf, energy and surface.  [default: {N_STARTS}]")
    ] = None,
    seed: SeedOption = 0,
    crossings: Annotated[int, typer.Option(help="Of each orbit, which ends with the last one.")] = N_CROSSINGS,
    t_end: Annotated[float | None, typer.Option(help=T_END_HELP)] = None,
    keep: Annotated[list[str] | None, typer.Option(metavar="FORMULA", help=KEEP_HELP)] = None,
    how: HowToRoundOff,
    limits: Limits,
    files: Files,
    x: Annotated[str | None, typer.Option("--x", metavar="FORMULA", help=ACROSS_HELP)] = None,
    y: Annotated[str | None, typer.Option("--y", metavar="FORMULA", help=UP_HELP)] = None,
    common: Common,
) -> None:
    """Print where orbits cross a surface.

    Several orbits of one leaf and one energy: those of --start or, moved there, of --guess, of --leaf and --energy,
    or else of trajectory 0 of the random states.  With --start, this orbit alone.  A vector field has one orbit, and
    needs --surface.

    The exit code is 1 where no crossing is found.
    """
    from liepoisson.poincare.section import section as find_crossings
    from liepoisson.poincare.section_arguments import check_that_it_varies
    from liepoisson.poincare.surfaces import section_starts

    chosen = read_numeric_equations(system, common.values)
    alone = bool(where.start) or not hasattr(chosen, "bracket")
    _check_counts(starts, crossings, alone=alone)
    check_end_time(t_end, forwards=False)
    check_limits(seed=seed, **asdict(limits))
    _check_steps(how.named())  # refused before anything is computed
    data, stem = result_files(files, chosen, common.values, "section")
    if stem is not None:
        _check_axes(chosen, x, y, keep)
    elif x is not None or y is not None:
        raise ParameterError("--x and --y belong to a figure; add --plot or --figure FILE, or leave them out.")
    begin = start_of(chosen, where, seed)
    cut, reason = _surface(begin, surface, direction, seed, alone=alone)
    _check_formulas(chosen, (cut, *(keep or ())))
    check_that_it_varies(chosen, cut)
    announce("\n".join(head_lines(chosen, begin, cut, reason, direction, alone=alone)), (data, stem))
    n = N_STARTS if starts is None else starts
    states = (
        begin.state[None]
        if alone or isinstance(begin, PlainStart)
        else section_starts(
            begin.leaf, cut, energy=begin.energy, n_starts=n, seed=seed, direction=direction.sign, spread=True
        )
    )
    unit = unit_of_time(chosen, states)
    if t_end is None:
        t_end = _TIME * crossings * unit
    if not alone:
        announce(f"starts   {n} on the leaf, the energy surface and the section, seed {seed}", (data, stem))
    total = len(states) * abs(t_end)
    with running("looking for crossings", total, quiet=common.quiet) as listen, warnings.catch_warnings():
        # a line of the output says so, with the share of the time
        warnings.filterwarnings("ignore", "the surface function .* could not be followed", SurfaceWarning)
        run = find_crossings(
            chosen,
            states,
            t_end=t_end,
            surface=cut,
            direction=direction.sign,
            n_crossings=crossings,
            keep=keep or None,
            method=how.named(unit),
            progress=listen,
            **asdict(limits),
        )
    axes = cache(lambda: _axes(run, x, y, keep))

    def draw() -> Figure:
        from liepoisson.plot.section import section, titled_section

        if isinstance(begin, PlainStart):
            return cast("Figure", section(run, axes().x, axes().y).figure)
        return titled_section(run, begin.leaf, cut, (axes().x, axes().y), begin.energy, sheets=axes().sheets)

    def about() -> list[str]:
        is_plane = not isinstance(begin, PlainStart) and begin.leaf.rank == 4
        return _about_axes(run, axes(), given=bool(x or y)) if not keep and is_plane else []

    lines = lambda: run_lines(run, begin, full=not keep)  # noqa: E731
    write_and_print(run, data, stem if len(run.time) else None, draw=draw, lines=lines, about=about)
    if not len(run.time):
        print(f"liepoisson: {why_nothing(run)}", file=sys.stderr)
        raise typer.Exit(NO_CROSSING)


def _surface(
    begin: Start | PlainStart, given: str | None, direction: Direction, seed: int, *, alone: bool
) -> tuple[str, str]:
    """The function that is zero on the surface, and why it was taken.

    An orbit that is given alone need not cross a component; the rate of one it does.
    """
    if given is not None:
        return given, "as given"
    if isinstance(begin, PlainStart):
        raise ParameterError("--surface must be given for a vector field; got none. Try a coordinate less a number.")
    from liepoisson.poincare.default_surface import surface_and_reason

    return surface_and_reason(begin.leaf, None if alone else begin.energy, direction=direction.sign, seed=seed)


def _about_axes(run: Section, axes: SectionAxes, *, given: bool) -> list[str]:
    """What is said of the axes of a figure of a section of dimension 2."""
    if axes.is_graph:
        return [f"figure   {axes.x} and {axes.y}: coordinates on the section"]
    if axes.sheets:
        sides = "each direction" if axes.by_direction else f"each sign of {axes.sheets}"
        return [f"figure   {axes.x} and {axes.y}: two sheets side by side, one for {sides}"]
    if not run.is_folded(axes.x, axes.y):
        return []
    advice = "Leave out --x and --y for others" if given else "Another --surface may have axes that do not"
    return [f"figure   folds the section: different states may lie at one point. {advice}"]


def head_lines(
    system: System | VectorField, begin: Start | PlainStart, cut: str, reason: str, direction: Direction, *, alone: bool
) -> list[str]:
    """What is known before the run: the surface, the leaf, the energy, the dimension of the section."""
    words = {Direction.UP: "increases", Direction.DOWN: "decreases", Direction.BOTH: "changes sign"}[direction]
    lines = [
        f"{system.name}: crossings where {cut} {words} through 0",
        f"surface  {reason}",
        *(start_lines(system, begin) if alone else leaf_lines(system, begin)),
    ]
    dimension = len(begin.state) - 1 if isinstance(begin, PlainStart) else max(begin.leaf.rank - 2, 0)
    remark = "; a plane shows a projection, which proves neither tori nor chaos" if dimension > 2 else ""
    return [*lines, f"section  dimension {dimension}{remark}"]


def _times_reached(run: Section) -> tuple[str, str]:
    """The least and the farthest of the times that the orbits reached; equal texts where they look equal."""
    reached = np.abs(np.nan_to_num(run.end_time))
    sense = 1 if run.t_end > 0 else -1
    return f"{sense * reached.min() + 0.0:.6g}", f"{sense * reached.max() + 0.0:.6g}"


def why_nothing(run: Section) -> str:
    """Why a run has no crossings: only one that was seen whole to its end has none for certain."""
    from liepoisson.poincare.section import as_percent

    finished = bool((run.outcome == "finished").all())
    if finished and not run.unseen_steps.any():
        return f"no orbit crosses {run.surface} = 0 up to t = {run.t_end:g}."
    least, farthest = _times_reached(run)
    sentence = f"no crossing of {run.surface} = 0 was found up to t = {least}"
    if not finished:
        reasons = ", ".join(sorted({str(name) for name in run.outcome if name != "finished"}))
        sentence += f", where the first orbit ended ({reasons}; {run.t_end:g} was wanted)"
        if least != farthest:
            sentence += f", nor up to t = {farthest} on those that went on"
    gaps = [
        f"{words} in {as_percent(share)} of the time"
        for words, share in (("could not be followed", run.unresolved_share), ("has no value", run.undefined_share))
        if share
    ]
    return sentence + (f"; the function {' and '.join(gaps)}." if gaps else ".")


@np.errstate(all="ignore")
def run_lines(run: Section, begin: Start | PlainStart, *, full: bool) -> list[str]:
    """What the command prints about the run."""
    from liepoisson.poincare.section import as_percent

    names, counts = np.unique(run.outcome, return_counts=True)
    least, farthest = _times_reached(run)
    reached = farthest if least == farthest else f"{least} to {farthest}"
    lines = [
        f"method   {run.method}, order {run.order}, {run.field.kind} kernel ({run.kernel})",
        "outcome  " + ", ".join(f"{name} {n}" for name, n in zip(names, counts, strict=True)),
        f"found    {len(run.time)} crossings, {_range(run.count)} of each orbit, "
        f"to t = {reached}; undecided touches: {len(run.touch_time)}",
    ]
    if escaped := int((run.outcome == "step too small").sum()):
        lines.append(
            f"escaped  {escaped} of {run.n_trajectories} orbits ran to infinity or to where the equations have no "
            "value: their starts lie on a part of the energy surface that leads there; --start chooses another one"
        )
    if unbounded := int(run.unbounded_steps.sum()):
        lines.append(f"error    of the state estimated, not bounded, in {unbounded} of {run.n_steps.sum()} steps")
    if undefined := run.undefined_share:
        lines.append(f"missed   the function does not exist in {as_percent(undefined)} of the time")
    if unresolved := run.unresolved_share:
        lines.append(f"missed   the function could not be followed in {as_percent(unresolved)} of the time")
    if full and len(run.time) and not isinstance(begin, PlainStart):
        stayed = np.isin(run.outcome, ("finished", "time limit"))[run.trajectory]
        state = run.state[stayed] if stayed.any() else run.state  # that of an orbit that escapes says nothing
        energy = begin.leaf.system.functions.energy(state)
        worst, drift = begin.leaf.residual(state).max(), np.abs(energy - begin.energy).max()
        lines.append(f"drift    relative to the leaf {worst:.0e}, energy {drift:.0e}")
    return lines


def _range(count: NDArray[np.int64]) -> str:
    return f"{count.min()}" if count.min() == count.max() else f"{count.min()} to {count.max()}"


def _check_counts(starts: int | None, crossings: int, *, alone: bool) -> None:
    if starts is not None and alone:
        raise ParameterError("--starts and --start exclude each other: with --start there is one orbit. Or --guess.")
    for name, value, most, usual in (
        ("starts", starts, _MOST_STARTS, N_STARTS),
        ("crossings", crossings, _MOST_CROSSINGS, N_CROSSINGS),
    ):
        if value is not None and not 1 <= value <= most:
            raise ParameterError(f"--{name} must be from 1 to {most}; got {value}. Try {usual}.")


def _check_steps(method: Method | Auto) -> None:
    """Refuse the one method of the commands that has neither power series nor equal steps."""
    if isinstance(method, RungeKutta) and method.step is None:
        raise ParameterError(
            "--method runge-kutta must come with --step where crossings are wanted: they lie between steps of one "
            "length. Try --step 0.1."
        )


def _check_formulas(system: System | VectorField, formulas: Sequence[str]) -> None:
    """Refuse formulas that cannot be read before anything is printed or drawn at random."""
    from liepoisson.model.vector_field import VectorField

    for formula in formulas:
        if isinstance(system, VectorField):
            is_constant = not system.expression(formula).free_symbols
        else:
            is_constant = system.functions.of(formula).is_constant
        if is_constant:
            raise ParameterError(f"a function of the state was wanted; {formula!r:.60} is constant. Try another one.")


def _check_axes(system: System | VectorField, x: str | None, y: str | None, keep: Sequence[str] | None) -> None:
    """Refuse functions that a figure cannot have along its axes."""
    if not keep:
        _check_formulas(system, [axis for axis in (x, y) if axis is not None])
        return
    across, up = x or keep[0], y or keep[-1]
    if across == up:
        raise ParameterError(
            f"a figure must have two functions for its axes; only {across!r} is there. Add another --keep."
        )
    if missing := [name for name in (across, up) if name not in keep]:
        raise ParameterError(f"--x and --y must be kept; {missing[0]!r} is not. Add --keep '{missing[0]}'.")


def _axes(run: Section, x: str | None, y: str | None, keep: Sequence[str] | None) -> SectionAxes:
    """The functions along the axes of the figure."""
    from liepoisson.poincare.section_coordinates import figure_axes
    from liepoisson.poincare.section_sheets import SectionAxes

    if keep or (x and y):
        across, up = (keep[0], keep[-1]) if keep else ("", "")
        return SectionAxes(x or across, y or up)
    found = figure_axes(run)
    return found if not (x or y) else SectionAxes(x or found.x, y or found.y)
