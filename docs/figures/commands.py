"""The figures of docs/command-line.md, as the commands above them draw them: `python docs/figures/commands.py`.

What a picture shows (titles, labels, limits, numbers of points) stands in its file, too, so that a test finds a picture
that the command would draw otherwise today.
"""

from __future__ import annotations

import contextlib
import io
import sys
from pathlib import Path
from unittest.mock import patch

from liepoisson.cli.main import main as liepoisson

FOLDER = Path(__file__).parents[1] / "images"
COMMANDS = {
    "command-orbit.png": "liepoisson orbit twisted-kovalevskaya --plot",
    "command-section.png": "liepoisson section kovalevskaya --plot",
}
DPI = 150
KEY = "Description"
"""The entry of a picture's file that says what it shows."""


def figure_of(command):
    """The figure that a command draws, instead of its files."""
    words = command.split()
    found = []
    with (
        patch("liepoisson.cli.runs.write_figure", lambda figure, _: found.append(figure) or []),
        patch.object(sys, "argv", words),
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.suppress(SystemExit),
    ):
        liepoisson()
    return found[0]


def content(figure):
    """What a figure shows, in words and numbers."""
    parts = [figure.get_suptitle()]
    for ax in figure.axes:
        legend = ax.get_legend()
        parts += [ax.get_title(loc="left"), ax.get_xlabel(), ax.get_ylabel(), *(text.get_text() for text in ax.texts)]
        parts += [] if legend is None else [text.get_text() for text in legend.get_texts()]
        parts.append(" ".join(f"{end:.3g}" for end in (*ax.get_xlim(), *ax.get_ylim())))
        parts.append(f"{len(ax.lines)} lines, {sum(len(line.get_xdata()) for line in ax.lines)} points")
    return " | ".join(part.replace("\n", " / ") for part in parts if part)


def main(folder: Path) -> None:
    """Draws both figures into a folder."""
    for name, command in COMMANDS.items():
        figure = figure_of(command)
        metadata = {"Software": None, KEY: content(figure)}
        figure.savefig(folder / name, format="png", dpi=DPI, metadata=metadata)
        print(folder / name, (folder / name).stat().st_size // 1000, "kB")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
