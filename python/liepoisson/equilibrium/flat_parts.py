r"""Intervals along a soft direction where doubles see no slope of H, with all the zeros of the slope in them.

The slope of $(q-1)^3(q-1.001)^3$ is below 1e-11 from q = 0.99 to 1.01, and Newton's method in doubles comes to rest
anywhere there. With 300 digits this is an interval like any other: the slope g has zeros $z_i$ of orders $m_i$ in it,
and $h = g/\prod(s - z_i)^{m_i}$ has none if all were found. That h has no zero is seen from the polynomial that
interpolates it at Chebyshev's points, by bisection: on a cell with the centre c and the half-width r there is none if
$|h(c)| > \sum_{k\ge1}|h_k|r^k$ with the coefficients of Taylor at c. Where a cell cannot be excluded, Newton's method
for the displacement $1/(g'/g - \sum m_i/(s - z_i))$, which is not zero at the zeros that were found, leads to the next.

The error of the interpolation is estimated from the last coefficients, so this is no proof.

References: [schroeder1870], for Newton's method.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from flint import arb, arb_poly

from liepoisson.algebra.ideals.certified_roots import precision
from liepoisson.equilibrium.soft_zeros import (
    BITS,
    WHOLE,
    ReducedSlope,
    Slope,
    SoftZero,
    fold_to_round_off,
    is_one_over_whole,
    newton_step,
    reduced_slope,
)
from liepoisson.inputs.arrays import Array
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.equilibrium.critical_points import HamiltonianFields
    from liepoisson.leaf.leaf_in_units import LeafInUnits

_BLIND = (1e-8, 1e-10, 1e-12, 1e-14, 1e-16)
"""A slope below this, relative, may be one at which Newton's method comes to rest on its way to a critical point. It is
relative to the largest curvature, so that beside a much larger hill elsewhere smaller ones count: the next is tried
where the slope does not become larger within reach."""
_FIRST, _FARTHEST = 1e-6, 64.0
"""How far the interval is followed on each side, relative to the length of the state, by factors of two."""
_VISIBLE_AT = 1e-2
"""If the slope is not seen with 300 digits at this distance on either side, it is that of a family, or of a tail."""
_POINTS, _LAST = (32, 64, 128), 4
"""Points of the interpolation, which are doubled where these are too few; coefficients that show its error."""
_DEPTH, _MOST_CELLS, _MOST_ZEROS = 40, 4000, 24
"""Halvings of the interval, at most; how many cells are looked at for one zero, and how many zeros are looked for."""
_NEWTON, _SETTLED, _ZERO = 40, 1e-24, 1e-10
"""Steps of Newton's method; one that ends it, and one after which a slope that is not seen any more counts as zero,
relative to the length of the interval."""
_STARTS = (40, 30, 20, 12, 6, 3)
"""Newton's method starts this many halvings of the interval from where a zero may be, as near as the slope is seen."""
_ON = 1e-6
"""How far a state may be from the valley, relative to its length, to count as one of the interval."""


@dataclass(frozen=True)
class FlatPart:
    """An interval in which doubles do not see the slope, and the critical points in it.

    Attributes:
        zeros: The critical points, along the interval.
        is_decided: Whether these were seen to be all.
    """

    slope: ReducedSlope
    begin: float
    end: float
    zeros: tuple[SoftZero, ...]
    is_decided: bool

    def contains(self, state: Array) -> bool:
        """Whether a state is in the interval, up to what Newton's method leaves across."""
        slope = self.slope
        s = float(linear.matmul(slope.soft[:, 0], (state - slope.origin)))
        if not self.begin <= s <= self.end:
            return False
        with precision(BITS):
            there = slope.at([arb(s)])
            return there is not None and bool(
                linear.norm(slope.state_of([arb(s)], there) - state) <= _ON * slope.length
            )


@np.errstate(all="ignore")  # functions need not be defined where they are tried
def flat_part_at(leaf: LeafInUnits, fields: HamiltonianFields, values: Array, state: Array) -> FlatPart | None:
    """The interval of a state with one soft direction; None if there is none, or it does not end within reach."""
    with precision(BITS):
        slope = reduced_slope(leaf, fields, values, state)
        if slope is None or slope.soft.shape[1] != 1 or not _is_blind(slope, 0, 0.0) or not _is_seen_beside(slope):
            return None
        for blind in _BLIND:
            begin, end = _end(slope, 0, -1, blind), _end(slope, 0, 1, blind)
            if begin is not None and end is not None:
                return _resolved(slope, begin, end)
        return None


@dataclass(frozen=True)
class HiddenPlace:
    """A place with several soft directions in which doubles do not see the slope, and which ends along each of them.

    Attributes:
        origin: A state of it, shape (N,).
        soft: The directions, shape (N, k).
        begin: Where it ends along each, shape (k,).
        end: The same on the other side.
    """

    origin: Array
    soft: Array
    begin: Array
    end: Array

    def contains(self, state: Array) -> bool:
        """Whether a state is in the box."""
        s = linear.matmul(self.soft.T, (state - self.origin))
        return bool((self.begin <= s).all() and (s <= self.end).all())


@np.errstate(all="ignore")
def hidden_place_at(leaf: LeafInUnits, fields: HamiltonianFields, values: Array, state: Array) -> HiddenPlace | None:
    """The place of a state with two or more soft directions; None if it has fewer, or is a tail along one of them."""
    with precision(BITS):
        slope = reduced_slope(leaf, fields, values, state)
        if slope is None or slope.soft.shape[1] < 2 or not _is_blind(slope, 0, 0.0):
            return None
        ends = [[_end(slope, axis, sign) for sign in (-1, 1)] for axis in range(slope.soft.shape[1])]
    known = [[end for end in pair if end is not None] for pair in ends]
    if min(map(len, known)) < 2:
        return None
    begin, end = np.array(known).T
    return HiddenPlace(slope.origin, slope.soft, begin, end)


def _is_seen_beside(slope: ReducedSlope) -> bool:
    beside = [slope.at([arb(sign * _VISIBLE_AT * slope.length)]) for sign in (-1, 1)]
    return any(there is not None and there.is_seen for there in beside)


def _end(slope: ReducedSlope, axis: int, sign: int, blind: float = _BLIND[0]) -> float | None:
    """Where the slope is seen in doubles, on one side along one direction."""
    share = _FIRST
    while share <= _FARTHEST:
        if not _is_blind(slope, axis, sign * share * slope.length, blind):
            return sign * share * slope.length
        share *= 2
    return None


def _is_blind(slope: ReducedSlope, axis: int, distance: float, blind: float = _BLIND[0]) -> bool:
    """Whether the slope is too small for doubles; also where it is not known, so that no interval ends there."""
    s = [arb(0)] * slope.soft.shape[1]
    s[axis] = arb(distance)
    there = slope.at(s)
    size = blind * slope.curvature * slope.length
    return there is None or not any(abs(v) >= size for v in there.value)


def _resolved(slope: ReducedSlope, begin: float, end: float) -> FlatPart:
    search = _Zeros(slope, arb(begin + end) / 2, arb(end - begin) / 2)
    is_decided = any(search.are_all(n_points) for n_points in _POINTS)
    zeros: list[SoftZero] = []
    for s, order in sorted(search.found, key=lambda zero: float(zero[0])):
        fold = fold_to_round_off(slope, [s])
        zero = slope.zero([s], np.array([1 / order])) if fold is None else slope.zero(fold, np.array([0.5]))
        if zero is not None:
            zeros.append(zero)
        is_decided = is_decided and zero is not None
    return FlatPart(slope, begin, end, tuple(zeros), is_decided)


@dataclass
class _Zeros:
    """The zeros of the slope on an interval, with their orders, as far as they were found."""

    slope: ReducedSlope
    middle: arb
    half: arb
    found: list[tuple[arb, int]] = field(default_factory=list[tuple[arb, int]])

    def are_all(self, n_points: int) -> bool:
        """Look for zeros until interpolation at this many points shows that there are no others."""
        places = [((2 * j + 1) * arb.pi() / (2 * n_points)).cos().mid() for j in range(n_points)]
        slopes = [self.slope.at([(self.middle + self.half * u).mid()]) for u in places]
        values = [there.value[0] for there in slopes if there is not None]
        if len(values) < n_points:
            return False
        while len(self.found) <= _MOST_ZEROS:
            left = [v / self._product((self.middle + self.half * u).mid()) for u, v in zip(places, values, strict=True)]
            if not all(v.is_finite() for v in left):
                return False
            cell = _first_cell(*_interpolation(left))
            if cell is None:
                return True
            zero = self._from_cell(cell)
            if zero is None:
                return False
            self.found.append(zero)
        return False

    def _product(self, s: arb) -> arb:
        product = arb(1)
        for zero, order in self.found:
            product *= ((s - zero) / self.half) ** order
        return product

    def _from_cell(self, cell: arb) -> tuple[arb, int] | None:
        for halvings in _STARTS:
            for sign in (1, -1):
                zero = self._newton((self.middle + self.half * (cell + sign * arb(2) ** -halvings)).mid())
                if zero is not None:
                    return zero
        return None

    def _newton(self, s: arb) -> tuple[arb, int] | None:
        """A zero that is new, by Newton's method for the displacement without those that were found."""
        last = None
        for _ in range(_NEWTON):
            there = self.slope.at([s])
            if there is None or not there.is_seen:
                break
            step = self._step(s, there)
            if step is None:
                return None
            s = (s - step).mid()
            size = float(abs(step / self.half))
            if not abs((s - self.middle) / self.half) <= 1 + WHOLE:
                return None
            if size <= _SETTLED or (last is not None and last <= _ZERO and size > last / 2):
                last = min(size, last or size)
                break
            last = size
        if last is None or not last <= _ZERO:
            return None
        order = self._order(s, last)
        is_new = all(abs((s - zero) / self.half) > _ZERO**2 for zero, _ in self.found)
        return (s, order) if order is not None and is_new else None

    def _step(self, s: arb, there: Slope) -> arb | None:
        r"""Newton's step for $1/L$ with $L = g'/g - \sum m_i/(s - z_i)$, which is $-L/L'$.

        With $n = g/g'$ and its step $w = n/n'$: $(g'/g)' = -n'/n^2 = -1/(nw)$.
        """
        both = newton_step(self.slope, [s], there)
        return None if both is None else self._deflated(s, *both)

    def _deflated(self, s: arb, step: list[arb], shares: Array) -> arb | None:
        share = float(shares[0])
        n = step[0] * share
        rate, bend = 1 / n, -1 / (n * step[0])
        for zero, order in self.found:
            rate -= order / (s - zero)
            bend += order / (s - zero) ** 2
        length = -rate / bend
        return length if length.is_finite() else None

    def _order(self, s: arb, size: float) -> int | None:
        """The order of a zero, from the displacement at a place beside it."""
        for share in (max(size, 1e-20) * 1e3, 1e-12, 1e-9):
            beside = (s + self.half * share).mid()
            there = self.slope.at([beside])
            if there is None or not there.is_seen:
                continue
            found = newton_step(self.slope, [beside], there)
            if found is not None and 0 < found[1][0] <= 1 + WHOLE and is_one_over_whole(found[1], WHOLE):
                return round(1 / float(found[1][0]))
        return None


def _interpolation(values: list[arb]) -> tuple[arb_poly, arb]:
    """The polynomial of these values at Chebyshev's points in [-1, 1], and an estimate of its error."""
    n = len(values)
    angles = [(k * arb.pi() / (2 * n)).cos().mid() for k in range(4 * n)]
    weights = [
        sum((v * angles[k * (2 * j + 1) % (4 * n)] for j, v in enumerate(values)), arb(0)) * 2 / n for k in range(n)
    ]
    weights[0] /= 2
    last, now, u = arb_poly([1]), arb_poly([0, 1]), arb_poly([0, 2])
    total = last * weights[0] + now * weights[1]
    for weight in weights[2:]:
        last, now = now, u * now - last
        total += now * weight.mid()
    error = sum((abs(w) for w in weights[-_LAST:]), arb(0)) * n
    return total, error.upper()


def _first_cell(polynomial: arb_poly, error: arb) -> arb | None:
    """The middle of the first small cell in [-1, 1] in which the polynomial may be zero, up to the error."""
    cells = [(arb(0), 0)]
    for _ in range(_MOST_CELLS):
        if not cells:
            return None
        middle, depth = cells.pop()
        radius = arb(2) ** -depth
        shifted = polynomial(arb_poly([middle, radius])).coeffs()
        if abs(shifted[0]) > sum((abs(c) for c in shifted[1:]), error):
            continue
        if depth == _DEPTH:
            return middle
        cells += [(middle + radius / 2, depth + 1), (middle - radius / 2, depth + 1)]
    return cells[-1][0]
