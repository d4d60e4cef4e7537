r"""Images of exact numbers modulo large primes, and rational numbers from them.

A homomorphism to the integers modulo a prime can only lower the rank of a matrix.  So ranks modulo primes are certified
lower bounds, and they cost little.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import islice
from math import isqrt
from random import Random
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.number_fields import Element, PrimeField
from liepoisson.algebra.sparse_polynomials import value_at

if TYPE_CHECKING:
    from flint import fmpq

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

    @cached_property
    def field(self) -> PrimeField:
        """The integers modulo p."""
        return PrimeField(self.p)

    @classmethod
    def of_rationals(cls, skipped: int = 0) -> Residues:
        """The rationals modulo `PRIME`, or a prime below it after some that are skipped."""
        return cls(_prime(skipped))

    @classmethod
    def of_cyclotomic(cls, order: int, skipped: int = 0) -> Residues:
        """A prime p = 1 modulo the order, and a root of unity of exactly this order."""
        from sympy import primefactors

        p = next(islice(primes((PRIME // order) * order + 1, order), skipped, None))
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
        for p in islice(primes(), 200 * (skipped + 1)):
            polynomial = nmod_poly([int(PrimeField(p).number(c)) for c in reversed(coefficients)], p)
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
            return int(self._polynomial(element.numer) / self._polynomial(element.denom))
        return int(self._constant(element))

    def _polynomial(self, polynomial: Any) -> Element:
        return value_at(polynomial.terms(), list(map(self.field.number, self.values)), self._constant)

    def _constant(self, number: Any) -> Element:
        if hasattr(number, "polynomial"):  # an algebraic number, coefficients from the constant upwards
            coefficients = number.polynomial.coeffs()
        elif hasattr(number, "to_list"):  # one of SymPy, coefficients from the highest downwards
            coefficients = reversed(number.to_list())
        else:
            return self.field.number(number)
        terms = (((k,), c) for k, c in enumerate(coefficients))
        return value_at(terms, [self.field.number(self.root)], self.field.number)


def _prime(skipped: int) -> int:
    return next(islice(primes(), skipped, None))


def primes(start: int = PRIME, step: int = 2) -> Iterator[int]:
    """Primes from a number downwards, in steps."""
    from flint import fmpz

    return (p for p in range(start, 2, -step) if fmpz(p).is_prime())


class Lift:
    """The coefficients of a vector, or of a polynomial, modulo a growing product of primes.

    References: von zur Gathen and Gerhard, Modern Computer Algebra, section 5.10 (rational reconstruction).
    """

    def __init__(self) -> None:
        self.modulus = 1
        self._values: dict[Any, int] = {}

    def add(self, residues: Mapping[Any, int], p: int) -> None:
        """Take residues modulo one prime more; a key that is missing has the coefficient zero."""
        inverse, modulus = pow(self.modulus, -1, p), self.modulus
        for key in {**self._values, **residues}:
            old = self._values.get(key, 0)
            self._values[key] = old + modulus * ((residues.get(key, 0) - old) * inverse % p)
        self.modulus *= p

    def lifted(self) -> dict[Any, fmpq] | None:
        """The rational coefficients of small height with these residues, or None if one has none yet.

        Numerator and denominator are at most the square root of half the modulus, so there is at most one each.
        """
        from flint import fmpq

        found: dict[Any, fmpq] = {}
        bound, common = isqrt(self.modulus // 2), 1
        for key, value in self._values.items():
            # most coefficients have a common denominator
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
                found[key] = fmpq(scaled, common)
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
