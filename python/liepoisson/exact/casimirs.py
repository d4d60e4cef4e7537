r"""Casimir invariants of a bracket: generators, their number, and what is proved about them.

Each generator is verified by $J \nabla C = 0$.  The number of functionally independent Casimirs is at most the corank
of J at any one point, which is computed exactly; when as many have been found, there are no more.

References: Olver, Applications of Lie Groups to Differential Equations (1993), section 6.2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from numbers import Integral
from random import Random
from typing import TYPE_CHECKING, Any, NamedTuple

from liepoisson.errors import ParameterError
from liepoisson.exact.linear.coefficients import Coefficients
from liepoisson.exact.linear.linear_algebra import rank
from liepoisson.exact.parameters import Exact, is_zero, to_sympy
from liepoisson.exact.poisson.casimir_search import (
    MAX_WORK,
    CasimirSearch,
    Polynomial,
    n_independent,
    new_generators,
    products_of_degree,
)
from liepoisson.exact.poisson.takiff import leibniz_strength, lifted, primitive

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.exact.bracket import Bracket
    from liepoisson.exact.poisson.poisson_tensor import LinearPoissonTensor

MAX_DEGREE = 6
"""Highest degree that is searched when the caller names none."""


class ExceptionalCase(NamedTuple):
    """Values of parameters at which there are more Casimirs than in general, or which need other generators.

    Attributes:
        condition: For example "epsilon = 0".
        generators: The generators there.
    """

    condition: str
    generators: list[Expr]


@dataclass(frozen=True)
class CasimirReport:
    """Casimirs of a bracket, and what is known about them.

    Attributes:
        generators: Casimirs of each degree modulo products of those of lower degree.
        degrees: Their degrees.
        dimensions: Number of linearly independent homogeneous Casimirs of each degree that was searched (proved).
        independent: Number of functionally independent ones among the generators (proved).
        corank: The corank of J at one point; no more can be independent (proved).
        complete: Whether these two numbers agree: every Casimir is locally a function of the generators.
        exceptional: Values of the parameters with more Casimirs in the degrees searched, with a higher corank, or at
            which the generic generators become dependent.
        examined: All values that had to be looked at; elsewhere, the generic answer holds in the degrees searched.
        undecided: Conditions on several parameters that were not looked at.
        verified: Whether J grad C = 0 for every generator, expanded anew.
        method: How they were found, in words.
        limits: Why the search ended before it was complete, or "".
    """

    generators: tuple[Expr, ...]
    degrees: tuple[int, ...]
    dimensions: dict[int, int]
    independent: int
    corank: int
    complete: bool
    exceptional: tuple[ExceptionalCase, ...]
    examined: tuple[str, ...]
    undecided: tuple[str, ...]
    verified: bool
    method: str
    limits: str


@dataclass
class _Found:
    """The state of a search."""

    tensor: LinearPoissonTensor
    corank: int
    generators: list[tuple[int, Polynomial]]
    dimensions: dict[int, int]
    limits: str = ""
    method: str = "linear algebra on all monomials of a degree"

    @property
    def independent(self) -> int:
        return n_independent([c for _, c in self.generators], self.tensor) if self.generators else 0

    @property
    def complete(self) -> bool:
        return self.independent == self.corank


def casimir_generators(bracket: Bracket, degree: int | None = None) -> list[Expr]:
    """Generators of the Casimirs, without examining special values of the parameters; see `CasimirReport`."""
    return _expressions(bracket, _find(bracket, degree))


def independent_casimirs(bracket: Bracket) -> int:
    """How many functionally independent Casimirs are found (proved to be so many)."""
    return _find(bracket, None).independent


def _find(bracket: Bracket, degree: int | None) -> _Found:
    closed = _lift(bracket) if degree is None else None
    if closed is not None and closed.complete:
        return closed
    return _better(closed, _search(CasimirSearch(bracket.tensor), _checked_degree(degree), _corank(bracket.tensor)))


def _better(closed: _Found | None, found: _Found) -> _Found:
    """The closed form where it is complete or gives more than the search, so that generators have one order."""
    return closed if closed is not None and (closed.complete or closed.independent > found.independent) else found


def casimir_report(bracket: Bracket, degree: int | None = None) -> CasimirReport:
    """The Casimirs up to a degree, or up to the degree that suffices, with proofs and exceptional parameters.

    Args:
        bracket: Any bracket; parameters that it keeps symbolic are generic.
        degree: Find everything up to this degree.  None: raise the degree until as many independent Casimirs are
            found as the corank allows; up to degree 6 and systems of 200,000 (monomials times coordinates).

    Raises:
        ParameterError: the degree is not a positive integer, or a search up to it is too large.
    """
    search = CasimirSearch(bracket.tensor, with_pivots=bool(bracket.tensor.field.parameters))
    found = _search(search, _checked_degree(degree), _corank(bracket.tensor))
    if degree is None and (closed := _lift(bracket)) is not None:
        closed.dimensions, closed.limits = found.dimensions, "" if closed.complete else found.limits
        found = _better(closed, found)
    exceptional, examined, undecided = _exceptional(bracket, search, found)
    return CasimirReport(
        generators=tuple(_expressions(bracket, found)),
        degrees=tuple(d for d, _ in found.generators),
        dimensions=found.dimensions,
        independent=found.independent,
        corank=found.corank,
        complete=found.complete,
        exceptional=exceptional,
        examined=examined,
        undecided=undecided,
        verified=not any(search.image(polynomial) for _, polynomial in found.generators),
        method=found.method,
        limits=found.limits,
    )


def quotient_casimirs(tensor: LinearPoissonTensor) -> list[Polynomial]:
    """Generators of the Casimirs of any linear Poisson tensor, as far as `casimir_report` would go."""
    return [polynomial for _, polynomial in _search(CasimirSearch(tensor), None, _corank(tensor)).generators]


def _search(search: CasimirSearch, degree: int | None, corank: int) -> _Found:
    found = _Found(search.tensor, corank, [], {})
    if degree is not None and not search.is_feasible(degree):
        raise ParameterError(f"the search must stay below its size limit; {_size_limit(degree)}. Lower the degree.")
    for d in count(1):
        if d > (MAX_DEGREE if degree is None else degree):
            if degree is None:
                found.limits = f"searched up to degree {MAX_DEGREE} only"
            break
        if degree is None and found.complete:
            break
        if not search.is_feasible(d):
            found.limits = _size_limit(d)
            if d == 2:  # large semisimple algebras have at least their Killing form, often diagonal
                found.generators += [(d, polynomial) for polynomial in search.sums_of_squares()]
            break
        space = search.of_degree(d)
        found.dimensions[d] = len(space)
        fresh = new_generators(space, products_of_degree(found.generators, d), search.tensor.field) if space else []
        found.generators += [(d, polynomial) for polynomial in fresh]
    return found


def _size_limit(degree: int) -> str:
    return f"degree {degree} exceeds the size limit ({MAX_WORK} monomials times coordinates)"


def _lift(bracket: Bracket) -> _Found | None:
    """The closed form for Leibniz extensions of higher order, verified; None if this is no such bracket."""
    from liepoisson.exact.extensions import leibniz

    n, strength, field = bracket.extension.dimension, leibniz_strength(bracket.extension), bracket.tensor.field
    if n < 2 or strength is None or strength == 0 or field.is_cyclotomic:
        return None
    base = bracket.algebra @ leibniz(1)
    found = _search(CasimirSearch(base.tensor), None, _corank(base.tensor))
    to_field = base.tensor.field.to_sympy
    generators: list[tuple[int, Polynomial]] = []
    for d, polynomial in found.generators:
        here = {m: field.read(to_field(c)) for m, c in polynomial.items()}
        lifts = lifted(here, bracket.algebra.dimension, n, field.read(strength), field)
        generators += [(d, casimir) for casimir in lifts]
    search = CasimirSearch(bracket.tensor)
    if any(search.image(polynomial) for _, polynomial in generators):
        return None
    method = f"closed form for Leibniz extensions, from the Casimirs of {bracket.algebra.name}"
    return _Found(bracket.tensor, _corank(bracket.tensor), generators, {}, found.limits, method)


def _corank(tensor: LinearPoissonTensor) -> int:
    return tensor.dimension - tensor.rank_at_a_point


def _exceptional(
    bracket: Bracket, search: CasimirSearch, found: _Found
) -> tuple[tuple[ExceptionalCase, ...], tuple[str, ...], tuple[str, ...]]:
    if not bracket.tensor.field.parameters:
        return (), (), ()
    from liepoisson.exact.poisson.exceptional_parameters import special_values

    values, undecided = special_values(search.pivots, bracket.tensor.field)
    generic = _expressions(bracket, found)
    cases: list[ExceptionalCase] = []
    for condition, substitution in values:
        try:
            special = bracket.substitute(substitution)
        except ParameterError:  # a pole: there is no bracket at this value
            continue
        inner = CasimirSearch(special.tensor)
        more = any(len(inner.of_degree(d)) > n for d, n in found.dimensions.items())
        fewer = _independent_at(substitution, generic, bracket) < found.independent
        if more or fewer or _corank(special.tensor) > found.corank:
            cases.append(ExceptionalCase(condition, casimir_generators(special)))
    return tuple(cases), tuple(condition for condition, _ in values), undecided


def _independent_at(values: Mapping[str, Exact], generators: Sequence[Expr], bracket: Bracket) -> int:
    """How many generators stay independent with these values of parameters (their gradients at one random point)."""
    random = Random(1)
    at: Any = [(x, random.randrange(1, 100)) for x in bracket.variables]
    inserted: Any = {name: to_sympy(value) for name, value in values.items()}
    special: list[Any] = [e.subs(inserted) for e in generators]
    rows = [[e.diff(x).subs(at) for x in bracket.variables] for e in special]
    field = Coefficients.containing([entry for row in rows for entry in row])
    return rank([{i: field.read(c) for i, c in enumerate(row) if not is_zero(c)} for row in rows], field)


def _expressions(bracket: Bracket, found: _Found) -> list[Expr]:
    return [polynomial_expression(polynomial, bracket) for _, polynomial in found.generators]


def polynomial_expression(polynomial: Polynomial, bracket: Bracket) -> Expr:
    """A polynomial in the coordinates of the bracket as a SymPy expression."""
    from sympy import Add, Mul

    x, read = bracket.variables, bracket.tensor.field.to_sympy
    polynomial = primitive(polynomial, bracket.tensor.field)
    terms: list[Any] = [Mul(read(c), *(x[i] for i in monomial)) for monomial, c in polynomial.items()]
    return Add(*terms)


def _checked_degree(degree: int | None) -> int | None:
    given: Any = degree
    if given is not None and (isinstance(given, bool) or not isinstance(given, Integral) or given < 1):
        raise ParameterError(f"degree must be an integer of at least 1; got {given!r}. Quadratic ones have degree 2.")
    return degree
