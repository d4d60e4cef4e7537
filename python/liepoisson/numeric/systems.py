"""What the numeric part asks of a system.

A field is enough to integrate: `HasField`.  What else some functions ask, a system that is only a field does not have;
they then do without it, or say what they want.  All of it is asked here, and `System` has all of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, TypeGuard, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.compile.field import Field, PiecesField, QuadraticField, TapeFunction, TopField, at_rest
from liepoisson.errors import ParameterError
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.refusals import not_a_system, shown

TOP_COMPONENTS = tuple(f"{vector}{i}" for vector in ("l", "alpha", "beta") for i in (1, 2, 3))


class HasField(Protocol):
    """A system that can be integrated: its name, for results, and its vector field."""

    @property
    def name(self) -> str:
        """Name of the system, for results."""
        ...

    def field(self) -> Field:
        """The vector field as plain data."""
        ...


def as_field(system: Any) -> Field:
    """The vector field of a system."""
    if isinstance(system, type) or not callable(getattr(system, "field", None)) or not hasattr(system, "name"):
        raise not_a_system(system)
    return system.field()


def core_field(field: Field) -> _core.Field:
    """The field as the core takes it."""
    if isinstance(field, TopField):
        return _core.Field.top(field.inertia, field.a, field.b, field.epsilon)
    if isinstance(field, QuadraticField):
        return _core.Field.quadratic(field.n_components, field.constant, field.linear, field.quadratic)
    if isinstance(field, PiecesField):
        return _core.Field.pieces(field.n_components, field.pieces)
    return _core.Field.tape(field.n_components, field.instructions, field.outputs, field.size_limits)


def core_fields(fields: Sequence[TopField] | Sequence[QuadraticField]) -> _core.Field:
    """Fields of one kind as the core takes them, one for each trajectory."""
    tops = [field for field in fields if isinstance(field, TopField)]
    if tops:
        return _core.Field.tops([(top.inertia, top.a, top.b, top.epsilon) for top in tops])
    quadratic = [field for field in fields if isinstance(field, QuadraticField)]
    return _core.Field.quadratics(
        quadratic[0].n_components, [(field.constant, field.linear, field.quadratic) for field in quadratic]
    )


def component_names(system: Any, n: int) -> tuple[str, ...]:
    """Names of the components of the state: the system's own, else those of the tops, else x1, x2, ...

    Raises:
        ParameterError: the system has names, and not one for each component of its field.
    """
    names = getattr(system, "component_names", None)
    if names is not None:
        if len(own := tuple(names)) != n:
            raise ParameterError(
                f"component_names: wanted {n} names, one for each component of the field of {system.name}; got "
                f"{len(own)}: {shown(own)}; name them all"
            )
        return own
    return TOP_COMPONENTS if n == len(TOP_COMPONENTS) else tuple(f"x{i + 1}" for i in range(n))


def periods_of_components(system: Any, n: int) -> Array:
    """The period of each component that is a point of a circle, infinite for the others, shape (component,)."""
    known: Mapping[str, Any] = getattr(system, "periods", {})
    if not known:
        return np.full(n, np.inf)
    return np.array([float(known.get(name, np.inf)) for name in component_names(system, n)])


def tangent_field(system: Any, field: Field) -> Field:
    r"""The field, given as the method integrates it, along which tangent vectors are measured.

    The momentum $p_t$ of time, the last component, drives nothing: the others are a flow by themselves, $(x, t)$.  It
    only adds up $-\partial H/\partial t$, and its tangent vector would grow like the square of the others, so it is
    held at rest.
    """
    return field if getattr(system, "clock", None) is None else at_rest(field, field.n_components - 1)


def n_of_time(system: Any) -> int:
    """How many of the last components are time and its momentum: 2 or 0."""
    return 0 if getattr(system, "clock", None) is None else 2


def at_equal_times(system: Any, tangents: Array) -> Array:
    """Tangent vectors, shape (..., component), without components along time and its momentum, if there are these."""
    found = tangents.copy()
    found[..., found.shape[-1] - n_of_time(system) :] = 0.0
    return found


def with_momentum_of_time(system: Any, start: Array, state: Array) -> Array:
    """States with the $p_t$ for which $H + p_t$ is that of the start; as they are where no time is.

    Args:
        system: The system.
        start: The starts, shape (trajectory, component).
        state: States of a run with $p_t$ at rest, shape (trajectory, ..., component).
    """
    if getattr(system, "clock", None) is None:
        return state
    found, energy = state.copy(), system.functions.energy
    with np.errstate(all="ignore"):  # a trajectory that failed has no energy
        begin = energy(start).reshape(len(start), *(1,) * (state.ndim - 2))
        found[..., -1] += begin - energy(state)
    return found


class HasFunctions(HasField, Protocol):
    """A system with a bracket: energy, Casimirs, Poisson tensor and other functions of the state, at many states."""

    @property
    def functions(self) -> Any:
        """`PhaseFunctions`: energy, of(expression), poisson_tensor(states), ..."""
        ...

    def vector_field(self, states: Any) -> Array:
        """The rates at many states."""
        ...


def has_functions(system: Any) -> TypeGuard[HasFunctions]:
    """Whether a system has a bracket, and so functions of the state."""
    return hasattr(system, "functions")


def known_constants(system: HasFunctions) -> Mapping[str, Any]:
    """Expressions of the known constants of the motion by name; none where a system lists none."""
    return getattr(system, "invariants", None) or {}


class HasInvariants(HasField, Protocol):
    """A system that knows constants of its motion."""

    def invariant_values(self, states: Any) -> dict[str, Array]:
        """The Hamiltonian, the Casimirs and known integrals by name, at many states."""
        ...


def has_invariants(system: Any) -> TypeGuard[HasInvariants]:
    """Whether a system knows constants of its motion."""
    return callable(getattr(system, "invariant_values", None))


def without_value(system: Any, states: Array) -> dict[str, NDArray[np.bool_]]:
    """Where invariants are no real numbers, by name, shape (...); empty if the system has none for which this may be.

    States that are not finite, where nothing has a value, are not meant.
    """
    told = getattr(system, "without_value", None)
    if not callable(told):
        return {}
    finite = np.isfinite(states).all(axis=-1)
    return {name: lost & finite for name, lost in cast("dict[str, NDArray[np.bool_]]", told(states)).items()}


def vector_length(system: Any, n_components: int) -> int:
    """Components of each vector of the state: the system's own word, else 3 where that fits, else all."""
    return getattr(system, "vector_length", 3 if n_components % 3 == 0 else n_components)


class HasPieces(HasField, Protocol):
    """A system whose Hamiltonian is a sum of pieces with known flows."""

    def pieces(self) -> PiecesField:
        """The pieces as plain data."""
        ...


def has_pieces(system: Any) -> TypeGuard[HasPieces]:
    """Whether a system tells the pieces of its Hamiltonian."""
    return callable(getattr(system, "pieces", None))


class ReadsFormulas(HasField, Protocol):
    """A system that reads functions of the state from texts or expressions."""

    def function_tape(self, *functions: Any) -> TapeFunction:
        """Functions as plain data."""
        ...


def reads_formulas(system: Any) -> TypeGuard[ReadsFormulas]:
    """Whether a system reads functions of the state."""
    return callable(getattr(system, "function_tape", None))


class HasBracket(HasField, Protocol):
    """A system that knows its bracket exactly."""

    @property
    def variables(self) -> tuple[Any, ...]:
        """The coordinates of phase space, as symbols."""
        ...

    def is_casimir(self, function: Any) -> bool:
        """Whether the bracket of a function with each coordinate is zero."""
        ...

    def expression(self, function: Any) -> Any:
        """A function of the state as an expression."""
        ...


def has_bracket(system: Any) -> TypeGuard[HasBracket]:
    """Whether a system knows its bracket exactly."""
    return callable(getattr(system, "is_casimir", None)) and getattr(system, "bracket", None) is not None
