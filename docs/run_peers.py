"""Run the lines of other tools: `python docs/run_peers.py docs/coming-from-scipy.md`.

The blocks `py` of a page are those of another tool, and a block `text` right after one is what they print.  They need
that tool, and so run by hand: in an environment that has it, without liepoisson.  Without arguments, all pages.
"""

from __future__ import annotations

import contextlib
import io
import re
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
BLOCK = re.compile(r"^```py\n(.*?)^```$(?:\s*^```text\n(.*?)^```$)?", re.DOTALL | re.MULTILINE)


def mistakes(page: Path) -> list[str]:
    """What a page shows and its blocks do not print; they share one namespace, in order."""
    namespace: dict[str, object] = {"__name__": "__document__"}
    found: list[str] = []
    for number, (code, shown) in enumerate(BLOCK.findall(page.read_text(encoding="utf-8")), 1):
        with contextlib.redirect_stdout(io.StringIO()) as output:
            exec(compile(code, f"{page.name}, block {number}", "exec"), namespace)
        if shown.split() != output.getvalue().split():
            found.append(f"block {number} shows\n{shown}and prints\n{output.getvalue()}")
    return found


def main() -> None:
    """The pages of the command line, or all that have such blocks."""
    pages = [Path(name) for name in sys.argv[1:]] or sorted(DOCS.glob("coming-from-*.md"))
    wrong = {page.name: mistakes(page) for page in pages}
    for name, found in wrong.items():
        print(f"{name}: {'as shown' if not found else ''}", *found, sep="\n" if found else "")
    sys.exit(any(wrong.values()))


if __name__ == "__main__":
    main()
