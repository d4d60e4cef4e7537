"""A page for each command of the command line, from what the command itself says of its arguments and options."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from typer.main import get_command

from liepoisson.cli.main import COMMANDS, application

if TYPE_CHECKING:
    from staging import Stage


def write(stage: Stage) -> None:
    """Write commands/index.md and commands/NAME.md."""
    whole: Any = get_command(application())
    lines = ["# Every command", ""]
    lines += [
        "The arguments and options of each command, as `--help` prints them. What it prints and writes is told in"
    ]
    lines += ["[The command line](../command-line.md).", "", "| command | what it does |", "|---|---|"]
    for name in COMMANDS:
        first = cell(whole.commands[name].help.split("\n\n")[0])
        lines.append(f"| [`liepoisson {name}`]({name}.md) | {first} |")
        stage.write(f"commands/{name}.md", page(name, whole.commands[name]))
    tree = "\n".join(f"liepoisson {name} <{name}>" for name in COMMANDS)
    lines += ["", "```{toctree}", ":hidden:", "", tree, "```", ""]
    stage.write("commands/index.md", "\n".join(lines))


def page(name: str, command: Any) -> str:
    """The page of one command."""
    context = command.make_context(f"liepoisson {name}", [], resilient_parsing=True)
    usage = " ".join([f"liepoisson {name}", *command.collect_usage_pieces(context)])
    lines = [f"# liepoisson {name}", "", "```text", usage, "```", "", prose(command.help), ""]
    parameters = [one for one in command.get_params(context) if not getattr(one, "hidden", False)]
    for title, wanted in (("Arguments", "argument"), ("Options", "option")):
        records = [one.get_help_record(context) for one in parameters if one.param_type_name == wanted]
        rows = [f"`{words}`\n: {prose(text, indent=2) or 'Shows the help.'}\n" for words, text in filter(None, records)]
        if rows:
            lines += [f"## {title}", "", *rows]
    return "\n".join(lines)


def prose(text: str | None, *, indent: int = 0) -> str:
    """Help as Markdown: signs that would be markup are escaped outside code."""
    text = re.sub(r"(?<![\w`-])(--[a-z][a-z-]*)", r"`\1`", re.sub(r"`(--[^`]*)`", r"\1", text or ""))
    parts = text.strip().split("`")
    for outside in range(0, len(parts), 2):
        for sign in "\\*_[]<>|$":
            parts[outside] = parts[outside].replace(sign, "\\" + sign)
    return "`".join(parts).replace("\n", "\n" + " " * indent)


def cell(text: str) -> str:
    """Help in a cell of a table."""
    return prose(" ".join(text.split()))
