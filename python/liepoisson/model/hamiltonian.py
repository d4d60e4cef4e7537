"""How a Hamiltonian and the parameters of a system are read: from text, from a function, or as an expression.

`scope_of` has the names that a formula on a bracket may use.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra.exact_numbers import Exact, as_expression, is_sympy, to_sympy
from liepoisson.errors import ParameterError, did_you_mean
from liepoisson.formula.parameters import Column, read_parameter
from liepoisson.formula.scope import Scope
from liepoisson.inputs.given import listed, listed_names, named
from liepoisson.inputs.names import NOT_SMOOTH, check_title

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.formula.parameters import GivenValue
    from liepoisson.structure.bracket import Bracket

Hamiltonian: TypeAlias = "str | Expr | Callable[..., Expr]"
"""Text in our grammar, an expression in `bracket.variables`, or a function of the field vectors (SymPy columns)."""


def check_hamiltonian(hamiltonian: object, bracket: Bracket) -> None:
    """Refuse what is neither text nor an expression nor a function.

    Raises:
        ParameterError: it is none of them.
    """
    is_function = callable(hamiltonian) and not isinstance(hamiltonian, type)
    if not (isinstance(hamiltonian, str) or is_function or is_expression(hamiltonian)):
        raise ParameterError(
            "the Hamiltonian must be a text, a SymPy expression in bracket.variables or a Python function of the field "
            f"vectors; got {hamiltonian!r:.60} of type {type(hamiltonian).__name__}. Write for example "
            f"'{bracket.coordinate_names_in_order[0]}^2/2', or lambda {', '.join(bracket.field_names)}: "
            f"{bracket.field_names[0]}.dot({bracket.field_names[0]}) / 2."
        )


RESERVED_NAME = re.compile(r"H|C\d+")
"""Names of the Hamiltonian and of the Casimirs among the invariants."""


def read_declarations(symbols: Sequence[str]) -> tuple[str, ...]:
    """Read the declarations of parameters without value, such as "epsilon" or "a[3]".

    Raises:
        ParameterError: not a sequence of texts.
    """
    items = listed_names(symbols, "symbols")
    if items is None or not all(isinstance(item, str) for item in items):
        raise ParameterError(f'symbols must be a list of declarations; got {symbols!r:.60}. Write ["epsilon", "a[3]"].')
    return tuple(str(item) for item in items)


def read_functions(functions: Mapping[str, str | Expr] | None, what: str) -> dict[str, str | Expr]:
    """Read functions on phase space by name: texts or SymPy expressions.

    Raises:
        ParameterError: not a mapping from names, a name is that of the Hamiltonian or of a Casimir, or a function is
            neither a text nor an expression.
    """
    given = named({} if functions is None else functions, what)
    if given is None or not all(isinstance(name, str) for name in given):
        raise ParameterError(
            f'{what} must be a mapping from names to functions; got {functions!r:.60}. Write {{"K": "..."}} with a '
            "formula."
        )
    for name, function in given.items():
        check_title(name, f"{what}: a name")
        if RESERVED_NAME.fullmatch(name):
            raise ParameterError(f"{what} must not be named H, C1, C2, ...; got {name!r}. Choose another name.")
        if not isinstance(function, str) and not is_expression(function):
            raise ParameterError(
                f"{what}: {name} must be a text or an expression; got {function!r:.60}. Write a formula."
            )
    return given


def read_pairs_of_functions(
    functions: Mapping[str, tuple[str | Expr, str | Expr]] | None,
) -> dict[str, tuple[str | Expr, str | Expr]]:
    """Read partial integrals by name: an integral and the function that vanishes where it is one.

    Raises:
        ParameterError: not a mapping from names to pairs of functions.
    """
    pairs = named({} if functions is None else functions, "partial_integrals")
    if pairs is None:
        raise ParameterError(f"partial_integrals must be a mapping from names to pairs; got {functions!r:.60}.")
    read = {name: listed(pair, f"partial_integrals: {name}") for name, pair in pairs.items()}
    for name, pair in read.items():
        if pair is None or len(pair) != 2:
            raise ParameterError(
                f"partial_integrals: {name} must be a pair (integral, function that vanishes); got {pairs[name]!r:.60}."
            )
        for function in pair:
            read_functions({name: function}, "partial_integrals")
    return {name: (pair[0], pair[1]) for name, pair in read.items() if pair}


def apply_function(function: Callable[..., Expr], bracket: Bracket) -> Expr:
    """The value of a Hamiltonian function at the field vectors.

    Raises:
        ParameterError: it does not take one vector per field, or does not return a SymPy expression.
    """
    from inspect import signature

    fields: dict[str, Column] = bracket.fields
    try:
        signature(function).bind(*fields.values())
    except (TypeError, ValueError) as error:
        raise ParameterError(
            f"the Hamiltonian function must take one vector per field, ({', '.join(fields)}); got one that does not "
            f"({error})."
        ) from None
    try:
        expression = function(*fields.values())
    except (TypeError, AttributeError) as error:
        raise ParameterError(
            f"the Hamiltonian function must compute with SymPy columns; got {type(error).__name__}: {error!s:.200}. "
            "Use functions of SymPy, such as sympy.sin, and no others."
        ) from error
    if not is_expression(expression):
        raise ParameterError(
            f"the Hamiltonian function must return a SymPy expression; got {type(expression).__name__}. "
            "Return a scalar built from its arguments, such as l.dot(l) / 2."
        )
    return expression


def with_exact_numbers(expression: Expr) -> Expr:
    """Floating-point numbers read as the decimals that they print as, like any other parameter."""
    from sympy import Float

    exact = {number: to_sympy(read_parameter(number, "H")) for number in expression.atoms(Float)}
    return cast("Expr", expression.xreplace(exact)) if exact else expression


def symbols_in(expression: Expr, coordinates: Collection[str]) -> tuple[str, ...]:
    """The names of the symbols that are no coordinates, in order: what a system with this Hamiltonian declares."""
    return tuple(sorted({str(symbol) for symbol in expression.free_symbols}.difference(coordinates)))


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
            if type(part).__name__.lower() in NOT_SMOOTH:
                raise ParameterError(
                    f"a function on phase space must be smooth, as the equations of motion need derivatives; got "
                    f"{part!s:.60}. Use smooth functions only."
                )
        elif type(part) is Symbol:
            if part in free and part.name not in known:
                raise _unknown_part(part, known)
        elif not (part.is_number or isinstance(part, (Str, MatrixMap))):
            raise _unknown_part(part, known)


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
    from sympy import expand, nan, oo, preorder_traversal, zoo

    expanded = expand(energy)
    if expanded.has(nan, oo, -oo, zoo) or any(
        part.is_number and part.is_extended_real is False for part in preorder_traversal(expanded)
    ):
        raise ParameterError(f"{name} must be finite and real; got {energy}. Check its terms.")


def has_partial_functions(function: Expr) -> bool:
    """Whether a function may be no real number at a real state: it has a logarithm, a root, or an inverse sine."""
    from sympy import Pow, acos, asin, log

    return bool(function.atoms(log, asin, acos)) or any(not power.exp.is_Integer for power in function.atoms(Pow))


def is_expression(value: object) -> bool:
    """Whether this is a SymPy expression; asked without importing SymPy for anything else."""
    if not is_sympy(value):
        return False
    from sympy import Expr

    return isinstance(value, Expr)


def scope_of(
    bracket: Bracket, parameters: Mapping[str, GivenValue] | None = None, symbols: Sequence[str] = ()
) -> Scope:
    """The names of the coordinates of a bracket, its own symbols, and the given parameters and symbols.

    Raises:
        ParameterError: as for a scope.
    """
    scalars, fields = bracket.scalars, bracket.vectors
    symbols = (*scalars, *symbols)
    remark = _about_fields(bracket)
    known = Scope(fields, parameters or {}, symbols, scalars, remark)
    missing = sorted(bracket.symbols - set(known.shapes) - set(known.components))
    return Scope(fields, parameters or {}, (*symbols, *missing), scalars, remark) if missing else known


def _about_fields(bracket: Bracket) -> str:
    """How the fields of a bracket get other names; and for se(3), where one field has two vectors, how they get any."""
    if bracket.has_scalar_fields:
        return ""
    if bracket.algebra.name == "se(3)" and len(bracket.field_names) == 1:
        return "Write so(3) @ semidirect(2) for se(3)* with two vectors, l and alpha"
    names = ", ".join(f'"{name}"' for name in ("m", "p", "q", "r")[: len(bracket.field_names)])
    return f"Other names: bracket.rename({names})" if len(bracket.field_names) <= 4 else ""
