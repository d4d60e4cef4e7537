"""Equations of motion with exact numbers, and functions of the state: what a `System` and a `VectorField` share.

A class that is made of such equations says what its coordinates and equations are and which names formulas may use.
The rest follows: values at many states, functions that are read from texts, and constants that were given.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from math import pi
from typing import TYPE_CHECKING, Any, Protocol, cast

from liepoisson.algebra.exact_numbers import Coefficient, Exact, substituted, symbols_of, to_sympy
from liepoisson.algebra.rational_polynomials import values_of
from liepoisson.compile.field import Field, TapeFunction
from liepoisson.compile.typed import Names, read_system
from liepoisson.errors import ExpressionError, LiePoissonError, ParameterError
from liepoisson.formula.parameters import Kept, Value, exact_value, flattened
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.names import MOMENTUM_OF_TIME
from liepoisson.inputs.read_only import ReadOnlyDict
from liepoisson.inputs.refusals import shown
from liepoisson.model.hamiltonian import RESERVED_NAME, is_expression
from liepoisson.structure.given_expressions import read_expression_in, with_exact_numbers

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray
    from sympy import Expr, Matrix, Symbol

    from liepoisson._core import TypedSystem
    from liepoisson.algebra.rational_polynomials import RationalPolynomial
    from liepoisson.formula.scope import Scope

_NAME = re.compile(r"[A-Za-z_]\w*")


@lru_cache(maxsize=1024)
def _symbols_in(expressions: tuple[Expr, ...]) -> frozenset[Symbol]:
    """The symbols of expressions, which are looked through once."""
    return frozenset(cast("Symbol", symbol) for expression in expressions for symbol in expression.free_symbols)


def check_source(source: object) -> str:
    """The text that says where equations are described.

    Raises:
        ParameterError: it is none.
    """
    if not isinstance(source, str) or not source.strip() or any("\ud800" <= c <= "\udfff" for c in source):
        raise ParameterError(f"source: wanted a text that says where the system is described; got {shown(source)}")
    return source


class HasExpression(Protocol):
    """A function of the state that knows its formula, such as a `PhaseFunction`."""

    @property
    def expression(self) -> Expr:
        """The function as a SymPy expression."""
        ...


class PolynomialEquations(Protocol):
    """Equations that are rational polynomials, and what is told of functions without SymPy."""

    def read(self, text: str) -> RationalPolynomial | None:
        """A formula; None if it is no small polynomial."""
        ...

    def is_constant(self, function: RationalPolynomial) -> bool | None:
        """Whether the derivative of a function along the motion vanishes; None if it is too large."""
        ...


@explains_its_methods
class EquationsOfMotion:
    """Equations of motion, and functions of the state.

    Attributes:
        name: How the equations are called in texts and files.
        source: Where they are described.
    """

    name: str
    source: str | None
    _kept_values: dict[str, Kept]
    _numbers: dict[str, Coefficient]
    _given_symbols: tuple[str, ...]
    _given_integrals: dict[str, str | Expr]

    @cached_property
    def values(self) -> dict[str, Value]:
        """The parameters by name: numbers, vectors, matrices."""
        return ReadOnlyDict({name: exact_value(value) for name, value in self._kept_values.items()})

    @cached_property
    def parameters(self) -> dict[str, Exact]:
        """The same, one entry for each number: I1, I2, I3 of a vector I."""
        return ReadOnlyDict(flattened(self.values))

    @property
    def variables(self) -> tuple[Symbol, ...]:
        """The coordinates, in the order of the state vector."""
        raise NotImplementedError

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the coordinates, in the order of the state vector."""
        raise NotImplementedError

    @property
    def clock(self) -> str | None:
        """Name of the coordinate that is time, if there is one."""
        return None

    @property
    def parts_of_state(self) -> tuple[str, ...]:
        """What the state consists of, in messages."""
        raise NotImplementedError

    @cached_property
    def periods(self) -> dict[str, Expr]:
        r"""The periods of the coordinates that are points of circles, by name: $2\pi$ of an angle."""
        raise NotImplementedError

    @property
    def _names_of_angles(self) -> tuple[str, ...]:
        """The coordinates that are angles."""
        raise NotImplementedError

    def _check_on_circles(self, functions: Mapping[str, Expr], hint: str) -> None:
        """Refuse functions that are not periodic in the coordinates on circles; by what they are in messages."""
        if self.periods:
            from liepoisson.structure.circles import check_on_circles

            periods: Any = {str(x): (x, self.periods[str(x)]) for x in self.variables if str(x) in self.periods}
            check_on_circles(functions.items(), periods, hint)

    @cached_property
    def equations(self) -> dict[Symbol, Expr]:
        """The right-hand sides of the equations of motion, in the order of `variables`."""
        raise NotImplementedError

    @cached_property
    def invariants(self) -> dict[str, Expr]:
        """What is known to be constant, by name."""
        raise NotImplementedError

    @property
    def polynomial_rates(self) -> tuple[RationalPolynomial, ...] | None:
        """The equations as rational polynomials that were read without SymPy; None where they are no such."""
        raise NotImplementedError

    @cached_property
    def polynomial_invariants(self) -> dict[str, RationalPolynomial] | None:
        """The `invariants` in the same way; None where one of them is no rational polynomial."""
        raise NotImplementedError

    @cached_property
    def _typed_invariants(self) -> Mapping[str, Callable[[ArrayLike], NDArray[np.float64]]] | None:
        """The `invariants` as functions of arrays that need no SymPy; None where they cannot be had so."""
        return None

    @cached_property
    def _polynomials(self) -> PolynomialEquations | None:
        """The equations, if they are rational polynomials that were read without SymPy."""
        raise NotImplementedError

    @property
    def size_limits(self) -> tuple[float | None, ...]:
        """The largest size with which each component counts where tolerances are relative to the size of a state.

        A turn of an angle, 0 for time and its momentum, None without limit; empty if there is no limit at all.
        """
        limits = dict.fromkeys(self._names_of_angles, 2 * pi)
        if self.clock is not None:
            limits |= {self.clock: 0.0, MOMENTUM_OF_TIME: 0.0}
        return tuple(limits.get(name) for name in self.component_names) if limits else ()

    def field(self) -> Field:
        """The vector field as plain data for the numeric core."""
        raise NotImplementedError

    def derivative(self, function: str | Expr) -> Expr:
        """The time derivative of a function of the state."""
        raise NotImplementedError

    @property
    def _names_of_state(self) -> Names:
        """The coordinates, as formulas call them."""
        raise NotImplementedError

    @property
    def _given_functions(self) -> Mapping[str, str | Expr]:
        """The functions of the state that were given, by name."""
        return self._given_integrals

    def _with_integrals(self, found: Mapping[str, Expr]) -> dict[str, Expr]:
        """What is known to be constant, and the integrals that were given.

        Raises:
            ParameterError: a given integral is not constant.
        """
        constants = dict(found)
        for name, integral in self.integrals.items():
            if not self.is_constant(integral):
                raise ParameterError(
                    f"the integral {name} must be constant along the motion; got {integral}, which is not: "
                    f"its derivative is {self.derivative(integral)}. Correct it, or give it as a partial integral."
                )
            constants.setdefault(name, integral)
        return constants

    @property
    def divergence(self) -> Expr:
        r"""The rate $\sum_i\partial\dot x_i/\partial x_i$ at which the flow changes volumes, expanded."""
        jacobian: Any = self.jacobian
        return jacobian.trace().expand()

    def polynomial(self, function: str | Expr | HasExpression) -> RationalPolynomial | None:
        """What `expression` returns, as a rational polynomial and without SymPy; None if it is not the text of one."""
        if not isinstance(function, str) or self._polynomials is None:
            return None
        name = function.strip()
        if RESERVED_NAME.fullmatch(name) or name in self._given_integrals:
            return None  # may be the name of an invariant
        return self._polynomials.read(function)

    def _scope_with(self, *further: str) -> Scope:
        """The names that formulas may use, and further symbols."""
        raise NotImplementedError

    @cached_property
    def _names_in_formulas(self) -> Scope:
        return self._scope_with()

    @cached_property
    def _parameter_names(self) -> tuple[str, ...]:
        """The names of all parameters, and those in their values."""
        in_values = set[str]().union(*map(symbols_of, self._numbers.values()))
        return tuple(sorted((self._names_in_formulas.numbers() | in_values).difference(self.component_names)))

    @property
    def jacobian(self) -> Matrix:
        r"""The matrix $\partial\dot x_i / \partial x_j$ of the equations of motion, shape (N, N)."""
        from sympy import Matrix

        return Matrix(list(self.equations.values())).jacobian(self.variables)

    @cached_property
    def integrals(self) -> dict[str, Expr]:
        """The integrals that were given, with the parameters inserted; claims, not proofs."""
        return {name: self._function(text) for name, text in self._given_integrals.items()}

    def is_constant(self, function: str | Expr) -> bool:
        """Whether a function on phase space is found constant along every orbit.

        Exact for polynomials and rational functions; for others SymPy has to simplify the derivative to zero, so True
        is a proof and False may mean that it did not succeed.
        """
        polynomial = self.polynomial(function)
        if polynomial is not None and self._polynomials is not None:
            known = self._polynomials.is_constant(polynomial)
            if known is not None:
                return known
        from liepoisson.algebra.exact_numbers import is_zero
        from liepoisson.structure.trace import abbreviated

        return is_zero(abbreviated(self.derivative(function))[0])

    @cached_property
    def _typed_functions(self) -> TypedSystem | None:
        """Functions of the state as the core reads them, which may be typed whatever the equations are made of."""
        return None if self._given_symbols else read_system(self._names_of_state, None, "0", self._kept_values)

    def vector_field(self, states: ArrayLike) -> NDArray[np.float64]:
        r"""The right-hand side $\dot x$ at many states; of a system $J \nabla H$.

        Args:
            states: Shape (..., N), dimensionless.

        Returns:
            Time derivatives, shape (..., N).

        Raises:
            ShapeError: the last axis of `states` is not N.
            ParameterError: a parameter is symbolic.
        """
        import numpy as np

        if self.polynomial_rates is not None:
            return values_of(self.polynomial_rates, self._states(states))
        return np.stack(self._evaluate(list(self.equations.values()), states), axis=-1)

    def right_hand_side(self, time: float, state: ArrayLike) -> NDArray[np.float64]:
        """The vector field in the convention of SciPy, for `scipy.integrate.solve_ivp` and tools like it.

        Args:
            time: Not used: the system is autonomous.
            state: One state, shape (N,).
        """
        return self.vector_field(state)

    def invariant_values(self, states: ArrayLike) -> dict[str, NDArray[np.float64]]:
        """The invariants at many states.

        Args:
            states: Shape (..., N), dimensionless.

        Returns:
            One array of shape (...) per name in `invariants`.

        Raises:
            ShapeError: the last axis of `states` is not N.
            ParameterError: a parameter is symbolic.
        """
        if (known := self.polynomial_invariants) is not None:
            values = values_of(known.values(), self._states(states))
            return {name: values[..., k].copy() for k, name in enumerate(known)}
        if (typed := self._typed_invariants) is not None:
            return {name: function(states) for name, function in typed.items()}
        return dict(zip(self.invariants, self._evaluate(list(self.invariants.values()), states), strict=True))

    def without_value(self, states: ArrayLike) -> dict[str, NDArray[np.bool_]]:
        """Where the Hamiltonian, if there is one, and the given integrals are no real numbers, such as log(-1).

        Args:
            states: Shape (..., N), dimensionless.

        Returns:
            One array of shape (...) for each of them that has a logarithm, a root, or an inverse sine or cosine.

        Raises:
            ShapeError: the last axis of `states` is not N.
            ParameterError: a parameter is symbolic.
        """
        import numpy as np

        if not self._partial_functions:
            return {}
        x = self._states(states)
        return {name: np.isnan(self._values(f, x)) for name, f in self._partial_functions.items()}

    def _values(self, function: TapeFunction | Expr, states: NDArray[np.float64]) -> NDArray[np.float64]:
        import numpy as np

        from liepoisson.compile.tape_values import values_of_tape

        if isinstance(function, TapeFunction):
            return values_of_tape(function, states)[..., 0]
        with np.errstate(all="ignore"):
            return self._evaluate([function], states)[0]

    @cached_property
    def _partial_functions(self) -> dict[str, TapeFunction | Expr]:
        """Those of the given functions that are not real at all states; of texts the tapes."""
        from liepoisson.compile.tape_values import has_partial_operations
        from liepoisson.formula.expression import is_partial
        from liepoisson.model.hamiltonian import has_partial_functions

        found: dict[str, TapeFunction | Expr] = {}
        for name, given in self._given_functions.items():
            if isinstance(given, str):
                if is_partial(given) and has_partial_operations(tape := self.function_tape(given)):
                    found[name] = tape
                continue
            function = self._function(given)
            if has_partial_functions(function):
                found[name] = function
        return found

    def expression(self, function: str | Expr | HasExpression) -> Expr:
        """A function on phase space with the parameters inserted.

        Args:
            function: A text like that of a Hamiltonian, in which angles `atan2(y, x)` may occur, too; or the name of an
                invariant alone (one of the keys of `invariants`, such as "C1"); a SymPy expression; or a PhaseFunction.

        Raises:
            ExpressionError: the text is not in the grammar, or a name in it is not known; with the position.
            ParameterError: the function is none of these, or a name alone stands for an invariant and for something
                else, such as C1 for a Casimir and for a component of a parameter C.
        """
        given: Any = function
        if not isinstance(function, str) and not is_expression(function):
            given = getattr(function, "expression", function)
        if not isinstance(given, str):
            if not is_expression(given):
                raise ParameterError(
                    f"a function on phase space must be a text such as '{self.component_names[0]} - 1/2', a SymPy "
                    f"expression or a PhaseFunction; got {given!r:.60}."
                )
            return self._function(given)
        try:
            expression = self._function(given, angles=True)
        except ExpressionError as error:
            return self._named_invariant(given, error)
        self._check_that_it_names_one_thing(given, expression)
        return expression

    def _check_that_it_names_one_thing(self, text: str, expression: Expr) -> None:
        """Refuse a text that is both a formula and the name of an invariant, where they differ."""
        name = text.strip()
        if not (RESERVED_NAME.fullmatch(name) or name in self._given_integrals):
            return
        invariant = self.invariants.get(name)
        if invariant is not None and invariant != expression:
            raise ParameterError(
                f"a name must stand for one thing; {name} is {expression} in formulas, and the invariant {invariant}. "
                f"Write 1*{name} for the former, system.invariants[{name!r}] for the latter."
            )

    def _named_invariant(self, text: str, error: ExpressionError) -> Expr:
        """The invariant that a text names, which is no formula; if it only contains such a name, say what to write."""
        names = set(_NAME.findall(text))
        known = [name for name in self.invariants if name in names]
        if not known:
            raise error
        if text.strip() == known[0]:
            return self.invariants[known[0]]
        hint = ", ".join(f"system.invariants[{name!r}]" for name in known)
        raise ExpressionError(
            f"{error.message}; an invariant is known by its name only where that is the whole text. Build the "
            f"expression from {hint}",
            text,
            error.position,
        ) from None

    def function_of_invariants(self, text: str) -> Expr:
        """A text like that of a Hamiltonian in which the names of invariants may occur, too: "C1 - 2*H".

        Raises:
            ExpressionError: the text is not in the grammar, or a name in it is not known; with the position.
        """
        from sympy import Symbol

        from liepoisson.formula.expression import read_expression

        try:
            return self.expression(text)
        except ExpressionError:
            names = [name for name in self.invariants if name in set(_NAME.findall(text))]
            if not names:
                raise
        read: Any = self._with_parameters(read_expression(text, self._scope_with(*names)))
        return read.xreplace({Symbol(name): self.invariants[name] for name in names})

    def function_tape(self, *functions: str | Expr) -> TapeFunction:
        """Functions on phase space as plain data for the numeric core, one output each.

        Raises:
            UnsupportedFieldError: a function is not smooth.
            ParameterError: a parameter is symbolic.
        """
        from liepoisson.compile.lowering import functions_of, tape_of_functions

        texts = [function for function in functions if isinstance(function, str)]
        if len(texts) == len(functions) and self._typed_functions is not None:
            try:
                return functions_of(self._typed_functions.functions(texts))
            except LiePoissonError:  # SymPy says what is wrong
                pass
        return tape_of_functions(self.variables, [self._function(function, angles=True) for function in functions])

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: everything but what is made again when it is asked for."""
        made_again = {"functions", "moving", "_typed", "_typed_functions"}
        return {name: value for name, value in self.__dict__.items() if name not in made_again}

    def _states(self, x: ArrayLike) -> NDArray[np.float64]:
        from liepoisson.formula.scalars import as_phase_points

        return as_phase_points(x, self.component_names, self.parts_of_state)

    def _evaluate(self, expressions: list[Expr], x: ArrayLike) -> list[NDArray[np.float64]]:
        from liepoisson.compile.symbols import evaluated

        states = self._states(x)
        free = _symbols_in(tuple(expressions)) - set(self.variables)
        if free:
            names = ", ".join(sorted(map(str, free)))
            raise ParameterError(
                f"{self.name} must have numbers for all parameters; got none for {names}. Give values."
            )
        values = evaluated(self.variables, expressions, states)
        return [values[..., k].copy() for k in range(len(expressions))]

    def _read(self, given: str | Expr, *, angles: bool = False) -> Expr:
        """A function on phase space with parameters as symbols: text is read in our grammar."""
        if not isinstance(given, str):
            return self._in_own_variables(with_exact_numbers(self._read_expression(given)))
        from liepoisson.formula.expression import read_expression

        return read_expression(given, self._names_in_formulas, angles=angles)

    def _in_own_variables(self, expression: Expr) -> Expr:
        """The expression in `variables`: for SymPy, a symbol that was made with assumptions is another one."""
        own = {str(variable): variable for variable in self.variables}
        foreign = {s: own[str(s)] for s in expression.free_symbols if str(s) in own and s != own[str(s)]}
        return cast("Expr", expression.xreplace(foreign)) if foreign else expression

    def _read_expression(self, given: object) -> Expr:
        """A function on phase space that is given as an expression, as it is."""
        return read_expression_in(given, self.component_names, self._parameter_names, self.parameters)

    def _function(self, given: str | Expr, *, angles: bool = False) -> Expr:
        return self._with_parameters(self._read(given, angles=angles))

    def _with_parameters(self, expression: Expr) -> Expr:
        """The expression with the parameters inserted, by name: a symbol may have been made with assumptions."""
        return to_sympy(substituted(expression, self.parameters))

    def _check_that_values_are_final(self) -> None:
        """Refuse the value of a parameter that is, or contains, the name of another one with a value."""
        for name, value in self._numbers.items():
            if known := sorted(symbols_of(value) & self._numbers.keys() - {name}):
                raise ParameterError(
                    f"the value of a parameter must not depend on another one that has a value; {name} = {value}, and "
                    f"{known[0]} is {self._numbers[known[0]]}. Write the number."
                )
