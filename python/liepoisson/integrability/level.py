r"""Polynomials on an invariant level set $L_1 = \dots = L_r = 0$: remainders modulo the ideal that the $L_j$ generate.

The remainders modulo a Gröbner basis in a degree order are a basis of the functions on the level, and their degree is
the smallest of all polynomials that have the same values there.

References: Cox, Little and O'Shea, Ideals, Varieties, and Algorithms (2015), sections 2.6 and 5.3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from liepoisson.errors import ParameterError
from liepoisson.integrability.derivation import Derivation, Exponents, Polynomial

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.exact.linear.coefficients import Coefficients


def order(monomial: Exponents) -> tuple[int, ...]:
    """Graded reverse lexicographic order."""
    return (sum(monomial), *(-k for k in reversed(monomial)))


@dataclass(frozen=True)
class Level:
    """The level set of some polynomials, or all of phase space.

    Attributes:
        basis: A Gröbner basis of the ideal, each with its leading monomial; monic.
    """

    basis: tuple[tuple[Exponents, Polynomial], ...] = ()

    def is_standard(self, monomial: Exponents) -> bool:
        """Whether a monomial is no multiple of a leading one."""
        return not any(_divides(lead, monomial) for lead, _ in self.basis)

    def remainder(self, polynomial: Mapping[Exponents, Any], p: int = 0) -> Polynomial:
        """What is left of a polynomial modulo the ideal; all coefficients modulo the prime p, if one is given."""
        left = {m: c for m, c in polynomial.items() if c}
        if not self.basis:
            return left
        done: Polynomial = {}
        while left:
            monomial = max(left, key=order)
            divisor = next((b for b in self.basis if _divides(b[0], monomial)), None)
            if divisor is None:
                done[monomial] = left.pop(monomial)
                continue
            lead, generator = divisor
            factor, shift = left[monomial], tuple(a - b for a, b in zip(monomial, lead, strict=True))
            for m, c in generator.items():
                key = tuple(map(sum, zip(m, shift, strict=True)))
                value = left[key] - factor * c if key in left else -(factor * c)
                value = value % p if p else value
                if value:
                    left[key] = value
                else:
                    left.pop(key, None)
        return done


def level_of(derivation: Derivation, zeros: Sequence[Polynomial]) -> Level:
    """The level set on which some polynomials vanish.

    Raises:
        ParameterError: it is not invariant, or empty.
    """
    generators = [zero for zero in zeros if zero]
    if not generators:
        return Level()
    basis = generators if len(generators) == 1 else _groebner(derivation, generators)
    pairs: list[tuple[Exponents, Polynomial]] = []
    for generator in basis:
        lead = max(generator, key=order)
        inverse = derivation.field.one / generator[lead]
        pairs.append((lead, {m: c * inverse for m, c in generator.items()}))
    level = Level(tuple(pairs))
    if not all(map(any, (lead for lead, _ in pairs))):
        raise ParameterError("on: wanted a level that has points; got equations that contradict each other")
    for zero in generators:
        if level.remainder(derivation(zero)):
            raise ParameterError(
                f"on: wanted a level set that orbits do not leave; got {derivation.expression(zero)} = 0, which is not "
                "invariant. Write for example a Casimir equal to a number"
            )
    return level


def _groebner(derivation: Derivation, generators: Sequence[Polynomial]) -> list[Polynomial]:
    field: Coefficients = derivation.field
    rational = [{m: _as_rational(field.write(c)) for m, c in g.items()} for g in generators]
    if all(c is not None for g in rational for c in g.values()):  # whatever the field of the equations is
        found = _over_the_rationals(cast("list[dict[Exponents, Fraction]]", rational))
        return [{m: field.number(c) for m, c in g.items()} for g in found]
    if field.is_cyclotomic:
        raise ParameterError("on: wanted one equation, or rational coefficients; got several over a cyclotomic field")
    return _over_a_domain(derivation, generators)


def _as_rational(value: Any) -> Fraction | None:
    if isinstance(value, Fraction):
        return value
    return Fraction(int(value.p), int(value.q)) if value.is_Rational else None


def _over_the_rationals(generators: Sequence[Mapping[Exponents, Fraction]]) -> list[dict[Exponents, Fraction]]:
    from flint import fmpq

    from liepoisson.exact.polynomials.groebner import groebner_basis, rational_context
    from liepoisson.exact.polynomials.limits import NotDecidedError

    context = rational_context([f"x{k}" for k in range(len(next(iter(generators[0]))))])
    given = [context.from_dict({m: fmpq(c.numerator, c.denominator) for m, c in g.items()}) for g in generators]
    try:
        basis = groebner_basis(given)
    except NotDecidedError as error:
        raise ParameterError(
            f"on: wanted a level whose Gröbner basis is computed within the limits; {error}"
        ) from error
    return [
        {tuple(map(int, m)): Fraction(int(c.p), int(c.q)) for m, c in polynomial.terms()}
        for polynomial in basis.polynomials
    ]


def _over_a_domain(derivation: Derivation, generators: Sequence[Polynomial]) -> list[Polynomial]:
    """Over a field with irrational numbers or parameters, by SymPy."""
    from sympy import groebner

    field: Coefficients = derivation.field
    expressions: list[Expr] = [derivation.expression(g) for g in generators]
    found: Any = groebner(expressions, *derivation.variables, order="grevlex", domain=field.domain)
    return [{m: field.read(c) for m, c in polynomial.terms()} for polynomial in found.polys]


def _divides(first: Exponents, second: Exponents) -> bool:
    return all(a <= b for a, b in zip(first, second, strict=True))
