"""A system one of whose parameters varies: what families in a parameter are followed with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from liepoisson.formula.parameters import Parameter, flattened
from liepoisson.model.system import System
from liepoisson.model.tops import Top


@dataclass(frozen=True, eq=False)
class FreeParameter:
    """A parameter of a system that varies, with the number that the system has for it.

    Attributes:
        system: The system.
        name: The parameter, or a component of a vector: "g", "a3".
    """

    system: System
    name: str

    @cached_property
    def value(self) -> float:
        """Its number in the system."""
        return float(flattened(values_of(self.system))[self.name])  # pyright: ignore[reportArgumentType]

    @cached_property
    def symbolic(self) -> System:
        """The system with the parameter as a symbol."""
        return self.at(self.name)

    def at(self, value: Parameter) -> System:
        """The system with this value of the parameter."""
        system = self.system
        values: dict[str, Any] = {key: self._replaced(key, old, value) for key, old in values_of(system).items()}
        if isinstance(system, Top):
            return Top(inertia=values.pop("I"), name=system.name, **values)
        given = system.as_given
        energy = system.symbolic_hamiltonian if given.hamiltonian is None else given.hamiltonian
        return System(
            system.symbolic_bracket, energy, values, name=system.name, symbols=given.symbols,
            integrals=given.integrals, partial_integrals=given.partial_integrals, source=system.source,
        )  # fmt: skip

    def _replaced(self, key: str, old: Any, value: Parameter) -> Any:
        """The value of one parameter, which may be a vector or a matrix with this one as a component."""
        if not isinstance(old, tuple):
            return value if key == self.name else old
        flat = [value if name == self.name else entry for name, entry in flattened({key: old}).items()]
        n = len(flat) // len(old)
        return [flat[k : k + n] for k in range(0, len(flat), n)] if isinstance(old[0], tuple) else flat


def values_of(system: System) -> Mapping[str, Any]:
    """The parameters of a system by name: those that it was given, or I, a, b and epsilon of a `Top`."""
    if isinstance(system, Top):
        return {"I": system.inertia, "a": system.a, "b": system.b, "epsilon": system.epsilon}
    return system.values
