r"""Images of exact numbers modulo large primes.

A homomorphism to the integers modulo a prime can only lower the rank of a matrix.  So ranks modulo primes are certified
lower bounds, and they cost little.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from random import Random
from typing import Any

PRIME = 2**61 - 1 if sys.maxsize > 2**32 else 2**31 - 1
"""A Mersenne prime that fits a word of FLINT: of 64 bits, or of 32 in a browser's Python (WebAssembly).

With it, ranks and null spaces are guessed before they are proved.
"""


@dataclass(frozen=True)
class Residues:
    """A homomorphism of a field to the integers modulo p, defined where denominators do not vanish.

    Attributes:
        p: The prime.
        root: Image of the generator of a number field.
        values: Images of the parameters.
    """

    p: int
    root: int = 0
    values: tuple[int, ...] = ()

    @classmethod
    def of_rationals(cls, skipped: int = 0) -> Residues:
        """The rationals modulo `PRIME`, or a prime below it after some that are skipped."""
        return cls(_prime(skipped))

    @classmethod
    def of_cyclotomic(cls, order: int, skipped: int = 0) -> Residues:
        """A prime p = 1 modulo the order, and a root of unity of exactly this order."""
        from sympy import primefactors

        p = next(islice(_probable_primes((PRIME // order) * order + 1, order), skipped, None))
        powers = (pow(g, (p - 1) // order, p) for g in range(2, 1000))
        root = next(z for z in powers if all(pow(z, order // q, p) != 1 for q in primefactors(order)))
        return cls(p, root)

    @classmethod
    def of_domain(cls, domain: Any, seed: int, skipped: int = 0) -> Residues | None:
        """Parameters go to random residues; None for SymPy domains that only simplify expressions."""
        values: tuple[int, ...] = ()
        if domain.is_FractionField:
            random = Random(seed)
            values = tuple(random.randrange(2, PRIME) for _ in domain.symbols)
            domain = domain.domain
        if domain.is_Algebraic:
            return cls.of_number_field(domain, values, skipped)
        return cls(_prime(skipped), values=values) if domain.is_QQ or domain.is_ZZ else None

    @classmethod
    def of_number_field(cls, domain: Any, values: tuple[int, ...], skipped: int = 0) -> Residues | None:
        """A prime modulo which the defining polynomial of the number field has a simple root."""
        from flint import nmod_poly

        coefficients = [Fraction(int(c.numerator), int(c.denominator)) for c in domain.mod.to_list()]
        for p in islice(_probable_primes(PRIME, 2), 200 * (skipped + 1)):
            polynomial = nmod_poly([_residue(c, p) for c in reversed(coefficients)], p)
            roots = [f for f, multiplicity in polynomial.factor()[1] if f.degree() == 1 and multiplicity == 1]
            if roots and not skipped:
                return cls(p, int(-roots[0][0] / roots[0][1]), values)
            skipped -= bool(roots)
        return None

    def __call__(self, element: Any) -> int:
        """The image of an element.

        Raises:
            ZeroDivisionError: a denominator vanishes modulo p.
        """
        if hasattr(element, "numer") and hasattr(element, "denom"):  # a rational function
            denominator = self._polynomial(element.denom)
            if not denominator:
                raise ZeroDivisionError
            return self._polynomial(element.numer) * pow(denominator, -1, self.p) % self.p
        return self._constant(element)

    def _polynomial(self, polynomial: Any) -> int:
        total = 0
        for powers, coefficient in polynomial.terms():
            term = self._constant(coefficient)
            for value, power in zip(self.values, powers, strict=True):
                term = term * pow(value, power, self.p) % self.p
            total += term
        return total % self.p

    def _constant(self, number: Any) -> int:
        if hasattr(number, "polynomial"):  # cyclotomic, coefficients from the constant upwards
            return self._horner(reversed(number.polynomial.coeffs()))
        if hasattr(number, "to_list"):  # an algebraic number, coefficients from the highest downwards
            return self._horner(number.to_list())
        return _residue(number, self.p)

    def _horner(self, coefficients: Iterable[Any]) -> int:
        value = 0
        for coefficient in coefficients:
            value = (value * self.root + _residue(coefficient, self.p)) % self.p
        return value


def _residue(number: Any, p: int) -> int:
    if hasattr(number, "numerator"):
        return int(number.numerator) * pow(int(number.denominator), -1, p) % p
    if hasattr(number, "p") and hasattr(number, "q"):
        return int(number.p) * pow(int(number.q), -1, p) % p
    return int(number) % p


def _prime(skipped: int) -> int:
    return PRIME if not skipped else next(islice(_probable_primes(PRIME, 2), skipped, None))


def _probable_primes(start: int, step: int) -> Iterable[int]:
    from flint import fmpz

    return (p for p in range(start, 2, -step) if fmpz(p).is_probable_prime())
