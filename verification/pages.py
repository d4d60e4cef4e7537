"""The page of the audit: tables between markers, written from results."""

from __future__ import annotations

import re
from pathlib import Path


class MissingMarkerError(Exception):
    """The page has no place for a table."""


def put(page: Path, name: str, text: str) -> None:
    """Replace what stands between `<!-- audit: name -->` and `<!-- end: name -->`.

    Raises:
        MissingMarkerError: The page does not have both markers, once each and in order.
        OSError: The page cannot be read or written.
    """
    begin, end = f"<!-- audit: {name} -->", f"<!-- end: {name} -->"
    parts = re.split(f"({re.escape(begin)}|{re.escape(end)})", page.read_text(encoding="utf-8"))
    if parts[1::2] != [begin, end]:
        raise MissingMarkerError(f"{page.name}: wanted the lines {begin} and {end}, once each; got {parts[1::2]}")
    page.write_text(f"{parts[0]}{begin}\n{text.rstrip()}\n{end}{parts[4]}", encoding="utf-8")
