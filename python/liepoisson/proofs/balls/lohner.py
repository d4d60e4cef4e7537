r"""Sets of states and of derivatives that are carried along the flow in balls, without being wrapped into boxes.

A set of states is $m + C r_0 + Q r$: a point, the box of the start in a frame that the flow moves, and what was added
on the way, in an orthonormal frame. A step with $\varphi(m)$ in y and $D\varphi$ in A makes of it
$m' = \mathrm{mid}\,y$, $C' = \mathrm{mid}(AC)$,
$r' = (Q'^{-1}AQ)r + Q'^{-1}((AC - C')r_0 + y - m')$, where Q' is the orthogonal factor of
$\mathrm{mid}(AQ)$, its columns sorted by the width that they carry; the derivative likewise [lohner1987],
[zgliczynski2002].
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite

from flint import arb, arb_mat

from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls.field import BallField, Vector, as_column, ball, magnitude, norm
from liepoisson.proofs.balls.flow import Parallelepiped, Tube, advance, column

_TRIALS = 30
_SHORTER, _LONGER = 0.5, 1.2
_GUARD = 48
"""Bits that the remainders may cost."""


@dataclass(frozen=True)
class How:
    """How the flow is enclosed; none of it decides whether a result is right.

    Attributes:
        order: Of the Taylor polynomials.
        step: The longest step.
        precision: Bits of the arithmetic.
        deadline: When to give up, on the clock of `time.monotonic`.
        heed: Called with the fraction that is done; whatever it raises ends the run.
    """

    order: int
    step: float
    precision: int
    deadline: float = inf
    heed: Callable[[float], object] | None = None


@dataclass(frozen=True)
class Carried:
    """A set of states with the derivatives of the flow along all of them.

    Attributes:
        middle: m, exact.
        frame: C, exact.
        start: The box r_0.
        turned: Q, exact.
        rest: The box r.
        derivative: The middle of the derivatives.
        derivative_turned: The frame of what is added to it.
        derivative_rest: What is added, in that frame.
    """

    middle: Vector
    frame: arb_mat
    start: Vector
    turned: arb_mat
    rest: Vector
    derivative: arb_mat
    derivative_turned: arb_mat
    derivative_rest: arb_mat

    @classmethod
    def of(cls, center: Sequence[arb], frame: arb_mat, ranges: Sequence[arb]) -> Carried:
        """The states center + frame times a box; the derivatives are by all components of the state."""
        n = len(center)
        middle = [arb(c.mid()) for c in center]
        rounded = [c - m for c, m in zip(center, middle, strict=True)]
        exact = frame.mid()
        added = column((frame - exact) * as_column(ranges)) if ranges else [arb(0)] * n
        rest = [a + b for a, b in zip(rounded, added, strict=True)]
        unit = identity(n)
        return cls(middle, exact, list(ranges), unit, rest, unit, unit, arb_mat(n, n))

    def box(self) -> Vector:
        """A box that contains the states."""
        moved = column(self.turned * as_column(self.rest))
        if self.start:
            moved = [a + b for a, b in zip(moved, column(self.frame * as_column(self.start)), strict=True)]
        return [m + d for m, d in zip(self.middle, moved, strict=True)]

    def hull(self) -> Vector:
        """A box that contains the states and the point that they are described from."""
        return [b.union(m) for b, m in zip(self.box(), self.middle, strict=True)]

    def derivatives(self) -> arb_mat:
        """A matrix that contains the derivatives."""
        return self.derivative + self.derivative_turned * self.derivative_rest

    def range(self, at_middle: arb, gradient: Sequence[arb]) -> arb:
        """The values of a function on the set, from that at the middle and the gradient on the hull."""
        row = arb_mat(1, len(gradient), list(gradient))
        total = at_middle + (row * self.turned * as_column(self.rest))[0, 0]
        return total + (row * self.frame * as_column(self.start))[0, 0] if self.start else total

    def moved(self, image: Sequence[arb], by: arb_mat) -> Carried:
        """After a map that takes the middle into a box and has its derivatives in a matrix."""
        middle = [arb(y.mid()) for y in image]
        added = [y - m for y, m in zip(image, middle, strict=True)]
        frame = self.frame
        if self.start:
            whole = by * self.frame
            frame = whole.mid()
            extra = column((whole - frame) * as_column(self.start))
            added = [a + e for a, e in zip(added, extra, strict=True)]
        turned, back, mixed = _turned(by, self.turned, [float(r.rad()) for r in self.rest])
        rest = column(mixed * as_column(self.rest) + back * as_column(added))
        whole = by * self.derivative
        derivative = whole.mid()
        widths = [max(float(e.rad()) for e in row) for row in self.derivative_rest.tolist()]
        other, other_back, other_mixed = _turned(by, self.derivative_turned, widths)
        derivative_rest = other_mixed * self.derivative_rest + other_back * (whole - derivative)
        return Carried(middle, frame, self.start, turned, rest, derivative, other, derivative_rest)


def identity(n: int) -> arb_mat:
    """The unit matrix."""
    return arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])


def _turned(by: arb_mat, frame: arb_mat, widths: Sequence[float]) -> tuple[arb_mat, arb_mat, arb_mat]:
    """The next frame Q', its inverse, and Q'^-1 A Q."""
    moved = by * frame
    turned = orthonormal(moved.mid(), widths)
    try:
        back = turned.inv()
    except ZeroDivisionError as error:
        raise EnclosureError("an orthonormal frame may be singular; try a smaller set or a higher precision") from error
    return turned, back, back * moved


def orthonormal(matrix: arb_mat, weights: Sequence[float]) -> arb_mat:
    """A nearly orthonormal frame that begins with the columns that are longest, weighted."""
    n = matrix.nrows()
    given = [column(arb_mat([[row[j]] for row in matrix.tolist()])) for j in range(matrix.ncols())]
    order = sorted(range(len(given)), key=lambda j: -weights[j] * _length(given[j]))
    units = [[arb(int(i == j)) for i in range(n)] for j in range(n)]
    frame: list[Vector] = []
    for vector in [*(given[j] for j in order), *units]:
        before, rest = _length(vector), vector
        for _ in range(2):
            for other in frame:
                product = sum((a * b for a, b in zip(other, rest, strict=True)), arb(0)).mid()
                rest = [arb((a - product * b).mid()) for a, b in zip(rest, other, strict=True)]
        after = _length(rest)
        if len(frame) < n and isfinite(after) and after > 1e-8 * before:
            size = sum((e * e for e in rest), arb(0)).sqrt().mid()
            frame.append([arb((e / size).mid()) for e in rest])
    return arb_mat([[frame[j][i] for j in range(n)] for i in range(n)])


def _length(vector: Sequence[arb]) -> float:
    return float(sum((e * e for e in vector), arb(0)).sqrt().mid())


def carry(field: BallField, states: Carried, time: float, how: How) -> tuple[Carried, list[Tube]]:
    """The states after a time, and boxes that contain the orbits on their way.

    Args:
        field: The equations.
        states: Where the orbits start.
        time: How long they run, exactly this double; not negative.
        how: Steps and order.

    Raises:
        EnclosureError: a step has no enclosure, or the deadline has passed.
    """
    tubes: list[Tube] = []
    elapsed, end = Fraction(0), Fraction(time)
    wanted = min(how.step, time)
    while elapsed < end:
        if clock.monotonic() > how.deadline:
            raise EnclosureError(
                f"stopped at time {float(elapsed):.6g}: the time limit has passed; give a larger time_limit, or use "
                'arithmetic="intervals"'
            )
        if how.heed is not None:
            how.heed(float(elapsed / end))
        wanted = min(how.step, _LONGER * wanted, _suited(field, states, how))
        for _ in range(_TRIALS):
            h = min(end - elapsed, Fraction(wanted))
            try:
                moved, tube = _step(field, states, ball(h), how.order)
                break
            except EnclosureError:
                wanted = _SHORTER * float(h)
        else:
            raise EnclosureError(
                f"no enclosure of a step from time {float(elapsed):.6g}: the set is too wide by then; try a smaller "
                "set, a shorter time, or a higher precision"
            )
        states = moved
        tubes.append(Tube(ball(elapsed), ball(elapsed + h), tube))
        elapsed += h
    return states, tubes


def _suited(field: BallField, states: Carried, how: How) -> float:
    """A step for which the remainders, from the series of the middle, are of the size of the last digits.

    Those of derivatives are bounded by norms, as `advance` does it: the same recursion, here in doubles, tells how
    large they will be.
    """
    p = how.order
    coefficients, matrices = field.series_with_jacobian(states.middle, p)
    size = max((float(magnitude(c).mid()) for c in states.middle), default=0.0) or 1.0
    norms = [float(norm(m).mid()) for m in matrices]
    bounds = [1.0]
    for k in range(p):
        bounds.append(sum(norms[j] * bounds[k - j] for j in range(k + 1)) / (k + 1))
    terms = [(p, bounds[p]), (p - 1, bounds[p - 1])]
    terms += [(k, max(float(magnitude(c).mid()) for c in coefficients[k]) / size) for k in (p - 1, p)]
    digits = how.precision - _GUARD
    return min((2.0 ** (-digits / k) * term ** (-1 / k) for k, term in terms if 0 < term < inf), default=how.step)


def _step(field: BallField, states: Carried, h: arb, order: int) -> tuple[Carried, Vector]:
    """One step.

    Raises:
        EnclosureError: no box was found that contains the orbits, or the bounds are not finite.
    """
    hull = states.hull()
    unit = identity(field.n)
    around = Parallelepiped(states.middle, unit, [b - m for b, m in zip(hull, states.middle, strict=True)])
    image, tube = advance(field, around, h, order)
    moved = states.moved(image.center, image.matrix)
    if not all(b.is_finite() for b in (*moved.box(), *moved.derivatives().entries())):
        raise EnclosureError("a step has bounds that are not finite")
    return moved, tube


def point(values: Sequence[float]) -> Vector:
    """Doubles as balls of radius zero."""
    return [ball(float(v)) for v in values]
