"""The check of a certificate of chaos in intervals of doubles, by the core; docs/proof.md says what is checked."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import product
from typing import TypeAlias

import numpy as np

from liepoisson import _core
from liepoisson.errors import EnclosureError
from liepoisson.proofs.certificate import CoveringCertificate, CoveringSet
from liepoisson.proofs.margins import Margins, Rotation
from liepoisson.proofs.polynomial_field import PolynomialField, Terms

LEVEL_RADIUS = Fraction(3, 10**8)
ENERGY_SHIFT = Fraction(1, 2**26)
ORDER = 20
STEP = 0.1
REACH = 1e-3
"""Greatest |w_k| in a chart."""
OFF_LEVEL = Fraction(1, 2**36)
"""Centers lie on the level up to this."""
SMALL = 0.1
"""Factor of the sets in which the periodic orbit is shown to be symmetric."""
NEAR = 0.3
"""Orbits near the middle set at times less than this from their own passage are no other passage."""
N_UNSTABLE = 2
FLOW = 2
"""Column of the flow in a frame."""
VISIT = 2.0**-5
"""No orbit comes back so soon to the section of the set that it leaves; flight times of one edge differ by less."""

CoreTerms: TypeAlias = "list[tuple[str, tuple[int, ...]]]"


def check_in_intervals(
    certificate: CoveringCertificate, field: PolynomialField, keep_going: Callable[[float], object] | None = None
) -> Margins:
    """Verify a certificate.

    Args:
        certificate: What is claimed.
        field: The equations and constants of motion.
        keep_going: Called with the fraction that is done; whatever it raises ends the check.

    Raises:
        EnclosureError: a condition fails; the message names the first one. Its attributes `check`, `set` and `edge` say
            which, and the number of the set or the edge.
    """
    started = time.perf_counter()
    if set(certificate.level) != set(field.constants):
        raise EnclosureError(
            f"the level: wanted values of {', '.join(field.constants)}; got {', '.join(certificate.level)}"
        )
    _require_level(certificate, field)
    found = _core.check_covering_relations(
        [core_terms(rate) for rate in field.rates],
        [core_terms(constant) for constant in field.constants.values()],
        [str(certificate.level[name]) for name in field.constants],
        list(certificate.symmetry),
        reversers(field),
        N_UNSTABLE,
        [s.name for s in certificate.sets],
        np.array([c for s in certificate.sets for c in s.center], float),
        np.array([e for s in certificate.sets for row in s.frame for e in row], float),
        [(e.source, e.target, e.time, e.symmetry) for e in certificate.edges],
        (str(LEVEL_RADIUS), ORDER, STEP, REACH, SMALL, NEAR, str(ENERGY_SHIFT)),
        math.inf,
        keep_going,
    )
    _require_single_visits(certificate, field, found["loop_times"])
    rotation = found["rotation"]
    if rotation is None:
        raise EnclosureError("rotation: nothing was computed")
    energy = certificate.level[next(iter(field.constants))]
    energies = (energy - ENERGY_SHIFT, energy + ENERGY_SHIFT)
    first, second = (Rotation(str(e), *angle) for e, angle in zip(energies, rotation["angles"], strict=True))
    return Margins(
        arithmetic="intervals",
        n_edges=len(certificate.edges),
        n_steps=found["n_steps"],
        level_radius=str(LEVEL_RADIUS),
        expansion=float(found["expansion"].min()),
        contraction=float(found["contraction"].max()),
        cone=float(found["cone"].min()),
        symmetric_q=found["reversal"],
        apart_from_orbit=found["apart_from_orbit"],
        apart_from_excursion=found["apart_from_excursion"],
        apart_from_image=found["apart_from_image"],
        loop_times=(found["loop_times"][0][1], found["loop_times"][1][1]),
        entropy=found["entropy"],
        discriminant=rotation["discriminant"][1],
        rotations=(first, second),
        seconds=time.perf_counter() - started,
    )


def _require_level(certificate: CoveringCertificate, field: PolynomialField) -> None:
    """Centers lie on the level, in rational numbers: a certificate is about the level that it names, not one nearby."""
    for one in certificate.sets:
        if not all(map(math.isfinite, one.center)):
            raise EnclosureError(f"form, set {one.name}: its center is not finite")
        center = [Fraction(c) for c in one.center]
        for name, constant in field.constants.items():
            found = sum(
                (
                    c * math.prod((v**e for v, e in zip(center, m, strict=True)), start=Fraction(1))
                    for m, c in constant.items()
                ),
                Fraction(0),
            )
            if not abs(found - certificate.level[name]) < OFF_LEVEL:
                raise EnclosureError(f"level, set {one.name}: its center is not on the level, {name} differs")


def _require_single_visits(
    certificate: CoveringCertificate, field: PolynomialField, loop_times: Sequence[tuple[float, float]]
) -> None:
    """An orbit visits a set once at a time, and p_a in one of its two images only: so words belong to points.

    Two points of a set that an edge takes to one point lie on one orbit, at times that differ by less than its flight
    times do, and no more than those of the loop; if n . f has no zero for so long after the set, they are one point.
    n . f is bounded in rational numbers.
    """
    if not all(upper - lower < 0.5 * VISIT for lower, upper in loop_times):
        raise EnclosureError(f"visits: the flight times of a loop differ by more than {0.5 * VISIT}")
    leaving = [e.source for e in certificate.edges]
    for number, one in enumerate(certificate.sets):
        box = _tube(one, field)
        crossing: Terms = {}
        for weight, rate in zip(_normal(one.frame), field.rates, strict=True):
            for m, c in rate.items():
                crossing[m] = crossing.get(m, Fraction(0)) + weight * c
        lower, upper = _range(crossing, box)
        if not (lower > 0 or upper < 0):
            raise EnclosureError(f"visits, set {one.name}: orbits may come back to its section within {VISIT}")
        if leaving.count(number) > 1 and all(
            sign > 0 or lower <= 0 <= upper for sign, (lower, upper) in zip(certificate.symmetry, box, strict=True)
        ):
            raise EnclosureError(f"visits, set {one.name}: it may meet its image under the symmetry")


def _tube(one: CoveringSet, field: PolynomialField) -> list[tuple[Fraction, Fraction]]:
    """A box that contains a set, with all |w_k| up to the reach of its chart, and its orbits until they are away."""
    extent = np.array([REACH] * len(field.names))
    extent[: len(field.names) - len(field.constants)] = 1.0
    extent[FLOW] = 0.0
    rates, center, frame = [core_terms(rate) for rate in field.rates], np.array(one.center), np.array(one.frame).ravel()
    one_step = (ORDER, VISIT, None, 1)
    found = _core.enclose_flow(rates, center, frame, -extent, extent, VISIT, one_step, True, math.inf, None)
    lower, upper = (found.get(side, np.array([])).ravel().tolist() for side in ("tube_lower", "tube_upper"))
    if len(lower) != len(field.names):
        raise EnclosureError(f"visits, set {one.name}: wanted one step of {VISIT}")
    return [(Fraction(a), Fraction(b)) for a, b in zip(lower, upper, strict=True)]


def _normal(frame: Sequence[Sequence[float]]) -> list[Fraction]:
    """The covector that is 1 on the flow column and 0 on all others, exactly, by Gauss–Jordan elimination."""
    n = len(frame)
    rows = [[*(Fraction(frame[i][k]) for i in range(n)), Fraction(k == FLOW)] for k in range(n)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [e / rows[k][k] for e in rows[k]]
        for i in range(n):
            if i != k and rows[i][k]:
                factor = rows[i][k]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k], strict=True)]
    return [row[-1] for row in rows]


def _range(terms: Terms, box: Sequence[tuple[Fraction, Fraction]]) -> tuple[Fraction, Fraction]:
    """Bounds of a polynomial on a box."""
    total = (Fraction(0), Fraction(0))
    for m, c in terms.items():
        product_ = (c, c)
        for sides, exponent in zip(box, m, strict=True):
            for _ in range(exponent):
                corners = [a * b for a in product_ for b in sides]
                product_ = (min(corners), max(corners))
        total = (total[0] + product_[0], total[1] + product_[1])
    return total


def core_terms(terms: Terms) -> CoreTerms:
    """A polynomial as the core reads it: coefficients as text, exponents of all variables."""
    return [(str(coefficient), exponents) for exponents, coefficient in terms.items()]


def reversers(field: PolynomialField) -> Sequence[Sequence[int]]:
    """The reflections that map orbits to orbits run backward and keep all constants of motion."""
    signs = product((1, -1), repeat=len(field.names))
    return [list(s) for s in signs if field.is_kept_by(s, reverses_time=True)]
