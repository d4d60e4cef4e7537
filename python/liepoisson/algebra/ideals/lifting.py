"""Rational numbers from their residues modulo primes."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping
from math import isqrt

from flint import fmpq, fmpz

from liepoisson.algebra.ideals.buchberger import Monomial
from liepoisson.algebra.residues import PRIME


def primes() -> Generator[int]:
    """Primes from `PRIME` down."""
    number = PRIME
    while True:
        if fmpz(number).is_prime():
            yield number
        number -= 2


class Residues:
    """Coefficients by monomial modulo a growing product of primes."""

    def __init__(self) -> None:
        self.modulus = 1
        self._values: dict[Monomial, int] = {}

    def add(self, residues: Mapping[Monomial, int], p: int) -> None:
        """Take residues modulo one prime more; a monomial that is missing has the coefficient zero."""
        inverse, modulus = pow(self.modulus, -1, p), self.modulus
        for monomial in self._values.keys() | residues.keys():
            old = self._values.get(monomial, 0)
            self._values[monomial] = old + modulus * ((residues.get(monomial, 0) - old) * inverse % p)
        self.modulus *= p

    def lifted(self) -> dict[Monomial, fmpq] | None:
        """The rational coefficients of small height with these residues, or None if one has none yet.

        Numerator and denominator are at most the square root of half the modulus, so there is at most one each.
        """
        found: dict[Monomial, fmpq] = {}
        bound, common = isqrt(self.modulus // 2), 1
        for monomial, value in self._values.items():
            # most coefficients of one polynomial have a common denominator
            scaled = value * common % self.modulus
            scaled -= self.modulus if scaled > self.modulus // 2 else 0
            if abs(scaled) > bound:
                fraction = _fraction(value * common % self.modulus, self.modulus, bound)
                if fraction is None:
                    return None
                scaled, denominator = fraction
                common *= denominator
            if common > bound:
                return None
            if scaled:
                found[monomial] = fmpq(scaled, common)
        return found


def _fraction(value: int, modulus: int, bound: int) -> tuple[int, int] | None:
    """Numerator and denominator of at most the bound with this residue, by Euclid's algorithm; None without any."""
    a, b, s, t = modulus, value, 0, 1
    while b > bound:
        quotient = a // b
        a, b, s, t = b, a - quotient * b, t, s - quotient * t
    if not t or abs(t) > bound:
        return None
    return (b, t) if t > 0 else (-b, -t)


def residues_of(terms: Iterable[tuple[Monomial, fmpq]], p: int) -> dict[Monomial, int] | None:
    """The coefficients modulo a prime, or None if it divides a denominator."""
    found: dict[Monomial, int] = {}
    for monomial, c in terms:
        denominator = int(c.q) % p
        if not denominator:
            return None
        found[monomial] = int(c.p) * pow(denominator, -1, p) % p
    return found
