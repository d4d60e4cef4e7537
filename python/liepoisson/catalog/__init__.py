"""The named systems of the literature, as system files in the very format that users write, and families of systems.

Each file has its source, its known integrals and reference values; the tests prove the former and compute the latter.
Importing this module imports neither NumPy nor SymPy.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from liepoisson._lazy import unknown
from liepoisson.catalog.families import (
    cubic_top,
    euler_top_on,
    heavy_top_on,
    henon_heiles,
    leibniz_top,
    manakov,
    reduced_mhd,
    su_top,
    toda,
    twisted_top_on,
    vorticity,
    zeitlin,
)
from liepoisson.catalog.unital_tops import kovalevskaya_top, lagrange_top
from liepoisson.errors import UnknownNameError, did_you_mean
from liepoisson.inputs.calls import explains_its_arguments

if TYPE_CHECKING:
    from liepoisson.formula.parameters import GivenValue
    from liepoisson.model.system import System
    from liepoisson.model.system_file import SystemFile

__all__ = [
    "cubic_top",
    "entry",
    "euler_top_on",
    "heavy_top_on",
    "henon_heiles",
    "kovalevskaya_top",
    "lagrange_top",
    "leibniz_top",
    "manakov",
    "names",
    "path",
    "reduced_mhd",
    "su_top",
    "system",
    "toda",
    "twisted_top_on",
    "vorticity",
    "zeitlin",
]

_FOLDER = Path(__file__).parent


@explains_its_arguments
@cache
def names() -> tuple[str, ...]:
    """The names of all systems of the catalog, in alphabetical order.

    Example:
        >>> [name for name in lp.catalog.names() if name.startswith("kovalevskaya")]
        ['kovalevskaya', 'kovalevskaya-gyrostat', 'kovalevskaya-so4']
    """
    return tuple(sorted(file.stem for file in _FOLDER.glob("*.toml")))


@explains_its_arguments
def path(name: str) -> Path:
    """The file of a system: a good start for a file of one's own.

    Example:
        >>> lines = lp.catalog.path("lagrange").read_text(encoding="utf-8").splitlines()
        >>> lines[lines.index("[hamiltonian]") + 1]
        'expression = "dot(l, inv(I)*l)/2 + dot(a, alpha)"'

    Raises:
        UnknownNameError: there is none of this name; the message gives the nearest names.
    """
    if name in names():
        return _FOLDER / f"{name}.toml"
    hint = (
        did_you_mean(name, names())
        or "Try one of these; a file is read by lp.read_system(path), or by its path in a command. "
    )
    raise UnknownNameError(f"there is no system {name!r} in the catalog. {hint}Known: {', '.join(names())}.")


@explains_its_arguments
def entry(name: str) -> SystemFile:
    """What the catalog knows of a system: bracket, Hamiltonian, parameters, source, integrals, reference values.

    Example:
        >>> toda = lp.catalog.entry("toda")
        >>> toda.hamiltonian
        'dot(p, p)/2 + exp(q1 - q2) + exp(q2 - q3) + exp(q3 - q1)'
        >>> list(toda.integrals)
        ['P', 'K']

    Raises:
        UnknownNameError: there is none of this name.
    """
    from liepoisson.model.system_file_reader import read_system_file

    return replace(read_system_file(path(name)), proved=True)


@explains_its_arguments
def system(name: str, parameters: Mapping[str, GivenValue] | None = None) -> System:
    """A system of the catalog, ready to be inspected or integrated, perhaps with other values of its parameters.

    With other values its name says so, and those of its integrals that are then not constant are left out.

    Example:
        >>> top = lp.catalog.system("kovalevskaya")
        >>> list(top.invariants), top.is_constant(top.integrals["K"])
        (['H', 'C1', 'C2', 'K'], True)
        >>> other = lp.catalog.system("kovalevskaya", {"I": [2, "3/2", 1]})
        >>> other.name, list(other.invariants)
        ('kovalevskaya, I = (2, 3/2, 1)', ['H', 'C1', 'C2'])

    Args:
        name: One of `names()`.
        parameters: Values by name, as for a `System`, of the shapes that they have in the catalog
            (`entry(name).parameters` and `entry(name).symbols`); all others keep theirs.

    Raises:
        UnknownNameError: there is none of this name.
        ParameterError: a name that is no parameter of the system, a value that is not exact, or one of another shape.
    """
    file = entry(name)
    if parameters is not None:
        file = file.with_parameters(parameters).with_constant_integrals()
    return file.system()


def _call(name: str) -> str:
    """How the system is had whose name was taken for one of the module."""
    known = name.replace("_", "-")
    return f'liepoisson.catalog.system("{known}")' if known in names() else ""


__getattr__ = unknown(__name__, __all__, _call)
