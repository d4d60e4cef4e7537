r"""Real solutions of polynomial equations with rational coefficients, proved: no root is missed and none is invented.

Roots of one polynomial are isolated by FLINT in ball arithmetic, where a real root is known to be real. Two polynomials
$f(s,t)$ and $g(s,t)$ are first reduced to one by their resultant, whose roots contain the first coordinates of all
common zeros. The second coordinates are enclosed by bisection, and an enclosure is kept or thrown away by ball
arithmetic. That a box contains exactly one solution is Krawczyk's theorem: if
$m - Y F(m) + (1 - Y F'(X))(X - m)$ lies in the interior of the box X with midpoint m, for any matrix Y, then F has
exactly one zero in X, and it is nondegenerate.

References: [johansson2017], for the ball arithmetic; [moore2009], chapter 8.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from typing import Any, cast

from flint import acb, arb, arb_mat, ctx, fmpq, fmpq_poly, fmpz_poly

from liepoisson.algebra.number_fields import as_fmpq

PRECISIONS = (128, 256, 512, 1024, 2048)
"""Bits of the ball arithmetic, tried in this order.

The last is for leaves of collinear fields by rounded values of the Casimirs, where an equilibrium is almost at rest.
"""

_MOST_CELLS = 4000
"""Cells of one bisection with up to 512 bits, more with more; a polynomial of degree four needs a few hundred with 128.
(Midpoints and radii are exact.)"""


class UndecidedError(Exception):
    """At this precision the balls do not tell two cases apart."""


@contextmanager
def precision(bits: int) -> Generator[None]:
    """Ball arithmetic with this many bits inside."""
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def rational(value: Fraction | float) -> fmpq:
    """The number as a rational one; a double is one."""
    return as_fmpq(Fraction(value))


def ball(value: fmpq | int) -> arb:
    """A rational number as a ball of the present precision."""
    number = fmpq(value)
    return arb(number.p) / arb(number.q)


def evaluate(polynomial: fmpq_poly, x: Any) -> Any:
    """The polynomial at a ball, real or complex."""
    total = x * 0
    for coefficient in reversed(polynomial.coeffs()):
        total = total * x + ball(coefficient)
    return total


def real_roots(polynomial: fmpq_poly | fmpz_poly) -> list[arb]:
    """The distinct real roots of a polynomial, each in a ball of its own.

    Raises:
        UndecidedError: the polynomial is zero, and every number is a root.
    """
    whole = polynomial.numer() if isinstance(polynomial, fmpq_poly) else polynomial
    if not whole:
        raise UndecidedError
    if whole.degree() < 1:
        return []
    # a root of several equal ones is the root of one squarefree factor, and of no other
    return [
        root.real
        for factor, _ in whole.factor_squarefree()[1]
        for root, _ in cast("list[tuple[acb, int]]", factor.complex_roots())
        if root.imag.is_zero()
    ]


def without(polynomial: fmpq_poly, factor: fmpq_poly) -> fmpq_poly:
    """The polynomial without the roots that it shares with the factor, and squarefree where it did."""
    common = polynomial.gcd(factor)
    while common.degree() > 0:
        polynomial = polynomial // common
        common = polynomial.gcd(factor)
    return polynomial


def positive_roots_of(polynomial: fmpq_poly, condition: fmpq_poly) -> list[arb]:
    """The real roots at which the condition is positive; where it vanishes is decided exactly.

    Raises:
        UndecidedError: at this precision its sign is not known at a root.
    """
    return [root for root in real_roots(without(polynomial, condition)) if is_positive(evaluate(condition, root))]


def is_positive(value: arb) -> bool:
    """Whether a ball is positive.

    Raises:
        UndecidedError: it contains zero.
    """
    if value.contains(0):
        raise UndecidedError
    return bool(value > 0)


def resultant(f: Any, g: Any) -> fmpz_poly:
    r"""The resultant of two polynomials in $(s, t)$ with respect to t, up to a factor.

    Args:
        f: A polynomial in two variables over the rationals (`fmpq_mpoly`).
        g: Another one.
    """
    found = f.resultant(g, f.context().names()[1])
    return in_powers(found)[0].numer() if found else fmpz_poly()


def in_powers(f: Any) -> list[fmpq_poly]:
    """The coefficients of the powers of t in a polynomial in (s, t) that is not zero, as polynomials in s."""
    powers: dict[int, dict[int, fmpq]] = {}
    for (i, j), c in f.terms():
        powers.setdefault(int(j), {})[int(i)] = c
    found: list[fmpq_poly] = []
    for j in range(max(powers) + 1):
        entries = powers.get(j, {})
        found.append(fmpq_poly([entries.get(i, fmpq(0)) for i in range(max(entries, default=-1) + 1)]))
    return found


def enclosures(coefficients: Sequence[arb]) -> list[arb]:
    r"""Balls that together contain all real zeros of the polynomial $\sum_j c_j t^j$ with balls as coefficients.

    Bisection of $|t|\le 1$ and of $|1/t|\le 1$ down to a third of the bits; neighbouring cells are joined. A ball may
    contain several zeros or none.

    Raises:
        UndecidedError: zeros may be at infinity, or too many cells are left.
    """
    near, far = _cells(coefficients), _cells(coefficients[::-1])
    if any(cell.contains(0) for cell in far):
        raise UndecidedError
    return _joined(near) + [1 / cell for cell in _joined(far)]


def _cells(coefficients: Sequence[arb]) -> list[arb]:
    """The small cells of [-1, 1] that may contain a zero."""
    width, coarse = arb(2) ** -(ctx.prec // 3), arb(2) ** -(ctx.prec // 8)
    left, small = [(arb(0), arb(1))], list[arb]()
    visited = 0
    while left:
        middle, radius = left.pop()
        visited += 1
        if visited > _MOST_CELLS * max(1, ctx.prec // 512):
            raise UndecidedError
        first, *others = _shifted(coefficients, middle)
        if abs(first) > sum((abs(c) * radius ** (k + 1) for k, c in enumerate(others)), arb(0)):
            continue
        # around a multiple zero the signs are lost in a wide interval, which is not worth cutting up
        if radius < width or (radius < coarse and first.contains(0)):
            small.append(arb(middle, radius))
            continue
        half = radius / 2
        left += [(middle - half, half), (middle + half, half)]
    return small


def _shifted(coefficients: Sequence[arb], middle: arb) -> list[arb]:
    """The coefficients in powers of the distance from a point."""
    c = list(coefficients)
    for i in range(len(c)):
        for j in range(len(c) - 2, i - 1, -1):
            c[j] += middle * c[j + 1]
    return c


def _joined(cells: list[arb]) -> list[arb]:
    """Overlapping cells as one."""
    found: list[arb] = []
    for cell in sorted(cells, key=lambda c: float(c.mid())):
        if found and found[-1].overlaps(cell):
            found[-1] = found[-1].union(cell)
        else:
            found.append(cell)
    return found


System3 = Callable[[Sequence[arb]], tuple[list[arb], list[list[arb]]]]
"""Values and Jacobian of a square system at a box."""


def unique_zero(system: System3, box: Sequence[arb]) -> list[arb] | None:
    """A much smaller box with the only zero in a neighbourhood of the box, or None if the box has no zero.

    Raises:
        UndecidedError: neither is proved at this precision.
    """
    if any(not value.contains(0) for value in system(box)[0]):
        return None
    # One relative radius for all: what is unknown in one coordinate moves the others, to second order. A coordinate may
    # be 1e-18 or 1e52, and is its own measure unless it may be zero.
    sizes = [1 + abs(arb(x.mid())) if x.contains(0) else abs(arb(x.mid())) for x in box]
    share = max((x.rad() / size for x, size in zip(box, sizes, strict=True)), key=float) + arb(2) ** -(
        3 * ctx.prec // 4
    )
    wide = [arb(x.mid(), (8 * share * size).upper()) for x, size in zip(box, sizes, strict=True)]
    inner = _krawczyk(system, wide)
    if not all(x.contains_interior(k) for x, k in zip(wide, inner, strict=True)):
        raise UndecidedError
    return _krawczyk(system, inner)


def _krawczyk(system: System3, box: Sequence[arb]) -> list[arb]:
    middle = [arb(x.mid()) for x in box]
    values, slopes = system(middle)[0], arb_mat(system(box)[1])
    try:
        inverse = arb_mat(system(middle)[1]).inv()
    except ZeroDivisionError as error:
        raise UndecidedError from error
    n = len(box)
    y = arb_mat([[arb(inverse[i, j].mid()) for j in range(n)] for i in range(n)])
    rest = arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)]) - y * slopes
    move = y * arb_mat(n, 1, values)
    spread = rest * arb_mat(n, 1, [x - m for x, m in zip(box, middle, strict=True)])
    return [middle[i] - move[i, 0] + spread[i, 0] for i in range(n)]
