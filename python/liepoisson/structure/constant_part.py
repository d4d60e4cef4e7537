r"""The constant part of a bracket, $c_{ij}$ in $\{x_i, x_j\}$: how it is given, and what a translation adds to it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra.exact_numbers import is_zero, product_of, sum_of, symbols_of
from liepoisson.errors import BracketError, ParameterError, did_you_mean
from liepoisson.formula.parameters import Parameter, read_coefficient
from liepoisson.inputs.given import is_named

if TYPE_CHECKING:
    from liepoisson.algebra.exact_numbers import Coefficient, Exact

Pair: TypeAlias = tuple[int, int]


def read_constant(
    given: Mapping[tuple[str | int, str | int], Parameter] | None, names: Sequence[str]
) -> dict[tuple[int, int], Coefficient]:
    """Read a constant part: the nonzero entries by (i, j) with i < j, counted from 0.

    Raises:
        BracketError: a coordinate is unknown, or a pair is given twice or with itself.
        ParameterError: not a mapping from pairs, or an entry is not exact.
    """
    entries: Any = {} if given is None else given
    if not is_named(entries):
        raise ParameterError(
            f"constant must be a mapping from pairs of coordinates; got {entries!r:.60}. Write {_example(names)}."
        )
    found: dict[tuple[int, int], Coefficient] = {}
    for pair, value in entries.items():
        i, j = read_pair(pair, names, "the constant part")
        entry = read_coefficient(value, f"the constant part of {{{names[i]}, {names[j]}}}")
        if i == j or (min(i, j), max(i, j)) in found:
            what = "with itself" if i == j else "twice"
            raise BracketError(
                f"each pair of different coordinates may have one constant; got ({names[i]}, {names[j]}) {what}. "
                "Remove one entry."
            )
        if inside := sorted(symbols_of(entry).intersection(names)):
            raise BracketError(
                f"a constant part must not depend on the state; got {{{names[i]}, {names[j]}}} = {entry} with the "
                f"coordinate {inside[0]}. Rename a parameter of this name. A linear bracket is one of a Lie algebra, "
                "LieAlgebra.from_brackets, one of any functions of the state a PoissonTensor(variables, entries); the "
                "equations dx/dt = f(x) of no bracket are those of H = p1*f1(x) + p2*f2(x) + ... on "
                "canonical(names=..., momenta=...)."
            )
        found[min(i, j), max(i, j)] = entry if i < j else -entry
    return {pair: value for pair, value in sorted(found.items()) if not is_zero(value)}


def _example(names: Sequence[str]) -> str:
    return f'{{("{names[0]}", "{names[1 % len(names)]}"): "k"}}'


def read_pair(pair: object, names: Sequence[str], what: str) -> tuple[int, int]:
    """The numbers of two coordinates.

    Raises:
        ParameterError: not a pair.
        BracketError: a coordinate is unknown.
    """
    if not isinstance(pair, tuple) or len(cast("tuple[object, ...]", pair)) != 2:
        raise ParameterError(f"{what} is given by pairs of coordinates; got {pair!r:.60}. Write {_example(names)}.")
    first, second = (_read_coordinate(one, names, what) for one in cast("tuple[object, ...]", pair))
    return first, second


def _read_coordinate(given: object, names: Sequence[str], what: str) -> int:
    if not isinstance(given, bool) and isinstance(given, Integral) and 0 <= int(given) < len(names):
        return int(given)
    if str(given) in names:  # a text or a symbol
        return list(names).index(str(given))
    hint = did_you_mean(given, names).strip() or "Write one of these."
    shown = ", ".join(names[:20]) + (", ..." if len(names) > 20 else "")
    raise BracketError(f"{what} must name coordinates; got {given!r:.60}. Known are {shown}. {hint}")


def with_linear_part_at(
    constant: Mapping[Pair, Exact], entries: Iterable[tuple[int, int, int, Exact]], point: Sequence[Exact]
) -> dict[Any, Parameter]:
    r"""The constant part and the linear part at a point, $c_{ij} + \sum_m c_{ij}{}^m x_m$, by (i, j) with i < j.

    Args:
        constant: The constant part.
        entries: The linear part, (i, j, m, c) with i < j.
        point: The coordinates of the point.
    """
    linear = [((i, j), product_of(c, point[m])) for i, j, m, c in entries if not is_zero(point[m])]
    sums: dict[Any, Any] = {}
    for pair, value in [*constant.items(), *linear]:
        sums[pair] = sum_of(sums[pair], value) if pair in sums else value
    return sums
