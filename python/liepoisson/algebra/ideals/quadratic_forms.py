r"""Real zeros of quadratic polynomials, decided by completing squares.

Over the rationals every polynomial of degree two is $q = \sum_i d_iL_i^2 + M + c$ with independent linear forms $L_i$
(with constants) and M, which is zero or independent of them. If M is not zero, or two of the $d_i$ and c have different
signs, q has real zeros and takes both signs. Otherwise q vanishes where all $L_i$ do, if c = 0, and never, if not.

The same holds for q in powers of the variables, as far as it says that there is no zero: $a^4 + a^2b^2 + b^4$ vanishes
only with $a^2 + b^2/2$ and $b^2$.
"""

from __future__ import annotations

from math import gcd
from typing import Any

from flint import fmpq

from liepoisson.algebra.ideals.buchberger import Poly


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
