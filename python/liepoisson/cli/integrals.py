"""The command `liepoisson integrals`: polynomial first integrals, and the proof that there are no others."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated

import typer

from liepoisson.cli.inspect import Format
from liepoisson.cli.progress import QuietOption, progress_bar
from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP, read_system

if TYPE_CHECKING:
    from liepoisson.integrability.polynomial_integrals import FirstIntegrals

FORMAT_HELP = "For people, for LaTeX, or for programs."
WEIGHT_HELP = "Weight of the polynomials instead, where the equations are homogeneous for positive weights."
ON_HELP = (
    "A function that vanishes on the level set that is searched: --on C1 --on C2-1.  [default: all of phase space]"
)


def integrals(
    system: Annotated[str, typer.Argument(help=SYSTEM_HELP, metavar="SYSTEM")],
    *,
    degree: Annotated[int | None, typer.Option(help="Largest total degree.  [default: 2]")] = None,
    weight: Annotated[int | None, typer.Option(help=WEIGHT_HELP)] = None,
    on: Annotated[list[str] | None, typer.Option(metavar="EQUATION", help=ON_HELP)] = None,
    format_: Annotated[Format, typer.Option("--format", help=FORMAT_HELP)] = Format.TEXT,
    quiet: QuietOption = False,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)] = None,
) -> None:
    """Print all polynomial first integrals up to a degree, or of one weight.

    What is found is proved, and so is that there are no others.  Parameters without a value count as generic.
    """
    from liepoisson.integrability.polynomial_integrals import first_integrals, search_record

    chosen = read_system(system, settings or ())
    with progress_bar(quiet=quiet) as bar:
        listen = None if bar is None else (lambda done: bar("searching", done, 1.0))
        found = first_integrals(chosen, degree=degree, weight=weight, on=on or (), progress=listen)
    match format_:
        case Format.TEXT:
            print(found)
        case Format.LATEX:
            print("\n".join(latex_lines(found)))
        case Format.JSON:
            print(json.dumps(search_record(found), indent=2))


def latex_lines(found: FirstIntegrals) -> list[str]:
    """One displayed equation for each integral, and what is proved, as a comment."""
    from liepoisson.formula.styles import LATEX
    from liepoisson.report.lines import Equation, Name
    from liepoisson.report.printing import Formula

    equations = [Equation(Name(f.name), Formula(f.expression)).write(LATEX) for f in found.found]
    return [*(f"% {line}" for line in _summary(found)), *(f"\\[ {equation} \\]" for equation in equations)]


def _summary(found: FirstIntegrals) -> list[str]:
    names = {f"{f.name} =" for f in found.found}
    return [line for line in str(found).splitlines() if not any(line.startswith(name) for name in names)]
