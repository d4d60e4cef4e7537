"""The command `liepoisson darboux`: Darboux polynomials with their cofactors, and integrals made of them."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liepoisson.cli.options import Common, LevelOption, ReportFormat, ReportFormatOption, SystemArgument, show
from liepoisson.cli.progress import listening
from liepoisson.cli.runs import check_limits
from liepoisson.cli.systems import read_system

if TYPE_CHECKING:
    from liepoisson.integrability.darboux import DarbouxPolynomials

WEIGHT_HELP = "Largest weight instead, where the equations are homogeneous for positive weights."


class Numbers(StrEnum):
    """Which numbers the coefficients of cofactors may be."""

    COMPLEX = "complex"
    REAL = "real"
    RATIONAL = "rational"


def darboux(
    system: SystemArgument,
    *,
    degree: Annotated[int | None, typer.Option(help="Largest total degree.  [default: 2]")] = None,
    weight: Annotated[int | None, typer.Option(help=WEIGHT_HELP)] = None,
    on: LevelOption = None,
    field: Annotated[Numbers, typer.Option(help="Which numbers cofactors may have.")] = Numbers.COMPLEX,
    time_limit: Annotated[float, typer.Option(help="Seconds after which the cases that are left are named.")] = 60.0,
    format_: ReportFormatOption = ReportFormat.TEXT,
    common: Common,
) -> None:
    """Print the Darboux polynomials p up to a degree or a weight: the rate of p is p times a polynomial, its cofactor.

    p = 0 is then invariant, and powers of several whose cofactors cancel make a rational integral.
    """
    from liepoisson.integrability.darboux import darboux_polynomials

    check_limits(time_limit=time_limit)
    chosen = read_system(system, common.values)
    with listening("searching", quiet=common.quiet) as listen:
        found = darboux_polynomials(
            chosen,
            degree=degree,
            weight=weight,
            on=on or (),
            field=field.value,
            time_limit=time_limit,
            progress=listen,
        )
    show(found, format_, record, latex_lines)


def latex_lines(found: DarbouxPolynomials) -> list[str]:
    """Two displayed equations for each polynomial, it and its rate, and what is proved, as a comment."""
    from liepoisson.formula.styles import LATEX
    from liepoisson.report.lines import Equation, Name
    from liepoisson.report.printing import Formula

    names = {f"{p.name} =" for p in found.found}
    lines = [f"% {line}" for line in str(found).splitlines() if not any(line.startswith(name) for name in names)]
    for p in found.found:
        equation = Equation(Name(p.name), Formula(p.expression)).write(LATEX)
        name = equation.split(" = ", 1)[0]
        lines.append(rf"\[ {equation}, \qquad \dot {name} = ({Formula(p.cofactor).write(LATEX)})\, {name} \]")
    return lines


def record(found: DarbouxPolynomials) -> dict[str, Any]:
    """The polynomials and integrals as data that JSON can write."""
    from liepoisson.report.printing import Formula

    size = {"degree": found.degree} if found.weight is None else {"weight": found.weight, "weights": found.weights}
    return {
        "system": found.system.name,
        **size,
        "on": [Formula(f).plain for f in found.on],
        "field": found.field,
        "known": [{"name": name, "expression": Formula(f).plain} for name, f in found.known.items()],
        "found": [
            {
                "name": p.name,
                "expression": Formula(p.expression).plain,
                "cofactor": Formula(p.cofactor).plain,
                "degree": p.degree,
                "real": p.is_real,
            }
            for p in found.found
        ],
        "rational_integrals": [
            {
                "name": r.name,
                "powers": r.powers,
                "expression": Formula(r.expression).plain,
                "polynomial": r.is_polynomial,
                "independent": r.is_independent,
            }
            for r in found.rational_integrals
        ],
        "complete": found.complete,
        "left": list(found.left),
        "proof": {
            "monomials": found.n_monomials,
            "blocks": found.n_blocks,
            "cofactor_monomials": [Formula(m).plain for m in found.cofactor_monomials],
            "cases": found.n_cases,
        },
    }
