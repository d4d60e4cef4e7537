"""The commands `orbit` and `equilibria`: one orbit from a start, and the states of a leaf that stay where they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, cast

import numpy as np
import typer

from liepoisson.cli.options import (
    Common,
    Files,
    Format,
    FormatOption,
    LeafOption,
    SeedOfStartAndNoiseOption,
    SeedOption,
    SystemArgument,
    TableOption,
    Where,
    show,
)
from liepoisson.cli.output import TABLE_ENDINGS, announce, data_file, name_of_files, result_files, write_result
from liepoisson.cli.progress import progress_bar
from liepoisson.cli.runs import (
    HowToRoundOff,
    TimeLimitOption,
    check_end_time,
    check_limits,
    noise_lines,
    running,
    unit_of_time,
    write_and_print,
)
from liepoisson.cli.starts import assignments, find_start, seed_of_start, start_lines, start_of
from liepoisson.cli.systems import read_numeric_system, read_shaken_equations
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from liepoisson.equilibrium.equilibrium_list import Equilibria
    from liepoisson.model.system import System
    from liepoisson.model.vector_field import VectorField
    from liepoisson.noise.noisy_orbits import NoisyOrbits
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
STATE_HELP = "A state on the leaf that is meant: all numbers, or by name, --start l=1,0,0,beta3=1; the others are 0."
ALONG_HELP = "An integral, by name or formula, along whose flow relative equilibria move, with its value: l3=1/2."
STARTS_HELP = "Starts of a search, where algebra does not give the list.  [default: 200]"


def orbit(
    system: SystemArgument,
    where: Where,
    *,
    seed: SeedOfStartAndNoiseOption = None,
    t_end: Annotated[float | None, typer.Option(help=T_END_HELP)] = None,
    points: Annotated[int, typer.Option(help="Times at which the state is kept, evenly spaced.")] = 2001,
    how: HowToRoundOff,
    time_limit: TimeLimitOption = TIME_LIMIT,
    files: Files,
    common: Common,
) -> None:
    """Print where an orbit begins, how it ended and how well its invariants are kept.

    Without --start, a random state is taken; --leaf and --energy move it onto the symplectic leaf with these values
    of the Casimirs and to this energy.  A file with a table [noise] is followed on the path that --seed draws.
    """
    chosen: Any = read_shaken_equations(system, common.values)
    noise: dict[str, Any] | None = getattr(chosen, "noise", None)
    how = how.of_system(chosen)
    check_end_time(t_end, forwards=noise is not None)
    if not 2 <= points <= _MOST_POINTS:
        raise ParameterError(f"--points must be from 2 to {_MOST_POINTS}; got {points}. Try 2001.")
    drawn = seed_of_start(where, seed) if noise is None else seed or 0
    check_limits(seed=drawn, time_limit=time_limit)
    data, stem = result_files(files, chosen, common.values, "orbit")
    how.named()  # refused before anything is computed
    chosen = chosen if noise is None else chosen.system
    own = getattr(chosen, "undamped", chosen)
    begin = start_of(own, where, drawn)
    unit = unit_of_time(chosen, begin.state)
    method, t_end = how.named(unit), _TIME * unit if t_end is None else t_end
    head = f"{chosen.name}: one orbit to t = {t_end:g}, {points} points"
    announce("\n".join([head, *start_lines(own, begin)]), (data, stem))
    with running("integrating", abs(t_end), quiet=common.quiet) as listen:
        times = np.linspace(0.0, t_end, points)
        options: dict[str, Any] = {"times": times, "method": method, "time_limit": time_limit, "progress": listen}
        run = _followed(chosen, begin.state, options, noise, drawn)
    write_and_print(run, data, stem, draw=lambda: _drawn(run), lines=lambda: run_lines(chosen, run))


def _followed(system: Any, state: Any, options: dict[str, Any], noise: dict[str, Any] | None, seed: int) -> Any:
    """The orbit, with noise on the path of this seed."""
    if noise is None:
        from liepoisson.numeric.integrate import integrate

        return integrate(system, state, **options)
    from liepoisson.noise.noisy_orbits import noisy_orbits

    return noisy_orbits(system, state, **noise, seed=seed, **options)


@np.errstate(all="ignore")
def run_lines(system: System | VectorField, run: Orbit | NoisyOrbits) -> list[str]:
    """What the command prints about the run: the method, the outcome, the largest change of each invariant."""
    from liepoisson.structure.casimirs import shortage

    lines = [
        f"method   {run.method}, order {run.order}, {run.field.kind} kernel ({run.kernel})",
        *noise_lines(run),
        f"outcome  {run.outcome[0]} at t = {run.end_time[0]:g}, {run.n_steps[0]} steps",
    ]
    longest, step = float(np.abs(np.diff(run.time)).max()), getattr(run.method, "step", None)
    if step is not None and step > (1 + _STEP_ROUNDING) * longest:
        lines.append(f"step     {longest:g}, not {step:g}: steps end at the times that are kept (see --points)")
    if (n := int(np.isfinite(run.state[0]).all(axis=1).sum())) < 2:
        return [*lines, "drift    not known: no state beyond the start was reached"]
    drift = run.drift
    lines.append(f"drift    largest change along {n} points" if drift else "drift    no integral is known")
    width = max(map(len, drift), default=0)
    lines += [f"  {name:<{width}}  {change[0]:.0e}" for name, change in drift.items()]
    for name, values in getattr(run, "monotone", {}).items():  # noise has none
        finite = values[0][np.isfinite(values[0])]
        verb = "falls" if finite[-1] < finite[0] else "rises"
        back = f"against it {run.reversals[name][0]:.0e}"
        lines.append(f"{verb:<8} {name} from {finite[0]:.9g} to {finite[-1]:.9g}, {back}")
    missing = shortage(bracket) if (bracket := getattr(system, "bracket", None)) else ""
    return lines + ([f"  {missing}"] if missing else [])


def _drawn(run: Orbit | NoisyOrbits) -> Figure:
    from liepoisson.plot.orbits import orbit as draw

    return draw(run)


def equilibria(
    system: SystemArgument,
    *,
    start: Annotated[list[str] | None, typer.Option(metavar="STATE", help=STATE_HELP)] = None,
    leaf: LeafOption = None,
    along: Annotated[list[str] | None, typer.Option(metavar="INTEGRAL=VALUE", help=ALONG_HELP)] = None,
    starts: Annotated[int | None, typer.Option(help=STARTS_HELP)] = None,
    seed: SeedOption = 0,
    time_limit: Annotated[float, typer.Option(help="Seconds that the search may take.")] = 3600.0,
    out: TableOption = None,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Print the equilibria on a leaf, with their stability, and whether they are all.

    The leaf is that of --start, or of --leaf, or of trajectory 0 of the random states.
    """
    from liepoisson.equilibrium.leaf_equilibria import equilibria as find_equilibria

    check_limits(seed=seed, time_limit=time_limit)
    if start and leaf:
        raise ParameterError(
            "--start and --leaf exclude each other: a start is on its own leaf. Leave one of them out."
        )
    chosen = read_numeric_system(system, common.values)
    data = data_file(out, f"{name_of_files(chosen, common.values)}-equilibria.csv", endings=TABLE_ENDINGS)
    place = find_start(chosen, Where(start=start, leaf=leaf), seed).leaf
    with progress_bar(quiet=common.quiet) as bar:
        if bar is not None:  # of a search nobody knows how much is left
            bar("looking for equilibria", 0.0, 1.0)
        found = find_equilibria(
            chosen,
            place,
            along=tuple(values := assignments(along or (), "--along", "--along l3=1/2", "integral")),
            values=cast("Any", values or None),
            seed=seed,
            time_limit=time_limit,
            **({} if starts is None else {"n_starts": starts}),
        )
    written = None if data is None else write_result(found, data)  # first, as nobody may read what is printed
    wrote = [f"wrote    {written}"] if written else []
    show(found, format_, equilibria_record, text=lambda _: "\n".join([*equilibrium_lines(found), *wrote]))


def equilibrium_lines(found: Equilibria) -> list[str]:
    """The table, then the state of each equilibrium in the order of its rows."""
    names = found.leaf.system.component_names
    values = ", ".join(f"{name} = {value:.9g}" for name, value in found.leaf.casimirs.items())
    lines = [f"leaf     {found.leaf.stratum}" + (f": {values}" if values else ""), repr(found)]
    if len(found):
        lines.append(f"states ({', '.join(names)})")
        lines += [f"{k:3}  {', '.join(f'{value:.9g}' for value in e.state)}" for k, e in enumerate(found)]
    return [*lines, *(f"hint     {hint}" for hint in found.hints)]


def equilibria_record(found: Equilibria) -> dict[str, Any]:
    """The equilibria as data that JSON can write."""
    leaf = found.leaf
    return {
        "system": leaf.system.name,
        "leaf": {"stratum": leaf.stratum, "dimension": leaf.rank, "casimirs": leaf.casimirs},
        "proved": found.proved,
        "completeness": found.completeness,
        "equilibria": [
            {
                "energy": float(e.energy),
                "state": dict(zip(leaf.system.component_names, e.state.tolist(), strict=True)),
                "family": e.family,
                "omega": {name: float(value) for name, value in e.omega.items()},
                "linear_stability": e.linear_stability,
                "nonlinear_stability": e.nonlinear_stability,
                "growth_rate": float(e.growth_rate),
                "signature": [int(n) for n in e.signature],
                "spectrum": [[float(value.real), float(value.imag)] for value in e.spectrum],
            }
            for e in found
        ],
    }
