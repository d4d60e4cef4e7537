"""The site: what goes into it, and that its checker finds what is wrong.  Building it is `make docs-check`."""

import re
import shutil
from pathlib import Path

import pytest

from script_folders import modules_of

ROOT = Path(__file__).parent.parent
TOOLS = ROOT / "docs" / "site"


check, command_pages, name_pages, staging = modules_of(TOOLS, "check", "command_pages", "name_pages", "staging")


def test_every_page_has_its_row_in_the_table_of_contents():
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    listed = [page for rows in staging.groups(index).values() for _, page in rows]
    pages = {(ROOT / "docs" / page).resolve() for page in listed}
    cards = {path for path in staging.documents() if path.parent.name == "gallery" and path.name != "index.md"}
    wanted = set(staging.documents()) - cards - {ROOT / "docs" / "index.md"}
    assert pages == wanted
    assert len(listed) == len(set(listed))


def test_every_chapter_is_in_one_group_and_every_name_has_one_page():
    assert sorted(chapter for group in name_pages.GROUPS.values() for chapter in group) == sorted(name_pages.chapters())
    pages = [one.page.lower() for one in name_pages.names() if one.chapter != "errors"]
    assert len(pages) == len(set(pages))  # also where files differ in more than the case of letters


def page_of(long):
    return next(name_pages.name_page(one) for one in name_pages.names() if one.long == long)


def test_a_name_at_the_top_has_one_entry():
    page = page_of("lp.orbits.integrate")
    assert re.findall(r"\{py:(\w+)\} ([\w.]+)\(", page) == [("function", "lp.integrate")]
    assert ":canonical: lp.orbits.integrate" in page
    assert "-> lp.results.Orbit" in page


def test_every_argument_of_a_docstring_is_an_entry():
    page = page_of("lp.methods.Taylor")
    assert re.findall(r"^`(\w+)`$", page, re.MULTILINE) == ["tol", "order", "precision", "max_steps", "ParameterError"]


def test_every_option_of_a_command_is_an_entry():
    from typer.main import get_command

    from liepoisson.cli.main import COMMANDS, application

    whole = get_command(application())
    for name in COMMANDS:
        text = command_pages.page(name, whole.commands[name])
        for parameter in whole.commands[name].params:
            if parameter.param_type_name == "option" and not parameter.hidden:
                assert re.search(rf"^`[^`]*{parameter.opts[0]}\b", text, re.MULTILINE), f"{name}: {parameter.opts[0]}"


def test_links_lead_to_pages_and_code_is_left_as_it_is(tmp_path):
    stage = staging.Stage(tmp_path / "source")
    stage.fill()
    text = (tmp_path / "source" / "getting-started.md").read_text(encoding="utf-8")
    assert "(readme.md#set-up)" in text
    assert "](../" not in staging.outside_code(text, lambda part: part)
    entry = (
        tmp_path / "source" / "source" / "python" / "liepoisson" / "catalog" / "kepler-on-the-sphere.toml.md"
    ).read_text()
    assert "nosearch: true" in entry
    assert 'savefig("fluid.png")' in (tmp_path / "source" / "gallery" / "fluid.md").read_text(encoding="utf-8")
    assert staging.outside_code("`[a](b)` [a](b)", lambda part: part.replace("b", "c")) == "`[a](b)` [a](c)"


GOOD = '<html><body id="here"><a href="#here">x</a><a href="other.html#there">y</a><a href="https://x.org">z</a></body></html>'


@pytest.mark.parametrize(
    ("file", "text", "complaint"),
    [
        ("a.html", '<img src="https://x.org/a.png">', "loads https://x.org/a.png"),
        ("a.html", '<script src="//x.org/a.js"></script>', "loads //x.org/a.js"),
        ("a.html", "<style>@import 'https://x.org/a.css'</style>", "a style loads"),
        ("a.html", '<p style="background: url(https://x.org/a.png)">', "a style loads"),
        ("a.html", "<script>fetch('https://x.org')</script>", "a script loads"),
        ("a.css", "p { background: url(//x.org/a.png) }", "loads from another host"),
        ("a.js", 's.src = "https://x.org/a.js"', "loads from another host"),
        ("a.html", '<a href="none.html">x</a>', "does not exist"),
        ("a.html", '<a href="other.html#none">x</a>', "no such anchor"),
        ("a.html", '<a href="../outside.html">x</a>', "does not exist"),
    ],
)
def test_the_checker_finds_what_is_wrong(tmp_path, file, text, complaint):
    site = tmp_path / "site"
    site.mkdir()
    (tmp_path / "outside.html").write_text(GOOD)
    (site / "index.html").write_text(GOOD)
    (site / "other.html").write_text('<p id="there">x</p>')
    assert check.check_files(site) == []
    (site / file).write_text(text)
    (found,) = check.check_files(site)
    assert complaint in found
    shutil.rmtree(site)
    assert check.check_files(site) != []
