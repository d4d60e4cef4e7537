"""Polynomials modulo a prime: products, gradients, ranks. What is independent there is independent exactly."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from random import Random

from liepoisson.algebra.coefficients import Coefficients, Element
from liepoisson.algebra.residues import Residues
from liepoisson.errors import ParameterError
from liepoisson.integrability.derivation import Exponents, Polynomial

Modular = dict[Exponents, int]
_MOST_PRIMES = 20


def modular(polynomial: Polynomial, residues: Residues) -> Modular:
    """The polynomial with its coefficients modulo the prime."""
    image = {m: residues(c) for m, c in polynomial.items()}
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


def multiply(first: Mapping[Exponents, int], second: Mapping[Exponents, int], p: int) -> Modular:
    """The product modulo p."""
    product: Modular = {}
    for m, c in first.items():
        for k, d in second.items():
            key = tuple(map(sum, zip(m, k, strict=True)))
            product[key] = product.get(key, 0) + c * d
    return {m: v for m, c in product.items() if (v := c % p)}


def value_at(polynomial: Mapping[Exponents, int], point: Sequence[int], p: int) -> int:
    """Its value at a point."""
    total = 0
    for monomial, coefficient in polynomial.items():
        for x, k in zip(point, monomial, strict=True):
            if k:
                coefficient = coefficient * pow(x, k, p) % p  # noqa: PLW2901
        total += coefficient
    return total % p


def gradient_at(polynomial: Mapping[Exponents, int], point: Sequence[int], p: int) -> dict[int, int]:
    """Its gradient at a point, by coordinate."""
    gradient: dict[int, int] = {}
    for monomial, coefficient in polynomial.items():
        powers = [pow(x, k, p) if k else 1 for x, k in zip(point, monomial, strict=True)]
        for i, k in enumerate(monomial):
            if not k:
                continue
            term = coefficient * k * pow(point[i], k - 1, p) % p
            for j, power in enumerate(powers):
                if j != i and monomial[j]:
                    term = term * power % p
            gradient[i] = (gradient.get(i, 0) + term) % p
    return {i: v for i, v in gradient.items() if v}


def random_point(n: int, p: int, seed: int = 1) -> list[int]:
    """Coordinates modulo p; the same for the same seed."""
    random = Random(seed)
    return [random.randrange(1, p) for _ in range(n)]


class Span:
    """The span of vectors modulo p, in reduced echelon form by their largest key."""

    def __init__(self, p: int, vectors: Iterable[Mapping[Exponents, int]] = ()) -> None:
        self.p = p
        self._rows: dict[Exponents, Modular] = {}
        for vector in vectors:
            self.insert(vector)

    def __len__(self) -> int:
        return len(self._rows)

    def reduce(self, vector: Mapping[Exponents, int]) -> Modular:
        """What is left of a vector modulo the span."""
        left, p = dict(vector), self.p
        while pivots := [m for m in left if m in self._rows]:
            # rows have only smaller keys beside their pivot, which may be pivots of others
            lead = max(pivots)
            factor = left[lead]
            for m, c in self._rows[lead].items():
                value = (left.get(m, 0) - factor * c) % p
                if value:
                    left[m] = value
                else:
                    left.pop(m, None)
        return left

    def insert(self, vector: Mapping[Exponents, int]) -> bool:
        """Add a vector; False if it was in the span."""
        left = self.reduce(vector)
        if not left:
            return False
        lead = max(left)
        inverse = pow(left[lead], -1, self.p)
        self._rows[lead] = {m: c * inverse % self.p for m, c in left.items()}
        return True
