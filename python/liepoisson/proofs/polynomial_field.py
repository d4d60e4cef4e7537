"""Polynomial equations with rational coefficients as plain data: what proofs are about, and what they print.

Nothing is typed again: the terms are those of `System.equations`, of its Hamiltonian and of its Casimirs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.errors import ParameterError
from liepoisson.formula.expression import read_expression
from liepoisson.formula.scope import Scope
from liepoisson.inputs.refusals import shown
from liepoisson.report.printing import Formula

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.model.system import System

Terms: TypeAlias = "dict[tuple[int, ...], Fraction]"
"""A polynomial: exponents -> coefficient, none of which is zero."""


@dataclass(frozen=True)
class PolynomialField:
    """A polynomial vector field and its constants of motion.

    Attributes:
        names: The coordinates.
        rates: Their rates of change.
        constants: H and the Casimirs, by name.
        equations: The equations as text in the grammar of system files, one for each coordinate.
    """

    names: tuple[str, ...]
    rates: tuple[Terms, ...]
    constants: Mapping[str, Terms]
    equations: tuple[str, ...]

    @property
    def text(self) -> str:
        """The equations, one in each line."""
        return "\n".join(self.equations)

    @property
    def degree(self) -> int:
        """The largest degree of a rate."""
        return max((sum(m) for rate in self.rates for m in rate), default=0)

    def is_kept_by(self, signs: Sequence[int], *, reverses_time: bool = False) -> bool:
        """Whether x -> (s_k x_k) maps orbits to orbits and keeps all constants of motion.

        Orbits are mapped to orbits if f(S x) = S f(x), and to orbits run backward if f(S x) = -S f(x).
        """
        sense = -1 if reverses_time else 1
        moved = [_signed(rate, signs) for rate in self.rates]
        same = all(
            m == {e: s * sense * c for e, c in r.items()} for m, r, s in zip(moved, self.rates, signs, strict=True)
        )
        return same and all(_signed(f, signs) == f for f in self.constants.values())


def polynomial_field(system: System) -> PolynomialField:
    """The equations of a system as polynomials with rational coefficients.

    Raises:
        ParameterError: an equation, H or a Casimir is no polynomial, or a coefficient is not rational.
    """
    x = system.variables
    named = {"H": system.hamiltonian, **{f"C{k}": c for k, c in enumerate(system.bracket.casimirs(), start=1)}}
    return PolynomialField(
        tuple(map(str, x)),
        tuple(rational_terms(e, x, f"the rate of {v}") for v, e in system.equations.items()),
        {name: rational_terms(f, x, name) for name, f in named.items()},
        tuple(f"d{v}/dt = {Formula(e).plain}" for v, e in system.equations.items()),
    )


def rational_terms(expression: Expr, variables: Sequence[Symbol], what: str) -> Terms:
    """The terms of a polynomial.

    Raises:
        ParameterError: it is no polynomial in the variables, or a coefficient is not rational.
    """
    from sympy import Poly, PolynomialError

    try:
        terms: Any = Poly(expression, *variables).terms()
    except PolynomialError as error:
        raise ParameterError(
            f"{what}: wanted a polynomial in {', '.join(map(str, variables))}; got {shown(expression)}. Rigorous "
            "enclosures are made for polynomial fields"
        ) from error
    for _, coefficient in terms:
        if not coefficient.is_Rational:
            raise ParameterError(
                f"{what}: wanted rational coefficients; got {shown(coefficient)}. Give numbers for all parameters, "
                "such as 1/3, and no roots"
            )
    return {tuple(map(int, m)): Fraction(int(c.p), int(c.q)) for m, c in terms if c != 0}


def _signed(terms: Terms, signs: Sequence[int]) -> Terms:
    """A polynomial at (s_k x_k), the signs being 1 and -1."""
    found: Terms = {}
    for m, c in terms.items():
        odd = sum(k for k, s in zip(m, signs, strict=True) if s < 0) % 2
        found[m] = -c if odd else c
    return found


def equations_of(system: System) -> PolynomialField:
    """The equations of a system, without constants of motion, which a flow does not ask for.

    Raises:
        ParameterError: an equation is no polynomial, or a coefficient is not rational.
    """
    x = system.variables
    return PolynomialField(
        tuple(map(str, x)),
        tuple(rational_terms(e, x, f"the rate of {v}") for v, e in system.equations.items()),
        {},
        tuple(f"d{v}/dt = {Formula(e).plain}" for v, e in system.equations.items()),
    )


def field_of_formulas(rates: Mapping[str, str], constants: Mapping[str, str] | None = None) -> PolynomialField:
    """A polynomial field from formulas in the grammar of system files; it need not be Hamiltonian.

    Args:
        rates: The rate of change of each coordinate, by its name.
        constants: Constants of motion, by name.

    Raises:
        ExpressionError: a formula cannot be read.
        ParameterError: one is no polynomial with rational coefficients.
    """
    from sympy import Symbol

    names = tuple(rates)
    x = [Symbol(name) for name in names]

    def terms(text: str, what: str) -> Terms:
        return rational_terms(read_expression(text, Scope(symbols=names)), x, what)

    return PolynomialField(
        names,
        tuple(terms(text, f"the rate of {name}") for name, text in rates.items()),
        {name: terms(text, name) for name, text in (constants or {}).items()},
        tuple(f"d{name}/dt = {text}" for name, text in rates.items()),
    )
