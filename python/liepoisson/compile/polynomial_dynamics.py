r"""Equations of motion of polynomial Hamiltonians, $\dot x = J\nabla H$, derived from the bracket without SymPy."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from liepoisson.algebra.rational_polynomials import Expanded, RationalPolynomial, multiplied, product_of, sum_of
from liepoisson.algebra.rounded import rounded

if TYPE_CHECKING:
    from liepoisson.algebra.rounded import Rounded
    from liepoisson.structure.bracket import Bracket


def is_rational(bracket: Bracket) -> bool:
    """Whether all structure constants and the constant part are rational numbers."""
    if bracket.algebra.symbols or bracket.extension.symbols:
        return False
    linear = all(isinstance(c, Fraction) for *_, c in bracket.entries())
    return linear and all(isinstance(c, Fraction) for c in bracket.constant.values())


def rates_of(bracket: Bracket, hamiltonian: RationalPolynomial) -> tuple[RationalPolynomial, ...]:
    r"""$J\nabla H$, one polynomial for each coordinate; the bracket must be rational.

    They are expanded where the Hamiltonian is; a square of a sum in it stays one, whose terms do not cancel.

    Raises:
        TooLargeError: an expanded polynomial has too many terms.
    """
    slopes = [hamiltonian.derivative(k) for k in range(bracket.dimension)]
    rates: list[list[RationalPolynomial]] = [[] for _ in slopes]

    def add(i: int, j: int, factor: RationalPolynomial) -> None:
        own = slopes[j].terms
        parts = [RationalPolynomial({monomial: value}) for monomial, value in own.items()]
        rates[i] += [product_of([factor, part]) for part in parts]

    for i, j, m, c in bracket.entries():
        assert isinstance(c, Fraction)
        add(i, j, product_of([c, RationalPolynomial.coordinate(m)]))
        add(j, i, product_of([-c, RationalPolynomial.coordinate(m)]))
    for (i, j), c in bracket.constant.items():
        assert isinstance(c, Fraction)
        add(i, j, RationalPolynomial.constant(c))
        add(j, i, RationalPolynomial.constant(-c))
    found = tuple(sum_of(rate) for rate in rates)
    for rate in found:
        _ = rate.expanded  # which others ask for, and which refuses what is too large
    return found


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
