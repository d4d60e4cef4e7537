r"""Signs of polynomials that can be read off their terms or their squares, for real values of the variables.

Over the rationals every polynomial of degree two is $q = \sum_i d_iL_i^2 + M + c$ with independent linear forms $L_i$
(with constants) and M, which is zero or independent of them. If M is not zero, or two of the $d_i$ and c have different
signs, q has real zeros and takes both signs. Otherwise q vanishes where all $L_i$ do, if c = 0, and never, if not.

The same holds for q in powers of the variables, as far as it says that there is no zero: $a^4 + a^2b^2 + b^4$ vanishes
only with $a^2 + b^2/2$ and $b^2$.
"""

from __future__ import annotations

from collections.abc import Collection
from math import gcd
from typing import Any

from flint import fmpq

from liepoisson.algebra.ideals.buchberger import Poly


def definite_terms(p: Poly, positive: Collection[int] = ()) -> list[Poly] | None:
    """The terms of a polynomial without their powers, if all of them have one sign and so vanish together.

    A term has a sign if every power in it is even or that of a positive variable. Positive variables are left out, as
    they do not vanish, and a single term is not taken apart, unless it never vanishes.

    Args:
        p: A polynomial over the rationals.
        positive: Numbers of the variables that are positive; all others are real.
    """
    context = p.context()
    signs: set[bool] = set()
    terms: list[Poly] = []
    for monomial, c in p.terms():
        signs.add(c > 0)
        powers = [int(k) for k in monomial]
        if len(signs) > 1 or any(k % 2 and v not in positive for v, k in enumerate(powers)):
            return None
        bases = tuple(int(bool(k) and v not in positive) for v, k in enumerate(powers))
        terms.append(context.from_dict({bases: 1}))
    return terms if len(terms) > 1 or all(t.is_constant() for t in terms) else None


def vanishing_parts(p: Poly, positive: Collection[int] = ()) -> list[Poly] | None:
    """Polynomials that vanish together where this one does, if its terms or completed squares show it.

    They have smaller degree, or are fewer terms; one of them is a constant if there is no real zero.
    """
    terms = definite_terms(p, positive)
    return terms if terms is not None else vanishing_squares(p)


def never_vanishes(p: Poly, positive: Collection[int] = ()) -> bool:
    """Whether the terms or the squares of a polynomial show that it has no real zero."""
    parts = vanishing_parts(p, positive)
    return parts is not None and any(t.is_constant() for t in parts)


def vanishing_squares(p: Poly) -> list[Poly] | None:
    """Polynomials that vanish together where a quadratic polynomial does, for real values of the variables.

    Returns:
        They are [1] if there is no real zero; None if the polynomial is not quadratic in powers of the variables, or
        takes both signs.
    """
    n = len(p.context().gens())
    powers = [gcd(*(int(m[v]) for m, _ in p.terms())) or 1 for v in range(n)]
    found = _squares_in(p, [1] * n)
    return found if found is not None else _squares_in(p, powers)


def _squares_in(p: Poly, steps: list[int]) -> list[Poly] | None:
    """The same for a polynomial that is quadratic in these powers of the variables."""
    context = p.context()
    n = len(steps)
    form = {tuple(int(k) // s for k, s in zip(m, steps, strict=True)): c for m, c in p.terms()}
    if max(map(sum, form), default=0) != 2:
        return None
    completed = _completed(form, n)
    if completed is None:
        return None
    squares, constant = completed
    if len({d > 0 for d in (*squares.values(), *([constant] if constant else []))}) > 1:
        return None
    if constant:
        return [context.constant(1)]
    values: list[Any] = [*(x**s for x, s in zip(context.gens(), steps, strict=True)), 1]
    return [sum((c * x for c, x in zip(linear, values, strict=True) if c), context.constant(0)) for linear in squares]


def _completed(form: dict[tuple[int, ...], fmpq], n: int) -> tuple[dict[tuple[fmpq, ...], fmpq], fmpq] | None:
    """The linear forms with their factors, and the constant; None where the polynomial takes both signs.

    A form has n + 1 coefficients, the last one its constant.
    """
    # the symmetric matrix of the form made homogeneous by one more variable
    a = [[fmpq(0)] * (n + 1) for _ in range(n + 1)]
    for m, c in form.items():
        places = [v for v, k in enumerate(m) for _ in range(k)]
        i, j = (*places, n, n)[:2]
        a[i][j] += c / 2
        a[j][i] += c / 2
    squares: dict[tuple[fmpq, ...], fmpq] = {}
    while True:
        pivot = next((v for v in range(n) if a[v][v]), None)
        if pivot is None:
            break
        d = a[pivot][pivot]
        linear = tuple(a[pivot][j] / d for j in range(n + 1))
        squares[linear] = d
        for i in range(n + 1):
            for j in range(n + 1):
                a[i][j] -= d * linear[i] * linear[j]
    if any(a[i][j] for i in range(n) for j in range(n + 1)):
        return None  # a product of two different variables, or a linear term
    return squares, a[n][n]
