"""What is shown of things that are tables or plain texts: as text, and in a notebook as HTML."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from html import escape
from typing import ClassVar, TypeVar, overload

T = TypeVar("T")


class Found(Sequence[T]):
    """What a search found, in its order; shown as one sentence about the search and a table with a row for each."""

    found: tuple[T, ...]
    titles: ClassVar[tuple[str, ...]]
    """The head of the table."""
    most_rows: ClassVar[int | None] = 60
    """Rows that are shown, all if None."""

    @abstractmethod
    def _head(self) -> str:
        """The sentence."""

    @abstractmethod
    def _row(self, one: T, /) -> tuple[str, ...]:
        """The row of one of them."""

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
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        table = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
        return "\n".join([self._head(), *table] if self.found else [self._head()])

    def _repr_html_(self) -> str:
        """What a notebook shows: a line and a table."""
        return as_line(self._head()) + as_table(self._rows())

    def _rows(self) -> list[tuple[str, ...]]:
        rows = [self.titles, *map(self._row, self.found[: self.most_rows])]
        if more := len(self.found) + 1 - len(rows):
            rows.append((f"and {more} more", *[""] * (len(self.titles) - 1)))
        return rows


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
