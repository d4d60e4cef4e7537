r"""The parameters of a top, its Hamiltonian and its equations as the paper writes them, and recognising a top."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.errors import ParameterError
from liepoisson.exact.parameters import (
    Column,
    Exact,
    as_coefficient,
    as_float,
    display,
    is_zero,
    read_parameter,
    symbols_of,
    to_sympy,
)
from liepoisson.exact.rounded import rational
from liepoisson.field import TopField, Vector3

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.exact.bracket import Bracket

ExactVector: TypeAlias = tuple[Exact, Exact, Exact]


_DIMENSIONS = (3, 6, 9)
"""Numbers of coordinates: l, then alpha, then beta."""

MOST_TERMS = 400
"""Of an expanded Hamiltonian in which a top is looked for; one that is written as a top has 18."""

_DIFFERENCE = Fraction(1, 2**30)
"""Relative error that rounding the moments may leave in their differences, which are the coefficients of l'."""


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
        r"""The right-hand sides as `liepoisson.field.TopField` states them, written out by cross products.

        $\dot\ell = \ell\times\omega + \alpha\times a + \beta\times b$,
        $\dot\alpha = \alpha\times\omega + \epsilon\,\beta\times a$, $\dot\beta = \beta\times\omega$.
        """
        from sympy import Matrix, expand

        inertia, a, b = self.vectors()
        omega = Matrix([l[i] / inertia[i] for i in range(3)])
        dl = l.cross(omega) + alpha.cross(a) + beta.cross(b)
        dalpha = alpha.cross(omega) + to_sympy(self.epsilon) * beta.cross(a)
        return tuple(expand(v) for v in (*dl, *dalpha, *beta.cross(omega)))

    def has_bracket(self, bracket: Bracket) -> bool:
        r"""Whether this is the bracket of the top, with the same epsilon, or that of its first fields.

        For three fields the Casimirs are then $|\alpha|^2 + 2\epsilon\,\ell\cdot\beta$, $\alpha\cdot\beta$ and
        $|\beta|^2$, for two $\ell\cdot\alpha$ and $|\alpha|^2$, for one $|\ell|^2$.  Another bracket can have the
        same equations, with another Hamiltonian or where a = b = 0.
        """
        from liepoisson.exact.extensions import leibniz
        from liepoisson.exact.lie_algebras import so

        if bracket.dimension not in _DIMENSIONS or bracket.constant:
            return False
        wanted = so(3) @ leibniz(bracket.dimension // 3, self.epsilon)
        return set(bracket.entries()) == set(wanted.entries())

    def field(self) -> TopField:
        """The plain description for the numeric core.

        Raises:
            ParameterError: a parameter is symbolic (the message names it) or does not fit into a double.
        """
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
        inertia = ", ".join(display(v) for v in self.inertia)
        return f"I = ({inertia}), a = {a}, b = {b}, epsilon = {display(self.epsilon)}"


def match_top(bracket: Bracket, equations: dict[Symbol, Expr]) -> TopParameters | None:
    """The top that has these equations of motion (coordinates in the order l, alpha, beta), or None.

    The parameters are read off the coefficients and the equations are then compared with `TopParameters.equations`,
    term by term.  When a = 0 the equations do not contain epsilon, which is then read from the bracket.

    Six equations are compared with those of l and alpha where beta = 0 (b and epsilon are then 0), and three with those
    of l where alpha is 0, too.  The latter contain only the differences of the 1/I, which have to be rational; the
    first of these is chosen such that all moments are positive.
    """
    from sympy import Matrix, Poly, PolynomialError, simplify

    x = list(equations)
    if len(x) not in _DIMENSIONS:
        return None
    try:
        polynomials = [Poly(value, *x) for value in equations.values()]
    except PolynomialError:
        return None
    parameters = _read_off(polynomials, bracket)
    if parameters is None:
        return None
    fields = [Matrix(x[i : i + 3]) if i < len(x) else Matrix([0, 0, 0]) for i in (0, 3, 6)]
    expected = parameters.equations(*fields)[: len(x)]
    residuals = (simplify(e - g) for e, g in zip(expected, equations.values(), strict=True))
    return parameters if all(residual == 0 for residual in residuals) else None


def _read_off(polynomials: Sequence[Any], bracket: Bracket) -> TopParameters | None:
    """Parameters from single coefficients: 1/I from beta' = beta x omega, a and b from l', epsilon from alpha'."""
    from sympy import S

    n = len(polynomials)

    def coefficient(row: int, *factors: int) -> Expr:
        if max(row, *factors) >= n:
            return S.Zero
        powers = [0] * n
        for factor in factors:
            powers[factor] += 1
        return polynomials[row].coeff_monomial(powers)

    # beta_i' contains beta_{i+1} l_{i+2} / I_{i+2}, and so does alpha_i';  (alpha x a)_i contains alpha_{i+1} a_{i+2}.
    last = n - 3
    inverse = {(i + 2) % 3: coefficient(last + i, last + (i + 1) % 3, (i + 2) % 3) for i in range(3)}
    if n == 3:
        # l_i' = l_{i+1} l_{i+2} (1/I_{i+2} - 1/I_{i+1})
        if not all(value.is_Rational for value in inverse.values()):
            return None
        first = S.One + sum(abs(value) for value in inverse.values())
        inverse = {0: first, 1: first + inverse[1], 2: first - inverse[0]}
    if any(value == 0 for value in inverse.values()):
        return None
    a = {(i + 2) % 3: coefficient(i, 3 + (i + 1) % 3) for i in range(3)}
    b = {(i + 2) % 3: coefficient(i, 6 + (i + 1) % 3) for i in range(3)}
    epsilon = _epsilon_of(bracket)
    for k in range(3):
        if a[k] != 0 and n == 9:
            epsilon = coefficient(3 + (k + 1) % 3, 6 + (k + 2) % 3) / a[k]
            break
    ordered = [[vector[k] for k in range(3)] for vector in (inverse, a, b)]
    inertia: list[Any] = [S.One / value for value in ordered[0]]
    return TopParameters(
        inertia=_read_triple(inertia, "inertia"),
        a=_read_triple(ordered[1], "a"),
        b=_read_triple(ordered[2], "b"),
        epsilon=read_parameter(epsilon, "epsilon"),
    )


def _epsilon_of(bracket: Bracket) -> Expr:
    """The entry of W that multiplies e_1 e_1 along e_2."""
    return to_sympy(bracket.extension.tensor[2][1][1]) if bracket.extension.dimension == 3 else to_sympy(_ZERO)


_ZERO = read_parameter(0, "zero")


def _read_triple(values: list[Expr], name: str) -> ExactVector:
    first, second, third = (read_parameter(value.simplify(), name) for value in values)
    return first, second, third


def _as_vector(values: ExactVector, name: str) -> Vector3:
    first, second, third = (as_coefficient(value, f"{name}{k}") for k, value in enumerate(values, start=1))
    return first, second, third


def _display_vector(values: ExactVector) -> str:
    if all(is_zero(value) for value in values):
        return "0"
    return "(" + ", ".join(display(value) for value in values) + ")"
