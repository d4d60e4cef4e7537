"""Imports run down: through the folders of the package, which are its layers.  There is no list of exceptions.

Imports inside functions and those for types count like all others.
"""

import ast
import re
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import liepoisson
from liepoisson.facades import FACADES

ROOT = Path(liepoisson.__file__).parent

LAYERS = (
    {"errors"},
    {"facades", "_lazy"},
    {"portable"},
    {"streams"},
    {"inputs"},
    {"algebra"},
    {"formula"},
    {"io"},
    {"structure"},
    {"compile"},
    {"model"},
    {"damping"},
    {"catalog"},
    {"report"},
    {"numeric"},
    {"leaf"},
    {"indicators", "poincare", "observations"},
    {"equilibrium", "noise", "rigid_body"},
    {"integrability", "orbits"},
    {"tori"},
    {"proofs"},
    {"sweeps"},
    {"saved"},
    {"plot"},
    {"laboratory"},
    {
        "", "algebras", "brackets", "chaos", "charts", "citations", "dissipation", "extensions", "fields",
        "fits", "methods", "phase_space", "results", "sections", "stochastic", "systems",
    },
    {"studies"},
    {"cli"},
    {"__main__"},
)  # fmt: skip
"""From the ground up, modules and folders.  Folders of one layer do not import each other; nothing imports the last."""

MOST_IN_A_CIRCLE = 5
"""Files that import each other, all in one folder: a class, and the files of what its methods compute."""


@dataclass(frozen=True)
class Arrow:
    importer: str
    imported: str
    line: int

    def __str__(self):
        path = module_path(self.importer).relative_to(ROOT.parent.parent)
        return f"{path}:{self.line} imports liepoisson.{self.imported}".rstrip(".")


def module_path(name):
    path = ROOT.joinpath(*name.split(".")) if name else ROOT
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def modules():
    """Names without "liepoisson."; the package itself is ""."""
    names = (path.relative_to(ROOT).with_suffix("").parts for path in ROOT.rglob("*.py"))
    return frozenset(".".join(parts).removesuffix("__init__").rstrip(".") for parts in names)


def imported_names(tree, name):
    """Full name and line of every import of a module."""
    package = ["liepoisson", *name.split(".")] if name else ["liepoisson"]
    package = package if module_path(name).name == "__init__.py" else package[:-1]
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node.lineno) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            origin = ".".join([*above, *([node.module] if node.module else [])])
            yield from ((f"{origin}.{alias.name}", node.lineno) for alias in node.names)


@cache
def tree_of(name):
    return ast.parse(module_path(name).read_text(encoding="utf-8"))


@cache
def arrows():
    found = []
    for name in sorted(modules()):
        for target, line in imported_names(tree_of(name), name):
            if target.partition(".")[0] != "liepoisson":
                continue
            inner = target.removeprefix("liepoisson").lstrip(".")
            # What is compiled or written when the package is built has no source here.
            if inner.partition(".")[0] in {"_core", "__version__"}:
                continue
            if inner not in modules():
                inner = inner.rpartition(".")[0]
            assert inner in modules(), f"line {line} of {name} imports {target}, and there is no such module"
            if inner != name:
                found.append(Arrow(name, inner, line))
    return tuple(found)


def folder(name):
    return name.partition(".")[0]


def height(name):
    return next(k for k, layer in enumerate(LAYERS) if folder(name) in layer)


def circles():
    """Sets of modules that import each other, directly or not (Tarjan's strongly connected components)."""
    targets = {name: {arrow.imported for arrow in arrows() if arrow.importer == name} for name in modules()}
    number, lowest, waiting, found = {}, {}, [], []

    def visit(name):
        number[name] = lowest[name] = len(number)
        waiting.append(name)
        for target in targets[name]:
            if target not in number:
                visit(target)
            if target in waiting:
                lowest[name] = min(lowest[name], lowest[target])
        if lowest[name] == number[name]:
            place = waiting.index(name)
            found.append(set(waiting[place:]))
            del waiting[place:]

    for name in modules():
        if name not in number:
            visit(name)
    return [circle for circle in found if len(circle) > 1]


def test_every_folder_is_in_a_layer():
    assert sorted({folder(name) for name in modules()}) == sorted(name for layer in LAYERS for name in layer)


def test_the_page_of_the_architecture_has_the_same_order():
    """The folders at the beginnings of the lines of its tree, each no lower than the one before it."""
    page = (ROOT.parents[1] / "ARCHITECTURE.md").read_text(encoding="utf-8")
    level = {name: k for k, names in enumerate(LAYERS) for name in names}
    told = re.findall(r"^  (\w+)/", page.split("python/liepoisson/\n")[1].split("crates/")[0], flags=re.MULTILINE)
    assert {*told} <= {*level}
    assert len(told) > 20
    assert told == sorted(told, key=level.__getitem__)


def test_imports_run_down():
    wrong = [
        arrow
        for arrow in arrows()
        if height(arrow.imported) > height(arrow.importer)
        or (height(arrow.imported) == height(arrow.importer) and folder(arrow.imported) != folder(arrow.importer))
        if height(arrow.importer) < len(LAYERS) - 1
    ]
    assert not wrong, "arrows up:\n" + "\n".join(sorted(map(str, wrong)))


def private_uses(tree, name):
    """Lines of a module that import from inside the package, or take a name of it that docs/names.md does not list."""
    chapters = {n for n in liepoisson.__all__ if isinstance(getattr(liepoisson, n), ModuleType)}
    for target, line in imported_names(tree, name):
        own = target.startswith(f"liepoisson.{folder(name)}")
        if target.partition(".")[0] == "liepoisson" and target != "liepoisson" and not own:
            yield f"line {line}: {target}"
    for node in ast.walk(tree):
        if not isinstance(node, ast.Attribute):
            continue
        match node.value:
            case ast.Name("lp") if node.attr not in liepoisson.__all__:
                yield f"line {node.lineno}: lp.{node.attr}"
            case ast.Attribute(ast.Name("lp"), chapter) if (
                chapter in chapters and node.attr not in getattr(liepoisson, chapter).__all__
            ):
                yield f"line {node.lineno}: lp.{chapter}.{node.attr}"


def test_studies_use_public_names_only():
    """As a user would: `import liepoisson as lp`, and what docs/names.md lists."""
    found = {name: list(private_uses(tree_of(name), name)) for name in modules() if folder(name) == "studies"}
    assert {name: uses for name, uses in found.items() if uses} == {}
    assert len(found) > 10


@pytest.mark.parametrize(
    "text",
    [
        "from liepoisson.io.files import writing",
        "import liepoisson.io.files",
        "from liepoisson import Top",
        "lp.numeric.methods",
        "lp.fits.last_decade([1, 10])",
    ],
)
def test_a_private_name_in_a_study_is_found(text):
    assert len(list(private_uses(ast.parse(text), "studies.twisted_top.runs"))) == 1


def test_circles_are_small_and_within_a_folder():
    for circle in circles():
        assert len({folder(name) for name in circle}) == 1, sorted(circle)
        assert len(circle) <= MOST_IN_A_CIRCLE, sorted(circle)


@pytest.mark.parametrize("method", FACADES)
def test_a_facade_calls_a_function_that_its_class_could_not_import(method):
    module, _, function = FACADES[method].rpartition(".")
    assert callable(getattr(import_module(f"liepoisson.{module}"), function))
    calls = [name for name in modules() if f'function_of("{method}")' in module_path(name).read_text(encoding="utf-8")]
    assert len(calls) == 1
    (home,) = calls
    assert f"class {method.partition('.')[0]}" in module_path(home).read_text(encoding="utf-8")
    assert home in below(module)


def below(name):
    """The modules that a module imports, directly or not."""
    found, waiting = set(), [name]
    while waiting:
        current = waiting.pop()
        new = {arrow.imported for arrow in arrows() if arrow.importer == current} - found
        found |= new
        waiting += new
    return found
