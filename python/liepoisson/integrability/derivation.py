r"""The equations of motion as a derivation of polynomials, $D = \sum_k \dot x_k\,\partial/\partial x_k$, exactly.

A polynomial is a dictionary from exponents to coefficients, which are elements of the exact field that the coefficients
of the equations generate (`liepoisson.algebra.coefficients`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra import sparse_polynomials
from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import Exact
from liepoisson.algebra.number_fields import Element
from liepoisson.algebra.sparse_polynomials import Monomial, Polynomial, of_exponents
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.refusals import shown

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.model.system import System

Exponents: TypeAlias = Monomial


@dataclass(frozen=True)
class Derivation:
    r"""A polynomial vector field, and polynomials with coefficients in the same field.

    Attributes:
        variables: The coordinates.
        components: The right-hand sides, one polynomial for each coordinate.
        field: Where coefficients live.
    """

    variables: tuple[Symbol, ...]
    components: tuple[Polynomial, ...]
    field: Coefficients

    @property
    def degree(self) -> int:
        """The largest degree of a right-hand side, 0 if all vanish."""
        return max((sum(m) for component in self.components for m in component), default=0)

    def __call__(self, polynomial: Mapping[Exponents, Element]) -> Polynomial:
        """The derivative of a polynomial along the motion."""
        total: Polynomial = {}
        for monomial, coefficient in polynomial.items():
            checkpoint("a derivative along the motion")
            for key, value in self.of_monomial(monomial):
                term = coefficient * value
                total[key] = total[key] + term if key in total else term
        return {m: c for m, c in total.items() if not self.field.vanishes(c)}

    def of_monomial(self, monomial: Exponents) -> list[tuple[Exponents, Element]]:
        """The terms of the derivative of one monomial; equal monomials may occur several times."""
        found: list[tuple[Exponents, Element]] = []
        for k, power in enumerate(monomial):
            if not power:
                continue
            factor_of_power = self.field.number(power)
            lowered = (*monomial[:k], power - 1, *monomial[k + 1 :])
            for factor, coefficient in self.components[k].items():
                found.append((of_exponents(lowered, factor), coefficient * factor_of_power))
        return found

    def expression(self, polynomial: Mapping[Exponents, Element]) -> Expr:
        """A polynomial as a SymPy expression."""
        return sparse_polynomials.expression(polynomial.items(), self.variables, self.field.to_sympy)


def derivation_of(system: System, *functions: Expr) -> tuple[Derivation, list[Polynomial]]:
    """The equations of a system as a derivation, and functions as polynomials over the same field.

    Raises:
        ParameterError: the equations or a function are no polynomials.
    """
    return derivation_of_rates(system.variables, list(system.equations.values()), functions)


def derivation_of_rates(
    variables: Sequence[Symbol], rates: Sequence[Expr], functions: Sequence[Expr] = ()
) -> tuple[Derivation, list[Polynomial]]:
    """Rates of some variables as a derivation, and functions as polynomials over the same field.

    Raises:
        ParameterError: they are no polynomials.
    """
    terms = [polynomial_terms(e, variables, f"the rate of {x}") for x, e in zip(variables, rates, strict=True)]
    # all rates may have a common power of pi, which changes the speed of motion and no integral
    speed = Coefficients.containing([c for one in terms for c in one.values()]).scale
    terms = [{m: _divided(c, speed) for m, c in one.items()} for one in terms]
    terms += [polynomial_terms(f, variables, "a function") for f in functions]
    field = Coefficients.containing([c for one in terms for c in one.values()])
    if not field.decides:
        raise ParameterError(undecided(field))
    read = [{m: field.read(c) for m, c in one.items()} for one in terms]
    n = len(variables)
    return Derivation(tuple(variables), tuple(read[:n]), field), read[n:]


def undecided(field: Coefficients) -> str:
    """Why nothing is proved with these coefficients, and what to write instead."""
    from sympy import Symbol

    numbers = sorted(str(g) for g in field.parameters if not isinstance(g, Symbol))
    return (
        "coefficients: wanted rational numbers, roots, symbols and at most one number such as pi or log(2), of which "
        f"equality is decided; got {shown(', '.join(numbers) or 'others')}, between which relations may "
        "hide, such as log(6) = log(2) + log(3). Write a symbol for each, which counts as generic, or rational values"
    )


def _divided(value: Exact, scale: Exact) -> Exact:
    return value if scale == 1 else value / scale


def polynomial_terms(expression: Any, variables: Sequence[Symbol], what: str) -> dict[Exponents, Exact]:
    """The exact coefficients of a polynomial.

    Raises:
        ParameterError: it is none; `what` says what it should have been.
    """
    from fractions import Fraction

    from sympy import Poly, PolynomialError

    if expression == 0:
        return {}
    if not expression.is_polynomial(*variables):
        raise ParameterError(
            f"{what}: wanted a polynomial in {', '.join(map(str, variables))}; got {shown(expression)}. Searches for "
            "polynomial integrals need polynomial equations; sections, exponents and `decide` take any smooth system"
        )
    try:
        terms = cast("Any", Poly(expression, *variables)).terms()
    except PolynomialError as error:
        raise ParameterError(f"{what}: wanted a polynomial; got {shown(expression)} ({error})") from error
    return {m: Fraction(int(c.p), int(c.q)) if c.is_Rational else c for m, c in terms if c != 0}
