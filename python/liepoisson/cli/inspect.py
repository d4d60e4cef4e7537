"""The command `liepoisson inspect`: what can be proved about a system."""

from __future__ import annotations

import json
import sys
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from liepoisson.cli.systems import SET_HELP, SYSTEM_HELP, read_system

if TYPE_CHECKING:
    from liepoisson.formula.styles import Style


REFUTED = 1


class Format(StrEnum):
    """How the report is printed."""

    TEXT = "text"
    LATEX = "latex"
    JSON = "json"


def inspect(
    system: Annotated[str, typer.Argument(help=SYSTEM_HELP, metavar="SYSTEM")],
    *,
    format_: Annotated[Format, typer.Option("--format", help="For people, for LaTeX, or for programs.")] = Format.TEXT,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help=SET_HELP)] = None,
) -> None:
    """Print what can be proved about a system.

    Algebra, extension, Jacobi identity, Casimirs, rank, leaves, symmetries, Hamiltonian, equations of motion and known
    integrals; every proof is computed anew.  JSON has one object per topic (see `liepoisson.systems.Report`).

    The exit code is 1 where something that is claimed turns out to be false: the Jacobi identity, or an integral that
    the file gives.
    """
    from liepoisson.report.describe import inspect as inspect_system

    report = inspect_system(read_system(system, settings or ()))
    match format_:
        case Format.TEXT:
            print(report.text(terminal_style()))
        case Format.LATEX:
            print(report.latex())
        case Format.JSON:
            print(json.dumps(report.record(), indent=2))
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
