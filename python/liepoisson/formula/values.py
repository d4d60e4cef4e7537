"""Values of parameters by name: numbers, vectors, matrices, and what their components are called."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias, cast

from liepoisson.algebra.exact_numbers import Exact, is_sympy
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.inputs.given import labelled, listed, named
from liepoisson.inputs.names import check_name

Shape: TypeAlias = tuple[int, ...]
"""() for a scalar, (n,) for a vector, (m, n) for a matrix."""

Value: TypeAlias = "Exact | tuple[Exact, ...] | tuple[tuple[Exact, ...], ...]"
"""The value of a parameter: a number (or name), a vector, a matrix."""

GivenValue: TypeAlias = "Parameter | Sequence[Parameter] | Sequence[Sequence[Parameter]]"


def read_values(parameters: Mapping[str, GivenValue] | None) -> dict[str, Value]:
    """Read the values of parameters, by name: numbers or names, vectors, matrices.

    Raises:
        ParameterError: not a mapping from names to values, a name that nobody may choose (`liepoisson.inputs.names`), or
            a value is not exact.
    """
    given = named({} if parameters is None else parameters, "parameters")
    if given is None or not all(isinstance(name, str) for name in given):
        raise ParameterError(
            f"parameters must be a mapping from names to values; got {parameters!r:.60}. Write for example "
            '{"epsilon": 1}.'
        )
    return {check_name(name, "the name of a parameter"): _read_value(value, name) for name, value in given.items()}


def _read_value(value: object, name: str) -> Value:
    if is_sympy(value) and hasattr(value, "tolist"):  # a SymPy matrix; one column is a vector
        rows = cast("Any", value).tolist()
        value = [row[0] for row in rows] if all(len(row) == 1 for row in rows) else rows
    items = listed(value, name, _names_of_places(value, name))
    if items is None:
        return read_parameter(value, name)
    rows = [listed(item, name) for item in items]
    if items and all(row is not None for row in rows):
        matrix = [
            tuple(read_parameter(entry, f"{name}[{i + 1},{j + 1}]") for j, entry in enumerate(row or ()))
            for i, row in enumerate(rows)
        ]
        if len({len(row) for row in matrix}) != 1 or not matrix[0]:
            raise ParameterError(f"{name} must be a matrix with rows of one length; got {value!r:.60}. Fill it up.")
        return tuple(matrix)
    if not items:
        raise ParameterError(f"{name} must have at least one component; got an empty sequence. Give its components.")
    return tuple(read_parameter(item, f"{name}[{k + 1}]") for k, item in enumerate(items))


def _names_of_places(value: object, name: str) -> list[str]:
    """What the components of a vector are called: I1, I2, ..."""
    found = labelled(value, name)
    is_vector = found is not None and not any(getattr(column, "ndim", 0) for column in found.columns)
    n = len(found.labels) if found is not None and is_vector else 0
    return [component_name(name, (k,), (n,)) for k in range(1, n + 1)]


def flattened(values: Mapping[str, Value]) -> dict[str, Exact]:
    """One entry per number: the components of a vector I are I1, I2, ..., those of a matrix M are M11, M12, ...

    Raises:
        ParameterError: two numbers would have one name, as those of a parameter I1 and of a vector I.
    """
    flat: dict[str, Exact] = {}
    for name, value in values.items():
        entries = _components(name, value) if isinstance(value, tuple) else {name: value}
        if twice := sorted(flat.keys() & entries):
            raise ParameterError(
                f"a name must stand for one thing; {twice[0]} would be {name} or a component of it, and another "
                "parameter. Rename one of them."
            )
        flat |= entries
    return flat


def _components(name: str, value: tuple[Exact, ...] | tuple[tuple[Exact, ...], ...]) -> dict[str, Exact]:
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
