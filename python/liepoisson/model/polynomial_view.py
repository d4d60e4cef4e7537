"""Systems that consist of rational polynomials: what a run asks of one, without SymPy.

Where the bracket and all parameters are rational numbers and the Hamiltonian is the text of a polynomial, the equations
of motion, the field and the invariants are rational polynomials, too.  They are the same as those that SymPy derives.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from liepoisson.algebra.rational_polynomials import RationalPolynomial, TooLargeError
from liepoisson.compile.polynomial_dynamics import bracket_with, is_rational, rates_of
from liepoisson.formula.scope import Scope
from liepoisson.formula.values import Value, flattened
from liepoisson.model.known_integrals import known_polynomials
from liepoisson.model.polynomial_formula import occurring, read_polynomial
from liepoisson.structure.bracket_scope import scope_of

if TYPE_CHECKING:
    from liepoisson.model.top_parameters import TopParameters
    from liepoisson.structure.bracket import Bracket


class PolynomialView:
    """The rational polynomials of a system.

    Args:
        bracket: The bracket with numbers.
        scope: The names that formulas may use.
        hamiltonian: The Hamiltonian.

    Attributes:
        hamiltonian: The Hamiltonian.
    """

    def __init__(self, bracket: Bracket, scope: Scope, hamiltonian: RationalPolynomial) -> None:
        self._bracket, self._scope = bracket, scope
        self.hamiltonian = hamiltonian

    @classmethod
    def of(cls, symbolic: Bracket, bracket: Bracket, values: Mapping[str, Value], text: str) -> PolynomialView | None:
        """The view of a system; None where its numbers are not rational or its Hamiltonian is no polynomial.

        Args:
            symbolic: The bracket with names for its parameters.
            bracket: The same with values.
            values: Of the parameters of the bracket and the Hamiltonian.
            text: The Hamiltonian.
        """
        known = flattened(values)
        if not all(isinstance(value, Fraction) for value in known.values()) or not is_rational(bracket):
            return None
        scope, names = scope_of(symbolic, values), bracket.coordinate_names_in_order
        hamiltonian = read_polynomial(text, scope, names)
        if hamiltonian is None:
            return None
        found = occurring(text, scope, names, hamiltonian)
        if found is None or any(
            name not in found and not symbolic.symbols & set(flattened({name: value})) for name, value in values.items()
        ):
            return None  # a parameter that drops out is refused where SymPy reads the formula
        return cls(bracket, scope, hamiltonian)

    def read(self, text: str) -> RationalPolynomial | None:
        """A formula in the names of the system; None if it is no small polynomial."""
        return read_polynomial(text, self._scope, self._bracket.coordinate_names_in_order)

    @cached_property
    def rates(self) -> tuple[RationalPolynomial, ...] | None:
        """The equations of motion, derived from the bracket; None if they are too large."""
        try:
            return rates_of(self._bracket, self.hamiltonian)
        except TooLargeError:
            return None

    def invariants(
        self, top: TopParameters | None, given: Mapping[str, object]
    ) -> dict[str, RationalPolynomial] | None:
        """What is known to be constant, by name; None where something in it is no rational polynomial, or not constant.

        Args:
            top: The top with these equations.
            given: Further integrals, texts or expressions, which are claims.
        """
        casimirs = self._bracket.polynomial_casimirs()
        known = {} if top is None else known_polynomials(top)
        if self.rates is None or casimirs is None or known is None:
            return None
        found = {"H": self.hamiltonian, **{f"C{k}": casimir for k, casimir in enumerate(casimirs, start=1)}, **known}
        for name, claim in given.items():
            integral = self.read(claim) if isinstance(claim, str) else None
            if integral is None or not self.is_constant(integral):
                return None
            found.setdefault(name, integral)
        return found

    def is_constant(self, function: RationalPolynomial) -> bool | None:
        """Whether the derivative of a function along the motion vanishes; None if it is too large."""
        try:
            return None if self.rates is None else not bracket_with(self.rates, function)
        except TooLargeError:
            return None

    def is_casimir(self, function: RationalPolynomial) -> bool | None:
        """Whether the bracket of a function with every coordinate vanishes; None if one of them is too large."""
        try:
            return not any(rate.expanded for rate in rates_of(self._bracket, function))
        except TooLargeError:
            return None
