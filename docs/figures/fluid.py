"""The figure of the fluid in docs/catalog.md, drawn by the code on the page: `python docs/figures/fluid.py`."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]


def main(folder: Path) -> None:
    """Runs the blocks of the section and leaves fluid.png in a folder."""
    page = (DOCS / "catalog.md").read_text(encoding="utf-8")
    section = page[page.index("## A fluid") : page.index("(images/fluid.png)")]
    os.environ["MPLBACKEND"] = "Agg"
    os.chdir(folder)
    code = "import liepoisson as lp\n" + "".join(re.findall(r"```python\n(.*?)```", section, re.DOTALL))
    exec(compile(code, "catalog.md", "exec"), {})


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else DOCS / "images")
