r"""Charts of sets on a level of the constants of motion, in balls, with proof that they are charts.

A set has a center c and a frame B with columns u (k), flow (1), s (k), gradients (m). Its chart is $\chi(q) = c +
B\,(q_u, 0, q_s, w(q))$, where w is such that the constants of motion F have the values of the level. That w exists,
is unique and smooth is proved by Newton's method in intervals: with $G(q, w) = F(c + B(q_u, 0, q_s, w)) - F_0$ and $Y
\approx (\partial G/\partial w)^{-1}$, if $-YG(q, 0) + (1 - Y\,\partial G/\partial w(q, W))W$ lies in the interior of
W for all q, then for each q there is exactly one zero in W (Krawczyk), and $\partial G/\partial w$ is invertible
there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import arb, arb_mat

from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls.field import BallField, Vector, as_column, lies_inside
from liepoisson.proofs.balls.flow import Parallelepiped, column

LARGEST_W = 1e-3
"""Charts are unique for |w_k| up to this."""
_MOST_STEPS = 10
_WORTH = 0.5
"""A step of Newton's method is followed by another if it has narrowed the box by this factor or more."""


@dataclass(frozen=True)
class BallSet:
    """A set of a chain of covering relations.

    Attributes:
        name: What it is called.
        center: Its center c.
        frame: Its frame B.
        k: Number of unstable directions, and of stable ones.
    """

    name: str
    center: Vector
    frame: arb_mat
    k: int

    @property
    def q_columns(self) -> tuple[int, ...]:
        """The columns u and s."""
        return (*range(self.k), *range(self.k + 1, 2 * self.k + 1))

    @property
    def w_columns(self) -> range:
        """The columns of the gradients."""
        return range(2 * self.k + 1, len(self.center))

    @property
    def unit(self) -> Vector:
        """The box |q_i| <= 1, which contains the set."""
        return [arb(0, 1)] * (2 * self.k)

    @cached_property
    def inverse(self) -> arb_mat:
        """B^-1.

        Raises:
            EnclosureError: it may be singular.
        """
        try:
            return self.frame.inv()
        except ZeroDivisionError as error:
            raise EnclosureError(f"set {self.name}: its frame may be singular") from error

    @cached_property
    def normal(self) -> list[arb]:
        """The covector that is 1 on the flow column and 0 on all others; the section is where it vanishes at x - c."""
        return self.inverse.tolist()[self.k]

    def scaled(self, factor: arb) -> BallSet:
        """The set whose unstable and stable columns are multiplied by a factor."""
        rows = [[e * factor if j in self.q_columns else e for j, e in enumerate(row)] for row in self.frame.tolist()]
        return BallSet(f"{factor.str(2, radius=False)} {self.name}", self.center, arb_mat(rows), self.k)

    def states(self, q: Sequence[arb], w: Sequence[arb]) -> Vector:
        """The point c + B (q_u, 0, q_s, w)."""
        moved = column(self.frame * as_column(self.coordinates(q, w)))
        return [c + d for c, d in zip(self.center, moved, strict=True)]

    def coordinates(self, q: Sequence[arb], w: Sequence[arb]) -> Vector:
        """(q_u, 0, q_s, w)."""
        return [*q[: self.k], arb(0), *q[self.k :], *w]


@dataclass(frozen=True)
class Chart:
    """A chart over a box of q, proved.

    Attributes:
        w: A box that contains w(q) for all q in the box.
        w_center: One that contains w(0).
        slopes: A matrix that contains the derivative of w by q.
    """

    w: Vector
    w_center: Vector
    slopes: arb_mat

    @property
    def middle(self) -> Vector:
        """w_0, the middle of the box of w."""
        return [arb(a.mid()) for a in self.w]


def chart(field: BallField, covering_set: BallSet, level: Sequence[arb], q: Sequence[arb]) -> Chart:
    """Prove that a set has a chart over a box of q.

    Raises:
        EnclosureError: it cannot be proved.
    """
    m = len(level)
    wide = [arb(0, LARGEST_W)] * m
    w = _newton(field, covering_set, level, q, wide)
    if not all(lies_inside(a, b) for a, b in zip(w, wide, strict=True)):
        raise EnclosureError(
            f"set {covering_set.name}: the constants of motion do not fix w with |w| < {LARGEST_W} over the set; it "
            "does not lie on the level, or the gradients are not independent"
        )
    w = _narrowed(lambda box: _newton(field, covering_set, level, q, box), w)
    origin = [arb(0)] * len(q)
    center = _narrowed(lambda box: _newton(field, covering_set, level, origin, box), w)
    gradients = _gradients(field, covering_set, q, w)
    try:
        by_w, by_q = (_columns(gradients, c) for c in (covering_set.w_columns, covering_set.q_columns))
        slopes = by_w.solve(by_q) * arb(-1)
    except ZeroDivisionError as error:
        raise EnclosureError(f"set {covering_set.name}: the derivative by w may be singular") from error
    return Chart(w, center, slopes)


def states_of(covering_set: BallSet, proved: Chart, q: Sequence[arb]) -> Parallelepiped:
    """All states c + B (q_u, 0, q_s, w(q)), with q and w - w_0 as coordinates that vary in boxes of their own."""
    columns = (*covering_set.q_columns, *covering_set.w_columns)
    center = covering_set.states([arb(0)] * len(q), proved.middle)
    w = [a - b for a, b in zip(proved.w, proved.middle, strict=True)]
    return Parallelepiped(center, _columns(covering_set.frame, columns), [*q, *w])


def _narrowed(step: Callable[[Sequence[arb]], Vector], box: Vector) -> Vector:
    """The box after as many steps as narrow it; each keeps the zero."""
    for _ in range(_MOST_STEPS):
        before, box = box, step(box)
        if not sum((w.rad() for w in box), arb(0)) < sum((w.rad() for w in before), arb(0)) * _WORTH:
            break
    return box


def _newton(
    field: BallField, covering_set: BallSet, level: Sequence[arb], q: Sequence[arb], w: Sequence[arb]
) -> Vector:
    """One step of Krawczyk's operator about the middle of a box of w; G is enclosed by the mean value theorem in q."""
    m = len(level)
    middle = [arb(c.mid()) for c in w]
    by_w = _columns(_gradients(field, covering_set, q, w), covering_set.w_columns)
    try:
        Y = arb_mat([[arb(e.mid()) for e in row] for row in by_w.mid().inv().tolist()])
    except ZeroDivisionError as error:
        raise EnclosureError(f"set {covering_set.name}: the gradients may depend on each other") from error
    values = field.constants(covering_set.states([arb(0)] * len(q), middle))
    by_q = _columns(_gradients(field, covering_set, q, middle), covering_set.q_columns)
    off = as_column([v - c for v, c in zip(values, level, strict=True)]) + by_q * as_column(q)
    identity = arb_mat([[int(i == j) for j in range(m)] for i in range(m)])
    spread = as_column([a - b for a, b in zip(w, middle, strict=True)])
    found = as_column(middle) - Y * off + (identity - Y * by_w) * spread
    return column(found)


def _gradients(field: BallField, covering_set: BallSet, q: Sequence[arb], w: Sequence[arb]) -> arb_mat:
    r"""The derivatives of the constants of motion along the columns of the frame, for all q and w in a box.

    $\nabla F(x) B = \nabla F(c) B + \sum_k y_k\, B_k^T F''(X) B$ by the mean value theorem, where y are the
    coordinates of x; multiplied in this order, since the columns of u and s are tangent to the level and $F''$
    between them is small. X contains c, whether the box of q and w contains 0 or not.
    """
    frame, y = covering_set.frame, as_column(covering_set.coordinates(q, w))
    from_center = covering_set.states([e.union(arb(0)) for e in q], [e.union(arb(0)) for e in w])
    curved = [(frame.transpose() * h * frame * y).transpose().entries() for h in field.hessians(from_center)]
    return field.gradients(covering_set.center) * frame + arb_mat(curved)


def _columns(matrix: arb_mat, chosen: Sequence[int]) -> arb_mat:
    return arb_mat([[row[k] for k in chosen] for row in matrix.tolist()])
