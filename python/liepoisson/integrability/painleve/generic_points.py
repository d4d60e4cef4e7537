r"""Generic points of the components of an algebraic set: coordinates in a field, in which all computation is exact.

An isolated point with its conjugates is $\mathbb Q[x]/I$ with a maximal ideal I, a number field.  On a component of
larger dimension some coordinates s are independent, and the others are algebraic over $\mathbb Q(s)$: a Gröbner basis
in lexicographic order, with s last, is one over $\mathbb Q(s)$.  Where it gives an equation for one coordinate, or for
a sum of them, and the others as polynomials in this one, the generic point is found; the irreducible factors of the
equation are the parts of the component.  Where that is too much work, a family has its coordinate ring.

References: [gianni1988].
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from itertools import combinations, islice
from random import Random
from typing import Any, TypeAlias

from flint import fmpq, fmpq_poly

from liepoisson.algebra.function_fields import (
    AlgebraicFunctions,
    AlgebraicNumbers,
    FunctionField,
    Ratio,
    RationalFunctions,
    Rationals,
    polynomial_at,
)
from liepoisson.algebra.ideals.buchberger import Poly, leading
from liepoisson.algebra.ideals.components import Assumptions, Component, components, irreducible_factors
from liepoisson.algebra.ideals.coordinate_ring import CoordinateRing
from liepoisson.algebra.ideals.groebner import GroebnerBasis, groebner_basis, new_name, rational_context
from liepoisson.algebra.ideals.limits import Budget, Limits, NotDecidedError
from liepoisson.algebra.ideals.operations import eliminated, in_context, radical_contains, saturation
from liepoisson.algebra.ideals.solutions import solutions
from liepoisson.algebra.number_fields import Element

_MOST_CHOICES = 6
"""Sets of independent coordinates, and sums of two coordinates that may generate the field, that are tried."""

_LOW_DEGREE = 2
"""A generic point of this degree, or less, is taken at once."""

_SMALL = 300_000
"""Units of work for an attempt that shall be cheap."""


@dataclass(frozen=True)
class GenericPoint:
    """The coordinates of the generic point of a part of an algebraic set."""

    field: FunctionField
    values: dict[str, Element]  # the values of all variables of the context, by name
    is_generic: bool = True  # whether it is generic; if not, it is a random point of its component
    sample: GenericPoint | None = None  # a random point, where the field is a coordinate ring


def generic_points(
    component: Component, parameters: Sequence[str], budget: Budget, *, most: int | None = None
) -> list[GenericPoint]:
    """The generic points of the parts of a component; none if the parameters are not independent on it."""
    basis = component.basis
    if not basis.dimension:
        return [] if parameters else _isolated(basis, budget)
    if parameters:
        others = [name for name in basis.names if name not in parameters]
        if others and eliminated(basis.polynomials or (basis.context.constant(0),), others, budget).polynomials:
            return []
    best: tuple[list[GenericPoint], list[Poly]] | None = None
    for independent in _independent(basis, parameters)[: 2 if most else _MOST_CHOICES]:
        found = _over(basis, independent, parameters, budget, is_cheap=most is not None)
        if found is not None and (best is None or _degree(found[0]) < _degree(best[0])):
            best = found
        if best is not None and _degree(best[0]) <= _LOW_DEGREE:
            break
    if best is None or (most and _degree(best[0]) > most):
        raise NotDecidedError("not decided: a family of balances whose generic point was not found")
    points, units = best
    if component.is_irreducible:
        return points
    return points + [p for rest in _rest(basis, units, budget) for p in generic_points(rest, parameters, budget)]


def of_family(component: Component, singular: Sequence[str], budget: Budget) -> GenericPoint:
    """The coordinate ring of a family, without the common zeros of some coordinates, and a random point of it."""
    basis = component.basis if component.is_irreducible else _without_zeros(component.basis, singular, budget)
    # leading monomials prove that these are independent
    supports = [{basis.names[k] for k, e in enumerate(lead) if e} for lead in basis.leads]
    independent = next((c for c in _independent(basis, ()) if not any(s <= set(c) for s in supports)), ())
    samples = random_points(basis, budget)
    ring = CoordinateRing(
        basis,
        is_prime=component.is_irreducible,
        independent=independent,
        degree=sum(p.field.degree for p in samples),
        budget=budget,
    )
    values = {name: ring.element(x) for name, x in zip(basis.names, basis.context.gens(), strict=True)}
    return GenericPoint(ring, values, sample=samples[0])


def _without_zeros(basis: GroebnerBasis, names: Sequence[str], budget: Budget) -> GroebnerBasis:
    """The ideal of a set without the common zeros of some coordinates, if these are a part of it."""
    gens = dict(zip(basis.names, basis.context.gens(), strict=True))
    random = Random(1)
    form = sum((gens[n] * random.randint(2, 99) for n in names), basis.context.constant(0))
    smaller = saturation(basis, form, budget)
    # what is lost lies where all coordinates vanish: a proof, whatever the form
    if all(radical_contains(basis, gens[n] * p, budget) for p in smaller.polynomials for n in names):
        return smaller
    return basis


def _isolated(basis: GroebnerBasis, budget: Budget) -> list[GenericPoint]:
    """The zeros of an ideal with finitely many, one for each field."""
    whole = solutions(basis, budget)
    gens = basis.context.gens()
    numerators = [whole.numerator(x) for x in gens]
    one = whole.numerator(basis.context.constant(1))
    found: list[GenericPoint] = []
    for factor in whole.factors:
        modulus = fmpq_poly(factor.polynomial)
        if factor.degree == 1:
            root = -modulus[0] / modulus[1]
            values = {name: g(root) / one(root) for name, g in zip(basis.names, numerators, strict=True)}
            found.append(GenericPoint(Rationals(), values))
            continue
        field = AlgebraicNumbers(modulus / modulus.leading_coefficient())
        scale = field.inverse(field.element(one))
        elements = {name: field.element(g) * scale for name, g in zip(basis.names, numerators, strict=True)}
        found.append(GenericPoint(field, elements))
    return found


_Attempt: TypeAlias = "tuple[str, tuple[int, ...] | None]"
"""A coordinate that may generate a field over others; or a name for a sum of coordinates, by its coefficients."""


def _independent(basis: GroebnerBasis, parameters: Sequence[str]) -> list[tuple[str, ...]]:
    """Sets of coordinates that may be independent: first those of which the leading monomials prove it."""
    names, d = basis.names, basis.dimension
    free = [name for name in names if name not in parameters]
    supports = [{names[k] for k, e in enumerate(lead) if e} for lead in basis.leads]
    found = [(*c, *parameters) for c in combinations(reversed(free), d - len(parameters))]
    found = [c for c in found if not any(len(s) == 1 and s <= set(c) and _is_linear(basis, *s) for s in supports)]
    return sorted(found, key=lambda c: any(s <= set(c) for s in supports))[:_MOST_CHOICES]


def _over(
    basis: GroebnerBasis, independent: tuple[str, ...], parameters: Sequence[str], budget: Budget, *, is_cheap: bool
) -> tuple[list[GenericPoint], list[Poly]] | None:
    """The generic points over some coordinates, with the first generator that is found; None if none is."""
    work = _SMALL if is_cheap else budget.limits.work // 16
    for attempt in islice(_attempts(basis, independent, parameters), 3 if is_cheap else None):
        small = Budget(Limits(max(1, min(work, budget.limits.work - int(budget.spent)))))
        try:
            found = _over_functions(basis, independent, attempt, small)
        except NotDecidedError:
            continue
        finally:
            budget.spend(small.spent, "generic points")
        if found is not None:
            return found
    return None


def _degree(points: Sequence[GenericPoint]) -> int:
    return sum(p.field.degree for p in points)


def _attempts(basis: GroebnerBasis, independent: tuple[str, ...], parameters: Sequence[str]) -> Generator[_Attempt]:
    """What may generate the field over some coordinates: one of the others, or a sum of two, or of all."""
    others = [name for name in basis.names if name not in independent and name not in parameters]
    several = [name for name in others if not _is_linear(basis, name)]
    for generator in islice(reversed(several or others[-1:]), 3):
        yield generator, None
    for pair in islice(combinations(several, 2), _MOST_CHOICES):
        yield new_name(basis.names, "u"), tuple(1 + pair.index(n) if n in pair else 0 for n in others)
    yield new_name(basis.names, "u"), tuple(k + 1 for k in range(len(others)))


def _is_linear(basis: GroebnerBasis, name: str) -> bool:
    k = basis.names.index(name)
    return any(sum(lead) == 1 and lead[k] for lead in basis.leads)


def _over_functions(
    basis: GroebnerBasis, independent: tuple[str, ...], attempt: _Attempt, budget: Budget
) -> tuple[list[GenericPoint], list[Poly]] | None:
    """The generic points over the functions of the independent coordinates, and what must not vanish."""
    generator, form = attempt
    others = [name for name in basis.names if name not in (*independent, generator)]
    context = rational_context((*others, generator, *independent), lexicographic=True)
    given = [in_context(p, context) for p in basis.polynomials]
    if form is not None:
        gens = dict(zip(context.names(), context.gens(), strict=True))
        given.append(
            gens[generator] - sum((c * gens[n] for c, n in zip(form, others, strict=True)), gens[generator] * 0)
        )
    found = groebner_basis(given, budget).polynomials
    n = len(others)
    equation: Poly | None = None
    linear: dict[str, Poly] = {}
    for p in found:
        lead = leading(p)
        if not any(lead[: n + 1]):
            return None  # the coordinates are not independent
        if not any(lead[:n]):
            if equation is None or lead[n] < leading(equation)[n]:
                equation = p
        elif sum(lead[:n]) == 1 and not lead[n]:
            linear.setdefault(others[next(k for k in range(n) if lead[k])], p)
    if equation is None or len(linear) < n:
        return None
    base = RationalFunctions(independent)
    # where none of these vanishes, the ideal is what it is over the functions [gianni1988]
    units = [_leading_coefficient(p, n, context) for p in found]
    points: list[GenericPoint] = []
    for factor in irreducible_factors(equation):
        if not factor.degrees()[n]:
            continue
        points.append(_point(factor, linear, others, generator, base))
    if form is not None:
        points = [GenericPoint(p.field, {k: v for k, v in p.values.items() if k != generator}) for p in points]
    return points, [in_context(u, basis.context) for u in units]


def _point(
    factor: Poly, linear: dict[str, Poly], others: Sequence[str], generator: str, base: RationalFunctions
) -> GenericPoint:
    """The point at a root of one factor of the equation of the generator."""
    *by_power, lead = _by_power(factor, len(others), base)
    monic = [c / lead for c in by_power]
    field: Any
    theta: Element
    if len(monic) == 1:
        field, theta = base, -monic[0]
    else:
        field = AlgebraicFunctions(base, monic)
        theta = field.element([base.number(0), base.number(1)])

    def constant(ratio: Ratio) -> Element:
        return ratio if field is base else field.element([ratio])

    values: dict[str, Element] = {
        name: constant(base.element(g)) for name, g in zip(base.parameters, base.context.gens(), strict=True)
    }
    values[generator] = theta
    for name in reversed(others):
        p, k = linear[name], others.index(name)
        slope = p.derivative(k)
        rest = p - slope * p.context().gens()[k]
        values[name] = -polynomial_at(rest, values, field) * field.inverse(polynomial_at(slope, values, field))
    return GenericPoint(field, values)


def _by_power(p: Poly, k: int, base: RationalFunctions) -> list[Ratio]:
    """The coefficients of the powers of variable k, functions of the variables after it."""
    found: dict[int, dict[tuple[int, ...], fmpq]] = {}
    for m, c in p.terms():
        found.setdefault(int(m[k]), {})[tuple(int(e) for e in m[k + 1 :])] = c
    return [base.element(base.context.from_dict(found.get(j, {}))) for j in range(max(found) + 1)]


def _leading_coefficient(p: Poly, n: int, context: Any) -> Poly:
    """The coefficient of the largest monomial in the first n variables and the generator."""
    lead = leading(p)[: n + 1]
    return context.from_dict(
        {(*(0,) * (n + 1), *m[n + 1 :]): c for m, c in p.terms() if tuple(int(k) for k in m[: n + 1]) == lead}
    )


def _rest(basis: GroebnerBasis, units: Sequence[Poly], budget: Budget) -> list[Component]:
    """The parts of a component on which one of some polynomials vanishes, and that are no limits of the others."""
    closed = basis
    factors = {str(q): q for u in units for q in irreducible_factors(u)}
    for q in factors.values():
        closed = saturation(closed, q, budget)
    if all(radical_contains(basis, p, budget) for p in closed.polynomials):
        return []
    found: list[Component] = []
    for q in factors.values():
        for part in components([*basis.polynomials, q], Assumptions(), budget):
            if not all(radical_contains(part.basis, p, budget) for p in closed.polynomials):
                found.append(part)
    return found


def random_points(basis: GroebnerBasis, budget: Budget) -> list[GenericPoint]:
    """Points with random values for coordinates that may be independent."""
    random, gens = Random(1), dict(zip(basis.names, basis.context.gens(), strict=True))
    for independent in _independent(basis, ()):
        values = [gens[s] - fmpq(random.randint(2, 99), random.randint(2, 9)) for s in independent]
        cut = groebner_basis([*basis.polynomials, *values], budget)
        if not cut.is_one and not cut.dimension:
            return [GenericPoint(p.field, p.values, is_generic=False) for p in _isolated(cut, budget)]
    raise NotDecidedError("not decided: a family of balances of which no rational section was found")
