"""What came out?  Tables in Markdown from what was measured; `python benchmarks/report.py` puts them into the docs.

Each row of the benchmark is one file of plain data in results/tables/.  In docs/benchmarks.md a table stands between
`<!-- table NAME -->` and `<!-- end of table -->`; no number there is written by hand.
"""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import dispatch
import kernels
import measure
from measure import Measured, Row, choice

TABLES = measure.HERE / "results" / "tables"
DOCUMENT = measure.ROOT / "docs" / "benchmarks.md"
MARKED = re.compile(r"(<!-- table ([\w.-]+) -->\n).*?(<!-- end of table -->)", re.DOTALL)
SUMMARY = (
    "1e-13",
    "1e-8",
    "1e-4",
    "single-precision",
    "single-tolerance",
    "single-level",
    "dense",
    "grid",
    "sections-1e-15",
    "sections-1e-9",
    "cold-20",
    "cold-200",
)
Record = dict[str, Any]


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
    """All tables' data, by name."""
    return {path.stem: json.loads(path.read_text()) for path in sorted(folder.glob("*.json"))}


def environment_text(facts: Record) -> str:
    """The facts that go with the numbers."""
    processor, ours, peer = facts["processor"], facts["liepoisson"], facts["heyoka"]
    busy = " (SOMETHING ELSE WAS COMPUTING: do not trust the times)" if facts["load_at_start"] > 0.7 else ""
    return (
        f"Processor: {processor['model name']}, {processor['vendor_id']} family {processor['cpu family']} model "
        f"{processor['model']} ({' '.join(processor['flags'])}), core {facts['pinned_to']} of {facts['cores']}; "
        f"{facts['system']}; Python {facts['python']}.\n"
        f"liepoisson {ours['liepoisson']}, kernel {ours['kernel']} of {', '.join(ours['available'])}, "
        f"numpy {ours['numpy']}; heyoka.py {peer['heyoka']} (recommended batch {peer['recommended_batch']}), "
        f"numpy {peer['numpy']}.\n"
        f"Load at the start {facts['load_at_start']:.2f}{busy}. "
        f"Reference: good to {facts['reference_error']:.0e} (median)."
    )


def duration(seconds: float) -> str:
    """Three digits with a unit."""
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def rate(units: float) -> str:
    """Trajectories times time a second."""
    return f"{units / 1e6:.3f}M" if units >= 1e5 else f"{units / 1e3:.3g}k"


def _errors(setting: Record, *names: str) -> str:
    values = [setting.get(name, 0.0) for name in names]
    return " / ".join(f"{value:.1e}" for value in values) if any(values) else ""


def ratios(peer: Record, ours: Record) -> tuple[float, float, float]:
    """How many times faster than the peer: by best times, by medians, and the median over rounds."""
    theirs, mine = np.array(peer["seconds"]) / work_of(peer), np.array(ours["seconds"]) / work_of(ours)
    return (
        float(theirs.min() / mine.min()),
        float(np.median(theirs) / np.median(mine)),
        float(np.median(theirs / mine)),
    )


def work_of(one: Record, default: float = 1.0) -> float:
    """Trajectories times time of one run; if a row has one work for all, it does not matter in ratios."""
    return one["contender"]["work"] or default


def _versus(peer: Record, one: Record) -> str:
    return " / ".join(f"{ratio:.2f}" if ratio < 100 else f"{ratio:.0f}" for ratio in ratios(peer, one))


def with_work(data: Record) -> list[Record]:
    """What was measured in a row, each with its own work."""
    return [one | {"contender": one["contender"] | {"work": work_of(one, data["work"])}} for one in data["measured"]]


def fastest(measured: list[Record]) -> Record | None:
    """The best rate among those that meet their level, if there are any."""
    meeting = [one for one in measured if one["contender"]["setting"]["meets"]]
    return min(meeting, key=lambda one: min(one["seconds"]) / work_of(one), default=None)


def of_kind(measured: list[Record], kind: str) -> list[Record]:
    """Those that compete as "double", "mixed" or "single"."""
    return [one for one in measured if one["contender"]["kind"] == kind]


def of_side(measured: list[Record], side: str) -> list[Record]:
    """Those of one side."""
    return [one for one in measured if one["contender"]["side"] == side]


def row_lines(data: Record) -> list[list[str]]:
    """A line for each contender, with columns of ratios (best, median, rounds)."""
    measured = with_work(data)
    versus = _ratios_to_others(measured) if _has_others(measured) else _ratios_to_heyoka(measured)
    best = [fastest(of_kind(measured, kind)) for kind in ("double", "mixed", "single")]
    header = ["contender", "setting", "order", "state error", "tangent error", "exponent error", "largest, of the mean"]
    table = [[*header, "best", "median", "rate at best", *versus[0]]]
    for one, against in zip(measured, versus[1:], strict=True):
        contender, seconds = one["contender"], one["seconds"]
        setting, name = contender["setting"], contender["name"]
        line = [
            (f"**{name}**" if one in best else name) + ("" if setting["meets"] else " (LEVEL NOT MET)"),
            choice(setting["request"]),
            str(setting["order"] or ""),
            *(_errors(setting, error) for error in ("state", "tangent", "exponent")),
            _errors(setting, "exponent_largest", "exponent_mean"),
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


def markdown(table: list[list[str]]) -> str:
    """A table's lines, the first of them its header."""
    return "".join(f"| {' | '.join(line)} |\n" for line in [table[0], ["---"] * len(table[0]), *table[1:]])


def render(data: Record) -> str:
    """One table with its title and its notes."""
    lines = {"row": row_lines, "kernels": kernels.lines, "dispatch": dispatch.lines}[data["kind"]](data)
    tail = notes(data) if data["kind"] == "row" else f"Runs of each: {data['rounds']}."
    return f"### {data['title']}\n\n{markdown(lines)}\n{tail}\n"


def summary(tables: dict[str, Record]) -> str:
    """The quickest of ours in each precision against the quickest heyoka, a line for each row of the benchmark."""
    header = ["what", "liepoisson", "state / tangent error", "largest exponent error", "rate", "heyoka's best", "ratio"]
    lines = [header]
    for data in (tables[name] for name in SUMMARY if name in tables):
        measured = with_work(data)
        peer = fastest(of_side(measured, "heyoka"))
        for ours in (fastest(of_kind(measured, kind)) for kind in ("double", "mixed", "single")):
            if ours is None or peer is None:
                continue
            setting = ours["contender"]["setting"]
            lines.append(
                [
                    data["title"],
                    f"{ours['contender']['name']}, {choice(setting['request'])}",
                    _errors(setting, "state", "tangent") if setting.get("tangent") else _errors(setting, "state"),
                    _errors(setting, "exponent_largest"),
                    _rate(data, ours),
                    f"{_rate(data, peer)} ({peer['contender']['name']})",
                    _versus(peer, ours),
                ]
            )
    return markdown(lines) + "\nRatios are of best times, of medians, and the median over rounds.\n"


def _rate(data: Record, one: Record) -> str:
    best = min(one["seconds"])
    return (
        duration(best)
        if data["wall"] or data["title"].startswith(("Single", "Dense", "Output"))
        else rate(work_of(one) / best)
    )


def blocks(tables: dict[str, Record]) -> dict[str, str]:
    """All that the document may hold, by the names of its markers."""
    first = next((tables[name]["facts"] for name in SUMMARY if name in tables), None)
    found = {name: render(data) + _elsewhere(data["facts"], first) for name, data in tables.items()}
    if first is not None:
        found |= {"summary": summary(tables), "environment": environment_text(first) + "\n"}
    return found


def _elsewhere(facts: Record, first: Record | None) -> str:
    """The facts of a table that was measured on another machine, or with other versions, than the first."""
    what = ("processor", "python", "heyoka", "liepoisson")
    same = first is not None and all(facts[name] == first[name] for name in what)
    return "" if same else f"\n{environment_text(facts)}\n"


def write_document(document: Path, found: dict[str, str]) -> list[str]:
    """Replace what stands between the markers; the names of the tables that were replaced."""
    text = document.read_text()
    replaced = [name for _, name, _ in MARKED.findall(text) if name in found]
    document.write_text(
        MARKED.sub(lambda mark: f"{mark[1]}\n{found[mark[2]]}\n{mark[3]}" if mark[2] in found else mark[0], text)
    )
    return replaced


def main() -> None:
    """Put all tables of results/tables/ into the docs."""
    found = blocks(load(TABLES))
    replaced = write_document(DOCUMENT, found)
    print(f"{DOCUMENT}: wrote {', '.join(replaced) or 'nothing'}")
    missing = sorted(set(found) - set(replaced))
    if missing:
        print(f"no marker for: {', '.join(missing)}")


if __name__ == "__main__":
    main()
