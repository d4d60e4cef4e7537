"""Orbits, tori and what was found of them as plain data: written whole, with what they share, and read as the same.

An object is written once, by the names of its fields, whatever refers to it: a homoclinic orbit comes back with one
manifold of one orbit at both ends.  Only classes of orbits, equilibria and tori are made again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from fractions import Fraction
from functools import cache
from importlib import import_module
from typing import Any, Self, TypeVar

import numpy as np
from sympy import Expr

from liepoisson.errors import OutputError
from liepoisson.formula.parameters import flattened, read_parameter
from liepoisson.inputs.deadline import CUT_SHORT
from liepoisson.io.display import Found
from liepoisson.io.result import Kept, homes_of_results
from liepoisson.leaf._checks import are_equal
from liepoisson.leaf.leaf import Leaf, leaf_of_values
from liepoisson.model.free_parameter import FreeParameter, values_of
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.model.system import System
from liepoisson.model.system_text import formula_text
from liepoisson.numeric.method.method import Method
from liepoisson.numeric.method.taylor import Taylor
from liepoisson.numeric.methods import METHODS, method_of, method_record

T = TypeVar("T")

INSIDE = {
    "DiscreteSymmetry": "liepoisson.model.discrete_symmetries",
    "Level": "liepoisson.orbits.level",
    "ScaledLeaf": "liepoisson.tori.lagrange_leaves",
    "UnstableSpace": "liepoisson.orbits.unstable_spaces",
}
"""Dataclasses that are written by their fields, with their modules; all others are in the chapter `results`."""
FOLDERS = ("liepoisson.equilibrium.", "liepoisson.orbits.", "liepoisson.tori.")
"""Where the others are defined: no file makes an object of another folder."""


@cache
def written_by_fields() -> dict[str, str]:
    """The modules of the dataclasses that are written by their fields, by name."""
    return {name: home for name, home in homes_of_results().items() if home.startswith(FOLDERS)} | INSIDE


class SavedWhole(Kept):
    """A result that is made of the classes of the chapter `results`."""

    def records(self) -> dict[str, Any]:
        """All of it as plain data that JSON can write."""
        writer = _Writer(self.system)
        whole = writer.plain(self)
        return {"record": {"whole": whole, "objects": writer.objects}}

    @classmethod
    def of_record(cls, record: Any, system: Any) -> Self:
        """The result whose "record" was written.

        Raises:
            Exception: of many kinds, if something is missing or altered.
        """
        found = _Reader(record["objects"], system).value(record["whole"])
        if type(found) is not cls:
            raise ValueError(f"record: wanted {cls.__name__}; got {type(found).__name__}")
        return found


class SavedOrbits(SavedWhole):
    """A result that is made of orbits and of what belongs to them."""

    @property
    def method(self) -> Method:
        """How its orbits were followed."""
        return Taylor()

    def records(self) -> dict[str, Any]:
        """All of it as plain data that JSON can write, and the method."""
        return super().records() | {"method": method_record(self.method)}


class SearchedOrbits(Found[T], SavedOrbits):
    """What a search among orbits found, with what it looked at."""

    n_starts: int
    is_cut_short: bool

    def _sentence(self, noun: str, where: str, starts: str, left_out: str = "") -> str:
        """What was found, and from what.

        Args:
            noun: One of them: "periodic orbit".
            where: Where they are.
            starts: What they were found from, with {} for how many.
            left_out: Of what is counted only: "that belong to families".
        """
        n, families = len(self.found), getattr(self, "n_families", 0)
        number = f"{'up to ' * self.is_cut_short}{self.n_starts}"
        return (
            f"{n or 'No'} {noun}{'s' * (n != 1)} {where}, found from {starts.format(number)}"
            f"{f'; {families} {left_out} are left out' * bool(families)}{CUT_SHORT * self.is_cut_short}; that there "
            "are no others is not proved."
        )


class _Writer:
    """Writes values; objects go to one list, to whose places the values refer."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.objects: list[Any] = []
        self._places: dict[int, int] = {}
        self._written: list[object] = []
        """What was written, so that no other object gets its number."""

    def plain(self, value: Any) -> Any:
        """A value as plain data: what JSON does not have is a dictionary that says what it is."""
        record: Any
        match value:
            case None | bool() | int() | float() | str():
                record = value
            case np.generic():
                record = value.item()
            case np.ndarray():
                parts = [value.real, value.imag] if value.dtype.kind == "c" else [value]
                record = {"array": [part.ravel().tolist() for part in parts], "shape": list(value.shape)}
                if not value.size and value.dtype.kind not in "fc":
                    record["dtype"] = value.dtype.str
            case tuple():
                record = [self.plain(one) for one in value]
            case Mapping():
                record = {"mapping": {name: self.plain(one) for name, one in value.items()}}
            case Fraction() | Expr():
                record = {"number": str(value)}
            case _:
                record = {"object": self._place(value)}
        return record

    def _place(self, value: Any) -> int:
        if (place := self._places.get(id(value))) is not None:
            return place
        record = self._record(value)
        self._places[id(value)] = place = len(self.objects)
        self._written.append(value)
        self.objects.append(record)
        return place

    def _record(self, value: Any) -> Any:
        name = type(value).__name__
        if isinstance(value, System):
            return {"System": self._other_values(value)}
        if isinstance(value, Leaf):
            return {"Leaf": self.plain({"system": value.system, "state": value.state, "casimirs": value.casimirs})}
        if isinstance(value, PhaseFunction):
            return {"PhaseFunction": formula_text(value.expression)}
        if isinstance(value, tuple(METHODS.values())):
            return {"Method": method_record(value)}
        if name in written_by_fields() and is_dataclass(value):
            return {name: self.plain({one.name: getattr(value, one.name) for one in fields(value)})}
        raise OutputError(f"a {name} cannot be written to a file; keep the table, to_csv(path)")

    def _other_values(self, system: System) -> Any:
        """The parameters of which a system has another value than that of the file: those of a family vary."""
        if are_equal(system, self.system):
            return {}
        given, own = flattened(values_of(system)), flattened(values_of(self.system))
        other = {name: value for name, value in given.items() if own.get(name) != value}
        record = {name: self.plain(value) for name, value in other.items()}
        if not (other and given.keys() == own.keys() and are_equal(_with_values(self.system, other), system)):
            raise OutputError(
                f"orbits of different systems, {self.system.name!r} and {system.name!r}, have no one file"
            )
        return record


def _with_values(system: System, values: Mapping[str, Any]) -> System:
    """The system with other values of some parameters."""
    for name, value in values.items():
        system = FreeParameter(system, name).at(value)
    return system


class _Reader:
    """Reads what `_Writer` has written."""

    def __init__(self, objects: Any, system: System) -> None:
        self.objects, self.system = objects, system
        self._made: dict[int, Any] = {}

    def value(self, record: Any) -> Any:
        """The value of plain data."""
        if isinstance(record, list):
            return tuple(self.value(one) for one in record)
        if not isinstance(record, dict):
            return record
        (kind, content), *rest = record.items()
        match kind:
            case "array":
                empty = dict(rest).get("dtype", np.float64)
                parts = [np.array(part, dtype=None if part else empty) for part in content]
                whole = parts[0] + 1j * parts[1] if len(parts) == 2 else parts[0]
                return whole.reshape(rest[0][1])
            case "mapping":
                return {name: self.value(one) for name, one in content.items()}
            case "number":
                return read_parameter(content, "number")
            case _:
                if content not in self._made:
                    ((name, inner),) = self.objects[content].items()
                    self._made[content] = self._object(name, inner)
                return self._made[content]

    def _object(self, name: str, record: Any) -> Any:
        if name == "System":
            return _with_values(self.system, {key: self.value(one) for key, one in record.items()})
        if name == "Method":
            return method_of(record)
        if name == "PhaseFunction":
            return self.system.functions.of(record)
        inner = self.value(record)
        if name == "Leaf":
            return leaf_of_values(Leaf.through(inner["system"], inner["state"]), inner["casimirs"])
        return class_of(name)(**inner)


@cache
def class_of(name: str) -> Any:
    """One of the dataclasses that are written by their fields, by its name."""
    return getattr(import_module(written_by_fields()[name]), name)
