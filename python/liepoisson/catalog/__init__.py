"""The named systems of the literature, as system files in the very format that users write, and families of systems.

Each file has its source, its known integrals and reference values; the tests prove the former and compute the latter.
Importing this module imports neither NumPy nor SymPy.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from liepoisson._lazy import unknown
from liepoisson.calls import explains_its_arguments
from liepoisson.catalog.families import (
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
from liepoisson.errors import UnknownNameError, did_you_mean

if TYPE_CHECKING:
    from liepoisson.exact.system import System
    from liepoisson.exact.system_file import SystemFile

__all__ = [
    "entry",
    "euler_top_on",
    "heavy_top_on",
    "henon_heiles",
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
        ['kovalevskaya', 'kovalevskaya-gyrostat']
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
    from liepoisson.exact.system_file_reader import read_system_file

    return read_system_file(path(name))


@explains_its_arguments
def system(name: str) -> System:
    """A system of the catalog, ready to be inspected or integrated.

    Example:
        >>> top = lp.catalog.system("kovalevskaya")
        >>> list(top.invariants), top.is_constant(top.integrals["K"])
        (['H', 'C1', 'C2', 'K'], True)

    Raises:
        UnknownNameError: there is none of this name.
    """
    return entry(name).system()


def _call(name: str) -> str:
    """How the system is had whose name was taken for one of the module."""
    known = name.replace("_", "-")
    return f'liepoisson.catalog.system("{known}")' if known in names() else ""


__getattr__ = unknown(__name__, __all__, _call)
