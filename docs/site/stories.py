"""Stories as pages: a stored notebook as Markdown, with what its cells printed and drew; nothing is run."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

MATH = re.compile(r"^\$+(?:\\displaystyle)?\s*(.*?)\$+$", re.DOTALL)


def story_text(notebook: Path) -> str:
    """The cells of a notebook one after the other, and below the title where to get the notebook itself."""
    parts: list[str] = []
    for number, cell in enumerate(json.loads(notebook.read_text(encoding="utf-8"))["cells"], start=1):
        source = _joined(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
        else:
            parts.append(_fenced("python", source))
            parts += [_output(one, notebook, number, cell["metadata"].get("alt", "")) for one in cell["outputs"]]
        if number == 1:
            parts.append(
                f"*A notebook, with what it printed and drew. [Download it]({notebook.name}) to run it in Jupyter.*"
            )
    return "\n\n".join(parts) + "\n"


def story_pictures(notebook: Path) -> dict[str, bytes]:
    """The pictures of a notebook, by the names that its page gives them."""
    cells = enumerate(json.loads(notebook.read_text(encoding="utf-8"))["cells"], start=1)
    return {
        _picture(notebook, number): base64.b64decode(_joined(output["data"]["image/png"]))
        for number, cell in cells
        for output in cell.get("outputs", ())
        if "image/png" in output.get("data", ())
    }


def _output(output: dict[str, Any], notebook: Path, number: int, alt: str) -> str:
    if "text" in output:
        return _fenced("text", _joined(output["text"]))
    data = output["data"]
    if "image/png" in data:
        return f"![{alt}]({_picture(notebook, number)})"
    if "text/latex" in data:
        return "$$\n" + MATH.sub(r"\1", _joined(data["text/latex"]).strip()) + "\n$$"
    return _fenced("text", _joined(data["text/plain"]))


def _picture(notebook: Path, number: int) -> str:
    return f"{notebook.stem}-{number}.png"


def _fenced(language: str, text: str) -> str:
    fence = "`" * (1 + max([2, *(len(run) for run in re.findall(r"`+", text))]))
    return f"{fence}{language}\n{text.rstrip()}\n{fence}"


def _joined(pieces: str | list[str]) -> str:
    return pieces if isinstance(pieces, str) else "".join(pieces)
