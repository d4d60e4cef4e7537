"""The corpus: what the package answers, written down before a change of its inside, to be compared with it after.

    python -m verification.corpus.record --out FOLDER [PART ...]
    python -m verification.corpus.compare OLD NEW

`make corpus` records into results/corpus; a corpus to compare with is recorded before the change, in a folder outside
of the repository.  Only public names of the package are asked, so that its files and inner names may change.  Each part
is one JSON file, sorted; recorded twice on one machine it has the same bytes.

- `catalogue`: each system of the catalog: report, equations, values, Casimirs, integrals, equilibria, Painlevé test,
  Lax pair, charts, symmetries; a question has limits of processor time and memory.
- `analysis`: algebras, families, searches, proofs, and what else has no row in the catalog.
- `commands`: the help of each command, and what short commands print.
- `signatures`: every public name, how it is called, and the attributes of its class.
- `hashes`: the cases of tests/portable/portable_cases.py, and orbits, exponents, sections and others of fixed starts.
- `pictures`: labels, titles, legends and data of each figure.
- `refusals`: not of this script, since it takes as long as the tests do; refusals.py says how it is recorded.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any

from verification.corpus.answer import answer

PARTS = ("signatures", "commands", "hashes", "pictures", "analysis", "catalogue")
"""Modules of this folder with a function `record`, the quickest first."""


def written(record: Any) -> str:
    """A part as text: one value a line, keys in alphabetical order."""
    return json.dumps(record, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def record_part(part: str, out: Path) -> None:
    """Record one part, and say how long it took and how large it is."""
    began, worked = time.perf_counter(), processor_time()
    text = written(answer(lambda: import_module(f"verification.corpus.{part}").record()))
    (out / f"{part}.json").write_text(text, encoding="utf-8")
    seconds, cpu = time.perf_counter() - began, processor_time() - worked
    print(f"{part}: {seconds:.0f} s ({cpu:.0f} s of processors), {len(text.encode()) / 1e3:.0f} kB", flush=True)


def processor_time() -> float:
    """Seconds of processors so far, with those of processes that have ended."""
    return sum(os.times()[:4])


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="record what liepoisson answers")
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}")
    parser.add_argument("--out", type=Path, required=True, help="the folder of the corpus")
    chosen = parser.parse_args()
    if unknown := [part for part in chosen.parts if part not in PARTS]:
        parser.error(f"there is no part {unknown[0]!r}; known: {', '.join(PARTS)}")
    chosen.out.mkdir(parents=True, exist_ok=True)
    os.environ["MPLBACKEND"] = "agg"
    os.environ["COLUMNS"] = "100"  # the width of help, and of tables
    for part in chosen.parts or PARTS:
        record_part(part, chosen.out)


if __name__ == "__main__":
    sys.exit(main())
