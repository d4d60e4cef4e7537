"""The command `liepoisson integrable`: is a system integrable, by polynomial integrals, and the certificate."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated

import typer

from liepoisson.cli.limits import check_limits
from liepoisson.cli.output import FORMAT_HELP, Format, checked_file
from liepoisson.cli.progress import QuietOption, progress_bar
from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP, read_system

if TYPE_CHECKING:
    from liepoisson.integrability.report import IntegrabilityReport

SAVE_HELP = "Write the whole report to this file, .json, which lp.integrability.load_report verifies."
CERTIFICATE_HELP = "Write the proof of integrability to this file, .json, which others can check."


def integrable(
    system: Annotated[str, typer.Argument(help=SYSTEM_HELP, metavar="SYSTEM")],
    *,
    degree: Annotated[int, typer.Option(help="Largest degree of the integrals.")] = 6,
    time_limit: Annotated[float, typer.Option(help="Seconds for the whole.")] = 60.0,
    certificate: Annotated[str | None, typer.Option(metavar="FILE", help=CERTIFICATE_HELP)] = None,
    save: Annotated[str | None, typer.Option(metavar="FILE", help=SAVE_HELP)] = None,
    format_: Annotated[Format, typer.Option("--format", help=FORMAT_HELP)] = Format.TEXT,
    quiet: QuietOption = False,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)] = None,
) -> None:
    """Look for polynomial integrals, degree by degree, until they prove that the system is integrable.

    Where none are found, it says up to which degree it is proved that there are none, and looks for a proof that there
    are no meromorphic ones, by the differential Galois group; the singularities in complex time are evidence besides.
    """
    from liepoisson.errors import ParameterError
    from liepoisson.integrability.certificates import save_certificate
    from liepoisson.integrability.report import integrability_report, report_record

    check_limits(seed=0, time_limit=time_limit)
    proof_file = None if certificate is None else checked_file(certificate, "--certificate", (".json",), "top.json")
    report_file = None if save is None else checked_file(save, "--save", (".json",), "report.json")
    chosen = read_system(system, settings or ())
    with progress_bar(quiet=quiet) as bar:
        listen = None if bar is None else (lambda done: bar("searching", done, 1.0))
        report = integrability_report(chosen, degree=degree, time_limit=time_limit, progress=listen)
    print(json.dumps(report_record(report), indent=2) if format_ is Format.JSON else report)
    if report_file is not None:
        report.save(report_file)
    if proof_file is not None:
        if report.certificate is None:
            raise ParameterError(f"--certificate: {_why_none(report)}")
        save_certificate(report.certificate, proof_file)


def _why_none(report: IntegrabilityReport) -> str:
    """Why a report has no certificate: nothing was proved, or the proof is more than a certificate holds."""
    if not report.commuting:
        return (
            f"wanted a proof of integrability; the verdict is {report.verdict!r}. Search to a higher degree, or write "
            "the report with --save"
        )
    functions = sorted({str(function) for search in report.searches for function in search.functions})
    others = next((note for note in report.notes if note.startswith("no certificate: ")), "")
    has = f"has {', '.join(functions)}" if functions else others.removeprefix("no certificate: ")
    return f"certificates hold polynomials with rational coefficients; this proof {has}. Write the report with --save"
