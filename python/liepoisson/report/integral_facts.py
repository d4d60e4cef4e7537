r"""What is reported about known integrals: each is proved anew, or refuted by a point at which it changes.

A derivative that is not recognised as zero refutes nothing by itself: it may vanish on the real points of the set
though it is no multiple of Z (of $Z = |\alpha|^2$ these are $\alpha = 0$), or be zero in a way that was not found.
Hence a point is asked for at which $\{K, H\} \ne 0$, for claims on a set also $Z = 0$.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations_with_replacement, pairwise
from math import prod
from random import Random
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import is_zero, to_sympy
from liepoisson.algebra.linear_algebra import rank
from liepoisson.errors import ParameterError
from liepoisson.report.lines import (
    Equation,
    Line,
    Name,
    Written,
    definition_lines,
    in_parentheses,
    rate,
    record_of,
    record_of_formula,
)
from liepoisson.report.printing import Formula
from liepoisson.report.topics import Topic
from liepoisson.report.vector_notation import VectorNotation

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.model.system import System


@dataclass(frozen=True)
class Integral:
    """A function and whether it was proved or refuted to be constant, just now."""

    name: str  # how it is called
    formula: Formula  # the function
    expression: Expr  # the same in components
    # {K, H} if it was not proved to vanish; that of `on` instead, where this is what is left to prove
    derivative: Formula | None
    on: Formula | None = None  # the function that vanishes on the invariant set to which the claim is confined
    refuted: bool = False  # whether a point was found at which the derivative is not zero
    about: Written | None = None  # whose derivative it is: the name, or `on`

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


def integral_topic(system: System, notation: VectorNotation) -> tuple[Topic, list[str]]:
    """Known integrals besides H and the Casimirs, each proved anew; and which of the claims are refuted."""
    from liepoisson.model.known_integrals import known_integrals

    top = system.top_parameters
    claims = {} if top is None else known_integrals(top, *system.bracket.fields.values())
    given = system.integrals
    again = [name for name, known in claims.items() if any(same_integral(known, k, system) for k in given.values())]
    claims = {name: claim for name, claim in claims.items() if name not in again or name in given} | given
    integrals = [_integral(system, notation, name, claim, None) for name, claim in claims.items()]
    partial = system.partial_integrals.items()
    integrals += [_integral(system, notation, name, claim, zero) for name, (claim, zero) in partial]
    definitions = notation.definitions([formula for integral in integrals for formula in integral.formulas])
    lines: list[Line] = [*map(_integral_line, integrals), *definition_lines(definitions), (MORE,)]
    topic = Topic(
        "integrals",
        lines if integrals else [(NONE,)],
        lambda: [
            {
                "name": integral.name,
                **record_of_formula(integral.formula, integral.expression),
                "definitions": [record_of(definition) for definition in definitions],
                "proved": integral.proved,
                "refuted": integral.refuted,
                "on": None if integral.on is None else record_of(integral.on),
                "derivative": None if integral.derivative is None else record_of(integral.derivative),
            }
            for integral in integrals
        ],
    )
    return topic, [_failure(integral) for integral in integrals if integral.refuted]


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
    open_ = [(value, about) for value, about in rates if not _is_multiple(system, value, zero)]
    for value, about in open_:
        if is_nonzero_on(value, zero, system.variables):
            return Integral(name, formula, claim, notation.formula(value), on, True, about)
    for value, about in open_:
        return Integral(name, formula, claim, notation.formula(value), on, False, about)
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
    about = in_parentheses(integral.about) if of_set else integral.about
    derivative = Equation(rate(about), integral.derivative)
    refutation = "this set is NOT invariant" if of_set else "NOT constant"
    verdict = refutation if integral.refuted else "not proved"
    return (equation, *place, f": {verdict}, ", derivative)


_TRIES = 40
_DIGITS = 40
_MARGIN = Fraction(1, 10**12)
"""A number of 40 digits that is larger than this is not zero."""


def is_nonzero_somewhere(function: Expr, variables: Sequence[Symbol]) -> bool:
    """Whether a real point was found at which the function does not vanish."""
    from sympy import fraction, together

    numerator: Any = fraction(together(function))[0]
    if numerator.is_polynomial(*variables) and not numerator.free_symbols - set(variables):
        return numerator.expand() != 0
    return any(_is_large(function.subs(point)) for point in _points(function, variables))


def is_nonzero_on(function: Expr, zero: Expr, variables: Sequence[Symbol]) -> bool:
    """Whether a real point was found at which `zero` vanishes and the function does not.

    On lines along the axes: for polynomials with rational coefficients the zeros are counted exactly (Sturm), after
    those that they have in common with the function are removed; otherwise a change of sign is followed.
    """
    for point in _points(function + zero, variables):
        for variable in sorted(zero.free_symbols & set(variables), key=str):
            rest = {name: value for name, value in point.items() if name != variable}
            if _is_nonzero_on_line(function.subs(rest), zero.subs(rest), variable):
                return True
    return False


def _points(function: Expr, variables: Sequence[Symbol]) -> Iterator[dict[Any, Any]]:
    """Rational points, many coordinates being zero; symbolic parameters get positive values.  Always the same ones."""
    random = Random(1)
    parameters = sorted(function.free_symbols - set(variables), key=str)
    for _ in range(_TRIES):
        point: dict[Any, Any] = {
            x: to_sympy(Fraction(random.choice((0, 0, 1, 1, -1, 2, -3, 5)), random.choice((1, 1, 2, 3))))
            for x in variables
        }
        point |= {name: to_sympy(Fraction(random.randint(1, 7), random.randint(1, 5))) for name in parameters}
        yield point


def _is_nonzero_on_line(function: Any, zero: Any, x: Any) -> bool:
    from sympy import Poly, fraction, nan, oo, together, zoo
    from sympy.polys.polyerrors import BasePolynomialError

    if function.has(nan, oo, zoo) or zero.has(nan, oo, zoo) or function == 0 or not zero.has(x):
        return False
    numerator, denominator = fraction(together(function))
    try:
        set_ = Poly(fraction(together(zero))[0], x, domain="QQ")
        others = [Poly(f, x, domain="QQ") for f in (numerator, denominator, fraction(together(zero))[1])]
    except BasePolynomialError:  # not polynomials, or irrational coefficients
        return _changes_sign(function, zero, x)
    for other in others:
        while not set_.is_zero and (common := set_.gcd(other)).degree() > 0:
            set_ = set_.quo(common)
    return set_.degree() > 0 and set_.count_roots() > 0


def _changes_sign(function: Any, zero: Any, x: Any) -> bool:
    """The same for other functions: bisection, then both functions at the place that was found."""
    grid = [to_sympy(Fraction(k, 3)) for k in range(-10, 11)]
    signs = [(place, _sign(zero, x, place)) for place in grid]
    for (low, first), (high, second) in pairwise(signs):
        if first * second >= 0:
            continue
        a, b = low, high
        for _ in range(4 * _DIGITS):
            middle = (a + b) / 2
            if _sign(zero, x, middle) == first:
                a = middle
            else:
                b = middle
        here = (a + b) / 2
        # A pole changes its sign, too, but is not small there.
        if not _is_large(zero.subs(x, here)) and _is_large(function.subs(x, here)):
            return True
    return False


def _sign(function: Any, x: Any, place: Any) -> int:
    value = function.subs(x, place).evalf(_DIGITS)
    return 0 if not value.is_real or value == 0 else (1 if value > 0 else -1)


def _is_large(value: Any) -> bool:
    """Whether it is a real number that is not zero, with a margin."""
    number = value.evalf(_DIGITS)
    return bool(number.is_Number and number.is_finite and abs(number) > to_sympy(_MARGIN))


_MOST_LETTERS = 2
_HIGHEST_DEGREE = 4  # with products of six, nine coordinates have thousands of monomials


def _written_out(casimirs: list[Expr]) -> list[Any]:
    """The Casimirs that are polynomials, or quadratic traces; written out, traces of higher degree are too long."""
    from liepoisson.structure.trace import traces_in

    short = [c for c in casimirs if all(len(trace.word) <= _MOST_LETTERS for trace in traces_in(c))]
    return [c.expand(trace=True) if traces_in(c) else c for c in short]


def same_integral(known: Expr, given: Expr, system: System) -> bool:
    r"""Whether $K' = cK + F$ with a nonzero number c and a polynomial F in H and the Casimirs.

    Decided exactly for polynomials, F being of at most their degree.  Other functions are the same only if equal.
    """
    from sympy import Integer, Poly, PolynomialError, total_degree

    if (known - given).expand() == 0:
        return True
    x = system.variables
    invariants = [system.hamiltonian, *_written_out(system.bracket.casimirs())]
    if any(value == 0 or not value.is_polynomial(*x) for value in (known, given, *invariants)):
        return False
    degree = max(int(total_degree(value, *x)) for value in (known, given))
    if degree > _HIGHEST_DEGREE:
        return False
    one: Any = Integer(1)
    factors: list[Any] = [one, *(v for v in invariants if total_degree(v, *x) <= degree)]
    products: set[Any] = {prod(chosen) for chosen in combinations_with_replacement(factors, degree)}
    fitting = [p for p in products if total_degree(p, *x) <= degree]
    try:
        rows = [dict(Poly(value, *x).terms()) for value in (known, given, *fitting)]
    except PolynomialError:
        return False
    field = Coefficients.containing(c for row in rows for c in row.values())
    monomials = {monomial: k for k, monomial in enumerate({m for row in rows for m in row})}
    read = [{monomials[m]: field.read(c) for m, c in row.items()} for row in rows]
    base = rank(read[2:], field)
    one_more = [rank([row, *read[2:]], field) for row in read[:2]]
    return one_more == [base + 1, base + 1] and rank(read, field) == base + 1
