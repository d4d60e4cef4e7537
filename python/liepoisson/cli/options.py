"""Options that several commands have, each written once, and how groups of them become the options of a command.

A command takes a group, a dataclass whose fields are options, as one argument:

    def lyapunov(system: SystemArgument, where: Where, *, seed: SeedOption = 0, common: Common) -> None: ...

`flat` makes of it the function with all options that Typer calls.  The options of runs are in `runs.py`.
"""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Sequence
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from enum import StrEnum
from functools import wraps
from typing import Annotated, Any, TypeAlias, get_type_hints

import typer


class Format(StrEnum):
    """How a result is printed."""

    TEXT = "text"
    JSON = "json"


class ReportFormat(StrEnum):
    """How a report is printed."""

    TEXT = "text"
    LATEX = "latex"
    JSON = "json"


_HELP = {
    "system": "A name of the catalog (see `liepoisson catalog`) or the path of a system file (.toml).",
    "set": "A value for a parameter: --set epsilon=1/3 --set a=1,0,0.  Repeat it for more.",
    "free": "A parameter that has a value and becomes a symbol: --free mu.  Repeat it for more.",
    "format": "For people or for programs.",
    "report": "For people, for LaTeX, or for programs.",
    "quiet": "No progress on standard error.",
    "seed": "Seed of what is drawn at random.",
    "on": "A function that vanishes on the level set that is searched: --on C1 --on C2-1.  "
    "[default: all of phase space]",
    "start": "Where the orbit begins: all numbers, or by name, --start l=1,0,0,beta3=1; the others are 0.",
    "guess": "Like --start, but it is moved onto --leaf and --energy.  [default: trajectory 0 of the seed]",
    "leaf": "Values of Casimirs, as in --leaf C1=1.2,C2=0 or --leaf l.alpha=1/5; the others keep theirs.",
    "energy": "Value of the Hamiltonian, as in --energy 1.5 or --energy 3/2.",
    "out": "Also write the result to this file: .nc (which can be rerun) or .csv (a table).",
    "found": "Also write what is found to this file: .nc, which `liepoisson.load` reads, or .csv, its table.",
    "table": "Also write the table to this file, .csv.",
    "plot": "Draw a figure, a .png file in the working folder.",
    "figure": "Draw the figure into this file: .png, .svg or .pdf; without an ending, all three.",
}
"""What `--help` says of each."""

_MaybeText: TypeAlias = str | None
_Texts: TypeAlias = list[str] | None
SystemArgument: TypeAlias = Annotated[str, typer.Argument(help=_HELP["system"], metavar="SYSTEM")]
SettingsOption: TypeAlias = Annotated[_Texts, typer.Option("--set", metavar="NAME=VALUE", help=_HELP["set"])]
FreeOption: TypeAlias = Annotated[_Texts, typer.Option(metavar="NAME", help=_HELP["free"])]
FormatOption: TypeAlias = Annotated[Format, typer.Option("--format", help=_HELP["format"])]
ReportFormatOption: TypeAlias = Annotated[ReportFormat, typer.Option("--format", help=_HELP["report"])]
QuietOption: TypeAlias = Annotated[bool, typer.Option("--quiet", help=_HELP["quiet"])]
SeedOption: TypeAlias = Annotated[int, typer.Option(help=_HELP["seed"])]
SeedOfStartOption: TypeAlias = Annotated[int | None, typer.Option(help="Seed of the random start.  [default: 0]")]
SeedOfStartAndNoiseOption: TypeAlias = Annotated[
    int | None, typer.Option(help="Seed of the random start, and of the path of noise.  [default: 0]")
]
LevelOption: TypeAlias = Annotated[_Texts, typer.Option(metavar="EQUATION", help=_HELP["on"])]
LeafOption: TypeAlias = Annotated[_Texts, typer.Option(metavar="C1=VALUE,...", help=_HELP["leaf"])]
OutOption: TypeAlias = Annotated[_MaybeText, typer.Option(metavar="FILE", help=_HELP["out"])]
FoundOption: TypeAlias = Annotated[_MaybeText, typer.Option(metavar="FILE", help=_HELP["found"])]
TableOption: TypeAlias = Annotated[_MaybeText, typer.Option(metavar="FILE.csv", help=_HELP["table"])]
PlotOption: TypeAlias = Annotated[bool, typer.Option("--plot", help=_HELP["plot"])]
FigureOption: TypeAlias = Annotated[_MaybeText, typer.Option(metavar="FILE", help=_HELP["figure"])]


@dataclass(frozen=True)
class Where:
    """Where orbits begin: a state that is given, or a guess moved onto a leaf and an energy."""

    start: Annotated[_Texts, typer.Option(metavar="STATE", help=_HELP["start"])] = None
    guess: Annotated[_Texts, typer.Option(metavar="STATE", help=_HELP["guess"])] = None
    leaf: LeafOption = None
    energy: Annotated[_MaybeText, typer.Option(metavar="NUMBER", help=_HELP["energy"])] = None

    @property
    def is_given(self) -> bool:
        """Whether anything is said."""
        return bool(self.start or self.guess or self.leaf) or self.energy is not None


@dataclass(frozen=True)
class Files:
    """What is written beside what is printed: the result, and figures."""

    out: OutOption = None
    plot: PlotOption = False
    figure: FigureOption = None


@dataclass(frozen=True)
class Common:
    """What all commands about a system have."""

    quiet: QuietOption = False
    settings: SettingsOption = None

    @property
    def values(self) -> Sequence[str]:
        """The values for parameters, as they were typed."""
        return self.settings or ()


def show(
    found: Any,
    how: Format | ReportFormat,
    record: Callable[[Any], Any],
    latex: Callable[[Any], Sequence[str]] = lambda _: (),
    *,
    text: Callable[[Any], str] = str,
) -> None:
    """Print what was found as text, by default its own, as lines of LaTeX, or as JSON of the record of it."""
    match how.value:
        case "json":
            print(json.dumps(record(found), indent=2))
        case "latex":
            print("\n".join(latex(found)))
        case _:
            print(text(found))


def flat(command: Callable[..., None]) -> Callable[..., None]:
    """A command with the options of its groups in the place of these."""
    hints = get_type_hints(command, include_extras=True)
    groups: dict[str, Any] = {name: kind for name, kind in hints.items() if is_dataclass(kind)}
    options: list[inspect.Parameter] = []
    for name, parameter in inspect.signature(command).parameters.items():
        if name in groups:
            of_group = get_type_hints(groups[name], include_extras=True)
            options += [_option(field, of_group[field.name]) for field in fields(groups[name])]
        else:
            options.append(parameter.replace(annotation=hints[name]))

    @wraps(command)
    def call(**given: Any) -> None:
        made = {name: kind(**{f.name: given.pop(f.name) for f in fields(kind)}) for name, kind in groups.items()}
        command(**given, **made)

    arguments = [p for p in options if p.kind is not p.KEYWORD_ONLY]
    named = [p for p in options if p.kind is p.KEYWORD_ONLY]
    flattened: Any = call
    flattened.__signature__ = inspect.Signature([*arguments, *named])
    flattened.__annotations__ = {p.name: p.annotation for p in options}
    del flattened.__wrapped__  # whose options Typer would look up
    return flattened


def _option(field: Field[Any], annotation: Any) -> inspect.Parameter:
    default = inspect.Parameter.empty if field.default is MISSING else field.default
    return inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
