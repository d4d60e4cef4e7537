"""The commands `periodic`, `continue` and `melnikov`: periodic orbits, their families, homoclinic orbits that split."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from liepoisson.cli.options import (
    Common,
    FigureOption,
    Format,
    FormatOption,
    FoundOption,
    PlotOption,
    SeedOption,
    SystemArgument,
    Where,
    show,
)
from liepoisson.cli.output import data_file, figure_stem, name_of_files, write_figure, write_result
from liepoisson.cli.runs import TimeLimitOption, check_limits, running
from liepoisson.cli.starts import assignments, find_start, state_of
from liepoisson.cli.systems import read_numeric_system
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_double

if TYPE_CHECKING:
    from liepoisson.equilibrium.stability import Equilibrium
    from liepoisson.model.system import System
    from liepoisson.orbits.closed_orbits import PeriodicOrbit
    from liepoisson.orbits.melnikov_integrals import Melnikov
    from liepoisson.orbits.orbit_families import FamilyPoint, OrbitFamily

NO_ORBIT = 1
"""Exit code: no periodic orbit was found."""

PERIOD_HELP = "About the period of an orbit near --start or --guess; without it orbits of the level are searched."
MOMENTUM_HELP = (
    "A linear integral that is held, too: orbits close up to its rotations. --momentum l3=1/2; near a start also "
    "--momentum l3, with the value there."
)
EQUILIBRIUM_HELP = "An equilibrium around which the orbits begin, written as --start."
MODE_HELP = "Of the equilibrium, which frequency, 0 for the largest.  [default: 0]"
ALONG_HELP = 'What varies: "energy" or the name of a Casimir; the others are held.'
UNTIL_HELP = "The value at which the family ends, as in --until 1/6."
DOWN_HELP = "Begin towards smaller values, where --until does not say the direction."
BRANCH_HELP = "Print the family that leaves at this branch or double period instead: 1 is the first one of the list."
STEP_HELP = "The longest step between starts of orbits, in units of the level.  [default: 0.2]"
MIDDLE_HELP = "The middle of a homoclinic orbit, written as in `orbit`."
ORIGIN_HELP = "The equilibrium from which it comes and to which it goes, written as --start."
INTEGRAL_HELP = "An integral whose values part on the two manifolds: --integral l3.  Repeat it for more."
MomentaOption = Annotated[list[str] | None, typer.Option("--momentum", metavar="FORMULA", help=MOMENTUM_HELP)]
PeriodOption = Annotated[float | None, typer.Option(help=PERIOD_HELP)]


def periodic(
    system: SystemArgument,
    *,
    where: Where,
    period: PeriodOption = None,
    momentum: MomentaOption = None,
    starts: Annotated[int | None, typer.Option(help="Random states of the level for a search.  [default: 200]")] = None,
    seed: SeedOption = 0,
    time_limit: TimeLimitOption = TIME_LIMIT,
    out: FoundOption = None,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Print the periodic orbit near a state, or periodic orbits of a level, with multipliers and stability.

    With --period one orbit near --start or --guess; without it, those that the nearest returns of random states of
    the level lead to.  That there are no others is not proved.

    The exit code is 1 where no orbit is found.
    """
    from liepoisson.orbits.level_orbits import periodic_orbits

    check_limits(seed=seed, time_limit=time_limit)
    chosen = read_numeric_system(system, common.values)
    data = data_file(out, f"{name_of_files(chosen, common.values)}-periodic.nc")
    if period is not None:
        if starts is not None:
            raise ParameterError("--starts and --period exclude each other: with --period there is one orbit.")
        one = _near(chosen, where, period, momentum, seed=seed, time_limit=time_limit, quiet=common.quiet)
        written = None if data is None else write_result(one, data)
        show(one, format_, _orbit_record, text=lambda _: "\n".join([*orbit_lines(one), *_wrote(written)]))
        return
    if any("=" not in word for word in momentum or ()):
        raise ParameterError("--momentum must come with a value where orbits are searched: --momentum l3=1/2.")
    begin = find_start(chosen, where, seed)
    options = {} if starts is None else {"n_starts": starts}
    with running("looking for periodic orbits", 1.0, quiet=common.quiet) as listen:
        found = periodic_orbits(
            chosen, begin.leaf, begin.energy if where.energy is None else where.energy, momenta=_momenta(momentum),
            seed=seed, time_limit=time_limit, progress=listen, **options,
        )  # fmt: skip
    written = None if data is None else write_result(found, data)
    records = lambda _: {"orbits": [_orbit_record(one) for one in found]}  # noqa: E731
    show(found, format_, records, text=lambda _: "\n".join([repr(found), *_states(found), *_wrote(written)]))
    if not found:
        raise typer.Exit(NO_ORBIT)


def continue_(
    system: SystemArgument,
    *,
    where: Where,
    period: PeriodOption = None,
    equilibrium: Annotated[list[str] | None, typer.Option(metavar="STATE", help=EQUILIBRIUM_HELP)] = None,
    mode: Annotated[int | None, typer.Option(help=MODE_HELP)] = None,
    along: Annotated[str, typer.Option(metavar="NAME", help=ALONG_HELP)] = "energy",
    until: Annotated[str | None, typer.Option(metavar="NUMBER", help=UNTIL_HELP)] = None,
    down: Annotated[bool, typer.Option("--down", help=DOWN_HELP)] = False,
    branch: Annotated[int | None, typer.Option(help=BRANCH_HELP)] = None,
    max_orbits: Annotated[int, typer.Option(help="At most so many orbits of a family.")] = 200,
    longest_step: Annotated[float | None, typer.Option(help=STEP_HELP)] = None,
    momentum: MomentaOption = None,
    seed: SeedOption = 0,
    time_limit: TimeLimitOption = TIME_LIMIT,
    out: FoundOption = None,
    plot: PlotOption = False,
    figure: FigureOption = None,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Print a family of periodic orbits in the energy or a Casimir, with its folds, branches and period doublings.

    It begins at the orbit near --start or --guess with --period, or around --equilibrium.
    """
    from liepoisson.orbits.orbit_families import orbit_family

    check_limits(seed=seed, time_limit=time_limit)
    chosen = read_numeric_system(system, common.values)
    stem = f"{name_of_files(chosen, common.values)}-family"
    data, picture = data_file(out, f"{stem}.nc"), figure_stem(plot, figure, stem)
    options: dict[str, Any] = {"along": along, "max_orbits": max_orbits, "momenta": _momenta(momentum)}
    options |= {} if longest_step is None else {"longest_step": longest_step}
    options |= {"increasing": False} if down else {}
    start: PeriodicOrbit | Equilibrium | FamilyPoint
    if equilibrium is not None:
        if where.is_given or period is not None:
            raise ParameterError("--equilibrium and --start, --guess, --period exclude each other; leave one out.")
        start = _at_rest(chosen, equilibrium, "--equilibrium")
    elif period is None:
        raise ParameterError("--period must come with --start or --guess; or write --equilibrium STATE.")
    else:
        start = _near(chosen, where, period, momentum, seed=seed, time_limit=time_limit, quiet=common.quiet)
    with running("following the family", 1.0, quiet=common.quiet) as listen:
        limits: dict[str, Any] = {"until": until, "time_limit": time_limit, "progress": listen}
        found = orbit_family(chosen, start, mode=mode, **options, **limits)
        if branch is not None:
            points = [one for one in found.points if one.kind in ("branch", "double period")]
            if not 1 <= branch <= len(points):
                raise ParameterError(
                    f"--branch must be from 1 to {len(points)}, the branches and double periods of this family: "
                    f"{', '.join(point_words(one, found) for one in points) or 'it has none'}; got {branch}."
                )
            limits["until"] = None
            found = orbit_family(chosen, points[branch - 1], **options, **limits)
    files = [] if data is None else [write_result(found, data)]
    if picture is not None:
        from liepoisson.plot.results import draw

        files += write_figure(draw(found), picture)
    show(found, format_, _family_record, text=lambda _: "\n".join([repr(found), *_wrote(*files)]))


def melnikov(
    system: SystemArgument,
    perturbation: Annotated[str, typer.Argument(help="H1 of H + delta H1.", metavar="H1")],
    *,
    start: Annotated[list[str], typer.Option(metavar="STATE", help=MIDDLE_HELP)],
    origin: Annotated[list[str], typer.Option(metavar="STATE", help=ORIGIN_HELP)],
    integral: Annotated[list[str], typer.Option(metavar="FORMULA", help=INTEGRAL_HELP)],
    time_limit: TimeLimitOption = TIME_LIMIT,
    out: FoundOption = None,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Print Melnikov's integrals along an orbit that is homoclinic to an equilibrium, with their errors.

    The values of an integral K on the unstable and the stable manifold differ by delta times the integral of {K, H1}
    over all times, to first order.
    """
    from liepoisson.orbits.melnikov_integrals import melnikov as integrals

    check_limits(time_limit=time_limit)
    chosen = read_numeric_system(system, common.values)
    data = data_file(out, f"{name_of_files(chosen, common.values)}-melnikov.nc")
    rest = _at_rest(chosen, origin, "--origin")
    middle = find_start(chosen, Where(start=start)).state
    with running("Melnikov's integrals", 1.0, quiet=common.quiet) as listen:
        found = integrals(
            chosen, middle, perturbation, origin=rest, integrals=integral, time_limit=time_limit, progress=listen
        )
    written = None if data is None else write_result(found, data)
    lines = lambda _: "\n".join([*melnikov_lines(found), *_wrote(written)])  # noqa: E731
    show(found, format_, melnikov_record, text=lines)


def _near(
    system: System,
    where: Where,
    period: float,
    momentum: Sequence[str] | None,
    *,
    seed: int,
    time_limit: float,
    quiet: bool,
) -> PeriodicOrbit:
    """The orbit near the start that the options ask for."""
    from liepoisson.orbits.guesses import periodic_orbit

    begin = find_start(system, where, seed)
    energy = begin.energy if where.energy is None else where.energy
    with running("looking for the orbit", 1.0, quiet=quiet) as listen:
        return periodic_orbit(
            system, begin.state, period=period, leaf=begin.leaf, energy=energy, momenta=_momenta(momentum),
            time_limit=time_limit, progress=listen,
        )  # fmt: skip


def _momenta(words: Sequence[str] | None) -> Sequence[str] | dict[str, float]:
    """Integrals by name, or with values where one has a value."""
    if not words or not any("=" in word for word in words):
        return words or ()
    values = assignments(words, "--momentum", "--momentum l3=1/2", "integral")
    return {name: as_double(value, "--momentum") for name, value in values.items()}


def _at_rest(system: System, words: Sequence[str], option: str) -> Equilibrium:
    """The equilibrium that an option names."""
    from liepoisson.equilibrium.stability import equilibrium
    from liepoisson.leaf.starts import read_state

    return equilibrium(
        system, read_state(system, cast("Any", state_of(words, option, system.component_names[0])), option)
    )


def orbit_lines(one: PeriodicOrbit) -> list[str]:
    """What is printed of one orbit."""
    start = zip(one.system.component_names, one.start.tolist(), strict=True)
    lines = [
        repr(one),
        f"period   {one.period!r}",
        f"energy   {one.energy!r}",
        f"start    {', '.join(f'{name} = {value!r}' for name, value in start)}",
        f"residual {one.residual:.0e}, multipliers: pairs to {one.pair_defect:.0e}, those that are 1 to "
        f"{one.trivial_defect:.0e}",
    ]
    if one.multipliers.size:
        lines.insert(3, f"multipliers  {', '.join(f'{m:.12g}' for m in one.multipliers)}")
    return lines


def _states(found: Sequence[PeriodicOrbit]) -> list[str]:
    if not found:
        return []
    names = ", ".join(found[0].system.component_names)
    return [f"starts ({names})", *(f"{k:3}  {', '.join(f'{x:.9g}' for x in one.start)}" for k, one in enumerate(found))]


def _wrote(*files: object) -> list[str]:
    return [f"wrote    {file}" for file in files if file is not None]


def point_words(point: FamilyPoint, family: OrbitFamily) -> str:
    """A point of a family in words: "branch at 0.16155"."""
    from liepoisson.orbits.orbit_families import value_of

    return f"{point.kind} at {value_of(point.orbit, family.along):.9g}"


def _orbit_record(one: PeriodicOrbit) -> dict[str, Any]:
    """An orbit as data that JSON can write."""
    return {
        "system": one.system.name,
        "energy": one.energy,
        "period": one.period,
        "stability": one.stability,
        "start": dict(zip(one.system.component_names, one.start.tolist(), strict=True)),
        "multipliers": [[float(m.real), float(m.imag)] for m in one.multipliers],
        "momenta": dict(one.momenta),
        "angles": one.angles.tolist(),
        "residual": one.residual,
        "pair_defect": one.pair_defect,
    }


def _family_record(family: OrbitFamily) -> dict[str, Any]:
    from liepoisson.orbits.orbit_families import value_of

    return {
        "along": family.along,
        "end": family.end,
        "orbits": [_orbit_record(one) for one in family],
        "points": [
            {"kind": one.kind, family.along: value_of(one.orbit, family.along), "after": one.after}
            for one in family.points
        ],
    }


def melnikov_lines(found: Melnikov) -> list[str]:
    """A line for each integral."""
    return [
        f"M_{name} = {value!r} ± {error:.1e}"
        for name, value, error in zip(found.integrals, found.value[0].tolist(), found.error[0].tolist(), strict=True)
    ]


def melnikov_record(found: Melnikov) -> dict[str, Any]:
    """The integrals as data that JSON can write."""
    values = zip(found.integrals, found.value[0].tolist(), found.error[0].tolist(), strict=True)
    return {"integrals": [{"integral": name, "value": value, "error": error} for name, value, error in values]}
