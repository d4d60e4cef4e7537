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
from liepoisson.proofs.certificate import CoveringCertificate
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


def core_terms(terms: Terms) -> CoreTerms:
    """A polynomial as the core reads it: coefficients as text, exponents of all variables."""
    return [(str(coefficient), exponents) for exponents, coefficient in terms.items()]


def reversers(field: PolynomialField) -> Sequence[Sequence[int]]:
    """The reflections that map orbits to orbits run backward and keep all constants of motion."""
    signs = product((1, -1), repeat=len(field.names))
    return [list(s) for s in signs if field.is_kept_by(s, reverses_time=True)]
