"""The pictures of the pages are those that the code would draw today."""

import runpy
from pathlib import Path

import pytest
from PIL import Image

DOCS = Path(__file__).parent.parent / "docs"
RECIPE = runpy.run_path(str(DOCS / "figures" / "commands.py"))


@pytest.mark.thorough
@pytest.mark.parametrize("name", RECIPE["COMMANDS"])
def test_pictures_of_commands_show_what_the_commands_draw(name):
    shown = RECIPE["content"](RECIPE["figure_of"](RECIPE["COMMANDS"][name]))
    with Image.open(DOCS / "images" / name) as picture:
        assert picture.text[RECIPE["KEY"]] == shown, "python docs/figures/commands.py draws it again"


def test_pictures_of_commands_stand_below_their_commands():
    page = (DOCS / "command-line.md").read_text(encoding="utf-8")
    for name, command in RECIPE["COMMANDS"].items():
        before = page[: page.index(f"(images/{name})")]
        assert f"```sh\n{command}\n" in before[before.rindex("\n#") :]
