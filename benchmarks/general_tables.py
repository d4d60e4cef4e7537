"""Tables of the systems that users type, from what is kept of each processor: the ratios, and all the rest."""

from __future__ import annotations

import statistics

import problem
from comparison import NOT_COMPILED, Record, duration, markdown, shown_ratios
from general_problems import LEVELS, PREFIX, PROBLEMS, ROWS
from processors import columns, heading, marked

NOTHING = "Not measured yet.\n"


def ratios(processors: list[Record]) -> str:
    """For each processor and instruction set: a line for each system, a column for each kind of row."""
    return "\n".join(_ratios_of(*one) for one in _measured(processors)) or NOTHING


def details(processors: list[Record]) -> str:
    """For each processor and instruction set: a line for each row, with settings, errors, times and cold starts."""
    title = "### Systems as users type them\n"
    return "\n".join([title, *([_details_of(*one) for one in _measured(processors)] or [NOTHING])])


def _measured(processors: list[Record]) -> list[tuple[Record, str]]:
    """The processors and instruction sets for which there are rows."""
    return [(one, simd) for one, simd in columns(processors) if any(_line(one, name, simd) for name in ROWS)]


def _line(one: Record, name: str, simd: str, kind: str = "double") -> Record | None:
    """What is kept of a row, for an instruction set and a kind."""
    lines = one["rows"][name]["lines"] if name in one["rows"] else []
    return next((line for line in lines if (line["simd"], line["kind"]) == (simd, kind)), None)


def _ratios_of(one: Record, simd: str) -> str:
    what = [f"{whose} at {problem.shown(level)}" for whose in ("512 orbits", "one orbit") for level in LEVELS]
    lines = [["system", *what]]
    for system, known in PROBLEMS.items():
        lines.append([known.name, *(_cell(one, name, simd) for name in ROWS if ROWS[name][0] == system)])
    found = [line["ratios"]["rounds"] for name in ROWS if (line := _line(one, name, simd))]
    said = f"median {shown_ratios([statistics.median(found)])}, least {shown_ratios([min(found)])}"
    return f"{heading(one, simd)}; rows: {len(found)}, {said}.\n\n{markdown(lines)}"


def _cell(one: Record, name: str, simd: str) -> str:
    """The ratio with the method, and the ratio without compiled code."""
    line, plain = _line(one, name, simd), _line(one, name, simd, NOT_COMPILED)
    if line is None:
        return ""
    shown = f"{marked(line['ratios']['rounds'])} {line['name'].split()[1].strip(',')}"
    return shown + (f" ({shown_ratios([plain['ratios']['rounds']])})" if plain else "")


def _details_of(one: Record, simd: str) -> str:
    what = ("setting", "errors", "largest errors", "best time", "cold start")
    table = [["row", *(f"{side}: {word}" for side in ("liepoisson", "heyoka") for word in what), "ratios"]]
    rows = {name: line for name in ROWS if (line := _line(one, name, simd))}
    for name, line in rows.items():
        table.append(
            [name.removeprefix(PREFIX), *_side(line), *_side(line["heyoka"]), shown_ratios([*line["ratios"].values()])]
        )
    dates, commits = (sorted({one["rows"][name][key] for name in rows}) for key in ("date", "commit"))
    said = f"{heading(one, simd)}; measured {dates[0][:10]} to {dates[-1][:10]}, commit {', '.join(commits)}."
    return f"{said}\n\n{markdown(table)}"


def _side(line: Record) -> list[str]:
    """Setting, median and largest errors of state and tangent vector, time and cold start of one side."""
    name = line["name"].removeprefix("liepoisson ").removeprefix("heyoka, ").removesuffix(", avx2")
    errors = [line["errors"].values(), [line["largest"][name]["error"] for name in line["errors"]]]
    shown = [" / ".join(f"{error:.1e}" for error in values) for values in errors]
    return [f"{name}, {line['setting']}", *shown, duration(line["seconds"]), duration(line["cold"])]
