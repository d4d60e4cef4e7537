"""Rigorous enclosures of the flow of a polynomial system and of its maps to sections, with their derivatives."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson import _core
from liepoisson.algebra.sparse_polynomials import value_at
from liepoisson.errors import EnclosureError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT
from liepoisson.inputs.arrays import ReadOnlyArrays
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import shown
from liepoisson.poincare.section_arguments import as_direction
from liepoisson.proofs.box import Box, BoxLike, interval_text
from liepoisson.proofs.interval_checker import core_terms
from liepoisson.proofs.polynomial_field import PolynomialField, Terms, rational_terms
from liepoisson.proofs.rigorous import (
    PRECISION,
    Arithmetic,
    Means,
    as_ball,
    box_of_states,
    equations,
    name_of,
    pair,
    positive,
    rounded,
)

if TYPE_CHECKING:
    from flint import arb, arb_mat

    from liepoisson.model.system import System

_BACK = "for the flow backward in time enclose that of the system with the opposite Hamiltonian"
_FIRST_STEP, _LOOKS = 1e-3, 100_000
_MOST_TIME = 1e6


@dataclass(frozen=True, eq=False)
class FlowEnclosure(ReadOnlyArrays):
    """What is known of the flow on a box of states, after a time.

    Example:
        >>> oscillator = lp.System(lp.canonical(1), "dot(p, p)/2 + dot(q, q)/2")
        >>> found = lp.proofs.enclose_flow(oscillator, lp.proofs.Box.around([1, 0], 1e-3), time=2)
        >>> found.image.contains([np.cos(2), -np.sin(2)]), bool(found.derivative.width.max() < 1e-12)
        (True, True)

    Attributes:
        system: The name of the system.
        box: Where the orbits start.
        time: How long they run, exactly.
        image: A box that contains all states after that time, shape (N,).
        derivative: One that contains the derivatives of the flow at all states of the box, shape (N, N).
        tube_times: Times from which and up to which the boxes of the tube hold, shape (step, 2).
        tube: Boxes that contain all orbits between these times, shape (step, N).
        arithmetic: "intervals" or "balls".
    """

    system: str
    box: Box
    time: float
    image: Box
    derivative: Box
    tube_times: Box
    tube: Box
    arithmetic: Arithmetic

    def __repr__(self) -> str:
        return (
            f"<FlowEnclosure of {self.system!r} for the time {self.time!r}, {self.arithmetic}: widths up to "
            f"{self.box.width.max():.2g} become {self.image.width.max():.2g}; derivative within "
            f"{self.derivative.width.max():.2g}>"
        )


@dataclass(frozen=True, eq=False)
class SectionMapEnclosure(ReadOnlyArrays):
    """What is known of the map along orbits from a box of states to a section.

    Example:
        >>> oscillators = lp.System(lp.canonical(2), "dot(p, p)/2 + (q1^2 + 4*q2^2)/2")
        >>> found = lp.proofs.enclose_section_map(oscillators, [0, 0.3, 1, 0.4], surface="q1", direction=1)
        >>> found.time[0] <= 2 * np.pi <= found.time[1], found.is_first
        (True, True)

    Attributes:
        system: The name of the system.
        box: Where the orbits start.
        surface: The affine function whose zeros are the section.
        time: Bounds of the time after which each orbit crosses the section.
        image: A box that contains all crossings, shape (N,).
        derivative: One that contains the derivatives of the map by the state, along the section, shape (N, N).
        rate: Bounds of the rate of change of the function where orbits cross; they have one sign.
        is_first: Whether it is proved that no orbit of the box crosses the section in the same sense before, after it
            has left the box: then this is the first return.
        arithmetic: "intervals" or "balls".
    """

    system: str
    box: Box
    surface: str
    time: tuple[float, float]
    image: Box
    derivative: Box
    rate: tuple[float, float]
    is_first: bool
    arithmetic: Arithmetic

    def __repr__(self) -> str:
        return (
            f"<SectionMapEnclosure of {self.system!r} to {self.surface} = 0, {self.arithmetic}: time "
            f"{interval_text(*self.time)}, widths up to {self.box.width.max():.2g} become "
            f"{self.image.width.max():.2g}>"
        )


@shows_progress
def enclose_flow(
    system: System | PolynomialField,
    box: BoxLike,
    *,
    time: float,
    arithmetic: Arithmetic = "intervals",
    order: int | None = None,
    step: float | None = None,
    precision: int = PRECISION,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> FlowEnclosure:
    r"""Enclose the image of a box of states under the flow for a time, and the derivative of the flow on the box.

    Rigorous: round-off, remainders of series and the extent of the box are all bounded, so that the result is a
    theorem about the exact equations. Taylor series with Lohner's method against wrapping.

    Example:
        >>> top = lp.Top(inertia=(1, 2, 3), a=(0, 0, 1))
        >>> start = [0.1, 0.2, 1, 0, "3/5", "4/5", 0, 0, 0]
        >>> found = lp.proofs.enclose_flow(top, start, time=1)
        >>> bool(found.image.width.max() < 1e-14)
        True

    Args:
        system: A system whose equations are polynomials with rational coefficients.
        box: A `Box`, a tuple of lower and upper bounds, or one state, shape (N,).
        time: How long the orbits run, exactly this double; not negative.
        order: Order of the Taylor polynomials; by default 20, and 32 for balls.
        step: The longest step; by default only the series decide.
        time_limit: Seconds that the run may take.

    Raises:
        EnclosureError: the set has become too wide, or the time limit has passed.
        ParameterError: the equations are not polynomial or have symbols, the box is empty, or a number is not as it
            must be.
        ShapeError: the box has another shape.

    References: [lohner1987]; [zgliczynski2002].
    """
    field = equations(system)
    means = Means.of(arithmetic, order=order, step=step, precision=precision, time_limit=time_limit, progress=progress)
    states, length = box_of_states(box, field), positive(time, "time", _BACK, or_zero=True)
    if means.arithmetic == "balls":
        image, derivative, times, tube = _flow_in_balls(field, states, length, means)
    else:
        image, derivative, times, tube = _flow_in_intervals(field, states, length, means)
    return FlowEnclosure(name_of(system), states, length, image, derivative, times, tube, means.arithmetic)


def _flow_in_intervals(field: PolynomialField, box: Box, time: float, means: Means) -> tuple[Box, Box, Box, Box]:
    n = len(field.names)
    found = _core.enclose_flow(
        [core_terms(rate) for rate in field.rates],
        *around_midpoint(box),
        time,
        means.of_core(box, time),
        True,
        means.time_limit,
        means.progress,
    )
    times = np.stack([found.get("tube_start", np.zeros(0)), found.get("tube_end", np.zeros(0))], axis=-1)
    tube = [found.get(f"tube_{side}", np.zeros(0)).reshape(-1, n) for side in ("lower", "upper")]
    return (
        Box(found["lower"], found["upper"]),
        Box(found["derivative_lower"].reshape(n, n), found["derivative_upper"].reshape(n, n)),
        Box(times, times),
        Box(*tube),
    )


def around_midpoint(box: Box) -> tuple[Any, Any, Any, Any]:
    """A box as the core reads it: a point, the unit frame, and bounds of what is added, rounded outward."""
    middle = box.midpoint
    low, high = (
        np.nextafter(side - middle, way) * (side != middle) for side, way in ((box.lower, -np.inf), (box.upper, np.inf))
    )
    return middle, np.eye(len(middle)).ravel(), low, high


def _flow_in_balls(field: PolynomialField, box: Box, time: float, means: Means) -> tuple[Box, Box, Box, Box]:
    from liepoisson.proofs.balls.field import BallField, working
    from liepoisson.proofs.balls.lohner import Carried, carry

    n = len(field.names)
    with working(means.precision):
        found, tubes = carry(BallField(field), Carried.of(*ball_states(box)), time, means.of_balls(time))
        times = [pair(t) for tube in tubes for t in (tube.start, tube.end)]
        low = np.array([p[0] for p in times], float).reshape(-1, 2)
        return (
            rounded(found.box(), (n,)),
            rounded(found.derivatives().entries(), (n, n)),
            Box(low, np.array([p[1] for p in times], float).reshape(-1, 2)),
            rounded([b for tube in tubes for b in tube.box], (len(tubes), n)),
        )


def ball_states(box: Box) -> tuple[list[arb], arb_mat, list[arb]]:
    """A box as center, frame and ranges; components that are points have no range."""
    from flint import arb, arb_mat

    middle = [arb(float(c)) for c in box.midpoint]
    wide = [k for k in range(len(middle)) if box.lower[k] < box.upper[k]]
    frame = arb_mat(len(middle), len(wide), [int(i == k) for i in range(len(middle)) for k in wide])
    ranges = [as_ball(float(box.lower[k]), float(box.upper[k])) - middle[k] for k in wide]
    return middle, frame, ranges


@shows_progress
def enclose_section_map(
    system: System | PolynomialField,
    box: BoxLike,
    *,
    surface: str,
    direction: int = 0,
    time: float | None = None,
    arithmetic: Arithmetic = "intervals",
    order: int | None = None,
    step: float | None = None,
    precision: int = PRECISION,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> SectionMapEnclosure:
    r"""Enclose where and when the orbits of a box cross an affine section, and the derivative of this Poincaré map.

    Proved: every orbit of the box crosses $s = 0$ transversally at a time within `time` of the result, and for no other
    time of a window around it. The box need not lie on the section. `is_first` says whether there is no such crossing
    before.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> box = lp.proofs.Box.around([0, 0.1, 0.3, 0.1], [0, 1e-6, 1e-6, 1e-6])
        >>> found = lp.proofs.enclose_section_map(system, box, surface="x", direction=1)
        >>> found.is_first, bool(found.image.width.max() < 1e-4)
        (True, True)

    Args:
        system: A system whose equations are polynomials with rational coefficients.
        box: A `Box`, a tuple of lower and upper bounds, or one state, shape (N,).
        surface: The function $s$, of degree one with rational coefficients: "alpha1", "l3 - 1/2".
        direction: +1 for a crossing where $s$ increases, -1 where it decreases, 0 for either.
        time: When the orbits cross, about; by default the first crossing of the midpoint of the box after it has left
            the section, found without proof.
        order: Order of the Taylor polynomials; by default 20, and 32 for balls.
        step: The longest step; by default only the series decide.
        time_limit: Seconds that the run may take.

    Raises:
        EnclosureError: the set has become too wide, it is not certain that every orbit crosses once and transversally
            or in which sense, no crossing was found, or the time limit has passed.
        ExpressionError: the surface is no formula.
        ParameterError: the equations or the surface are not as they must be, the box is empty, a number is
            out of range.
        ShapeError: the box has another shape.

    References: [zgliczynski2002].
    """
    field = equations(system)
    means = Means.of(arithmetic, order=order, step=step, precision=precision, time_limit=time_limit, progress=progress)
    states, section = box_of_states(box, field), _affine(system, field, surface)
    direction = as_direction(direction)
    about = positive(time, "time", _BACK) if time is not None else None
    middle = Box(states.midpoint, states.midpoint)
    if about is None:
        about = _next_crossing(field, middle, section, direction, means)
    about = _improved(field, middle, section, about, means)
    run = _section_in_balls if means.arithmetic == "balls" else _section_in_intervals
    when, image, derivative, rate, tubes = run(field, states, section, about, means)
    sign = 1 if rate[0] > 0 else -1
    if not (rate[0] > 0 or rate[1] < 0) or (direction and sign != direction):
        raise EnclosureError(
            f"the orbits cross {surface} = 0 at a rate within {interval_text(*rate)}, not in the sense of direction="
            f"{direction}; give another time or direction=0"
        )
    first = when[0] > 0 and _is_first(field, states, section, list(tubes), sign=sign, either=direction == 0)
    return SectionMapEnclosure(name_of(system), states, surface, when, image, derivative, rate, first, means.arithmetic)


def _affine(system: System | PolynomialField, field: PolynomialField, surface: object) -> Terms:
    """The terms of the function of a section.

    Raises:
        ParameterError: it is not of degree one.
    """
    from sympy import Symbol

    if not isinstance(surface, str):
        raise ParameterError(f'surface: wanted a formula such as "{field.names[0]} - 1/2"; got {shown(surface)}')
    if isinstance(system, PolynomialField):
        from liepoisson.formula.expression import read_expression
        from liepoisson.formula.scope import Scope

        expression, x = read_expression(surface, Scope(symbols=field.names)), [Symbol(name) for name in field.names]
    else:
        expression, x = system.expression(surface), system.variables
    terms = rational_terms(expression, x, "surface")
    if max((sum(m) for m in terms), default=0) != 1:
        raise ParameterError(
            f"surface: wanted a function of degree one in {', '.join(field.names)}; got {shown(surface)}; rigorous "
            "section maps are made for hyperplanes"
        )
    return terms


def _improved(field: PolynomialField, middle: Box, section: Terms, time: float, means: Means) -> float:
    """The time of the crossing of one orbit, nearer; without proof, as the crossing of the set is proved later."""
    for _ in range(3):
        try:
            when = _section_in_intervals(field, middle, section, time, means)[0]
        except EnclosureError:
            return time
        time, before = 0.5 * (when[0] + when[1]), time
        if abs(time - before) <= 1e-13 * time:
            break
    return time


def _next_crossing(field: PolynomialField, middle: Box, section: Terms, direction: int, means: Means) -> float:
    """When one orbit crosses the section next, about.

    Raises:
        EnclosureError: no crossing was found, or the time limit has passed.
    """
    speed = max((abs(_at(rate, middle)) for rate in field.rates), default=0.0) or 1.0
    length = _FIRST_STEP * max(float(np.abs(middle.midpoint).max(initial=0.0)), 1e-6) / speed
    elapsed, before, state = 0.0, None, middle
    for _ in range(_LOOKS):
        if clock.monotonic() > means.deadline:
            raise EnclosureError(
                f"no crossing of the section was found up to time {elapsed:.6g} before the time limit has passed; does "
                "the orbit of the midpoint of the box meet it? If so, give the time of the crossing, about"
            )
        try:
            found = _flow_in_intervals(field, state, length, means)
        except EnclosureError:
            length *= 0.5
            continue
        after = _at(section, following := Box(found[0].midpoint, found[0].midpoint))
        if before is not None and before * after < 0 and (not direction or after * direction > 0):
            share = before / (before - after)
            return elapsed + share * length
        state, elapsed, before = following, elapsed + length, after
        if elapsed > _MOST_TIME:
            break
        length = min(1.5 * length, _quarter(field, state))
    raise EnclosureError(
        f"no crossing of the section was found up to time {elapsed:.6g}; does the orbit of the midpoint of the box "
        "meet it? If so, give the time of the crossing, about"
    )


def _quarter(field: PolynomialField, state: Box) -> float:
    """A time in which an orbit does not turn around: 0.2 of the size of the state over its speed."""
    speed = max((abs(_at(rate, state)) for rate in field.rates), default=0.0)
    size = float(np.abs(state.midpoint).max(initial=0.0)) or 1.0
    return 0.2 * size / speed if speed else 1.0


def _at(terms: Terms, state: Box) -> float:
    """A polynomial at the middle of a box.

    Raises:
        EnclosureError: no double holds it.
    """
    try:
        return float(value_at(terms.items(), [Fraction(float(v)) for v in state.midpoint], Fraction))
    except OverflowError as error:
        raise EnclosureError("numbers beyond the range of doubles; take a smaller box or another unit") from error


_Steps = Iterator[tuple[float, float, Box]]


def _section_in_intervals(
    field: PolynomialField, box: Box, section: Terms, time: float, means: Means
) -> tuple[tuple[float, float], Box, Box, tuple[float, float], _Steps]:
    n = len(field.names)
    found = _core.enclose_section_map(
        [core_terms(rate) for rate in field.rates],
        core_terms(section),
        *around_midpoint(box),
        time,
        means.of_core(box, time),
        means.time_limit,
        means.progress,
    )

    def steps() -> _Steps:
        _, _, times, tube = _flow_in_intervals(field, box, time, means)
        for k in range(len(times.lower)):
            yield float(times.lower[k, 0]), float(times.upper[k, 1]), tube[k]

    return (
        found["time"],
        Box(found["lower"], found["upper"]),
        Box(found["derivative_lower"].reshape(n, n), found["derivative_upper"].reshape(n, n)),
        found["rate"],
        steps(),
    )


def _section_in_balls(
    field: PolynomialField, box: Box, section: Terms, time: float, means: Means
) -> tuple[tuple[float, float], Box, Box, tuple[float, float], _Steps]:
    from liepoisson.proofs.balls.field import BallField, ball, working
    from liepoisson.proofs.balls.section import Hyperplane, section_map

    n = len(field.names)
    with working(means.precision):
        unit = [tuple(int(i == k) for i in range(n)) for k in range(n)]
        normal = [ball(section.get(m, Fraction(0))) for m in unit]
        plane = Hyperplane(normal, ball(-section.get((0,) * n, Fraction(0))))
        found = section_map(BallField(field), *ball_states(box), section=plane, time=time, how=means.of_balls(time))
        return (
            pair(found.time),
            rounded(found.states, (n,)),
            rounded(found.derivative.entries(), (n, n)),
            pair(found.rate),
            iter([(pair(t.start)[0], pair(t.end)[1], rounded(t.box, (n,))) for t in found.tubes]),
        )


def _is_first(
    field: PolynomialField,
    box: Box,
    section: Terms,
    steps: list[tuple[float, float, Box]],
    *,
    sign: int,
    either: bool,
) -> bool:
    """Whether orbits of the box provably cross the section not before, after they have left the box; or in no sense."""
    from liepoisson.proofs.balls.field import BallField, working

    with working():
        evaluated = BallField(PolynomialField(field.names, (*field.rates,), {"s": section}, ()))

        def signs(of: Box) -> tuple[int, int]:
            """Those of the function and of its rate on a box; 0 where they are not certain."""
            x = [as_ball(float(a), float(b)) for a, b in zip(of.lower, of.upper, strict=True)]
            gradient = evaluated.gradients(x).tolist()[0]
            rate = sum((g * r for g, r in zip(gradient, evaluated.rates(x), strict=True)), x[0] * 0)
            return _sign(evaluated.constants(x)[0]), _sign(rate)

        known = [signs(one) for _, _, one in steps]
        begin = signs(box)
    # while the rate keeps its sign an orbit crosses once at most: at the end that is the crossing that was found
    last = len(known)
    while last and known[last - 1][1] == sign:
        last -= 1
    # at the beginning orbits leave the section, or go away from it
    first = 0
    if begin[0] in (0, begin[1]) and (begin[0] or _is_on(box, section)):
        while first < last and begin[1] and known[first][1] == begin[1]:
            first += 1
    middle = known[first:last]
    return all(side != 0 or (not either and rate == -sign) for side, rate in middle)


def _is_on(box: Box, section: Terms) -> bool:
    """Whether all states of a box lie on a hyperplane, exactly: it is a box on a plane of coordinates, or one point."""
    fixed = [a == b for a, b in zip(box.lower, box.upper, strict=True)]
    needed = [any(m[k] for m in section) for k in range(len(fixed))]
    return all(f for f, n in zip(fixed, needed, strict=True) if n) and not value_at(
        section.items(), [Fraction(float(v)) for v in box.lower]
    )


def _sign(x: arb) -> int:
    return 1 if x > 0 else -1 if x < 0 else 0
