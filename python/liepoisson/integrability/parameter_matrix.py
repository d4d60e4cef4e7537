"""The matrix of a search for integrals with polynomials in the parameters for entries, and the scalings that keep it.

The equations of motion are multiplied by the common denominator of their coefficients, which changes the speed of the
motion and no integral, where it does not vanish.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, transposed
from liepoisson.algebra.function_fields import over_common_denominator
from liepoisson.algebra.sparse_polynomials import Polynomial, expression, of_exponents, whole_expression
from liepoisson.errors import ParameterError
from liepoisson.integrability.derivation import Derivation, Exponents, gradings
from liepoisson.integrability.level import Level
from liepoisson.integrability.parameter_cases import Poly, SparseRow

if TYPE_CHECKING:
    from sympy import Expr, Symbol


class ParameterMatrix:
    """The equations of motion, on a level or in all of phase space, with flint's polynomials for coefficients."""

    def __init__(self, derivation: Derivation, zeros: Sequence[Polynomial] = (), level: Level | None = None) -> None:
        from flint import fmpq_mpoly_ctx

        self.symbols = derivation.field.parameters
        self.names = [str(s) for s in self.symbols]
        self.context: Any = fmpq_mpoly_ctx.get(self.names, "degrevlex")
        self._zero, self._one = self.context.constant(0), self.context.constant(1)
        self.components, self.denominator = self._cleared(derivation.components)
        self.zeros = [self.without_denominators(zero) for zero in zeros if zero]
        self.level = self._level(level or Level())

    def _read(self, polynomial: Any) -> Poly:
        from flint import fmpq

        terms = {tuple(map(int, m)): fmpq(int(c.numerator), int(c.denominator)) for m, c in polynomial.terms()}
        return self.context.from_dict(terms)

    def without_denominators(self, polynomial: Polynomial) -> dict[Exponents, Poly]:
        """A polynomial times the common denominator of its coefficients."""
        return self._cleared([polynomial])[0][0]

    def _cleared(self, polynomials: Sequence[Polynomial]) -> tuple[list[dict[Exponents, Poly]], Poly]:
        """Polynomials times the common denominator of the coefficients of all, and that."""
        pairs = [(self._read(c.numer), self._read(c.denom)) for p in polynomials for c in p.values()]
        tops, common = over_common_denominator(pairs, self._one)
        left = iter(tops)
        return [{m: next(left) for m in p} for p in polynomials], common

    def read(self, function: Expr, variables: Sequence[Symbol]) -> dict[Exponents, Poly]:
        """A function, a polynomial whose coefficients are rational functions of the parameters, without denominators.

        Modulo the level.
        """
        from flint import fmpq
        from sympy import Poly as SymPyPoly

        n, numerator = len(variables), cast("Any", function).together().as_numer_denom()[0]
        found: dict[Exponents, dict[tuple[int, ...], Any]] = {}
        for m, c in cast("Any", SymPyPoly(numerator, *variables, *self.symbols)).terms():
            found.setdefault(m[:n], {})[m[n:]] = fmpq(int(c.p), int(c.q))
        return self.level.remainder({m: self.context.from_dict(terms) for m, terms in found.items()})

    def _level(self, level: Level) -> Level:
        """The level over polynomials: division by its basis must be the same for all values of the parameters."""
        basis: list[tuple[Exponents, dict[Exponents, Poly]]] = []
        for lead, generator in level.basis:
            divided = {m: (self._read(c.numer), self._read(c.denom)) for m, c in generator.items()}
            is_constant = all(a.is_constant() for a, _ in divided.values())
            if not all(b.is_constant() for _, b in divided.values()) or (len(self.zeros) > 1 and not is_constant):
                raise ParameterError(
                    "on: wanted one equation whose highest term has a number for its coefficient, or several without "
                    "parameters; got others; give numbers for the parameters of the level"
                )
            basis.append((lead, {m: a / b.leading_coefficient() for m, (a, b) in divided.items()}))
        return Level(tuple(basis))

    def rows(self, block: Sequence[Exponents]) -> list[SparseRow]:
        """The matrix of D on some monomials that are standard on the level."""
        return transposed(self.level.remainder(self._image(monomial)) for monomial in block)

    def _image(self, monomial: Exponents) -> dict[Exponents, Poly]:
        total: dict[Exponents, Poly] = {}
        for k, power in enumerate(monomial):
            if power:
                lowered = (*monomial[:k], power - 1, *monomial[k + 1 :])
                for factor, coefficient in self.components[k].items():
                    key = of_exponents(lowered, factor)
                    total[key] = total.get(key, self._zero) + coefficient * power
        return total

    def scalings(self) -> list[tuple[int, ...]]:
        """Independent weights of the parameters with which the equations, and those of the level, are homogeneous.

        An equation f = 0 is homogeneous if there are weights of the equations with one more coordinate whose rate is f.
        """
        equations = [*self.components, *self.zeros]
        n, k, more = len(self.components), len(self.symbols), len(self.zeros)
        extended: list[dict[Exponents, Any]] = [
            {(*m, *(0,) * more, *map(int, powers)): 1 for m, a in part.items() for powers, _ in a.terms()}
            for part in equations
        ]
        names: Any = tuple(range(n + more + k))  # gradings look at exponents alone
        whole = Derivation(names, (*extended, *({} for _ in range(k))), Coefficients())
        found = Echelon(Coefficients())
        for grading in gradings(whole):
            if not grading.modulus:
                found.insert({i: Fraction(w) for i, w in enumerate(grading.weights[n + more :]) if w})
        scalings: list[tuple[int, ...]] = []
        for vector in found.basis():
            scale = lcm(*(c.denominator for c in vector.values()))
            scalings.append(tuple(int(vector.get(i, Fraction(0)) * scale) for i in range(k)))
        return scalings

    def fraction(self, numerator: Poly, denominator: Poly) -> Expr:
        """A fraction of polynomials in the parameters as an expression."""
        return expression(numerator.terms(), self.symbols) / expression(denominator.terms(), self.symbols)

    def sympy(self, polynomial: Poly) -> Expr:
        """A polynomial in the parameters as an expression with whole coefficients without a common factor."""
        return whole_expression(polynomial.terms(), self.symbols)
