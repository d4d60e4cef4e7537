"""Systems and functions that are given as texts, as the core reads them: without SymPy, in the grouping of the user."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from liepoisson import _core
from liepoisson.algebra.exact_numbers import Coefficient, symbols_of, to_sympy
from liepoisson.algebra.symbol_polynomials import SymbolPolynomial
from liepoisson.errors import LiePoissonError
from liepoisson.formula.parameters import Kept, flattened

if TYPE_CHECKING:
    from liepoisson.structure.bracket import Bracket

Names: TypeAlias = "Sequence[str] | Sequence[tuple[str, Sequence[str]]]"
"""Of scalar coordinates, or of fields with those of their components."""


def names_of(bracket: Bracket) -> Names:
    """The coordinates of a bracket, as formulas call them."""
    vectors, scalars = bracket.vectors, bracket.scalars
    if not vectors:
        return list(scalars)
    return [(field, list(names)) for field, names in vectors.items()] + [(name, [""]) for name in scalars]


def read_system(
    names: Names, bracket: Bracket | None, hamiltonian: str, values: Mapping[str, Kept]
) -> _core.TypedSystem | None:
    """The system that the core reads; None where it refuses it, or where a number is a symbol.

    SymPy then reads the system, and says what is wrong with it.

    Args:
        names: The coordinates.
        bracket: The bracket with numbers, linear or not; None where functions alone are wanted.
        hamiltonian: The Hamiltonian.
        values: Of the parameters.
    """
    if (bracket is not None and _has_symbols(bracket)) or any(map(symbols_of, flattened(values).values())):
        return None
    try:
        terms = [] if bracket is None else _terms(bracket)
        return _core.TypedSystem(
            names, terms, hamiltonian, [(name, _texts(value)) for name, value in values.items()], []
        )
    except LiePoissonError:
        return None


def _has_symbols(bracket: Bracket) -> bool:
    """Whether a number of the bracket is a symbol."""
    return any(symbols_of(c) for *_, c in bracket.kept_entries()) if bracket.is_linear else bool(bracket.symbols)


def _terms(bracket: Bracket) -> list[tuple[int, int, int | None, str]]:
    """The terms of a bracket with numbers, as the core takes them; functions of the state in the names of these."""
    if bracket.is_linear:
        return [(i, j, m, _text(c)) for i, j, m, c in bracket.kept_entries()]
    from liepoisson.compile.printing import printed_functions

    terms = bracket.terms()
    texts = printed_functions(bracket.variables, [to_sympy(c) for *_, c in terms])
    return [(i, j, m, text) for (i, j, m, _), text in zip(terms, texts, strict=True)]


def _texts(value: Kept) -> str | list[str] | list[list[str]]:
    """A parameter as the core takes it: a number, a vector, or a matrix by its rows."""
    if not isinstance(value, tuple):
        return _text(value)
    return [_texts(entry) for entry in value]  # pyright: ignore[reportReturnType]


def _text(value: Coefficient) -> str:
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, SymbolPolynomial):
        return value.formula()
    from liepoisson.compile.printing import printed_number

    return printed_number(value)
