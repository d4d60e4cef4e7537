"""The command `liepoisson prove`: the theorem that a top is chaotic, from a certificate that two arithmetics check."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liepoisson.cli.output import FORMAT_HELP, Format, checked_file
from liepoisson.cli.progress import QuietOption, progress_bar
from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP, read_system
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from liepoisson.exact.system import System
    from liepoisson.proofs.theorem import ChaosProof

CERTIFICATE_HELP = "Certificate to check, .json.  [default: the one that comes with the package]"
SEARCH_HELP = "Search for a new certificate and check it, on --level or on the level of the one in the package."
LEVEL_HELP = "Values of H and the Casimirs for --search: --level H=1/2 --level C1=1 ..."
OUT_HELP = "Write the certificate that --search found to this file, .json."


def prove(
    system: Annotated[str, typer.Argument(help=SYSTEM_HELP, metavar="SYSTEM")],
    *,
    certificate: Annotated[str | None, typer.Option(metavar="FILE", help=CERTIFICATE_HELP)] = None,
    search: Annotated[bool, typer.Option("--search", help=SEARCH_HELP)] = False,
    level: Annotated[list[str] | None, typer.Option(metavar="NAME=VALUE", help=LEVEL_HELP)] = None,
    seed: Annotated[int, typer.Option(help="Seed of the search.")] = 0,
    out: Annotated[str | None, typer.Option(metavar="FILE", help=OUT_HELP)] = None,
    format_: Annotated[Format, typer.Option("--format", help=FORMAT_HELP)] = Format.TEXT,
    quiet: QuietOption = False,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)] = None,
) -> None:
    """Prove that a top is chaotic: check a certificate in two arithmetics and print the theorem that follows.

    A certificate that fails a check is refused with the name of the first one that fails, and exit code 2.
    """
    from liepoisson.proofs.theorem import prove_chaos

    if not search and (level or out is not None):
        raise ParameterError("--level and --out belong to --search; add it, or leave them out")
    if search and certificate is not None:
        raise ParameterError("wanted --certificate to check a file or --search to find one; got both")
    path = None if out is None else checked_file(out, "--out", (".json",), "proof.json")
    chosen = read_system(system, settings or ())
    found: Any = certificate
    with progress_bar(quiet=quiet) as bar:
        if search:
            candidate = _searched(chosen, level or (), seed, lambda done: bar and bar("searching", done, 1.0))
            if path is not None:
                candidate.save(path)
            found = candidate
        listen = None if bar is None else (lambda done: bar("checking", done, 1.0))
        proof = prove_chaos(chosen, found, progress=listen)
    print(json.dumps(record(proof), indent=2) if format_ is Format.JSON else proof)


def _searched(system: System, level: Sequence[str], seed: int, progress: Any) -> Any:
    """A certificate that was found on a level."""
    from liepoisson.proofs.search import find_certificate
    from liepoisson.proofs.theorem import shipped_certificate

    if level:
        values = dict(_assignment(text) for text in level)
        if "H" not in values:
            raise ParameterError("--level: wanted the value of H, too; add --level H=1/2")
    else:
        values = {name: str(value) for name, value in shipped_certificate(system).level.items()}
    energy = values.pop("H")
    return find_certificate(system, values, energy, seed=seed, progress=progress)


def _assignment(text: str) -> tuple[str, str]:
    name, sign, value = text.partition("=")
    if not sign or not name.strip() or not value.strip():
        raise ParameterError(f"--level: wanted NAME=VALUE, such as H=1/2; got {text}")
    return name.strip(), value.strip()


def record(proof: ChaosProof) -> dict[str, Any]:
    """The proof as data that JSON can write."""
    return {
        "system": proof.system.name,
        "equations": list(proof.field.equations),
        "level": {name: str(value) for name, value in proof.certificate.level.items()},
        "entropy_above": proof.entropy,
        "accepted_by": [asdict(m) for m in proof.margins],
        "notes": list(proof.notes),
    }
