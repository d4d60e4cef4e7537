"""Makes docs/names.md: every public name by chapter, and the words of arguments. Run it when a name is new.

Classes of results that files hold get their lines in results.pyi, methods theirs in methods.pyi, and functions that
make results theirs in the stubs of the chapters of `CHAPTER`.

python docs/public_names.py
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Iterator
from dataclasses import is_dataclass
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType
from typing import Any

import liepoisson as lp
from liepoisson._lazy import homes_of
from liepoisson.io.result import Saved
from liepoisson.numeric.methods import CHOICES

PAGE = Path(__file__).with_name("names.md")

RESULTS = Path(lp.__file__).with_name("results.pyi")

CHAPTER = {"indicators": "chaos", "noise": "stochastic", "poincare": "sections"}
"""The chapter of the functions by which the results of a folder are made."""

WORDS = {
    "system": "what is studied: a `System`, a `Top`, a `VectorField`, anything that has a field",
    "box": "a set of states: a `Box`, a tuple of its bounds, or one state",
    "arithmetic": "of a proof: intervals of doubles, or balls of any precision",
    "leaf": "a `Leaf`, or the values of the Casimirs by name",
    "state": "one point of phase space, shape (component,)",
    "states": "any number of them, shape (..., component)",
    "start": "the state at the first time",
    "starts": "one state at the first time, or many: (component,) or (trajectory, component); or by name or label",
    "guess": "a state near the one that is wanted",
    "n_starts": "how many starts",
    "times": "one time or many",
    "t_end": "the last time; runs begin at 0",
    "transient": "time before anything is measured",
    "energy": "value of the Hamiltonian",
    "surface": "a function that is zero on the surface of section",
    "direction": "sign of its rate at a crossing",
    "along": "integrals that are fixed, by name or formula",
    "method": "how orbits are integrated",
    "tol": "tolerance",
    "step": "size of the steps",
    "order": "order of the method",
    "seed": "draws what is random; always with a default",
    "first": "number of the first trajectory, whose random numbers depend on it",
    "threads": "how many; all cores by default, and the numbers do not depend on it",
    "time_limit": "seconds that the run may take",
    "progress": "called with the fraction that is done; by default a bar in a notebook or on a terminal",
    "tangents": "tangent vectors at the first time",
    "path": "of a file",
    "name": "how something is called",
}
"""What the words mean that several functions share."""


def chapters() -> dict[str, ModuleType]:
    """The chapters by name, in alphabetical order."""
    found = {name: getattr(lp, name) for name in lp.__all__}
    return {name: module for name, module in found.items() if isinstance(module, ModuleType)}


def arguments(value: Any) -> list[str]:
    """The names of the arguments of a function, or of what a class is made from."""
    if not callable(value) or is_error(value):
        return []
    return [name for name in inspect.signature(value).parameters if name != "self"]


def is_error(value: Any) -> bool:
    """Whether it is the class of an error or a warning."""
    return isinstance(value, type) and issubclass(value, Exception)


def is_result(chapter: str, value: Any) -> bool:
    """Whether a class is made by a computation and by nobody else; its attributes are in its docstring."""
    return chapter == "results" and isinstance(value, type)


def callables() -> dict[str, list[str]]:
    """The arguments of every public function, class and method by its dotted name."""
    found: dict[str, list[str]] = {}
    for chapter, module in chapters().items():
        for name in module.__all__:
            value = getattr(module, name)
            if not is_result(chapter, value):
                found[f"{chapter}.{name}"] = arguments(value)
            if isinstance(value, type) and not is_error(value):
                for member, function in inspect.getmembers(value, callable):
                    if not member.startswith("_"):
                        found[f"{chapter}.{name}.{member}"] = arguments(function)
    return found


def saved(base: type = Saved) -> Iterator[type]:
    """The classes that files hold, of the modules that have public names."""
    for one in base.__subclasses__():
        yield from saved(one)
        if is_dataclass(one) and hasattr(one, "kind") and one.__module__.startswith("liepoisson."):
            yield one


def stubs() -> dict[Path, str]:
    """The texts of results.pyi, with a line for each class that files hold, of methods.pyi, and of chapters."""
    for module in chapters().values():
        for name in module.__all__:
            import_module(getattr(getattr(module, name), "__module__", None) or "liepoisson")
    for folder in CHAPTER:
        for found in iter_modules(import_module(f"liepoisson.{folder}").__path__, f"liepoisson.{folder}."):
            import_module(found.name)
    listed = {"results": {one.__name__: one.__module__ for one in saved()}}
    listed["methods"] = {one.__name__: one.__module__ for one in CHOICES.values()}
    for one in saved():
        chapter = CHAPTER.get(one.__module__.split(".")[1])
        if chapter and hasattr(sys.modules[one.__module__], maker := getattr(one, "made_by", "")):
            listed.setdefault(chapter, {})[maker] = one.__module__
    texts: dict[Path, str] = {}
    for chapter, names in listed.items():
        path = RESULTS.with_name(f"{chapter}.pyi")
        homes = homes_of(str(path)) | names
        lines = [
            f"from {home} import {name} as {name}"
            for home, name in sorted((home, name) for name, home in homes.items())
        ]
        texts[path] = "\n".join([path.read_text(encoding="utf-8").splitlines()[0], *lines]) + "\n"
    return texts


def page() -> str:
    """The text of docs/names.md."""
    short = [name for name in lp.__all__ if name not in chapters() and name != "__version__"]
    lines = [
        "# Public names",
        "",
        "Made by `python docs/public_names.py`. `help(lp.integrate)` has arguments, results and errors,",
        "and so has the site of `make docs`. Names at the top are in a chapter, too.",
        "",
        "At the top: " + ", ".join(f"`{name}`" for name in short) + ".",
        "",
    ]
    for chapter, module in chapters().items():
        stub = RESULTS.with_name(f"{chapter}.pyi")  # which has names that are new, too
        names = ", ".join(f"`{name}`" for name in (sorted(homes_of(str(stub))) if stub.exists() else module.__all__))
        lines += [f"## {chapter}", "", f"{_first_sentence(module.__doc__)} {names}.", ""]
    lines += ["## Words of arguments", "", "| word | meaning |", "|---|---|"]
    lines += [f"| `{word}` | {meaning} |" for word, meaning in WORDS.items()]
    return "\n".join(lines) + "\n"


def _first_sentence(text: str | None) -> str:
    first = inspect.cleandoc(text or "").split("\n\n")[0].replace("\n", " ")
    return first.replace("|", r"\|")


if __name__ == "__main__":
    for path, text in stubs().items():
        path.write_text(text, encoding="utf-8")
    PAGE.write_text(page(), encoding="utf-8")
