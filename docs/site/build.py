"""Builds the site: python docs/site/build.py [--out FOLDER] [--rust].  Nothing is downloaded.

Pages are staged (staging.py), name_pages.py and command_pages.py write those of public names and of commands, and
Sphinx makes HTML of them, where each warning is an error.  `--rust` adds the pages of the Rust core, by cargo.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

os.environ["MPLBACKEND"] = "agg"

import command_pages
import name_pages
from sphinx.cmd.build import main as sphinx
from staging import ROOT, Stage

import liepoisson as lp

HERE = Path(__file__).resolve().parent


def build(out: Path) -> int:
    """The site in out/html, from pages in out/source; returns the exit code of Sphinx."""
    stage = Stage(out / "source")
    stage.fill()
    name_pages.write(stage)
    command_pages.write(stage)
    shutil.rmtree(out / "html", ignore_errors=True)
    options = ["-W", "--keep-going", "-q", "-E", "-b", "html", "-c", str(HERE), "-d", str(out / "doctrees")]
    code = sphinx([*options, str(out / "source"), str(out / "html")])
    (out / "html" / "version.json").write_text(json.dumps({"version": lp.__version__}) + "\n", encoding="utf-8")
    return code


def build_rust(out: Path) -> int:
    """The pages of the Rust core in out/html/rust, as cargo makes them."""
    command = ["cargo", "doc", "-p", "liepoisson-core", "--no-deps", "--locked", "--offline", "--quiet"]
    settings = {**os.environ, "CARGO_TARGET_DIR": str(out / "rust")}
    code = subprocess.run(command, check=False, cwd=ROOT, env=settings).returncode
    if not code:
        shutil.copytree(out / "rust" / "doc", out / "html" / "rust", dirs_exist_ok=True)
    return code


def main() -> int:
    """Build what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "target" / "site", help="the folder of the site")
    parser.add_argument("--rust", action="store_true", help="with the pages of the Rust core")
    given = parser.parse_args()
    code = build(given.out.resolve())
    if given.rust:
        code = code or build_rust(given.out.resolve())
    print(f"{given.out / 'html' / 'index.html'}")
    return code


if __name__ == "__main__":
    sys.exit(main())
