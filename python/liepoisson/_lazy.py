"""Public names that are loaded on first use, from the stub beside the module (after Scientific Python's SPEC 1).

A name is written once, in the stub, as `from liepoisson.place import name as name`. Type checkers read it there, and so
does `attach`. The package has its own loader since the stubs name their places absolutely, and to save a dependency.

This module imports next to nothing: a command that Ctrl-C ends before `cli/exit.py` is there ends in a traceback.
"""

from __future__ import annotations

import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable


def attach(module: str, file: str) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """`__getattr__`, `__dir__` and `__all__` of a module (PEP 562) whose stub lists its names.

    Args:
        module: The module's `__name__`.
        file: Its `__file__`.
    """
    homes = homes_of(f"{file.rpartition('.')[0]}.pyi")

    def load(name: str) -> object:
        from importlib import import_module

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


def homes_of(stub: str) -> dict[str, str]:
    """The module of each name that a stub lists."""
    with open(stub, encoding="utf-8") as lines:
        words = [line.split() for line in lines]
    return {line[5]: line[1] for line in words if line[:1] == ["from"]}


def _unknown(module: str, name: str, names: list[str]) -> str:
    """The message for an unknown name, with the chapter that has it, if one does."""
    message = f"module {module!r} has no attribute {name!r}"
    if name.startswith("_"):
        return message
    from importlib import import_module

    from liepoisson.errors import did_you_mean

    elsewhere = {
        known: f"liepoisson.{chapter}.{known}" if chapter else f"liepoisson.{known}"
        for chapter in (*reversed(_chapters()), "")  # the name of the top level comes first
        if (full := f"liepoisson.{chapter}".rstrip(".")) != module
        for known in import_module(full).__all__
    }
    if name in elsewhere:
        return f"{message}; it is {elsewhere[name]}"
    hint = did_you_mean(name, names).strip()
    if not hint and (far := did_you_mean(name, elsewhere).removeprefix("Did you mean ").removesuffix("? ")):
        hint = f"Did you mean {elsewhere[far]}?"
    return f"{message}; {hint[0].lower()}{hint[1:]}" if hint else f"{message}; dir({module}) lists what it has"


def unknown(module: str, names: list[str], instead: Callable[[str], str] | None = None) -> Callable[[str], object]:
    """`__getattr__` of a chapter that imports its names at once: the error names the nearest one.

    Args:
        module: The module's `__name__`.
        names: Its `__all__`.
        instead: Gives what to write in place of a name that is something else, or nothing.
    """

    def load(name: str) -> object:
        other = instead(name) if instead is not None and not name.startswith("_") else ""
        raise AttributeError(
            f"module {module!r} has no attribute {name!r}; write {other}" if other else _unknown(module, name, names)
        )

    return load


def _chapters() -> list[str]:
    """All modules of names for users; those with a stub, and those that import their names at once."""
    from pathlib import Path

    here = Path(__file__).parent
    lazy = [file.stem for file in here.glob("*.pyi") if not file.stem.startswith("_")]
    return sorted({*lazy, *(file.parent.name for file in here.glob("*/__init__.pyi")), "catalog", "errors", "plot"})
