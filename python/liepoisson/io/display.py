"""What a notebook shows of things that are tables or plain texts, as HTML."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape


def as_line(text: str) -> str:
    """One line of text, such as a repr."""
    return f"<p><code>{escape(text)}</code></p>"


def as_text(text: str) -> str:
    """Lines of text whose blanks matter."""
    return f"<pre>{escape(text)}</pre>"


def as_table(rows: Sequence[Sequence[str]]) -> str:
    """A table, the first row its head; nothing if there is no other row."""
    if len(rows) < 2:
        return ""
    head, *body = ["".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in row) for tag, row in _tagged(rows)]
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(f'<tr>{row}</tr>' for row in body)}</tbody></table>"


def _tagged(rows: Sequence[Sequence[str]]) -> list[tuple[str, Sequence[str]]]:
    return [("td" if k else "th", row) for k, row in enumerate(rows)]
