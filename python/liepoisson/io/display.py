"""What a terminal and a notebook show of things that are lists, tables or plain texts."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from html import escape
from typing import TypeVar, overload

T = TypeVar("T")


class ShownList(Sequence[T]):
    """What a search has found, a sequence: a line says what it is, and a table has a row for each item."""

    found: tuple[T, ...]

    @abstractmethod
    def _head(self) -> str:
        """The line."""

    @abstractmethod
    def _rows(self) -> list[tuple[str, ...]]:
        """The table, the first row its head."""

    @overload
    def __getitem__(self, index: int) -> T: ...
    @overload
    def __getitem__(self, index: slice) -> list[T]: ...
    def __getitem__(self, index: int | slice) -> T | list[T]:
        """One of them, or a list of several."""
        return list(self.found[index]) if isinstance(index, slice) else self.found[index]

    def __len__(self) -> int:
        """How many."""
        return len(self.found)

    def __repr__(self) -> str:
        rows = self._rows()
        widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
        table = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
        return "\n".join([self._head(), *table] if self.found else [self._head()])

    def _repr_html_(self) -> str:
        """What a notebook shows: the line and the table."""
        return as_line(self._head()) + as_table(self._rows())


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
