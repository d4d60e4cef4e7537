r"""Numbers with square roots: fields $\mathbb Q(\sqrt{d_1},\dots,\sqrt{d_r})$, and roots of quadratic polynomials."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import combinations
from math import isqrt, prod
from typing import TYPE_CHECKING, Any

from liepoisson.exact.linear.coefficients import Coefficients

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
    from sympy import QQ, sqrt

    independent: list[int] = []
    for d in sorted({d for value in values for d in _radicands(value)}, key=lambda d: (abs(d), d)):
        subsets = (s for n in range(len(independent) + 1) for s in combinations(independent, n))
        if not any(_is_square(d * prod(s)) for s in subsets):
            independent.append(d)
    return Coefficients(QQ.algebraic_field(*map(sqrt, independent))) if independent else Coefficients()


def element(value: Expr, field: Coefficients) -> Any:
    """A number with these square roots as an element of the field."""
    return field.read(value)


def _radicands(value: Expr) -> set[int]:
    """The integers under the square roots of a number, -1 for i."""
    from sympy import I, Pow

    found = {-1} if value.has(I) else set[int]()
    return found | {int(p.base) for p in value.atoms(Pow) if p.base.is_Integer and not p.exp.is_Integer}


def _is_square(d: int) -> bool:
    return d >= 0 and isqrt(d) ** 2 == d
