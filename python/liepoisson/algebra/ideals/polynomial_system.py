r"""Systems of polynomial equations over the rational numbers, and what can be proved about their solutions.

Scope: rational coefficients (doubles are rational), a few unknowns. Every answer is exact; what would cost more than
the limits is not decided, which an error says. Nothing is decided by a tolerance.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import fmpq

from liepoisson.algebra.exact_numbers import as_expression
from liepoisson.algebra.ideals.buchberger import Poly
from liepoisson.algebra.ideals.components import Assumptions, Component, components
from liepoisson.algebra.ideals.groebner import GroebnerBasis, groebner_basis, rational_context
from liepoisson.algebra.ideals.limits import Limits
from liepoisson.algebra.ideals.operations import in_context, saturation
from liepoisson.algebra.ideals.signs import never_vanishes
from liepoisson.algebra.ideals.solutions import Solution, Solutions, solutions
from liepoisson.algebra.number_fields import as_fmpq
from liepoisson.errors import ParameterError
from liepoisson.inputs.refusals import shown


@dataclass(frozen=True, repr=False)
class PolynomialSystem:
    """Equations p = 0, with polynomials that do not vanish and variables that are positive.

    Example:
        >>> from sympy import symbols
        >>> x, y = symbols("x y")
        >>> PolynomialSystem.of([x**2 + y**2 - 5, x * y - 2], [x, y]).real_solutions()
        [<Solution (-2, -1)>, <Solution (-1, -2)>, <Solution (1, 2)>, <Solution (2, 1)>]

    Attributes:
        context: FLINT's context of the variables, in degree reverse lexicographic order.
        equations: Polynomials of this context that vanish.
        nonzero: Polynomials that do not vanish.
        positive: Names of variables that are positive.
        limits: What one question may cost.
    """

    context: Any
    equations: tuple[Poly, ...]
    nonzero: tuple[Poly, ...] = ()
    positive: frozenset[str] = frozenset()
    limits: Limits = field(default_factory=Limits)

    @classmethod
    def of(
        cls,
        equations: Iterable[Any],
        unknowns: Sequence[Any],
        parameters: Sequence[Any] = (),
        *,
        nonzero: Iterable[Any] = (),
        positive: Collection[Any] = (),
        limits: Limits | None = None,
    ) -> PolynomialSystem:
        """The system of some polynomials.

        Args:
            equations: What vanishes: SymPy expressions, or polynomials of FLINT whose variables are among the names.
            unknowns: Symbols or names.
            parameters: Further symbols or names. They are unknowns like the others, and stay where the unknowns are
                eliminated.
            nonzero: What does not vanish.
            positive: Symbols or names that are positive.
            limits: What one question may cost.

        Raises:
            ParameterError: an equation is no polynomial in these variables with rational coefficients.
        """
        symbols = [*unknowns, *parameters]
        context = rational_context([str(s) for s in symbols])
        return cls(
            context,
            tuple(polynomial(p, context) for p in equations),
            tuple(polynomial(p, context) for p in nonzero),
            frozenset(str(s) for s in positive),
            limits or Limits(),
        )

    def __repr__(self) -> str:
        return f"<PolynomialSystem: {len(self.equations)} equations in {', '.join(self.context.names())}>"

    def read(self, expression: Any) -> Poly:
        """A SymPy expression, or a polynomial of FLINT, as a polynomial of this system."""
        return polynomial(expression, self.context)

    @cached_property
    def _basis(self) -> GroebnerBasis:
        budget = self.limits.budget()
        if any(not p for p in self.nonzero):
            return GroebnerBasis(self.context, (self.context.constant(1),))
        basis = groebner_basis(self.equations or [self.context.constant(0)], budget)
        for p in self._units():
            basis = basis if basis.is_one else saturation(basis, p, budget)
        return basis

    def _units(self) -> list[Poly]:
        gens = dict(zip(self.context.names(), self.context.gens(), strict=True))
        return [*self.nonzero, *(gens[name] for name in sorted(self.positive))]

    def groebner(self) -> GroebnerBasis:
        """The reduced Gröbner basis of the ideal, saturated by what does not vanish."""
        return self._basis

    @property
    def dimension(self) -> int:
        """The dimension of the set of complex solutions, -1 if there are none."""
        return self._basis.dimension

    @property
    def degree(self) -> int:
        """The degree of the ideal; in dimension 0 the number of complex solutions with multiplicities."""
        return self._basis.degree

    @property
    def is_inconsistent(self) -> bool:
        """Whether it is proved that there is no real solution.

        True if there is no complex one, or if the terms of an element of the basis show that it never vanishes; in
        dimension 0 this is decided, in higher dimension False only means that neither argument applies.
        """
        if self._basis.is_one or any(never_vanishes(p, self._positive) for p in self._basis.polynomials):
            return True
        return self.dimension == 0 and not self.real_solutions(8)

    @property
    def _positive(self) -> frozenset[int]:
        return frozenset(k for k, name in enumerate(self.context.names()) if name in self.positive)

    def components(self, *, is_real: bool = False) -> list[Component]:
        """The solutions as a union of parts, none inside another; see `liepoisson.algebra.ideals.components`.

        Args:
            is_real: Whether parts are left out, or made smaller, of which the terms of an equation show that they have
                no real points, or real points in a smaller part only.
        """
        assumptions = Assumptions(tuple(self._units()), self._positive, is_real or bool(self.positive))
        return components(self.equations or (self.context.constant(0),), assumptions, self.limits.budget())

    @cached_property
    def _solutions(self) -> Solutions:
        if self.dimension > 0:
            raise ParameterError(
                f"wanted finitely many complex solutions; got a set of dimension {self.dimension}. Add equations, or "
                "ask for components()"
            )
        return solutions(self._basis, self.limits.budget())

    def solutions(self) -> Solutions:
        """All complex solutions, in one representation.

        Raises:
            ParameterError: there are infinitely many.
        """
        return self._solutions

    def real_solutions(self, bits: int = 60) -> list[Solution]:
        """The real solutions with positive values where this is demanded, by increasing coordinates; proved to be all.

        Args:
            bits: Each coordinate is a ball with a relative error of at most $2^{-bits}$; one that is zero is exact.

        Raises:
            ParameterError: there are infinitely many complex solutions.
        """
        all_of_them = self._solutions
        gens = dict(zip(self.context.names(), self.context.gens(), strict=True))
        found = [
            s for s in all_of_them.real(bits) if all(all_of_them.sign(gens[name], s) > 0 for name in self.positive)
        ]
        return sorted(found, key=lambda s: [float(v.mid()) for v in s.values])


def polynomial(expression: Any, context: Any) -> Poly:
    """An expression as a polynomial of a context.

    Raises:
        ParameterError: it is none in these variables, or a coefficient is not rational.
    """
    if isinstance(expression, int | Fraction | fmpq):
        return context.constant(as_fmpq(expression))
    names = context.names()
    if hasattr(expression, "context"):
        occurring = {n for n, k in zip(expression.context().names(), expression.degrees(), strict=True) if k}
        if not occurring <= set(names):
            raise ParameterError(f"wanted polynomials in {', '.join(names)}; got {expression}")
        return in_context(expression, context)
    return context.from_dict(_read(expression, names))


def _read(expression: Any, names: Sequence[str]) -> dict[tuple[int, ...], fmpq]:
    from sympy import Poly as SymPyPoly
    from sympy import PolynomialError

    read: Any = as_expression(expression, "a polynomial")
    by_name = {str(s): s for s in read.free_symbols}
    symbols: list[Any] = [s for name, s in by_name.items() if name in names]
    wrong = f"wanted a polynomial in {', '.join(names)} with rational coefficients; got {shown(expression)}"
    if len(symbols) < len(by_name):
        raise ParameterError(wrong)
    if not symbols:
        if not read.is_Rational:
            raise ParameterError(wrong)
        return {(0,) * len(names): fmpq(int(read.p), int(read.q))}
    try:
        terms: Any = SymPyPoly(read, *symbols).terms()
    except PolynomialError as error:
        raise ParameterError(wrong) from error
    if not all(c.is_Rational for _, c in terms):
        raise ParameterError(wrong)
    where = [names.index(str(s)) for s in symbols]
    found: dict[tuple[int, ...], fmpq] = {}
    for monomial, c in terms:
        powers = [0] * len(names)
        for place, k in zip(where, monomial, strict=True):
            powers[place] = int(k)
        found[tuple(powers)] = fmpq(int(c.p), int(c.q))
    return found
