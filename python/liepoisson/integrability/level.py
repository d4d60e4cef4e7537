r"""Polynomials on an invariant level set $L_1 = \dots = L_r = 0$: remainders modulo the ideal that the $L_j$ generate.

The remainders modulo a Gröbner basis in a degree order are a basis of the functions on the level, and their degree is
the smallest of all polynomials that have the same values there.

A function vanishes on the level where some power of it is in the ideal.  One equation is replaced by its squarefree
part, which generates all functions that vanish on the complex level (Hilbert's Nullstellensatz).  Of several equations
each is; the ideal of all may still be smaller than that of the functions that vanish.

References: Cox, Little and O'Shea, Ideals, Varieties, and Algorithms (2015), sections 2.6 and 5.3.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
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

    def mapped(self, function: Callable[[Polynomial], Polynomial]) -> Level:
        """The level whose basis is the image of this one, under a map that keeps the monomials."""
        return Level(tuple((lead, function(generator)) for lead, generator in self.basis))

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
    from sympy import Poly, PolynomialError

    if not function.is_polynomial(*variables):
        return function
    check_degree([function])
    try:
        polynomial: Any = Poly(function, *variables, extension=True)
        part = polynomial.sqf_part()
    except (PolynomialError, NotImplementedError):  # coefficients in no field, which is refused later
        return function
    return function if part.total_degree() == polynomial.total_degree() else part.as_expr()


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
    leads = [max(generator, key=order) for generator in basis]
    inverses = [derivation.field.one / generator[lead] for lead, generator in zip(leads, basis, strict=True)]
    monic = [{m: c * inverse for m, c in g.items()} for g, inverse in zip(basis, inverses, strict=True)]
    level = Level(tuple(zip(leads, monic, strict=True)))
    if not all(map(any, leads)):
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
    written: list[dict[Exponents, Any]] = [{m: field.to_sympy(c) for m, c in g.items()} for g in generators]
    if all(c.is_Rational for g in written for c in g.values()):  # whatever the field of the equations is
        found = _over_the_rationals([{m: as_fmpq(c) for m, c in g.items()} for g in written])
        return [{m: field.number(c) for m, c in g.items()} for g in found]
    if field.is_cyclotomic:
        raise ParameterError("on: wanted one equation, or rational coefficients; got several over a cyclotomic field")
    from sympy import groebner

    expressions: list[Expr] = [derivation.expression(g) for g in generators]
    by_sympy: Any = groebner(expressions, *derivation.variables, order="grevlex", domain=field.domain)
    return [{m: field.read(c) for m, c in polynomial.terms()} for polynomial in by_sympy.polys]


def _over_the_rationals(generators: Sequence[Mapping[Exponents, Any]]) -> list[Polynomial]:
    from liepoisson.algebra.ideals.groebner import groebner_basis, rational_context
    from liepoisson.algebra.ideals.limits import NotDecidedError

    context = rational_context([f"x{k}" for k in range(len(next(iter(generators[0]))))])
    try:
        basis = groebner_basis([context.from_dict(dict(g)) for g in generators])
    except NotDecidedError as error:
        checkpoint("the Gröbner basis of a level")
        raise ParameterError(
            f"on: wanted a level whose Gröbner basis is computed within the limits; {error}"
        ) from error
    return [{tuple(map(int, m)): c for m, c in polynomial.terms()} for polynomial in basis.polynomials]
