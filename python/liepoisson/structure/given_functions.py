"""Names of coordinates and functions of them that callers give for brackets by formulas, as texts or expressions."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import as_expression, is_sympy, read_number, substituted, symbols_of, to_sympy
from liepoisson.errors import BracketError, ParameterError, ShapeError
from liepoisson.formula.expression import read_expression
from liepoisson.formula.parameters import GivenValue, flattened, read_values
from liepoisson.formula.scope import Scope
from liepoisson.inputs.given import listed, listed_names, named
from liepoisson.inputs.names import check_name
from liepoisson.structure.given_expressions import check_real, read_expression_in, with_exact_numbers

if TYPE_CHECKING:
    from sympy import Expr

MOST_VARIABLES = 100
"""Coordinates of the largest tensor."""


def read_variables(given: object) -> tuple[str, ...]:
    """The names of coordinates.

    Raises:
        ShapeError: no sequence of names.
        BracketError: a name is given twice.
        ParameterError: a name is none that a user may choose, or there are too many.
    """
    items = listed_names(given, "variables")
    if not items or not all(isinstance(item, str) for item in items):
        raise ShapeError(
            f'variables must be a sequence of names; got {given!r:.60}. Write for example ["x", "y", "z"].'
        )
    names = tuple(check_name(str(item), "the name of a coordinate") for item in items)
    if len({*names}) < len(names):
        raise BracketError(f"coordinates must have distinct names; got {list(names)!s:.100}. Rename one of them.")
    if len(names) > MOST_VARIABLES:
        raise ParameterError(f"a tensor must have at most {MOST_VARIABLES} coordinates; got {len(names)}.")
    return names


def check_distinct(names: Collection[str], parameters: Collection[str]) -> None:
    """Refuse parameters that are named like a coordinate: a derivative would take one for the other.

    Raises:
        BracketError: there is such a name; the message lists them.
    """
    if clash := {*names} & {*parameters}:
        raise BracketError(f"{sorted(clash)} name both coordinates and parameters; rename the parameters.")


def scope_with(names: tuple[str, ...], parameters: Mapping[str, GivenValue] | None, symbols: Sequence[str]) -> Scope:
    """The names that formulas may use: coordinates, parameters with values, and names that stay symbolic.

    Raises:
        BracketError: the value of a parameter depends on a coordinate.
        ParameterError: the parameters are no mapping, a declaration is none, or a name stands for two things.
    """
    declared = listed_names(symbols, "symbols")
    if declared is None or not all(isinstance(item, str) for item in declared):
        raise ParameterError(f'symbols must be a list of declarations; got {symbols!r:.60}. Write ["epsilon", "a[3]"].')
    values: Any = read_values(parameters)
    check_distinct(names, set[str]().union(*map(symbols_of, flattened(values).values())))
    return Scope(parameters=values, symbols=(*names, *declared), scalars=names)


def scope_of(
    coordinates: tuple[str, ...],
    own: Collection[str],
    symbols: Sequence[str],
    parameters: Mapping[str, GivenValue] | None = None,
) -> Scope:
    """The same for functions on the phase space of a bracket, whose `own` symbols need not be declared again.

    Raises:
        BracketError: also if a parameter has the name of a symbol of the bracket.
    """
    declared = listed_names(symbols, "symbols")
    given: Any = symbols if declared is None else declared
    values: Any = read_values(parameters)
    if clash := sorted({*own} & {*values, *flattened(values)}):
        raise BracketError(
            f"parameters: {clash[0]} is a symbol of the bracket, which keeps it; give it a value there first, with "
            f"bracket.substitute({{{clash[0]!r}: ...}}), or choose another name"
        )
    more = sorted({*own} - scope_with(coordinates, values, given).numbers())
    return scope_with(coordinates, values, [*given, *more])


def read_function(given: Any, scope: Scope, what: str) -> Expr:
    """A text in the grammar, a number, or an expression in known symbols, with the values of the parameters.

    Raises:
        ExpressionError: a text is not in the grammar, or a name in it is not known; with the position.
        ParameterError: it is none of these, not finite and real, or not smooth.
    """
    if isinstance(given, str):
        return read_expression(given, scope, insert_values=True)
    if not is_sympy(given):
        return to_sympy(read_number(given, what))
    from sympy import Derivative, Order, Subs, Symbol
    from sympy.core.function import AppliedUndef

    expression = as_expression(given, what)
    known = scope.numbers()
    unknown = sorted(str(s) for s in expression.atoms(Symbol, AppliedUndef) if str(s) not in known)
    if unknown:
        raise ParameterError(
            f"{what}: wanted an expression in the coordinates and declared parameters; got {unknown[0]}, which is none "
            f"of them. {scope.suggestion(unknown[0])}. Declare a parameter that has no value, symbols=[...]."
        )
    if expression.has(Derivative, Order, Subs):
        raise ParameterError(f"{what}: wanted a formula that is written out; got {expression!s:.60}. Try .doit().")
    values: Any = flattened(scope.values)
    expression = with_exact_numbers(read_expression_in(expression, scope.scalars, known - {*scope.scalars}, values))
    plain: Any = {s: Symbol(str(s)) for s in expression.free_symbols}
    function = to_sympy(substituted(cast("Expr", expression.xreplace(plain)), values))
    check_real(function, what)
    return function


def listed_functions(given: Any, what: str, example: str) -> list[Any]:
    """The functions of a list, or of a mapping from names.

    Raises:
        ParameterError: it is neither.
    """
    if (by_name := named(given, what)) is not None:
        return list(by_name.values())
    items = None if is_sympy(given) else listed(given, what)
    if items is None:
        raise ParameterError(f"{what} must be a list of functions; got {given!r:.60}. Write for example {example}.")
    return items
