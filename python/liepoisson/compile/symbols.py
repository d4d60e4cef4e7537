"""Expressions in symbols of the package's own, in which they are compiled and lowered.

SymPy compiles an expression by printing it: `exp(1)` is printed as `e`, and an argument that a user called e would then
be read for it.  Here every variable is first replaced by a private symbol.  What is compiled thus depends on the order
of the variables only, to the last bit, and never on their names.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.errors import ParameterError, UnsupportedFieldError

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.inputs.arrays import Array

NumpyFunction: TypeAlias = Callable[..., list[Any]]
"""Takes one array for each variable and returns a list of one value for each expression."""


def in_compiler_symbols(
    variables: Sequence[Symbol], expressions: Sequence[Expr]
) -> tuple[tuple[Symbol, ...], list[Expr]]:
    """Private symbols for the variables, in their order, and the expressions in them.

    All symbols are replaced at once, so that none can be mistaken for another one.  Symbols are the same if SymPy says
    so; that two of them are printed alike means nothing.

    Raises:
        ParameterError: a symbol in an expression is none of the variables.
        UnsupportedFieldError: a function in it is neither one of SymPy's nor a trace, or it binds a variable of its
            own, like a sum.
    """
    from sympy import S, Symbol

    from liepoisson.algebra.exact_numbers import as_expression

    # Leading zeros, so that SymPy sorts the names by their numbers.  The last variable comes first: the tape of the
    # quaternion chart has 115 operations then, in the other order 118.
    n, width = len(variables), len(str(len(variables)))
    private = tuple(Symbol(f"_{n - 1 - k:0{width}d}") for k in range(n))
    named = dict(zip(variables, private, strict=True))
    exact: list[Any] = [as_expression(expression, "a function to be compiled") for expression in expressions]
    free = {symbol for expression in exact for symbol in expression.free_symbols} - named.keys()
    if free:
        names = ", ".join(sorted(str(symbol) for symbol in free))
        raise ParameterError(f"every parameter must be a number for numerical work; got none for {names}. Give values.")
    for expression in exact:
        _refuse_foreign_functions(expression)
    return private, [expression if expression is S.Zero else expression.xreplace(named) for expression in exact]


def name_of_function(expression: Expr) -> str | None:
    """The name of SymPy's function of which this is a value, such as "sin"; None if it is none of SymPy's own.

    A function that a user made and called sin is not the sine.
    """
    import sympy

    kind = type(expression)
    return kind.__name__ if getattr(sympy, kind.__name__, None) is kind else None


def numpy_function(variables: Sequence[Symbol], expressions: Sequence[Expr]) -> NumpyFunction:
    """A NumPy function of the variables that returns the values of all expressions.

    The same variables and expressions give the same function again, without compiling.

    Raises:
        ParameterError: a symbol in an expression is none of the variables.
        UnsupportedFieldError: an expression contains a function that NumPy does not have.
    """
    return _numpy_function(tuple(variables), tuple(expressions))


@lru_cache(maxsize=1024)
def first_of_equal(expressions: tuple[Expr, ...]) -> tuple[Expr, ...]:
    """The first equal expressions that were seen: to find these again, no expression is compared."""
    return expressions


@lru_cache(maxsize=1024)
def _numpy_function(variables: tuple[Symbol, ...], expressions: tuple[Expr, ...]) -> NumpyFunction:
    from sympy import S, lambdify
    from sympy.printing.codeprinter import PrintMethodNotImplementedError
    from sympy.printing.numpy import NumPyPrinter

    from liepoisson.portable import elementary

    class Printer(NumPyPrinter):
        """Prints powers as a function of ours: NumPy's depends on the processor."""

        def _print_Pow(self, expr: Any, rational: bool = False) -> str:
            base, exponent = expr.as_base_exp()
            if exponent in (-1, 1, 2) or abs(exponent) == S.Half:
                return super()._print_Pow(expr, rational)
            return f"power({self._print(base)}, {self._print(exponent)})"

    symbols, private = in_compiler_symbols(variables, expressions)
    printer = Printer(
        {"fully_qualified_modules": False, "inline": True, "allow_unknown_functions": False, "user_functions": {}}
    )
    try:
        # SymPy's annotation of `cse` knows only bool; its documentation says "or callable".
        options: dict[str, Any] = {"modules": [elementary.FUNCTIONS, "numpy"], "printer": printer, "cse": _common_parts}
        function: Any = lambdify(symbols, private, **options)
    except PrintMethodNotImplementedError as error:
        raise _not_for_arrays(expressions) from error
    if set(cast("Any", printer).module_imports) - {"numpy", "functools"}:  # those of `math` take no arrays
        raise _not_for_arrays(expressions)
    return cast("NumpyFunction", function)


def evaluated(variables: Sequence[Symbol], expressions: Sequence[Expr], states: Array) -> Array:
    """The values of expressions in the variables at states of shape (..., N), stacked along a new last axis.

    Raises:
        ParameterError: a number in an expression does not fit into a double, or a symbol in it is no variable.
        UnsupportedFieldError: an expression contains a function that NumPy does not have.
    """
    import numpy as np

    function = numpy_function(variables, expressions)
    try:
        values = function(*(states[..., k] for k in range(states.shape[-1])))
    except OverflowError as error:  # exact numbers are divided as integers, which have no bounds
        raise ParameterError(
            "a function to be evaluated must have numbers that fit into doubles (below 1.8e308); got a larger one. "
            "Rescale the system, or set parameters that are nearly 0 to 0."
        ) from error
    columns = np.empty((*states.shape[:-1], len(values)))
    for k, value in enumerate(values):  # a constant is a single number
        columns[..., k] = value
    return columns


def _not_for_arrays(expressions: Sequence[Any]) -> UnsupportedFieldError:
    return UnsupportedFieldError(
        f"a function of arrays must be made of functions that NumPy has; got {_shown(expressions)}. Replace the others."
    )


def _common_parts(expressions: Any) -> Any:
    """Common subexpressions, under names that no variable has."""
    from sympy import cse, numbered_symbols

    return cse(expressions, symbols=numbered_symbols("_c"), list=False)


def _refuse_foreign_functions(expression: Any) -> None:
    from sympy import Function, Symbol

    from liepoisson.structure.trace import Trace

    for value in expression.atoms(Function):
        if name_of_function(value) is None and type(value) is not Trace:
            raise UnsupportedFieldError(
                f"a function on phase space must be made of SymPy's own functions; got {_shown([value])}, which is not "
                "defined there. Replace it by a smooth expression."
            )
    if bound := expression.atoms(Symbol) - expression.free_symbols:
        names = ", ".join(sorted(map(str, bound)))
        raise UnsupportedFieldError(
            f"a function on phase space must have no variable of its own; got {_shown([expression])} with {names}. "
            "Write out sums, integrals and derivatives."
        )


def _shown(expressions: Sequence[Any]) -> str:
    text = ", ".join(map(str, expressions))
    return text if len(text) <= 60 else text[:57] + "..."
