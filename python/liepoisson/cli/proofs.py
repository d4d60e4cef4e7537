"""The commands `integrable`, `painleve` and `prove`: integrability, singularities in complex time, and chaos."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liepoisson.cli.options import Common, Format, FormatOption, FreeOption, SystemArgument, show
from liepoisson.cli.output import checked_file
from liepoisson.cli.progress import listening
from liepoisson.cli.runs import check_limits
from liepoisson.cli.systems import read_equations, read_system
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import SEARCH_LIMIT

if TYPE_CHECKING:
    from liepoisson.integrability.report import IntegrabilityReport
    from liepoisson.model.system import System
    from liepoisson.proofs.theorem import ChaosProof

INCOMPLETE = 1

SAVE_HELP = "Write the whole report to this file, .json, which lp.integrability.load_report verifies."
WRITTEN_HELP = "Write the proof of integrability to this file, .json, which others can check."
WEIGHTS_HELP = "Orders of poles, one for each coordinate: --weights 2,2,3,3.  [default: all maximal ones]"
LIMIT_HELP = "Seconds after which the balances that are left are named."
CERTIFICATE_HELP = "Certificate to check, .json.  [default: the one that comes with the package]"
SEARCH_HELP = "Search for a new certificate and check it, on --level or on the level of the one in the package."
LEVEL_HELP = "Values of H and all Casimirs for --search: --level H=4,C1=10,C2=-2,C3=1."
STARTS_HELP = (
    "Starts of the searches for periodic orbits with --search; homoclinic orbits have twice as many.  [default: 200]"
)
OUT_HELP = "Write the certificate that --search found to this file, .json."


def integrable(
    system: SystemArgument,
    *,
    degree: Annotated[int, typer.Option(help="Largest degree of the integrals.")] = 6,
    time_limit: Annotated[float, typer.Option(help="Seconds for the whole.")] = SEARCH_LIMIT,
    certificate: Annotated[str | None, typer.Option(metavar="FILE", help=WRITTEN_HELP)] = None,
    save: Annotated[str | None, typer.Option(metavar="FILE", help=SAVE_HELP)] = None,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Look for polynomial integrals, degree by degree, until they prove that the system is integrable.

    Where none are found, it says up to which degree it is proved that there are none, and looks for a proof that there
    are no meromorphic ones, by the differential Galois group; the singularities in complex time are evidence besides.
    """
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


def painleve(
    system: SystemArgument,
    *,
    weights: Annotated[str | None, typer.Option(metavar="NUMBERS", help=WEIGHTS_HELP)] = None,
    free: FreeOption = None,
    time_limit: Annotated[float, typer.Option(help=LIMIT_HELP)] = SEARCH_LIMIT,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Test whether singularities of solutions in complex time are poles: balances, exponents, logarithms, the verdict.

    A system that passes need not be integrable.  If something is left undecided, it is named, and the exit code is 1.
    """
    from liepoisson.integrability.painleve.singularity_analysis import painleve_test, record

    check_limits(time_limit=time_limit)
    chosen = read_equations(system, common.values, free or ())
    orders = None if weights is None else [part.strip() for part in weights.split(",")]
    with listening("testing", quiet=common.quiet) as listen:
        found = painleve_test(chosen, weights=orders, time_limit=time_limit, progress=listen)
    show(found, format_, record)
    if found.verdict == "undecided":
        raise typer.Exit(INCOMPLETE)


def prove(
    system: SystemArgument,
    *,
    certificate: Annotated[str | None, typer.Option(metavar="FILE", help=CERTIFICATE_HELP)] = None,
    search: Annotated[bool, typer.Option("--search", help=SEARCH_HELP)] = False,
    level: Annotated[list[str] | None, typer.Option(metavar="H=VALUE,...", help=LEVEL_HELP)] = None,
    starts: Annotated[int | None, typer.Option(metavar="N", help=STARTS_HELP)] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the search.  [default: 0]")] = None,
    out: Annotated[str | None, typer.Option(metavar="FILE", help=OUT_HELP)] = None,
    format_: FormatOption = Format.TEXT,
    common: Common,
) -> None:
    """Prove that a top is chaotic: check a certificate in two arithmetics and print the theorem that follows.

    With --search, a certificate is first looked for on a level of any top. One that fails a check is refused with the
    name of the first check that fails, and exit code 2.
    """
    from liepoisson.proofs.theorem import prove_chaos

    if not search and (level or (starts, seed, out) != (None, None, None)):
        raise ParameterError("--level, --starts, --seed and --out belong to --search; add it, or leave them out")
    if search and certificate is not None:
        raise ParameterError("wanted --certificate to check a file or --search to find one; got both")
    path = None if out is None else checked_file(out, "--out", (".json",), "proof.json")
    chosen = read_system(system, common.values)
    found: Any = certificate
    if search:
        options = {} if starts is None else {"n_starts": starts}
        with listening("searching", quiet=common.quiet) as listen:
            found = _searched(chosen, level or (), seed=seed or 0, progress=listen, **options)
        if path is not None:
            found.save(path)
    with listening("checking", quiet=common.quiet) as listen:
        proof = prove_chaos(chosen, found, progress=listen)
    show(proof, format_, proof_record)


def _searched(system: System, level: Sequence[str], **options: Any) -> Any:
    """A certificate that was found on a level."""
    from liepoisson.cli.starts import assignments, split_at_commas
    from liepoisson.proofs.search import find_certificate
    from liepoisson.proofs.theorem import has_shipped_certificate, shipped_certificate

    if level:
        values = assignments(split_at_commas(level), "--level", "--level H=1/2,C1=1", "constant of motion")
        missing = [name for name in ("H", *system.functions.casimirs) if name not in values]
        if missing:
            added = ",".join(f"{name}=1" for name in missing)
            raise ParameterError(
                f"--level: wanted the values of H and all Casimirs; got none of {', '.join(missing)}; add for example "
                f"--level {added}"
            )
    elif has_shipped_certificate(system):
        values = {name: str(value) for name, value in shipped_certificate(system).level.items()}
    else:
        example = ",".join(f"{name}=1" for name in ("H", *system.functions.casimirs))
        raise ParameterError(
            f"--search: wanted a level of {system.name}; name the values of H and all Casimirs, as in --level {example}"
        )
    energy = values.pop("H")
    return find_certificate(system, values, energy, **options)


def proof_record(proof: ChaosProof) -> dict[str, Any]:
    """The proof as data that JSON can write."""
    return {
        "system": proof.system.name,
        "equations": list(proof.field.equations),
        "level": {name: str(value) for name, value in proof.certificate.level.items()},
        "entropy_above": proof.entropy,
        "excludes_further_analytic_integrals": proof.excludes_integrals,
        "accepted_by": [asdict(m) for m in proof.margins],
        "notes": list(proof.notes),
    }
