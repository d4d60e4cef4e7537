"""The audit of the methods: measures, then writes figures, tables and docs/verification/results.json.

The page docs/verification.md has the summary, verification/tables.md the tables of each question.

`python verification/run.py` runs everything, an hour or two; `--quick` takes small sizes, minutes, and writes into
results/audit/quick unless `--out` says otherwise.  `--only orders drift` runs some of the questions and leaves the
results of the others.  What is measured is kept piece by piece in results/audit, and an audit that was interrupted
goes on where it was.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

import bits
import drift
import figures
import independent
import liepoisson as lp
import orders
import pages
import poisson_defect
import reference_check
import reversal
import summary
import tangents
import work_precision
from settings import Settings
from store import Store

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
STORED = ROOT / "results" / "audit"
QUESTIONS: dict[str, ModuleType] = {
    "reference": reference_check,
    "orders": orders,
    "poisson-defect": poisson_defect,
    "tangents": tangents,
    "reversal": reversal,
    "bits": bits,
    "work-precision": work_precision,
    "independent": independent,
    "drift": drift,
}
"""In this order: the longest last."""
ON_THE_PAGE = ("bits", "independent")
"""Questions whose tables stand in docs/verification.md; the others are in tables.md."""


def machine() -> dict[str, Any]:
    """Where and with what it was measured."""
    names = [line.partition(":")[2].strip() for line in _cpuinfo() if line.startswith("model name")]
    return {
        "liepoisson": lp.__version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "processor": names[0] if names else platform.processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
    }


def _cpuinfo() -> list[str]:
    path = Path("/proc/cpuinfo")
    return path.read_text().splitlines() if path.exists() else []


def answer(name: str, settings: Settings, store: Store, out: Path) -> None:
    """Measure one question, and write its part of results.json, its figure and its table."""
    question, began = QUESTIONS[name], time.perf_counter()
    result: dict[str, Any] = question.measure(settings, store)
    seconds = time.perf_counter() - began
    record = {"quick": settings.quick, "machine": machine(), "result": result}
    record = json.loads(json.dumps(record, allow_nan=False))  # what is drawn and tabulated is what the file holds
    _keep(out / "verification" / "results.json", name, record)
    publish(name, record, out)
    print(f"{name}: {seconds:.0f} s", flush=True)


def _keep(path: Path, name: str, record: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    results = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    results[name] = record
    partial = path.with_suffix(".partial")
    lines = (f"{json.dumps(key)}: {json.dumps(value)}" for key, value in results.items())  # a line for each question
    partial.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    os.replace(partial, path)


def publish(name: str, record: dict[str, Any], out: Path) -> None:
    """Figure and table of a result; the same record gives the same bytes."""
    question, facts = QUESTIONS[name], record["machine"]
    for figure, draw in getattr(question, "FIGURES", {}).items():
        svg = out / "verification" / f"{figure}.svg"
        figures.save(draw, record["result"], svg, STORED / "figures" / f"{figure}.png")
    size = "**Quick run, small sizes.** " if record["quick"] else ""
    foot = (
        f"{size}liepoisson {facts['liepoisson']}, numpy {facts['numpy']}, Python {facts['python']}, {facts['system']}, "
        f"{facts['processor']}."
    )
    page = out / "verification.md" if name in ON_THE_PAGE else tables_of(out)
    pages.put(page, name, f"\n{question.table(record['result'])}\n\n{foot}\n")


def summarise(out: Path) -> None:
    """The table of the page, where its parts have been measured."""
    results = json.loads((out / "verification" / "results.json").read_text(encoding="utf-8"))
    if set(summary.NEEDED) <= set(results):
        pages.put(out / "verification.md", "summary", f"\n{summary.table(results)}\n")


def tables_of(out: Path) -> Path:
    """The file of the detailed tables: beside this one for those of the documents."""
    return (ROOT / "verification" if out.resolve() == DOCS else out) / "tables.md"


def main(arguments: list[str] | None = None) -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="audit of the methods of liepoisson")
    parser.add_argument("--quick", action="store_true", help="small sizes, a few minutes")
    parser.add_argument("--only", nargs="+", choices=QUESTIONS, metavar="NAME", help=f"of {', '.join(QUESTIONS)}")
    parser.add_argument("--out", type=Path, help="folder of verification.md and verification/, by default docs")
    parser.add_argument("--fresh", action="store_true", help="compute again what is stored: for a changed build")
    parser.add_argument("--draw", action="store_true", help="measure nothing, draw what results.json holds")
    chosen = parser.parse_args(arguments)
    out: Path = chosen.out or (STORED / "quick" if chosen.quick else DOCS)
    if out.resolve() != DOCS:
        out.mkdir(parents=True, exist_ok=True)
        shutil.copy(DOCS / "verification.md", out)
        shutil.copy(tables_of(DOCS), out)
    if chosen.draw:
        kept = json.loads((out / "verification" / "results.json").read_text(encoding="utf-8"))
        for name in chosen.only or kept:
            publish(name, kept[name], out)
        summarise(out)
        return
    settings, store = Settings(quick=chosen.quick), Store(STORED, fresh=chosen.fresh)
    for name in chosen.only or QUESTIONS:
        missing = independent.missing() if name == "independent" else None
        if missing is None:
            answer(name, settings, store, out)
        else:
            print(f"{name}: passed over, {missing}", flush=True)
    summarise(out)


if __name__ == "__main__":
    sys.exit(main())
