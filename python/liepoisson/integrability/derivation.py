r"""The equations of motion as a derivation of polynomials, $D = \sum_k \dot x_k\,\partial/\partial x_k$, exactly.

A polynomial is a dictionary from exponents to coefficients, which are elements of the exact field that the coefficients
of the equations generate (`liepoisson.algebra.coefficients`).

Weights $w_i$ of the coordinates are a grading if all terms of D change the weight of a monomial by the same number s:
$\sum_i m_i w_i - w_k = s$ for each term $x^m\,\partial_k$ of D.  Then D maps the polynomials of weight w to those of
weight w + s, and each part of one weight of an integral is an integral: the search for integrals falls into blocks.
Weights may be integers (quasi-homogeneous equations) or integers modulo 2 (changes of signs; with s = 1 they reverse
time) or 3.

On an invariant level set $L_1 = \dots = L_r = 0$ polynomials are remainders modulo the ideal of the $L_j$.  Those
modulo a Gröbner basis in a degree order are a basis of the functions on the level, and their degree is the smallest of
all polynomials that have the same values there.  A function vanishes on the level where some power of it is in the
ideal.  One equation is replaced by its squarefree part, which generates all functions that vanish on the complex level
(Hilbert's Nullstellensatz).  Of several equations each is; the ideal of all may still be smaller than that of the
functions that vanish.

References: Cox, Little and O'Shea, Ideals, Varieties, and Algorithms (2015), sections 2.6 and 5.3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, product
from math import comb, gcd, lcm
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra import sparse_polynomials
from liepoisson.algebra.coefficients import Coefficients, check_degree
from liepoisson.algebra.exact_numbers import Exact
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod
from liepoisson.algebra.number_fields import Element, as_fmpq, as_fraction
from liepoisson.algebra.sparse_polynomials import Monomial, Polynomial, divides, of_exponents
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.refusals import shown
from liepoisson.report.printing import Formula

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.model.equations_of_motion import EquationsOfMotion

Exponents: TypeAlias = Monomial


@dataclass(frozen=True)
class Derivation:
    r"""A polynomial vector field, and polynomials with coefficients in the same field.

    Attributes:
        variables: The coordinates.
        components: The right-hand sides, one polynomial for each coordinate.
        field: Where coefficients live.
    """

    variables: tuple[Symbol, ...]
    components: tuple[Polynomial, ...]
    field: Coefficients

    @property
    def degree(self) -> int:
        """The largest degree of a right-hand side, 0 if all vanish."""
        return max((sum(m) for component in self.components for m in component), default=0)

    def __call__(self, polynomial: Mapping[Exponents, Element]) -> Polynomial:
        """The derivative of a polynomial along the motion."""
        total: Polynomial = {}
        for monomial, coefficient in polynomial.items():
            checkpoint("a derivative along the motion")
            for key, value in self.of_monomial(monomial):
                term = coefficient * value
                total[key] = total[key] + term if key in total else term
        return {m: c for m, c in total.items() if not self.field.vanishes(c)}

    def of_monomial(self, monomial: Exponents) -> list[tuple[Exponents, Element]]:
        """The terms of the derivative of one monomial; equal monomials may occur several times."""
        found: list[tuple[Exponents, Element]] = []
        for k, power in enumerate(monomial):
            if not power:
                continue
            factor_of_power = self.field.number(power)
            lowered = (*monomial[:k], power - 1, *monomial[k + 1 :])
            for factor, coefficient in self.components[k].items():
                found.append((of_exponents(lowered, factor), coefficient * factor_of_power))
        return found

    def expression(self, polynomial: Mapping[Exponents, Element]) -> Expr:
        """A polynomial as a SymPy expression."""
        return sparse_polynomials.expression(polynomial.items(), self.variables, self.field.to_sympy)


def derivation_of(system: EquationsOfMotion, *functions: Expr) -> tuple[Derivation, list[Polynomial]]:
    """The equations of a system as a derivation, and functions as polynomials over the same field."""
    return derivation_of_rates(system.variables, list(system.equations.values()), functions)


def derivation_of_rates(
    variables: Sequence[Symbol], rates: Sequence[Expr], functions: Sequence[Expr] = ()
) -> tuple[Derivation, list[Polynomial]]:
    """Rates of some variables as a derivation, and functions as polynomials over the same field."""
    terms = [polynomial_terms(e, variables, f"the rate of {x}") for x, e in zip(variables, rates, strict=True)]
    # all rates may have a common power of pi, which changes the speed of motion and no integral
    speed = Coefficients.containing([c for one in terms for c in one.values()]).scale
    terms = [{m: c if speed == 1 else c / speed for m, c in one.items()} for one in terms]
    terms += [polynomial_terms(f, variables, "a function") for f in functions]
    field = Coefficients.containing([c for one in terms for c in one.values()])
    if not field.decides:
        raise ParameterError(undecided(field))
    read = [{m: field.read(c) for m, c in one.items()} for one in terms]
    n = len(variables)
    return Derivation(tuple(variables), tuple(read[:n]), field), read[n:]


def undecided(field: Coefficients) -> str:
    """Why nothing is proved with these coefficients, and what to write instead."""
    from sympy import Symbol

    numbers = sorted(str(g) for g in field.parameters if not isinstance(g, Symbol))
    return (
        "coefficients: wanted rational numbers, roots, symbols and at most one number such as pi or log(2), of which "
        f"equality is decided; got {shown(', '.join(numbers) or 'others')}, between which relations may "
        "hide, such as log(6) = log(2) + log(3). Write a symbol for each, which counts as generic, or rational values"
    )


def polynomial_terms(expression: Any, variables: Sequence[Symbol], what: str) -> dict[Exponents, Exact]:
    """The exact coefficients of a polynomial."""
    from sympy import Poly, PolynomialError

    if expression == 0:
        return {}
    if not expression.is_polynomial(*variables):
        raise ParameterError(
            f"{what}: wanted a polynomial in {', '.join(map(str, variables))}; got {shown(expression)}. Searches for "
            "polynomial integrals need polynomial equations; sections, exponents and `decide` take any smooth system"
        )
    try:
        terms = cast("Any", Poly(expression, *variables)).terms()
    except PolynomialError as error:
        raise ParameterError(f"{what}: wanted a polynomial; got {shown(expression)} ({error})") from error
    return {m: as_fraction(c) if c.is_Rational else c for m, c in terms if c != 0}


MODULI = (2, 3)
_MOST_COMBINATIONS = 6
"""Integer gradings are combined with factors up to this to find one with positive weights."""


@dataclass(frozen=True)
class Grading:
    """Weights of the coordinates, and what D adds to a weight."""

    weights: tuple[int, ...]  # one for each coordinate
    shift: int  # what D adds
    modulus: int = 0  # 0 for integers

    def of(self, monomial: Exponents) -> int:
        """The weight of a monomial."""
        weight = sum(w * k for w, k in zip(self.weights, monomial, strict=True) if k)
        return weight % self.modulus if self.modulus else weight


def gradings(derivation: Derivation) -> tuple[Grading, ...]:
    """A basis of the gradings over the integers, and of those modulo 2 and 3."""
    n = len(derivation.variables)
    relations: set[tuple[tuple[int, int], ...]] = set()
    for k, component in enumerate(derivation.components):
        for monomial in component:
            row = {i: m for i, m in enumerate(monomial) if m}
            row[k] = row.get(k, 0) - 1
            row[n] = -1
            relations.add(tuple(sorted((i, c) for i, c in row.items() if c)))
    rows = [dict(relation) for relation in sorted(relations)]
    found: list[Grading] = []
    rationals = Coefficients()
    exact = [{c: Fraction(v) for c, v in row.items()} for row in rows]
    for vector in nullspace(exact, n + 1, rationals).vectors:
        scale = lcm(*(value.denominator for value in vector.values()))
        whole = [int(vector.get(i, 0) * scale) for i in range(n + 1)]
        common = gcd(*whole)
        *weights, shift = (w // common for w in whole)
        found.append(Grading(tuple(weights), shift))
    for q in MODULI:
        for vector in nullspace_mod(rows, n + 1, q):
            found.append(Grading(tuple(vector.get(i, 0) for i in range(n)), vector.get(n, 0), q))
    return tuple(g for g in found if any(g.weights))


def positive_grading(found: Iterable[Grading], n_positive: int | None = None) -> Grading | None:
    """A grading with positive integer weights, small ones preferred; None if there is none of small factors.

    Args:
        found: A basis of the gradings.
        n_positive: How many of the first weights have to be positive; by default all.  Those after them are 0 if that
            is possible.
    """
    integer = [g for g in found if not g.modulus]
    positive: list[Grading] = []
    n = len(integer)
    bound = _MOST_COMBINATIONS if n <= 2 else 2
    for factors in product(range(-bound, bound + 1), repeat=n) if n <= 5 else ():
        scaled = [[f * w for w in g.weights] for f, g in zip(factors, integer, strict=True)]
        weights = list(map(sum, zip(*scaled, strict=True)))
        if not weights or min(weights[:n_positive]) <= 0:
            continue
        shift = sum(f * g.shift for f, g in zip(factors, integer, strict=True))
        common = gcd(*weights, shift)
        positive.append(Grading(tuple(w // common for w in weights), shift // common))
    behind = len(positive[0].weights) if positive and n_positive is None else n_positive
    return min(positive, key=lambda g: (abs(g.shift - 1), *map(abs, g.weights[behind:]), sum(g.weights)), default=None)


def homogeneous_parts(polynomial: Polynomial, found: Sequence[Grading]) -> dict[tuple[int, ...], Polynomial]:
    """The parts of a polynomial, by their weights in all gradings."""
    parts: dict[tuple[int, ...], Polynomial] = {}
    for monomial, coefficient in polynomial.items():
        parts.setdefault(tuple(g.of(monomial) for g in found), {})[monomial] = coefficient
    return parts


def n_monomials(n_variables: int, degree: int) -> int:
    """The number of monomials up to a degree."""
    return comb(n_variables + degree, degree)


def n_of_weights(weights: Sequence[int], most: int) -> list[int]:
    """The numbers of monomials of each weight up to the largest, without listing them; weights are positive."""
    counts = [1] + [0] * most
    for w in weights:
        for k in range(w, most + 1):
            counts[k] += counts[k - w]
    return counts


def of_degree(n_variables: int, degree: int) -> Iterator[Exponents]:
    """All monomials of one degree."""
    return of_weight((1,) * n_variables, degree)


def up_to_degree(n_variables: int, degree: int) -> Iterator[Exponents]:
    """All monomials up to a degree."""
    return chain.from_iterable(of_degree(n_variables, k) for k in range(degree + 1))


def of_weight(weights: Sequence[int], weight: int) -> Iterator[Exponents]:
    """All monomials of one weight; weights are positive."""
    if not weights:
        if weight == 0:
            yield ()
        return
    if len(weights) == 1:
        if weight % weights[0] == 0:
            yield (weight // weights[0],)
        return
    for power in range(weight // weights[0] + 1):
        for rest in of_weight(weights[1:], weight - power * weights[0]):
            yield (power, *rest)


def in_blocks(monomials: Iterator[Exponents], gradings: Sequence[Grading]) -> dict[tuple[int, ...], list[Exponents]]:
    """The monomials by their weights in all gradings."""
    blocks: dict[tuple[int, ...], list[Exponents]] = {}
    for monomial in monomials:
        blocks.setdefault(tuple(g.of(monomial) for g in gradings), []).append(monomial)
    return blocks


def order(monomial: Exponents) -> tuple[int, ...]:
    """Graded reverse lexicographic order."""
    return (sum(monomial), *(-k for k in reversed(monomial)))


@dataclass(frozen=True)
class Level:
    """The level set of some polynomials, or all of phase space."""

    # a Gröbner basis of the ideal, each with its leading monomial; monic
    basis: tuple[tuple[Exponents, Polynomial], ...] = ()

    def mapped(self, function: Callable[[Polynomial], Polynomial]) -> Level:
        """The level whose basis is the image of this one, under a map that keeps the monomials."""
        return Level(tuple((lead, function(generator)) for lead, generator in self.basis))

    def is_standard(self, monomial: Exponents) -> bool:
        """Whether a monomial is no multiple of a leading one."""
        return not any(divides(lead, monomial) for lead, _ in self.basis)

    def remainder(self, polynomial: Mapping[Exponents, Any]) -> Polynomial:
        """What is left of a polynomial modulo the ideal."""
        left = {m: c for m, c in polynomial.items() if c}
        if not self.basis:
            return left
        done: Polynomial = {}
        while left:
            checkpoint("a remainder on a level")
            monomial = max(left, key=order)
            divisor = next((b for b in self.basis if divides(b[0], monomial)), None)
            if divisor is None:
                done[monomial] = left.pop(monomial)
                continue
            lead, generator = divisor
            factor, shift = left[monomial], tuple(a - b for a, b in zip(monomial, lead, strict=True))
            for m, c in generator.items():
                key = of_exponents(m, shift)
                value = left[key] - factor * c if key in left else -(factor * c)
                if value:
                    left[key] = value
                else:
                    left.pop(key, None)
        return done


def squarefree(function: Any, variables: Sequence[Symbol]) -> Any:
    """A polynomial without repeated factors that vanishes where the given one does: itself if it has none."""
    from sympy import Poly, PolynomialError

    if not function.is_polynomial(*variables):
        return function
    check_degree([function])
    try:
        polynomial: Any = Poly(function, *variables, extension=True)
        part = polynomial.sqf_part()
    except (PolynomialError, NotImplementedError):  # coefficients in no field, which is refused later
        return function
    return function if part.total_degree() == polynomial.total_degree() else part.as_expr()


def real_points(function: Any, variables: Sequence[Symbol]) -> tuple[Symbol, ...] | None:
    """The coordinates that vanish at all real zeros of a sum of squares, as C2 = |alpha|^2 is one; None for others."""
    from sympy import Poly

    if not function.is_polynomial(*variables):
        return None
    terms = cast("Any", Poly(function, *variables)).terms()
    even = all(k % 2 == 0 for m, _ in terms for k in m)
    if not even or not (all(c.is_positive for _, c in terms) or all(c.is_negative for _, c in terms)):
        return None
    if any(not any(m) for m, _ in terms):
        raise ParameterError(
            f"on: wanted a level with real points; got {Formula(function).plain} = 0, a sum of squares and "
            "a number of the same sign"
        )
    alone = [[x for x, k in zip(variables, m, strict=True) if k] for m, _ in terms]
    return tuple(dict.fromkeys(x for factors in alone if len(factors) == 1 for x in factors)) or None


def level_of(derivation: Derivation, zeros: Sequence[Polynomial]) -> Level:
    """The level set on which some polynomials vanish."""
    generators = [zero for zero in zeros if zero]
    if not generators:
        return Level()
    basis = generators if len(generators) == 1 else _groebner(derivation, generators)
    leads = [max(generator, key=order) for generator in basis]
    inverses = [derivation.field.one / generator[lead] for lead, generator in zip(leads, basis, strict=True)]
    monic = [{m: c * inverse for m, c in g.items()} for g, inverse in zip(basis, inverses, strict=True)]
    level = Level(tuple(zip(leads, monic, strict=True)))
    if not all(map(any, leads)):
        raise ParameterError("on: wanted a level that has points; got equations that contradict each other")
    for zero in generators:
        if level.remainder(derivation(zero)):
            raise ParameterError(
                f"on: wanted a level set that orbits do not leave; got {derivation.expression(zero)} = 0, which is not "
                "invariant. Write a constant of the motion equal to a number, such as H = 1"
            )
    return level


def _groebner(derivation: Derivation, generators: Sequence[Polynomial]) -> list[Polynomial]:
    from liepoisson.algebra.ideals.groebner import groebner_basis, rational_context
    from liepoisson.algebra.ideals.limits import NotDecidedError

    field: Coefficients = derivation.field
    written: list[dict[Exponents, Any]] = [{m: field.to_sympy(c) for m, c in g.items()} for g in generators]
    if all(c.is_Rational for g in written for c in g.values()):  # whatever the field of the equations is
        context = rational_context([f"x{k}" for k in range(len(derivation.variables))])
        try:
            basis = groebner_basis([context.from_dict({m: as_fmpq(c) for m, c in g.items()}) for g in written])
        except NotDecidedError as error:
            checkpoint("the Gröbner basis of a level")
            raise ParameterError(
                f"on: wanted a level whose Gröbner basis is computed within the limits; {error}"
            ) from error
        return [{tuple(map(int, m)): field.number(c) for m, c in p.terms()} for p in basis.polynomials]
    if field.is_cyclotomic:
        raise ParameterError("on: wanted one equation, or rational coefficients; got several over a cyclotomic field")
    from sympy import groebner

    expressions: list[Expr] = [derivation.expression(g) for g in generators]
    found: Any = groebner(expressions, *derivation.variables, order="grevlex", domain=field.domain)
    return [{m: field.read(c) for m, c in polynomial.terms()} for polynomial in found.polys]
