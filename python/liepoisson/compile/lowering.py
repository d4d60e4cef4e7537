r"""From expressions to plain data for the numeric core: a sparse quadratic field, or a tape.

The core derives the equations from the bracket, finds those of degree two, adds what cancels, and writes everything
else as a straight line of operations, in which a subexpression that occurs twice is computed once
(`liepoisson.compile.printing` says how it is told the expressions).  A field does not depend on the names of the
coordinates, which would else decide in which order a sum is taken.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from liepoisson import _core
from liepoisson.algebra.exact_numbers import to_sympy
from liepoisson.compile.field import QuadraticField, TapeField, TapeFunction, field_of
from liepoisson.compile.printing import PrintedExpressions
from liepoisson.errors import ParameterError, UnsupportedFieldError

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.structure.bracket import Bracket


def lower(bracket: Bracket, hamiltonian: Expr) -> QuadraticField | TapeField:
    """The field of a Hamiltonian as plain data.

    It is quadratic where the Hamiltonian is of degree two, or of degree three and J constant.

    Raises:
        ParameterError: a parameter is symbolic (the message names it), or a coefficient does not fit into a double.
        UnsupportedFieldError: the Hamiltonian contains a function that is not smooth or not known.
    """
    check_numeric(bracket, hamiltonian)
    return _general(_field_of_bracket(bracket, hamiltonian, as_tape=False))


def tape_of_bracket(bracket: Bracket, hamiltonian: Expr) -> TapeField:
    """The field of any smooth Hamiltonian as a tape.

    Raises:
        UnsupportedFieldError: the Hamiltonian contains a function that is not smooth or not known.
    """
    return cast("TapeField", field_of(_field_of_bracket(bracket, hamiltonian, as_tape=True)))


def _field_of_bracket(bracket: Bracket, hamiltonian: Expr, *, as_tape: bool) -> dict[str, Any]:
    terms = bracket.terms()
    functions = [] if bracket.is_linear else [to_sympy(c) for *_, c in terms]
    printed = PrintedExpressions(bracket.variables, [hamiltonian, *functions])
    texts = [printed.number(c) for *_, c in terms] if bracket.is_linear else printed.texts[1:]
    named = [(i, j, m, text) for (i, j, m, _), text in zip(terms, texts, strict=True)]
    return _core.printed_field(printed.n_components, printed.parts, named, printed.texts[0], as_tape)


def check_numeric(bracket: Bracket, hamiltonian: Expr) -> None:
    """Refuse symbols without numbers.

    Raises:
        ParameterError: a parameter is symbolic; the message names it.
    """
    free = {str(symbol) for symbol in hamiltonian.free_symbols - set(bracket.variables)} | bracket.symbols
    if free:
        raise ParameterError(
            f"every parameter must be a number for numerical work; got none for {', '.join(sorted(free))}. Give values."
        )


def field_of_equations(variables: Sequence[Symbol], derivatives: Sequence[Expr]) -> QuadraticField | TapeField:
    r"""Any smooth equations $\dot x_i = f_i(x)$ as a field, quadratic where they are of degree two.

    For systems that are not written as a Lie-Poisson bracket.

    Raises:
        UnsupportedFieldError: a function is not smooth or not known.
        ParameterError: a symbol is not among the variables.
    """
    return _general(_equations(variables, derivatives, as_tape=False))


def quadratic_of_equations(variables: Sequence[Symbol], derivatives: Sequence[Expr]) -> QuadraticField:
    """The same for equations of degree two alone.

    Raises:
        UnsupportedFieldError: a right-hand side is not a polynomial of degree at most two with numbers as coefficients.
    """
    field = field_of_equations(variables, derivatives)
    if isinstance(field, QuadraticField):
        return field
    raise UnsupportedFieldError(
        "the derivatives must be polynomials of degree at most two with numbers as coefficients; got "
        f"{list(derivatives)!s:.60}. Use tape_of_equations."
    )


def tape_of_equations(variables: Sequence[Symbol], derivatives: Sequence[Expr]) -> TapeField:
    """The same equations as a tape, whatever their degree."""
    return cast("TapeField", field_of(_equations(variables, derivatives, as_tape=True)))


def _equations(variables: Sequence[Symbol], derivatives: Sequence[Expr], *, as_tape: bool) -> dict[str, Any]:
    printed = PrintedExpressions(variables, derivatives)
    return _core.printed_equations(printed.n_components, printed.parts, printed.texts, as_tape)


def _general(record: Mapping[str, Any]) -> QuadraticField | TapeField:
    return cast("QuadraticField | TapeField", field_of(record))


def tape_of_functions(variables: Sequence[Symbol], functions: Sequence[Expr]) -> TapeFunction:
    """Functions of the variables as one tape; angles of pairs, atan2(y, x), may occur in them.

    Raises:
        UnsupportedFieldError: a function is not smooth or not known.
        ParameterError: a symbol is not among the variables.
    """
    printed = PrintedExpressions(variables, functions, angles=True)
    return functions_of(_core.printed_functions(printed.n_components, printed.parts, printed.texts))


def functions_of(record: Mapping[str, Any]) -> TapeFunction:
    """The functions of a record that the core has made."""
    return TapeFunction(record["n_components"], record["instructions"], record["outputs"])
