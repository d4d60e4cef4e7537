"""The commands `catalog` and `cite`: the named systems of the literature, and what to cite in published work."""

from __future__ import annotations

import json
import re
from enum import StrEnum
from typing import Annotated, Any

import typer

from liepoisson.cli.options import Format, FormatOption
from liepoisson.errors import ParameterError


def catalog(*, format_: FormatOption = Format.TEXT) -> None:
    """List the named systems of the literature.

    Each name with its first source; the commands take such a name for SYSTEM.

    The JSON is a list of objects with name, description, source and the path of the file.
    """
    from liepoisson.catalog import names, path

    entries = [_heads(path(name)) for name in names()]
    if format_ is Format.JSON:
        print(json.dumps(entries, indent=2, ensure_ascii=True))
        return
    width = max(len(entry["name"]) for entry in entries)
    for entry in entries:
        print(f"{entry['name']:<{width}}  {short_source(entry['source'])}")


def short_source(source: str) -> str:
    """Authors and year of the first work that a citation names: "Thiffeault and Morrison (2001)".

    A citation begins with authors such as "J.-L. Thiffeault and P. J. Morrison"; another beginning is kept as it is.
    """
    first = source.partition(";")[0]
    given = r"(?:[A-ZÀ-Þ]\.(?:-[A-Z]\.)? ?)+"
    author = rf"{given}([A-ZÀ-Þ][\w’'-]+)(?: \(\d{{4}}\)(?= and ))?"
    authors = re.match(rf"{author}(?:(?:, | and ){author})*", first)
    year = re.search(r"\((\d{4})\)", first)
    if authors is None or year is None:
        return first if len(first) <= 60 else first[:57] + "..."
    surnames = re.findall(author, authors.group())
    listed = " and ".join(filter(None, (", ".join(surnames[:-1]), surnames[-1])))
    return f"{listed} ({year.group(1)})"


def _heads(file: Any) -> dict[str, str]:
    """What the list needs of a file; its mathematics is not read."""
    import tomllib

    with file.open("rb") as stream:
        table = tomllib.load(stream)
    one_line = {key: " ".join(str(table.get(key, "")).split()) for key in ("name", "description", "source")}
    return {**one_line, "path": str(file)}


class CitationFormat(StrEnum):
    """How references are printed."""

    TEXT = "text"
    BIBTEX = "bibtex"


def cite(
    *,
    used: Annotated[
        list[str] | None,
        typer.Argument(help="Names of the catalog, system files (.toml) and results (.nc).", metavar="[USED]..."),
    ] = None,
    format_: Annotated[
        CitationFormat, typer.Option("--format", help="For people, or for a file of references.")
    ] = CitationFormat.TEXT,
) -> None:
    """Print how to cite liepoisson, and the works that describe what was used."""
    from liepoisson.saved import citation as references

    citation = references.cite(*(_used(name) for name in used or ()))
    print(citation.text if format_ is CitationFormat.TEXT else citation.bibtex)


def _used(name: str) -> Any:
    """What an argument names."""
    if not name.strip():
        raise ParameterError("USED: wanted a name of the catalog or a file; got an empty text. Leave it out.")
    if name.endswith(".toml"):
        from liepoisson.model.system_file_reader import read_system_file

        return read_system_file(name)
    if name.endswith(".nc"):
        from liepoisson.saved.rerun import load

        return load(name)
    return name
