"""How a Hamiltonian and the parameters of a system are read: from text, from a function, or as an expression."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias, cast

from liepoisson.errors import ParameterError
from liepoisson.exact.names import check_title
from liepoisson.exact.parameters import Column, is_sympy, read_parameter, to_sympy
from liepoisson.given import listed, named

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.exact.bracket import Bracket

Hamiltonian: TypeAlias = "str | Expr | Callable[..., Expr]"
"""Text in our grammar, an expression in `bracket.variables`, or a function of the field vectors (SymPy columns)."""


def check_hamiltonian(hamiltonian: object, bracket: Bracket) -> None:
    """Refuse what is neither text nor an expression nor a function.

    Raises:
        ParameterError: it is none of them.
    """
    if not (isinstance(hamiltonian, str) or callable(hamiltonian) or is_expression(hamiltonian)):
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
    items = listed(symbols, "symbols")
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
    except TypeError as error:
        raise ParameterError(
            f"the Hamiltonian function must take one vector per field, ({', '.join(fields)}); got one that does not "
            f"({error})."
        ) from None
    expression = function(*fields.values())
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


def is_expression(value: object) -> bool:
    """Whether this is a SymPy expression; asked without importing SymPy for anything else."""
    if not is_sympy(value):
        return False
    from sympy import Expr

    return isinstance(value, Expr)
