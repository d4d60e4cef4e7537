r"""Recognising a top by its equations of motion, however they were written.

Parameters are read off single coefficients and the equations of the top with these are compared with all terms, in
SymPy or, where the system consists of rational polynomials, without it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.rational_polynomials import ZERO, RationalPolynomial
from liepoisson.algebra.triples import Scalar, Triple
from liepoisson.formula.parameters import read_parameter
from liepoisson.model.top_parameters import DIMENSIONS, ExactVector, TopParameters, rates_of_top

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.model.system import System
    from liepoisson.structure.bracket import Bracket

MOST_TERMS = 400
"""Of an expanded Hamiltonian in which a top is looked for; one that is written as a top has 18."""


def recognised_top(system: System) -> TopParameters | None:
    """The top with the equations of motion of a system, or None; see `match_top`."""
    if system.bracket.dimension not in DIMENSIONS:
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
