"""Checks that the functions on phase space share: systems with numbers for all parameters, and energies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_number
from liepoisson.inputs.refusals import not_a_system

if TYPE_CHECKING:
    from liepoisson.model.system import System


def as_system(system: Any) -> System:
    """A system whose parameters are all numbers.

    Raises:
        ParameterError: it is no system (a text, a class, ...), or a parameter has no number.
    """
    from liepoisson.model.system import System

    if not isinstance(system, System):
        raise not_a_system(system)
    if len(system.component_names) != system.bracket.dimension:
        found = ", ".join(system.component_names[system.bracket.dimension :])
        raise ParameterError(
            f"system: wanted one whose state is a point of its phase space; {system.name} has {found} besides, found "
            "by quadrature; make it without quadratures"
        )
    if system.polynomial_hamiltonian is not None:
        return system
    in_energy = {str(symbol) for symbol in system.hamiltonian.free_symbols if symbol not in system.variables}
    if free := in_energy | system.bracket.symbols:
        names = ", ".join(sorted(free))
        raise ParameterError(f"{system.name} must have numbers for all parameters; {names} has none. Give values.")
    return system


def are_equal(first: System, second: System) -> bool:
    """Whether two systems have the same coordinates, bracket and Hamiltonian, whatever their names."""
    if first is second:
        return True
    names = [[str(x) for x in system.variables] for system in (first, second)]
    if names[0] != names[1] or set(first.bracket.entries()) != set(second.bracket.entries()):
        return False
    difference = first.hamiltonian - second.hamiltonian
    return bool(difference == 0 or difference.expand() == 0)


def as_energy(value: Any, name: str = "energy") -> float:
    """A finite energy as a plain float.

    Raises:
        ParameterError: it is no finite real number.
    """
    energy = as_number(value, name, "a finite number")
    if not np.isfinite(energy):
        raise ParameterError(f"{name} must be a finite number; got {energy}. Take one of leaf.energy_range().")
    return energy
