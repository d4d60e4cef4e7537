"""The workflows run what is there: pinned actions, files that exist, and as many wheels as are published."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
PINNED = re.compile(r"[\w.-]+/[\w.-]+@[0-9a-f]{40} # v\d+(\.\d+)*")
FILE = re.compile(r"(?<![\w./-])((?:\.ci|requirements|benchmarks|\.github)/[\w./-]+\.\w+|\.ci/run)(?![\w/])")


def text(path):
    return path.read_text(encoding="utf-8")


def used(content):
    return re.findall(r"^ *(?:- )?uses: (.*)$", content, re.MULTILINE)


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_actions_are_pinned_by_commit_and_name_their_version(path):
    actions = used(text(path))
    assert actions
    assert [action for action in actions if not PINNED.fullmatch(action)] == []


def test_an_action_has_one_commit_everywhere():
    found = {tuple(action.split("@", 1)) for path in WORKFLOWS for action in used(text(path))}
    assert len({name for name, _ in found}) == len(found), sorted(found)


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_files_and_recipes_of_a_workflow_exist(path):
    content = text(path)
    files = set(FILE.findall(content))
    assert files
    assert [name for name in files if not (ROOT / name).exists()] == []
    for recipe in re.findall(r"^ *(?:- run: )?make ([\w-]+)", content, re.MULTILINE):
        assert re.search(rf"^{recipe}:", text(ROOT / "Makefile"), re.MULTILINE), recipe


def test_nothing_is_allowed_that_a_job_does_not_name():
    for path in WORKFLOWS:
        content = text(path)
        assert re.search(r"^permissions: \{\}$", content, re.MULTILINE), path.name
        assert content.count("persist-credentials: false") == content.count("actions/checkout@"), path.name
        assert "secrets." not in content, path.name


def test_all_wheels_are_published_and_no_other():
    content = text(ROOT / ".github" / "workflows" / "wheels.yml")
    wheels = re.findall(r"- \{ name: ([\w-]+), runner: ", content)
    assert len(wheels) == len(set(wheels))
    (wanted,) = re.findall(r"ls dist/\*\.whl \| wc -l\)\" = (\d+)", content)
    assert int(wanted) == len(wheels)
    assert "name: release-${{ matrix.name }}" in content
    assert "pattern: release-*" in content
    page = text(ROOT / "docs" / "installing.md")
    assert {name.partition("-")[0] for name in wheels} == {"linux", "macos", "windows"}
    assert all(
        system in page for system in ("Linux (x86-64 and ARM64", "macOS (Intel and Apple silicon)", "Windows (x86-64)")
    )
