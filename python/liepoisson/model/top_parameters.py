r"""The parameters of a top, its Hamiltonian and its equations as the paper writes them.

A top is recognised by its equations of motion, however they were written: parameters are read off single coefficients
and the equations of the top with these are compared with all terms, in SymPy or, where the system consists of rational
polynomials, without it.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from liepoisson.algebra.exact_numbers import Exact, as_coefficient, as_float, exceeds_sum, is_zero, symbols_of, to_sympy
from liepoisson.algebra.rational_polynomials import ZERO, RationalPolynomial
from liepoisson.algebra.rounded import rational
from liepoisson.compile.field import TopField, Vector3
from liepoisson.errors import InertiaWarning, ParameterError
from liepoisson.formula.parameters import Column, read_parameter
from liepoisson.inputs.calls import level_of_the_caller

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket

ExactVector: TypeAlias = tuple[Exact, Exact, Exact]

Scalar: TypeAlias = Any
"""Whatever can be added and multiplied."""

DIMENSIONS = (3, 6, 9)
"""Numbers of coordinates: l, then alpha, then beta."""

_DIFFERENCE = Fraction(1, 2**30)
"""Relative error that rounding the moments may leave in their differences, which are the coefficients of l'."""


@dataclass(frozen=True, slots=True)
class Triple:
    """Three scalars of one kind in the formulas of tops: SymPy expressions, rational polynomials or numbers."""

    first: Scalar
    second: Scalar
    third: Scalar

    def __iter__(self) -> Iterator[Scalar]:
        return iter((self.first, self.second, self.third))

    def __getitem__(self, k: int) -> Scalar:
        return (self.first, self.second, self.third)[k]

    def __add__(self, other: Triple) -> Triple:
        return Triple(*(x + y for x, y in zip(self, other, strict=True)))

    def __rmul__(self, factor: Scalar) -> Triple:
        return Triple(*(factor * x for x in self))

    def dot(self, other: Triple) -> Scalar:
        """The inner product."""
        return self[0] * other[0] + self[1] * other[1] + self[2] * other[2]

    def cross(self, other: Triple) -> Triple:
        """The vector product."""
        return Triple(*(self[i] * other[j] - self[j] * other[i] for i, j in ((1, 2), (2, 0), (0, 1))))


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

        if bracket.dimension not in DIMENSIONS or not bracket.has_algebra or bracket.constant_rows:
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


MOST_TERMS = 400
"""Of an expanded Hamiltonian in which a top is looked for; one that is written as a top has 18."""


def warn_of_impossible_bodies(inertia: Sequence[Exact], system: System | None = None) -> None:
    """Warn of moments of inertia that no rigid body has; of a system, if it has the equations of a top."""
    for k in range(3):
        first, second = (inertia[m] for m in range(3) if m != k)
        if exceeds_sum(inertia[k], first, second) and (system is None or recognised_top(system) is not None):
            warnings.warn(
                f"a rigid body has moments with I{k + 1} at most the sum of the other two; got I{k + 1} = {inertia[k]} "
                f"and {first}, {second}. The equations are integrated as they stand.",
                InertiaWarning,
                stacklevel=level_of_the_caller(),
            )


def recognised_top(system: System) -> TopParameters | None:
    """The top with the equations of motion of a system, or None; see `match_top`."""
    if system.bracket.dimension not in DIMENSIONS or not system.bracket.has_algebra:
        return None
    # The equations are expanded to be compared, which for a high power of a sum would take minutes.
    if system.polynomial_hamiltonian is not None and system.polynomial_rates is not None:
        small = system.polynomial_hamiltonian.written_out[0] <= MOST_TERMS
        return match_polynomial_top(system.bracket, system.polynomial_rates) if small else None
    from liepoisson.formula.arithmetic import expanded_terms

    small = expanded_terms(system.hamiltonian) <= MOST_TERMS
    return match_top(system.bracket, system.equations) if small else None


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
    if len(x) not in DIMENSIONS:
        return None
    try:
        polynomials: list[Any] = [Poly(value, *x) for value in equations.values()]
    except PolynomialError:
        return None

    def coefficient(row: int, *factors: int) -> Expr:
        return polynomials[row].coeff_monomial([factors.count(k) for k in range(len(x))])

    parameters = _read_off(len(x), coefficient, bracket)
    if parameters is None:
        return None
    fields = [Matrix(x[i : i + 3]) if i < len(x) else Matrix([0, 0, 0]) for i in (0, 3, 6)]
    expected = parameters.equations(*fields)[: len(x)]
    residuals = (simplify(e - g) for e, g in zip(expected, equations.values(), strict=True))
    return parameters if all(residual == 0 for residual in residuals) else None


def match_polynomial_top(bracket: Bracket, rates: Sequence[RationalPolynomial]) -> TopParameters | None:
    """The same for equations that are rational polynomials, on a bracket with rational numbers, without SymPy."""
    n = len(rates)

    def coefficient(row: int, *factors: int) -> Fraction:
        return rates[row].expanded.get(tuple(sorted(factors)), Fraction(0))

    parameters = _read_off(n, coefficient, bracket)
    if parameters is None:
        return None
    x = [RationalPolynomial.coordinate(k) if k < n else ZERO for k in range(9)]
    expected = rates_of_top(parameters.numbers(_itself), Triple(*x[:3]), Triple(*x[3:6]), Triple(*x[6:]))
    same = all(e.expanded == g.expanded for e, g in zip(expected[:n], rates, strict=True))
    return parameters if same else None


def _read_off(n: int, coefficient: Callable[..., Scalar], bracket: Bracket) -> TopParameters | None:
    """Parameters from single coefficients: 1/I from beta' = beta x omega, a and b from l', epsilon from alpha'."""
    # beta_i' contains beta_{i+1} l_{i+2} / I_{i+2}, and so does alpha_i';  (alpha x a)_i contains alpha_{i+1} a_{i+2}.
    last = n - 3
    inverse: dict[int, Scalar] = {(i + 2) % 3: coefficient(last + i, last + (i + 1) % 3, (i + 2) % 3) for i in range(3)}
    if n == 3:
        # l_i' = l_{i+1} l_{i+2} (1/I_{i+2} - 1/I_{i+1})
        if not all(isinstance(value, Fraction) or value.is_Rational for value in inverse.values()):
            return None
        first = 1 + sum(abs(value) for value in inverse.values())
        inverse = {0: first, 1: first + inverse[1], 2: first - inverse[0]}
    if any(value == 0 for value in inverse.values()):
        return None
    a = {(i + 2) % 3: coefficient(i, 3 + (i + 1) % 3) if n > 3 else Fraction(0) for i in range(3)}
    b = {(i + 2) % 3: coefficient(i, 6 + (i + 1) % 3) if n > 6 else Fraction(0) for i in range(3)}
    epsilon: Scalar = bracket.extension.tensor[2][1][1] if bracket.extension.dimension == 3 else Fraction(0)
    for k in range(3):
        if a[k] != 0 and n == 9:
            epsilon = coefficient(3 + (k + 1) % 3, 6 + (k + 2) % 3) / a[k]
            break
    return TopParameters(
        inertia=_read_triple({k: 1 / value for k, value in inverse.items()}, "inertia"),
        a=_read_triple(a, "a"),
        b=_read_triple(b, "b"),
        epsilon=read_parameter(epsilon, "epsilon"),
    )


def _read_triple(values: dict[int, Scalar], name: str) -> ExactVector:
    simple = {k: value if isinstance(value, Fraction) else value.simplify() for k, value in values.items()}
    first, second, third = (read_parameter(simple[k], name) for k in range(3))
    return first, second, third


def _itself(value: Scalar) -> Scalar:
    return value
