r"""Curves of solutions, followed by their tangents (pseudo-arclength), and the points on them where something changes.

Where equations have one unknown more than they fix, their solutions form curves.  A step goes along the tangent and is
corrected across it by Newton's method, so that folds are no obstacle; it is halved until the correction succeeds and
the tangents at its ends differ little.  Functions along the curve change their signs where something changes.  Each
zero is located by the secant method (Illinois) on a cubic curve through both ends with their tangents, which is
corrected by the solutions that were found on it (Lagrange).  Where curves cross, the equations are singular: guesses are
so near to the curve that is followed that Newton's method stays on it.

References: [keller1977]; [doedel2003].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from liepoisson.errors import TimeLimitError
from liepoisson.inputs.arrays import Array
from liepoisson.numeric.run_options import RunOptions
from liepoisson.portable import elementary, linear

FIRST, LONGEST = 1e-2, 0.2
"""The first and the longest step, in units of the solutions, which are of order one."""
_SHORTEST = 1e-7
"""A solution is known to 1e-12, and so the direction of a step of this length to five digits."""
_LEAST = 0.01
"""Part of the longest step down to which one is made again where a point in it was not located."""
_GOOD, _BAD = 0.2, 0.5
"""The step grows where its tangents differ by less than the first angle, and is made again above the second."""
_TRIALS = 8
"""So often a first step is halved; the last is below 1e-4."""
_SECANTS, _KNOWN = 40, 4
"""Each third step of the Illinois method triples the digits; a curve keeps so many of the solutions found on it."""
_SAME, _ZERO = 1e-6, 1e-13
"""Places with a smaller distance are one, relative to the step, and so are signs of a function with this of its change;
a zero is located where its bracket has the square of the first."""
REACHED, TOO_SHORT, LATE = "the wanted value", "the steps became too short", "the time limit"
"""Why a curve ends."""

P = TypeVar("P")
M = TypeVar("M")
E = TypeVar("E")


class Curve(Protocol[P]):
    """The equations of a curve whose points are of a type P.

    A tangent is written in the units of a point, where its length is 1.
    """

    def value(self, point: P, /) -> float:
        """What varies along the curve."""
        ...

    def slope(self, point: P, /) -> Array:
        """Its derivatives by the components of a tangent."""
        ...

    def coordinates(self, point: P, /) -> Array:
        """All that the point is computed from, as one vector."""
        ...

    def rates(self, point: P, tangent: Array, /) -> Array:
        """How the coordinates change along a tangent."""
        ...

    def components(self, point: P, change: Array, /) -> Array:
        """A change of the coordinates as a tangent is written."""
        ...

    def solved(self, coordinates: Array, near: P, across: Array, /) -> P:
        """What Newton's method makes of a guess, across a tangent at a point that is near."""
        ...

    def at_value(self, point: P, value: float, /) -> P:
        """What it makes of a point where the value is a wanted one."""
        ...

    def holds(self, point: P, /) -> bool:
        """Whether the equations hold."""
        ...

    def null_space(self, point: P, n: int, /) -> Array:
        """Orthonormal tangents along which the equations hold to first order, shape (n, component).

        Args:
            point: The point.
            n: How many there are, if the point itself does not say.

        Raises:
            LinAlgError: the equations have no finite derivatives there.
        """
        ...

    def tests(self, point: P, tangent: Array, /) -> dict[str, Array]:
        """Functions that pass zero where something changes, in kinds, each in its order.

        At a zero of the kind "branch" another curve may cross.  A kind is left out where its functions do not exist.
        """
        ...

    def obstacle(self, first: P, last: P, /) -> tuple[str, bool]:
        """What lies between two points that no step may pass, and whether a shorter step is of no use; else nothing."""
        return "", False

    def settled(self, point: P, /) -> P:
        """The same point as the next steps begin there."""
        return point


class Between(NamedTuple, Generic[E]):
    """What changes in the last step.

    Attributes:
        events: It, in its order.
        are_located: Whether all zeros were located.
        end: Why the curve ends within the step.
    """

    events: list[E]
    are_located: bool = True
    end: str = ""


class Change(NamedTuple):
    """A function along a curve that changes its sign.

    Attributes:
        kind: Its kind.
        k: Which of them.
        first: Its value at the first end.
        last: At the last.
    """

    kind: str
    k: int
    first: float
    last: float


class Zero(NamedTuple, Generic[P]):
    """A point where a function along a curve vanishes.

    Attributes:
        kind: Of the function.
        place: The displacement from the first end of its piece.
        point: The point; the nearest one that was found, if it was not located.
        tangent: The direction there.
        is_located: Whether it is known to round-off.
    """

    kind: str
    place: float
    point: P
    tangent: Array
    is_located: bool


@dataclass(frozen=True, eq=False)
class End(Generic[P]):
    """A point of a curve, its tangent, and how its coordinates change along it."""

    point: P
    tangent: Array
    rates: Array


class Piece(Generic[P]):
    """A curve between two points: a cubic with its tangents there, through the points that were found on it.

    Args:
        curve: The curve.
        first: Its first end.
        last: The other.
    """

    def __init__(self, curve: Curve[P], first: End[P], last: End[P]) -> None:
        self.curve, self.first, self.last = curve, first, last
        self._ends = curve.coordinates(first.point), curve.coordinates(last.point)
        self.length = self._along(self._ends[1] - self._ends[0])
        self._rates = first.rates / self._along(first.rates), last.rates / self._along(last.rates)
        self._known: list[tuple[float, Array]] = []

    def _along(self, change: Array) -> float:
        """A change of the coordinates along the first tangent."""
        return float(linear.matmul(self.first.tangent, self.curve.components(self.first.point, change)))

    def add(self, place: float, point: P) -> None:
        """Let the cubic pass through a point at a displacement."""
        u = place / self.length
        off = self.curve.coordinates(point) - self._cubic(u)[0]
        if all(abs(u - other) > _SAME for other in (0.0, 1.0, *(other for other, _ in self._known))):
            self._known = [*self._known, (u, off / (u * (1 - u)) ** 2)][-_KNOWN:]

    def at(self, place: float) -> tuple[Array, Array]:
        """The coordinates at a displacement, and how the cubic goes on there."""
        u = place / self.length
        value, rates = self._cubic(u)
        for j, (one, off) in enumerate(self._known):  # Lagrange's polynomial of what is left, by u^2 (1 - u)^2
            weight = float(np.prod([(u - other) / (one - other) for i, (other, _) in enumerate(self._known) if i != j]))
            value = value + (u * (1 - u)) ** 2 * weight * off
        return value, rates

    def _cubic(self, u: float) -> tuple[Array, Array]:
        """Hermite's polynomial, and its derivative by the displacement."""
        (first, last), (rates, last_rates), h = self._ends, self._rates, self.length
        value = (1 + 2 * u) * (1 - u) ** 2 * first + u * (1 - u) ** 2 * h * rates
        value = value + u * u * (3 - 2 * u) * last + u * u * (u - 1) * h * last_rates
        slope = 6 * u * (1 - u) * (last - first) / h + (1 - u) * (1 - 3 * u) * rates + u * (3 * u - 2) * last_rates
        return value, slope


class Follower(Generic[P]):
    """What moves along a curve.

    Args:
        curve: The curve.
        point: A point of it.
        longest: The longest step.
    """

    piece: Piece[P]

    def __init__(self, curve: Curve[P], point: P, longest: float) -> None:
        self.curve, self.longest, self.step = curve, longest, min(FIRST, longest)
        self.here = self.end(point, curve.null_space(point, 1)[0])

    def end(self, point: P, tangent: Array) -> End[P]:
        """A point with a tangent."""
        return End(point, tangent, self.curve.rates(point, tangent))

    def turn_towards(self, bound: float | None, increasing: bool | None) -> None:
        """Go on towards a value, or to larger or smaller ones."""
        slope = float(linear.matmul(self.curve.slope(self.here.point), self.here.tangent))
        if increasing is None:
            increasing = bound is None or bound > self.curve.value(self.here.point)
        if (slope < 0) == increasing and slope != 0:
            self.here = self.end(self.here.point, -self.here.tangent)

    def leave(self, directions: Array) -> bool:
        """Go to a curve that crosses this one, in one of some directions; whether there is one."""
        for direction in directions:
            first, step = self.end(self.here.point, direction), self.step
            for _ in range(_TRIALS):
                new = self.moved(first, step)
                if self.curve.holds(new):
                    self.here, self.step = self.end(new, self.turned(first, new)[0]), step
                    return True
                step /= 2
        return False

    def moved(self, end: End[P], length: float) -> P:
        """The point after a step along a tangent, corrected across it."""
        guess = self.curve.coordinates(end.point) + length * end.rates
        return self.curve.solved(guess, end.point, end.tangent)

    def turned(self, end: End[P], new: P) -> tuple[Array, float]:
        """The tangent of a new point, and its angle to that of an end."""
        return self._nearest(new, self.curve.components(new, end.rates), 1)

    def _nearest(self, point: P, direction: Array, n: int) -> tuple[Array, float]:
        """What is nearest to a direction in the null space of n dimensions, and the angle between; NaN without one."""
        try:
            space = self.curve.null_space(point, n)
        except linear.LinAlgError:
            return np.full_like(direction, np.nan), np.nan
        share = linear.matmul(space, direction / linear.norm(direction))
        cosine = float(linear.norm(share))
        return linear.matmul(share, space) / (cosine or 1.0), float(elementary.arccos(min(1.0, cosine)))

    def advance(self, bound: float | None) -> str:
        """Go on by one point; why the curve ends there, or nothing."""
        curve, here, obstacle = self.curve, self.here, ""
        while self.step > _SHORTEST:
            new, end = self.moved(here, self.step), ""
            old, value = curve.value(here.point), curve.value(new)
            if bound is not None and curve.holds(new) and old != bound and (old - bound) * (value - bound) <= 0:
                length = self.step * (bound - old) / (value - old)
                new, end = curve.at_value(self.moved(here, length), bound), REACHED
            if curve.holds(new):
                words, is_final = curve.obstacle(here.point, new)
                if is_final:
                    return words
                obstacle = obstacle or words
                tangent, angle = self.turned(here, new)
                if not words and angle < _BAD:
                    break
            self.step /= 2
        else:
            return obstacle or TOO_SHORT
        last = self.end(new, tangent)
        self.piece = Piece(curve, here, last)
        settled = new if end else curve.settled(new)
        self.here = last if settled is new else self.end(settled, tangent)
        if angle < _GOOD and not end:
            self.step = min(self.longest, 1.5 * self.step)
        return end

    def _can_go_back(self) -> bool:
        """Go back by the last step, to make it again with half the length, if it was not short."""
        if self.piece.length < _LEAST * self.longest:
            return False
        self.here, self.step = self.piece.first, self.piece.length / 2
        return True

    def followed(
        self,
        bound: float | None,
        most: int,
        run: RunOptions,
        member: Callable[[P], M],
        between: Callable[[int], Between[E]],
    ) -> tuple[tuple[M, ...], tuple[E, ...], str]:
        """The members of the curve, what changes between them, and why it ends; empty at so many members.

        Args:
            bound: The value at which it ends.
            most: At most so many members.
            run: Whose deadline ends it, and who hears of it.
            member: What a point is for the caller.
            between: What changes in the last step, after the member of a number.
        """
        members, events, end = [member(self.here.point)], list[E](), ""
        while not end and len(members) < most:
            try:
                end = self.advance(bound)
                if end not in ("", REACHED):
                    break
                new, found = member(self.here.point), between(len(members) - 1)
                if not found.are_located and self._can_go_back():
                    end = ""
                    continue
                events += found.events
                end = found.end or end
                if not found.end:
                    members.append(new)
            except TimeLimitError:
                end = LATE
            run.tell(len(members) / most)
        return tuple(members), tuple(events), end

    def tests(self, point: P, tangent: Array) -> dict[str, Array]:
        """The functions of the curve, and "fold", the derivative of what varies."""
        slope = float(linear.matmul(self.curve.slope(point), tangent))
        return {"fold": np.array([slope])} | self.curve.tests(point, tangent)

    def changes(self, piece: Piece[P]) -> list[Change]:
        """The functions that change their signs along a piece."""
        first, last = (self.tests(end.point, end.tangent) for end in (piece.first, piece.last))
        found: list[Change] = []
        for kind in first:
            one, other = first[kind], last.get(kind, np.zeros(0))
            low, high = sorted(int((values < 0).sum()) for values in (one, other))
            for k in range(low, high) if len(one) == len(other) else ():
                found.append(Change(kind, k, float(one[k]), float(other[k])))
        return found

    def located(self, piece: Piece[P], change: Change) -> Zero[P]:
        """Where a function vanishes that changes its sign along a piece."""
        kind, k, low, high = change
        a, b, side = 0.0, piece.length, 0
        end = piece.last if abs(high) < abs(low) else piece.first
        nearest = Zero(kind, b if end is piece.last else a, end.point, end.tangent, False)
        for _ in range(_SECANTS):
            middle = (a * high - b * low) / (high - low)
            guess, rates = piece.at(middle)
            point = self.curve.solved(guess, piece.first.point, piece.first.tangent)
            if not self.curve.holds(point):
                break
            piece.add(middle, point)
            tangent = self._nearest(point, self.curve.components(point, rates), 2 if kind == "branch" else 1)[0]
            found = self.tests(point, tangent).get(kind, ())
            value = float(found[k]) if k < len(found) else 0.0
            is_located = abs(b - a) < _SAME**2 * piece.length or abs(value) <= _ZERO * abs(high - low)
            nearest = Zero(kind, middle, point, tangent, is_located)
            if is_located:
                break
            if value * high > 0:
                b, high, low, side = middle, value, low / 2 if side == 1 else low, 1
            else:
                a, low, high, side = middle, value, high / 2 if side == -1 else high, -1
        return nearest
