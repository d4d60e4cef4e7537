"""The command `liepoisson prove`: the theorem that a top is chaotic, from a certificate that two arithmetics check."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liepoisson.cli.output import FORMAT_HELP, Format, checked_file
from liepoisson.cli.progress import QuietOption, progress_bar
from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP, read_system

if TYPE_CHECKING:
    from liepoisson.proofs.theorem import ChaosProof

CERTIFICATE_HELP = "Certificate to check, .json.  [default: the one that comes with the package]"
SEARCH_HELP = "Search for a new certificate on the level --level, and check it."
LEVEL_HELP = "Values of H and the Casimirs for --search: --level H=1/2 --level C1=1.  [default: the shipped level]"
OUT_HELP = "Write the certificate that was found to this file, .json."


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

    A certificate that fails a check is refused, with the name of the first one that fails, and exit code 2.
    """
