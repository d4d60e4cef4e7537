"""The stories: `python docs/stories/make.py [NAME ...]` runs the notebooks and stores what they print, by default all.

A story is a notebook.  Change it in Jupyter or in any editor, then run this script: it runs the notebook from its first
cell in a new kernel, in a folder that is thrown away, and stores it without what differs from one run to the next.
So what is stored changes only where what is printed or drawn does.  `--out FOLDER` writes it to another place.

Running needs ipykernel and nbclient (pip install --require-hashes -r requirements/notebooks.txt), all else neither.
"""

from __future__ import annotations

import argparse
import base64
import contextlib
import io
import json
import os
import re
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from PIL import Image

FOLDER = Path(__file__).parent
NAMES = ("the-paper-in-an-hour", "from-a-hamiltonian-to-a-verdict", "from-laptop-to-cluster")
"""In the order in which they are read."""

METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
CELL_METADATA = ("alt",)
"""What a cell may say of itself: `alt`, its picture in words, for those who do not see it."""

SHOWN = ("image/png", "text/latex", "text/plain")
"""Forms of an output, best first; only the best is stored."""

COLOURS = 256
"""Of the palette of a picture, which makes it three times smaller."""

KERNEL = """
c.InlineBackend.print_figure_kwargs = {"dpi": 150, "bbox_inches": None}
c.HistoryManager.enabled = False
c.IPKernelApp.log_level = "ERROR"
"""
"""Settings of the kernel: figures have the size that they ask for; it does not warn that it listens on this machine."""

CHANGES = {
    "an address in memory": r"\b0x[0-9a-f]{6,}\b",
    "an absolute path": r"(?<![\w.:/])/(?:home|tmp|usr|root|work|private|Users|var)/",
    "a time of the clock": r"\b\d\d:\d\d:\d\d\b",
}
"""What an output must not have, since the next run prints another one."""


def read(path: Path) -> dict[str, Any]:
    """A notebook as data."""
    return json.loads(path.read_text(encoding="utf-8"))


def written(notebook: dict[str, Any]) -> str:
    """The text of the file of a notebook."""
    return json.dumps(notebook, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def run(notebook: dict[str, Any], *, timeout: float = 300) -> dict[str, Any]:
    """The notebook with what its cells print and draw now; it runs in a new kernel and in a folder of its own."""
    import nbformat
    from nbclient import NotebookClient

    with quiet_place() as place:
        ready = nbformat.reads(json.dumps(notebook), as_version=4)
        NotebookClient(ready, timeout=timeout, resources={"metadata": {"path": str(place)}}).execute()
        return normalised(json.loads(nbformat.writes(ready)))


@contextlib.contextmanager
def quiet_place() -> Iterator[Path]:
    """An empty folder, and settings by which a kernel reads and writes nothing of the user's."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        place = Path(folder)
        profile = place / "ipython" / "profile_default"
        profile.mkdir(parents=True)
        (profile / "ipython_kernel_config.py").write_text(KERNEL, encoding="utf-8")
        (place / "work").mkdir()
        settings = {f"JUPYTER_{name}_DIR": str(place / name.lower()) for name in ("CONFIG", "DATA", "RUNTIME")}
        settings |= {"IPYTHONDIR": str(place / "ipython"), "LIEPOISSON_PROGRESS": "0"}
        before = dict(os.environ)
        os.environ.update(settings)
        for name in ("MPLBACKEND", "LIEPOISSON_SIMD"):
            os.environ.pop(name, None)
        try:
            yield place / "work"
        finally:
            os.environ.clear()
            os.environ.update(before)


def normalised(notebook: dict[str, Any]) -> dict[str, Any]:
    """The notebook without what differs from run to run; raises ValueError where an output cannot be freed of it."""
    cells, count = [], 0
    for cell in notebook["cells"]:
        kept: dict[str, Any] = {name: cell[name] for name in ("cell_type", "id")}
        kept["source"] = text_of(cell["source"]).strip("\n").splitlines(keepends=True)
        kept["metadata"] = {name: value for name, value in cell["metadata"].items() if name in CELL_METADATA}
        if cell["cell_type"] == "code":
            count += 1
            kept["execution_count"] = count
            kept["outputs"] = outputs(cell["outputs"], count)
        cells.append(kept)
    return {"cells": cells, "metadata": METADATA, "nbformat": 4, "nbformat_minor": 5}


def outputs(given: list[dict[str, Any]], count: int) -> list[dict[str, Any]]:
    """The outputs of a cell: what it printed in one piece, then formulas and pictures."""
    kept: list[dict[str, Any]] = []
    for output in given:
        kind = output["output_type"]
        if kind == "error" or output.get("name") == "stderr":
            raise ValueError(
                f"cell {count}: {output.get('ename', 'stderr')}: {output.get('evalue', output.get('text'))}"
            )
        if kind == "stream":
            before = text_of(kept.pop()["text"]) if kept and kept[-1]["output_type"] == "stream" else ""
            text = before + text_of(output["text"])
            kept.append({"name": "stdout", "output_type": "stream", "text": text.splitlines(keepends=True)})
        else:
            kept.append({"data": data(output["data"]), "metadata": {}, "output_type": kind})
            if kind == "execute_result":
                kept[-1]["execution_count"] = count
    for text in (shown(output) for output in kept):
        for what, pattern in CHANGES.items():
            if match := re.search(pattern, text):
                raise ValueError(f"cell {count} prints {what}: {match[0]}")
    return kept


def data(given: dict[str, Any]) -> dict[str, Any]:
    """The best form of an output."""
    best = next(form for form in SHOWN if form in given)
    if best == "image/png":
        return {best: base64.b64encode(small(base64.b64decode(text_of(given[best])))).decode("ascii")}
    return {best: text_of(given[best]).splitlines(keepends=True)}


def small(png: bytes) -> bytes:
    """The same picture with a palette, and without the name and the version of the program that drew it."""
    with Image.open(io.BytesIO(png)) as picture:
        if picture.mode == "P":
            return png
        few = picture.convert("RGB").quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    buffer = io.BytesIO()
    few.save(buffer, format="png", optimize=True)
    return buffer.getvalue()


def shown(output: dict[str, Any]) -> str:
    """What an output says in words or as a formula; pictures say nothing."""
    if "text" in output:
        return text_of(output["text"])
    return "".join(text_of(content) for form, content in output["data"].items() if form != "image/png")


def text_of(pieces: str | list[str]) -> str:
    """A text that a notebook holds as one string or as lines."""
    return pieces if isinstance(pieces, str) else "".join(pieces)


def main() -> int:
    """Run what the command line names."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", choices=[[], *NAMES], metavar="NAME", help=", ".join(NAMES))
    parser.add_argument("--out", type=Path, default=FOLDER, help="where to write the notebooks")
    given = parser.parse_args()
    for name in given.names or NAMES:
        began = time.perf_counter()
        text = written(run(read(FOLDER / f"{name}.ipynb")))
        (given.out / f"{name}.ipynb").write_text(text, encoding="utf-8")
        print(f"{name}: {time.perf_counter() - began:.0f} s, {len(text) / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
