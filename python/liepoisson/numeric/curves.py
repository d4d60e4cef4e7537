r"""Curves of solutions, followed by their tangents (pseudo-arclength), and the points on them where something changes.

Where equations have one unknown more than they fix, their solutions form curves.  A step goes along the tangent and is
corrected across it by Newton's method, so that folds are no obstacle; it is halved until the correction succeeds and
the tangents at its ends differ little.  Functions along the curve pass zero where something changes.  Each zero is
located by the secant method (Illinois), on a cubic curve through both ends with their tangents that is corrected by the
solutions found on it (Lagrange).  Where curves cross, the equations are singular: such guesses are so near to the curve
that is followed that Newton's method stays on it.

References: [keller1977]; [doedel2003].
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, Generic, NamedTuple, Protocol, TypeAlias, TypeVar

import numpy as np

from liepoisson.errors import TimeLimitError
from liepoisson.inputs.arrays import Array
from liepoisson.numeric.run_options import RunOptions
from liepoisson.portable import elementary, linear

HOLDS = 1e-12
"""The largest residual of a solution, in units; Newton's method usually ends at 1e-16."""
FIRST, LONGEST, _SHORTEST = 1e-2, 0.2, 1e-7
"""The first step, the longest by default, and the shortest: with that residual its direction has five digits."""
_LEAST = 0.01
"""Part of the longest step down to which one is made again where a point in it was not located."""
_GOOD, _BAD = 0.2, 0.5
"""The step grows where its tangents differ by less than the first angle, and is made again above the second."""
TRIALS = 8
"""How often the first step is tried."""
_SECANTS, _KNOWN, _SAME, _ZERO = 40, 4, 1e-6, 1e-13
"""Steps of the secant method, in which each third one triples the digits; solutions that correct a cubic; the distance,
relative to the step, of solutions that are the same; and the part of its change below which a function is zero."""
_PAST, _NEAR = 9, 1e-4
"""Points from which the next ones are predicted, and the error of a prediction, in units, from which Newton's method
converges quadratically.  Measured in ten families of orbits: with 1e-3 they take as long, with 1e-6 a tenth longer, and
with 1e-8 a third."""
_REACHED, TOO_SHORT, _SINGULAR = "the wanted value", "the steps became too short", "a singular level"


class Solution(Protocol):
    """A point of a curve, or a guess."""

    @property
    def unknowns(self) -> Array:
        """All that it is computed from."""
        ...

    @property
    def units(self) -> Array:
        """Theirs, in which a tangent has the length 1; infinite of those that follow from the others."""
        ...

    @property
    def residual(self) -> float:
        """How well the equations hold, in units."""
        ...


P = TypeVar("P", bound=Solution)
M = TypeVar("M")


class Curve(Protocol[P]):
    """The equations of a curve.  A direction is a change of the unknowns.

    Attributes:
        together: How many points are solved for together at most.
    """

    together: ClassVar[int] = 1

    def value(self, point: P, /) -> float:
        """What varies along the curve."""
        ...

    def solved(self, guess: Array, near: P, aim: Array | float, /) -> P:
        """What Newton's method makes of a guess: across a direction in units, or where the value is a wanted one."""
        ...

    def null_space(self, point: P, n: int, /, *, least: int = 1) -> Array:
        """Orthonormal directions in which the equations hold to first order; n, where the point does not say how many.

        Args:
            least: How many there are at least; the point may be so far from an exact one that it does not say so.

        Raises:
            LinAlgError: the equations have no finite derivatives there.
        """
        ...

    def tests(self, point: P, tangent: Array, /) -> dict[str, Array]:
        """Functions that pass zero where something changes, of each kind in their order; none where they do not exist.

        Of the kind "fold" is the derivative of the value along the tangent, which is given in units; of the kind
        "branch" is what passes zero at a fold, and where another curve crosses.
        """
        ...

    def obstacle(self, first: P, last: P, /) -> tuple[str, bool]:
        """What lies between two points that no step may pass, and whether shorter steps are of no use; else nothing."""
        return "", False

    def ahead(self, guesses: Array, last: P, direction: Array, length: float, /) -> Sequence[P]:
        """The points that follow a last one by equal steps, from guesses; as many as are found together."""
        return ()

    def settled(self, point: P, /) -> P:
        """The same point as the next steps begin there."""
        return point


class Zero(NamedTuple, Generic[P]):
    """A point where something changes.

    Attributes:
        kind: What does: "fold", "branch", or the kind of the function that vanishes.
        place: The displacement from the last member.
        point: The point; the nearest one that was found, if it was not located.
        direction: That of the curve there.
        is_located: Whether it is known to round-off.
        after: The number of the last member.
    """

    kind: str
    place: float
    point: P
    direction: Array
    is_located: bool
    after: int = 0

    @property
    def tangent(self) -> Array:
        """The direction in the finite ones of the units."""
        return _tangent((self.point, self.direction))


Direction: TypeAlias = "tuple[P, Array]"
"""A point, and a change of its unknowns."""


def _tangent(end: Direction[P]) -> Array:
    """A direction in the finite ones of the units."""
    units = end[0].units
    return (end[1] / units)[np.isfinite(units)]


class Piece(Generic[P]):
    """A curve between two points with their directions: a cubic, corrected by the points that were found on it.

    Attributes:
        ends: They.
        across: The first direction, in units.
        length: The displacement along it.
    """

    def __init__(self, first: Direction[P], last: Direction[P]) -> None:
        self.ends, self._known = (first, last), list[tuple[float, Array]]()
        units = first[0].units
        self.across, change = first[1] / units, (last[0].unknowns - first[0].unknowns) / units
        self.length = float(linear.matmul(self.across, change))
        self._rate = last[1] / linear.matmul(self.across, last[1] / units)

    def add(self, u: float, point: P) -> None:
        """Let the curve pass through a point at a part of the length."""
        if all(abs(u - other) > _SAME for other in (0.0, 1.0, *(other for other, _ in self._known))):
            off = (point.unknowns - self._cubic(u)) / (u * (1 - u)) ** 2
            self._known = [*self._known, (u, off)][-_KNOWN:]

    def at(self, u: float) -> tuple[Array, Array]:
        """The unknowns there, and their derivatives by the cubic: imaginary parts beside a real number."""
        value, beside = self._cubic(u), self._cubic(complex(u, 1e-100))
        for j, (one, off) in enumerate(self._known):  # Lagrange's polynomial of what is left, by u^2 (1 - u)^2
            weight = float(np.prod([(u - other) / (one - other) for i, (other, _) in enumerate(self._known) if i != j]))
            value = value + (u * (1 - u)) ** 2 * weight * off
        return value, beside.imag / 1e-100

    def _cubic(self, u: Any) -> Any:
        """Hermite's polynomial."""
        (first, rate), (last, _) = self.ends
        value = (1 + 2 * u) * (1 - u) ** 2 * first.unknowns + u * (1 - u) ** 2 * self.length * rate
        return value + u * u * (3 - 2 * u) * last.unknowns + u * u * (u - 1) * self.length * self._rate


class Follower(Generic[P]):
    """What moves along a curve, from a point of it."""

    _piece: Piece[P]

    def __init__(self, curve: Curve[P], point: P, longest: float) -> None:
        self.curve, self.longest, self.step = curve, longest, min(FIRST, longest)
        self.here = point, curve.null_space(point, 1)[0]
        self._past, self._ahead = [point], list[P]()
        ahead = range(curve.together)
        self._binomials = np.array([[float(math.comb(i + j, i)) for j in ahead] for i in range(_PAST)])
        self._known_tests: list[tuple[Direction[P], dict[str, Array]]] = []

    def turn_towards(self, bound: float | None, increasing: bool | None) -> None:
        """Go on towards a value, or to larger or smaller ones."""
        (point, direction), slope = self.here, self._tests(self.here)["fold"][0]
        if increasing is None:
            increasing = bound is None or bound > self.curve.value(point)
        self.here = point, -direction if (slope < 0) == increasing and slope != 0 else direction

    def leave(self, tangent: Array) -> bool:
        """Go to a curve that crosses the one with a tangent; whether there is one."""
        for direction in self._across(self.here[0], tangent):
            first = self.here[0], direction
            for step in self.step / 2.0 ** np.arange(TRIALS):
                new = self._moved(first, step)
                if new.residual <= HOLDS:
                    self.here, self.step = (new, self._nearest(new, _tangent(first), 1)[0]), float(step)
                    self._past = [new]
                    return True
        return False

    def _look_ahead(self, most: int) -> None:
        r"""Some of the next points, all at once, where the past predicts them: after equal steps, at most so many.

        With the differences of the last points, $x_j \approx \sum_{i<q}\binom{i+j-1}{i}\nabla^i x$, and the next term
        is about the error: the order is the one that predicts most points so well that Newton's method converges
        quadratically, and these best.
        """
        differences, rest = list[Array](), np.array([one.unknowns for one in self._past])
        while len(rest):
            differences.append(rest[-1])
            rest = rest[1:] - rest[:-1]
        (last, direction), terms = self.here, np.array(differences)
        sizes = linear.norm((terms / last.units)[2:, np.isfinite(last.units)], axis=1)
        errors = self._binomials[2 : len(terms), :most] * sizes[:, None]
        n = int((errors < _NEAR).sum(axis=1).max(initial=0))
        if n > 1:
            order = 2 + int(errors[:, n - 1].argmin())
            guesses = linear.matmul(self._binomials[:order, :n].T, terms[:order])
            self._ahead = list(self.curve.ahead(guesses, last, direction, self.step))

    def _moved(self, end: Direction[P], length: float) -> P:
        """The point after a step in a direction, corrected across it."""
        point, direction = end
        return self.curve.solved(point.unknowns + length * direction, point, direction / point.units)

    def _nearest(self, point: P, tangent: Array, n: int) -> tuple[Array, float]:
        """The direction nearest to a tangent in the null space of n dimensions, and their angle; NaN without one."""
        try:
            space = self.curve.null_space(point, n)
        except linear.LinAlgError:
            return np.full_like(point.unknowns, np.nan), np.nan
        share = linear.matmul(np.array([_tangent((point, one)) for one in space]), tangent / linear.norm(tangent))
        cosine = float(linear.norm(share))
        return linear.matmul(share, space) / (cosine or 1.0), float(elementary.arccos(min(1.0, cosine)))

    def _advance(self, bound: float | None, most: int) -> str:
        """Go on by one point, of at most so many; why the curve ends there, or nothing."""
        curve, here, obstacle = self.curve, self.here, ""
        old, tangent = curve.value(here[0]), _tangent(here)
        if not self._ahead and len(self._past) > 2 and curve.together > 1:
            self._look_ahead(most)
        while self.step > _SHORTEST:
            is_ahead = bool(self._ahead)
            new, end = self._ahead.pop(0) if is_ahead else self._moved(here, self.step), ""
            value = curve.value(new)
            if bound is not None and new.residual <= HOLDS and old != bound and (old - bound) * (value - bound) <= 0:
                near = self._moved(here, self.step * (bound - old) / (value - old))
                new, end = curve.solved(near.unknowns, near, bound), _REACHED
            if new.residual <= HOLDS:
                words, is_final = curve.obstacle(here[0], new)
                if is_final:
                    return words
                obstacle = obstacle or words
                direction, angle = self._nearest(new, tangent, 1)
                if not words and angle < _BAD:
                    break
            self._past, self._ahead = [], []
            self.step = self.step if is_ahead else self.step / 2  # it may be that only what was predicted fails
        else:
            return obstacle or TOO_SHORT
        last = new, direction
        self._piece, settled = Piece(here, last), curve.settled(new)
        self.here = last if settled is new else (settled, self._nearest(settled, _tangent(last), 1)[0])
        step = min(self.longest, 1.5 * self.step) if angle < _GOOD else self.step
        if settled is not new or step != self.step:
            self.step, self._past, self._ahead = step, [], []
        self._past = [*self._past, settled][-_PAST:]
        return end

    def followed(
        self, bound: float | None, most: int, run: RunOptions, member: Callable[[P], M]
    ) -> tuple[tuple[M, ...], tuple[Zero[P], ...], str]:
        """The members of the curve, where something changes between them, and why it ends; nothing at so many members.

        Args:
            bound: The value at which it ends.
            most: At most so many members.
            run: Whose deadline ends it, and who hears of it.
            member: What a point is for the caller.
        """
        members, zeros, end = [member(self.here[0])], list[Zero[P]](), ""
        while not end and len(members) < most:
            try:
                end = self._advance(bound, most - len(members))
                if end not in ("", _REACHED):
                    break
                new, found = member(self._piece.ends[1][0]), self._zeros(len(members) - 1)
                if not all(one.is_located for one in found) and self._piece.length >= _LEAST * self.longest:
                    self.here, self.step, end = self._piece.ends[0], self._piece.length / 2, ""  # not in one step
                    self._past, self._ahead = [], []
                    continue
                if found and found[-1].kind == _SINGULAR:
                    end = found.pop().kind
                else:
                    members.append(new)
                zeros += found
            except TimeLimitError:
                end = "the time limit"
            run.tell(len(members) / most)
        return tuple(members), tuple(zeros), end

    def _tests(self, end: Direction[P]) -> dict[str, Array]:
        """The functions at a point; those of the last two, the ends of a step, are kept."""
        for known, found in self._known_tests:
            if known is end:
                return found
        found = self.curve.tests(end[0], end[1] / end[0].units)
        self._known_tests = [(end, found), *self._known_tests[:1]]
        return found

    def _zeros(self, after: int) -> list[Zero[P]]:
        """What changes in the last step, after a member, in its order up to a singular level."""
        piece = self._piece
        changes = self._changes(piece)
        turns, passes = ("fold", 0) in changes, any(kind == "branch" for kind, _ in changes)
        found: list[Zero[P]] = []
        for kind, k in changes:
            if kind == "fold" and passes:
                continue
            zero = self._located(piece, kind, k)._replace(after=after)
            if zero.kind == "fold" and "branch" in self._tests(piece.ends[0]):
                zero = self._crossed(zero)
            found.append(zero._replace(kind="fold") if turns and zero.kind == "branch" and passes else zero)
        if not self._tests(piece.ends[1]):
            found.append(Zero(_SINGULAR, piece.length, *piece.ends[1], True))
        kept, where = list[Zero[P]](), -np.inf
        for one in sorted(found, key=lambda one: one.place):
            if one.kind not in ("fold", "branch"):
                kept.append(one)
            elif one.place - where > _SAME * piece.length:  # several functions of the kind may vanish
                kept.append(one)
                where = one.place
            if one.kind == _SINGULAR:
                break
        return kept

    def _changes(self, piece: Piece[P]) -> dict[tuple[str, int], tuple[float, float]]:
        """The functions that pass zero along a piece, by kind and number: their values at the ends."""
        first, last = map(self._tests, piece.ends)
        found: dict[tuple[str, int], tuple[float, float]] = {}
        for kind, values in first.items():
            others = last.get(kind, np.zeros(0))
            n, m = np.count_nonzero(values < 0), np.count_nonzero(others < 0)
            for k in range(min(n, m), max(n, m)) if len(values) == len(others) else ():
                found[kind, k] = float(values[k]), float(others[k])
        return found

    def _located(self, piece: Piece[P], kind: str, k: int) -> Zero[P]:
        """Where the k-th function of a kind vanishes on a piece."""
        (low, high), a, b, side = self._changes(piece)[kind, k], 0.0, piece.length, 0
        nearest = Zero(kind, *((b, *piece.ends[1]) if abs(high) < abs(low) else (a, *piece.ends[0])), False)
        for _ in range(_SECANTS):
            middle = (a * high - b * low) / (high - low)
            guess, rate = piece.at(middle / piece.length)
            point = self.curve.solved(guess, piece.ends[0][0], piece.across)
            if not point.residual <= HOLDS:
                break
            piece.add(middle / piece.length, point)
            here = point, self._nearest(point, _tangent((point, rate)), 2 if kind == "branch" else 1)[0]
            tests = self._tests(here)
            if not tests:
                return Zero(_SINGULAR, middle, *here, True)
            value = float(tests[kind][k]) if k < len(tests[kind]) else 0.0
            is_located = abs(b - a) < _SAME**2 * piece.length or abs(value) <= _ZERO * abs(high - low)
            nearest = Zero(kind, middle, *here, is_located)
            if is_located:
                break
            if value * high > 0:
                b, high, low, side = middle, value, low / 2 if side == 1 else low, 1
            else:
                a, low, high, side = middle, value, high / 2 if side == -1 else high, -1
        return nearest

    def _crossed(self, fold: Zero[P]) -> Zero[P]:
        r"""Where the value turns but nothing else passes zero another curve crosses: the point, located along it.

        The side branch of a pitchfork arrives so, as $x^2 \sim c$: a residual r leaves an error of $r^{1/3}$ in x, too
        much to see in the equations that they are singular there.
        """
        point, near = fold.point, fold._replace(kind="branch", is_located=False)
        other = self._across(point, fold.tangent)[0]
        ends = [self._moved((point, other), way * self._piece.length / 4) for way in (-1, 1)]
        if not all(one.residual <= HOLDS for one in ends):
            return near
        piece = Piece(*((one, self._nearest(one, _tangent((point, other)), 1)[0]) for one in ends))
        found = [self._located(piece, kind, k) for kind, k in self._changes(piece) if kind == "branch"]
        if not found:
            return near
        own = self._across(found[0].point, found[0].tangent)[0]
        own = own if linear.matmul(_tangent((found[0].point, own)), fold.tangent) > 0 else -own
        return found[0]._replace(place=fold.place, direction=own, after=fold.after)

    def _across(self, point: P, tangent: Array) -> Array:
        """Directions in the null space of a point where curves cross, orthogonal to a tangent."""
        space = self.curve.null_space(point, 2, least=2)
        share = linear.matmul(np.array([_tangent((point, one)) for one in space]), tangent)[:, None]
        sign = -1.0 if share[0] < 0 else 1.0  # in a plane the direction is the tangent, turned by a right angle
        return sign * linear.matmul(linear.complement(share / linear.norm(share)).T, space)
