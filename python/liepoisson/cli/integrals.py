"""The command `liepoisson integrals`: polynomial first integrals, and the proof that there are no others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from liepoisson.cli.options import Common, LevelOption, ReportFormat, ReportFormatOption, SystemArgument, show
from liepoisson.cli.progress import listening
from liepoisson.cli.systems import read_system

if TYPE_CHECKING:
    from liepoisson.integrability.polynomial_integrals import FirstIntegrals

WEIGHT_HELP = "Weight of the polynomials instead, where the equations are homogeneous for positive weights."


def integrals(
    system: SystemArgument,
    *,
    degree: Annotated[int | None, typer.Option(help="Largest total degree.  [default: 2]")] = None,
    weight: Annotated[int | None, typer.Option(help=WEIGHT_HELP)] = None,
    on: LevelOption = None,
    format_: ReportFormatOption = ReportFormat.TEXT,
    common: Common,
) -> None:
    """Print all polynomial first integrals up to a degree, or of one weight.

    What is found is proved, and so is that there are no others.  Parameters without a value count as generic.
    """
    from liepoisson.integrability.polynomial_integrals import first_integrals, search_record

    chosen = read_system(system, common.values)
    with listening("searching", quiet=common.quiet) as listen:
        found = first_integrals(chosen, degree=degree, weight=weight, on=on or (), progress=listen)
    show(found, format_, search_record, latex_lines)


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
