"""Writes what the page offers to somebody who types a system, `src/data/systems.json`: brackets and examples.

    python web/build_systems.py

The terms of the brackets, their Casimirs and the examples are those of the package; `tests/web/test_typed_systems.py`
repeats it.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from liepoisson.compile.typed import names_of
from liepoisson.laboratory.drafts import BRACKETS, EXAMPLES, example
from liepoisson.model.constructors import read_algebra, read_extension
from liepoisson.structure.bracket import Bracket

FILE = Path(__file__).resolve().parent / "src" / "data" / "systems.json"


def brackets() -> dict[str, Any]:
    """Terms `(i, j, m, c)` with {x_i, x_j} = sum of c x_m, and Casimirs as formulas, by key."""
    found = {}
    for key, words, algebra, extension, variables in BRACKETS:
        bracket = Bracket(read_algebra(algebra), read_extension(extension, ("epsilon",)), variables)
        found[key] = {
            "words": words,
            "algebra": algebra,
            "extension": extension,
            "fields": dict(names_of(bracket)),
            "terms": [[i, j, m, str(c)] for i, j, m, c in bracket.kept_entries()],
            "casimirs": [formula(casimir) for casimir in bracket.casimirs()],
        }
    return found


def formula(expression: Any) -> str:
    """A polynomial of SymPy in the grammar."""
    return str(expression).replace("**", "^").replace(" ", "")


def examples() -> list[dict[str, Any]]:
    """Systems of the catalog as somebody would type them."""
    left_out = ("name", "ranges", "given")
    drafts = [(key, words, asdict(example(key))) for key, words in EXAMPLES.items()]
    return [
        {"key": key, "words": words, **{name: one for name, one in draft.items() if name not in left_out}}
        for key, words, draft in drafts
    ]


def text() -> str:
    """What the file contains."""
    record = {"brackets": brackets(), "examples": examples()}
    return json.dumps(record, allow_nan=False, ensure_ascii=False, separators=(",", ":")) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
