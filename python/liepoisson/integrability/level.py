r"""Polynomials on an invariant level set $L_1 = \dots = L_r = 0$: remainders modulo the ideal that the $L_j$ generate.

The remainders modulo a Gröbner basis in a degree order are a basis of the functions on the level, and their degree is
the smallest of all polynomials that have the same values there.

A function vanishes on the level where some power of it is in the ideal.  One equation is replaced by its squarefree
part, which generates all functions that vanish on the complex level (Hilbert's Nullstellensatz).  Of several equations
each is; the ideal of all may still be smaller than that of the functions that vanish.

References: Cox, Little and O'Shea, Ideals, Varieties, and Algorithms (2015), sections 2.6 and 5.3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.coefficients import check_degree
from liepoisson.algebra.number_fields import as_fmpq
from liepoisson.algebra.sparse_polynomials import Polynomial, divides, of_exponents
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.integrability.derivation import Derivation, Exponents
from liepoisson.report.printing import Formula

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.algebra.coefficients import Coefficients


def order(monomial: Exponents) -> tuple[int, ...]:
    """Graded reverse lexicographic order."""
    return (sum(monomial), *(-k for k in reversed(monomial)))


@dataclass(frozen=True)
class Level:
    """The level set of some polynomials, or all of phase space."""

    # a Gröbner basis of the ideal, each with its leading monomial; monic
    basis: tuple[tuple[Exponents, Polynomial], ...] = ()

    def is_standard(self, monomial: Exponents) -> bool:
        """Whether a monomial is no multiple of a leading one."""
        return not any(divides(lead, monomial) for lead, _ in self.basis)

    def remainder(self, polynomial: Mapping[Exponents, Any]) -> Polynomial:
        """What is left of a polynomial modulo the ideal."""
        left = {m: c for m, c in polynomial.items() if c}
        if not self.basis:
            return left
        done: Polynomial = {}
        while left:
            checkpoint("a remainder on a level")
            monomial = max(left, key=order)
            divisor = next((b for b in self.basis if divides(b[0], monomial)), None)
            if divisor is None:
                done[monomial] = left.pop(monomial)
                continue
            lead, generator = divisor
            factor, shift = left[monomial], tuple(a - b for a, b in zip(monomial, lead, strict=True))
            for m, c in generator.items():
                key = of_exponents(m, shift)
                value = left[key] - factor * c if key in left else -(factor * c)
                if value:
                    left[key] = value
                else:
                    left.pop(key, None)
        return done


def squarefree(function: Any, variables: Sequence[Symbol]) -> Any:
    """A polynomial without repeated factors that vanishes where the given one does: itself if it has none."""
    from sympy import Dummy, Poly, PolynomialError

    if not function.is_polynomial(*variables):
        return function
    check_degree([function])
    random, t = Random(1), Dummy("t")
    line = {x: random.randint(-99, 99) + random.randint(1, 99) * t for x in variables}
    try:
        polynomial: Any = Poly(function, *variables, extension=True)
        on_line: Any = Poly(function.xreplace(line), t, extension=True)
        # a square would be one on each line, if its degree does not drop there
        if on_line.degree() < polynomial.total_degree() or not on_line.is_sqf:
            part = polynomial.sqf_part()
            return function if part.total_degree() == polynomial.total_degree() else part.as_expr()
    except (PolynomialError, NotImplementedError):  # coefficients in no field, which is refused later
        return function
    return function


def real_points(function: Any, variables: Sequence[Symbol]) -> tuple[Symbol, ...] | None:
    """The coordinates that vanish at all real zeros of a sum of squares, as C2 = |alpha|^2 is one; None for others."""
    from sympy import Poly

    if not function.is_polynomial(*variables):
        return None
    terms = cast("Any", Poly(function, *variables)).terms()
    even = all(k % 2 == 0 for m, _ in terms for k in m)
    if not even or not (all(c.is_positive for _, c in terms) or all(c.is_negative for _, c in terms)):
        return None
    if any(not any(m) for m, _ in terms):
        raise ParameterError(
            f"on: wanted a level with real points; got {Formula(function).plain} = 0, a sum of squares and "
            "a number of the same sign"
        )
    alone = [[x for x, k in zip(variables, m, strict=True) if k] for m, _ in terms]
    return tuple(dict.fromkeys(x for factors in alone if len(factors) == 1 for x in factors)) or None


def level_of(derivation: Derivation, zeros: Sequence[Polynomial]) -> Level:
    """The level set on which some polynomials vanish."""
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
                "invariant. Write a constant of the motion equal to a number, such as H = 1"
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

    from liepoisson.algebra.ideals.groebner import groebner_basis, rational_context
    from liepoisson.algebra.ideals.limits import NotDecidedError

    context = rational_context([f"x{k}" for k in range(len(next(iter(generators[0]))))])
    given = [context.from_dict({m: as_fmpq(c) for m, c in g.items()}) for g in generators]
    try:
        basis = groebner_basis(given)
    except NotDecidedError as error:
        checkpoint("the Gröbner basis of a level")
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
