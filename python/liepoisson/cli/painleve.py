"""The command `liepoisson painleve`: the Kovalevskaya-Painlevé test, with balances and exponents."""

from __future__ import annotations

from typing import Annotated

import typer

from liepoisson.cli.options import Common, Format, FormatOption, FreeOption, SystemArgument, show
from liepoisson.cli.progress import listening
from liepoisson.cli.runs import check_limits
from liepoisson.cli.systems import read_file, with_settings, with_symbols

INCOMPLETE = 1

WEIGHTS_HELP = "Orders of poles, one for each coordinate: --weights 2,2,3,3.  [default: all maximal ones]"
LIMIT_HELP = "Seconds after which the balances that are left are named."


def painleve(
    system: SystemArgument,
    *,
    weights: Annotated[str | None, typer.Option(metavar="NUMBERS", help=WEIGHTS_HELP)] = None,
    free: FreeOption = None,
    time_limit: Annotated[float, typer.Option(help=LIMIT_HELP)] = 60.0,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Test whether singularities of solutions in complex time are poles: balances, exponents, logarithms, the verdict.

    A system that passes need not be integrable.  If something is left undecided, it is named, and the exit code is 1.
    """
    from liepoisson.integrability.painleve.singularity_analysis import painleve_test, record

    check_limits(time_limit=time_limit)
    chosen = with_symbols(with_settings(read_file(system), common.values), free or ()).system()
    orders = None if weights is None else [part.strip() for part in weights.split(",")]
    with listening("testing", quiet=common.quiet) as listen:
        found = painleve_test(chosen, weights=orders, time_limit=time_limit, progress=listen)
    show(found, format_, record)
    if found.verdict == "undecided":
        raise typer.Exit(INCOMPLETE)
