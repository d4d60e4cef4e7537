r"""Points at which a claimed integral is seen to change: $\{K, H\} \ne 0$, for claims on a set also $Z = 0$.

A derivative that is not recognised as zero refutes nothing by itself: it may vanish on the real points of the set
though it is no multiple of Z (of $Z = |\alpha|^2$ these are $\alpha = 0$), or be zero in a way that was not found.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from random import Random
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.exact_numbers import to_sympy

if TYPE_CHECKING:
    from sympy import Expr, Symbol

_TRIES = 40
_DIGITS = 40
_MARGIN = Fraction(1, 10**12)
"""A number of 40 digits that is larger than this is not zero."""


def is_nonzero_somewhere(function: Expr, variables: Sequence[Symbol]) -> bool:
    """Whether a real point was found at which the function does not vanish."""
    from sympy import fraction, together

    numerator: Any = fraction(together(function))[0]
    if numerator.is_polynomial(*variables) and not numerator.free_symbols - set(variables):
        return numerator.expand() != 0
    return any(_is_large(function.subs(point)) for point in _points(function, variables))


def is_nonzero_on(function: Expr, zero: Expr, variables: Sequence[Symbol]) -> bool:
    """Whether a real point was found at which `zero` vanishes and the function does not.

    On lines along the axes: for polynomials with rational coefficients the zeros are counted exactly (Sturm), after
    those that they have in common with the function are removed; otherwise a change of sign is followed.
    """
    for point in _points(function + zero, variables):
        for variable in sorted(zero.free_symbols & set(variables), key=str):
            rest = {name: value for name, value in point.items() if name != variable}
            if _is_nonzero_on_line(function.subs(rest), zero.subs(rest), variable):
                return True
    return False


def _points(function: Expr, variables: Sequence[Symbol]) -> Iterator[dict[Any, Any]]:
    """Rational points, many coordinates being zero; symbolic parameters get positive values.  Always the same ones."""
    random = Random(1)
    parameters = sorted(function.free_symbols - set(variables), key=str)
    for _ in range(_TRIES):
        point: dict[Any, Any] = {
            x: to_sympy(Fraction(random.choice((0, 0, 1, 1, -1, 2, -3, 5)), random.choice((1, 1, 2, 3))))
            for x in variables
        }
        point |= {name: to_sympy(Fraction(random.randint(1, 7), random.randint(1, 5))) for name in parameters}
        yield point


def _is_nonzero_on_line(function: Any, zero: Any, x: Any) -> bool:
    from sympy import Poly, fraction, nan, oo, together, zoo
    from sympy.polys.polyerrors import BasePolynomialError

    if function.has(nan, oo, zoo) or zero.has(nan, oo, zoo) or function == 0 or not zero.has(x):
        return False
    numerator, denominator = fraction(together(function))
    try:
        set_ = Poly(fraction(together(zero))[0], x, domain="QQ")
        others = [Poly(f, x, domain="QQ") for f in (numerator, denominator, fraction(together(zero))[1])]
    except BasePolynomialError:  # not polynomials, or irrational coefficients
        return _changes_sign(function, zero, x)
    for other in others:
        while not set_.is_zero and (common := set_.gcd(other)).degree() > 0:
            set_ = set_.quo(common)
    return set_.degree() > 0 and set_.count_roots() > 0


def _changes_sign(function: Any, zero: Any, x: Any) -> bool:
    """The same for other functions: bisection, then both functions at the place that was found."""
    grid = [to_sympy(Fraction(k, 3)) for k in range(-10, 11)]
    signs = [(place, _sign(zero, x, place)) for place in grid]
    for (low, first), (high, second) in pairwise(signs):
        if first * second >= 0:
            continue
        a, b = low, high
        for _ in range(4 * _DIGITS):
            middle = (a + b) / 2
            if _sign(zero, x, middle) == first:
                a = middle
            else:
                b = middle
        here = (a + b) / 2
        # A pole changes its sign, too, but is not small there.
        if not _is_large(zero.subs(x, here)) and _is_large(function.subs(x, here)):
            return True
    return False


def _sign(function: Any, x: Any, place: Any) -> int:
    value = function.subs(x, place).evalf(_DIGITS)
    return 0 if not value.is_real or value == 0 else (1 if value > 0 else -1)


def _is_large(value: Any) -> bool:
    """Whether it is a real number that is not zero, with a margin."""
    number = value.evalf(_DIGITS)
    return bool(number.is_Number and number.is_finite and abs(number) > to_sympy(_MARGIN))
