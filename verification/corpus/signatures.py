"""Every public name, how it is called, and what the classes have."""

from __future__ import annotations

import dataclasses
import inspect
import re
from types import ModuleType
from typing import Any

from verification.corpus.answer import answer, lines, masked

import liepoisson as lp

MODULE = re.compile(r"\bliepoisson(?:\.\w+)+\.(?=[A-Za-z_])")
"""Where a name of the package is at home, which may change."""


def record() -> dict[str, Any]:
    """The top level and each chapter."""
    found = {"liepoisson": names(lp)}
    for name in sorted(lp.__all__):
        if isinstance(chapter := getattr(lp, name), ModuleType):
            found[name] = names(chapter)
    return found


def names(module: ModuleType) -> dict[str, Any]:
    """What a chapter lists."""
    listed = {name: answer(lambda name=name: described(getattr(module, name))) for name in sorted(module.__all__)}
    return {"what the module is for": lines(inspect.getdoc(module) or ""), "dir": sorted(dir(module)), **listed}


def described(value: Any) -> Any:
    """A name: kind, signature, docstring; of a class its members, too."""
    if isinstance(value, ModuleType):
        return "a module"
    if isinstance(value, type):
        return {**called(value), "bases": [base.__name__ for base in value.__mro__[1:]], "members": members(value)}
    if callable(value):
        return called(value)
    return f"a {type(value).__name__}"


def called(value: Any) -> dict[str, Any]:
    """The signature and the docstring."""
    try:
        signature = shown(str(inspect.signature(value)))
    except (TypeError, ValueError):  # that of the compiled core, or of an exception
        signature = "none"
    return {"signature": signature, "says": lines(inspect.getdoc(value) or "")}


def shown(text: str) -> str:
    """A signature without the homes of the names in it."""
    return MODULE.sub("", masked(text))


def members(cls: type) -> dict[str, Any]:
    """Public attributes and methods of a class, inherited ones too."""
    found: dict[str, Any] = {}
    for name, value in inspect.getmembers_static(cls):
        if name.startswith("_"):
            continue
        if isinstance(value, property) or type(value).__name__ in {"cached_property", "member_descriptor"}:
            found[name] = {"kind": "attribute", "says": lines(inspect.getdoc(value) or "")}
        elif callable(getattr(cls, name)):
            found[name] = {"kind": type(value).__name__, **called(getattr(cls, name))}
        else:
            found[name] = {"kind": "value", "value": shown(repr(value))}
    if dataclasses.is_dataclass(cls):
        for one in dataclasses.fields(cls):
            if not one.name.startswith("_"):
                found[one.name] = {"kind": "field", "type": shown(str(one.type))}
    return found
