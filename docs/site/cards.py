"""The cards of the gallery, from their scripts: docs/gallery/NAME.py has title, text and links in its docstring.

The first paragraph is the title, the last says what to read; NAME.png beside the script is its picture.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import NamedTuple


class Card(NamedTuple):
    """What a script says."""

    title: str
    seen: str
    read: str
    code: str


def card(script: Path) -> Card:
    """Title, what is seen, what to read, and the code without its docstring."""
    text = script.read_text(encoding="utf-8")
    tree = ast.parse(text)
    title, *seen, read = (ast.get_docstring(tree) or "").split("\n\n")
    code = "".join(text.splitlines(keepends=True)[tree.body[0].end_lineno :]).lstrip("\n")
    return Card(title.rstrip("."), "\n\n".join(seen), read, code)


def card_page(script: Path) -> str:
    """The page of a card, as Markdown: the picture, what is seen, the code, what to read."""
    title, seen, read, code = card(script)
    picture = f"![{plain(title)}]({script.stem}.png)"
    return f"# {title}\n\n{picture}\n\n{seen}\n\n```python\n{code}```\n\n{read}\n\n[All cards](index.md)\n"


def plain(title: str) -> str:
    """A title without the signs of Markdown and mathematics, for those who do not see the picture."""
    return re.sub(r"[$\\_{}^`]", "", title)
