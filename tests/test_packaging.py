"""What the package imports is what it declares, and what is locked follows from what is declared."""

import ast
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import liepoisson as lp

ROOT = Path(__file__).parent.parent
PACKAGE = Path(lp.__file__).parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def normal(name):
    """A distribution's name as the registry writes it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def named(requirements):
    return {normal(re.match(r"[\w.-]+", text)[0]) for text in requirements}


def modules_used(source):
    """Top-level modules that a source imports, also inside functions, and those that xarray loads by name."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Import():
                yield from (alias.name.split(".")[0] for alias in node.names)
            case ast.ImportFrom(level=0):
                yield node.module.split(".")[0]
            case ast.keyword(arg="engine", value=ast.Constant(value=str(engine))):
                yield engine


WITH_NOTEBOOK = {PACKAGE / "laboratory" / "widget.py"}
"""The sources that may import what the extra `notebook` brings."""


def distributions_used(sources):
    modules = {name for path in sources for name in modules_used(path.read_text(encoding="utf-8"))}
    owners = {"anywidget": ["anywidget"], "traitlets": ["traitlets"], **packages_distributions()}
    foreign = modules - set(sys.stdlib_module_names) - {"liepoisson", "__future__"}
    return {normal(owners[name][0]) for name in foreign}


def locked(name):
    text = (ROOT / "requirements" / name).read_text(encoding="utf-8")
    return named(re.findall(r"^[\w.-]+(?===)", text, re.MULTILINE))


def test_what_is_imported_is_declared_and_what_is_declared_is_imported():
    sources = set(PACKAGE.rglob("*.py"))
    declared = named(PROJECT["project"]["dependencies"])
    assert sources >= WITH_NOTEBOOK
    assert distributions_used(sources - WITH_NOTEBOOK) == declared
    extra = named(PROJECT["project"]["optional-dependencies"]["notebook"])
    assert distributions_used(WITH_NOTEBOOK) - declared == extra


def test_an_import_is_found_wherever_it_stands():
    source = "import a.b, c\nfrom . import d\ndef e():\n    from f.g import h\n    open_dataset(x, engine='j')\n"
    assert set(modules_used(source)) == {"a", "c", "f", "j"}


def test_locks_hold_what_is_declared_and_the_tools_of_the_build_are_apart():
    groups = PROJECT["dependency-groups"]
    run, build, dev, notebooks = (locked(f"{name}.txt") for name in ("run", "build", "dev", "notebooks"))
    extra = named(PROJECT["project"]["optional-dependencies"]["notebook"])
    assert groups["build"] == PROJECT["build-system"]["requires"]
    assert named(groups["build"]) <= build
    assert named(PROJECT["project"]["dependencies"]) <= run
    assert not build & run
    assert run | extra | named(groups["test"]) | named(groups["lint"]) <= dev
    assert run | extra | named(groups["notebooks"]) <= notebooks
    assert not run & extra
    assert not dev & named(groups["notebooks"])
