"""Makes CITATION.cff of what the package says how to cite it. Run it when the version or the data are new.

python docs/citation_file.py
"""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import indent

from liepoisson import __version__
from liepoisson.saved.citation import data

FILE = Path(__file__).parents[1] / "CITATION.cff"


def text() -> str:
    """The text of CITATION.cff, in the Citation File Format 1.2.0."""
    what = data()
    lines = [
        "cff-version: 1.2.0",
        f"message: {_quoted(what['message'])}",
        f"title: {_quoted(what['package']['title'])}",
        "type: software",
        f"version: {__version__}",
        "license:",
        *(f"  - {name}" for name in what["license"]),
        "authors:",
        f"  - name: {what['package']['group']}",
        "abstract: >-",
        indent(what["abstract"].strip(), "  "),
        "keywords:",
        *(f"  - {word}" for word in what["keywords"]),
        "references:",
    ]
    for work in what["work"]:
        lines += ["  - type: article", f"    title: {_quoted(work['title'])}", "    authors:"]
        for given, family in work["authors"]:
            lines += [f"      - given-names: {given}", f"        family-names: {family}"]
        lines += [f"    {name}: {work[name]}" for name in ("journal", "volume", "start", "year")]
        lines += ["    identifiers:", "      - type: other", f"        value: arXiv:{work['arxiv']}"]
    return "\n".join(lines) + "\n"


def _quoted(words: str) -> str:
    """A text of YAML, which reads quotes as JSON does."""
    return json.dumps(words, ensure_ascii=False)


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
