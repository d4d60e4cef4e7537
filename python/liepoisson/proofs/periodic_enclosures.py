"""Periodic orbits of polynomial systems, proved: on a level of H and the Casimirs, by Krawczyk's operator."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from liepoisson import _core
from liepoisson.errors import EnclosureError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import shows_progress
from liepoisson.portable import linear
from liepoisson.proofs.box import Box, BoxLike, interval_text
from liepoisson.proofs.enclosures import around_midpoint
from liepoisson.proofs.equilibrium_enclosures import on_level
from liepoisson.proofs.interval_checker import core_terms
from liepoisson.proofs.polynomial_field import PolynomialField
from liepoisson.proofs.rigorous import (
    PRECISION,
    Arithmetic,
    Means,
    equations_and_constants,
    level_values,
    name_of,
    one_state,
    pair,
    positive,
    rounded,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from liepoisson.model.system import System

_REACH = 1e-3
"""How far charts reach along the gradients of the constants of motion, in units of the state."""
_PIECES = 32
_MOST_SECTIONS = 250
"""The equations of all sections are solved as one dense system: of 250 this takes a tenth of a second, of 1,000 seven
seconds, in which nobody looks at the clock."""
_REPEATS, _WORTH = 4, 0.5
"""How often a proof is made again from the orbit that it has found, as long as that halves what is not known."""
_GROWTH = 10.0
"""A section is put wherever perturbations have grown by this factor."""
_FAR = 0.1
"""An orbit that ends further from its start than this, in units of the state, is said not to close."""


@dataclass(frozen=True, eq=False)
class PeriodicOrbitEnclosure(ReadOnlyArrays):
    """A periodic orbit that was proved to exist on a level, and to be the only one there that is near.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.orbits.symmetric_periodic_orbits(system, {}, energy="1/10", n_starts=20)[0]
        >>> orbit = lp.proofs.prove_periodic_orbit(system, found.start, period=found.period, level={"H": "1/10"})
        >>> bool(orbit.multipliers_real.lower.max() > 1), bool(orbit.is_simple.all())  # proved to be hyperbolic
        (True, True)

    Attributes:
        system: The name of the system.
        level: The exact values of H and the Casimirs, by name.
        period: Bounds of the time after which it closes; a multiple of the least period, perhaps.
        states: Boxes that contain its states on each section, shape (section, N). A section is the hyperplane across
            the flow through the state from which the proof began.
        times: Bounds of the times from each section to the next.
        unique_radius: Half the width of the boxes that Newton's operator maps into themselves: in coordinates across
            the flow, the orbit is the only one of the level that crosses the sections one after the other within this
            distance of certain points, from which it is itself no further.
        derivative: A box around the derivative of the Poincaré map of the first section on the level, in coordinates
            across the flow, shape (d, d).
        multipliers_real: Boxes of the real parts of the Floquet multipliers, those of `derivative`; the trivial ones,
            of the flow, of H and of the Casimirs, are not among them.
        multipliers_imaginary: Boxes of their imaginary parts.
        is_simple: Whether a box contains one multiplier only; boxes that overlap contain as many as they are.
        arithmetic: "intervals" or "balls".
    """

    system: str
    level: Mapping[str, Fraction]
    period: tuple[float, float]
    states: Box
    times: Box
    unique_radius: float
    derivative: Box
    multipliers_real: Box
    multipliers_imaginary: Box
    is_simple: NDArray[np.bool_]
    arithmetic: Arithmetic

    def __repr__(self) -> str:
        return (
            f"<PeriodicOrbitEnclosure of {self.system!r}{on_level(self.level)}, {self.arithmetic}: period "
            f"{interval_text(*self.period)}, states known to {self.states.width.max():.2g}, alone within "
            f"{self.unique_radius:.2g}; multipliers {_numbers(self.multipliers_real, self.multipliers_imaginary)}>"
        )


def _numbers(real: Box, imaginary: Box) -> str:
    """Complex boxes as text."""
    parts: list[str] = []
    for k in range(len(real.lower)):
        text = repr(real[k])
        parts.append(text if imaginary.lower[k] == imaginary.upper[k] == 0 else f"{text} + {imaginary[k]!r}i")
    return ", ".join(parts)


@shows_progress
def prove_periodic_orbit(
    system: System | PolynomialField,
    start: BoxLike,
    *,
    period: float,
    level: Mapping[str, float | str] | None = None,
    n_sections: int | None = None,
    arithmetic: Arithmetic = "intervals",
    order: int | None = None,
    step: float | None = None,
    precision: int = PRECISION,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> PeriodicOrbitEnclosure:
    """Prove that near a state there is exactly one periodic orbit on its level, and enclose its period and multipliers.

    A periodic orbit of a conservative system is isolated only on a level of H and the Casimirs, so the proof is made
    there: sections across the flow, with coordinates in which the level is exact, and Krawczyk's operator for the maps
    from each section to the next. Orbits with a further multiplier 1, as all orbits of integrable systems with more
    than one degree of freedom have, are not isolated, and refused.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.orbits.symmetric_periodic_orbits(system, {}, energy="1/10", n_starts=20)
        >>> orbit = lp.proofs.prove_periodic_orbit(system, found[0].start, period=found[0].period, level={"H": "1/10"})
        >>> orbit.period[0] < found[0].period < orbit.period[1], bool(orbit.is_simple.all())
        (True, True)

    Args:
        system: A system whose equations, Hamiltonian and Casimirs are polynomials with rational coefficients.
        start: A state near the orbit, shape (N,), to eight digits or so.
        period: Its period, about.
        level: Exact values of H and the Casimirs, by name; by default the doubles nearest to those of `start`.
        n_sections: How many sections; by default one for each factor of ten by which perturbations grow.
        order: Order of the Taylor polynomials; by default 20, and 32 for balls.
        step: The longest step; by default only the series decide.
        time_limit: Seconds that the run may take.

    Raises:
        EnclosureError: the orbit does not close, no box is mapped into itself, the enclosures have become too wide, or
            the time limit has passed.
        ParameterError: the system is not polynomial or has symbols, its levels are curves, the level is not as it must
            be, or a number is out of range.
        ShapeError: the start has another shape.

    References: [krawczyk1969]; [galias2001].
    """
    field = equations_and_constants(system)
    means = Means.of(arithmetic, order=order, step=step, precision=precision, time_limit=time_limit, progress=progress)
    state, about = one_state(start, field, "start"), positive(period, "period", "give the time after which it closes")
    values = level_values(level, field, list(field.constants), state.tolist())
    if (d := len(field.names) - 1 - len(values)) < 1:
        raise ParameterError(
            f"system: wanted levels of H and the Casimirs of three dimensions or more; got {d + 1}: every closed "
            "curve is a periodic orbit there. Its period is the time of enclose_section_map"
        )
    count = None if n_sections is None else as_count(n_sections, "n_sections", least=1, most=_MOST_SECTIONS)
    states, gap = _sections(field, state, about, count, means)
    size = float(np.abs(state).max(initial=0.0)) or 1.0
    if not gap <= _FAR * size:
        raise EnclosureError(
            f"periodic orbit: wanted a start that its orbit comes back to after the period {about:.6g}; it ends at a "
            f"distance of {gap:.2g} from it; improve both, for example by lp.orbits.symmetric_periodic_orbits"
        )
    reach = _REACH * size / max(1.0, _steepest(field, state))
    name, chain = name_of(system), _Chain(states, [about / len(states)] * len(states), reach)
    try:
        if means.arithmetic == "intervals":
            return _repeated(name, field, values, chain, means)[0]
        with suppress(EnclosureError):
            chain = _repeated(name, field, values, chain, means)[1]
        return _in_balls(name, field, values, chain, means)
    except EnclosureError as error:
        raise EnclosureError(
            f"periodic orbit{on_level(values)}: not proved, {str(error).removeprefix('no enclosure: ')}. The orbit "
            f"of the start ends at a distance of {gap:.2g} from it. It must be isolated on its level; a nearer start "
            "or more n_sections may help"
        ) from error


@dataclass(frozen=True)
class _Chain:
    """States on an orbit, the times from each to the next, and how far charts reach."""

    states: list[Array]
    times: list[float]
    reach: float


def _repeated(
    name: str, field: PolynomialField, values: Mapping[str, Fraction], chain: _Chain, means: Means
) -> tuple[PeriodicOrbitEnclosure, _Chain]:
    """The proof in intervals, made again from where the orbit was found: that is narrower, and where balls begin.

    Raises:
        EnclosureError: there is no proof.
    """
    found = _in_intervals(name, field, values, chain, means)
    for _ in range(_REPEATS):
        # sections at the times that the orbit takes
        better = _Chain([*found.states.midpoint], found.times.midpoint.tolist(), chain.reach)
        try:
            again = _in_intervals(name, field, values, better, means)
        except EnclosureError:
            break
        if not _widths(again) < _widths(found):
            break
        is_worth_it = _widths(again) < _WORTH * _widths(found)
        found, chain = again, better
        if not is_worth_it:
            break
    return found, chain


def _widths(orbit: PeriodicOrbitEnclosure) -> float:
    """How much is not known of an orbit."""
    return float(orbit.states.width.max() + orbit.times.width.max() + orbit.derivative.width.max())


def _sections(
    field: PolynomialField, start: Array, period: float, count: int | None, means: Means
) -> tuple[list[Array], float]:
    """States at equal times along an orbit, without proof, and how far from its start it ends.

    Raises:
        EnclosureError: the orbit cannot be followed.
    """
    n, rates = len(field.names), [core_terms(rate) for rate in field.rates]

    def flown(x: Array, time: float) -> tuple[Array, Array]:
        box = Box(x, x)
        found = _core.enclose_flow(
            rates, *around_midpoint(box), time, means.of_core(box, time), False, means.time_limit, None
        )
        middle = 0.5 * (found["lower"] + found["upper"])
        return middle, 0.5 * (found["derivative_lower"] + found["derivative_upper"]).reshape(n, n)

    if count is None:
        x, growth = start, np.eye(n)
        for _ in range(_PIECES):
            x, derivative = flown(x, period / _PIECES)
            growth = linear.matmul(derivative, growth)
        factor = float(linear.norm(growth, 2))
        count = max(1, ceil(log10(max(factor, 1.0)) / log10(_GROWTH)))
    states = [start]
    for _ in range(count):
        states.append(flown(states[-1], period / count)[0])
    return states[:-1], float(np.abs(states[-1] - start).max())


def _steepest(field: PolynomialField, state: Array) -> float:
    """The largest component of a gradient of a constant of motion."""
    from liepoisson.proofs.balls.field import BallField, working

    if not field.constants:
        return 1.0
    with working():
        from flint import arb

        gradients = BallField(field).gradients([arb(float(v)) for v in state])
        return max(abs(float(e.mid())) for e in gradients.entries())


def _in_intervals(
    name: str, field: PolynomialField, values: Mapping[str, Fraction], chain: _Chain, means: Means
) -> PeriodicOrbitEnclosure:
    states, times, reach = chain.states, chain.times, chain.reach
    n, d = len(field.names), len(field.names) - 1 - len(values)
    found = _core.enclose_periodic_orbit(
        [core_terms(rate) for rate in field.rates],
        [core_terms(constant) for constant in field.constants.values()],
        [str(value) for value in values.values()],
        None,
        np.concatenate(states),
        np.array(times),
        reach,
        means.of_core(Box(np.min(states, axis=0), np.max(states, axis=0)), times[0]),
        means.time_limit,
        means.progress,
    )
    return PeriodicOrbitEnclosure(
        name,
        dict(values),
        found["period"],
        Box(found["lower"].reshape(-1, n), found["upper"].reshape(-1, n)),
        Box(found["times_lower"], found["times_upper"]),
        found["unique_radius"],
        Box(found["derivative_lower"].reshape(d, d), found["derivative_upper"].reshape(d, d)),
        Box(found["multipliers_real_lower"], found["multipliers_real_upper"]),
        Box(found["multipliers_imaginary_lower"], found["multipliers_imaginary_upper"]),
        found["multipliers_alone"],
        "intervals",
    )


def _in_balls(
    name: str, field: PolynomialField, values: Mapping[str, Fraction], chain: _Chain, means: Means
) -> PeriodicOrbitEnclosure:
    states, times, reach = chain.states, chain.times, chain.reach
    from flint import arb

    from liepoisson.proofs.balls.field import BallField, ball, working
    from liepoisson.proofs.balls.periodic import Chain
    from liepoisson.proofs.rigorous import eigenvalue_boxes

    n, d = len(field.names), len(field.names) - 1 - len(values)
    with working(means.precision):
        sections = Chain(
            BallField(field),
            [s.tolist() for s in states],
            times,
            level=[ball(v) for v in values.values()],
            reach=reach,
            how=means.of_balls(times[0]),
        )
        found = sections.prove()
        real, imaginary, simple = eigenvalue_boxes(found.derivative)
        return PeriodicOrbitEnclosure(
            name,
            dict(values),
            pair(sum(found.times, arb(0))),
            rounded([b for one in found.states for b in one], (len(states), n)),
            rounded(found.times, (len(states),)),
            found.unique_radius,
            rounded(found.derivative.entries(), (d, d)),
            real,
            imaginary,
            simple,
            "balls",
        )
