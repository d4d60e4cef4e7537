"""Writes what the page knows of tops, `src/data/tops.json`: equations, invariants, and the presets.

    python web/build_tops.py

`tests/laboratory/test_tops.py` repeats it.
"""

from __future__ import annotations

import json
from pathlib import Path

from liepoisson.laboratory.tops import description_of_tops, presets

FILE = Path(__file__).resolve().parent / "src" / "data" / "tops.json"


def text() -> str:
    """What the file contains."""
    return json.dumps({**description_of_tops(), "presets": presets()}, allow_nan=False, separators=(",", ":")) + "\n"


if __name__ == "__main__":
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text(text(), encoding="utf-8")
