"""The command `liepoisson integrable`: is a system integrable, by polynomial integrals, and the certificate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from liepoisson.cli.options import Common, Format, FormatOption, SystemArgument, show
from liepoisson.cli.output import checked_file
from liepoisson.cli.progress import listening
from liepoisson.cli.runs import check_limits
from liepoisson.cli.systems import read_system

if TYPE_CHECKING:
    from liepoisson.integrability.report import IntegrabilityReport

SAVE_HELP = "Write the whole report to this file, .json, which lp.integrability.load_report verifies."
CERTIFICATE_HELP = "Write the proof of integrability to this file, .json, which others can check."


def integrable(
    system: SystemArgument,
    *,
    degree: Annotated[int, typer.Option(help="Largest degree of the integrals.")] = 6,
    time_limit: Annotated[float, typer.Option(help="Seconds for the whole.")] = 60.0,
    certificate: Annotated[str | None, typer.Option(metavar="FILE", help=CERTIFICATE_HELP)] = None,
    save: Annotated[str | None, typer.Option(metavar="FILE", help=SAVE_HELP)] = None,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Look for polynomial integrals, degree by degree, until they prove that the system is integrable.

    Where none are found, it says up to which degree it is proved that there are none, and looks for a proof that there
    are no meromorphic ones, by the differential Galois group; the singularities in complex time are evidence besides.
    """
    from liepoisson.errors import ParameterError
    from liepoisson.integrability.certificates import save_certificate
    from liepoisson.integrability.report import integrability_report, report_record

    check_limits(time_limit=time_limit)
    proof_file = None if certificate is None else checked_file(certificate, "--certificate", (".json",), "top.json")
    report_file = None if save is None else checked_file(save, "--save", (".json",), "report.json")
    chosen = read_system(system, common.values)
    with listening("searching", quiet=common.quiet) as listen:
        report = integrability_report(chosen, degree=degree, time_limit=time_limit, progress=listen)
    show(report, format_, report_record)
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
