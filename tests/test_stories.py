"""The stories: stored notebooks without errors and without what changes from run to run; they print the same today."""

import base64
import copy
import importlib.util
import io
import json
import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import liepoisson as lp
from script_folders import modules_of
from test_docs import LINK, SPAN, attribute, difference, headings

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "stories"
STORIES = runpy.run_path(str(FOLDER / "make.py"))
NAMES = STORIES["NAMES"]
MISSING = [name for name in ("ipykernel", "nbclient") if importlib.util.find_spec(name) is None]
staging, stories = modules_of(ROOT / "docs" / "site", "staging", "stories")


def stored(name):
    return STORIES["read"](FOLDER / f"{name}.ipynb")


def cells(name, kind):
    return [cell for cell in stored(name)["cells"] if cell["cell_type"] == kind]


def texts(cell):
    """What a cell says in words, one text for each output."""
    return [STORIES["shown"](output) for output in cell["outputs"] if "image/png" not in output.get("data", {})]


def pictures(cell):
    return [
        Image.open(io.BytesIO(base64.b64decode(output["data"]["image/png"])))
        for output in cell["outputs"]
        if "image/png" in output.get("data", {})
    ]


def how_far(one, other):
    """The mean difference of two pictures, 0 where they are the same and 1 between black and white."""
    first, second = (np.asarray(picture.convert("RGB"), dtype=float) / 255 for picture in (one, other))
    assert first.shape == second.shape
    return np.abs(first - second).mean()


@pytest.mark.slow
@pytest.mark.skipif(
    bool(MISSING),
    reason=f"{' and '.join(MISSING)} not installed: pip install --require-hashes -r requirements/notebooks.txt",
)
@pytest.mark.parametrize("name", NAMES)
def test_a_story_prints_and_draws_what_is_stored(name, tmp_path):
    command = [sys.executable, str(FOLDER / "make.py"), name, "--out", str(tmp_path)]
    run = subprocess.run(command, check=False, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    now = STORIES["read"](tmp_path / f"{name}.ipynb")
    assert len(now["cells"]) == len(stored(name)["cells"])
    for before, after in zip(stored(name)["cells"], now["cells"], strict=True):
        if before["cell_type"] == "markdown":
            continue
        where = f"{name}, cell {before['execution_count']}"
        assert len(texts(before)) == len(texts(after)), where
        for shown, printed in zip(texts(before), texts(after), strict=True):
            wrong = difference(shown, printed)
            again = f"python docs/stories/make.py {name} stores what is printed now"
            assert wrong is None, f"{where}: {wrong}\n{again}\nshown:\n{shown}\nprinted:\n{printed}"
        for shown, drawn in zip(pictures(before), pictures(after), strict=True):
            # Where starts differ in their last bit, chaotic orbits are others, and so are their points.
            assert how_far(shown, drawn) < 0.001, where


@pytest.mark.parametrize("name", NAMES)
def test_the_stored_notebook_has_nothing_that_changes_from_run_to_run(name):
    text = (FOLDER / f"{name}.ipynb").read_text(encoding="utf-8")
    notebook = json.loads(text)
    assert STORIES["written"](STORIES["normalised"](copy.deepcopy(notebook))) == text
    assert [cell["execution_count"] for cell in cells(name, "code")] == list(range(1, len(cells(name, "code")) + 1))
    assert len({cell["id"] for cell in notebook["cells"]}) == len(notebook["cells"])
    shown = [output for cell in cells(name, "code") for output in cell["outputs"]]
    assert {form for output in shown for form in output.get("data", ())} <= set(STORIES["SHOWN"])


def test_every_notebook_of_the_folder_is_a_story():
    assert sorted(NAMES) == sorted(path.stem for path in FOLDER.glob("*.ipynb"))


@pytest.mark.parametrize("name", NAMES)
def test_links_lead_to_pages_and_headings_and_names_exist(name):
    prose = "\n".join(STORIES["text_of"](cell["source"]) for cell in cells(name, "markdown"))
    for target in LINK.findall(SPAN.sub("", prose)):
        path, _, heading = target.partition("#")
        file = (FOLDER / path).resolve()
        assert file.exists(), target
        assert not heading or heading in headings(file), target
    for dotted in re.findall(r"\blp((?:\.\w+)+)", " ".join(SPAN.findall(prose))):
        here = lp
        for part in dotted.strip(".").split("."):
            here = attribute(here, part, f"{name}: lp{dotted} does not exist")


def code_cell(*outputs):
    cell = {"cell_type": "code", "id": "one", "source": ["1"], "metadata": {"alt": "x", "collapsed": True}}
    cell |= {"execution_count": 7, "outputs": list(outputs)}
    return {"cells": [cell], "metadata": {"language_info": {"version": "3.11.7"}}}


@pytest.mark.parametrize(
    ("output", "complaint"),
    [
        ({"output_type": "error", "ename": "ValueError", "evalue": "no", "traceback": []}, "ValueError: no"),
        ({"output_type": "stream", "name": "stderr", "text": "a warning"}, "a warning"),
        ({"output_type": "stream", "name": "stdout", "text": "<object at 0x7f3a2b1c>"}, "an address in memory"),
        ({"output_type": "stream", "name": "stdout", "text": "/tmp/x/map.zarr"}, "an absolute path"),
        ({"output_type": "stream", "name": "stdout", "text": "at 12:30:05"}, "a time of the clock"),
    ],
)
def test_what_cannot_be_stored_is_refused(output, complaint):
    with pytest.raises(ValueError, match=complaint):
        STORIES["normalised"](code_cell(output))
