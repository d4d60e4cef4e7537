"""What a caller gives: structure constants c[i][j][k] and extensions W[lam][mu][nu], dense or sparse, and names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TypeAlias, cast

from liepoisson.algebra.exact_numbers import Coefficient, Exact, is_sympy, is_zero, to_sympy
from liepoisson.algebra.symbol_polynomials import SymbolPolynomial
from liepoisson.errors import BracketError, ShapeError
from liepoisson.formula.parameters import Parameter, read_coefficient, read_parameter
from liepoisson.inputs.given import is_named, listed, listed_names

Tensor3: TypeAlias = tuple[tuple[tuple[Exact, ...], ...], ...]
"""A dense cubic tensor."""

Brackets: TypeAlias = dict[tuple[int, int], dict[int, Exact]]
"""Structure constants by (i, j), i < j, then by k: only the nonzero ones, counted from 0."""

Rows: TypeAlias = dict[tuple[int, int], dict[int, Coefficient]]
"""The same, or the products of an extension, as they are kept: with polynomials that SymPy has not seen yet."""


def in_sympy(rows: Rows) -> Brackets:
    """Rows as callers see them: Fractions, or SymPy expressions throughout, for the two do not mix."""
    values = {value for row in rows.values() for value in row.values()}
    if all(isinstance(value, Fraction) for value in values):
        return cast("Brackets", rows)
    known = {value: to_sympy(value) for value in values}
    return {pair: {k: known[value] for k, value in row.items()} for pair, row in rows.items()}


def of_one_kind(rows: Rows) -> Rows:
    """Rows whose entries can be added and multiplied: no expression, or nothing else."""
    is_free = all(isinstance(v, (Fraction, SymbolPolynomial)) for row in rows.values() for v in row.values())
    return rows if is_free else cast("Rows", in_sympy(rows))


def read_tensor(entries: Sequence[Sequence[Sequence[Parameter]]], name: str) -> list[list[list[Coefficient]]]:
    """Read an n x n x n tensor of exact entries; all of them become SymPy expressions as soon as one is.

    Raises:
        ShapeError: the tensor is not n x n x n.
        ParameterError: an entry is not exact.
    """
    planes = [[listed(row, name) or [] for row in listed(plane, name) or []] for plane in listed(entries, name) or []]
    n = len(planes)
    if n == 0 or any(len(plane) != n or any(len(row) != n for row in plane) for plane in planes):
        got = f"its first axis has length {n}" if planes else f"got {type(entries).__name__}"
        raise ShapeError(f"{name} must have shape (n, n, n); {got}. Make every axis that long.")
    rows = of_one_kind(
        {
            (i, j): {k: read_coefficient(v, f"{name}[{i}][{j}][{k}]") for k, v in enumerate(row)}
            for i, plane in enumerate(planes)
            for j, row in enumerate(plane)
        }
    )
    return [[[*rows[i, j].values()] for j in range(n)] for i in range(n)]


def read_names(names: Sequence[str] | None, name: str, default: tuple[str, ...]) -> tuple[str, ...]:
    """Read a sequence of names, or take the default ones.

    Raises:
        ShapeError: not a sequence of strings.
    """
    if names is None:
        return default
    given = listed_names(names, name)
    if given is None or not all(isinstance(item, str) for item in given):
        raise ShapeError(f"{name} must be a sequence of names; got {names!r}. Write for example {name}={default!r}.")
    return tuple(str(item) for item in given)


def read_components(values: object, name: str, labels: Sequence[str]) -> list[Exact]:
    """Read the coordinates of an element, in order or by the names of the basis.

    Raises:
        ShapeError: not a sequence of n scalars.
        ParameterError: one of them is not exact.
    """
    items = listed(values, name, labels)
    if items is None or len(items) != len(labels):
        got = f"{values!r}" if items is None else f"{len(items)}"
        raise ShapeError(f"{name} must have {len(labels)} components; got {got}. Give one per basis element.")
    return [read_parameter(item, f"{name}[{k}]") for k, item in enumerate(items)]


def read_brackets(n: int, brackets: object) -> Rows:
    """Read sparse structure constants.

    Raises:
        ShapeError: not a mapping of mappings.
        BracketError: an index out of range, or a pair that is given twice or with itself.
        ParameterError: an entry is not exact.
    """
    if not is_named(brackets):
        raise ShapeError(
            f"brackets must be a mapping; got {type(brackets).__name__}. Write for example {{(0, 1): {{2: 1}}}}."
        )
    entries: Rows = {}
    known: dict[object, Coefficient] = {}
    for pair, row in cast("Mapping[object, object]", brackets).items():
        i, j = _read_pair(pair, n)
        if not is_named(row):
            raise ShapeError(f"brackets[{i}, {j}] must be a mapping k: c; got {row!r}. Write for example {{2: 1}}.")
        if (j, i) in brackets:
            raise BracketError(f"brackets must name each pair once; got ({i}, {j}) and ({j}, {i}). Leave one out.")
        read: dict[int, Coefficient] = {}
        for k, value in cast("Mapping[object, object]", row).items():
            _check_index(k, n, f"brackets[{i}, {j}]")
            entry = _read_known(value, f"brackets[{i}, {j}][{k}]", known)
            read[cast("int", k)] = entry if i < j else -entry
        entries[min(i, j), max(i, j)] = read
    return nonzero_brackets(entries)


def _read_known(value: object, name: str, known: dict[object, Coefficient]) -> Coefficient:
    """Read an entry; equal expressions are checked once, for there may be thousands of them."""
    if type(value) is Fraction or type(value) is SymbolPolynomial:
        return value
    if not is_sympy(value):
        return read_coefficient(value, name)
    if value not in known:
        known[value] = read_coefficient(value, name)
    return known[value]


def _read_pair(pair: object, n: int) -> tuple[int, int]:
    if not isinstance(pair, tuple) or len(cast("tuple[object, ...]", pair)) != 2:
        raise BracketError(f"brackets must be given by pairs (i, j); got {pair!r}. Write for example (0, 1).")
    i, j = cast("tuple[int, int]", pair)
    for index in (i, j):
        _check_index(index, n, "brackets")
    if i == j:
        raise BracketError(f"brackets must be antisymmetric; got the pair ({i}, {j}). Leave it out: [e, e] = 0.")
    return i, j


def _check_index(index: object, n: int, name: str) -> None:
    if isinstance(index, bool) or not isinstance(index, int) or not 0 <= index < n:
        raise BracketError(f"the indices of {name} must be integers from 0 to {n - 1}; got {index!r}. Count from 0.")


def nonzero_brackets(entries: Rows) -> Rows:
    """The entries that are not zero, sorted."""
    entries = of_one_kind(entries)
    zeros = {value for value in {value for row in entries.values() for value in row.values()} if is_zero(value)}
    rows = ((pair, {k: c for k, c in sorted(entries[pair].items()) if c not in zeros}) for pair in sorted(entries))
    return {pair: row for pair, row in rows if row}
