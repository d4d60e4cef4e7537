"""Entry point of the command `liepoisson`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import typer

REFUSED = 2


def main() -> None:
    """Run the command line and leave the process with its exit code.

    0: done.  1: a claim about the system that was inspected is false.  2: refused, with the reason on standard error
    and no traceback.  130: interrupted by Ctrl-C.
    """
    from typer.main import get_command

    from liepoisson.errors import LiePoissonError

    try:
        get_command(application()).main(prog_name="liepoisson")
    except LiePoissonError as error:
        print(f"liepoisson: {error}", file=sys.stderr)
        sys.exit(REFUSED)


def application() -> typer.Typer:
    """The commands, as a Typer application."""
    import typer

    from liepoisson.cli.catalog import catalog
    from liepoisson.cli.inspect import inspect
    from liepoisson.cli.lyapunov import lyapunov
    from liepoisson.cli.orbit import orbit
    from liepoisson.cli.reproduce import reproduce
    from liepoisson.cli.section import section
    from liepoisson.cli.sweep import sweep

    app = typer.Typer(
        name="liepoisson",
        help="The laboratory for Lie-Poisson dynamics.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
    )

    def print_version(wanted: bool) -> None:
        if wanted:
            from liepoisson import __version__

            print(f"liepoisson {__version__}")
            raise typer.Exit

    # Typer looks up annotations among the names of the module, so an option made here is a default, not `Annotated`.
    version_option = typer.Option(
        False, "--version", help="Print the version and exit.", callback=print_version, is_eager=True
    )

    def options(version: bool = version_option) -> None:
        """The laboratory for Lie-Poisson dynamics."""

    app.callback()(options)
    for command in (reproduce, inspect, catalog, lyapunov, orbit, section, sweep):
        app.command()(command)
    return app
