"""Formats of stored files: what is said where one has another format than this version reads; docs/saved-results.md."""

from __future__ import annotations


def another_format(found: object, wanted: object, writer: object = None) -> str:
    """The sentence that refuses a file of another format, with the version that reads it.

    Args:
        found: The format that the file names.
        wanted: The one that this version reads.
        writer: The version of liepoisson that the file names; None where files of its kind name none.
    """
    from liepoisson._core import __version__ as version

    if writer is None:
        by = ""
    elif writer == version:  # a format changes between two released versions only
        by = f" (a state of {version} before its release)"
    else:
        by = f" ({writer!s:.60})"
    return (
        f"it has the format {found!s:.60}, and liepoisson {version} reads {wanted} alone; read it with the liepoisson "
        f"that wrote it{by}, or make it again"
    )
