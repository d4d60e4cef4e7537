r"""Equations of motion of polynomial Hamiltonians, $\dot x = J\nabla H$, derived from the bracket without SymPy."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from liepoisson.exact.rational_polynomials import Expanded, RationalPolynomial, multiplied
from liepoisson.exact.rounded import rounded

if TYPE_CHECKING:
    from liepoisson.exact.bracket import Bracket
    from liepoisson.exact.rounded import Rounded


def is_rational(bracket: Bracket) -> bool:
    """Whether all structure constants and the constant part are rational numbers."""
    if bracket.algebra.symbols or bracket.extension.symbols:
        return False
    linear = all(isinstance(c, Fraction) for *_, c in bracket.entries())
    return linear and all(isinstance(c, Fraction) for c in bracket.constant.values())


def rates_of(bracket: Bracket, hamiltonian: RationalPolynomial) -> tuple[RationalPolynomial, ...]:
    r"""$J\nabla H$, expanded, one polynomial for each coordinate; the bracket must be rational.

    Raises:
        TooLargeError: an expanded polynomial has too many terms.
    """
    slopes = [hamiltonian.derivative(k).expanded for k in range(bracket.dimension)]
    rates: list[Expanded] = [{} for _ in slopes]

    def add(i: int, j: int, factor: tuple[int, ...], number: Fraction) -> None:
        for monomial, value in slopes[j].items():
            key = tuple(sorted((*factor, *monomial)))
            rates[i][key] = rates[i].get(key, Fraction(0)) + number * value

    for i, j, m, c in bracket.entries():
        assert isinstance(c, Fraction)
        add(i, j, (m,), c)
        add(j, i, (m,), -c)
    for (i, j), c in bracket.constant.items():
        assert isinstance(c, Fraction)
        add(i, j, (), c)
        add(j, i, (), -c)
    return tuple(RationalPolynomial.of(rate) for rate in rates)


def bracket_with(rates: Sequence[RationalPolynomial], function: RationalPolynomial) -> RationalPolynomial:
    r"""$\{f, H\} = \nabla f\cdot\dot x$, expanded, from the rates $\dot x = J\nabla H$.

    Raises:
        TooLargeError: an expanded polynomial has too many terms.
    """
    total: Expanded = {}
    for number in function.coordinates:
        for monomial, value in multiplied(function.derivative(number).expanded, rates[number].expanded).items():
            total[monomial] = total.get(monomial, Fraction(0)) + value
    return RationalPolynomial.of(total)


def of_degree_two(polynomial: RationalPolynomial) -> dict[tuple[int, ...], Rounded] | None:
    """The coefficients of a polynomial of degree at most two; None for another one."""
    expanded = polynomial.expanded
    if max(map(len, expanded), default=0) > 2:
        return None
    return {monomial: rounded(value) for monomial, value in expanded.items()}
