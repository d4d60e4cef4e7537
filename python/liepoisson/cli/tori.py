"""The commands `diagram` and `critical`: the critical values of the integrals of a system on a leaf."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from liepoisson.cli.options import (
    Common,
    FigureOption,
    Format,
    FormatOption,
    FoundOption,
    PlotOption,
    ReportFormat,
    ReportFormatOption,
    SeedOption,
    SystemArgument,
    Where,
    show,
)
from liepoisson.cli.output import data_file, figure_stem, name_of_files, write_figure, write_result
from liepoisson.cli.runs import TimeLimitOption, check_limits, running
from liepoisson.cli.starts import assignments, find_start, split_at_commas
from liepoisson.cli.systems import read_numeric_system
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_double
from liepoisson.inputs.deadline import SEARCH_LIMIT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from liepoisson.model.system import System
    from liepoisson.tori.critical_polynomials import CriticalEquations
    from liepoisson.tori.diagrams import Diagram
    from liepoisson.tori.fibre_regions import Regions
    from liepoisson.tori.lagrange_diagrams import LagrangeDiagram

INTEGRAL_HELP = "An integral beside H: --integral K. By default the known ones that commute.  Repeat it for more."
ENERGY_MAX_HELP = "Follow families up to this energy.  [default: a little above the critical points]"
AT_HELP = "Of three integrals: keep one at a value, --at l3=0.3, and look for the critical values of the other two."
CUT_HELP = "Of the twisted Lagrange top: draw the plane of this l3 instead of the figure in space."
VALUES_HELP = "Rational values of Casimirs, as in --leaf C1=3/5,C2=1; the others are variables of the equations."
REGIONS_HELP = "Count the tori over each region of the plane; a file .nc has the regions with the diagram."


def diagram(
    system: SystemArgument,
    *,
    where: Where,
    integral: Annotated[list[str] | None, typer.Option(metavar="FORMULA", help=INTEGRAL_HELP)] = None,
    at: Annotated[str | None, typer.Option(metavar="NAME=NUMBER", help=AT_HELP)] = None,
    energy_max: Annotated[str | None, typer.Option(metavar="NUMBER", help=ENERGY_MAX_HELP)] = None,
    cut: Annotated[str | None, typer.Option(metavar="NUMBER", help=CUT_HELP)] = None,
    regions: Annotated[bool, typer.Option("--regions", help=REGIONS_HELP)] = False,
    seed: SeedOption = 0,
    time_limit: TimeLimitOption = TIME_LIMIT,
    out: FoundOption = None,
    plot: PlotOption = False,
    figure: FigureOption = None,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Print the bifurcation diagram of an integrable system on a leaf: the critical values of its integrals.

    Of two integrals, or of three with --at, by search; of the twisted Lagrange top, charged or not, in closed form.
    Without a leaf it is that of a random state, where partial integrals of the system hold if it has any.
    """
    from liepoisson.tori.lagrange_leaves import is_twisted_lagrange

    check_limits(seed=seed, time_limit=time_limit)
    chosen = read_numeric_system(system, common.values)
    stem = f"{name_of_files(chosen, common.values)}-diagram"
    data, picture = data_file(out, f"{stem}.nc"), figure_stem(plot, figure, stem)
    found: Diagram | LagrangeDiagram
    counted: Regions | tuple[()] = ()
    if is_twisted_lagrange(chosen) and not integral and at is None:
        from liepoisson.tori.lagrange_diagrams import lagrange_diagram

        if regions or energy_max is not None:
            raise ParameterError(
                "--regions and --energy-max are for diagrams by search; that of the twisted Lagrange top is in closed "
                "form, with one torus over each regular value. Leave them out, or search where an integral has a "
                "value: --at l3=0.3."
            )
        found = lagrange_diagram(find_start(chosen, where, seed).leaf)
    else:
        from liepoisson.tori.diagrams import diagram as search
        from liepoisson.tori.fibre_regions import regions as count
        from liepoisson.tori.momentum_maps import momentum_map

        if cut is not None:
            raise ParameterError("--cut is for the diagram of the twisted Lagrange top in closed form. Leave it out.")
        held = assignments([] if at is None else [at], "--at", "--at l3=0.3", "integral")
        values = {name: as_double(value, "--at") for name, value in held.items()}
        limit = None if energy_max is None else as_double(energy_max, "--energy-max")
        leaf = find_start(chosen, where if where.is_given else replace(where, leaf=_known_values(chosen)), seed).leaf
        momentum = momentum_map(chosen, integral or None, leaf=leaf if leaf.is_regular else None)
        with running("looking for critical values", 1.0, quiet=common.quiet):
            found = search(leaf, at=values, momentum=momentum, energy_max=limit, seed=seed, time_limit=time_limit)
            counted = count(found, seed=seed, time_limit=time_limit) if regions else ()
    # the file of regions has their diagram; its table is that of critical values
    whole = counted if counted and data is not None and data.suffix == ".nc" else found
    files = [] if data is None else [write_result(whole, data)]
    if picture is not None:
        from liepoisson.plot.diagrams import diagram as draw

        axes = draw(found, regions=counted, l3=None if cut is None else as_double(cut, "--cut"))
        files += write_figure(cast("Figure", axes.figure), picture)
    lines = [*diagram_lines(found), *(repr(one)[1:-1] for one in counted), *(f"wrote    {path}" for path in files)]
    show(found, format_, diagram_record, text=lambda _: "\n".join(lines))


def _known_values(system: System) -> list[str] | None:
    """The values of Casimirs where partial integrals of a system hold, "C1=0", if there are any."""
    values = list[str]()
    for name, casimir in system.functions.casimirs.items():
        for _, zero in system.partial_integrals.values():
            if (value := (casimir.expression - zero).expand()).is_number:
                values.append(f"{name}={value}")
    return list(dict.fromkeys(values)) or None


def diagram_lines(found: Diagram | LagrangeDiagram) -> list[str]:
    """What the diagram consists of, a line for each part."""
    from liepoisson.tori.diagrams import Diagram

    lines = [repr(found)[1:-1]]
    if isinstance(found, Diagram):
        h, other = found.names
        rest = "relative equilibrium" if found.at else "equilibrium"
        for family in found.families:
            low, high = family.values.min(axis=0), family.values.max(axis=0)
            span = f"{h} from {low[0]:.6g} to {high[0]:.6g}, {other} from {low[1]:.6g} to {high[1]:.6g}"
            lines.append(f"{family.type}: {span}")
        for kind, value in zip(found.rest_types, found.rest_values, strict=True):
            lines.append(f"{rest}, {kind}: {h} = {value[0]:.6g}, {other} = {value[1]:.6g}")
        for value in found.degenerate_values:
            lines.append(f"degenerate, on no curve: {h} = {value[0]:.6g}, {other} = {value[1]:.6g}")
        return lines
    return [*lines, *(f"{curve.kind} from {curve.ends[0]} to {curve.ends[1]}" for curve in found.curves)]


def diagram_record(found: Diagram | LagrangeDiagram) -> dict[str, Any]:
    """The diagram as data that JSON can write."""
    from liepoisson.tori.diagrams import Diagram

    rows = {name: column.tolist() for name, column in found.columns().items()}
    kind = {"class": found.leaf_class} if not isinstance(found, Diagram) else {"at": found.at} if found.at else {}
    return {"casimirs": found.leaf.casimirs, **kind, "critical_values": rows}


def critical(
    system: SystemArgument,
    *,
    leaf: Annotated[list[str] | None, typer.Option(metavar="C1=VALUE,...", help=VALUES_HELP)] = None,
    integral: Annotated[list[str] | None, typer.Option(metavar="FORMULA", help=INTEGRAL_HELP)] = None,
    time_limit: TimeLimitOption = SEARCH_LIMIT,
    format_: ReportFormatOption = ReportFormat.TEXT,
    common: Common,
) -> None:
    """Print polynomials, exactly, of one of which each critical value of the integrals is a zero.

    For Hamiltonians and integrals that are polynomials with rational coefficients.
    """
    from liepoisson.tori.critical_polynomials import critical_equations

    check_limits(time_limit=time_limit)
    chosen = read_numeric_system(system, common.values)
    values = assignments(split_at_commas(leaf or ()), "--leaf", "--leaf C1=3/5,C2=1", "Casimir") if leaf else {}
    with running("eliminating", 1.0, quiet=common.quiet):
        found = critical_equations(chosen, values, integrals=integral or None, time_limit=time_limit)
    show(found, format_, critical_record, critical_in_latex)


def critical_in_latex(found: CriticalEquations) -> list[str]:
    """A displayed line for each curve."""
    from liepoisson.report.printing import Formula

    return [rf"\[ {', '.join(f'{Formula(p).latex} = 0' for p in one)} \]" for one in found.equations()]


def critical_record(found: CriticalEquations) -> dict[str, Any]:
    """The equations as data that JSON can write."""
    return {
        "system": found.momentum.system.name,
        "casimirs": {name: str(value) for name, value in found.casimirs.items()},
        "curves": [str(p) for p in found.curves],
        "others": [[str(p) for p in one] for one in found.others],
    }
