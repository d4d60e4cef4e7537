"""Builds the page of the laboratory, one file, and writes beside it the hash of what it is made from.

    python web/build_page.py

It needs node and npm.  `tests/web/test_page.py` compares the hash with the sources, so that nothing else does.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
import sys
from pathlib import Path

WEB = Path(__file__).resolve().parent
ROOT = WEB.parent
FOLDER = ROOT / "python" / "liepoisson" / "laboratory" / "page"
PAGE, RECORD = FOLDER / "index.html", FOLDER / "page.json"
WIDGET, SHIPPED_WIDGET = WEB / "src" / "notebook" / "widget.js", FOLDER / "widget.js"
"""The script of the widget of notebooks, which is shipped as it is."""


def sources() -> list[Path]:
    """What the page is made from."""
    names = ("index.html", "package.json", "package-lock.json", "tsconfig.json", "vite.config.ts")
    files = [*(WEB / name for name in names), *(WEB / "src").rglob("*.*"), FOLDER / "core.wasm"]
    return sorted(files, key=lambda file: file.relative_to(ROOT).as_posix())


def hash_of_sources() -> str:
    """One hash of names and contents."""
    total = hashlib.sha256()
    for file in sources():
        total.update(f"{file.relative_to(ROOT).as_posix()}\n{hash_of(file)}\n".encode())
    return total.hexdigest()


def hash_of(file: Path) -> str:
    """The hash of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def build() -> None:
    """Builds the page and writes it with its record.

    Raises:
        SystemExit: there is no npm, or it failed.
    """
    npm = shutil.which("npm")
    if npm is None:
        raise SystemExit("to build the page, install node 20 or later, with npm")
    commands = [["run", "build"]]
    if not (WEB / "node_modules").is_dir():
        commands.insert(0, ["ci", "--no-audit", "--no-fund"])
    for command in commands:
        if subprocess.run([npm, *command], cwd=WEB, check=False).returncode:
            raise SystemExit(f"npm {' '.join(command)} failed")
    shutil.copyfile(WEB / "dist" / "index.html", PAGE)
    shutil.copyfile(WIDGET, SHIPPED_WIDGET)
    record = {"sources": hash_of_sources(), "page": hash_of(PAGE)}
    RECORD.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    print(f"{PAGE.relative_to(ROOT)}: {PAGE.stat().st_size} bytes")


if __name__ == "__main__":
    sys.exit(build())
