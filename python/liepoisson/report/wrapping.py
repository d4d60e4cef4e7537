"""Lines of a report broken to a width: words at blanks, formulas before a + or - and after a comma."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING

from liepoisson.report.lines import Line

if TYPE_CHECKING:
    from liepoisson.formula.styles import Style

_KEPT = "\x00"
"""Stands for a blank where no line is broken."""

_INSIDE = "".join(map(chr, range(1, 9)))
"""Stand for blanks inside parentheses, where a line is broken only if it must: first of all after an outer comma."""

_INDENT = "    "


def wrapped(line: Line, style: Style, width: int) -> list[str]:
    """A line as rows of at most `width` characters; rows after the first are indented where there are formulas.

    A single term that is longer than a row is left whole.
    """
    if all(isinstance(piece, str) for piece in line):
        return wrap("".join(style.words(str(piece)) for piece in line), width)
    text = "".join(
        style.words(piece) if isinstance(piece, str) else breakable(style.formula(piece.write(style))) for piece in line
    )
    rows = [""]
    for chunk in text.split(" "):
        _fill(rows, chunk, width)
    blanks = str.maketrans(dict.fromkeys(_KEPT + _INSIDE, " "))
    return [row.translate(blanks) for row in rows]


def breakable(formula: str) -> str:
    """The formula with a blank left only where a line may be broken: before + and -, and after commas."""
    depth, marked = 0, ""
    for position, character in enumerate(formula):
        depth += (character in "([{") - (character in ")]}")
        if character != " ":
            marked += character
        elif formula[position + 1 : position + 3] in ("+ ", "- ") or formula[position - 1] == ",":
            level = 2 * depth - (formula[position - 1] == ",") - 1
            marked += _INSIDE[min(level, len(_INSIDE) - 1)] if depth else " "
        else:
            marked += _KEPT
    return marked


def _fill(rows: list[str], chunk: str, width: int) -> None:
    """Append a chunk, broken at the outermost of its blanks if there is no better way."""
    # What is left of a row is used if the next one does not hold the chunk either, or if it is most of the row.
    broken = len(chunk) > width - len(_INDENT) or len(rows[-1]) < width // 3
    blank = next((mark for mark in _INSIDE if mark in chunk), None)
    if blank is None or not broken or _fits(rows, chunk, width):
        _append(rows, chunk, width)
        return
    for part in chunk.split(blank):
        _fill(rows, part, width)


def _fits(rows: list[str], chunk: str, width: int) -> bool:
    return len(rows[-1]) + bool(rows[-1]) + len(chunk) <= width


def _append(rows: list[str], chunk: str, width: int) -> None:
    if not rows[-1]:
        rows[-1] = chunk
    elif _fits(rows, chunk, width):
        rows[-1] += f" {chunk}"
    else:
        rows.append(_INDENT + chunk)
