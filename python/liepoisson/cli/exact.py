"""The commands `inspect`, `integrals`, `darboux`, `families`, `deformations`: what exact algebra proves of a system."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from liepoisson.cli.options import (
    Common,
    FreeOption,
    LevelOption,
    ReportFormat,
    ReportFormatOption,
    SettingsOption,
    SystemArgument,
    show,
)
from liepoisson.cli.progress import listening
from liepoisson.cli.systems import read_equations, read_file, read_whole_system, with_symbols
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import FAMILY_LIMIT, SEARCH_LIMIT

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.formula.styles import Style
    from liepoisson.integrability.darboux import DarbouxPolynomials
    from liepoisson.integrability.deforming.deformed_integrals import Deformations
    from liepoisson.integrability.families import IntegrableFamilies, ParameterCase
    from liepoisson.integrability.polynomial_integrals import FirstIntegrals

REFUTED = INCOMPLETE = 1
"""Exit codes: something that is claimed is false; some cases are left."""

INTEGRAL_WEIGHT_HELP = "Weight of the polynomials instead, where the equations are homogeneous for positive weights."
DARBOUX_WEIGHT_HELP = "Largest weight instead, where the equations are homogeneous for positive weights."
PARAMETER_HELP = "The parameters of the deformation, which lose their values: --parameter epsilon."
DEFORMED_WEIGHT_HELP = "Largest weight instead, where the equations are homogeneous for positive weights.  [default: 4]"
POSITIVE_HELP = "Parameters that are positive: --positive J1,J2,J3.  [default: all may be any real numbers]"
NONZERO_HELP = "Parameters that are not zero: --nonzero a3."
LIMIT_HELP = "Seconds after which the cases that are left are named."


def inspect(
    system: SystemArgument, *, format_: ReportFormatOption = ReportFormat.TEXT, settings: SettingsOption = None
) -> None:
    """Print what can be proved about a system.

    Algebra, extension, Jacobi identity, Casimirs, rank, leaves, symmetries, Hamiltonian, equations of motion and known
    integrals; every proof is computed anew.  Of a file with a table [damping] or [noise] also what stays constant with
    it; all else is about the system without.  JSON has one object per topic (see `liepoisson.systems.Report`).

    The exit code is 1 where something that is claimed turns out to be false: the Jacobi identity, or an integral that
    the file gives.
    """
    from liepoisson.report.describe import inspect as inspect_system

    report = inspect_system(read_whole_system(system, settings or ()))
    text = lambda _: report.text(terminal_style())  # noqa: E731
    show(report, format_, lambda _: report.record(), lambda _: [report.latex()], text=text)
    if report.failed:
        print(f"liepoisson: {report.name}: {'; '.join(report.failed)}.", file=sys.stderr)
        raise typer.Exit(REFUTED)


def terminal_style() -> Style:
    """Unicode where standard output can show it, else ASCII."""
    from liepoisson.formula.styles import PLAIN, UNICODE

    try:
        "α·β × ½ ₁² ∂ ⊗ ≠".encode(sys.stdout.encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return PLAIN
    return UNICODE


def integrals(
    system: SystemArgument,
    *,
    degree: Annotated[int | None, typer.Option(help="Largest total degree.  [default: 2]")] = None,
    weight: Annotated[int | None, typer.Option(help=INTEGRAL_WEIGHT_HELP)] = None,
    on: LevelOption = None,
    format_: ReportFormatOption = ReportFormat.TEXT,
    common: Common,
) -> None:
    """Print all polynomial first integrals up to a degree, or of one weight.

    What is found is proved, and so is that there are no others.  Parameters without a value count as generic.
    """
    from liepoisson.integrability.polynomial_integrals import first_integrals, search_record

    chosen = read_equations(system, common.values)
    with listening("searching", quiet=common.quiet) as listen:
        found = first_integrals(chosen, degree=degree, weight=weight, on=on or (), progress=listen)
    show(found, format_, search_record, integrals_in_latex)


def integrals_in_latex(found: FirstIntegrals) -> list[str]:
    """One displayed equation for each integral, and what is proved, as a comment."""
    equations = [_equation(f.name, f.expression) for f in found.found]
    return [*_remarks(found, found.found), *(f"\\[ {equation} \\]" for equation in equations)]


def _equation(name: str, expression: Expr) -> str:
    from liepoisson.formula.styles import LATEX
    from liepoisson.report.lines import Equation, Name
    from liepoisson.report.printing import Formula

    return Equation(Name(name), Formula(expression)).write(LATEX)


def _remarks(found: object, named: Iterable[Any]) -> list[str]:
    """What a result says besides what it found, as comments of LaTeX."""
    names = tuple(f"{one.name} =" for one in named)
    return [f"% {line}" for line in str(found).splitlines() if not line.startswith(names)]


class Numbers(StrEnum):
    """Which numbers the coefficients of cofactors may be."""

    COMPLEX = "complex"
    REAL = "real"
    RATIONAL = "rational"


def darboux(
    system: SystemArgument,
    *,
    degree: Annotated[int | None, typer.Option(help="Largest total degree.  [default: 2]")] = None,
    weight: Annotated[int | None, typer.Option(help=DARBOUX_WEIGHT_HELP)] = None,
    on: LevelOption = None,
    field: Annotated[Numbers, typer.Option(help="Which numbers cofactors may have.")] = Numbers.COMPLEX,
    time_limit: Annotated[float, typer.Option(help=LIMIT_HELP)] = SEARCH_LIMIT,
    format_: ReportFormatOption = ReportFormat.TEXT,
    common: Common,
) -> None:
    """Print the Darboux polynomials p up to a degree or a weight: the rate of p is p times a polynomial, its cofactor.

    p = 0 is then invariant, and powers of several whose cofactors cancel make a rational integral.
    """
    from liepoisson.cli.runs import check_limits  # which needs NumPy; `inspect` does not
    from liepoisson.integrability.darboux import darboux_polynomials

    check_limits(time_limit=time_limit)
    chosen = read_equations(system, common.values)
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
    show(found, format_, darboux_record, darboux_in_latex)


def darboux_in_latex(found: DarbouxPolynomials) -> list[str]:
    """Two displayed equations for each polynomial, it and its rate, and what is proved, as a comment."""
    lines = _remarks(found, found.found)
    for p in found.found:
        equation = _equation(p.name, p.expression)
        name = equation.split(" = ", 1)[0]
        lines.append(rf"\[ {equation}, \qquad \dot {name} = ({_latex(p.cofactor)})\, {name} \]")
    return lines


def _latex(expression: Expr) -> str:
    from liepoisson.report.printing import Formula

    return Formula(expression).latex


def _plain(expression: Expr) -> str:
    from liepoisson.report.printing import Formula

    return Formula(expression).plain


def darboux_record(found: DarbouxPolynomials) -> dict[str, Any]:
    """The polynomials and integrals as data that JSON can write."""
    size = {"degree": found.degree} if found.weight is None else {"weight": found.weight, "weights": found.weights}
    known = [{"name": name, "expression": _plain(f)} for name, f in found.known.items()]
    polynomial = {"name": "name", "expression": "expression", "cofactor": "cofactor", "degree": "degree"}
    integral = {"name": "name", "powers": "powers", "expression": "expression", "polynomial": "is_polynomial"}
    proof = {"monomials": "n_monomials", "blocks": "n_blocks", "cofactor_monomials": "cofactor_monomials"}
    return {
        "system": found.system.name,
        **size,
        **_fields(found, on="on", field="field"),
        "known": known,
        "found": [_fields(p, **polynomial, real="is_real") for p in found.found],
        "rational_integrals": [_fields(r, **integral, independent="is_independent") for r in found.rational_integrals],
        "time_dependent_integrals": [
            _fields(e, name="name", powers="powers", rate="rate", expression="expression", independent="is_independent")
            for e in found.time_dependent_integrals
        ],
        **_fields(found, complete="complete", left="left"),
        "proof": _fields(found, **proof, cases="n_cases"),
    }


def families(
    system: SystemArgument,
    *,
    degree: Annotated[int, typer.Option(help="Largest total degree of the integrals.")] = 2,
    on: LevelOption = None,
    free: FreeOption = None,
    positive: Annotated[list[str] | None, typer.Option(metavar="NAMES", help=POSITIVE_HELP)] = None,
    nonzero: Annotated[list[str] | None, typer.Option(metavar="NAMES", help=NONZERO_HELP)] = None,
    time_limit: Annotated[float, typer.Option(help=LIMIT_HELP)] = FAMILY_LIMIT,
    format_: ReportFormatOption = ReportFormat.TEXT,
    common: Common,
) -> None:
    """Find the parameters for which there is a polynomial integral that there is not in general.

    Parameters without a value are unknown real numbers.  The cases that are found are proved to be all, unless some are
    left: these are named, and the exit code is 1.
    """
    from liepoisson.cli.runs import check_limits
    from liepoisson.integrability.families import integrable_families

    check_limits(time_limit=time_limit)
    file = with_symbols(read_file(system), common.values, free or ())
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
    show(found, format_, families_record, families_in_latex)
    if not found.complete:
        raise typer.Exit(INCOMPLETE)


def deformations(
    system: SystemArgument,
    *,
    parameter: Annotated[list[str], typer.Option(metavar="NAMES", help=PARAMETER_HELP)],
    degree: Annotated[int | None, typer.Option(help="Largest total degree of the integrals at 0.")] = None,
    weight: Annotated[int | None, typer.Option(help=DEFORMED_WEIGHT_HELP)] = None,
    order: Annotated[int, typer.Option(help="Highest order of the corrections.")] = 4,
    time_limit: Annotated[float, typer.Option(help=LIMIT_HELP)] = SEARCH_LIMIT,
    format_: ReportFormatOption = ReportFormat.TEXT,
    common: Common,
) -> None:
    """Find which integrals at the value 0 of a parameter survive when it is not 0.

    What does not survive has a proof.  Several parameters: the values for which an integral survives.
    """
    from liepoisson.cli.runs import check_limits
    from liepoisson.integrability.deforming.deformed_integrals import deformations as search

    check_limits(time_limit=time_limit)
    file = read_file(system)
    names = _names(parameter)
    chosen = with_symbols(file, common.values, [name for name in names if name in file.parameters]).system()
    found = search(chosen, parameter=names, degree=degree, weight=weight, order=order, time_limit=time_limit)
    show(found, format_, deformations_record, deformations_in_latex)


def deformations_in_latex(found: Deformations) -> list[str]:
    """One displayed equation for each integral that survives, and what is proved, as a comment."""
    shown: list[tuple[Expr, Expr]] = [(f.start, f.function) for f in (*found.integrals, *found.cases)]
    equations = [rf"\[ {_latex(start)} + \dots = {_latex(function)} \]" for start, function in shown]
    return [*(f"% {line}" for line in str(found).splitlines()), *equations]


def deformations_record(found: Deformations) -> dict[str, Any]:
    """What survives and what does not as data that JSON can write, expressions in the grammar of system files."""
    size = {"degree": found.degree} if found.weight is None else {"weight": found.weight, "weights": found.weights}
    return {
        "system": found.system.name,
        "parameters": list(found.parameters),
        **size,
        "order": found.order,
        "known": [{"name": name, "expression": _plain(f)} for name, f in (found.trivial | found.known).items()],
        "not_counted": list(found.trivial),
        "integrals": [_fields(f, start="start", function="function", order="order") for f in found.integrals],
        "obstructions": [
            {
                **_fields(o, start="start", order="order", monomials="n_corrections"),
                "functional": {_plain(m): _plain(c) for m, c in o.functional.items()},
            }
            for o in found.obstructions
        ],
        "cases": [
            _fields(c, start="start", zero="conditions", function="function", exact="is_exact") for c in found.cases
        ],
        **_fields(found, hamiltonian_terms="hamiltonian_terms", left="left"),
    }


def _names(given: list[str] | None) -> list[str]:
    return [name.strip() for names in given or () for name in names.split(",") if name.strip()]


def families_in_latex(found: IntegrableFamilies) -> list[str]:
    """One displayed line of conditions for each case, and what is proved, as a comment."""
    lines = str(found).splitlines()
    last = lines[1 + max(1, len(found.cases)) :]
    shown: list[str] = []
    for case in found.cases:
        parts = [f"{_latex(c)} = 0" for c in case.conditions]
        parts += [rf"{_latex(c)} \neq 0" for c in case.nonzero]
        shown += [f"% {case.remark}"] if case.remark else []
        shown.append(r"\[ " + r",\quad ".join(parts) + r" \]")
    return [f"% {lines[0]}", *shown, *(f"% {line}" for line in last)]


def families_record(found: IntegrableFamilies) -> dict[str, Any]:
    """The cases as data that JSON can write, expressions in the grammar of system files."""
    return {
        "system": found.system.name,
        **_fields(found, degree="degree", on="on"),
        "parameters": [str(p) for p in found.parameters],
        **_fields(found, assumptions="assumptions", general="general"),
        "cases": [_case_record(case) for case in found.cases],
        **_fields(found, complete="complete", left="left", cases_without="n_closed"),
        "casimirs": [_fields(one, zero="conditions", casimirs="casimirs") for one in found.casimirs],
    }


def _case_record(case: ParameterCase) -> dict[str, Any]:
    example = None if case.example is None else {str(p): str(value) for p, value in case.example.items()}
    conditions = _fields(case, zero="conditions", not_zero="nonzero")
    return {**conditions, "example": example, **_fields(case, remark="remark", integrals="integrals")}


def _fields(one: Any, **names: str) -> dict[str, Any]:
    """Attributes under the names that they have in JSON, expressions in the grammar of system files."""
    return {key: _as_data(getattr(one, name)) for key, name in names.items()}


def _as_data(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return [_as_data(item) for item in cast("Sequence[Any]", value)]
    return _plain(value) if hasattr(value, "free_symbols") else value
