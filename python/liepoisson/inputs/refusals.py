"""Checks that many functions share, and how messages quote a wrong value: "NAME: wanted this; got that; try this"."""

from __future__ import annotations

from collections.abc import Collection, Hashable
from typing import TypeVar

from liepoisson.errors import ParameterError, did_you_mean

T = TypeVar("T")

NO_BRACKET = (
    "a vector field has no bracket; what needs energies, Casimirs, leaves or their equilibria takes a System(bracket, "
    "hamiltonian)"
)

_INSTEAD = {
    "LieAlgebra": "a Lie algebra is not a system yet: write System(algebra @ trivial(), hamiltonian)",
    "Extension": "write System(so(3) @ extension, hamiltonian)",
    "Bracket": "a bracket is not a system yet: write System(bracket, hamiltonian)",
    "str": 'write liepoisson.read_system(path), or liepoisson.catalog.system("kovalevskaya")',
    "Leaf": "its system is leaf.system",
    "VectorField": NO_BRACKET,
    "DampedSystem": "a damped system has none of the energies and leaves of motion: give system.undamped",
    "TopField": "a field does not know its bracket: give the system that it is from",
    "QuadraticField": "a field does not know its bracket: give the system that it is from",
    "TapeField": "a field does not know its bracket: give the system that it is from",
    "PiecesField": "a field does not know its bracket: give the system that it is from",
}
"""What to do with things that are no systems, by the names of their types."""


def not_a_system(value: object) -> ParameterError:
    """The refusal of what came where a system was wanted."""
    kind = type(value).__name__
    hint = (
        "call it to make one"
        if isinstance(value, type)
        else _INSTEAD.get(kind, 'write System(bracket, hamiltonian), or liepoisson.catalog.system("kovalevskaya")')
    )
    return ParameterError(f"system: wanted a system such as Top.kovalevskaya(); got {shown(value)}; {hint}")


def not_a_whole_system(value: object) -> ParameterError:
    """The refusal of what came where a bracket and a Hamiltonian are needed, perhaps a vector field."""
    kind = type(value).__name__
    if isinstance(value, type) or kind in _INSTEAD or not callable(getattr(value, "field", None)):
        return not_a_system(value)
    return ParameterError(
        f"system: wanted a System, which has a bracket and a Hamiltonian; got {shown(value)}, which is a vector field "
        "only; the equations dx/dt = f(x) are a VectorField, for searches, and those of H = p1*f1(x) + p2*f2(x) + ... "
        "on canonical(names=..., momenta=...)"
    )


def check_kind(value: object, kind: type[T], name: str, wanted: str, hint: str) -> T:
    """The value, if it is of a class.

    Raises:
        ParameterError: it is of another.
    """
    if not isinstance(value, kind):
        raise not_a(wanted, value, name, hint)
    return value


def check_choice(value: object, name: str, choices: Collection[object], hint: str = "") -> None:
    """Refuse what is none of a few values; of texts the nearest one is named.

    Raises:
        ParameterError: it is none of them.
    """
    if isinstance(value, Hashable) and value in choices and not isinstance(value, bool):
        return
    said = [f'"{one}"' if isinstance(one, str) else str(one) for one in choices]
    wanted = " or ".join(filter(None, [", ".join(said[:-1]), said[-1]]))
    near = did_you_mean(value, map(str, choices)).strip()
    raise not_a(wanted, value, name, hint or near.replace("Did", "did") or "take one of these")


def not_a(wanted: str, value: object, name: str, hint: str) -> ParameterError:
    """The refusal of a value of the wrong type: what was wanted, what came, what to try."""
    return ParameterError(f"{name}: wanted {wanted}; got {shown(value)}; {hint}")


def shown(value: object) -> str:
    """A wrong value as a message quotes it: never long."""
    try:
        text = repr(value)
    except ValueError:  # an integer of thousands of digits has no repr
        text = "a very large number"
    return text if len(text) <= 60 else text[:57] + "..."


def counted(n: int, one: str, many: str = "") -> str:
    """A number with its noun: "1 point", "2 points"; the plural is given where it has more than an s."""
    return f"{n} {one if n == 1 else many or one + 's'}"
