"""The search for integrals at one point of a grid of parameters, from plain data that other processes can read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.sparse_polynomials import Polynomial, value_at
from liepoisson.integrability.derivation import Derivation, Exponents
from liepoisson.integrability.gradings import Grading
from liepoisson.integrability.level import Level
from liepoisson.integrability.monomials import of_degree
from liepoisson.integrability.polynomial_integrals import tidied
from liepoisson.integrability.search import Generator, Search

if TYPE_CHECKING:
    from liepoisson.integrability.parameter_cases import Poly

OUTCOMES = ("finished", "not proved", "no system", "failed", "time limit")
"""What becomes of a point: counted and proved; counted, but there may be more; a denominator vanishes; its process
ended; not computed."""

Terms: TypeAlias = "tuple[tuple[Exponents, Fraction], ...]"
"""A polynomial in the parameters."""
Family: TypeAlias = "dict[Exponents, Terms]"
"""A polynomial in the coordinates whose coefficients are polynomials in the parameters."""


@dataclass(frozen=True)
class PointResult:
    """What was found at a point.

    Attributes:
        outcome: One of `OUTCOMES`.
        n_further: Number of integrals that are functionally independent of the known ones and of each other.
        found: All that are no polynomials in the known ones, lowest degree first.
    """

    outcome: str
    n_further: int = -1
    found: tuple[Polynomial, ...] = ()


@dataclass(frozen=True)
class PointSearch:
    """A search whose coefficients are polynomials in the parameters.

    Attributes:
        n: Number of coordinates.
        degree: The largest degree of the integrals.
        gradings: The gradings for all values of the parameters.
        components: The equations of motion, without denominators.
        denominator: What they were multiplied by.
        zeros: The functions that vanish on the level.
        basis: A Gröbner basis of these, each with its leading monomial.
        known: The integrals that are known, by name; remainders on the level.
    """

    n: int
    degree: int
    gradings: tuple[Grading, ...]
    components: tuple[Family, ...]
    denominator: Terms
    zeros: tuple[Family, ...]
    basis: tuple[tuple[Exponents, Family], ...]
    known: tuple[tuple[str, Family], ...]

    def at(self, values: Sequence[Fraction]) -> PointResult:
        """Search at some values of the parameters."""
        if not value_at(self.denominator, values):
            return PointResult("no system")
        names: Any = tuple(range(self.n))  # of the coordinates, which nothing here prints
        derivation = Derivation(names, tuple(_at(part, values) for part in self.components), Coefficients())
        known = ((name, _at(function, values)) for name, function in self.known)
        search = Search(
            derivation,
            self.gradings,
            Level(tuple((lead, _at(generator, values)) for lead, generator in self.basis)),
            tuple(zero for part in self.zeros if (zero := _at(part, values))),
            [Generator(name, polynomial, is_new=False) for name, polynomial in known if any(map(any, polynomial))],
        )
        search.run(chain.from_iterable(of_degree(self.n, k) for k in range(1, self.degree + 1)))
        new = [g for g in search.generators if g.is_new]
        is_proved = all(count.nullity == count.n_known for count in search.counts)
        return PointResult(
            "finished" if is_proved else "not proved",
            sum(g.is_independent for g in new),
            tuple(tidied(g.polynomial) for g in new),
        )


def plain(polynomial: Poly) -> Terms:
    """The terms of a polynomial of flint."""
    return tuple((tuple(map(int, m)), Fraction(int(c.p), int(c.q))) for m, c in polynomial.terms())


def plain_family(family: Mapping[Exponents, Poly]) -> Family:
    """A polynomial in the coordinates as plain data."""
    return {m: plain(c) for m, c in family.items()}


def _at(family: Family, values: Sequence[Fraction]) -> Polynomial:
    return {m: value for m, terms in family.items() if (value := value_at(terms, values))}
