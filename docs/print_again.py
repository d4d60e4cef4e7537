"""Write into the pages what their blocks print now: `python docs/print_again.py README.md docs/exponents.md`.

For numbers that changed with a release; words and layout are left as they are, and the tests compare them.  Without
arguments, all pages.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from test_docs import GUIDE, outputs, with_numbers_of  # noqa: E402  # pyright: ignore[reportMissingImports]


def print_again(page: Path) -> int:
    """Run a page and replace the numbers of its outputs; returns how many outputs changed."""
    lines = page.read_text(encoding="utf-8").split("\n")
    changed = 0
    for block, printed in outputs(page):
        now = with_numbers_of(block.content, printed)
        if now.rstrip() != block.content.rstrip():
            begin = block.line
            end = begin + len(block.content.rstrip("\n").split("\n"))
            lines[begin:end] = now.rstrip("\n").split("\n")
            changed += 1
    page.write_text("\n".join(lines), encoding="utf-8")
    return changed


def main() -> None:
    """The pages of the command line, or all."""
    os.environ["MPLBACKEND"] = "Agg"
    os.environ.pop("LIEPOISSON_SIMD", None)
    pages = [Path(name).resolve() for name in sys.argv[1:]] or GUIDE
    for page in pages:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            print(f"{page.name}: {print_again(page)} outputs changed", flush=True)
            os.chdir(ROOT)


if __name__ == "__main__":
    main()
