"""Functions of the state that are given as SymPy expressions: what may stand in them, read exactly."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import Exact, as_expression, to_sympy
from liepoisson.errors import ParameterError, did_you_mean
from liepoisson.formula.parameters import read_parameter
from liepoisson.inputs.names import ELEMENTARY_FUNCTIONS, NOT_SMOOTH

if TYPE_CHECKING:
    from sympy import Expr


def with_exact_numbers(expression: Expr) -> Expr:
    """Floating-point numbers read as the decimals that they print as, like any other parameter."""
    from sympy import Float

    exact = {number: to_sympy(read_parameter(number, "H")) for number in expression.atoms(Float)}
    return cast("Expr", expression.xreplace(exact)) if exact else expression


def read_expression_in(
    given: object, coordinates: Collection[str], others: Collection[str], values: Mapping[str, Exact]
) -> Expr:
    """Read a function on phase space that is given as an expression, which may contain what a text may contain.

    Args:
        given: A SymPy expression or a number.
        coordinates: Names of the coordinates.
        others: Names of the parameters.
        values: Values of parameters.

    Raises:
        ParameterError: it is neither, has a part that is neither coordinate nor parameter, a function that is not
            smooth, or a symbol with assumptions that do not hold.
    """
    expression = as_expression(given, "a function on phase space")
    _check_parts(expression, (*coordinates, *others))
    _check_coordinates(expression, coordinates)
    _check_values(expression, values)
    return expression


def _check_parts(expression: Expr, known: Collection[str]) -> None:
    """Refuse what no text may contain: unknown names, and functions that are not smooth.

    A symbol that is neither a coordinate nor a declared parameter would be a constant of every derivative, and so would
    an element of an indexed object, a value of an undefined function, or a `Dummy`, whatever it is called.

    Args:
        expression: A function on phase space.
        known: The names of the coordinates and of the parameters.

    Raises:
        ParameterError: there is one; the message names it.
    """
    from sympy import Atom, Indexed, Symbol
    from sympy.core.function import Application, AppliedUndef
    from sympy.core.symbol import Str
    from sympy.matrices.expressions.matexpr import MatrixElement

    from liepoisson.structure.trace import MatrixMap

    free = expression.free_symbols
    wholes = (AppliedUndef, Indexed, MatrixElement)
    for part in sorted(expression.atoms(Atom, Application, *wholes), key=lambda p: (not isinstance(p, wholes), str(p))):
        if isinstance(part, wholes):
            raise _unknown_part(part, known)
        if isinstance(part, Application):
            if not _is_smooth(part):
                raise ParameterError(
                    f"a function on phase space must be smooth, as the equations of motion need derivatives; got "
                    f"{part!s:.60}. Use smooth functions only."
                )
        elif type(part) is Symbol:
            if part in free and part.name not in known:
                raise _unknown_part(part, known)
        elif not (part.is_number or isinstance(part, (Str, MatrixMap))):
            raise _unknown_part(part, known)


def _is_smooth(part: Any) -> bool:
    """Whether a function has derivatives; those that SymPy leaves as they are, as of a conjugate, count as none."""
    from sympy import Derivative, Function

    name = type(part).__name__.lower()
    if name in NOT_SMOOTH or name in ELEMENTARY_FUNCTIONS or not isinstance(part, Function):
        return name not in NOT_SMOOTH
    return not any(part.diff(symbol).has(Derivative) for symbol in part.free_symbols)


def _check_coordinates(expression: Expr, names: Collection[str]) -> None:
    """Refuse symbols of coordinates with assumptions, such as a positive l1: coordinates take all real values.

    Raises:
        ParameterError: there is one; the message names it.
    """
    from sympy import Symbol, srepr

    real = Symbol("x", real=True).assumptions0
    for symbol in sorted(expression.free_symbols, key=str):
        if str(symbol) in names and not cast("Any", symbol).assumptions0.items() <= real.items():
            raise ParameterError(
                f"a coordinate must be a symbol without assumptions, or a real one: it takes all real values; got "
                f"{srepr(symbol)}. Write Symbol({str(symbol)!r}), or take it from system.variables."
            )


def _check_values(expression: Expr, values: Mapping[str, Exact]) -> None:
    """Refuse values of parameters that the assumptions of their symbols exclude, such as -2 for a positive one.

    Raises:
        ParameterError: there is one; the message names it.
    """
    from sympy import srepr

    for symbol in sorted(expression.free_symbols, key=str):
        if str(symbol) not in values:
            continue
        value: Any = to_sympy(values[str(symbol)])
        facts: Any = cast("Any", symbol).assumptions0.items()
        if any(getattr(value, f"is_{fact}") is (not wanted) for fact, wanted in facts):
            raise ParameterError(
                f"the value of {symbol} must be one that its symbol allows, {srepr(symbol)}; got {value}. Give another "
                f"value, or write Symbol({str(symbol)!r})."
            )


def _unknown_part(part: object, known: Collection[str]) -> ParameterError:
    from sympy.core.function import AppliedUndef

    name = re.sub(r"[\W_]", "", str(getattr(part, "name", None) or part))
    kind = "an undefined function" if isinstance(part, AppliedUndef) else f"a SymPy {type(part).__name__}"
    shown = ", ".join([*known][:12]) + (", ..." if len(known) > 12 else "")
    return ParameterError(
        f"a function on phase space must consist of coordinates and declared parameters; got {part!s:.60}, {kind}. "
        f"{did_you_mean(name, known)}Known are {shown}. Take coordinates from bracket.variables, and declare a "
        'parameter that has no value, System(..., symbols=["k"]).'
    )


def check_real(energy: Expr, name: str = "the Hamiltonian") -> None:
    """Refuse infinities, undefined values and imaginary numbers, of which the equations could not be evaluated.

    Raises:
        ParameterError: it contains one.
    """
    if not is_finite_and_real(energy):
        raise ParameterError(f"{name} must be finite and real; got {energy}. Check its terms.")


def is_finite_and_real(expression: Expr) -> bool:
    """Whether there is no part that is infinite, undefined, an interval such as atan(1/0), or an imaginary number."""
    from sympy import AccumBounds, expand, nan, oo, preorder_traversal, zoo

    expanded: Any = expand(expression)
    return not expanded.has(nan, oo, -oo, zoo, AccumBounds) and not any(
        part.is_number and part.is_extended_real is False for part in preorder_traversal(expanded)
    )
