r"""Quotients of exponentials, written so that none of them is infinite over infinite.

$e^u/(1 + e^u)^2$ tends to zero on both sides, and in doubles it is $\infty/\infty$ for $u > 710$.  With $D = \sum_i c_i
e^{u_i}$ and all $c_i > 0$,

$$\frac{e^{u_i}}{D} = \frac1{\sum_j c_j e^{u_j - u_i}} ,$$

and one over a sum of positive terms is right to all digits, or zero where a term is beyond the range of numbers.
Likewise $\sinh u/\cosh u$ is a hyperbolic tangent.
"""

from __future__ import annotations

from itertools import combinations_with_replacement
from typing import Any

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
