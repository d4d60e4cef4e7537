"""Pictures of pages are those that scripts and commands draw today; pages are in step with them."""

import re
import runpy
from pathlib import Path

import pytest
from PIL import Image

from script_folders import modules_of

FOLDER = Path(__file__).parent.parent / "docs" / "gallery"
DOCS = FOLDER.parent
RECIPE = runpy.run_path(str(DOCS / "figures" / "commands.py"))
GALLERY = runpy.run_path(str(FOLDER / "make.py"))
(cards,) = modules_of(FOLDER.parent / "site", "cards")
card_page = cards.card_page
NAMES = GALLERY["NAMES"]
QUICK = ("rattleback", "attitude", "sphere", "structure")
"""A tenth of the cards, among the fastest, and always the same: a failure is repeated. The slow tests run all."""

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def differs(shown, drawn):
    """Whether two contents differ: words must be the same, numbers agree to 1%, places to 1% of the axes.

    On another machine starts may differ in their last bit, and chaos makes of that another orbit of the same sea.
    """
    if NUMBER.sub("#", shown) != NUMBER.sub("#", drawn):
        return True
    pairs = zip(map(float, NUMBER.findall(shown)), map(float, NUMBER.findall(drawn)), strict=True)
    return any(abs(a - b) > 0.01 * max(1, abs(a)) for a, b in pairs)


def compare(name):
    drawn = GALLERY["content"](GALLERY["figure_of"](name))
    with Image.open(FOLDER / f"{name}.png") as picture:
        shown = picture.text[GALLERY["KEY"]]
    assert not differs(shown, drawn), f"python docs/gallery/make.py {name} draws it again\n{shown}\n{drawn}"


@pytest.mark.thorough
@pytest.mark.parametrize("name", QUICK)
def test_a_tenth_of_the_pictures_show_what_the_scripts_draw(name):
    compare(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_all_pictures_show_what_the_scripts_draw(name):
    compare(name)


def test_every_script_has_its_place_in_the_index():
    scripts = {path.stem for path in FOLDER.glob("*.py")} - {"make"}
    assert sorted(NAMES) == sorted(scripts)
    assert {path.stem for path in FOLDER.glob("*.png")} == scripts
    assert (FOLDER / "index.md").read_text(encoding="utf-8") == GALLERY["index"]()


@pytest.mark.parametrize("name", [*NAMES, "index"])
def test_links_lead_to_pages_headings_and_references(name):
    page = card_page(FOLDER / f"{name}.py") if name in NAMES else (FOLDER / "index.md").read_text(encoding="utf-8")
    for words, target in re.findall(r"\[([^\]]*)\]\(([^)\s]+)\)", page):
        path, _, heading = target.partition("#")
        file = FOLDER / path
        assert file.exists(), target
        text = file.read_text(encoding="utf-8") if file.suffix == ".md" else ""
        titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
        anchors = {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}
        assert not heading or heading in anchors, target
        assert file.name != "references.md" or f"**[{words}]**" in text, words


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
