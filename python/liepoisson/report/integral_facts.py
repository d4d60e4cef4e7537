"""What is reported about known integrals: each is proved anew, or refuted."""

# ruff: noqa: D102 - lines() and record() are described once, in Topic

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, final

from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.errors import ParameterError
from liepoisson.report.bracket_facts import Topic
from liepoisson.report.counterexamples import is_nonzero_on, is_nonzero_somewhere
from liepoisson.report.equal_integrals import same_integral
from liepoisson.report.lines import (
    Equation,
    Line,
    Name,
    Rate,
    Written,
    definition_lines,
    record_of,
    record_of_formula,
)
from liepoisson.report.printing import Formula
from liepoisson.report.vector_notation import VectorNotation

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.system import System


@dataclass(frozen=True)
class Integral:
    """A function and whether it was proved or refuted to be constant, just now.

    Attributes:
        name: How it is called.
        formula: The function.
        expression: The same in components.
        derivative: {K, H} if it was not proved to vanish; that of `on` instead, where this is what is left to prove.
        on: The function that vanishes on the invariant set to which the claim is confined.
        refuted: Whether a point was found at which the derivative is not zero.
        about: Whose derivative it is: the name, or `on`.
    """

    name: str
    formula: Formula
    expression: Expr
    derivative: Formula | None
    on: Formula | None = None
    refuted: bool = False
    about: Written | None = None

    @property
    def formulas(self) -> list[Formula]:
        """All formulas that are told about it."""
        return [formula for formula in (self.formula, self.derivative, self.on) if formula is not None]

    @property
    def proved(self) -> bool:
        """Whether {K, H} = 0, on the invariant set if there is one."""
        return self.derivative is None


NONE = "none besides H and the Casimirs (to search: liepoisson integrals, integrable)"
MORE = "to search for others: liepoisson integrals, integrable"


@final
class IntegralFacts(Topic):
    """Known integrals besides H and the Casimirs, each proved anew."""

    key, title = "integrals", "Known integrals"

    def __init__(self, system: System, notation: VectorNotation) -> None:
        from liepoisson.model.known_integrals import known_integrals

        top = system.top_parameters
        claims = {} if top is None else known_integrals(top, *system.bracket.fields.values())
        given = system.integrals
        again = [name for name, known in claims.items() if any(same_integral(known, k, system) for k in given.values())]
        claims = {name: claim for name, claim in claims.items() if name not in again or name in given} | given
        self.integrals = [_integral(system, notation, name, claim, None) for name, claim in claims.items()]
        partial = system.partial_integrals.items()
        self.integrals += [_integral(system, notation, name, claim, zero) for name, (claim, zero) in partial]
        self.definitions = notation.definitions(
            [formula for integral in self.integrals for formula in integral.formulas]
        )

    @property
    def failed(self) -> list[str]:
        """Which of the claims are refuted."""
        return [_failure(integral) for integral in self.integrals if integral.refuted]

    def lines(self) -> list[Line]:
        if not self.integrals:
            return [(NONE,)]
        return [*map(_integral_line, self.integrals), *definition_lines(self.definitions), (MORE,)]

    def record(self) -> list[dict[str, Any]]:
        return [
            {
                "name": integral.name,
                **record_of_formula(integral.formula, integral.expression),
                "definitions": [record_of(definition) for definition in self.definitions],
                "proved": integral.proved,
                "refuted": integral.refuted,
                "on": None if integral.on is None else record_of(integral.on),
                "derivative": None if integral.derivative is None else record_of(integral.derivative),
            }
            for integral in self.integrals
        ]


def _integral(system: System, notation: VectorNotation, name: str, claim: Expr, zero: Expr | None) -> Integral:
    formula, derivative = notation.formula(claim), system.derivative(claim)
    if zero is None:
        if is_zero(derivative):
            return Integral(name, formula, claim, None)
        refuted = is_nonzero_somewhere(derivative, system.variables)
        return Integral(name, formula, claim, notation.formula(derivative), None, refuted, Name(name))
    if not zero.free_symbols & set(system.variables):
        raise ParameterError(
            f"the set on which {name} is constant must be given by a function of the coordinates that vanishes there; "
            f"got {zero}. Give an integral that holds everywhere among the integrals."
        )
    on = notation.formula(zero)
    rates = [(derivative, Name(name)), (system.derivative(zero), on)]
    open_ = [(rate, about) for rate, about in rates if not _is_multiple(system, rate, zero)]
    for rate, about in open_:
        if is_nonzero_on(rate, zero, system.variables):
            return Integral(name, formula, claim, notation.formula(rate), on, True, about)
    for rate, about in open_:
        return Integral(name, formula, claim, notation.formula(rate), on, False, about)
    return Integral(name, formula, claim, None, on)


def _is_multiple(system: System, value: Expr, zero: Expr) -> bool:
    """Whether {K, H} or {Z, H} is a multiple of Z: if both are, K is constant on the invariant set Z = 0."""
    from sympy import PolynomialError, fraction, reduced, together

    numerator = fraction(together(value))[0]
    try:
        return numerator == 0 or reduced(numerator, [zero], *system.variables)[1] == 0
    except PolynomialError:
        return False


def _failure(integral: Integral) -> str:
    if integral.on is None:
        return f"the integral {integral.name} is not constant"
    place = f"{integral.on.plain} = 0"
    if integral.about is integral.on:
        return f"the set {place} of the integral {integral.name} is not invariant"
    return f"the integral {integral.name} is not constant on {place}"


def _integral_line(integral: Integral) -> Line:
    equation = Equation(Name(integral.name), integral.formula)
    zero = Formula(to_sympy(Fraction(0)))
    place: Line = () if integral.on is None else (" on ", Equation(integral.on, zero))
    if integral.derivative is None or integral.about is None:
        return (equation, *place, ": constant, proved")
    of_set = integral.about is integral.on
    about = _InParentheses(integral.about) if of_set else integral.about
    rate = Equation(Rate(about), integral.derivative)
    refutation = "this set is NOT invariant" if of_set else "NOT constant"
    verdict = refutation if integral.refuted else "not proved"
    return (equation, *place, f": {verdict}, ", rate)


@dataclass(frozen=True)
class _InParentheses:
    """A formula whose derivative is meant."""

    of: Written

    def write(self, style: Any) -> str:
        """The formula in parentheses."""
        return style.parentheses(self.of.write(style))
