"""The command `liepoisson cite`: what to cite in published work."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any

import typer

from liepoisson.errors import ParameterError


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
