"""The command `liepoisson families`: for which parameters is there a further integral?"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from liepoisson.cli.options import (
    Common,
    FreeOption,
    LevelOption,
    ReportFormat,
    ReportFormatOption,
    SystemArgument,
    show,
)
from liepoisson.cli.progress import listening
from liepoisson.cli.runs import check_limits
from liepoisson.cli.systems import read_file, with_settings, with_symbols
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from liepoisson.integrability.families import IntegrableFamilies, ParameterCase

INCOMPLETE = 1

POSITIVE_HELP = "Parameters that are positive: --positive J1,J2,J3.  [default: all may be any real numbers]"
NONZERO_HELP = "Parameters that are not zero: --nonzero a3."
LIMIT_HELP = "Seconds after which the cases that are left are named."


def families(
    system: SystemArgument,
    *,
    degree: Annotated[int, typer.Option(help="Largest total degree of the integrals.")] = 2,
    on: LevelOption = None,
    free: FreeOption = None,
    positive: Annotated[list[str] | None, typer.Option(metavar="NAMES", help=POSITIVE_HELP)] = None,
    nonzero: Annotated[list[str] | None, typer.Option(metavar="NAMES", help=NONZERO_HELP)] = None,
    time_limit: Annotated[float, typer.Option(help=LIMIT_HELP)] = 600.0,
    format_: ReportFormatOption = ReportFormat.TEXT,
    common: Common,
) -> None:
    """Find the parameters for which there is a polynomial integral that there is not in general.

    Parameters without a value are unknown real numbers.  The cases that are found are proved to be all, unless some are
    left: these are named, and the exit code is 1.
    """
    from liepoisson.integrability.families import integrable_families

    check_limits(time_limit=time_limit)
    file = with_symbols(with_settings(read_file(system), common.values), free or ())
    if not file.symbols:
        known = ", ".join(name for name in file.parameters if len(file.scope.shapes[name]) < 2)
        raise ParameterError(
            f"{file.name} must have parameters without a value, which are searched; all have one. "
            + (f"Name some of {known} with --free." if known else "Its integrals are found by liepoisson integrals.")
        )
    chosen = file.system()
    with listening("splitting", quiet=common.quiet) as listen:
        found = integrable_families(
            chosen,
            degree=degree,
            on=on or (),
            positive=_names(positive),
            nonzero=_names(nonzero),
            time_limit=time_limit,
            progress=listen,
        )
    show(found, format_, record, latex_lines)
    if not found.complete:
        raise typer.Exit(INCOMPLETE)


def _names(given: list[str] | None) -> list[str]:
    return [name.strip() for names in given or () for name in names.split(",") if name.strip()]


def latex_lines(found: IntegrableFamilies) -> list[str]:
    """One displayed line of conditions for each case, and what is proved, as a comment."""
    from liepoisson.report.printing import Formula

    lines = str(found).splitlines()
    last = lines[1 + max(1, len(found.cases)) :]
    shown: list[str] = []
    for case in found.cases:
        parts = [f"{Formula(c).latex} = 0" for c in case.conditions]
        parts += [rf"{Formula(c).latex} \neq 0" for c in case.nonzero]
        shown += [f"% {case.remark}"] if case.remark else []
        shown.append(r"\[ " + r",\quad ".join(parts) + r" \]")
    return [f"% {lines[0]}", *shown, *(f"% {line}" for line in last)]


def record(found: IntegrableFamilies) -> dict[str, Any]:
    """The cases as data that JSON can write, expressions in the grammar of system files."""
    from liepoisson.report.printing import Formula

    return {
        "system": found.system.name,
        "degree": found.degree,
        "on": [Formula(f).plain for f in found.on],
        "parameters": [str(p) for p in found.parameters],
        "assumptions": found.assumptions,
        "general": [Formula(f).plain for f in found.general],
        "cases": [_case_record(case) for case in found.cases],
        "complete": found.complete,
        "left": list(found.left),
        "cases_without": found.n_closed,
        "casimirs": [
            {"zero": [Formula(c).plain for c in one.conditions], "casimirs": [Formula(c).plain for c in one.casimirs]}
            for one in found.casimirs
        ],
    }


def _case_record(case: ParameterCase) -> dict[str, Any]:
    from liepoisson.report.printing import Formula

    example = None if case.example is None else {str(p): str(value) for p, value in case.example.items()}
    return {
        "zero": [Formula(c).plain for c in case.conditions],
        "not_zero": [Formula(c).plain for c in case.nonzero],
        "example": example,
        "remark": case.remark,
        "integrals": [Formula(f).plain for f in case.integrals],
    }
