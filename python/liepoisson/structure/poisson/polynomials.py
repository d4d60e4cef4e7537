"""Polynomials in the coordinates of a Poisson tensor, whose monomials are the sorted numbers of their factors.

(-1, 0) is x0 made homogeneous of degree 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from liepoisson.algebra import sparse_polynomials
from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.sparse_polynomials import Polynomial

if TYPE_CHECKING:
    from sympy import Expr


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
