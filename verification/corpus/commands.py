"""The command line: the help of each command, and exit codes and output of short commands.

Commands run in this process, in an empty folder, as `liepoisson ...` would; a file that one writes is named.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import sys
import tempfile
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

from verification.corpus.answer import answer, lines

from liepoisson.cli import main

SHORT = """
--version
nosuch
catalog
catalog --format json
cite
cite twisted-kovalevskaya rattleback
cite twisted-kovalevskaya --format bibtex
inspect nosuch
inspect kovalevskia
inspect clebsch
inspect twisted-top --format text
inspect twisted-top --format latex
inspect twisted-top --format json
inspect lagrange --set a=0,0,2 --set I=3,3,1
inspect lagrange --set a=0,0,x
integrals clebsch --degree 2
integrals clebsch --degree 2 --format latex
integrals clebsch --degree 2 --format json
integrals goryachev-chaplygin --on l.alpha --degree 3
integrable clebsch --time-limit 3600
integrable twisted-lagrange --format json --time-limit 3600
families heavy-top --free I --free a --positive I1,I2,I3 --degree 1 --time-limit 3600
darboux free-rigid-body --degree 1 --time-limit 3600
darboux henon-heiles --degree 2 --format json --time-limit 3600
painleve lagrange --time-limit 3600
painleve henon-heiles --format json --time-limit 3600
painleve henon-heiles-kdv --weights 2,2,3,3 --time-limit 3600
prove twisted-kovalevskaya --quiet
orbit kovalevskaya --start l=1,0,0 --start alpha=0,3/5,4/5 --leaf C1=1
orbit kovalevskaya --guess l=1,0,0 --guess alpha=0,3/5,4/5 --leaf C1=1/2 --energy 1 --t-end 10 --points 11
orbit kovalevskaya --energy -5
orbit twisted-kovalevskaya --t-end 20 --points 11
orbit twisted-kovalevskaya --t-end 20 --method splitting --order 6 --step 1/20
orbit twisted-kovalevskaya --t-end 20 --method splitting --order 6 --step 0.05
orbit twisted-kovalevskaya --t-end 20 --method nosuch
orbit three-wave --t-end 40 --points 81 --out waves.csv
section kovalevskaya --starts 3 --crossings 20
section twisted-kovalevskaya --starts 2 --crossings 20 --keep l1 --keep "dot(l, beta)" --out points.csv
section twisted-kovalevskaya --starts 2 --crossings 10 --plot
lyapunov twisted-kovalevskaya --leaf C1=1,C2=0,C3=1 --energy 1 --starts 8 --t-end 200
lyapunov henon-heiles --spectrum --start 0.1,0,0.3,0.2 --t-end 200
decide kovalevskaya --start l=1,0,1 --start alpha=0,0,1 --t-end 200
decide twisted-kovalevskaya --starts 4 --t-end 300 --format json
equilibria kovalevskaya --leaf l.alpha=1,C2=1
equilibria kovalevskaya --leaf l.alpha=1,C2=1 --format json
equilibria lagrange --along l3=2 --starts 20
sweep nosuch.toml
reproduce nosuch
lab nosuch
""".strip().split("\n")

_WRITTEN = (".csv", ".toml")
"""Endings of files that are kept as texts."""
_SECONDS = re.compile(r"\b\d+(?:\.\d+)? ?(?:s|seconds|ms)\b|(?<=^seconds ) .*", re.MULTILINE)
"""How long something took."""


def record() -> dict[str, Any]:
    """Help, and the short commands, by what is typed."""
    everything = run(["--help"])
    names = re.findall(r"^  ([a-z]+)  ", str(everything["output"]).partition("Commands:")[2], re.MULTILINE)
    helped = {"liepoisson --help": answer(lambda: everything)}
    helped |= {f"liepoisson {name} --help": answer(lambda name=name: run([name, "--help"])) for name in names}
    short = {f"liepoisson {line}": answer(lambda line=line: run(shlex.split(line))) for line in SHORT}
    ascii_report = {"ASCII: liepoisson inspect twisted-top": run(["inspect", "twisted-top"], encoding="ascii")}
    return {
        "help": helped,
        "short": {line: tidy(said) for line, said in (short | ascii_report).items()},
    }


def run(arguments: Sequence[str], encoding: str = "utf-8") -> dict[str, Any]:
    """A command: its exit code, what it prints, and the files that it leaves."""
    with in_a_folder() as folder, patch.object(sys, "argv", ["liepoisson", *arguments]), streams(encoding) as read:
        try:
            main()
            code: Any = 0
        except SystemExit as stopped:
            code = stopped.code or 0
        output, error = read()
        files = {path.name: content(path) for path in sorted(folder.rglob("*")) if path.is_file()}
    return {"exit code": code, "output": output, "error": error, "files": files}


def content(path: Path) -> str:
    """The text of a file, or that there is one."""
    return path.read_text(encoding="utf-8") if path.suffix in _WRITTEN else "there is one"


def tidy(said: Any) -> Any:
    """By lines, without how long it took."""
    if isinstance(said, dict):
        return {key: tidy(value) for key, value in said.items()}
    if isinstance(said, list):
        return [tidy(line) for line in said]
    return lines(_SECONDS.sub("(time)", said)) if isinstance(said, str) else said


@contextlib.contextmanager
def in_a_folder() -> Generator[Path]:
    """An empty working folder."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder), patch.dict(os.environ):
        yield Path(folder)


@contextlib.contextmanager
def streams(encoding: str) -> Generator[Any]:
    """Standard output and error that are kept, in an encoding."""
    kept = [io.TextIOWrapper(io.BytesIO(), encoding=encoding) for _ in range(2)]

    def read() -> list[str]:
        for stream in kept:
            stream.flush()
        return [stream.buffer.getvalue().decode(encoding) for stream in kept]

    with contextlib.redirect_stdout(kept[0]), contextlib.redirect_stderr(kept[1]):
        yield read
