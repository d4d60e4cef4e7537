r"""Systems: a bracket and a Hamiltonian, from which everything else follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.arrays import as_array
from liepoisson.errors import ParameterError, ShapeError, UnsupportedFieldError
from liepoisson.exact.bracket import Bracket
from liepoisson.exact.parameters import (
    Column,
    Exact,
    Parameter,
    is_sympy,
    read_parameter,
    symbols_of,
    to_sympy,
)
from liepoisson.field import TopField

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.exact.top_parameters import TopParameters

Hamiltonian: TypeAlias = "Expr | Callable[..., Expr]"
"""An expression in `bracket.variables`, or a function of the field vectors (SymPy columns l, alpha, beta)."""


class System:
    r"""A Lie-Poisson system, $\dot x = \{x, H\} = J(x) \nabla H(x)$.

    Args:
        bracket: The Lie-Poisson bracket.
        hamiltonian: A SymPy expression in `bracket.variables`, or a Python function that takes one SymPy column per
            field (l, alpha, beta for three fields) and returns such an expression.
        parameters: Values for symbols that occur in the bracket or the Hamiltonian, by name.
        name: How the system is called in texts and files.

    Raises:
        ParameterError: the Hamiltonian is neither an expression nor a function, `parameters` is not a mapping from
            names, or a parameter is not exact.
        BracketError: a parameter is named like a coordinate.
    """

    def __init__(
        self,
        bracket: Bracket,
        hamiltonian: Hamiltonian,
        parameters: Mapping[str, Parameter] | None = None,
        *,
        name: str | None = None,
    ) -> None:
        if not isinstance(bracket, Bracket):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise ParameterError(
                f"the bracket must be of type Bracket; got {type(bracket).__name__}. Write for example "
                "so(3) @ leibniz(3, 1)."
            )
        if not callable(hamiltonian) and not _is_expression(hamiltonian):
            raise ParameterError(
                "the Hamiltonian must be a SymPy expression in bracket.variables or a Python function of the field "
                f"vectors; got {hamiltonian!r} of type {type(hamiltonian).__name__}. "
                "Write for example lambda l, alpha, beta: l.dot(l) / 2 + alpha[2]."
            )
        self._given_hamiltonian = hamiltonian
        self.parameters: dict[str, Exact] = _read_values(parameters)
        bracket.check_parameter_names(set(self.parameters).union(*map(symbols_of, self.parameters.values())))
        self._bracket_symbols = bracket.symbols
        self.bracket: Bracket = bracket.substitute(self.parameters) if self.parameters else bracket
        self.name: str = name or "Lie-Poisson system"

    @property
    def variables(self) -> tuple[Symbol, ...]:
        """The coordinates of phase space, in the order of the state vector."""
        return self.bracket.variables

    @cached_property
    def hamiltonian(self) -> Expr:
        """The Hamiltonian as a SymPy expression, with the parameters inserted.

        Raises:
            ParameterError: the given function does not return a SymPy expression, or the Hamiltonian is not finite
                and real.
        """
        given: Any = self._given_hamiltonian
        expression = given if _is_expression(given) else _applied(given, self.bracket.fields)
        if not _is_expression(expression):
            raise ParameterError(
                f"the Hamiltonian function must return a SymPy expression; got {type(expression).__name__}. "
                "Return a scalar built from its arguments, such as l.dot(l) / 2."
            )
        energy = self._with_parameters(_with_exact_numbers(expression))
        _check_real(energy)
        return energy

    def _with_parameters(self, expression: Expr) -> Expr:
        """The expression with the parameters inserted, by name: a symbol may have been made with assumptions."""
        for name, value in self.parameters.items():
            symbols = [symbol for symbol in expression.free_symbols if str(symbol) == name]
            if not symbols and name not in self._bracket_symbols:
                raise ParameterError(
                    f"a parameter must occur in the bracket or in the Hamiltonian; {name!r} occurs in neither. "
                    f"Known there: {', '.join(sorted(self._bracket_symbols | _names(expression)))}."
                )
            expression = expression.subs({symbol: to_sympy(value) for symbol in symbols})
        return expression

    @cached_property
    def equations(self) -> dict[Symbol, Expr]:
        """The right-hand sides of the equations of motion, derived from the bracket, in the order of `variables`."""
        return dict(zip(self.variables, self.bracket.vector_field(self.hamiltonian), strict=True))

    @cached_property
    def invariants(self) -> dict[str, Expr]:
        """What is known to be constant: H, the Casimirs C1, C2, ..., and the known integrals of this case.

        For a top (typed by hand or made by `Top`) see `liepoisson.exact.known_integrals`.
        """
        from liepoisson.exact.known_integrals import known_integrals

        found: dict[str, Expr] = {"H": self.hamiltonian}
        found |= {f"C{k}": casimir for k, casimir in enumerate(self.bracket.casimirs(), start=1)}
        top = self.top_parameters
        return found if top is None else found | known_integrals(top, *self.bracket.fields.values())

    @cached_property
    def top_parameters(self) -> TopParameters | None:
        """The exact parameters of the top with these equations, or None if there is no such top."""
        return self._recognise_top()

    def field(self) -> TopField:
        """The vector field as plain data for the numeric core.

        Raises:
            UnsupportedFieldError: the derived equations are not those of a top.
            ParameterError: a parameter is symbolic.
        """
        top = self.top_parameters
        if top is None:
            raise UnsupportedFieldError(
                f"the numeric core integrates tops, x = (l, alpha, beta); the equations of {self.name!r} are not those "
                "of a top with diagonal inertia. Use System.vector_field with an integrator of your choice."
            )
        return top.field()

    def vector_field(self, x: ArrayLike) -> NDArray[np.float64]:
        r"""The right-hand side $J \nabla H$ at many states.

        Args:
            x: States, shape (..., N), dimensionless.

        Returns:
            Time derivatives, shape (..., N).

        Raises:
            ShapeError: the last axis of `x` is not N.
            ParameterError: a parameter is symbolic.
        """
        return np.stack(self._evaluate(list(self.equations.values()), x), axis=-1)

    def invariant_values(self, x: ArrayLike) -> dict[str, NDArray[np.float64]]:
        """The invariants at many states.

        Args:
            x: States, shape (..., N), dimensionless.

        Returns:
            One array of shape (...) per name in `invariants`.

        Raises:
            ShapeError: the last axis of `x` is not N.
            ParameterError: a parameter is symbolic.
        """
        return dict(zip(self.invariants, self._evaluate(list(self.invariants.values()), x), strict=True))

    def describe(self) -> str:
        """The bracket, the Hamiltonian, the equations and the invariants as text."""
        from liepoisson.exact.describe import describe

        return describe(self)

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: everything but the compiled functions, which are made again when they are asked for."""
        return {name: value for name, value in self.__dict__.items() if name != "_numpy_functions"}

    def __repr__(self) -> str:
        return f"<System {self.name!r} on {self.bracket!r}>"

    def _recognise_top(self) -> TopParameters | None:
        from liepoisson.exact.top_parameters import match_top

        return match_top(self.bracket, self.equations)

    def _evaluate(self, expressions: list[Expr], x: ArrayLike) -> list[NDArray[np.float64]]:
        states = as_array(x, "x")
        n = self.bracket.dimension
        if states.ndim == 0 or states.shape[-1] != n:
            fields = ", ".join(self.bracket.extension.field_names)
            hint = " Transpose it?" if states.ndim > 1 and states.shape[0] == n else ""
            raise ShapeError(f"x must end in {n} components ({fields}); got shape {states.shape}.{hint}")
        values = self._compiled(tuple(expressions))(*np.moveaxis(states, -1, 0))
        return [np.array(np.broadcast_to(value, states.shape[:-1]), dtype=np.float64) for value in values]

    def _compiled(self, expressions: tuple[Expr, ...]) -> Callable[..., list[NDArray[np.float64]]]:
        if expressions not in self._numpy_functions:
            from sympy import lambdify

            free = {s for e in expressions for s in e.free_symbols} - set(self.variables)
            if free:
                names = ", ".join(sorted(str(symbol) for symbol in free))
                raise ParameterError(
                    f"{self.name} must have numbers for all parameters; {names} has none. Give values."
                )
            function = lambdify(self.variables, list(expressions), modules="numpy", cse=True)
            self._numpy_functions[expressions] = cast("Callable[..., list[NDArray[np.float64]]]", function)
        return self._numpy_functions[expressions]

    @cached_property
    def _numpy_functions(self) -> dict[tuple[Expr, ...], Callable[..., list[NDArray[np.float64]]]]:
        return {}


def _applied(hamiltonian: Callable[..., Expr], fields: Mapping[str, Column]) -> Expr:
    """The Hamiltonian function of the field vectors."""
    from inspect import signature

    try:
        signature(hamiltonian).bind(*fields.values())
    except TypeError as error:
        raise ParameterError(
            f"the Hamiltonian function must take one vector per field, ({', '.join(fields)}); got one that does not "
            f"({error})."
        ) from None
    return hamiltonian(*fields.values())


def _with_exact_numbers(expression: Expr) -> Expr:
    """Floating-point numbers read as the decimals that they print as, like any other parameter."""
    from sympy import Float

    exact = {number: to_sympy(read_parameter(number, "H")) for number in expression.atoms(Float)}
    return cast("Expr", expression.xreplace(exact))


def _names(expression: Expr) -> set[str]:
    return {str(symbol) for symbol in expression.free_symbols}


def _is_expression(value: object) -> bool:
    """Whether this is a SymPy expression; asked without importing SymPy for a plain function."""
    if not is_sympy(value):
        return False
    from sympy import Expr

    return isinstance(value, Expr)


def _read_values(parameters: Mapping[str, Parameter] | None) -> dict[str, Exact]:
    given = cast("Any", {} if parameters is None else parameters)  # a caller without a type checker may pass anything
    if not isinstance(given, Mapping) or not all(isinstance(name, str) for name in cast("Mapping[object, Any]", given)):
        raise ParameterError(
            f'parameters must be a mapping from names to values; got {given!r}. Write for example {{"epsilon": 1}}.'
        )
    return {name: read_parameter(value, name) for name, value in cast("Mapping[str, Parameter]", given).items()}


def _check_real(energy: Expr) -> None:
    """Refuse infinities, undefined values and imaginary numbers, of which the equations could not be evaluated."""
    from sympy import expand, nan, oo, preorder_traversal, zoo

    expanded = expand(energy)
    if expanded.has(nan, oo, -oo, zoo) or any(
        part.is_number and part.is_extended_real is False for part in preorder_traversal(expanded)
    ):
        raise ParameterError(f"the Hamiltonian must be finite and real; got {energy}. Check its terms.")
