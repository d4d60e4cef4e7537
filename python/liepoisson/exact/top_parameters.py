r"""The parameters of a top, its Hamiltonian and its equations as the paper writes them, and recognising a top."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.errors import ParameterError
from liepoisson.exact.parameters import Column, Exact, as_float, display, is_zero, read_parameter, symbols_of, to_sympy
from liepoisson.field import TopField, Vector3

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.exact.bracket import Bracket

ExactVector: TypeAlias = tuple[Exact, Exact, Exact]


MOST_TERMS = 400
"""Of an expanded Hamiltonian in which a top is looked for; one that is written as a top has 18."""


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
        r"""Whether this is the bracket of the top, with the same epsilon.

        Then its Casimirs are $|\alpha|^2 + 2\epsilon\,\ell\cdot\beta$, $\alpha\cdot\beta$ and $|\beta|^2$.  Another
        bracket can have the same equations, with another Hamiltonian or where a = b = 0.
        """
        from liepoisson.exact.extensions import leibniz
        from liepoisson.exact.lie_algebras import so

        return bracket.entries() == (so(3) @ leibniz(3, self.epsilon)).entries()

    def field(self) -> TopField:
        """The plain description for the numeric core.

        Raises:
            ParameterError: a parameter is symbolic (the message names it) or does not fit into a double.
        """
        inertia = _as_vector(self.inertia, "I")
        for k, moment in enumerate(inertia):
            if moment <= 0 or 1 / moment == float("inf"):
                raise ParameterError(
                    f"I{k + 1} must be positive and its inverse below 1.8e308; got {self.inertia[k]}. Rescale."
                )
        a, b = _as_vector(self.a, "a"), _as_vector(self.b, "b")
        return TopField(inertia=inertia, a=a, b=b, epsilon=as_float(self.epsilon, "epsilon"))

    def describe(self) -> str:
        """The parameters in one line, for example "I = (2, 2, 1), a = (-1, 0, 0), b = 0, epsilon = 1"."""
        a, b = (_display_vector(vector) for vector in (self.a, self.b))
        inertia = ", ".join(display(v) for v in self.inertia)
        return f"I = ({inertia}), a = {a}, b = {b}, epsilon = {display(self.epsilon)}"


def match_top(bracket: Bracket, equations: dict[Symbol, Expr]) -> TopParameters | None:
    """The top that has these nine equations of motion (coordinates in the order l, alpha, beta), or None.

    The parameters are read off the coefficients and the equations are then compared with `TopParameters.equations`,
    term by term.  When a = 0 the equations do not contain epsilon, which is then read from the bracket.
    """
    from sympy import Matrix, Poly, PolynomialError, simplify

    x = list(equations)
    if len(x) != 9:
        return None
    l, alpha, beta = (Matrix(x[i : i + 3]) for i in (0, 3, 6))
    try:
        polynomials = [Poly(value, *x) for value in equations.values()]
    except PolynomialError:
        return None
    parameters = _read_off(polynomials, bracket)
    if parameters is None:
        return None
    expected = parameters.equations(l, alpha, beta)
    residuals = (simplify(e - g) for e, g in zip(expected, equations.values(), strict=True))
    return parameters if all(residual == 0 for residual in residuals) else None


def _read_off(polynomials: Sequence[Any], bracket: Bracket) -> TopParameters | None:
    """Parameters from single coefficients: 1/I from beta' = beta x omega, a and b from l', epsilon from alpha'."""
    from sympy import S

    def coefficient(row: int, *factors: int) -> Expr:
        powers = [0] * 9
        for factor in factors:
            powers[factor] += 1
        return polynomials[row].coeff_monomial(powers)

    # beta_i' contains beta_{i+1} l_{i+2} / I_{i+2};  (alpha x a)_i contains alpha_{i+1} a_{i+2}.
    inverse = {(i + 2) % 3: coefficient(6 + i, 6 + (i + 1) % 3, (i + 2) % 3) for i in range(3)}
    if any(value == 0 for value in inverse.values()):
        return None
    a = {(i + 2) % 3: coefficient(i, 3 + (i + 1) % 3) for i in range(3)}
    b = {(i + 2) % 3: coefficient(i, 6 + (i + 1) % 3) for i in range(3)}
    epsilon = _epsilon_of(bracket)
    for k in range(3):
        if a[k] != 0:
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
    first, second, third = (as_float(value, f"{name}{k}") for k, value in enumerate(values, start=1))
    return first, second, third


def _display_vector(values: ExactVector) -> str:
    if all(is_zero(value) for value in values):
        return "0"
    return "(" + ", ".join(display(value) for value in values) + ")"
