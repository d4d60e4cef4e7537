"""How messages quote a wrong value."""

from __future__ import annotations

from liepoisson.errors import ParameterError

_INSTEAD = {
    "LieAlgebra": "a Lie algebra is not a system yet: write System(algebra @ trivial(), hamiltonian)",
    "Extension": "write System(so(3) @ extension, hamiltonian)",
    "Bracket": "a bracket is not a system yet: write System(bracket, hamiltonian)",
    "str": 'write liepoisson.read_system(path), or liepoisson.catalog.system("kovalevskaya")',
    "Leaf": "its system is leaf.system",
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
        "only; the equations dx/dt = f(x) are those of H = p1*f1(x) + p2*f2(x) + ... on canonical(names=..., "
        "momenta=...)"
    )


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
