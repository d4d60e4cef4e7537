"""Systems whose parameters vary: what families in a parameter are followed with, and fits look for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar, cast

from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.compile.field import QuadraticField, TapeField
from liepoisson.compile.symbols import evaluated
from liepoisson.formula.parameters import Parameter, flattened
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.names import MOMENTUM_OF_TIME
from liepoisson.model.equations_of_motion import EquationsOfMotion
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.model.system import System
from liepoisson.model.tops import Top
from liepoisson.model.vector_field import VectorField
from liepoisson.structure.suspension import Suspension

if TYPE_CHECKING:
    from sympy import Expr, Symbol

E = TypeVar("E", bound=EquationsOfMotion)


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
        return with_values(self.system, {self.name: value})


def with_values(system: E, values: Mapping[str, Parameter]) -> E:
    """A system, or a vector field, with other values of some parameters, by the names of their components: "g", "a3".

    A value that is the name itself makes the parameter a symbol.
    """
    all_values: dict[str, Any] = {key: _replaced(key, old, values) for key, old in values_of(system).items()}
    if isinstance(system, Top):
        top: Any = Top(inertia=all_values.pop("I"), name=system.name, **all_values)
        return top
    if isinstance(system, VectorField):
        return system._at_values(all_values)  # pyright: ignore[reportPrivateUsage]  # each kind makes itself anew
    assert isinstance(system, System)
    given, bracket = system.as_given, system.symbolic_bracket
    energy = system.symbolic_hamiltonian if given.hamiltonian is None else given.hamiltonian
    period = None
    if isinstance(bracket, Suspension):  # which a Hamiltonian with time makes again
        bracket, period = bracket.base, bracket.period
        if not isinstance(energy, str):
            from sympy import Symbol

            energy = cast("Any", energy) - Symbol(MOMENTUM_OF_TIME)
    found: Any = System(
        bracket, energy, all_values, period=period, name=system.name, symbols=given.symbols,
        integrals=given.integrals, partial_integrals=given.partial_integrals, source=system.source,
    )  # fmt: skip
    return found


def _replaced(key: str, old: Any, values: Mapping[str, Parameter]) -> Any:
    """The value of one parameter, which may be a vector or a matrix with components among the values."""
    if not isinstance(old, tuple):
        return values.get(key, old)
    flat = [values.get(name, entry) for name, entry in flattened({key: old}).items()]
    n = len(flat) // len(old)
    return [flat[k : k + n] for k in range(0, len(flat), n)] if isinstance(old[0], tuple) else flat


class StateAndParameters:
    r"""A system with parameters as components of the state that do not move: $x' = f(x, p)$, $p' = 0$.

    Its flow has the derivatives by the parameters among those by the state.

    Args:
        symbolic: The system, with the parameters as symbols.
        names: The parameters.
        units: In which the coordinates are, numbers without rounding such as powers of two; by default 1.  A norm of
            the state, by which methods choose steps, has those of the parameters, too.
    """

    def __init__(self, symbolic: System | VectorField, *names: str, units: Sequence[float] | None = None) -> None:
        from sympy import S, Symbol

        self.name = symbolic.name
        self.parameters: tuple[Symbol, ...] = tuple(map(Symbol, names))
        self.variables: tuple[Symbol, ...] = (*symbolic.variables, *self.parameters)
        self.component_names = self.parts_of_state = (*symbolic.component_names, *names)
        self._symbolic: Any = symbolic
        rates: Any = tuple(symbolic.equations.values())
        if units is not None:
            scales = zip(self.parameters, map(Fraction, units), strict=True)
            scaled: Any = {p: p * to_sympy(unit) for p, unit in scales}
            rates = tuple(rate.xreplace(scaled) for rate in rates)
        self._rates = (*rates, *(cast("Expr", S.Zero) for _ in names))

    def field(self) -> QuadraticField | TapeField:
        """The vector field as plain data."""
        return self._field

    @cached_property
    def _field(self) -> QuadraticField | TapeField:
        from liepoisson.compile.lowering import field_of_equations

        return field_of_equations(self.variables, self._rates)

    def vector_field(self, states: Array) -> Array:
        """The rates, those of the parameters last: zero."""
        return evaluated(self.variables, self._rates, states)

    def functions(self) -> dict[str, PhaseFunction]:
        """H and the Casimirs."""
        casimirs = {f"C{k}": f for k, f in enumerate(self._symbolic.bracket.casimirs(), start=1)}
        return {name: self.function(f) for name, f in {"H": self._symbolic.hamiltonian, **casimirs}.items()}

    def function(self, function: str | Expr) -> PhaseFunction:
        """A function of the state and the parameters: an expression, or the text of one."""
        expression = self._symbolic.expression(function) if isinstance(function, str) else function
        return PhaseFunction(cast("Any", self), expression)

    def poisson_tensor(self, state: Array) -> Array:
        """The Poisson tensor of the system, shape (N, N), at one state with the parameters."""
        n = len(self.variables) - len(self.parameters)
        return evaluated(self.variables, self._entries, state).reshape(n, n)

    @cached_property
    def _entries(self) -> tuple[Expr, ...]:
        return tuple(self._symbolic.bracket.poisson_tensor().flat())


def values_of(system: EquationsOfMotion) -> Mapping[str, Any]:
    """The parameters of a system by name: those that it was given, or I, a, b and epsilon of a `Top`."""
    if isinstance(system, Top):
        return {"I": system.inertia, "a": system.a, "b": system.b, "epsilon": system.epsilon}
    return system.values
