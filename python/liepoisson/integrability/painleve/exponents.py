r"""Kovalevskaya exponents: the eigenvalues of the matrix K of a balance, exactly.

The characteristic polynomial has coefficients in the field of the balance.  Written in a basis over $\mathbb Q$, it is
a sum of basis elements times polynomials with rational coefficients; a rational number is a root if and only if it is
one of all these, with the multiplicity that it has in their greatest common divisor G.  So rational exponents are the
linear factors of G, and all others are proved to be irrational.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from re import sub
from typing import Any, cast

from flint import acb, acb_poly, fmpq_poly

from liepoisson.algebra.function_fields import (
    AlgebraicFunctions,
    AlgebraicNumbers,
    FunctionField,
    RationalFunctions,
    polynomial_gcd,
    polynomial_quotient,
)
from liepoisson.algebra.ideals.certified_roots import ball, evaluate, precision
from liepoisson.algebra.number_fields import Element

_BITS = (128, 256, 512, 1024, 2048)


@dataclass(frozen=True)
class Exponents:
    """The exponents of a balance.

    Attributes:
        rational: The rational ones with their multiplicities, in increasing order.
        over_rationals: Irreducible polynomials over the rational numbers, of degree two or more, with multiplicities,
            whose roots are exponents, too.
        rest: The coefficients, by powers, of the polynomial whose roots are the others; it has no rational roots. (1,)
            if there are no others.
        field: The field of the balance.
    """

    rational: tuple[tuple[Fraction, int], ...]
    over_rationals: tuple[tuple[fmpq_poly, int], ...]
    rest: tuple[Element, ...]
    field: FunctionField

    @property
    def all_rational(self) -> bool:
        """Whether all exponents are rational numbers."""
        return not self.over_rationals and len(self.rest) == 1

    @property
    def are_integers(self) -> bool:
        """Whether all exponents are integers."""
        return self.all_rational and all(r.denominator == 1 for r, _ in self.rational)

    def multiplicity(self, r: Fraction | int) -> int:
        """How often a rational number occurs."""
        return dict(self.rational).get(Fraction(r), 0)

    @cached_property
    def others(self) -> tuple[acb, ...]:
        """The other exponents as balls, of all conjugates of the balance; empty where they depend on parameters."""
        found: list[acb] = []
        for p, k in self.over_rationals:
            with precision(_BITS[0]):
                found += [root for root in _roots(p) for _ in range(k)]
        if len(self.rest) > 1:
            found += self._roots_of_rest()
        return tuple(found)

    def _roots_of_rest(self) -> list[acb]:
        if isinstance(self.field, RationalFunctions | AlgebraicFunctions):
            return []
        field = self.field
        slope = [c * field.number(k) for k, c in enumerate(self.rest)][1:]
        common = polynomial_gcd(self.rest, slope, field)
        squarefree = polynomial_quotient(self.rest, common, field)[0]
        for bits in _BITS:
            with precision(bits):
                try:
                    found: list[acb] = []
                    for theta in _embeddings(field):
                        coefficients = [_at(c, theta) for c in squarefree]
                        while coefficients[-1] == 0:
                            coefficients.pop()
                        found += acb_poly(coefficients).roots()
                except ValueError:  # FLINT's, where roots are not isolated
                    continue
                return found
        return []

    def __str__(self) -> str:
        parts = [str(r) for r, k in self.rational for _ in range(k)]
        for p, k in self.over_rationals:
            with precision(_BITS[0]):
                roots = ", ".join(shown_number(z) for z in _roots(p))
            parts += [f"the roots of {_readable(str(p).replace('x', 'r'))} ({roots})"] * k
        if len(self.rest) > 1:
            degree = len(self.rest) - 1
            if isinstance(self.field, AlgebraicNumbers):
                shown = ", ".join(shown_number(z) for z in self.others[-degree * self.field.degree :][:degree])
                parts.append(f"{degree} that are irrational, for one conjugate {shown}")
            else:
                parts.append(self._depending())
        return ", ".join(parts)

    def _depending(self) -> str:
        """The exponents that depend on parameters."""
        degree = len(self.rest) - 1
        if degree == 1:
            return self._explained(self.field.text(-self.rest[0] * self.field.inverse(self.rest[1])))
        lead = self.field.inverse(self.rest[-1])
        monic = [c * lead for c in self.rest]
        terms: list[str] = []
        for k in range(degree, -1, -1):
            if monic[k]:
                power = f"r^{k}" if k > 1 else "r" if k else ""
                text = self.field.text(monic[k])
                simple = text if text.isalnum() or not power else f"({text})"
                terms.append(power if text == "1" and power else f"{simple}*{power}" if power else text)
        return self._explained(f"the roots of {_readable(' + '.join(terms))}")

    def _explained(self, text: str) -> str:
        """A text, with the equation of theta if it occurs."""
        return f"{text}, where {self.field.generator}" if "theta" in text else text


def _readable(polynomial: str) -> str:
    """A polynomial with minus signs for negative numbers."""
    return sub(r"\+ \((-[\d/]+)\)", r"+ \1", polynomial).replace("+ -", "- ")


def exponents_of(characteristic: Sequence[Element], field: FunctionField) -> Exponents:
    """The exponents of a characteristic polynomial, given by powers."""
    rows = field.rational_parts(characteristic)
    common = fmpq_poly()
    for row in rows:
        common = common.gcd(fmpq_poly(row))
    rational: dict[Fraction, int] = {}
    others: list[tuple[fmpq_poly, int]] = []
    for factor, k in common.factor()[1]:
        p = fmpq_poly(factor)
        if p.degree() == 1:
            root = -p[0] / p[1]
            rational[Fraction(int(root.p), int(root.q))] = int(k)
        elif p.degree() > 1:
            others.append((p, int(k)))
    divisor = [field.number(c) for c in common.coeffs()]
    rest, _ = polynomial_quotient(characteristic, divisor, field)
    while len(rest) > 1 and not rest[-1]:
        rest.pop()
    return Exponents(tuple(sorted(rational.items())), tuple(others), tuple(rest), field)


def _roots(p: fmpq_poly) -> list[acb]:
    return [root for root, _ in cast("list[tuple[acb, int]]", p.complex_roots())]


def _embeddings(field: FunctionField) -> list[acb]:
    if isinstance(field, AlgebraicNumbers):
        return _roots(field.modulus)
    return [acb(0)]


def _at(element: Element, theta: acb) -> acb:
    polynomial: Any = getattr(element, "polynomial", None)
    return acb(ball(element)) if polynomial is None else evaluate(polynomial, theta)


def shown_number(z: acb) -> str:
    """A number with ten digits, which its ball proves."""
    real, imaginary = float(z.real.mid()), float(z.imag.mid())
    if abs(imaginary) <= float(z.imag.rad()):
        return f"{real:.10g}"
    if abs(real) <= float(z.real.rad()):
        return f"{imaginary:.10g}i"
    return f"{real:.10g}{imaginary:+.10g}i"
