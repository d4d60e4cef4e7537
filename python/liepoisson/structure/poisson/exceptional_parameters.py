r"""Where a generic null space may change: the roots of what the elimination divided by.

Over the field of rational functions of the parameters, an elimination divides by pivots.  At values where no numerator
and no denominator of a pivot vanishes it goes through unchanged, so the null space has its generic dimension.  What
remains are finitely many irreducible conditions.  With one parameter these are its real roots, all of which are listed.
With several parameters, conditions that are linear in one of them are solved for it, the others staying generic
(intersections of conditions are not examined); the rest is reported as undecided.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.exact_numbers import Exact, to_sympy
from liepoisson.formula.parameters import read_parameter

if TYPE_CHECKING:
    from liepoisson.algebra.coefficients import Coefficients

SpecialValue: TypeAlias = "tuple[str, dict[str, Exact]]"
"""A condition as text, and the values to insert for it."""


def special_values(pivots: Iterable[Any], field: Coefficients) -> tuple[list[SpecialValue], tuple[str, ...]]:
    """The parameter values at which a null space may be larger, and conditions that were not solved.

    Args:
        pivots: Rational functions, elements of the field.
        field: A field with parameters.
    """
    found: dict[str, dict[str, Exact]] = {}
    undecided: list[str] = []
    for factor in _irreducible_factors(pivots, field):
        if not factor.free_symbols:  # a number such as e, of which nothing is known here
            continue
        solutions = _solve(factor, [s for s in field.parameters if factor.has(s)])
        if solutions is None:
            undecided.append(f"{factor} = 0")
        else:
            found |= {f"{name} = {value}": {name: value} for name, value in solutions}
    return sorted(found.items(), key=_by_size), tuple(undecided)


def _by_size(condition: SpecialValue) -> tuple[Any, ...]:
    """Names in the order of the alphabet, the values of one name by size; values that are no numbers at the end."""
    ((name, value),) = condition[1].items()
    number = to_sympy(value)
    return (name, 0, float(number), "") if number.is_number else (name, 1, 0.0, str(number))


def _irreducible_factors(pivots: Iterable[Any], field: Coefficients) -> list[Any]:
    polynomials = {part for pivot in pivots for part in (pivot.numer, pivot.denom) if not part.is_ground}
    factors = {factor for polynomial in polynomials for factor, _ in polynomial.factor_list()[1]}
    return sorted((factor.as_expr(*field.parameters) for factor in factors), key=str)


def _solve(factor: Any, symbols: list[Any]) -> list[tuple[str, Exact]] | None:
    """Solutions name = value of factor = 0, or None if none can be written down."""
    from sympy import Poly

    if not all(symbol.is_Symbol for symbol in symbols):
        return None
    if len(symbols) == 1:
        roots = Poly(factor, symbols[0]).real_roots(multiple=False)
        return [(str(symbols[0]), read_parameter(root, str(symbols[0]))) for root, _ in roots]
    for symbol in symbols:
        polynomial = Poly(factor, symbol)
        if polynomial.degree() == 1:
            slope, constant = polynomial.all_coeffs()
            return [(str(symbol), read_parameter((-constant / slope).cancel(), str(symbol)))]
    return None
