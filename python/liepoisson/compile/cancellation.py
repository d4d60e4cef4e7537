r"""Terms of J grad H that cancel are added before a field is written down.

The field of a function of $|\ell|^2$ vanishes, $\ell\times\ell f = 0$, but the products $\ell_2\,\ell_3 f$ and
$\ell_3\,\ell_2 f$ are rounded differently by a machine.  What is left of them is of the size of terms that the
equations do not have, and may be larger than all that they have.  The coefficients of equal terms are therefore added
here, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import Exact, to_sympy
from liepoisson.formula.arithmetic import expanded_terms

if TYPE_CHECKING:
    from sympy import Expr, Symbol

_KEPT = Fraction(1, 16)
"""Terms whose sum is less than this part of their sizes cancel: evaluated one by one they cost four bits or more."""

MOST_TERMS = 20_000
"""A field with more terms is written as it is: they take some seconds."""

_MOST_EXPANDED = 500
"""Products in one component that would have more terms than this together are not expanded."""


@dataclass(frozen=True)
class MinorProduct:
    """A term of a component of J grad H: a number times a coordinate, if any, times a component of the gradient."""

    coefficient: Exact
    coordinate: int | None
    slope: int


def n_terms(rates: Sequence[Sequence[MinorProduct]], slopes: Sequence[Expr]) -> int:
    """The number of terms in all components, where the sums of the gradient are multiplied out."""
    from sympy import Add

    lengths = [len(Add.make_args(slope)) for slope in slopes]
    return sum(lengths[product.slope] for products in rates for product in products)


def regrouped(products: Sequence[MinorProduct], slopes: Sequence[Expr], variables: Sequence[Symbol]) -> Expr | None:
    """The sum of the products, in which no terms cancel; None if none do as it stands."""
    from sympy import Add

    terms: list[tuple[Any, Any]] = []
    of_product: list[range] = []
    for product in products:
        outside = to_sympy(product.coefficient)
        if product.coordinate is not None:
            outside = outside * variables[product.coordinate]
        start = len(terms)
        terms += [(outside * part).as_coeff_Mul() for part in Add.make_args(slopes[product.slope]) if part != 0]
        of_product.append(range(start, len(terms)))
    changed: set[int] = set()
    result: list[Any] = []
    _add_equal(terms, changed, result)
    _add_expanded(terms, changed, result)
    if not changed:
        return None
    for product, own in zip(products, of_product, strict=True):
        if changed.isdisjoint(own):  # a sum that stays is written once
            coordinate = 1 if product.coordinate is None else variables[product.coordinate]
            result.append(to_sympy(product.coefficient) * coordinate * slopes[product.slope])
        else:
            result += [terms[k][0] * terms[k][1] for k in own if k not in changed]
    return Add(*result)


def _add_equal(terms: Sequence[tuple[Any, Any]], changed: set[int], result: list[Any]) -> None:
    """Adds terms that are multiples of each other, as they are written."""
    groups: dict[Any, list[int]] = {}
    for k, (_, rest) in enumerate(terms):
        groups.setdefault(rest, []).append(k)
    for rest, group in groups.items():
        if _cancel([terms[k][0] for k in group]):
            changed.update(group)
            result.append(sum(terms[k][0] for k in group) * rest)


def _add_expanded(terms: Sequence[tuple[Any, Any]], changed: set[int], result: list[Any]) -> None:
    """Adds products of sums after expanding them, where something cancels."""
    left = [k for k in range(len(terms)) if k not in changed]
    if sum(expanded_terms(terms[k][1]) for k in left) > _MOST_EXPANDED:
        return
    masks: dict[Any, Any] = {}
    polynomials = {k: _polynomial(terms[k][0] * _masked(terms[k][1], masks)) for k in left}
    coefficients: dict[Any, list[Any]] = {}
    for polynomial in polynomials.values():
        for monomial, coefficient in polynomial.items():
            coefficients.setdefault(monomial, []).append(coefficient)
    lost = {monomial for monomial, values in coefficients.items() if _cancel(values)}
    expanded = [k for k in left if not lost.isdisjoint(polynomials[k])]
    if not expanded:
        return
    changed.update(expanded)
    sums: dict[Any, Any] = {}
    for k in expanded:
        for monomial, coefficient in polynomials[k].items():
            sums[monomial] = sums.get(monomial, 0) + coefficient
    unmasked = {dummy: part for part, dummy in masks.items()}
    result += [coefficient * monomial.xreplace(unmasked) for monomial, coefficient in sums.items()]


def _cancel(coefficients: Sequence[Any]) -> bool:
    """Whether the sum of these numbers is small beside them."""
    return len(coefficients) > 1 and abs(sum(coefficients)) < to_sympy(_KEPT) * sum(map(abs, coefficients))


def _polynomial(expression: Any) -> dict[Any, Any]:
    """Coefficients by monomial of an expression made of sums, products and whole powers."""
    from sympy import Add, expand

    pairs = [term.as_coeff_Mul() for term in Add.make_args(expand(expression))]
    return {rest: coefficient for coefficient, rest in pairs if coefficient != 0}


def _masked(expression: Any, masks: dict[Any, Any]) -> Any:
    """The expression with a symbol for each part that is no sum, product or whole power of variables and rationals."""
    from sympy import Dummy

    if expression.is_Symbol or expression.is_Rational:
        return expression
    if expression.is_Add or expression.is_Mul:
        return expression.func(*(_masked(part, masks) for part in expression.args))
    if expression.is_Pow and expression.exp.is_Integer and expression.exp > 0:
        return _masked(expression.base, masks) ** expression.exp
    return masks.setdefault(expression, Dummy())
