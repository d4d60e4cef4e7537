r"""Numbers with square roots: fields $\mathbb Q(\sqrt{d_1},\dots,\sqrt{d_r})$, and roots of quadratic polynomials."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import cache
from itertools import combinations
from math import isqrt, prod
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients

if TYPE_CHECKING:
    from sympy import Expr


def roots(a: Fraction, b: Fraction, c: Fraction) -> tuple[Expr, Expr]:
    r"""The zeros of $a x^2 + b x + c$, with the square root of a squarefree number."""
    from sympy import Rational, sqrt

    discriminant, middle = b * b - 4 * a * c, -b / (2 * a)
    root: Any = sqrt(Rational(discriminant.numerator, discriminant.denominator))
    step: Any = root / Rational((2 * a).numerator, (2 * a).denominator)
    centre = Rational(middle.numerator, middle.denominator)
    return centre + step, centre - step


def field_of(values: Iterable[Expr]) -> Coefficients:
    """The field that the square roots in some numbers generate."""
    independent: list[int] = []
    for d in sorted({d for value in values for d in _radicands(value)}, key=lambda d: (abs(d), d)):
        subsets = (s for n in range(len(independent) + 1) for s in combinations(independent, n))
        if not any(_is_square(d * prod(s)) for s in subsets):
            independent.append(d)
    return _field(tuple(independent))


def element(value: Expr, field: Coefficients) -> Any:
    """A number with these square roots as an element of the field."""
    from sympy import Add, I, Mul

    total = field.zero
    for term in Add.make_args(value.expand()):
        product = field.one
        for factor in Mul.make_args(term):
            number: Any = factor
            if number.is_Rational:
                product = product * field.number(Fraction(int(number.p), int(number.q)))
            elif number == I:
                product = product * _root(-1, field.domain)
            else:
                product = product * _root(int(number**2), field.domain)  # SymPy has sqrt(2/3) as sqrt(6)/3
        total = total + product
    return total


@cache
def _field(independent: tuple[int, ...]) -> Coefficients:
    """The field of some square roots, none of which is a product of others."""
    from sympy import QQ, sqrt

    return Coefficients(QQ.algebraic_field(*map(sqrt, independent))) if independent else Coefficients()


@cache
def _root(d: int, domain: Any) -> Any:
    """The square root of an integer as an element of a field, for which SymPy factors a polynomial over it."""
    from sympy import sqrt

    return domain.from_sympy(sqrt(d))


def _radicands(value: Expr) -> set[int]:
    """The integers under the square roots of a number, -1 for i."""
    from sympy import I, Pow

    found = {-1} if value.has(I) else set[int]()
    return found | {int(p.base) for p in value.atoms(Pow) if p.base.is_Integer and not p.exp.is_Integer}


def _is_square(d: int) -> bool:
    return d >= 0 and isqrt(d) ** 2 == d
