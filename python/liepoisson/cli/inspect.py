"""The command `liepoisson inspect`: what can be proved about a system."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import typer

from liepoisson.cli.options import ReportFormat, ReportFormatOption, SettingsOption, SystemArgument, show
from liepoisson.cli.systems import read_system

if TYPE_CHECKING:
    from liepoisson.formula.styles import Style


REFUTED = 1


def inspect(
    system: SystemArgument, *, format_: ReportFormatOption = ReportFormat.TEXT, settings: SettingsOption = None
) -> None:
    """Print what can be proved about a system.

    Algebra, extension, Jacobi identity, Casimirs, rank, leaves, symmetries, Hamiltonian, equations of motion and known
    integrals; every proof is computed anew.  JSON has one object per topic (see `liepoisson.systems.Report`).

    The exit code is 1 where something that is claimed turns out to be false: the Jacobi identity, or an integral that
    the file gives.
    """
    from liepoisson.report.describe import inspect as inspect_system

    report = inspect_system(read_system(system, settings or ()))
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
