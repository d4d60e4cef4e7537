"""Polynomials in the coordinates of a Poisson tensor, as dictionaries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients

if TYPE_CHECKING:
    from sympy import Expr

Monomial: TypeAlias = tuple[int, ...]
"""Indices of the factors in increasing order: (0, 0, 2) is x0^2 x2, and (-1, 0) is x0 made homogeneous of degree 2."""

Polynomial: TypeAlias = dict[Monomial, Any]
"""Coefficients, elements of the field, by monomial."""


def multiply(first: Polynomial, second: Polynomial) -> Polynomial:
    """The product of two polynomials."""
    product: Polynomial = {}
    for m1, c1 in first.items():
        for m2, c2 in second.items():
            key, value = tuple(sorted(m1 + m2)), c1 * c2
            product[key] = product[key] + value if key in product else value
    return {m: c for m, c in product.items() if c}


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
