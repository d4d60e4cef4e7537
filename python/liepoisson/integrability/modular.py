"""Polynomials modulo a prime. What is independent there is independent exactly."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.number_fields import Element
from liepoisson.algebra.residues import Residues
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.errors import ParameterError

_MOST_PRIMES = 20


def modular(polynomial: Polynomial, residues: Residues) -> Polynomial:
    """The polynomial over the field of the prime."""
    number = residues.field.number
    image = {m: number(residues(c)) for m, c in polynomial.items()}
    return {m: c for m, c in image.items() if c}


def residues_of(field: Coefficients, polynomials: Iterable[Polynomial], skipped: int = 0) -> Residues:
    """The homomorphism modulo the first prime, after some that are skipped, modulo which no coefficient vanishes.

    Raises:
        ParameterError: there is none.
    """
    values = [c for polynomial in polynomials for c in polynomial.values()]
    for attempt in range(_MOST_PRIMES):
        found = field.residues(seed=1 + attempt, skipped=attempt)
        if found is None:
            break
        if _all_nonzero(found, values):
            if not skipped:
                return found
            skipped -= 1
    raise ParameterError(
        "the coefficients have no images modulo primes, which every search begins with; give rational numbers or roots"
    )


def _all_nonzero(residues: Residues, values: Iterable[Element]) -> bool:
    try:
        return all(residues(value) for value in values)
    except (ValueError, ZeroDivisionError):  # a denominator vanishes modulo the prime
        return False


def random_point(n: int, residues: Residues, seed: int = 1) -> list[Element]:
    """Numbers of the field of the prime; the same for the same seed."""
    random = Random(seed)
    return [residues.field.number(random.randrange(1, residues.p)) for _ in range(n)]
