"""Exact parameters: how the numbers, names and formulas that a caller gives are read.

A parameter is a `Fraction` when it is a rational number, and a SymPy expression when it is anything else (a name kept
symbolic, a square root).  SymPy is imported only for the latter; coefficients of a bracket wait for it.

`Value` is what a parameter has by name: a number, a vector or a matrix, whose components have names, too.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias, cast, overload

from liepoisson.algebra.exact_numbers import Coefficient, Exact, exact, is_sympy, not_a_parameter, read_number
from liepoisson.algebra.symbol_polynomials import SymbolPolynomial
from liepoisson.errors import ExpressionError, ParameterError, ShapeError, did_you_mean
from liepoisson.inputs.given import as_scalar, by_name, labelled, listed, named
from liepoisson.inputs.names import CONSTANTS, NOT_FINITE, check_name

if TYPE_CHECKING:
    from sympy import Expr

Parameter: TypeAlias = "int | float | Fraction | str | Expr"
"""What a caller may write for a parameter."""


Column: TypeAlias = Any
"""A SymPy column of three expressions (Matrix, 3 x 1); SymPy's annotations of its entries are too loose to be used."""

# A bounded exponent: Fraction("1e999999999") would fill the memory with digits.
_NUMBER = re.compile(r"[+-]?(\d+/\d+|(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?)")
_MAX_CHARACTERS = 200
_NAME = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")


def read_parameter(value: object, name: str) -> Exact:
    """Read one parameter exactly.

    A float is read as the decimal it prints as (0.1 is 1/10); a string is a number ("1/3", "0.25", "sqrt(2)/2"), an
    identifier, which stays symbolic, or a formula in such ("2*epsilon").  No string is ever evaluated as code.

    Args:
        value: int, Fraction, float, NumPy scalar, string or SymPy expression.
        name: What to call the parameter in an error message.

    Returns:
        A Fraction for a rational number, else a SymPy expression.

    Raises:
        ParameterError: not a number or name, or a number that is not finite and real.
    """
    return exact(read_coefficient(value, name))


def read_coefficient(value: object, name: str) -> Coefficient:
    """Read one parameter as `read_parameter`, but leave a polynomial in names, or in a surd, to be an expression later.

    Raises:
        ParameterError: as there.
    """
    if isinstance(value, SymbolPolynomial):
        return value
    value = as_scalar(value)
    return _read_string(value, name) if isinstance(value, str) else read_number(value, name)


def read_symbol(value: object, name: str) -> str | None:
    """The name of the symbol that a parameter is given as; None if it is given as anything but the text of a name.

    Raises:
        ParameterError: a user may not choose this name.
    """
    text = value.strip() if isinstance(value, str) else ""
    if not _NAME.fullmatch(text) or text.lower() in NOT_FINITE or text in CONSTANTS:
        return None
    return check_name(text, f"{name}: the name of a symbol")


def read_new_symbol(value: object, name: str, taken: Collection[str]) -> str:
    """The name of a symbol that has no meaning yet.

    Raises:
        ParameterError: it is no name, one that a user may not choose, or one of those that are taken.
    """
    symbol = read_symbol(value, name)
    if symbol is None or symbol in taken:
        raise ParameterError(f"{name}: wanted a name that nothing has yet; got {value!r:.60}. Take another one.")
    return symbol


def read_vector(values: object, name: str, components: str) -> tuple[Exact, Exact, Exact]:
    """Read three parameters, for example the moments of inertia.

    Args:
        values: A sequence of 3 parameters (list, tuple, array, SymPy Matrix).
        name: What to call the vector in an error message.
        components: What its components are, for example "(I1, I2, I3)".

    Raises:
        ShapeError: not a sequence of 3 scalars.
        ParameterError: a component that is not an exact finite real parameter, or labels other than the components.
    """
    names = components.strip("()").split(", ")
    items = listed(values, name, names)
    if items is None:
        raise ShapeError(f"{name} must be 3 numbers {components}; got {values!r}. Write for example {name}=(1, 1, 2).")
    if len(items) != 3 or any(listed(item) is not None for item in items):
        got = f"shape {_shape(values, items)}"
        raise ShapeError(f"{name} must be 3 numbers {components}; got {got}. Give exactly three components.")
    first, second, third = (read_parameter(item, part) for item, part in zip(items, names, strict=True))
    return first, second, third


def values_of_symbols(given: object, symbols: Iterable[str]) -> dict[str, Coefficient]:
    """Values for some of these symbols, by their names, also where a caller gives the symbols themselves.

    Raises:
        ParameterError: not a mapping, a name is none of them or comes twice, or a value is not exact.
    """
    known, values = {*symbols}, dict[str, Coefficient]()
    for name, value in by_name(given, "values", "values", '{"epsilon": 1}').items():
        if name not in known:
            raise ParameterError(
                f"values: wanted the names of symbols, {', '.join(sorted(known)) or 'of which there are none'}; got "
                f"{name!r:.60}. {did_you_mean(name, known)}Correct the name or leave it out."
            )
        values[name] = read_coefficient(value, name)
    return values


def _read_string(text: str, name: str) -> Coefficient:
    if (symbol := read_symbol(text, name)) is not None:
        return SymbolPolynomial.of(symbol)
    stripped = text.strip()
    if len(stripped) > _MAX_CHARACTERS:
        raise not_a_parameter(text, name)
    if not _NUMBER.fullmatch(stripped):
        return _read_formula(stripped, name)
    try:
        return Fraction(stripped)
    except ZeroDivisionError:
        raise ParameterError(f"{name} must be a finite number; got {text!r}. Use a nonzero denominator.") from None


def _read_formula(text: str, name: str) -> Coefficient:
    """A formula whose names are those of symbols: "sqrt(2)", "2*epsilon"."""
    from liepoisson.formula.coefficients import parameter

    try:
        return parameter(text)
    except ExpressionError as error:
        raise not_a_parameter(text, name, error.message) from None


def _shape(values: object, items: list[object]) -> tuple[int, ...]:
    shape = getattr(values, "shape", None)
    if isinstance(shape, tuple):
        return cast("tuple[int, ...]", shape)
    inner = listed(items[0]) if items else None
    return (len(items),) if inner is None else (len(items), len(inner))


Shape: TypeAlias = tuple[int, ...]
"""() for a scalar, (n,) for a vector, (m, n) for a matrix."""

Value: TypeAlias = "Exact | tuple[Exact, ...] | tuple[tuple[Exact, ...], ...]"
"""The value of a parameter: a number (or name), a vector, a matrix."""

Kept: TypeAlias = "Coefficient | tuple[Coefficient, ...] | tuple[tuple[Coefficient, ...], ...]"
"""The same as it is kept, before SymPy is asked for it."""

GivenValue: TypeAlias = "Parameter | Sequence[Parameter] | Sequence[Sequence[Parameter]]"


def read_values(parameters: Mapping[str, GivenValue] | None) -> dict[str, Value]:
    """Read the values of parameters, by name: numbers or names, vectors, matrices.

    Raises:
        ParameterError: as in `read_kept_values`.
    """
    return {name: exact_value(value) for name, value in read_kept_values(parameters).items()}


def exact_value(value: Kept) -> Value:
    """The value as callers see it."""
    return cast("Value", tuple(map(exact_value, value))) if isinstance(value, tuple) else exact(value)


def read_kept_values(parameters: Mapping[str, GivenValue] | None) -> dict[str, Kept]:
    """Read the values of parameters without SymPy, where it need not be asked.

    Raises:
        ParameterError: not a mapping from names to values, a name that nobody may choose (`liepoisson.inputs.names`),
            or a value is not exact.
    """
    given = named({} if parameters is None else parameters, "parameters")
    if given is None or not all(isinstance(name, str) for name in given):
        raise ParameterError(
            f"parameters must be a mapping from names to values; got {parameters!r:.60}. Write for example "
            '{"epsilon": 1}.'
        )
    return {check_name(name, "the name of a parameter"): _read_value(value, name) for name, value in given.items()}


def _read_value(value: object, name: str) -> Kept:
    if is_sympy(value) and hasattr(value, "tolist"):  # a SymPy matrix; one column is a vector
        rows = cast("Any", value).tolist()
        value = [row[0] for row in rows] if all(len(row) == 1 for row in rows) else rows
    items = listed(value, name, names_of_places(value, name))
    if items is None:
        return read_coefficient(value, name)
    rows = [listed(item, name) for item in items]
    if items and all(row is not None for row in rows):
        matrix = [
            tuple(read_coefficient(entry, f"{name}[{i + 1},{j + 1}]") for j, entry in enumerate(row or ()))
            for i, row in enumerate(rows)
        ]
        if len({len(row) for row in matrix}) != 1 or not matrix[0]:
            raise ParameterError(f"{name} must be a matrix with rows of one length; got {value!r:.60}. Fill it up.")
        return tuple(matrix)
    if not items:
        raise ParameterError(f"{name} must have at least one component; got an empty sequence. Give its components.")
    return tuple(read_coefficient(item, f"{name}[{k + 1}]") for k, item in enumerate(items))


def listed_rows(values: object, name: str) -> list[Any] | None:
    """The rows of a matrix, also of SymPy, or the items of a vector; None for what has none."""
    return listed(cast("Any", values).tolist() if is_sympy(values) and hasattr(values, "tolist") else values, name)


def names_of_places(value: object, name: str) -> list[str]:
    """What the components of a vector are called: I1, I2, ..."""
    found = labelled(value, name)
    is_vector = found is not None and not any(getattr(column, "ndim", 0) for column in found.columns)
    n = len(found.labels) if found is not None and is_vector else 0
    return [component_name(name, (k,), (n,)) for k in range(1, n + 1)]


@overload
def flattened(  # pyright: ignore[reportOverlappingOverload]  # the narrower kind first
    values: Mapping[str, Value],
) -> dict[str, Exact]: ...
@overload
def flattened(values: Mapping[str, Kept]) -> dict[str, Coefficient]: ...
def flattened(values: Mapping[str, Any]) -> dict[str, Any]:
    """One entry per number: the components of a vector I are I1, I2, ..., those of a matrix M are M11, M12, ...

    Raises:
        ParameterError: two numbers would have one name, as those of a parameter I1 and of a vector I.
    """
    flat: dict[str, Any] = {}
    for name, value in values.items():
        entries = _components(name, value) if isinstance(value, tuple) else {name: value}
        if twice := sorted(flat.keys() & entries):
            raise ParameterError(
                f"a name must stand for one thing; {twice[0]} would be {name} or a component of it, and another "
                "parameter. Rename one of them."
            )
        flat |= entries
    return flat


def _components(name: str, value: tuple[Any, ...]) -> dict[str, Any]:
    rows = [item if isinstance(item, tuple) else (item,) for item in value]
    is_matrix = isinstance(value[0], tuple)
    shape = (len(rows), len(rows[0])) if is_matrix else (len(rows),)
    return {
        component_name(name, (i, j) if is_matrix else (i,), shape): entry
        for i, row in enumerate(rows, start=1)
        for j, entry in enumerate(row, start=1)
    }


def component_name(name: str, index: Shape, shape: Shape) -> str:
    """The short form of a component: I1; A12, or A1_12 if an index of the matrix may have two digits."""
    return name + ("" if max(shape, default=0) < 10 else "_").join(map(str, index))
