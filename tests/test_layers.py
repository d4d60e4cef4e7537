"""Imports run one way: down through the rooms of the package, and through the levels of the exact wing.

Imports inside functions and those for types count like all others.  An exception is an arrow with a reason; one that is
no longer needed must be removed from the list.
"""

import ast
from dataclasses import dataclass
from functools import cache
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path

import pytest

import liepoisson

ROOT = Path(liepoisson.__file__).parent

ROOMS = (
    {"errors", "arrays", "field", "files", "given", "formats", "netcdf", "wrong_values", "display", "calls", "scalars",
     "deadline", "streams", "read_only", "portable", "_lazy"},
    {"tables"},
    {"result", "dataset"},
    {"exact", "numeric"},
    {"tops", "catalog"},
    {"phase_space", "integrability"},
    {"orbits"},
    {"proofs"},
    {"sweeps"},
    {"repeat", "citing"},
    {"plot"},
    {"studies"},
    {"laboratory"},
    {"cli"},
    {"", "__main__", "algebras", "brackets", "chaos", "charts", "citations", "extensions", "fields", "fits", "methods",
     "results", "sections", "systems"},
)  # fmt: skip
"""From the ground up: modules and folders of the package.  The last is the surface, which nothing inside imports."""

STRANGERS = {
    ("exact", "numeric"), ("numeric", "exact"), ("phase_space", "integrability"), ("integrability", "phase_space"),
}  # fmt: skip
"""Rooms of one level that do not import each other."""

LEVELS = {
    "names and numbers": {
        "names", "parameters", "rational_polynomials", "rounded", "sparse_polynomials", "styles", "tensors", "triples",
        "values",
    },
    "linear algebra": {"linear"},
    "polynomial systems": {"polynomials"},
    "algebras": {
        "commutative", "lie",
        "extension", "extensions", "normal_forms", "classification", "lie_algebra", "lie_algebras",
    },
    "Poisson tensors": {"poisson"},
    "brackets": {
        "bracket", "canonical_bracket", "constant_part", "casimirs", "certificates", "locus", "strata", "automorphisms",
        "trace", "trace_arithmetic", "trace_casimirs", "trace_words",
    },
    "formulas": {"formula", "expression", "constructors", "polynomial_formula"},
    "systems": {
        "hamiltonian", "top_parameters", "top_recognition", "known_integrals",
        "private_symbols", "cancellation", "overflow", "lowering",
        "polynomial_dynamics", "polynomial_view",
        "pieces", "ball_functions", "phase_functions", "trace_values", "system", "canonical_system",
        "discrete_symmetries",
        "signed_permutations",
    },
    "files and charts": {"system_file", "system_file_reader", "system_text", "charts"},
    "reports": {"decimals", "printing", "report", "describe"},
}  # fmt: skip
"""Levels of the exact wing, from the ground up: files and folders of `exact`."""

FACADES = {
    "result": {"dataset"},
    "structure.bracket": {
        "structure.automorphisms", "structure.casimirs", "structure.certificates", "structure.strata", "structure.trace_casimirs",
        "report.describe",
    },
    "structure.lie_algebra": {"structure.bracket", "report.describe"},
    "structure.extension": {"structure.classification"},
    "proofs.theorem": {"proofs.statement"},
    "integrability.galois.linear_systems": {"integrability.galois.local_solutions"},
    "model.system": {"report.describe", "model.phase_functions", "model.system_text", "model.top_recognition"},
    "integrability.lax.pair": {"integrability.lax.lax_integrals", "integrability.lax.spectral_curve"},
    "poincare.section": {"poincare.section_coordinates", "poincare.section_levels"},
    "orbits.homoclinic_orbits": {"orbits.polish_homoclinic"},
    "orbits.periodic_orbits": {"orbits.polish"},
    "leaf.leaf": {"leaf.leaf_sampling", "leaf.leaf_search"},
}  # fmt: skip
"""Methods and operators of a class that call functions of other files, which take objects of this class."""

_TEXT = 'a number given as text, such as "sqrt(2)", is read as a formula'
EXCEPTIONS = {
    ("formula.parameters", "formula.expression"): _TEXT,
    ("formula.parameters", "algebra.cyclotomic"): "whether a sum of sines and roots vanishes is decided there",
    ("arrays", "formula.expression"): _TEXT,
    ("arrays", "formula.parameters"): _TEXT,
    ("indicators.spectrum_check", "indicators.spectrum"): "the check of a spectrum, which has it as a method",
    ("sweeps.tasks", ""): "a worker says which version of the package it has",
    ("sweeps.remote", ""): "a function that travels to a worker, which may have another version or none",
}
"""Other arrows that run up or close a circle, with the reason."""


@dataclass(frozen=True)
class Arrow:
    importer: str
    imported: str
    line: int
    is_at_once: bool

    @property
    def ends(self):
        return self.importer, self.imported

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


def imports(node, *, at_once=True):
    """The import statements below a node, and whether they are run as soon as the module is imported."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (ast.Import, ast.ImportFrom)):
            yield child, at_once
        elif isinstance(child, ast.stmt | ast.ExceptHandler | ast.match_case):
            is_function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef)
            is_for_types = isinstance(child, ast.If) and getattr(child.test, "id", "") == "TYPE_CHECKING"
            yield from imports(child, at_once=at_once and not is_function and not is_for_types)


def imported_names(tree, name):
    """Full name, line, and whether it is imported at once, for every import of a module."""
    package = ["liepoisson", *name.split(".")] if name else ["liepoisson"]
    package = package if module_path(name).name == "__init__.py" else package[:-1]
    for node, at_once in imports(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node.lineno, at_once) for alias in node.names)
        else:
            above = package[: len(package) - node.level + 1] if node.level else []
            origin = ".".join([*above, *([node.module] if node.module else [])])
            yield from ((f"{origin}.{alias.name}", node.lineno, at_once) for alias in node.names)


@cache
def arrows():
    found = []
    for name in sorted(modules()):
        tree = ast.parse(module_path(name).read_text(encoding="utf-8"))
        for target, line, is_at_once in imported_names(tree, name):
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
                found.append(Arrow(name, inner, line, is_at_once))
    return tuple(found)


def is_excepted(arrow):
    return arrow.imported in FACADES.get(arrow.importer, ()) or arrow.ends in EXCEPTIONS


def room(name):
    return name.partition(".")[0]


def level(name):
    return name.split(".")[1]


def height(name, floors):
    return next(k for k, floor in enumerate(floors) if name in floor)


def upward(found, place, floors, strangers=frozenset()):
    """The arrows from a floor to one above it, or between two places of a floor that are strangers."""
    for arrow in found:
        ends = place(arrow.importer), place(arrow.imported)
        if height(ends[1], floors) > height(ends[0], floors) or ends in strangers:
            yield arrow


def listed(found):
    return "\n".join(sorted(set(map(str, found))))


def test_every_module_has_its_place():
    assert sorted({room(name) for name in modules()}) == sorted(name for floor in ROOMS for name in floor)
    inside = {level(name) for name in modules() if name.startswith("exact.")}
    assert sorted(inside) == sorted(name for floor in LEVELS.values() for name in floor)


def test_rooms_import_what_is_below_them():
    found = upward(arrows(), room, ROOMS, STRANGERS)
    assert not (wrong := [arrow for arrow in found if not is_excepted(arrow)]), f"arrows up:\n{listed(wrong)}"


def test_the_exact_wing_runs_in_one_direction():
    inside = [arrow for arrow in arrows() if all(end.startswith("exact.") for end in arrow.ends)]
    found = upward(inside, level, tuple(LEVELS.values()))
    assert not (wrong := [arrow for arrow in found if not is_excepted(arrow)]), f"arrows up:\n{listed(wrong)}"


def test_there_is_no_circle():
    graph = {name: set() for name in modules()}
    counted = [arrow for arrow in arrows() if not is_excepted(arrow)]
    for arrow in counted:
        graph[arrow.importer].add(arrow.imported)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        names = error.args[1][::-1]
        steps = set(pairwise(names))
        pytest.fail(f"a circle:\n{listed(arrow for arrow in counted if arrow.ends in steps)}")


def test_facades_import_when_they_are_called():
    wrong = [arrow for arrow in arrows() if arrow.imported in FACADES.get(arrow.importer, ()) and arrow.is_at_once]
    assert not wrong, listed(wrong)


def test_exceptions_are_needed():
    """Without it there would be an arrow up, or a circle with the other exceptions in place or not."""
    present = {arrow.ends for arrow in arrows()}
    excepted = {(source, target) for source, targets in FACADES.items() for target in targets} | set(EXCEPTIONS)
    assert not (gone := excepted - present), f"no longer there, remove them from the list: {sorted(gone)}"
    reached = {name: below(name) for name in {target for _, target in excepted}}
    up = {arrow.ends for arrow in upward(arrows(), room, ROOMS, STRANGERS)}
    up |= {arrow.ends for arrow in upward(
        [a for a in arrows() if all(end.startswith("exact.") for end in a.ends)], level, tuple(LEVELS.values())
    )}  # fmt: skip
    idle = {(source, target) for source, target in excepted - up if source not in reached[target]}
    assert not idle, f"they run down and close no circle, remove them from the list: {sorted(idle)}"


def below(name):
    """The modules that a module imports, directly or not."""
    found, waiting = set(), [name]
    while waiting:
        current = waiting.pop()
        new = {arrow.imported for arrow in arrows() if arrow.importer == current} - found
        found |= new
        waiting += new
    return found
