r"""Where the orbits of a set cross a hyperplane, when, and the derivative of the map that takes them there, in balls.

On a box that contains the orbits for all times of a window $[-d, d]$, the rate $g = \nabla s\cdot f$ keeps its sign. By
the mean value theorem an orbit at x crosses $s = 0$ at a time of $-s(x)/g$, and if that lies within the window it does
so exactly once there. With y the crossing, $DP = (1 - f(y)\nabla s^T/g(y))\,D\varphi_\tau$.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls.field import BallField, Vector, as_column, ball, lies_inside, magnitude, norm
from liepoisson.proofs.balls.flow import Tube, column
from liepoisson.proofs.balls.lohner import Carried, How, carry, identity

_TRIALS = 12
_IMPROVEMENTS = 3
_LEAST_WINDOW = 1e-14
_NO_CROSSING = (
    "no certain transversal crossing of the section: not every orbit of the set crosses it once near this time; try a "
    "smaller set, another time, or a section across the flow"
)


@dataclass(frozen=True)
class Hyperplane:
    """The states with normal . x = offset.

    Attributes:
        normal: The gradient of s.
        offset: The value of normal . x on it.
    """

    normal: Vector
    offset: arb

    def value(self, x: Sequence[arb]) -> arb:
        """s(x)."""
        return _dot(self.normal, x) - self.offset


@dataclass(frozen=True)
class Crossing:
    """The crossings of all orbits of a set.

    Attributes:
        time: When they cross, counted from the set.
        window: Times within which each orbit crosses exactly once.
        rate: Rates of change of s along the orbits within the window.
        states: A box that contains the crossings.
        transport: The derivatives of the flow from the set to the crossing, for a fixed time.
    """

    time: arb
    window: arb
    rate: arb
    states: Vector
    transport: arb_mat

    def derivative(self, field: BallField, section: Hyperplane) -> arb_mat:
        """Projections along the field onto the section, times the transport."""
        rates = field.rates(self.states)
        speed = _dot(section.normal, rates)
        n = field.n
        ratios = [_ratio(r, speed) for r in rates]
        projection = arb_mat(n, n, [int(i == j) - ratios[i] * section.normal[j] for i in range(n) for j in range(n)])
        return projection * self.transport


def cross(field: BallField, states: Carried, section: Hyperplane) -> Crossing:
    """Let the orbits of a set cross a section that they are near to.

    Raises:
        EnclosureError: it is not sure that each crosses exactly once within a window of time around the present.
    """
    start = states.hull()
    # the value at the middle and the slopes are exact up to round-off: the section is a plane
    values = states.range(section.value(states.middle), section.normal)
    guess = _ratio(values, _dot(section.normal, field.rates(start)))
    reach = 2 * magnitude(guess) + _LEAST_WINDOW
    window = arb(0, reach.upper())
    tube = _meanwhile(field, start, window)
    rate = _dot(section.normal, field.rates(tube))
    delay = -_ratio(values, rate)
    if not lies_inside(delay, window):
        raise EnclosureError(_NO_CROSSING)
    path = tube
    for _ in range(_IMPROVEMENTS):  # up to their crossings the orbits stay in a smaller box, which says more
        path = _met(path, [s + delay.union(0) * r for s, r in zip(start, field.rates(path), strict=True)])
        delay = _met([delay], [-_ratio(values, _dot(section.normal, field.rates(path)))])[0]
    states_there = _met(path, [s + delay * r for s, r in zip(start, field.rates(path), strict=True)])
    jacobian = field.jacobian(path)
    growth = ((magnitude(delay) * norm(jacobian)).exp() - 1).upper()
    n = field.n
    meanwhile = identity(n) + arb_mat(n, n, [arb(0, growth)] * (n * n))
    transport = identity(n) + jacobian * meanwhile * delay
    return Crossing(delay, window, rate, states_there, transport)


def of_point(field: BallField, states: Carried, crossing: Crossing, how: How) -> Vector:
    """The crossings themselves, from a small set: its box is moved by the series of its solutions."""
    box = states.hull()
    tube = _meanwhile(field, box, crossing.time.union(0))
    coefficients, last = field.series(box, how.order), field.series(tube, how.order + 1)[how.order + 1]
    moved = last
    for k in range(how.order, -1, -1):
        moved = [m * crossing.time + c for m, c in zip(moved, coefficients[k], strict=True)]
    return _met(moved, crossing.states)


@dataclass(frozen=True)
class SectionMap:
    """The map of a set to a section.

    Attributes:
        time: Flight times.
        rate: Rates of change of s where orbits cross.
        states: The crossings.
        from_center: The crossing of the center.
        derivative: By the state, for all states of the set.
        window: The times within which each orbit crosses exactly once.
        tubes: Where the orbits are on the way.
    """

    time: arb
    rate: arb
    states: Vector
    from_center: Vector
    derivative: arb_mat
    window: arb
    tubes: list[Tube]


def section_map(
    field: BallField,
    center: Vector,
    frame: arb_mat,
    ranges: Vector,
    *,
    section: Hyperplane,
    time: float,
    how: How,
) -> SectionMap:
    """Follow center + frame box for about a time, up to a section.

    Raises:
        EnclosureError: no enclosure of the flow, or it is not sure that every orbit crosses once, near that time.
    """
    ranges = [r.union(0) for r in ranges]
    whole, tubes = carry(field, Carried.of(center, frame, ranges), time, how)
    alone, _ = carry(field, Carried.of(center, identity(field.n), []), time, how)
    crossing, first = cross(field, whole, section), cross(field, alone, section)
    if not crossing.window.contains(first.time):
        raise EnclosureError(_NO_CROSSING)
    at_center = of_point(field, alone, first, how)
    derivative = crossing.derivative(field, section) * whole.derivatives()
    moved = column(derivative * frame * as_column(ranges))
    states = _met(crossing.states, [a + b for a, b in zip(at_center, moved, strict=True)])
    t = ball(time)
    return SectionMap(t + crossing.time, crossing.rate, states, at_center, derivative, t + crossing.window, tubes)


def _meanwhile(field: BallField, start: Vector, window: arb) -> Vector:
    """A box that contains the orbits from a box for all times of a window, which contains 0, by Picard's operator.

    Raises:
        EnclosureError: none was found.
    """

    def image(within: Vector) -> Vector:
        return [s + window * r for s, r in zip(start, field.rates(within), strict=True)]

    trial = [_inflated(b) for b in image(start)]
    for _ in range(_TRIALS):
        found = image(trial)
        if all(lies_inside(a, b) for a, b in zip(found, trial, strict=True)):
            return found
        trial = [_inflated(b) for b in found]
    raise EnclosureError(_NO_CROSSING)


def _inflated(b: arb) -> arb:
    wider = (b.rad() * 2 + magnitude(b) * arb(2) ** -40).upper()
    return b + arb(0, wider + arb(2) ** -500)


def _met(first: Sequence[arb], second: Sequence[arb]) -> Vector:
    """What two boxes have in common; both contain the same thing, so that it is not empty."""
    return [a.intersection(b) for a, b in zip(first, second, strict=True)]


def _ratio(a: arb, b: arb) -> arb:
    """A quotient.

    Raises:
        EnclosureError: the divisor may be zero.
    """
    if not b.is_finite() or b.contains(0):
        raise EnclosureError(_NO_CROSSING)
    return a / b


def _dot(a: Sequence[arb], b: Sequence[arb]) -> arb:
    return sum((x * y for x, y in zip(a, b, strict=True)), arb(0))
