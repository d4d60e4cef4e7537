"""The command `liepoisson prove`: the theorem that a top is chaotic, from a certificate that two arithmetics check."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liepoisson.cli.options import Common, Format, FormatOption, SystemArgument, show
from liepoisson.cli.output import checked_file
from liepoisson.cli.progress import listening
from liepoisson.cli.systems import read_system
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from liepoisson.model.system import System
    from liepoisson.proofs.theorem import ChaosProof

CERTIFICATE_HELP = "Certificate to check, .json.  [default: the one that comes with the package]"
SEARCH_HELP = "Search for a new certificate and check it, on --level or on the level of the one in the package."
LEVEL_HELP = "Values of H and all Casimirs for --search: --level H=4,C1=10,C2=-2,C3=1."
STARTS_HELP = (
    "Starts of the searches for periodic orbits with --search; homoclinic orbits have twice as many.  [default: 200]"
)
OUT_HELP = "Write the certificate that --search found to this file, .json."


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
    show(proof, format_, record)


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


def record(proof: ChaosProof) -> dict[str, Any]:
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
