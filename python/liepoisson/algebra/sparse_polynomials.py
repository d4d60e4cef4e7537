"""Sparse polynomials over any ring: dictionaries from monomial to coefficient, without zeros.

A monomial is the tuple of its exponents, or, where there are many variables, the sorted tuple of the numbers of its
factors: (0, 0, 2) is x0^2 x2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import add, le
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.inputs.deadline import checkpoint

if TYPE_CHECKING:
    from sympy import Expr

Monomial: TypeAlias = tuple[int, ...]
Polynomial: TypeAlias = dict[Monomial, Any]


def of_exponents(first: Monomial, second: Monomial) -> Monomial:
    """The product of two monomials, by their exponents."""
    return tuple(map(add, first, second))


def of_factors(first: Monomial, second: Monomial) -> Monomial:
    """The product of two monomials, by their factors."""
    return tuple(sorted(first + second))


def divides(first: Monomial, second: Monomial) -> bool:
    """Whether a monomial divides another, by their exponents."""
    return all(map(le, first, second))


def multiply(
    first: Mapping[Monomial, Any],
    second: Mapping[Monomial, Any],
    monomials: Callable[[Monomial, Monomial], Monomial] = of_exponents,
) -> Polynomial:
    """The product of two polynomials.

    Args:
        first: A polynomial.
        second: Another one.
        monomials: How monomials are multiplied.

    Raises:
        TimeLimitError: the deadline of the call has passed.
    """
    product: Polynomial = {}
    for m, c in first.items():
        checkpoint("a product of polynomials")
        for k, d in second.items():
            key, value = monomials(m, k), c * d
            product[key] = product[key] + value if key in product else value
    return {m: c for m, c in product.items() if c}


def add_multiple(total: Polynomial, polynomial: Mapping[Monomial, Any], factor: Any) -> None:
    """Add a multiple of a polynomial to another one, in place, dropping zeros."""
    for m, c in polynomial.items():
        value = total[m] + factor * c if m in total else factor * c
        if value:
            total[m] = value
        else:
            total.pop(m, None)


def value_at(
    terms: Iterable[tuple[Sequence[int], Any]], point: Sequence[Any], number: Callable[[Any], Any] = lambda c: c
) -> Any:
    """The value at a point.

    Args:
        terms: Exponents and coefficients.
        point: Elements of a ring, only those that occur.
        number: Maps coefficients to that ring.
    """
    total = number(0)
    for monomial, coefficient in terms:
        term = number(coefficient)
        for x, power in zip(point, monomial, strict=True):
            if power:
                term = term * x ** int(power)
        total = total + term
    return total


def gradient_at(polynomial: Mapping[Monomial, Any], point: Sequence[Any]) -> dict[int, Any]:
    """The gradient at a point, by the numbers of the variables; monomials by their exponents."""
    gradient: dict[int, Any] = {}
    for monomial, coefficient in polynomial.items():
        powers = [x**k if k else 1 for x, k in zip(point, monomial, strict=True)]
        for i, k in enumerate(monomial):
            if not k:
                continue
            term = coefficient * k if k == 1 else coefficient * k * point[i] ** (k - 1)
            for j, power in enumerate(powers):
                if j != i and monomial[j]:
                    term = term * power
            gradient[i] = gradient[i] + term if i in gradient else term
    return {i: v for i, v in gradient.items() if v}


def derivative(polynomial: Mapping[Monomial, Any], k: int) -> Polynomial:
    """The derivative by variable number k; monomials by their exponents."""
    return {(*m[:k], m[k] - 1, *m[k + 1 :]): c * m[k] for m, c in polynomial.items() if m[k]}


def along(polynomial: Mapping[Monomial, Any], rates: Sequence[Mapping[Monomial, Any]]) -> Polynomial:
    r"""The rate of change along a vector field, $\sum_k f_k\,\partial F/\partial x_k$; empty if F is constant."""
    total: Polynomial = {}
    for k, rate in enumerate(rates):
        add_multiple(total, multiply(derivative(polynomial, k), rate), 1)
    return total


def rational_to_sympy(value: Any) -> Expr:
    """A Fraction or a rational number of FLINT for SymPy."""
    from sympy import Rational

    return Rational(int(value.numerator), int(value.denominator))


def expression(
    terms: Iterable[tuple[Sequence[int], Any]],
    variables: Sequence[Any],
    number: Callable[[Any], Expr] = rational_to_sympy,
) -> Expr:
    """The SymPy expression of a polynomial.

    Args:
        terms: Exponents and coefficients.
        variables: SymPy's.
        number: Maps coefficients to expressions.
    """
    from sympy import Add, Mul

    return Add(*(Mul(number(c), *(x ** int(k) for x, k in zip(variables, m, strict=True) if k)) for m, c in terms))


def whole_expression(terms: Iterable[tuple[Sequence[int], Any]], variables: Sequence[Any]) -> Expr:
    """A polynomial with rational coefficients up to a factor: whole coefficients without a common one, a sign fixed."""
    read: Any = expression(terms, variables)
    whole = read.as_numer_denom()[0].primitive()[1]
    return -whole if whole.could_extract_minus_sign() else whole
