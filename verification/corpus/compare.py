"""Where two corpora differ: `python -m verification.corpus.compare OLD NEW`; the exit status is 1 if they do.

Each difference stands under the part and the question that it belongs to, line by line as `diff -u` writes it.  A part
that only one folder has is a difference, too; `--only PART ...` compares some parts.
"""

from __future__ import annotations

import argparse
import difflib
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ABSENT = object()
DEPTH = 3
"""Keys down to here name a question; what is below is its answer."""


def questions(record: Any, depth: int = DEPTH, path: str = "") -> Iterator[tuple[str, Any]]:
    """The answers of a part by the path of their keys."""
    if isinstance(record, dict) and depth and record:
        for key, item in record.items():
            yield from questions(item, depth - 1, f"{path} / {key}" if path else key)
    else:
        yield path, record


def as_lines(value: Any) -> list[str]:
    """An answer by lines: a text as itself, all else as JSON."""
    if value is ABSENT:
        return []
    if isinstance(value, str):
        return [value]
    if isinstance(value, list) and all(isinstance(item, str) for item in value):
        return value
    return json.dumps(value, indent=1, sort_keys=True, ensure_ascii=False).split("\n")


def differences(old: Any, new: Any) -> Iterator[tuple[str, list[str]]]:
    """The question and the lines of each difference, in the order of the questions."""
    before, after = dict(questions(old)), dict(questions(new))
    for question in sorted(before.keys() | after.keys()):
        one, other = before.get(question, ABSENT), after.get(question, ABSENT)
        if one == other and (one is ABSENT) == (other is ABSENT) and as_lines(one) == as_lines(other):
            continue
        if as_lines(one) == as_lines(other) and ABSENT not in (one, other):
            continue  # NaN is not equal to itself
        shown = difflib.unified_diff(as_lines(one), as_lines(other), lineterm="", n=2)
        yield question, list(shown)[2:]


def parts(folder: Path, only: list[str] | None) -> dict[str, Any]:
    """The parts of a corpus by name."""
    files = sorted(folder.glob("*.json"))
    return {
        file.stem: json.loads(file.read_text(encoding="utf-8")) for file in files if only is None or file.stem in only
    }


def main() -> int:
    """Print the differences; 1 if there are any."""
    parser = argparse.ArgumentParser(description="compare two corpora")
    parser.add_argument("old", type=Path, help="the folder recorded before the change")
    parser.add_argument("new", type=Path, help="the folder recorded after it")
    parser.add_argument("--only", nargs="+", metavar="PART", help="some parts")
    chosen = parser.parse_args()
    old, new = parts(chosen.old, chosen.only), parts(chosen.new, chosen.only)
    if not old and not new:
        parser.error("there is no part in either folder")
    count = 0
    for part in sorted(old.keys() | new.keys()):
        if part not in old or part not in new:
            print(f"== {part}: only in {chosen.old if part in old else chosen.new}")
            count += 1
            continue
        for question, shown in differences(old[part], new[part]):
            print(f"== {part}: {question}", *shown, "", sep="\n")
            count += 1
    print("the same" if not count else f"{count} differences", f"in {', '.join(sorted(old.keys() | new.keys()))}")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
