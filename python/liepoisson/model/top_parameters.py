r"""The parameters of a top, its Hamiltonian and its equations as the paper writes them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from liepoisson.algebra.exact_numbers import Exact, as_coefficient, as_float, is_zero, symbols_of, to_sympy
from liepoisson.algebra.rounded import rational
from liepoisson.algebra.triples import Scalar, Triple
from liepoisson.compile.field import TopField, Vector3
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Column

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.bracket import Bracket

ExactVector: TypeAlias = tuple[Exact, Exact, Exact]


DIMENSIONS = (3, 6, 9)
"""Numbers of coordinates: l, then alpha, then beta."""

_DIFFERENCE = Fraction(1, 2**30)
"""Relative error that rounding the moments may leave in their differences, which are the coefficients of l'."""


class TopNumbers(NamedTuple):
    """The parameters of a top as numbers of one kind: all SymPy expressions, or all Fractions."""

    inertia: Triple
    a: Triple
    b: Triple
    epsilon: Scalar


@dataclass(frozen=True)
class TopParameters:
    r"""Principal moments, centre of mass a, centre of charge b (all in the body frame) and the cocycle strength.

    $H = \tfrac12\,\ell\cdot I^{-1}\ell + a\cdot\alpha + b\cdot\beta$.
    """

    inertia: ExactVector
    a: ExactVector
    b: ExactVector
    epsilon: Exact

    @property
    def symbols(self) -> set[str]:
        """Names of the parameters kept symbolic."""
        return {s for value in (*self.inertia, *self.a, *self.b, self.epsilon) for s in symbols_of(value)}

    def numbers(self, kind: Callable[[Exact], Scalar]) -> TopNumbers:
        """The parameters as numbers of one kind."""
        inertia, a, b = (Triple(*map(kind, vector)) for vector in (self.inertia, self.a, self.b))
        return TopNumbers(inertia, a, b, kind(self.epsilon))

    def vectors(self) -> tuple[Column, Column, Column]:
        """The moments of inertia, a and b as SymPy columns."""
        from sympy import Matrix

        inertia, a, b = (Matrix([to_sympy(v) for v in vector]) for vector in (self.inertia, self.a, self.b))
        return inertia, a, b

    def hamiltonian(self, l: Column, alpha: Column, beta: Column) -> Expr:
        """The energy, kinetic plus the two potentials."""
        inertia, a, b = self.vectors()
        kinetic = sum(l[i] ** 2 / (2 * inertia[i]) for i in range(3))
        return kinetic + a.dot(alpha) + b.dot(beta)

    def equations(self, l: Column, alpha: Column, beta: Column) -> tuple[Expr, ...]:
        r"""The right-hand sides as `liepoisson.compile.field.TopField` states them, written out by cross products.

        $\dot\ell = \ell\times\omega + \alpha\times a + \beta\times b$,
        $\dot\alpha = \alpha\times\omega + \epsilon\,\beta\times a$, $\dot\beta = \beta\times\omega$.
        """
        from sympy import expand

        rates = rates_of_top(self.numbers(to_sympy), Triple(*l), Triple(*alpha), Triple(*beta))
        return tuple(expand(rate) for rate in rates)

    def has_bracket(self, bracket: Bracket) -> bool:
        r"""Whether this is the bracket of the top, with the same epsilon, or that of its first fields.

        For three fields the Casimirs are then $|\alpha|^2 + 2\epsilon\,\ell\cdot\beta$, $\alpha\cdot\beta$ and
        $|\beta|^2$, for two $\ell\cdot\alpha$ and $|\alpha|^2$, for one $|\ell|^2$.  Another bracket can have the
        same equations, with another Hamiltonian or where a = b = 0.
        """
        from liepoisson.structure.extensions import leibniz
        from liepoisson.structure.lie_algebras import so

        if bracket.dimension not in DIMENSIONS or bracket.constant:
            return False
        wanted = so(3) @ leibniz(bracket.dimension // 3, self.epsilon)
        return set(bracket.entries()) == set(wanted.entries())

    def field(self) -> TopField:
        """The plain description for the numeric core.

        Raises:
            ParameterError: a parameter is symbolic (the message names it) or does not fit into a double.
        """
        return self._field

    @cached_property
    def _field(self) -> TopField:
        inertia = self._moments()
        for k, moment in enumerate(inertia):
            if moment <= 0 or 1 / moment == float("inf"):
                raise ParameterError(
                    f"I{k + 1} must be positive and its inverse below 1.8e308; got {self.inertia[k]}. Rescale."
                )
        a, b = _as_vector(self.a, "a"), _as_vector(self.b, "b")
        return TopField(inertia=inertia, a=a, b=b, epsilon=as_coefficient(self.epsilon, "epsilon"))

    def _moments(self) -> Vector3:
        first, second, third = (as_float(moment, f"I{k}") for k, moment in enumerate(self.inertia, start=1))
        return first, second, third

    def is_kept_by_doubles(self) -> bool:
        """Whether moments that differ do so as doubles, by the same difference to nine digits."""
        doubles = [Fraction(moment) for moment in self._moments()]
        exact = [rational(moment) for moment in self.inertia]
        wanted, found = ([x - y for x, y in pairwise([*moments, moments[0]])] for moments in (exact, doubles))
        return all(abs(x - y) <= abs(x) * _DIFFERENCE for x, y in zip(wanted, found, strict=True))

    def describe(self) -> str:
        """The parameters in one line, for example "I = (2, 2, 1), a = (-1, 0, 0), b = 0, epsilon = 1"."""
        a, b = (_display_vector(vector) for vector in (self.a, self.b))
        inertia = ", ".join(map(str, self.inertia))
        return f"I = ({inertia}), a = {a}, b = {b}, epsilon = {self.epsilon}"


def rates_of_top(top: TopNumbers, l: Triple, alpha: Triple, beta: Triple) -> tuple[Scalar, ...]:
    """The right-hand sides of `TopParameters.equations`, not expanded, in scalars of any kind."""
    omega = Triple(*(component / moment for component, moment in zip(l, top.inertia, strict=True)))
    dl = l.cross(omega) + alpha.cross(top.a) + beta.cross(top.b)
    dalpha = alpha.cross(omega) + top.epsilon * beta.cross(top.a)
    return (*dl, *dalpha, *beta.cross(omega))


def _as_vector(values: ExactVector, name: str) -> Vector3:
    first, second, third = (as_coefficient(value, f"{name}{k}") for k, value in enumerate(values, start=1))
    return first, second, third


def _display_vector(values: ExactVector) -> str:
    if all(is_zero(value) for value in values):
        return "0"
    return f"({', '.join(map(str, values))})"
