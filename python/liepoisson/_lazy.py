"""Public names that are loaded on first use, from the stub beside the module (after Scientific Python's SPEC 1).

A name is written once, in the stub, as `from liepoisson.place import name as name`. Type checkers read it there, and so
does `attach`. The package has its own loader since the stubs name their places absolutely, and to save a dependency.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path


def attach(module: str, file: str) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """`__getattr__`, `__dir__` and `__all__` of a module (PEP 562) whose stub lists its names.

    Args:
        module: The module's `__name__`.
        file: Its `__file__`.
    """
    homes = {
        alias.name: node.module
        for node in ast.parse(Path(file).with_suffix(".pyi").read_text(encoding="utf-8")).body
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }

    def load(name: str) -> object:
        home = homes.get(name)
        if home is None:
            raise AttributeError(_unknown(module, name, list(homes)))
        if home == "liepoisson":  # a chapter
            return import_module(f"liepoisson.{name}")
        value = getattr(import_module(home), name)
        setattr(sys.modules[module], name, value)
        return value

    names = sorted(homes)
    return load, lambda: list(names), names


def _unknown(module: str, name: str, names: list[str]) -> str:
    """The message for an unknown name, with the chapter that has it, if one does."""
    message = f"module {module!r} has no attribute {name!r}"
    if name.startswith("_"):
        return message
    from liepoisson.errors import did_you_mean

    for chapter in () if module != "liepoisson" else _chapters():
        if name in dir(import_module(f"liepoisson.{chapter}")):
            return f"{message}; it is liepoisson.{chapter}.{name}"
    hint = did_you_mean(name, names).strip()
    return f"{message}; {hint[0].lower()}{hint[1:]}" if hint else f"{message}; dir({module}) lists what it has"


def _chapters() -> list[str]:
    return [file.stem for file in sorted(Path(__file__).parent.glob("*.pyi")) if not file.stem.startswith("_")] + [
        file.parent.name for file in sorted(Path(__file__).parent.glob("*/__init__.pyi"))
    ]
