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
from liepoisson.proofs.certificate import CoveringCertificate
from liepoisson.proofs.margins import Margins, Rotation
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
) -> tuple[dict[str, Any], tuple[tuple[int, ...], ...]]:
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


def core_terms(terms: Terms) -> CoreTerms:
    """A polynomial as the core reads it: coefficients as text, exponents of all variables."""
    return [(str(coefficient), exponents) for exponents, coefficient in terms.items()]


def reversers(field: PolynomialField) -> Sequence[Sequence[int]]:
    """The reflections that map orbits to orbits run backward and keep all constants of motion."""
    signs = product((1, -1), repeat=len(field.names))
    return [list(s) for s in signs if field.is_kept_by(s, reverses_time=True)]
