"""The site: what goes into it, and that its checker finds what is wrong.  Building it is `make docs-check`."""

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
