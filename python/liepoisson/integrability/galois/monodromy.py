r"""Monodromy matrices of a linear system along loops, enclosed rigorously in balls.

Along a polygon in the complex plane the fundamental matrix is continued by Taylor series: at a centre c

$$ Y(c + h) = \sum_k Y_k h^k, \qquad d(c + h)\,Y'(c + h) = M(c + h)\,Y(c + h), \qquad A = M/d . $$

Let the sum of a row of $|A_{ij}|$ be at most a on a disc of radius $\rho$ around c that contains no singular point.  By
Cauchy's estimate the coefficients of A are at most $a\rho^{-k}$, hence those of Y at most those of
$(1 - h/\rho)^{-a\rho}$, and with $r = |h| < \rho$ the terms from the K-th on add up to at most

$$ \binom{a\rho + K - 1}{K}\Bigl(\frac r\rho\Bigr)^K \Big/ \Bigl(1 - \frac r\rho\,\frac{a\rho + K}{K + 1}\Bigr)
   \quad\text{if } a\rho \ge 1 . $$

All is computed in the balls of Arb, rounding included: the matrices contain the true ones.
"""

from __future__ import annotations

from cmath import exp, phase, pi
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import frexp
from typing import TYPE_CHECKING, Any

from liepoisson.errors import EnclosureError, ParameterError
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import sequence
from liepoisson.inputs.refusals import shown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from liepoisson.integrability.galois.linear_systems import LinearSystem

PRECISION = 64
"""Bits that are wanted: the radii of the balls are at most 2^-64 times the largest entry."""

_MOST_BITS = 4096
"""The recursion for the coefficients and the product of many steps lose bits; all is repeated with twice as many until
enough are left. Half of them are for the remainders of the series."""

_RATIO = 0.4
"""Length of a step in units of the radius of the disc: for steps that are longer the balls of the coefficients grow."""

_DISC = 0.4
"""The radius of the disc in units of the distance to the next singular point: near to it the bound a is large."""

_NEAR = 1e-9
"""A loop that comes so near to a singular point, in units of its longest edge, is refused."""

_LARGEST = 1e150
"""Absolute value of the coordinates of a corner, so that a double holds every distance."""

_SIDES = 8
"""Corners of the polygon around a singular point."""

_DIRECTIONS = 24
"""In which a way out to infinity is looked for."""

_BASES = ((-3, 7), (5, 9), (-7, 5), (11, -9), (2, 13), (-13, -6))
"""Base points that are tried, in tenths: at generic places, so that singular points do not lie behind each other."""

_CLEARANCE = 0.12
"""Singular points keep this distance from the way to another one, in units of the smallest distance of two."""


@dataclass(frozen=True)
class Loop:
    """A closed polygon in the plane of s that avoids the singular points.

    Attributes:
        corners: Its corners, the first one not repeated, as pairs of fractions: real and imaginary part.
        name: What it goes around.
    """

    corners: tuple[tuple[Fraction, Fraction], ...]
    name: str = "loop"


@dataclass(frozen=True, eq=False)
class Monodromy:
    """The monodromy matrix of a loop: a fundamental matrix that is 1 at the first corner is continued to it.

    Attributes:
        system: The system.
        loop: The loop.
        balls: The matrix in balls, which contain the true numbers.
        windings: How often the loop goes around each finite singular point, with the points as balls.
    """

    system: LinearSystem
    loop: Loop
    balls: Any
    windings: tuple[tuple[Any, int], ...]

    @cached_property
    def matrix(self) -> NDArray[np.complex128]:
        """The midpoints, shape (n, n)."""
        import numpy as np

        return np.array([[complex(entry) for entry in row] for row in self.balls.tolist()])

    @property
    def error(self) -> float:
        """A bound of the error of every entry of `matrix`, but for the rounding to doubles."""
        return max(float(entry.rad()) for row in self.balls.tolist() for entry in row)

    def power(self, k: int) -> Any:
        """The k-th power of the balls, k at least 0."""
        from flint import acb_mat

        found = acb_mat([[int(i == j) for j in range(self.system.n)] for i in range(self.system.n)])
        for _ in range(k):
            found = found * self.balls
        return found

    def __repr__(self) -> str:
        around = ", ".join(f"{complex(z):.3g}: {w}" for z, w in self.windings if w)
        return f"<Monodromy of {self.loop.name}, winding numbers {{{around}}}, error {self.error:.1e}>"


@explains_its_arguments
def monodromy(system: LinearSystem, corners: Sequence[Any] | Loop, *, precision: int = PRECISION) -> Monodromy:
    r"""The monodromy matrix of a linear system along a closed polygon, enclosed rigorously.

    Example:
        >>> import sympy
        >>> s = sympy.Symbol("s")
        >>> root = lp.integrability.linear_system(sympy.Matrix([[1 / (2 * s)]]), s)
        >>> around = lp.integrability.monodromy(root, [1, 1j, -1, -1j])
        >>> around.matrix.round(9).real.tolist(), around.error < 1e-30
        ([[-1.0]], True)

    Args:
        system: A system, as `linear_system` or `variational_equations` make it.
        corners: The corners of the polygon, complex numbers; the last is joined to the first.
        precision: Bits that are wanted; all balls are true enclosures, whatever it is.

    Raises:
        ParameterError: the loop goes through a singular point, or has fewer than three corners.
        EnclosureError: the precision does not suffice.
    """
    loop = corners if isinstance(corners, Loop) else Loop(_corners(corners))
    return continued(system, loop, precision=as_count(precision, "precision", least=30, most=10_000))


def generators(system: LinearSystem) -> tuple[tuple[Any, Loop], ...]:
    """Loops with one base point, one around each finite singular point: they generate the monodromy group.

    They are in the order of their angles at the base point, so that one after the other they go once around all.

    Returns:
        For each the irreducible polynomial of the singular point, and the loop.

    Raises:
        EnclosureError: no base point was found from which the ways are clear.
    """
    roots = [(f, complex(root)) for f in system.singular_points for root, _ in f.numer().complex_roots()]
    places = [z for _, z in roots]
    apart = min((abs(v - w) for k, v in enumerate(places) for w in places[:k]), default=1.0)
    scale = max(map(abs, places), default=1.0) or 1.0
    for base in _BASES:
        start = scale * complex(*base) / 10
        others = {z: [w for w in places if w is not z] for z in places}
        clear = all(_distance(start, z, w) > _CLEARANCE * apart for z in places for w in others[z])
        if clear and all(abs(start - z) > _CLEARANCE * apart for z in places):
            ordered = sorted(roots, key=lambda root: phase(root[1] - start))
            near = {z: min([abs(start - z), *(abs(z - w) for w in others[z])]) for z in places}
            # Rounded once: matrices of loops from two base points, however near, cannot be compared.
            corner = _rounded([start], min(near.values(), default=1.0))[0]
            return tuple((f, _lasso(corner, z, near[z], f, system)) for f, z in ordered)
    raise EnclosureError(
        "generators of the monodromy group: found no base point from which every singular point is "
        "seen at a distance from the others; give a polygon to `monodromy`"
    )


def loop_around_all(system: LinearSystem, like: Loop) -> Loop:
    """A loop around all finite singular points, that is around infinity, with the base point of another loop."""
    places = [complex(root) for f in system.singular_points for root, _ in f.numer().complex_roots()]
    start = complex(*map(float, like.corners[0]))
    radius = 2 * max([abs(start), *map(abs, places)]) or 1.0
    angles = [2 * pi * k / _DIRECTIONS for k in range(_DIRECTIONS)]
    # the way out with the largest distance from the singular points
    best = max(angles, key=lambda a: min((_distance(start, radius * exp(1j * a), z) for z in places), default=1.0))
    around = [radius * exp(1j * (best + 2 * pi * k / (2 * _SIDES))) for k in range(2 * _SIDES)]
    return Loop((like.corners[0], *_rounded([*around, around[0]], radius)), "infinity")


def continued(system: LinearSystem, loop: Loop, *, precision: int = PRECISION) -> Monodromy:
    """The monodromy along a loop.

    Args:
        system: The system.
        loop: The loop.
        precision: Bits that are wanted.

    Raises:
        ParameterError: the loop goes through a singular point.
        EnclosureError: the precision does not suffice.
        TimeLimitError: the deadline of the call has passed.
    """
    from flint import ctx

    from liepoisson.algebra.flint_pickles import register

    register()  # a result keeps its balls

    before, bits = ctx.prec, 4 * precision
    try:
        while True:
            ctx.prec = bits
            found = _around(system, loop, bits // 2)
            if found is not None and found.error < 2.0**-precision * max(1.0, abs(found.matrix).max()):
                return found
            bits *= 2
            if bits > _MOST_BITS:
                raise EnclosureError(
                    f"the monodromy of {loop.name}: {_MOST_BITS} bits do not suffice; take a loop "
                    "farther from the singular points"
                )
    finally:
        ctx.prec = before


def _around(system: LinearSystem, loop: Loop, precision: int) -> Monodromy | None:
    """The monodromy with the bits that are set; None where they do not suffice."""
    from flint import acb, acb_mat, arb, fmpq

    _, denominator = system.polynomials
    factors = [(power, [root for root, _ in f.numer().complex_roots()]) for f, power in denominator.factor()[1]]
    poles = [root for _, roots in factors for root in roots]
    corners = [
        acb(arb(fmpq(x.numerator, x.denominator)), arb(fmpq(y.numerator, y.denominator))) for x, y in loop.corners
    ]
    total = acb_mat([[int(i == j) for j in range(system.n)] for i in range(system.n)])
    turns = [arb(0) for _ in poles]
    longest = max(float((corners[k] - c).abs_upper()) for k, c in enumerate(corners[1:]))
    for k, start in enumerate(corners):
        end = corners[(k + 1) % len(corners)]
        here, last = start, False
        while not last:
            checkpoint("a monodromy matrix")
            left = end - here
            distance = min((float((here - z).abs_lower()) for z in poles), default=1.0 + float(left.abs_upper()))
            if not distance > _NEAR * longest:
                near = min((complex(z.mid()) for z in poles), key=lambda z: abs(z - complex(here.mid())))
                raise ParameterError(
                    f"loop: the polygon goes through or very near to the singular point {near:.6g}, between its "
                    f"corners {k + 1} and {(k + 1) % len(corners) + 1}; move the corners away"
                )
            radius, length = _DISC * distance, float(left.abs_upper())
            last = length <= _RATIO * radius
            target = end if last else here + left * arb(_RATIO * radius / length)
            target = target if last else acb(target.real.mid(), target.imag.mid())
            total = _step(system, factors, here, target - here, radius=radius, precision=precision) * total
            if not all(entry.is_finite() for entry in total.entries()):
                return None
            # a step is shorter than the distance to each pole, so the principal value is the angle
            turns = [t + ((target - z) / (here - z)).log().imag for t, z in zip(turns, poles, strict=True)]
            here = target
    windings: list[Any] = [(t / (2 * arb.pi())).unique_fmpz() for t in turns]
    if any(w is None for w in windings):
        return None
    return Monodromy(system, loop, total, tuple((z, int(w)) for z, w in zip(poles, windings, strict=True)))


def _step(system: LinearSystem, factors: Any, here: Any, h: Any, *, radius: float, precision: int) -> Any:
    """The matrix that continues a solution from `here` to `here` + h."""
    from flint import acb, acb_mat, acb_poly, arb

    numerators, denominator = system.polynomials
    n = system.n
    moved = acb_poly([here, h])  # all in units of h: the step is from 0 to 1
    rho = arb(radius)
    ratio = h.abs_upper() / rho
    matrices = [
        [acb_poly(list(map(acb, f.coeffs())))(moved) * h if f else acb_poly([0]) for f in row] for row in numerators
    ]
    d = acb_poly(list(map(acb, denominator.coeffs())))(moved)
    d0 = d[0]
    top = max(0, *(f.degree() for row in matrices for f in row))  # that of the polynomial 0 is -1
    layers = [acb_mat([[f[k] for f in row] for row in matrices]) * (1 / d0) for k in range(top + 1)]
    lower = [d[k] / d0 for k in range(1, d.degree() + 1)]
    bound = _largest(numerators, factors, here, rho) * rho
    if not bound > 1:
        bound = arb(1)
    terms = [acb_mat([[int(i == j) for j in range(n)] for i in range(n)])]
    total = terms[0]
    # binom(b + k - 1, k) ratio^k, the bound of the k-th term
    size = arb(1)
    goal = arb(2) ** (-precision)
    k = 0
    while True:
        new = layers[0] * terms[k]
        for j in range(1, min(k, top) + 1):
            new = new + layers[j] * terms[k - j]
        for j in range(1, min(k, len(lower)) + 1):
            new = new - terms[k + 1 - j] * (lower[j - 1] * (k + 1 - j))
        new = new * (acb(1) / (k + 1))
        size = (size * ratio * (bound + k) / (k + 1)).upper()
        k += 1
        terms.append(new)
        total = total + new
        following = (size * ratio * (bound + k) / (k + 1)).upper()
        slope = (ratio * (bound + k + 1) / (k + 2)).upper()
        if slope < 0.99 and following / (1 - slope) < goal:
            rest = (following / (1 - slope)).upper()
            error = acb(arb(0, rest), arb(0, rest))
            return total + acb_mat([[error] * n] * n)
        if k > 40 * precision:
            raise EnclosureError(
                "the monodromy: a power series converges too slowly; take a loop farther from the singular points"
            )


def _largest(numerators: Any, factors: Any, here: Any, rho: Any) -> Any:
    """A bound of the row sums of |A| on the disc of radius rho; the denominator has the leading coefficient 1."""
    from flint import acb, acb_poly, arb

    below = arb(1)
    for power, roots in factors:
        for root in roots:
            away = (here - root).abs_lower() - rho
            if not away > 0:
                raise EnclosureError(
                    "the monodromy: a disc around a point of the loop contains a singular point; take "
                    "more bits of precision"
                )
            below *= away**power
    moved = acb_poly([here, 1])
    largest = arb(0)
    for row in numerators:
        total = arb(0)
        for f in row:
            if f:
                series = acb_poly(list(map(acb, f.coeffs())))(moved)
                total += sum((abs(series[k]).upper() * rho**k for k in range(series.degree() + 1)), arb(0))
        largest = largest if largest > total else total.upper()
    return (largest / below).upper()


def _corners(given: Sequence[Any]) -> tuple[tuple[Fraction, Fraction], ...]:
    found: list[tuple[Fraction, Fraction]] = []
    corners = sequence(given, "corners", "complex numbers", "[1, 1j, -1, -1j]")
    try:
        for one in corners:
            z = complex(one)
            found.append((Fraction(z.real), Fraction(z.imag)))
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(
            f"corners: wanted finite complex numbers such as [1, 1j, -1, -1j]; got {shown(given)}"
        ) from None
    if len(found) < 3:
        raise ParameterError(f"corners: wanted at least 3, the last is joined to the first; got {len(found)}")
    if any(max(abs(x), abs(y)) > _LARGEST for x, y in found):
        raise ParameterError(f"corners: wanted numbers up to {_LARGEST:g}; got {shown(given)}; take another unit")
    if len(set(found)) < 2:
        raise ParameterError(f"corners: wanted a polygon; got one point, {shown(corners[0])}; give [1, 1j, -1, -1j]")
    return tuple(found)


def _distance(start: complex, end: complex, point: complex) -> float:
    """The distance of a point from a segment."""
    way = end - start
    along = ((point - start) * way.conjugate()).real / abs(way) ** 2 if way else 0.0
    return abs(start + min(max(along, 0.0), 1.0) * way - point)


def _lasso(base: tuple[Fraction, Fraction], z: complex, near: float, point: Any, system: LinearSystem) -> Loop:
    """From the base point towards z, around it counterclockwise, and back."""
    from liepoisson.integrability.galois.linear_systems import root_text

    radius = near / 2
    angle = phase(complex(*map(float, base)) - z)
    around = [z + radius * exp(1j * (angle + 2 * pi * k / _SIDES)) for k in range(_SIDES)]
    name = root_text(point, system.variable)
    if point.degree() > 1:
        name = f"{system.variable} = {z:.3g}"
    return Loop((base, *_rounded([*around, around[0]], radius)), name)


def _rounded(way: Sequence[complex], unit: float) -> tuple[tuple[Fraction, Fraction], ...]:
    """Corners as fractions, to about a millionth of a unit."""
    grid = Fraction(2) ** (frexp(unit)[1] - 20)
    return tuple((round(Fraction(c.real) / grid) * grid, round(Fraction(c.imag) / grid) * grid) for c in way)
