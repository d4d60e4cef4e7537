r"""Polynomials with rational coefficients as they were written: $(l_1^2 - l_2^2)^2$ stays a square.

Most Hamiltonians, Casimirs and integrals are such polynomials.  Sums, derivatives, Poisson brackets and values of these
need no computer algebra, whose import takes longer than many an integration.  As in SymPy, equal terms are collected
and numbers multiplied out, and a product of sums stays one until it is expanded.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from math import comb
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.sparse_polynomials import multiply, of_factors

if TYPE_CHECKING:
    from liepoisson.inputs.arrays import Array

Atom: TypeAlias = "int | RationalPolynomial"
"""A coordinate by its number, or a sum in a product."""
Monomial: TypeAlias = tuple[tuple[Atom, int], ...]
"""Atoms with their powers, coordinates first and in increasing order."""
Expanded: TypeAlias = dict[tuple[int, ...], Fraction]
"""Coefficients by the sorted tuple of the numbers of the coordinates that are multiplied."""

MOST_TERMS = 2000
"""Of a polynomial that is expanded here; larger ones are left to computer algebra."""


class TooLargeError(Exception):
    """A polynomial has too many terms when it is expanded."""


class RationalPolynomial:
    """A sum of products of coordinates and of sums, with rational numbers before them.

    Args:
        terms: The numbers by monomials; those that are zero are left out.
    """

    def __init__(self, terms: Mapping[Monomial, Fraction]) -> None:
        self.terms: dict[Monomial, Fraction] = {m: c for m, c in terms.items() if c}

    @classmethod
    def coordinate(cls, number: int) -> RationalPolynomial:
        """One coordinate."""
        return cls({((number, 1),): Fraction(1)})

    @classmethod
    def constant(cls, value: Fraction) -> RationalPolynomial:
        """A number."""
        return cls({(): value})

    @classmethod
    def of(cls, expanded: Mapping[tuple[int, ...], Fraction]) -> RationalPolynomial:
        """The polynomial with these coefficients."""
        return cls({_powers(monomial): c for monomial, c in expanded.items()})

    @classmethod
    def of_powers(cls, terms: Mapping[tuple[int, ...], Fraction]) -> RationalPolynomial:
        """The polynomial with these coefficients, by the powers of all coordinates."""
        named: dict[Monomial, Fraction] = {}
        for powers, c in terms.items():
            named[tuple((k, power) for k, power in enumerate(powers) if power)] = c
        return cls(named)

    @cached_property
    def coordinates(self) -> frozenset[int]:
        """The numbers of the coordinates that occur."""
        atoms = [atom for monomial in self.terms for atom, _ in monomial]
        inner = (atom.coordinates if isinstance(atom, RationalPolynomial) else {atom} for atom in atoms)
        return frozenset().union(*inner)

    @cached_property
    def degree(self) -> int:
        """The total degree as it is written: terms that cancel when the polynomial is expanded count."""
        return max((sum(_degree(atom) * power for atom, power in monomial) for monomial in self.terms), default=0)

    @cached_property
    def written_out(self) -> tuple[int, int]:
        """At most so many terms when it is expanded, before equal ones are collected, and bits in their numbers."""
        n_terms = longest = 0
        for monomial, coefficient in self.terms.items():
            own, bits = 1, coefficient.numerator.bit_length() + coefficient.denominator.bit_length()
            for atom, power in monomial:
                if isinstance(atom, RationalPolynomial):
                    inner, inner_bits = atom.written_out
                    own, bits = own * comb(inner + power - 1, power), bits + inner_bits * power
            n_terms, longest = n_terms + own, max(longest, bits)
        return n_terms, longest

    @cached_property
    def expanded(self) -> Expanded:
        """The coefficients of all monomials.

        Raises:
            TooLargeError: there are more than `MOST_TERMS` on the way.
        """
        total: Expanded = {}
        for monomial, coefficient in self.terms.items():
            product: Expanded = {(): coefficient}
            for atom, power in monomial:
                factor = atom.expanded if isinstance(atom, RationalPolynomial) else {(atom,): Fraction(1)}
                for _ in range(power):
                    product = multiplied(product, factor)
            for key, value in product.items():
                total[key] = total.get(key, Fraction(0)) + value
        return {key: value for key, value in total.items() if value}

    def derivative(self, number: int) -> RationalPolynomial:
        """The derivative by a coordinate."""
        if number not in self.coordinates:
            return ZERO
        found: list[RationalPolynomial] = []
        for monomial, coefficient in self.terms.items():
            for place, (atom, power) in enumerate(monomial):
                inner = atom.derivative(number) if isinstance(atom, RationalPolynomial) else (atom == number)
                if not inner:
                    continue
                lower = ((atom, power - 1),) if power > 1 else ()
                rest = RationalPolynomial({(*monomial[:place], *lower, *monomial[place + 1 :]): Fraction(1)})
                found.append(product_of([coefficient * power, rest, *([] if inner is True else [inner])]))
        return sum_of(found)

    def __add__(self, other: object) -> RationalPolynomial:
        return sum_of([self, other]) if isinstance(other, _SCALARS) else NotImplemented

    __radd__ = __add__

    def __sub__(self, other: object) -> RationalPolynomial:
        return sum_of([self, -other]) if isinstance(other, _SCALARS) else NotImplemented

    def __neg__(self) -> RationalPolynomial:
        return product_of([Fraction(-1), self])

    def __mul__(self, other: object) -> RationalPolynomial:
        return product_of([self, other]) if isinstance(other, _SCALARS) else NotImplemented

    __rmul__ = __mul__

    def __truediv__(self, divisor: Fraction) -> RationalPolynomial:
        return product_of([self, 1 / divisor])

    def __pow__(self, exponent: int) -> RationalPolynomial:
        return power_of(self, exponent)

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, RationalPolynomial):
            return self.terms == other.terms
        return self.terms == ({(): Fraction(other)} if other else {}) if isinstance(other, (int, Fraction)) else False

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash(frozenset(self.terms.items()))

    @cached_property
    def monomials_in_order(self) -> list[Monomial]:
        """In an order that depends on the numbers of the coordinates, not on how they were called or written."""
        top = max(self.coordinates, default=-1)

        def exponents(monomial: Monomial) -> list[int]:
            powers = {atom: power for atom, power in monomial if isinstance(atom, int)}
            return [powers.get(number, 0) for number in range(top, -1, -1)]

        return sorted(self.terms, key=exponents, reverse=True)

    @cached_property
    def _in_order(self) -> tuple[tuple[float, Monomial], ...]:
        """The terms in the order in which they are added up: that of SymPy, the last coordinates first."""
        return tuple((float(self.terms[m]), tuple(reversed(m))) for m in self.monomials_in_order)

    def value(self, columns: Sequence[Array], known: dict[RationalPolynomial, Any] | None = None) -> Any:
        """The values, with the values of the coordinates one by one.

        Args:
            columns: One array for each coordinate.
            known: The values of sums that are known already; others are added.
        """
        from liepoisson.portable.elementary import whole_power

        known = {} if known is None else known
        total: Any = None
        for coefficient, monomial in self._in_order:
            term: Any = None if coefficient in (1.0, -1.0) else coefficient
            for atom, power in monomial:
                if isinstance(atom, RationalPolynomial):
                    if atom not in known:
                        known[atom] = atom.value(columns, known)
                    base = known[atom]
                else:
                    base = columns[atom]
                factor = base if power == 1 else whole_power(base, power)
                term = factor if term is None else term * factor
            if term is None:
                term = coefficient
            elif coefficient == -1.0 and monomial:
                term = -term
            total = term if total is None else total + term
        return 0.0 if total is None else total


def values_of(polynomials: Iterable[RationalPolynomial], states: Array) -> Array:
    """The values of polynomials at states of shape (..., N), stacked along a new last axis."""
    import numpy as np

    columns, known = [states[..., k] for k in range(states.shape[-1])], dict[RationalPolynomial, Any]()
    given = list(polynomials)
    found = np.empty((*states.shape[:-1], len(given)))
    for k, p in enumerate(given):  # a constant is a single number
        found[..., k] = p.value(columns, known)
    return found


def sum_of(terms: Iterable[int | Fraction | RationalPolynomial]) -> RationalPolynomial:
    """The sum, with equal monomials collected."""
    total: dict[Monomial, Fraction] = {}
    for term in terms:
        own = term.terms if isinstance(term, RationalPolynomial) else {(): term}
        for monomial, coefficient in own.items():
            total[monomial] = total.get(monomial, Fraction(0)) + coefficient
    return RationalPolynomial(total)


def product_of(factors: Iterable[int | Fraction | RationalPolynomial]) -> RationalPolynomial:
    """The product; a number is multiplied into a single sum, and sums into each other they are not."""
    coefficient, powers = Fraction(1), dict[Atom, int]()
    for factor in factors:
        if not isinstance(factor, RationalPolynomial):
            coefficient *= factor
        elif len(factor.terms) == 1:
            ((monomial, number),) = factor.terms.items()
            coefficient *= number
            for atom, power in monomial:
                powers[atom] = powers.get(atom, 0) + power
        elif not factor:
            return ZERO
        else:
            powers[factor] = powers.get(factor, 0) + 1
    if len(powers) == 1:
        ((atom, power),) = powers.items()
        if isinstance(atom, RationalPolynomial) and power == 1:
            return RationalPolynomial({monomial: coefficient * c for monomial, c in atom.terms.items()})
    return RationalPolynomial({_sorted(powers): coefficient})


def power_of(base: RationalPolynomial, exponent: int) -> RationalPolynomial:
    """A power with a whole exponent that is not negative."""
    if exponent == 0:
        return RationalPolynomial.constant(Fraction(1))
    if len(base.terms) == 1:
        return product_of([base] * exponent)
    return base if exponent == 1 or not base else RationalPolynomial({((base, exponent),): Fraction(1)})


def _sorted(powers: Mapping[Atom, int]) -> Monomial:
    return tuple(sorted(powers.items(), key=lambda item: _place(item[0])))


def _degree(atom: Atom) -> int:
    return atom.degree if isinstance(atom, RationalPolynomial) else 1


def _place(atom: Atom) -> tuple[int, int]:
    return (0, atom) if isinstance(atom, int) else (1, hash(atom))


def _powers(monomial: Iterable[int]) -> Monomial:
    powers: dict[Atom, int] = {}
    for number in monomial:
        powers[number] = powers.get(number, 0) + 1
    return _sorted(powers)


def multiplied(first: Expanded, second: Expanded) -> Expanded:
    """The product, expanded.

    Raises:
        TooLargeError: it may have more than `MOST_TERMS` terms.
    """
    if len(first) * len(second) > MOST_TERMS:
        raise TooLargeError
    return multiply(first, second, of_factors)


def powers_of(polynomial: RationalPolynomial, n: int) -> list[tuple[tuple[int, ...], Fraction]]:
    """The terms of the expanded polynomial in n coordinates: powers and coefficients, in lexicographic order.

    Raises:
        TooLargeError: there are too many.
    """
    terms = {tuple(monomial.count(k) for k in range(n)): c for monomial, c in polynomial.expanded.items()}
    return sorted(terms.items(), reverse=True)


def expression_of(polynomial: RationalPolynomial, variables: Sequence[Any]) -> Any:
    """The expanded polynomial as a SymPy expression."""
    from sympy import Add, Mul, Rational

    terms = polynomial.expanded.items()
    return Add(*(Mul(Rational(c.numerator, c.denominator), *(variables[k] for k in m)) for m, c in terms))


def in_words(polynomial: RationalPolynomial, names: Sequence[str]) -> str:
    """The expanded polynomial as a formula, written as SymPy orders its terms and factors."""
    gens = sorted(range(len(names)), key=lambda number: names[number])
    expanded = polynomial.expanded

    def exponents(monomial: tuple[int, ...]) -> list[int]:
        return [monomial.count(number) for number in gens]

    texts = list(_terms_in_words(sorted(expanded, key=exponents, reverse=True), expanded, gens, names))
    first, *others = texts or ["0"]
    return first + "".join(f" - {text[1:]}" if text.startswith("-") else f" + {text}" for text in others)


def _terms_in_words(
    monomials: Iterable[tuple[int, ...]], terms: Expanded, gens: Sequence[int], names: Sequence[str]
) -> Iterator[str]:
    for monomial in monomials:
        coefficient = terms[monomial]
        factors = [
            names[number] + (f"^{power}" if power > 1 else "") for number in gens if (power := monomial.count(number))
        ]
        above = abs(coefficient.numerator)
        if above != 1 or not factors:
            factors.insert(0, str(above))
        below = f"/{coefficient.denominator}" if coefficient.denominator != 1 else ""
        yield ("-" if coefficient < 0 else "") + "*".join(factors) + below


_SCALARS = (int, Fraction, RationalPolynomial)
ZERO = RationalPolynomial({})
