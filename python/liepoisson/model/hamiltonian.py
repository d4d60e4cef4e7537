"""How a Hamiltonian and the parameters of a system are read: from text, from a function, or as an expression.

`scope_of` has the names that a formula on a bracket may use.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias

from liepoisson.algebra.exact_numbers import is_sympy
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Column
from liepoisson.formula.scope import Scope
from liepoisson.inputs.given import listed, listed_names, named
from liepoisson.inputs.names import check_title

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


def symbols_in(expression: Expr, coordinates: Collection[str]) -> tuple[str, ...]:
    """The names of the symbols that are no coordinates, in order: what a system with this Hamiltonian declares."""
    return tuple(sorted({str(symbol) for symbol in expression.free_symbols}.difference(coordinates)))


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
