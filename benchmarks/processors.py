"""What did each processor say?  One small file for each in benchmarks/processors/, and a column for each in the docs.

A file keeps, for each row, the quickest of ours of each kind, the quickest setting of heyoka on that processor and the
ratios between them.  `report.py` renews the rows that were measured and leaves the others; the files are under version
control, so that the page keeps what was measured on machines that are no longer at hand.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import general_problems
import kernels
import measure
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

FOLDER = measure.HERE / "processors"
ROWS = (
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
"""Rows of the top that have a peer, in the order of the tables; those of `general.py` have tables of their own."""
MAIN_ROW = "1e-13"
"""The processor on which this row was measured last is at the head of the page."""
ERRORS = ("state", "tangent", "exponent_largest")
SETS = {"avx512": "AVX-512", "avx2": "AVX2", "neon": "NEON", "scalar": "no vectors"}
"""Kernels, the widest first."""
DIGITS = 10
"""More than are shown, so that what is shown is rounded once."""


def has_row(name: str, data: Record) -> bool:
    """Whether a table becomes a row here: it compares liepoisson with heyoka."""
    return data["kind"] == "row" and (name in ROWS or name.startswith(general_problems.PREFIX))


def row_of(data: Record, facts: Record) -> Record:
    """The quickest of each kind against the quickest setting of heyoka, and the same for another instruction set."""
    measured = [_with_kind(one, data["measured"]) for one in with_work(data)]
    peer, ours = fastest(of_side(measured, "heyoka")), of_side(measured, "liepoisson")
    lines: list[Record] = []
    for simd in dict.fromkeys(one["contender"]["simd"] for one in ours):
        same = [one for one in ours if one["contender"]["simd"] == simd]
        for best in (fastest(of_kind(same, kind)) for kind in KINDS):
            if best is not None and peer is not None:
                lines.append(_line(data, best, peer, simd or facts["liepoisson"]["kernel"]))
    return {
        "title": data["title"],
        "date": facts["date"],
        "rounds": data["rounds"],
        "liepoisson": facts["liepoisson"]["liepoisson"],
        "commit": facts.get("commit", ""),
        "heyoka": facts["heyoka"]["heyoka"],
        "lines": lines,
    }


def _with_kind(one: Record, measured: list[Record]) -> Record:
    """A contender of another instruction set competes as the one with the same request; where none is named, all are
    double."""
    contender = one["contender"]
    if contender["kind"] or contender["side"] != "liepoisson":
        return one
    kinds = [other["contender"] for other in measured if other["contender"]["kind"]]
    if not kinds:
        return one | {"contender": contender | {"kind": "double"}}
    if contender["simd"] is None:
        return one
    kind = next((other["kind"] for other in kinds if other["request"] == contender["request"]), "")
    return one | {"contender": contender | {"kind": kind}}


def _line(data: Record, ours: Record, peer: Record, simd: str) -> Record:
    best, median, rounds = map(_rounded, ratios(peer, ours))
    return {
        "kind": ours["contender"]["kind"],
        "simd": simd,
        **_side(data, ours),
        "heyoka": _side(data, peer),
        "ratios": {"best": best, "median": median, "rounds": rounds},
    }


def _side(data: Record, one: Record) -> Record:
    """Setting, errors, the best time, and the rate at that time but where whole processes are timed."""
    contender, best = one["contender"], min(one["seconds"])
    setting = contender["setting"]
    cold = setting.get("cold") or min((answer.get("cold", 0.0) for answer in one["answers"]), default=0.0)
    return {
        "name": contender["name"],
        "setting": measure.choice(setting["request"]),
        "errors": {name: _rounded(setting[name]) for name in ERRORS if setting.get(name)},
        **({"largest": setting["largest"]} if setting.get("largest") else {}),
        **({"cold": _rounded(cold)} if cold else {}),
        "seconds": _rounded(best),
        "rate": None if data["wall"] else _rounded(work_of(one) / best),
    }


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def peak_of(data: Record, facts: Record) -> Record:
    """What part of the peak of multiply-adds each kernel reaches."""
    reached = [
        {
            "kernel": one["kernel"],
            "simd": one["simd"],
            "gflops": _rounded(one["gflops"]),
            "fraction": _rounded(one["fraction"]),
        }
        for one in kernels.reached(data)
    ]
    return {"date": facts["date"], "rounds": data["rounds"], "reached": reached}


def file_of(processor: Record) -> str:
    """The name of a processor's file: `genuineintel-6-207.json`."""
    return f"{processor['vendor_id'].lower()}-{processor['cpu family']}-{processor['model']}.json"


def update(folder: Path, tables: dict[str, Record]) -> list[str]:
    """Renew the rows that `tables` have, each in the file of its processor; the names of the files written."""
    found: dict[str, Record] = {}
    for name, data in tables.items():
        if not has_row(name, data) and data["kind"] != "kernels":
            continue
        facts = data["facts"]
        file = file_of(facts["processor"])
        if file not in found:
            path = folder / file
            known = json.loads(path.read_text()) if path.exists() else {"rows": {}, "peak": None}
            found[file] = {"processor": facts["processor"], "facts": facts} | known
        _renew(found[file], name, data)
    folder.mkdir(parents=True, exist_ok=True)
    for file, known in found.items():
        known["rows"] = {name: known["rows"][name] for name in order_of(known["rows"])}
        (folder / file).write_text(json.dumps(known, indent=1) + "\n")
    return list(found)


def _renew(known: Record, name: str, data: Record) -> None:
    """Put one table in, unless a newer one is there; a remark belongs to one measurement and goes with it."""
    facts = data["facts"]
    older = known["peak"] if data["kind"] == "kernels" else known["rows"].get(name)
    if older and older["date"] > facts["date"]:
        return
    remark = {"remark": older["remark"]} if older and older["date"] == facts["date"] and "remark" in older else {}
    if data["kind"] == "kernels":
        known["peak"] = peak_of(data, facts) | remark
        return
    known["rows"][name] = row_of(data, facts) | remark
    if not name.startswith(general_problems.PREFIX) and facts["date"] >= known["facts"]["date"]:
        known["processor"], known["facts"] = facts["processor"], facts


def load(folder: Path = FOLDER) -> list[Record]:
    """All processors, by the names of their files."""
    return [json.loads(path.read_text()) for path in sorted(folder.glob("*.json"))]


def order_of(names: Any) -> list[str]:
    """Names of rows in the order of the tables."""
    return [name for name in ROWS if name in names] + sorted(name for name in names if name not in ROWS)


def at_head(processors: list[Record]) -> Record:
    """The processor on which the ensembles were measured last; if on none, the one that was measured last."""

    def last(one: Record) -> tuple[bool, str]:
        rows = one["rows"]
        return MAIN_ROW in rows, rows[MAIN_ROW]["date"] if MAIN_ROW in rows else one["facts"]["date"]

    return max(processors, key=last)


def columns(processors: list[Record]) -> list[tuple[Record, str]]:
    """Each processor with each instruction set that was measured on it, the widest first."""
    found: list[tuple[Record, str]] = []
    for one in processors:
        measured = {line["simd"] for row in one["rows"].values() for line in row["lines"]}
        found += [(one, simd) for simd in SETS if simd in measured]
    return found


def heading(one: Record, simd: str) -> str:
    """A processor and an instruction set."""
    return f"{processor_name(one['processor'])}, {SETS[simd]}"


def marked(ratio: float) -> str:
    """The ratio; bold where liepoisson is the slower one."""
    shown = shown_ratios([ratio])
    return f"**{shown}**" if ratio < 1.0 else shown


def table(processors: list[Record]) -> list[list[str]]:
    """A line for each row and kind, a column for each processor and instruction set."""
    across = columns(processors)
    lines = [["row", "precision", *(heading(*one) for one in across)]]
    for name in ROWS:
        for kind in KINDS:
            cells = [_cell(one["rows"].get(name), kind, simd) for one, simd in across]
            if any(cells):
                lines.append([f"`{name}`", kind, *cells])
    return lines


def _cell(row: Record | None, kind: str, simd: str) -> str:
    lines = row["lines"] if row else []
    return next(
        (marked(line["ratios"]["rounds"]) for line in lines if line["kind"] == kind and line["simd"] == simd), ""
    )


def peak_table(processors: list[Record]) -> list[list[str]]:
    """A line for each kernel with the part of the peak that it reaches on each processor."""
    having = [one for one in processors if one["peak"]]
    reached = {
        (one["kernel"], processor_name(processor["processor"]), one["simd"]): one["fraction"]
        for processor in having
        for one in processor["peak"]["reached"]
    }
    across = [
        (one, simd) for one in having for simd in SETS if any(part["simd"] == simd for part in one["peak"]["reached"])
    ]
    names = dict.fromkeys(name for name, _, _ in reached)
    lines = [["kernel", *(heading(*one) for one in across)]]
    for name in names:
        fractions = [reached.get((name, processor_name(one["processor"]), simd)) for one, simd in across]
        lines.append([name, *("" if value is None else f"{100 * value:.0f}%" for value in fractions)])
    return lines


def _from_what(one: Record) -> str:
    """Name, instruction sets, dates, versions and remarks of one processor."""
    rows = one["rows"].values()
    said = [
        f"{processor_name(one['processor'])}: {one['processor']['model name']} ({' '.join(one['processor']['flags'])})",
        "measured " + _span({row["date"][:10] for row in rows}),
        "liepoisson "
        + _span({row["liepoisson"] for row in rows})
        + ", heyoka.py "
        + _span({row["heyoka"] for row in rows}),
        _span({str(row["rounds"]) for row in rows}) + " processes of each",
    ]
    remarks: dict[str, list[str]] = {}
    measured = [(name, one["rows"][name]) for name in order_of(one["rows"])] + [("kernels", one["peak"] or {})]
    for name, row in measured:
        if "remark" in row:
            remarks.setdefault(row["remark"], []).append(f"`{name}`")
    return "; ".join(said) + "." + "".join(f" {', '.join(names)}: {remark}" for remark, names in remarks.items())


def _span(values: set[str]) -> str:
    return " to ".join(sorted({min(values), max(values)}))


def render(processors: list[Record]) -> str:
    """The table of all processors, with what it says and from what it comes."""
    parts = [
        "### Each processor: how many times faster than heyoka's best setting on it\n",
        markdown(table(processors)),
        "Medians over rounds. A ratio below 1, where liepoisson is slower, is bold; an empty place was not measured. "
        "In the columns of a narrower instruction set only liepoisson is kept to it.\n",
    ]
    if any(one["peak"] for one in processors):
        parts += ["Part of the peak of multiply-adds that the kernels reach:\n", markdown(peak_table(processors))]
    parts += [f"- {_from_what(one)}" for one in processors]
    return "\n".join(parts) + "\n"


def head(processors: list[Record]) -> str:
    """The processors of the page, in one sentence."""
    named: dict[str, list[str]] = {}
    for one, simd in columns(processors):
        named.setdefault(processor_name(one["processor"]), []).append(SETS[simd])
    last = processor_name(at_head(processors)["processor"])
    listed = "; ".join(f"{name} ({', '.join(sets)})" for name, sets in named.items())
    return f"Processors measured: {listed}. The detailed tables are of {last}.\n"


def environment(processors: list[Record]) -> str:
    """The facts of the processor at the head."""
    return environment_text(at_head(processors)["facts"]) + "\n"


def summary(one: Record) -> str:
    """The quickest of ours in each precision against the quickest heyoka, a line for each row of the top."""
    header = ["what", "liepoisson", "state / tangent error", "largest exponent error", "rate", "heyoka's best", "ratio"]
    lines = [header]
    for row in (one["rows"][name] for name in ROWS if name in one["rows"]):
        widest = next(simd for simd in SETS if any(line["simd"] == simd for line in row["lines"]))
        for ours in (line for line in row["lines"] if line["simd"] == widest):
            errors, peer = ours["errors"], ours["heyoka"]
            lines.append(
                [
                    row["title"],
                    f"{ours['name']}, {ours['setting']}",
                    shown_errors(errors, "state", "tangent") if "tangent" in errors else shown_errors(errors, "state"),
                    shown_errors(errors, "exponent_largest"),
                    _shown_speed(row, ours),
                    f"{_shown_speed(row, peer)} ({peer['name']})",
                    shown_ratios(list(ours["ratios"].values())),
                ]
            )
    dates = _span({one["rows"][name]["date"][:10] for name in ROWS if name in one["rows"]})
    return (
        f"Measured on {processor_name(one['processor'])}, {dates}.\n\n{markdown(lines)}\n"
        "Ratios are of best times, of medians, and the median over rounds.\n"
    )


def _shown_speed(row: Record, one: Record) -> str:
    if one["rate"] is None or row["title"].startswith(("Single", "Dense", "Output")):
        return duration(one["seconds"])
    return rate(one["rate"])
