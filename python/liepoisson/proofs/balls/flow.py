r"""Rigorous enclosures of the flow of a polynomial field and of its derivative, in balls.

A set of states is kept as $x_0 + M y$ with y in a box: a point and a matrix, both enclosed. Its image is
$\varphi(x_0) + D\varphi\,M y$ by the mean value theorem, with $D\varphi$ over the whole set (a matrix that depends on
y, in the convex set of matrices that the balls contain). One step of length h:

- **A priori.** Let $x^{(k)}$ be Taylor coefficients over the set X, and Y a box. If
  $\sum_{k\le n} x^{(k)}(X)[0,h]^k + [0,h]^{n+1}x^{(n+1)}(Y)$ lies in the interior of Y, all solutions from X exist up
  to h and stay in Y: up to the time at which one left Y, Taylor's formula with its remainder keeps it in the interior.
- **State.** $\varphi_h(x_0) \in \sum_{k\le n} x^{(k)}(x_0)h^k + h^{n+1}x^{(n+1)}(Y)$.
- **Derivative.** $V' = Df(x(t))V$, $V(0) = 1$, has coefficients $V^{(k+1)} = \frac1{k+1}\sum_j A^{(j)}V^{(k-j)}$,
  where $A^{(j)}$ are those of $Df(x(t))$. The remainder is $h^{n+1}V^{(n+1)}$ at a state of Y and a matrix V of norm at
  most $e^{h|Df(Y)|}$; its norm is bounded by the same recursion for norms.

The largest row sum is the norm of a matrix. Sets that are small, and times that are short, lose little; for long times
and large boxes the intervals of the core, which turn their axes along, are the better tool.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls.field import BallField, Vector, as_column, lies_inside, magnitude, norm

ORDER = 20
_MOST_HALVINGS = 3
_LARGEST_REMAINDER = 2.0**-12
"""Half-width of what a box Y has beyond the Taylor polynomial, in units of the largest component of X."""


@dataclass(frozen=True)
class Parallelepiped:
    """The states x_0 + M y with y in a box that contains 0.

    Attributes:
        center: x_0.
        matrix: M, one column for each coordinate y.
        ranges: The box of y.
    """

    center: Vector
    matrix: arb_mat
    ranges: Vector

    def box(self) -> Vector:
        """A box that contains it."""
        moved = column(self.matrix * as_column(self.ranges))
        return [c + m for c, m in zip(self.center, moved, strict=True)]

    def mapped(self, matrix: arb_mat) -> Parallelepiped:
        """Its image under a linear map."""
        return Parallelepiped(column(matrix * as_column(self.center)), matrix * self.matrix, self.ranges)


@dataclass(frozen=True)
class Tube:
    """A box that contains all orbits of a set from one time to another."""

    start: arb
    end: arb
    box: Vector


def flow(
    field: BallField, states: Parallelepiped, time: arb, largest_step: float, order: int = ORDER
) -> tuple[Parallelepiped, list[Tube]]:
    """The image of a set of states under the flow, and boxes that contain the orbits on their way.

    Args:
        field: The equations.
        states: Where the orbits start.
        time: How long they run; positive.
        largest_step: Steps are equal, and not longer than this; one that fails is halved, at most three times.
        order: Order of the Taylor polynomials.

    Raises:
        EnclosureError: the enclosures grow too much: the set is too large, or the time too long.
    """
    if not (time > 0 and largest_step > 0):
        raise EnclosureError(f"a flow: wanted a positive time and step; got {time} and {largest_step}")
    n_steps = max(1, int((time / largest_step).upper().ceil().unique_fmpz() or 1))
    h = time / n_steps
    tubes: list[Tube] = []
    for k in range(n_steps):
        states, found = _advanced(field, states, (h * k, h), order, _MOST_HALVINGS)
        tubes += found
    return states, tubes


def _advanced(
    field: BallField, states: Parallelepiped, span: tuple[arb, arb], order: int, halvings: int
) -> tuple[Parallelepiped, list[Tube]]:
    """One step from a time, or two of half the length where no box is found for one."""
    start, h = span
    try:
        states, box = advance(field, states, h, order)
    except EnclosureError:
        if not halvings:
            raise
        states, first = _advanced(field, states, (start, h / 2), order, halvings - 1)
        states, second = _advanced(field, states, (start + h / 2, h / 2), order, halvings - 1)
        return states, first + second
    return states, [Tube(start, start + h, box)]


def advance(field: BallField, states: Parallelepiped, h: arb, order: int = ORDER) -> tuple[Parallelepiped, Vector]:
    """One step, and a box that contains all orbits on their way.

    Raises:
        EnclosureError: no box was found that provably contains the orbits.
    """
    box = states.box()
    coefficients, matrices = field.series_with_jacobian(box, order)
    whole = arb(0).union(h)
    polynomial = [_horner([c[i] for c in coefficients], whole) for i in range(field.n)]
    size = max((float(magnitude(c).mid()) for c in box), default=0.0)
    slack = arb(0, size * _LARGEST_REMAINDER)
    tube = [p + slack for p in polynomial]
    last, jacobians = field.series_with_jacobian(tube, order + 1)
    power, whole_power = h ** (order + 1), whole ** (order + 1)
    kept = (lies_inside(p + whole_power * c, t) for p, c, t in zip(polynomial, last[order + 1], tube, strict=True))
    if not all(kept):
        raise EnclosureError(
            f"a rigorous step of length {float(h.mid()):.3g}: wanted a box that contains the orbits; found none. The "
            "set is too large for this step; take a smaller set or smaller steps"
        )
    center = [
        _horner([c[i] for c in field_coefficients], h) + power * last[order + 1][i]
        for field_coefficients in [field.series(states.center, order)]
        for i in range(field.n)
    ]
    jacobian = _derivative(matrices, jacobians, h, order)
    return Parallelepiped(center, jacobian * states.matrix, states.ranges), tube


def _derivative(matrices: Sequence[arb_mat], jacobians: Sequence[arb_mat], h: arb, order: int) -> arb_mat:
    """An enclosure of the derivative of a step; the Taylor coefficients of Df over the set, and over the tube."""
    n = matrices[0].nrows()
    identity = arb_mat([[int(i == j) for j in range(n)] for i in range(n)])
    found = [identity]
    for k in range(order):
        total = matrices[k]
        for j in range(k):
            total = total + matrices[j] * found[k - j]
        found.append(total / (k + 1))
    norms = [norm(m) for m in jacobians[: order + 1]]
    bounds = [(h * norms[0]).exp().upper()]
    for k in range(order + 1):
        total = sum((norms[j] * bounds[k - j] for j in range(k + 1)), arb(0))
        bounds.append((total / (k + 1)).upper())
    total = found[order]
    for k in range(order - 1, -1, -1):
        total = total * h + found[k]
    rest = arb(0, (bounds[order + 1] * h ** (order + 1)).upper())
    return total + arb_mat([[rest] * n] * n)


def _horner(coefficients: Sequence[arb], h: arb) -> arb:
    total = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        total = total * h + c
    return total


def column(matrix: arb_mat) -> Vector:
    """A matrix of one column as a vector."""
    return [row[0] for row in matrix.tolist()]
