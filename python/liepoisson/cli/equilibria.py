"""The command `liepoisson equilibria`: the equilibria of a leaf, and whether they are stable."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from liepoisson.cli.options import (
    Common,
    Format,
    FormatOption,
    LeafOption,
    SeedOption,
    SystemArgument,
    TableOption,
    Where,
    show,
)
from liepoisson.cli.output import TABLE_ENDINGS, data_file, name_of_files, write_result
from liepoisson.cli.progress import progress_bar
from liepoisson.cli.runs import check_limits
from liepoisson.cli.starts import assignments, find_start, read_numeric_system

if TYPE_CHECKING:
    from liepoisson.equilibrium.equilibrium_list import Equilibria

STATE_HELP = (
    "A state on the leaf that is meant: all numbers, or by name, --start l=1,0,0 --start beta3=1; the others are 0."
)
ALONG_HELP = "An integral, by name or formula, along whose flow relative equilibria move, with its value: l3=1/2."
STARTS_HELP = "Starts of a search, where algebra does not give the list.  [default: 200]"


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
    show(found, format_, record, text=lambda _: "\n".join([*equilibrium_lines(found), *wrote]))


def equilibrium_lines(found: Equilibria) -> list[str]:
    """The table, then the state of each equilibrium in the order of its rows."""
    names = found.leaf.system.component_names
    values = ", ".join(f"{name} = {value:.9g}" for name, value in found.leaf.casimirs.items())
    lines = [f"leaf     {found.leaf.stratum}" + (f": {values}" if values else ""), repr(found)]
    if len(found):
        lines.append(f"states ({', '.join(names)})")
        lines += [f"{k:3}  {', '.join(f'{value:.9g}' for value in e.state)}" for k, e in enumerate(found)]
    return [*lines, *(f"hint     {hint}" for hint in found.hints)]


def record(found: Equilibria) -> dict[str, Any]:
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
