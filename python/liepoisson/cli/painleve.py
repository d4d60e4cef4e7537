"""The command `liepoisson painleve`: the Kovalevskaya-Painlevé test, with balances and exponents."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from liepoisson.cli.limits import check_limits
from liepoisson.cli.output import FORMAT_HELP, Format
from liepoisson.cli.progress import QuietOption, progress_bar
from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP, read_file, with_settings, with_symbols

INCOMPLETE = 1

WEIGHTS_HELP = "Orders of poles, one for each coordinate: --weights 2,2,3,3.  [default: all maximal ones]"
FREE_HELP = "A parameter that has a value and becomes a symbol: --free C.  Repeat it for more."
LIMIT_HELP = "Seconds after which the balances that are left are named."


def painleve(
    system: Annotated[str, typer.Argument(help=SYSTEM_HELP, metavar="SYSTEM")],
    *,
    weights: Annotated[str | None, typer.Option(metavar="NUMBERS", help=WEIGHTS_HELP)] = None,
    free: Annotated[list[str] | None, typer.Option(metavar="NAME", help=FREE_HELP)] = None,
    time_limit: Annotated[float, typer.Option(help=LIMIT_HELP)] = 60.0,
    format_: Annotated[Format, typer.Option("--format", help=FORMAT_HELP)] = Format.TEXT,
    quiet: QuietOption = False,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)] = None,
) -> None:
    """Test whether singularities of solutions in complex time are poles: balances, exponents, logarithms, the verdict.

    A system that passes need not be integrable.  If something is left undecided, it is named, and the exit code is 1.
    """
    from liepoisson.integrability.painleve.singularity_analysis import painleve_test, record

    check_limits(seed=0, time_limit=time_limit)
    chosen = with_symbols(with_settings(read_file(system), settings or ()), free or ()).system()
    orders = None if weights is None else [part.strip() for part in weights.split(",")]
    with progress_bar(quiet=quiet) as bar:
        listen = None if bar is None else (lambda done: bar("testing", done, 1.0))
        found = painleve_test(chosen, weights=orders, time_limit=time_limit, progress=listen)
    print(json.dumps(record(found), indent=2) if format_ is Format.JSON else found)
    if found.verdict == "undecided":
        raise typer.Exit(INCOMPLETE)
