r"""Polynomials in the coordinates of a Poisson tensor, whose monomials are the sorted numbers of their factors.

(-1, 0) is x0 made homogeneous of degree 2.

Here is the order of monomials that fixes the generators of Casimirs, one rule for all brackets.

The coordinates come field by field, $x_0, x_1, \dots$.  Of two monomials of a degree the one whose fields come later is
the larger: their labels are sorted and compared from the first on.  Within the same fields the one whose coordinates
come first is the larger: $\beta_1^2 > \beta_2^2 > \alpha_1\beta_1 > \alpha_1^2 > \alpha_2^2 > \ell_1\beta_1$.

A generator has the coefficient 1 at its largest monomial, at which all other members of the reduced basis have 0.  The
other coefficients are then rational functions of the structure constants.  Nothing depends on whether a structure
constant is a number or a symbol, so that inserting numbers commutes with finding the generators, except at values where
a leading coefficient vanishes (see `liepoisson.structure.casimirs.ExceptionalCase`).

Where the bracket has a constant part Casimirs are not homogeneous: a monomial of a higher degree is the larger one.

In the usual bases of an extension the unit $e_0$ comes first and products come after their factors.  A cocycle then
adds terms with early fields, such as $2\epsilon\,\ell\cdot\beta$ to $|\alpha|^2$, which are never the leading ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra import sparse_polynomials
from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.sparse_polynomials import Polynomial

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.algebra.sparse_polynomials import Monomial


def multiply(first: Polynomial, second: Polynomial) -> Polynomial:
    """The product of two polynomials."""
    return sparse_polynomials.multiply(first, second, sparse_polynomials.of_factors)


def gradient_at(polynomial: Polynomial, point: Sequence[Any]) -> dict[int, Any]:
    """The gradient of a polynomial at a point, by coordinate."""
    gradient: dict[int, Any] = {}
    for monomial, coefficient in polynomial.items():
        for position, factor in enumerate(monomial):
            term = coefficient
            for other in monomial[:position] + monomial[position + 1 :]:
                term = term * point[other]
            gradient[factor] = gradient[factor] + term if factor in gradient else term
    return gradient


def expression_of(polynomial: Polynomial, coordinates: Sequence[Expr], field: Coefficients) -> Expr:
    """A polynomial as a SymPy expression in the coordinates, with the coefficients that it has."""
    from sympy import Add, Mul

    terms: list[Any] = [Mul(field.to_sympy(c), *(coordinates[i] for i in m)) for m, c in polynomial.items()]
    return Add(*terms)


Key: TypeAlias = tuple[int, tuple[int, ...], tuple[int, ...]]


def size(monomial: Monomial, block: int) -> Key:
    """What is compared: the degree, the labels of the fields, then the coordinates, the first ones largest.

    Args:
        monomial: Indices of coordinates in increasing order.
        block: Number of coordinates of a field.
    """
    return len(monomial), tuple(i // block for i in monomial), tuple(-i for i in monomial)


def leading(monomials: Iterable[Monomial], block: int) -> Monomial:
    """The largest of these monomials."""
    return max(monomials, key=lambda monomial: size(monomial, block))


def place(monomial: Monomial, block: int) -> tuple[tuple[int, ...], Monomial]:
    r"""Where a generator with this leading monomial stands among those of its degree: early fields, first coordinates.

    For tops $|\alpha|^2 + 2\epsilon\,\ell\cdot\beta$, $\alpha\cdot\beta$, $|\\beta|^2$.
    """
    return size(monomial, block)[1], monomial


def monic(polynomial: Polynomial, block: int) -> Polynomial:
    """The multiple with the coefficient 1 at the leading monomial."""
    unit = polynomial[leading(polynomial, block)]
    return {monomial: coefficient / unit for monomial, coefficient in polynomial.items()}
