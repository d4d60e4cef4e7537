r"""Terms of J grad H that cancel are added before a field is written down.

The field of a function of $|\ell|^2$ vanishes, $\ell\times\ell f = 0$, but the products $\ell_2\,\ell_3 f$ and
$\ell_3\,\ell_2 f$ are rounded differently by a machine.  What is left of them is of the size of terms that the
equations do not have, and may be larger than all that they have.  The coefficients of equal terms are therefore added
here, exactly.

Quotients of exponentials are written so that none of them is infinite over infinite.

$e^u/(1 + e^u)^2$ tends to zero on both sides, and in doubles it is $\infty/\infty$ for $u > 710$.  With $D = \sum_i c_i
e^{u_i}$ and all $c_i > 0$,

$$\frac{e^{u_i}}{D} = \frac1{\sum_j c_j e^{u_j - u_i}} ,$$

and one over a sum of positive terms is right to all digits, or zero where a term is beyond the range of numbers.
Likewise $\sinh u/\cosh u$ is a hyperbolic tangent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations_with_replacement
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


_MOST_FACTORS = 4
"""Exponentials that are looked for in a product."""
_MOST_TERMS = 6
"""Exponentials in a sum that is looked at."""


def without_overflow(expression: Any) -> Any:
    """The same expression of real variables, in which an exponential does not stand over a sum that it is a term of."""
    from sympy import cosh, exp, sinh

    if not expression.has(exp, sinh, cosh):
        return expression
    return expression.replace(lambda part: part.is_Mul, _product)


def _product(product: Any) -> Any:
    """The product, its exponentials and hyperbolic functions divided by what they stand over."""
    from sympy import Mul

    powers: dict[Any, Any] = dict(product.as_powers_dict())
    _divide_hyperbolic(powers)
    _divide_sums(powers)
    _divide_exponentials(powers)
    return Mul(*(base**exponent for base, exponent in powers.items()))


def _divide_hyperbolic(powers: dict[Any, Any]) -> None:
    """Write sinh over cosh as tanh, cosh over sinh as one over tanh."""
    from sympy import cosh, sinh, tanh

    for base in [base for base in powers if isinstance(base, sinh)]:
        argument = base.args[0]
        other = cosh(argument)
        m, n = powers[base], powers.get(other, 0)
        if m.is_Integer and n != 0 and n.is_Integer and m * n < 0:
            common = min(abs(m), abs(n)) * (1 if m > 0 else -1)
            powers[base], powers[other] = m - common, n + common
            powers[tanh(argument)] = powers.get(tanh(argument), 0) + common


def _divide_sums(powers: dict[Any, Any]) -> None:
    """Divide sums of exponentials by sums of exponentials, term by term."""
    from sympy import Add, exp

    for top in [base for base, n in powers.items() if base.is_Add and base.has(exp) and n.is_Integer and n > 0]:
        for bottom in [base for base, n in powers.items() if n.is_Integer and n < 0 and _sum_of_exponentials(base)]:
            common = min(powers[top], -powers[bottom])
            quotients = [(term / bottom, _product(term / bottom)) for term in top.args]
            if common > 0 and any(plain != divided for plain, divided in quotients):
                powers[top], powers[bottom] = powers[top] - common, powers[bottom] + common
                ratio = Add(*(divided for _, divided in quotients))
                powers[ratio] = powers.get(ratio, 0) + common


def _divide_exponentials(powers: dict[Any, Any]) -> None:
    """Write exponentials over sums that they are terms of as one over sums."""
    from sympy import Add, E, Integer, cosh, exp, expand

    for base in [base for base in powers if base != E]:
        exponent, argument = powers[base], powers.get(E, Integer(0))
        if argument == 0:
            return
        if not (exponent.is_Rational and exponent < 0):
            continue
        if isinstance(base, cosh):
            u: Any = base.args[0]
            terms: dict[Any, Any] | None = {u: Integer(1) / 2, -u: Integer(1) / 2}
        else:
            terms = _sum_of_exponentials(base)
        if terms is None:
            continue
        chosen = _chosen(argument, list(terms), int(-exponent))
        if not chosen:
            continue
        rest = argument - Add(*chosen)
        powers[E] = Integer(0) if expand(rest) == 0 else rest
        powers[base] = exponent + len(chosen)
        for u in chosen:
            divided = Add(*(c * exp(v - u) for v, c in terms.items()))
            powers[divided] = powers.get(divided, 0) - 1


def _sum_of_exponentials(base: Any) -> dict[Any, Any] | None:
    """The positive coefficients of a sum of exponentials and a constant, by argument; None if it is no such sum."""
    from sympy import Add, Integer, exp

    terms: dict[Any, Any] = {}
    parts = Add.make_args(base)
    if not 2 <= len(parts) <= _MOST_TERMS:
        return None
    for part in parts:
        coefficient, rest = part.as_independent(*part.free_symbols, as_Add=False)
        if not part.free_symbols:
            coefficient, argument = part, Integer(0)
        elif isinstance(rest, exp):
            argument = rest.args[0]
        else:
            return None
        if coefficient.is_positive is not True:
            return None
        terms[argument] = terms.get(argument, 0) + coefficient
    return terms


def _chosen(argument: Any, terms: list[Any], most: int) -> tuple[Any, ...]:
    """At most so many arguments that add up to that of an exponential, or leave a positive multiple of one; else none.

    Each is that of a term of the sum, or lies between that and zero.
    """
    from sympy import Add, Integer, cancel, expand

    own = [u for u in terms if u != 0]
    for u in own:
        ratio = cancel(argument / u)
        if ratio.is_Rational and ratio > 0 and most > 0:
            whole = min(int(ratio), most)
            rest = (ratio - whole) * u
            return (u,) * whole + ((rest,) if whole < most and rest != 0 else ())
    for count in range(2, min(most, _MOST_FACTORS) + 1):
        for found in combinations_with_replacement(own, count):
            if expand(argument - Add(*found)) == Integer(0):
                return found
    return ()
