r"""Symmetric forms: matrices of formulas, read exactly, and whether a form is semi-definite.

A symmetric matrix is semi-definite if and only if all elementary symmetric functions $e_k$ of its eigenvalues are not
negative: these are the coefficients of its characteristic polynomial, up to sign, and are computed in exact numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias, cast

from liepoisson.algebra.decimals import decimals, round_off
from liepoisson.algebra.exact_numbers import is_sympy, is_zero
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.parameters import Parameter
from liepoisson.inputs.given import listed
from liepoisson.inputs.refusals import not_a

if TYPE_CHECKING:
    from sympy import Expr, Matrix, Symbol

N_POINTS = 10
"""Points at which a form that depends on the state is tried, as many as for the Jacobi identity."""

Known: TypeAlias = Literal["proved", "sampled", "undecided"]
"""How a statement is known: exactly, at `N_POINTS` points, or not."""

FormLike: TypeAlias = "Sequence[Parameter] | Sequence[Sequence[Parameter]] | Matrix"
"""A symmetric matrix, shape (N, N), or its diagonal, shape (N,): numbers, texts or expressions."""


class Sign(NamedTuple):
    """Whether something is never negative, and a state at which it is, if one was found."""

    known: Known
    negative_at: dict[str, str] | None = None


def read_form(given: Any, names: Sequence[str], name: str, read: Callable[[Any, str], Expr]) -> Matrix:
    """A symmetric matrix from its rows, or from its diagonal.

    Args:
        given: As it came.
        names: The N coordinates; labels of a diagonal decide its order.
        name: The name of the argument in messages.
        read: Reads an entry, with its name in messages.

    Raises:
        ShapeError: it has not N rows of N entries, or N entries.
        ParameterError: it is not symmetric, or an entry cannot be read.
    """
    from sympy import Matrix, diag

    n, rows = len(names), form_entries(given, names, name)
    example = _example(names, name)
    if not any(isinstance(row, tuple) for row in rows):
        if len(rows) != n:
            raise ShapeError(f"{name}: wanted {n} entries, one for each coordinate; got {len(rows)}; {example}")
        return diag(*(read(entry, f"{name}[{k + 1}]") for k, entry in enumerate(rows)))
    sizes = [len(cast("Any", row)) if isinstance(row, tuple) else 0 for row in rows]
    if sizes != [n] * n:
        raise ShapeError(f"{name}: wanted {n} rows of {n} entries; got {len(rows)} rows of {sizes!s:.40}; {example}")
    found: Any = Matrix(
        [[read(entry, f"{name}[{i + 1}, {j + 1}]") for j, entry in enumerate(row)] for i, row in enumerate(rows)]
    )
    for i in range(n):
        for j in range(i):
            if not is_zero(found[i, j] - found[j, i]):
                raise ParameterError(
                    f"{name}: wanted a symmetric matrix; got {found[i, j]} at [{i + 1}, {j + 1}] and {found[j, i]} at "
                    f"[{j + 1}, {i + 1}]; give both the same entry, such as half of their sum"
                )
    return found


def form_entries(given: Any, names: Sequence[str], name: str) -> tuple[Any, ...]:
    """The entries of a symmetric matrix as they were given, as a tuple of rows, or those of its diagonal.

    Nobody changes them later, an iterator is read once, and labels have decided the order.

    Raises:
        ParameterError: it is no sequence.
    """
    rows = listed(given.tolist() if is_sympy(given) else given, name, names)
    if rows is None:
        raise not_a("a symmetric matrix or its diagonal", given, name, _example(names, name))
    inner = [None if isinstance(row, str) else listed(row, name) for row in rows]
    return tuple(entry if row is None else tuple(row) for entry, row in zip(rows, inner, strict=True))


def _example(names: Sequence[str], name: str) -> str:
    n = len(names)
    entries = f"[{', '.join(['1'] * min(n, 4))}{', ...' if n > 4 else ''}]"
    return f"write for example {name}={entries}, a diagonal" if name.isidentifier() else f"give for example {entries}"


def semidefinite(form: Matrix, variables: Sequence[Symbol]) -> Sign:
    """Whether a symmetric matrix has no negative eigenvalue: decided for numbers, tried at points for functions."""
    if form.is_diagonal():
        return _all_of([never_negative(cast("Expr", form[k, k]), variables) for k in range(form.rows)])
    return _sign(lambda values: _symmetric_functions(form.xreplace(values)), form.free_symbols, variables)


def never_negative(function: Expr, variables: Sequence[Symbol]) -> Sign:
    """The same for a number or a function of the state."""
    return _sign(lambda values: [function.xreplace(values)], function.free_symbols, variables)


def _sign(values_at: Callable[[dict[Any, Any]], list[Any]], symbols: Any, variables: Sequence[Symbol]) -> Sign:
    """Of several functions together."""
    if symbols - {*variables}:  # parameters without a value
        return Sign("undecided")
    if not symbols:
        signs = [_is_negative(value) for value in values_at({})]
        if any(signs):
            return Sign("undecided", {})
        return Sign("undecided" if None in signs else "proved")
    tried = 0
    for point in points(variables):
        values = values_at(point)
        if not all(value.is_finite and value.is_real for value in values):
            continue
        tried += 1
        if any(map(_is_negative, values)):
            return Sign("undecided", {str(x): str(value) for x, value in point.items()})
    return Sign("sampled" if tried else "undecided")


def _all_of(signs: Sequence[Sign]) -> Sign:
    order: tuple[Known, ...] = ("undecided", "sampled", "proved")
    return min(signs, key=lambda sign: (sign.negative_at is None, order.index(sign.known)))


def _symmetric_functions(form: Any) -> list[Any]:
    """The elementary symmetric functions of the eigenvalues."""
    return [(-1) ** k * c for k, c in enumerate(form.charpoly().all_coeffs())][1:]


def _is_negative(value: Any) -> bool | None:
    """Of a real number; None where it is round-off beside its terms."""
    from mpmath import mp

    if value.is_negative is not None:
        return value.is_negative
    if (found := decimals([value], {})) is None:
        return None
    (number,), (size,), digits = found
    with mp.workdps(digits):
        return None if abs(number) <= round_off(digits) * size else bool(mp.re(number) < 0)


def points(variables: Sequence[Symbol]) -> Iterator[dict[Symbol, Any]]:
    """States with rational coordinates, the same in every call: u/(1 - u^2) for u between -1 and 1, so of any size."""
    from sympy import Rational

    for k in range(N_POINTS):
        steps = [(k + 2) * (i + 3) ** 2 * 37 % 41 - 20 for i in range(len(variables))]
        yield {x: Rational(21 * step, 441 - step**2) for x, step in zip(variables, steps, strict=True)}
