r"""Periodic orbits on a level of constants of motion, by Krawczyk's operator for several sections at once, in balls.

A frame is a point c and a matrix B whose columns are directions q, the flow, and the gradients of the constants G.
The chart is $\chi(q) = c + B(q, 0, w(q))$, $G(\chi(q))$ = level, $|w_k|$ at most a reach. With $P_i$ the map from
section i to the next, $F_i(q) = q_{i+1} - P_i(q_i)$, cyclically; if $K = m - YF(m) + (1 - Y\,DF(Q))(Q - m)$ lies
inside of the box Q, there is exactly one zero of F in Q.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls.field import BallField, Vector, as_column, ball, lies_inside, magnitude
from liepoisson.proofs.balls.flow import column
from liepoisson.proofs.balls.lohner import How, identity, orthonormal
from liepoisson.proofs.balls.section import Hyperplane, section_map

_NEWTON_STEPS = 6
_NEAR = 1e-9
"""A last step of this size leaves an error of its square."""
_RADII = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14)
"""Half-widths of the boxes that are tried: the larger, the more is said of where the orbit is the only one."""
_IMPROVEMENTS = 4


@dataclass(frozen=True)
class Frame:
    """Coordinates around a point: directions q, the flow, and as many directions w as there are constants of motion.

    Attributes:
        center: c, exact.
        columns: B, exact.
        back: A matrix that contains its inverse.
        n_directions: The number of coordinates q.
    """

    center: Vector
    columns: arb_mat
    back: arb_mat
    n_directions: int

    @classmethod
    def around(cls, field: BallField, center: Vector) -> Frame:
        """Orthonormal directions across the flow and the gradients.

        Raises:
            EnclosureError: the flow and the gradients may depend on each other here.
        """
        n, m = field.n, len(field.constant_names)
        gradients = field.gradients(center).tolist() if m else []
        across = arb_mat(
            [[arb(r.mid()), *(arb(g[i].mid()) for g in gradients)] for i, r in enumerate(field.rates(center))]
        )
        basis = orthonormal(across, [1.0] * (m + 1))
        rows = zip(basis.tolist(), across.tolist(), strict=True)
        columns = arb_mat([[*b[m + 1 :], *a] for b, a in rows])
        try:
            back = columns.inv()
        except ZeroDivisionError as error:
            raise EnclosureError(
                "the flow and the gradients of H and the Casimirs may depend on each other at a state of the orbit, "
                "as they do at an equilibrium or on a singular leaf"
            ) from error
        return cls(center, columns, back, n - m - 1)

    @property
    def section(self) -> Hyperplane:
        """Where the coordinate of the flow is zero."""
        normal = self.back.tolist()[self.n_directions]
        return Hyperplane(normal, sum((a * b for a, b in zip(normal, self.center, strict=True)), arb(0)))

    def states(self, q: Sequence[arb], w: Sequence[arb]) -> Vector:
        """The states c + B (q, 0, w)."""
        moved = column(self.columns * as_column([*q, arb(0), *w]))
        return [c + d for c, d in zip(self.center, moved, strict=True)]

    def part(self, matrix: arb_mat) -> tuple[arb_mat, arb_mat]:
        """The columns of q, and those of w; the second has no columns, as a list has no entries, without constants."""
        rows, d = matrix.tolist(), self.n_directions
        return arb_mat([r[:d] for r in rows]), arb_mat([r[d + 1 :] for r in rows])


@dataclass(frozen=True)
class Lift:
    """A chart over a box of q, proved: w, and its derivative by q."""

    w: Vector
    slope: arb_mat


def lift(field: BallField, frame: Frame, level: Sequence[arb], q: Sequence[arb], reach: float) -> Lift:
    """Prove that for every q of a box there is exactly one w with |w_k| <= reach on the level, and enclose it.

    Raises:
        EnclosureError: it is not sure.
    """
    m = len(level)
    if not m:
        return Lift([], arb_mat(0, len(q)))

    def slopes(q: Sequence[arb], w: Sequence[arb]) -> tuple[arb_mat, arb_mat]:
        return frame.part(field.gradients(frame.states(q, w)) * frame.columns)

    middle_q = [arb(c.mid()) for c in q]
    w = [arb(0, reach)] * m
    for number in range(_IMPROVEMENTS):
        by_q, by_w = slopes(q, w)
        guess = _inverse(by_w.mid())
        middle = [arb(c.mid()) for c in w]
        values = field.constants(frame.states(middle_q, middle))
        off = as_column([v - c for v, c in zip(values, level, strict=True)])
        off = off + by_q * as_column([a - b for a, b in zip(q, middle_q, strict=True)])
        spread = as_column([a - b for a, b in zip(w, middle, strict=True)])
        image = column(as_column(middle) - guess * off + (identity(m) - guess * by_w) * spread)
        if number == 0 and not all(lies_inside(a, b) for a, b in zip(image, w, strict=True)):
            raise EnclosureError("the constants of motion do not fix the states of a section over a box of its chart")
        w = [a.intersection(b) for a, b in zip(image, w, strict=True)]
    by_q, by_w = slopes(q, w)
    try:
        return Lift(w, by_w.solve(by_q) * arb(-1))
    except ZeroDivisionError as error:
        raise EnclosureError("a matrix that may be singular") from error


@dataclass(frozen=True)
class Passage:
    """The map from a chart to the next: the image of the middle, derivatives on the whole box, flight times."""

    offset: Vector
    derivative: arb_mat
    time: arb


@dataclass(frozen=True)
class PeriodicOrbit:
    """What was proved: coordinates and states on each section, times, the derivative around, and where it is alone."""

    states: list[Vector]
    times: list[arb]
    derivative: arb_mat
    unique_radius: float


class Chain:
    """Sections along an orbit that closes."""

    def __init__(
        self,
        field: BallField,
        states: Sequence[Sequence[float]],
        times: Sequence[float],
        *,
        level: Sequence[arb],
        reach: float,
        how: How,
    ) -> None:
        self.field, self.times, self.level, self.reach, self.how = field, list(times), list(level), reach, how
        self.frames = [Frame.around(field, [ball(float(c)) for c in s]) for s in states]

    def prove(self) -> PeriodicOrbit:
        """Find the orbit, and prove that it is there and the only one in its boxes.

        Raises:
            EnclosureError: a passage is not certain, or no box is mapped into itself.
        """
        d = self.frames[0].n_directions
        middle: list[Vector] = [[arb(0)] * d for _ in self.frames]
        step = 1.0
        for _ in range(_NEWTON_STEPS):
            passages = self._passages(_around(middle, 1e-9), middle)
            change = _inverse(self._jacobian(passages).mid()) * as_column(self._defect(passages, middle))
            flat = [arb((m - c).mid()) for m, c in zip(_flat(middle), column(change), strict=True)]
            middle = [flat[k : k + d] for k in range(0, len(flat), d)]
            step = max(float(magnitude(c).mid()) for c in column(change.mid()))
            if step < _NEAR:
                break
        for radius in _RADII:
            boxes = _around(middle, radius)
            try:
                image = self._krawczyk(self._passages(boxes, middle), boxes, middle)
            except EnclosureError:
                continue
            if all(lies_inside(a, b) for a, b in zip(_flat(image), _flat(boxes), strict=True)):
                return self._found(self._narrowed(image, middle), middle, radius)
        raise EnclosureError("Newton's operator does not map a box around the orbit into itself")

    def _narrowed(self, image: list[Vector], middle: Sequence[Vector]) -> list[Vector]:
        """The box after as many steps as halve it; each keeps the zero, which is the only one there."""
        for _ in range(_IMPROVEMENTS):
            hulls = _hulls(image, middle)
            following = self._krawczyk(self._passages(hulls, middle), hulls, middle)
            met = [
                [a.intersection(b) for a, b in zip(x, y, strict=True)] for x, y in zip(image, following, strict=True)
            ]
            is_halved = 2 * sum(float(e.rad()) for e in _flat(met)) < sum(float(e.rad()) for e in _flat(image))
            image = met
            if not is_halved:
                break
        return image

    def _passages(self, boxes: Sequence[Vector], middle: Sequence[Vector]) -> list[Passage]:
        count = len(self.frames)
        return [self._pass(k, (k + 1) % count, boxes[k], middle[k]) for k in range(count)]

    def _pass(self, start: int, end: int, q: Vector, q_0: Vector) -> Passage:
        frame, to, m = self.frames[start], self.frames[end], len(self.level)
        whole = lift(self.field, frame, self.level, q, self.reach)
        small = lift(self.field, frame, self.level, q_0, self.reach)
        middle_w = [arb(c.mid()) for c in small.w]
        center = frame.states(q_0, middle_w)
        by_q, by_w = frame.part(frame.columns)
        ranges = [a - b for a, b in zip([*q, *whole.w], [*q_0, *middle_w], strict=True)]
        rows = zip(by_q.tolist(), by_w.tolist(), strict=True) if m else ((r, []) for r in by_q.tolist())
        found = section_map(
            self.field,
            center,
            arb_mat([[*a, *b] for a, b in rows]),
            ranges,
            section=to.section,
            time=self.times[start],
            how=self.how,
        )
        along = to.back * found.derivative
        reached = column(to.back * as_column([x - c for x, c in zip(found.from_center, to.center, strict=True)]))
        from_q, from_w = frame.part(along * frame.columns)
        if m:
            off = [a - b for a, b in zip(small.w, middle_w, strict=True)]
            reached = [a + b for a, b in zip(reached, column(from_w * as_column(off)), strict=True)]
            spread = column(from_q * as_column([a - b for a, b in zip(q, q_0, strict=True)]))
            far = column(from_w * as_column([a - b for a, b in zip(whole.w, small.w, strict=True)]))
            d = to.n_directions
            w = [a + b + c for a, b, c in zip(reached[d + 1 :], spread[d + 1 :], far[d + 1 :], strict=True)]
            # then the point with these coordinates is the point of the chart: there is only one within its reach
            if not all(lies_inside(c, arb(0, self.reach)) for c in w):
                raise EnclosureError("images that may lie beyond the reach of a chart")
            from_q = from_q + from_w * whole.slope
        d = to.n_directions
        return Passage(reached[:d], arb_mat(from_q.tolist()[:d]), found.time)

    def _jacobian(self, passages: Sequence[Passage]) -> arb_mat:
        count, d = len(passages), self.frames[0].n_directions
        found = arb_mat(count * d, count * d)
        for k, passage in enumerate(passages):
            following = (k + 1) % count
            for i in range(d):
                found[k * d + i, following * d + i] += 1
                for j in range(d):
                    found[k * d + i, k * d + j] -= passage.derivative[i, j]
        return found

    def _defect(self, passages: Sequence[Passage], middle: Sequence[Vector]) -> Vector:
        count = len(passages)
        return [
            q - image
            for k, passage in enumerate(passages)
            for q, image in zip(middle[(k + 1) % count], passage.offset, strict=True)
        ]

    def _krawczyk(self, passages: Sequence[Passage], boxes: Sequence[Vector], middle: Sequence[Vector]) -> list[Vector]:
        jacobian = self._jacobian(passages)
        inverse = _inverse(jacobian.mid())
        flat, d = _flat(middle), len(middle[0])
        extent = as_column([b - m for b, m in zip(_flat(boxes), flat, strict=True)])
        rest = (identity(len(flat)) - inverse * jacobian) * extent
        image = column(as_column(flat) - inverse * as_column(self._defect(passages, middle)) + rest)
        return [image[k : k + d] for k in range(0, len(image), d)]

    def _found(self, image: list[Vector], middle: Sequence[Vector], radius: float) -> PeriodicOrbit:
        """The orbit in its narrow boxes."""
        passages = self._passages(_hulls(image, middle), middle)
        around = identity(len(middle[0]))
        for passage in passages:
            around = passage.derivative * around
        lifts = (lift(self.field, f, self.level, q, self.reach) for f, q in zip(self.frames, image, strict=True))
        states = [f.states(q, one.w) for f, q, one in zip(self.frames, image, lifts, strict=True)]
        return PeriodicOrbit(states, [p.time for p in passages], around, radius)


def _inverse(matrix: arb_mat) -> arb_mat:
    """An exact matrix near the inverse of an exact one.

    Raises:
        EnclosureError: it may be singular.
    """
    try:
        return matrix.inv().mid()
    except ZeroDivisionError as error:
        raise EnclosureError("a matrix that may be singular") from error


def _around(middle: Sequence[Vector], radius: float) -> list[Vector]:
    return [[m + arb(0, radius) for m in one] for one in middle]


def _hulls(boxes: Sequence[Vector], middle: Sequence[Vector]) -> list[Vector]:
    """The boxes with the points from which mean values are taken."""
    return [[b.union(m) for b, m in zip(box, mid, strict=True)] for box, mid in zip(boxes, middle, strict=True)]


def _flat(parts: Sequence[Vector]) -> Vector:
    return [entry for part in parts for entry in part]
