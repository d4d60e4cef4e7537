"""A system one of whose parameters varies: what families in a parameter are followed with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

from liepoisson.compile.field import QuadraticField, TapeField
from liepoisson.compile.symbols import evaluated
from liepoisson.formula.parameters import Parameter, flattened
from liepoisson.inputs.arrays import Array
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.model.system import System
from liepoisson.model.tops import Top

if TYPE_CHECKING:
    from sympy import Expr, Symbol


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


class StateAndParameter:
    r"""A system with its parameter as a component of the state that does not move: $x' = f(x, p)$, $p' = 0$.

    Its flow has the derivatives by the parameter among those by the state.

    Args:
        variable: The system and the parameter.
    """

    def __init__(self, variable: FreeParameter) -> None:
        from sympy import S, Symbol

        symbolic = variable.symbolic
        self.name = symbolic.name
        self.parameter = Symbol(variable.name)
        self.variables: tuple[Symbol, ...] = (*symbolic.variables, self.parameter)
        self.component_names = self.parts_of_state = (*symbolic.component_names, variable.name)
        self._symbolic, self._rates = symbolic, (*symbolic.equations.values(), cast("Expr", S.Zero))

    def field(self) -> QuadraticField | TapeField:
        """The vector field as plain data."""
        from liepoisson.compile.lowering import field_of_equations

        return field_of_equations(self.variables, self._rates)

    def vector_field(self, states: Array) -> Array:
        """The rates, shape (..., N + 1)."""
        return evaluated(self.variables, self._rates, states)

    def functions(self) -> dict[str, PhaseFunction]:
        """H and the Casimirs."""
        casimirs = {f"C{k}": f for k, f in enumerate(self._symbolic.bracket.casimirs(), start=1)}
        return {name: self.function(f) for name, f in {"H": self._symbolic.hamiltonian, **casimirs}.items()}

    def function(self, function: str | Expr) -> PhaseFunction:
        """A function of the state and the parameter: an expression, or the text of one."""
        expression = self._symbolic.expression(function) if isinstance(function, str) else function
        return PhaseFunction(cast("Any", self), expression)

    def poisson_tensor(self, state: Array) -> Array:
        """The Poisson tensor of the system, shape (N, N), at one state with the parameter."""
        n = len(self.variables) - 1
        return evaluated(self.variables, self._entries, state).reshape(n, n)

    @cached_property
    def _entries(self) -> tuple[Expr, ...]:
        return tuple(cast("Any", self._symbolic.bracket.poisson_tensor()).flat())


def values_of(system: System) -> Mapping[str, Any]:
    """The parameters of a system by name: those that it was given, or I, a, b and epsilon of a `Top`."""
    if isinstance(system, Top):
        return {"I": system.inertia, "a": system.a, "b": system.b, "epsilon": system.epsilon}
    return system.values
