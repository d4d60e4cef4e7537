"""The script that is asked before a release finds what is wrong; docs/releasing.md."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

import liepoisson as lp
from script_folders import modules_of

ROOT = Path(__file__).parent.parent
(release,) = modules_of(ROOT / ".ci", "release")
FILES = ("Cargo.toml", "Cargo.lock", "CHANGELOG.md", "CITATION.cff", "web/src/data/tops.json", "Makefile")
VERSION = release.version_of(ROOT)
TAG = f"v{VERSION}"
QUICK = ["version", "changelog", "citation", "tree", "unused"]


@pytest.fixture
def copy(tmp_path):
    """The files that the quick checks read, released today, in a repository of their own."""
    for name in FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    changed(tmp_path / "CHANGELOG.md", rf"^## {re.escape(VERSION)} .*$", f"## {VERSION} (2026-01-31)")
    git(tmp_path, "init", "-q")
    committed(tmp_path)
    return tmp_path


def git(root, *arguments):
    who = ("-c", "user.name=A Tester", "-c", "user.email=tester@example.org", "-c", "commit.gpgsign=false")
    subprocess.run(["git", *who, *arguments], cwd=root, check=True, capture_output=True)


def committed(root):
    git(root, "add", ".")
    git(root, "commit", "-q", "-m", "State")


def changed(path, pattern, text):
    before = path.read_text(encoding="utf-8")
    after, n = re.subn(pattern, text, before, count=1, flags=re.MULTILINE)
    assert n == 1, f"{pattern} is not in {path.name}"
    path.write_text(after, encoding="utf-8")


def test_what_is_right_is_ready(copy, capsys):
    assert release.main(["--only", *QUICK], root=copy) == 0
    assert capsys.readouterr().out.count("ok ") == len(QUICK)


def test_the_version_of_this_tree_is_everywhere_the_same():
    assert lp.__version__ == VERSION
    assert release.version(ROOT, TAG) == []
    assert release.citation(ROOT, TAG) == []


WRONG = {
    "a crate of another version": (
        "version",
        "Cargo.lock",
        r'(name = "liepoisson-wasm"\nversion = )".*"',
        r'\1"9.9.9"',
    ),
    "a page of another version": ("version", "web/src/data/tops.json", '"package":"[^"]*"', '"package":"9.9.9"'),
    "a version that is none": ("version", "Cargo.toml", r'^version = ".*"', 'version = "1.0"'),
    "no date": ("changelog", "CHANGELOG.md", r"\(2026-01-31\)", "(unreleased)"),
    "a date that is none": ("changelog", "CHANGELOG.md", "2026-01-31", "2026-02-31"),
    "a date to come": ("changelog", "CHANGELOG.md", "2026-01-31", "2999-01-31"),
    "a section of another version first": (
        "changelog",
        "CHANGELOG.md",
        "^## ",
        "## 9.9.9 (2026-01-31)\n\n- One.\n\n## ",
    ),
    "a section with nothing in it": ("changelog", "CHANGELOG.md", r"(^## .*\n)", r"\1\n## 0.0.1 (2025-01-31)\n"),
    "a citation of another version": ("citation", "CITATION.cff", "^version: .*", "version: 9.9.9"),
    "a citation of none": ("citation", "CITATION.cff", "^version: .*\n", ""),
}


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_found_by_its_check(copy, capsys, wrong):
    check, name, pattern, text = wrong
    changed(copy / name, pattern, text)
    committed(copy)
    assert release.main(["--tag", TAG, "--only", check], root=copy) == 1
    out = capsys.readouterr().out
    assert re.match(rf"FAILED  {check}: .", out), out
    assert f"not ready for {TAG}" in out


def test_what_is_not_committed_is_found(copy):
    assert release.tree(copy, TAG) == []
    (copy / "new.txt").write_text("new")
    assert release.tree(copy, TAG) == ["not committed: new.txt"]


def test_a_tag_that_exists_is_found_here_and_where_it_is_pushed(copy, tmp_path_factory):
    assert release.unused(copy, TAG) == []
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    git(elsewhere, "clone", "-q", "--bare", str(copy), "bare.git")
    git(copy, "remote", "add", "origin", str(elsewhere / "bare.git"))
    assert release.unused(copy, TAG) == []
    git(elsewhere / "bare.git", "tag", TAG)
    assert release.unused(copy, TAG) == [f"the tag {TAG} is there already, in origin"]
    git(copy, "tag", TAG)
    assert len(release.unused(copy, TAG)) == 2


@pytest.mark.parametrize(("check", "recipe"), [("tests", "static"), ("tests", "test"), ("wheels", "wheel-check")])
def test_a_recipe_that_fails_is_found(copy, check, recipe):
    makefile = "static test wheel-check:\n\t@true\n"
    (copy / "Makefile").write_text(makefile)
    (copy / "dist").mkdir()
    (copy / "dist" / f"liepoisson-{VERSION}-cp311-abi3-linux_x86_64.whl").touch()
    assert release.CHECKS[check](copy, TAG) == []
    (copy / "Makefile").write_text(makefile + f"{recipe}: fails\nfails:\n\t@false\n")
    assert release.CHECKS[check](copy, TAG) == [f"make {recipe} failed"]
