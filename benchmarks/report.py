"""What came out?  Tables in Markdown from what was measured; `python benchmarks/report.py` puts them into the docs.

Each row of the benchmark is one file of plain data in results/tables/; what it says of its processor is kept in
processors/.  A table stands between `<!-- table NAME -->` and `<!-- end of table -->`: summaries in docs/benchmarks.md,
every contender in benchmarks/tables.md.
"""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

import commands
import dispatch
import general_problems
import general_tables
import kernels
import measure
import periodic
import processors
import spectra
from comparison import (
    KINDS,
    Record,
    duration,
    environment_text,
    fastest,
    markdown,
    of_kind,
    of_side,
    processor_name,
    rate,
    ratios,
    shown_errors,
    shown_ratios,
    with_work,
    work_of,
)
from measure import Measured, Row, choice

TABLES = measure.HERE / "results" / "tables"
QUICK = measure.HERE / "results" / "quick"
DOCUMENT = measure.ROOT / "docs" / "benchmarks.md"
DETAILS = measure.HERE / "tables.md"
PEERS = "peers-"
MARKED = re.compile(r"(<!-- table ([\w.-]+) -->\n).*?(<!-- end of table -->)", re.DOTALL)


def record(row: Row, measured: list[Measured], rounds: int) -> Record:
    """All that was measured for a row, as plain data."""
    return {
        "kind": "row",
        "title": row.title,
        "work": row.work,
        "wall": row.wall,
        "absent": row.absent,
        "rounds": rounds,
        "measured": [asdict(one) for one in measured],
    }


def save(folder: Path, name: str, data: Record, facts: Record) -> None:
    """Write one table's data with the facts that go with them."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps(data | {"facts": facts}, indent=1))


def load(folder: Path) -> dict[str, Record]:
    """All tables' data, by name; the date of a table that does not say its own is that of its file."""
    tables = {path.stem: json.loads(path.read_text()) for path in sorted(folder.glob("*.json"))}
    for name, data in tables.items():
        written = datetime.fromtimestamp((folder / f"{name}.json").stat().st_mtime, UTC)
        data["facts"].setdefault("date", written.isoformat(timespec="minutes"))
    return tables


def _versus(peer: Record, one: Record) -> str:
    return shown_ratios(ratios(peer, one))


def row_lines(data: Record) -> list[list[str]]:
    """A line for each contender, with columns of ratios (best, median, rounds)."""
    measured = with_work(data)
    versus = _ratios_to_others(measured) if _has_others(measured) else _ratios_to_heyoka(measured)
    best = [fastest(of_kind(measured, kind)) for kind in KINDS]
    header = ["contender", "setting", "order", "state error", "tangent error", "exponent error", "largest, of the mean"]
    table = [[*header, "best", "median", "rate at best", *versus[0]]]
    for one, against in zip(measured, versus[1:], strict=True):
        contender, seconds = one["contender"], one["seconds"]
        setting, name = contender["setting"], contender["name"]
        line = [
            (f"**{name}**" if one in best else name) + ("" if setting["meets"] else " (LEVEL NOT MET)"),
            choice(setting["request"]),
            str(setting["order"] or ""),
            *(shown_errors(setting, error) for error in ("state", "tangent", "exponent")),
            shown_errors(setting, "exponent_largest", "exponent_mean"),
            duration(min(seconds)),
            duration(float(np.median(seconds))),
            "" if data["wall"] else rate(work_of(one) / min(seconds)),
            *against,
        ]
        table.append(line)
    table += [[name, why, *[""] * (len(table[0]) - 2)] for name, why in data["absent"].items()]
    return _without_empty_columns(table)


def _has_others(measured: list[Record]) -> bool:
    return any(one["contender"]["side"] in measure.PEERS for one in measured)


def _ratios_to_heyoka(measured: list[Record]) -> list[list[str]]:
    """A column for each setting of heyoka: how much faster than it each of ours is."""
    peers = of_side(measured, "heyoka")
    lines = [["" if one["contender"]["side"] == "heyoka" else _versus(peer, one) for peer in peers] for one in measured]
    return [[f"against {one['contender']['name']}" for one in peers], *lines]


def _ratios_to_others(measured: list[Record]) -> list[list[str]]:
    """One column: how much faster than each tool our first contender is."""
    ours = of_side(measured, "liepoisson")[0]
    return [["liepoisson against it"], *(["" if one is ours else _versus(one, ours)] for one in measured)]


def _without_empty_columns(table: list[list[str]]) -> list[list[str]]:
    kept = [column for column in zip(*table, strict=True) if any(column[1:])]
    return [list(line) for line in zip(*kept, strict=True)]


def notes(data: Record) -> str:
    """What a row's answers say besides times."""
    answers = [(one["contender"]["name"], one["answers"][-1]) for one in data["measured"]]
    said: list[str] = []
    drifts = [f"{name} {answer['drift']:.1e}" for name, answer in answers if "drift" in answer]
    if drifts:
        said.append(f"Largest change of H, C1, C2, C3 at the end, median over starts: {'; '.join(drifts)}.")
    crossings = [f"{name} {answer['crossings']}" for name, answer in answers if "crossings" in answer]
    if crossings:
        said.append(f"Crossings found: {'; '.join(crossings)}.")
    means = [f"{name} {answer['mean_exponent']:.5f}" for name, answer in answers if "mean_exponent" in answer]
    if means and not data["wall"]:
        said.append(f"Mean exponent at the end of the run: {'; '.join(means)}.")
    said.append(f"Processes of each: {data['rounds']}.")
    return " ".join(said)


def render(data: Record) -> str:
    """One table with its title and its notes."""
    lines = {
        "row": row_lines,
        "kernels": kernels.lines,
        "dispatch": dispatch.lines,
        "commands": commands.lines,
        "spectra": spectra.lines,
        "periodic": periodic.lines,
    }[data["kind"]](data)
    tail = notes(data) if data["kind"] == "row" else f"Runs of each: {data['rounds']}."
    return f"### {data['title']}\n\n{markdown(lines)}\n{tail}\n"


def summary(tables: dict[str, Record], facts: Record) -> str:
    """The summary of these tables, which one machine measured."""
    rows = {name: processors.row_of(data, facts) for name, data in tables.items() if processors.has_row(name, data)}
    top = {name: row for name, row in rows.items() if name in processors.ROWS and row["lines"]}
    return processors.summary({"processor": facts["processor"], "rows": top}) if top else ""


def peers(tables: dict[str, Record], first: Record | None) -> dict[str, str]:
    """How many times faster liepoisson is than each tool: a line for each, a column for each level."""
    found = {name.removeprefix(PEERS): data for name, data in tables.items() if name.startswith(PEERS)}
    if not found:
        return {}
    levels = sorted(found, key=float)
    cells: dict[str, dict[str, str]] = {}
    for level, data in found.items():
        measured = with_work(data)
        ours = of_side(measured, "liepoisson")[0]
        for one in (one for one in measured if one is not ours):
            cells.setdefault(one["contender"]["name"], {})[level] = shown_ratios(ratios(one, ours)[-1:])
        for name in data["absent"]:
            cells.setdefault(name, {})[level] = "does not reach it"
    lines = [["tool", *(f"at {level}" for level in levels)]]
    lines += [[name, *(row.get(level, "") for level in levels)] for name, row in cells.items()]
    title = "How many times faster than other tools: 512 exponents, t = 0..200, one thread"
    return {"peers": f"### {title}\n\n{markdown(lines)}{_from_where(found[levels[0]]['facts'], first)}"}


def blocks(tables: dict[str, Record], measured: list[Record]) -> dict[str, str]:
    """All that the documents may hold, by the names of its markers: one for each table, and what all processors say."""
    found: dict[str, str] = {}
    first = None
    if measured:
        one = processors.at_head(measured)
        first = one["facts"]
        found = {
            "head": processors.head(measured),
            "summary": processors.summary(one),
            "environment": processors.environment(measured),
            "processors": processors.render(measured),
        }
    found |= {"general": general_tables.ratios(measured), "general-details": general_tables.details(measured)}
    found |= peers(tables, first)
    own = {name: data for name, data in tables.items() if not name.startswith(general_problems.PREFIX)}
    return found | {name: render(data) + _from_where(data["facts"], first) for name, data in own.items()}


def _from_where(facts: Record, first: Record | None) -> str:
    """The processor and the day; all facts if machine or versions are not those at the head of the page."""
    what = ("processor", "python", "heyoka", "liepoisson")
    same = first is not None and all(facts[name] == first[name] for name in what)
    line = f"\nMeasured on {processor_name(facts['processor'])}, {facts['date'][:10]}.\n"
    return line if same else f"{line}\n{environment_text(facts)}\n"


def write_document(document: Path, found: dict[str, str]) -> list[str]:
    """Replace what stands between the markers; the names of the tables that were replaced."""
    text = document.read_text()
    replaced = [name for _, name, _ in MARKED.findall(text) if name in found]
    document.write_text(
        MARKED.sub(lambda mark: f"{mark[1]}\n{found[mark[2]]}\n{mark[3]}" if mark[2] in found else mark[0], text)
    )
    return replaced


def main() -> None:
    """Put all tables of results/tables/ into the files of their processors and into the docs."""
    tables = load(TABLES)
    for file in processors.update(processors.FOLDER, tables):
        print(f"{processors.FOLDER / file}: written")
    found = blocks(tables, processors.load())
    replaced: list[str] = []
    for document in (DOCUMENT, DETAILS):
        written = write_document(document, found)
        print(f"{document}: wrote {', '.join(written) or 'nothing'}")
        replaced += written
    missing = sorted(set(found) - set(replaced))
    if missing:
        print(f"no marker for: {', '.join(missing)}")


if __name__ == "__main__":
    main()
