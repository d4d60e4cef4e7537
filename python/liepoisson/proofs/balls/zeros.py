"""All zeros of a square system of polynomials in a box, in balls: Krawczyk's operator, and boxes that are cut."""

from __future__ import annotations

import time as clock
from collections.abc import Sequence

import numpy as np
from flint import arb

from liepoisson.errors import EnclosureError
from liepoisson.proofs.balls.field import BallField, Vector, as_column, lies_inside, magnitude
from liepoisson.proofs.balls.flow import column
from liepoisson.proofs.balls.lohner import identity
from liepoisson.proofs.box import Box
from liepoisson.proofs.rigorous import Means, as_ball, rounded

_NARROWEST = 1e-10
_IMPROVEMENTS = 12
_WORTH = 0.7


def zeros(
    system: BallField, region: Box, most: int, cut: float, means: Means
) -> tuple[list[tuple[Box, Box]], list[Box]]:
    """The zeros in a box by looking at so many boxes at most, as the core finds them in intervals.

    Raises:
        EnclosureError: the time limit has passed.
    """
    waiting: list[Vector] = [[as_ball(float(a), float(b)) for a, b in zip(region.lower, region.upper, strict=True)]]
    found: list[tuple[Vector, Vector]] = []
    undecided: list[Vector] = []
    for _ in range(most):
        if not waiting:
            break
        if clock.monotonic() > means.deadline:
            raise EnclosureError("the time limit has passed; give a larger time_limit or a smaller box")
        if means.progress is not None:
            means.progress(0.0)
        box = waiting.pop()
        if not _may_vanish(system, box):
            continue
        image = _operator(system, box)
        if image is None:
            _cut_or_left(box, cut, waiting, undecided)
            continue
        if not all(a.overlaps(b) for a, b in zip(image, box, strict=True)):
            continue
        if all(lies_inside(a, b) for a, b in zip(image, box, strict=True)):
            _keep(found, undecided, _narrowed(system, image), box)
            continue
        common = [a.intersection(b) for a, b in zip(image, box, strict=True)]
        wider = _inflated(common)
        image = _operator(system, wider)
        if image is not None and all(lies_inside(a, b) for a, b in zip(image, wider, strict=True)):
            _keep(found, undecided, _narrowed(system, image), wider)
        elif _width(common) < _WORTH * _width(box):
            waiting.append(common)
        elif _may_vanish(system, common):
            _cut_or_left(common, cut, waiting, undecided)
    n = region.lower.shape
    narrow = [(rounded(a, n), _inner(b, n)) for a, b in found]
    inside = [(a, b) for a, b in narrow if region.contains(a)]  # a ball is wider than the interval that it was made of
    edge = [a for a, _ in narrow if region.overlaps(a) and not region.contains(a)]
    return inside, [*edge, *(rounded(b, n) for b in [*undecided, *waiting])]


def _inner(box: Vector, shape: tuple[int, ...]) -> Box:
    """The box in which a zero is alone, rounded inward by what the balls are wider."""
    wide = rounded(box, shape)
    low = np.array([float(b.lower()) for b in box], float)
    high = np.array([float(b.upper()) for b in box], float)
    return Box(np.nextafter(low, wide.upper), np.nextafter(high, wide.lower))


def _inflated(box: Vector) -> Vector:
    """A wider box: a component that the operator makes a point lies in the interior of none otherwise."""
    widest = max(float(b.rad()) for b in box)
    return [b + arb(0, 0.1 * widest + 1e-14 * float(magnitude(b).mid()) + 1e-300) for b in box]


def _may_vanish(system: BallField, box: Vector) -> bool:
    return all(v.contains(0) for v in system.rates(box))


def _operator(system: BallField, box: Sequence[arb]) -> Vector | None:
    """Krawczyk's operator, which contains all zeros in the box; none if there is no approximate inverse."""
    middle = [arb(b.mid()) for b in box]
    jacobian = system.jacobian(box)
    try:
        inverse = jacobian.mid().inv().mid()
    except ZeroDivisionError:
        return None
    spread = as_column([b - m for b, m in zip(box, middle, strict=True)])
    rest = (identity(system.n) - inverse * jacobian) * spread
    image = column(as_column(middle) - inverse * as_column(system.rates(middle)) + rest)
    return image if all(b.is_finite() for b in image) else None


def _narrowed(system: BallField, zero: Vector) -> Vector:
    for _ in range(_IMPROVEMENTS):
        image = _operator(system, zero)
        if image is None:
            break
        following = [a.intersection(b) for a, b in zip(image, zero, strict=True)]
        if not _width(following) < 0.9 * _width(zero):
            break
        zero = following
    return zero


def _keep(found: list[tuple[Vector, Vector]], undecided: list[Vector], zero: Vector, around: Vector) -> None:
    """Keep a zero, unless it is one that was found from the box beside it."""
    if any(all(k.contains(z) for k, z in zip(known, zero, strict=True)) for _, known in found):
        return
    if any(all(k.overlaps(z) for k, z in zip(known, zero, strict=True)) for known, _ in found):
        undecided.append(zero)
        return
    found.append((zero, around))


def _cut_or_left(box: Vector, cut: float, waiting: list[Vector], undecided: list[Vector]) -> None:
    """Cut a box across its widest side, or leave it if that is too narrow; the parts overlap a little."""
    widths = [float(b.rad()) for b in box]
    widest = max(range(len(box)), key=widths.__getitem__)
    low, high = box[widest].lower(), box[widest].upper()
    size = max(abs(float(low)), abs(float(high)), 1e-6)
    if not 2 * widths[widest] > _NARROWEST * size:
        undecided.append(box)
        return
    place = low + cut * (high - low)
    # parts that overlap have a zero on the cut inside of one of them
    for side in ((low, place + (high - low) / 64), (place - (high - low) / 64, high)):
        part = list(box)
        part[widest] = side[0].union(side[1])
        waiting.append(part)


def _width(box: Sequence[arb]) -> float:
    return sum(float(b.rad()) for b in box)
