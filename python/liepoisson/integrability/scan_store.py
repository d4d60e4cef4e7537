"""The folder of a scan: one file of lines, the first of which says what is scanned; each other one has some points.

Each line begins with its checksum, those of points also with a digest of the first line: they name their scan.  A line
that is damaged or belongs to another scan, such as the last one of a process that was killed, is left out, and its
points are computed again.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any
from zlib import crc32

from liepoisson.errors import DamagedFileError, OutputError
from liepoisson.integrability.checker import number
from liepoisson.integrability.scan_points import OUTCOMES, PointResult
from liepoisson.io.files import another_format, write_atomically, writing

FORMAT = "liepoisson integral scan 2"
_FILE = "points.jsonl"


class ScanStore:
    """The points of a scan that are known."""

    def __init__(self, folder: Path, description: Mapping[str, Any], *, fresh: bool = False) -> None:
        self.path = folder / _FILE
        self.known: dict[int, PointResult] = {}
        head = json.loads(json.dumps({"format": FORMAT, **description}))
        self._scan = sha256(_line(head).encode()).hexdigest()[:16] + " "
        with writing(folder):
            is_there, is_used = self.path.exists(), any(p.name not in (".lock", _FILE) for p in folder.iterdir())
        if is_there and not fresh:
            self._read(head)
        elif is_used:
            raise OutputError(f"{folder} is not empty and holds no scan. Choose another name for the store.")
        else:
            write_atomically(self.path, _line(head).encode())

    def _read(self, head: Mapping[str, Any]) -> None:
        with writing(self.path):
            content = self.path.read_bytes()
        lines = content.decode("utf-8", "replace").split("\n")
        found = _content(lines[0])
        named = found.get("format") if isinstance(found, dict) else None
        if isinstance(named, str) and named != FORMAT and named.startswith(FORMAT.rstrip("0123456789")):
            raise OutputError(f"{self.path}: {another_format(named, FORMAT)}")
        if named != FORMAT:
            raise DamagedFileError(f"{self.path} holds no scan that can be read. Start over with fresh=True.")
        if found != head:
            names = [name for name in head if found.get(name) != head[name]]
            raise OutputError(
                f"{self.path} holds another scan: {', '.join(names) or 'its description'} differs. Choose another "
                "store, or discard it with fresh=True."
            )
        for line in lines[1:]:
            try:
                said = _content(line, self._scan) or {}
                self.known |= {int(point): _result(record) for point, record in said.items()}
            except (ArithmeticError, ValueError, TypeError, AttributeError):  # it had a right sum, and is none of ours
                continue
        if not content.endswith(b"\n"):
            with writing(self.path), self.path.open("ab") as stream:
                stream.write(b"\n")

    def keep(self, results: Mapping[int, PointResult]) -> None:
        """Add points; one whose process failed is tried again next time."""
        if records := {str(k): _record(r) for k, r in results.items() if r.outcome != "failed"}:
            with writing(self.path), self.path.open("a", encoding="utf-8") as stream:
                stream.write(_line(records, self._scan))
                stream.flush()
                os.fsync(stream.fileno())


def _line(content: Any, scan: str = "") -> str:
    text = scan + json.dumps(content, separators=(",", ":"))
    return f"{crc32(text.encode()):08x} {text}\n"


def _content(line: str, scan: str = "") -> Any:
    """What a line says, or None."""
    total, _, text = line.partition(" ")
    if total != f"{crc32(text.encode()):08x}" or not text.startswith(scan):
        return None
    try:
        return json.loads(text.removeprefix(scan))
    except (ValueError, RecursionError):
        return None


def _record(result: PointResult) -> list[Any]:
    found = [[[str(c), list(m)] for m, c in polynomial.items()] for polynomial in result.found]
    return [result.outcome, result.n_further, found]


def _result(record: list[Any]) -> PointResult:
    outcome, n_further, found = record
    if outcome not in OUTCOMES:
        raise ValueError("another outcome")
    polynomials = tuple({tuple(map(int, m)): number(c) for c, m in polynomial} for polynomial in found)
    return PointResult(outcome, int(n_further), polynomials)
