"""Entry point of the command `liepoisson`."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from importlib import import_module
from keyword import iskeyword
from typing import TYPE_CHECKING, Any

from liepoisson.cli.exit import InterruptedCommandError, NobodyReadsError, end
from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import OFF

if TYPE_CHECKING:
    import typer


@contextmanager
def _heard() -> Generator[None]:
    """Ctrl-C and a reader that has gone under names of our own, as Typer ends the others by itself."""
    try:
        yield
    except KeyboardInterrupt as error:
        raise InterruptedCommandError from error
    except BrokenPipeError as error:
        raise NobodyReadsError from error


def main() -> None:
    """Run the command line and leave the process with its exit code (`liepoisson.cli`)."""
    end(_run)


def _run() -> None:
    os.environ["MPLBACKEND"] = "agg"  # figures go into files; an unknown backend would be an error
    os.environ[OFF] = "0"  # the commands have a bar of their own
    from typer.main import get_command  # imports take most of the first second: Ctrl-C may come here

    with warnings.catch_warnings():  # a sentence, without the line of the package where it is said
        warnings.showwarning = lambda message, *_, **__: print(f"liepoisson: {message}", file=sys.stderr)
        get_command(application(asked_command(sys.argv[1:]))).main(prog_name="liepoisson")


COMMANDS = {
    "reproduce": "reproduce",
    "inspect": "exact",
    "integrals": "exact",
    "integrable": "proofs",
    "families": "exact",
    "deformations": "exact",
    "darboux": "exact",
    "painleve": "proofs",
    "prove": "proofs",
    "catalog": "literature",
    "orbit": "orbit",
    "section": "section",
    "lyapunov": "chaos",
    "decide": "chaos",
    "equilibria": "orbit",
    "relax": "relax",
    "stationary": "noise",
    "passages": "noise",
    "periodic": "periodic",
    "continue": "periodic",
    "melnikov": "periodic",
    "diagram": "tori",
    "critical": "tori",
    "fit": "fit",
    "sweep": "sweep",
    "lab": "lab",
    "cite": "literature",
}
"""The module of each, in the order of the help."""


def asked_command(arguments: Sequence[str]) -> str | None:
    """The command that is called; None where all are needed: for the help that lists them, or a name that is none."""
    return arguments[0] if arguments and arguments[0] in COMMANDS else None


def application(only: str | None = None) -> typer.Typer:
    """The commands, or only one of them, as a Typer application: those that are not called are not imported."""
    import typer
    from typer.core import TyperCommand, TyperGroup

    from liepoisson.cli.options import flat

    class Command(TyperCommand):
        """A command that refuses an option given twice, of which only the last value would count."""

        def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
            given: list[Any] = self.make_parser(ctx).parse_args(args=list(args))[2]
            for option in given:
                single = not (option.multiple or option.is_flag) if option.param_type_name == "option" else False
                if single and given.count(option) > 1:
                    raise ParameterError(f"{option.opts[0]} must be given once; it comes twice. Remove one.")
            return super().parse_args(ctx, args)

        def invoke(self, ctx: Any) -> Any:
            from liepoisson.cli.output import arguments_are

            with arguments_are(dict(self._texts(ctx))):
                return super().invoke(ctx)

        def _texts(self, ctx: Any) -> Generator[tuple[str, list[str]]]:
            """What is given as text, under the names that a user knows."""
            for parameter in self.params:
                given = ctx.params.get(parameter.name)
                name = parameter.opts[0] if parameter.param_type_name == "option" else parameter.human_readable_name
                texts = [
                    one for one in (given if isinstance(given, (list, tuple)) else [given]) if isinstance(one, str)
                ]
                yield name, texts

    class Commands(TyperGroup):
        """The commands, whose interruption is not left to Typer."""

        def make_context(self, *args: Any, **options: Any) -> Any:
            with _heard():
                return super().make_context(*args, **options)

        def invoke(self, ctx: Any) -> Any:
            with _heard():
                return super().invoke(ctx)

    app = typer.Typer(
        name="liepoisson",
        cls=Commands,
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
    for name in COMMANDS if only is None else (only,):
        function = getattr(import_module(f"liepoisson.cli.{COMMANDS[name]}"), name + "_" * iskeyword(name))
        app.command(name, cls=Command)(flat(function))
    return app


if __name__ == "__main__":
    main()
