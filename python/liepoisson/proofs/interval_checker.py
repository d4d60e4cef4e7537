"""The check of a certificate of chaos in intervals of doubles, by the core; docs/proof.md says what is checked."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import product
from typing import Any, TypeAlias

import numpy as np

from liepoisson import _core
from liepoisson.errors import EnclosureError
from liepoisson.proofs.certificate import CoveringCertificate, CoveringSet, Margins, Rotation
from liepoisson.proofs.polynomial_field import PolynomialField, Terms

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
COMPLEX = 2
"""Number of unstable multipliers that may be complex, and whose angle is looked at."""
_OF_MULTIPLIERS = ("multipliers", "rotation")
"""Checks on which only the theorem on integrals depends."""
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
    if not certificate.level_radius > 0:
        raise EnclosureError(f"form: wanted a positive radius of the ball of levels; got {certificate.level_radius}")
    n_unstable = _n_unstable(certificate, field)
    _require_level(certificate, field)
    shift, undecided = (energy_shift(certificate.level_radius) if n_unstable == COMPLEX else None), ""
    try:
        found, symmetric = _checked(certificate, field, n_unstable, shift, keep_going)
    except EnclosureError as error:
        if shift is None or getattr(error, "check", None) not in _OF_MULTIPLIERS:
            raise
        undecided = str(error)
        found, symmetric = _checked(certificate, field, n_unstable, None, keep_going)
    _require_single_visits(certificate, field, found["loop_times"])
    rotation, energy = found["rotation"], certificate.level[next(iter(field.constants))]
    return Margins(
        arithmetic="intervals",
        n_unstable=n_unstable,
        n_edges=len(certificate.edges),
        n_steps=found["n_steps"],
        level_radius=str(certificate.level_radius),
        expansion=float(found["expansion"].min()),
        contraction=float(found["contraction"].max()),
        cone=float(found["cone"].min()),
        reversers=symmetric,
        symmetric_q=found["reversal"],
        apart_from_orbit=found["apart_from_orbit"],
        apart_from_excursion=found["apart_from_excursion"],
        apart_from_image=found["apart_from_image"],
        loop_times=(found["loop_times"][0][1], found["loop_times"][1][1]),
        entropy=found["entropy"],
        discriminant=None if rotation is None else rotation["discriminant"][1],
        rotations=None if rotation is None or shift is None else _rotations(energy, shift, rotation["angles"]),
        undecided=undecided,
        seconds=time.perf_counter() - started,
    )


def _n_unstable(certificate: CoveringCertificate, field: PolynomialField) -> int:
    """Half of the dimension of a section in a level.

    Raises:
        EnclosureError: there is no such half, or the certificate has another number of coordinates.
    """
    if len(certificate.symmetry) != len(field.names):
        raise EnclosureError(
            f"form: wanted a sign of the symmetry for each of {len(field.names)} coordinates; got "
            f"{len(certificate.symmetry)}"
        )
    dimension = len(field.names) - 1 - len(field.constants)
    if dimension not in (2, 2 * COMPLEX):
        raise EnclosureError(
            f"the system: wanted sections of dimension 2 or 4 in a level; got {dimension}, of {len(field.names)} "
            f"coordinates and {len(field.constants)} constants of motion"
        )
    return dimension // 2


def _checked(
    certificate: CoveringCertificate,
    field: PolynomialField,
    n_unstable: int,
    shift: Fraction | None,
    keep_going: Callable[[float], object] | None,
) -> tuple[Any, tuple[tuple[int, ...], ...]]:
    """What the core has verified, and the reversers that map the periodic orbit to itself.

    The core asks for all reversers that it is given. Two that differ by the symmetry belong together; of several such
    pairs one is enough.
    """
    first_refusal: EnclosureError | None = None
    for pair in _pairs(reversers(field), certificate.symmetry):
        try:
            found = _core.check_covering_relations(
                [core_terms(rate) for rate in field.rates],
                [core_terms(constant) for constant in field.constants.values()],
                [str(certificate.level[name]) for name in field.constants],
                list(certificate.symmetry),
                pair,
                n_unstable,
                [s.name for s in certificate.sets],
                np.array([c for s in certificate.sets for c in s.center], float),
                np.array([e for s in certificate.sets for row in s.frame for e in row], float),
                [(e.source, e.target, e.time, e.symmetry) for e in certificate.edges],
                (str(certificate.level_radius), ORDER, STEP, REACH, SMALL, NEAR, None if shift is None else str(shift)),
                math.inf,
                keep_going,
            )
        except EnclosureError as error:
            if getattr(error, "check", None) != "reversal":
                raise
            first_refusal = first_refusal or error
        else:
            return found, tuple(map(tuple, pair))
    raise first_refusal or EnclosureError("reversers: wanted a change of signs that reverses time; there is none")


def _pairs(found: Sequence[Sequence[int]], symmetry: Sequence[int]) -> list[list[list[int]]]:
    """Reversers with their products with the symmetry."""
    pairs: list[list[list[int]]] = []
    for signs in found:
        if not any(list(signs) in pair for pair in pairs):
            pairs.append([list(signs), [a * b for a, b in zip(signs, symmetry, strict=True)]])
    return pairs


def energy_shift(level_radius: Fraction) -> Fraction:
    """By how much the energies differ of the two levels whose angles are compared: a power of two, within the ball."""
    shift = Fraction(1)
    while shift > level_radius / 2:
        shift /= 2
    return shift


def _rotations(energy: Fraction, shift: Fraction, angles: Sequence[tuple[float, float]]) -> tuple[Rotation, Rotation]:
    energies = (energy - shift, energy + shift)
    first, second = (Rotation(str(e), *angle) for e, angle in zip(energies, angles, strict=True))
    return first, second


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
    flow = (len(field.names) - 1 - len(field.constants)) // 2
    for number, one in enumerate(certificate.sets):
        box = _tube(one, field, flow)
        crossing: Terms = {}
        for weight, rate in zip(_normal(one.frame, flow), field.rates, strict=True):
            for m, c in rate.items():
                crossing[m] = crossing.get(m, Fraction(0)) + weight * c
        lower, upper = _range(crossing, box)
        if not (lower > 0 or upper < 0):
            raise EnclosureError(f"visits, set {one.name}: orbits may come back to its section within {VISIT}")
        if leaving.count(number) > 1 and all(
            sign > 0 or lower <= 0 <= upper for sign, (lower, upper) in zip(certificate.symmetry, box, strict=True)
        ):
            raise EnclosureError(f"visits, set {one.name}: it may meet its image under the symmetry")


def _tube(one: CoveringSet, field: PolynomialField, flow: int) -> list[tuple[Fraction, Fraction]]:
    """A box that contains a set, with all |w_k| up to the reach of its chart, and its orbits until they are away."""
    extent = np.array([REACH] * len(field.names))
    extent[: len(field.names) - len(field.constants)] = 1.0
    extent[flow] = 0.0
    rates, center, frame = [core_terms(rate) for rate in field.rates], np.array(one.center), np.array(one.frame).ravel()
    one_step = (ORDER, VISIT, None, 1)
    found = _core.enclose_flow(rates, center, frame, -extent, extent, VISIT, one_step, True, math.inf, None)
    lower, upper = (found.get(side, np.array([])).ravel().tolist() for side in ("tube_lower", "tube_upper"))
    if len(lower) != len(field.names):
        raise EnclosureError(f"visits, set {one.name}: wanted one step of {VISIT}")
    return [(Fraction(a), Fraction(b)) for a, b in zip(lower, upper, strict=True)]


def _normal(frame: Sequence[Sequence[float]], flow: int) -> list[Fraction]:
    """The covector that is 1 on the column of the flow and 0 on all others, exactly, by Gauss–Jordan elimination."""
    n = len(frame)
    rows = [[*(Fraction(frame[i][k]) for i in range(n)), Fraction(k == flow)] for k in range(n)]
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
