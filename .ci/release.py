"""Is everything ready for a release?  Follows the list of docs/releasing.md and changes nothing.

    python .ci/release.py                           # the whole list, which takes as long as the tests
    python .ci/release.py --only version changelog  # a part of it
    python .ci/release.py --tag v0.2.0              # against the tag that is about to be made, or is built

It needs Python alone for all but `tests` and `wheels`, which run make.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from datetime import date
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

_CRATES = ("liepoisson-core", "liepoisson-formula", "liepoisson-py", "liepoisson-wasm")
_HEADING = re.compile(r"^## (\S+)(?: \((.*)\))?$", re.MULTILINE)
_VERSION = re.compile(r"\d+\.\d+\.\d+(?:(?:a|b|rc)\d+)?")


def version_of(root: Path) -> str:
    """The version that Cargo.toml declares, from which the package takes it."""
    return str(tomllib.loads(_read(root / "Cargo.toml"))["workspace"]["package"]["version"])


def version(root: Path, tag: str) -> list[str]:
    """The version is the same wherever it is written, and it is that of the tag."""
    wanted = version_of(root)
    found = {"the tag": tag.removeprefix("v")}
    locked = {one["name"]: one["version"] for one in tomllib.loads(_read(root / "Cargo.lock"))["package"]}
    found |= {f"{name} in Cargo.lock": locked.get(name) for name in _CRATES}
    found["web/src/data/tops.json"] = json.loads(_read(root / "web/src/data/tops.json")).get("package")
    wrong = [f"{place} has {given}, and Cargo.toml {wanted}" for place, given in found.items() if given != wanted]
    if not _VERSION.fullmatch(wanted):
        wrong.append(f"Cargo.toml has {wanted}; wanted three numbers, such as 0.2.0 or 0.2.0rc1")
    return wrong


def changelog(root: Path, tag: str) -> list[str]:
    """The first section of the changelog is that of the version, with its date, and is not empty."""
    text, wanted = _read(root / "CHANGELOG.md"), tag.removeprefix("v")
    sections = list(_HEADING.finditer(text))
    if not sections or sections[0][1] != wanted:
        return [f"the first section of CHANGELOG.md is {sections[0][0] if sections else 'missing'}; wanted {wanted}"]
    wrong: list[str] = []
    try:
        written = date.fromisoformat(sections[0][2] or "")
        if written > date.today():
            wrong.append(f"the section {wanted} of CHANGELOG.md has the date {written}, which is not yet")
    except ValueError:
        wrong.append(f"the heading of {wanted} in CHANGELOG.md has ({sections[0][2]}); wanted a date: (2026-01-31)")
    end = sections[1].start() if len(sections) > 1 else len(text)
    if not re.search(r"^- ", text[sections[0].end() : end], re.MULTILINE):
        wrong.append(f"the section {wanted} of CHANGELOG.md lists nothing")
    return wrong


def citation(root: Path, tag: str) -> list[str]:
    """CITATION.cff has the version; the tests compare the rest of it with what `lp.cite` says."""
    found = re.search(r"^version: (.*)$", _read(root / "CITATION.cff"), re.MULTILINE)
    if found is None or found[1].strip("\"'") != tag.removeprefix("v"):
        given = found[1] if found else "no version"
        return [f"CITATION.cff has {given}, and the tag {tag}; run .venv/bin/python docs/citation_file.py"]
    return []


def tree(root: Path, tag: str) -> list[str]:
    """Everything is committed."""
    changed = _git(root, "status", "--porcelain").splitlines()
    return [f"not committed: {', '.join(line[3:] for line in changed[:5])}"] if changed else []


def unused(root: Path, tag: str) -> list[str]:
    """The tag does not exist, neither here nor, where there is one, in the repository that is pushed to."""
    wrong = [f"the tag {tag} is there already"] if _git(root, "tag", "--list", tag).strip() else []
    for remote in _git(root, "remote").split():
        if _git(root, "ls-remote", "--tags", remote, f"refs/tags/{tag}").strip():
            wrong.append(f"the tag {tag} is there already, in {remote}")
    return wrong


def tests(root: Path, tag: str) -> list[str]:
    """All tests pass, with format, lint and types."""
    return _made(root, "static", "test")


def wheels(root: Path, tag: str) -> list[str]:
    """The wheel builds, has the version, and computes a first result where there is no compiler."""
    if wrong := _made(root, "wheel-check"):
        return wrong
    built = [path.name for path in (root / "dist").glob("*.whl")]
    wanted = f"liepoisson-{tag.removeprefix('v')}-"
    return [] if any(name.startswith(wanted) for name in built) else [f"dist has {built}; wanted {wanted}*.whl"]


CHECKS: dict[str, Callable[[Path, str], list[str]]] = {
    check.__name__: check for check in (version, changelog, citation, tree, unused, tests, wheels)
}
"""In the order of the list, the quick ones first; each gives what is wrong."""


def main(arguments: list[str] | None = None, root: Path = ROOT) -> int:
    """Runs the checks and prints a line for each; 1 where one fails."""
    parser = argparse.ArgumentParser(description="Is everything ready for a release?")
    parser.add_argument("--tag", help="by default v and the version of Cargo.toml")
    parser.add_argument(
        "--only", nargs="+", choices=CHECKS, default=list(CHECKS), metavar="CHECK", help=", ".join(CHECKS)
    )
    given = parser.parse_args(arguments)
    tag = given.tag or f"v{version_of(root)}"
    failed = False
    for name in given.only:
        try:
            wrong = CHECKS[name](root, tag)
        except (OSError, ValueError, KeyError, subprocess.CalledProcessError) as error:
            wrong = [f"could not be checked: {error}"]
        print(f"{'FAILED' if wrong else 'ok':<8}{name}: {'; '.join(wrong) or CHECKS[name].__doc__}", flush=True)
        failed = failed or bool(wrong)
    print(f"not ready for {tag}" if failed else f"ready for {tag}" if given.only == list(CHECKS) else "so far so good")
    return int(failed)


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _git(root: Path, *arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=root, check=True, capture_output=True, text=True).stdout


def _made(root: Path, *recipes: str) -> list[str]:
    for recipe in recipes:
        if subprocess.run(["make", recipe], cwd=root, check=False).returncode:
            return [f"make {recipe} failed"]
    return []


if __name__ == "__main__":
    sys.exit(main())
