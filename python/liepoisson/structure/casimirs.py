r"""Casimir invariants of a bracket: generators, their number, and what is proved about them.

Each generator is verified by $J \nabla C = 0$.  The number of functionally independent Casimirs is at most the corank
of J at any one point, which is computed exactly; when as many have been found, there are no more.

C1, C2, ... have one normalisation and one order: the coefficient 1 at the leading monomial, by degrees and by leading
monomials (`liepoisson.structure.poisson.polynomials`).  Only the entries of J decide, so that the generators of a
bracket with symbols become those of the bracket with numbers when these are inserted.  Where they do not,
`casimir_report` says so.

References: Olver, Applications of Lie Groups to Differential Equations (1993), section 6.2.

Where a generic null space may change: the roots of what the elimination divided by.

Over the field of rational functions of the parameters, an elimination divides by pivots.  At values where no numerator
and no denominator of a pivot vanishes it goes through unchanged, so the null space has its generic dimension.  What
remains are finitely many irreducible conditions.  With one parameter these are its real roots, all of which are listed.
With several parameters, conditions that are linear in one of them are solved for it, the others staying generic
(intersections of conditions are not examined); the rest is reported as undecided.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import count, zip_longest
from numbers import Integral
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from liepoisson.algebra.exact_numbers import Exact, is_zero, to_sympy
from liepoisson.algebra.rational_polynomials import RationalPolynomial
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import read_parameter
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.structure.certificates import RankCertificate
from liepoisson.structure.poisson.casimir_search import (
    MAX_WORK,
    CasimirSearch,
    homogeneous,
    leibniz_strength,
    lifted,
    n_independent,
    products_of_degree,
    without_constant_factors,
)
from liepoisson.structure.poisson.poisson_tensor import CONSTANT
from liepoisson.structure.poisson.polynomials import expression_of, leading, place
from liepoisson.structure.trace_casimirs import TraceCasimirs, replaces_search

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.algebra.coefficients import Coefficients
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.poisson.casimir_search import AnyTensor

MAX_DEGREE = 6
"""Highest degree that is searched when the caller names none."""


class ExceptionalCase(NamedTuple):
    """Values of parameters at which there are more Casimirs than in general, or which need other generators.

    Attributes:
        condition: For example "epsilon = 0".
        generators: The generators there.
        jumps: The names C1, C2, ... that mean something else there than the limit of what they mean near by.
    """

    condition: str
    generators: list[Expr]
    jumps: tuple[str, ...]


@explains_its_methods
@dataclass(frozen=True)
class CasimirReport:
    """Casimirs of a bracket, and what is known about them.

    Example:
        >>> report = (lp.so(3) @ lp.leibniz(3, "epsilon")).casimir_report()
        >>> report.degrees, report.independent, report.corank, report.complete
        ((2, 2, 2), 3, 3, True)

    Attributes:
        generators: Casimirs of each degree modulo products of those of lower degree; C1, C2, ... in this order.
        degrees: Their degrees.
        dimensions: Number of linearly independent homogeneous Casimirs of each degree that was searched (proved); with
            a constant part of the bracket, of those of at most this degree without a constant.
        independent: Number of functionally independent ones among the generators (proved).
        corank: The corank of J at one point; no more can be independent (proved).
        complete: Whether these two numbers agree: every Casimir is locally a function of the generators.
        exceptional: Values of the parameters with more Casimirs in the degrees searched, with a higher corank, or at
            which the generators are not the limits of the generic ones.
        examined: All values that had to be looked at; elsewhere, the generic answer holds in the degrees searched.
        undecided: Conditions on several parameters that were not looked at.
        verified: Whether J grad C = 0 for every generator, expanded anew; for traces, proved from their matrices.
        method: How they were found, in words.
        limits: Why the search ended before it was complete, or "".
        meanings: Where generators are traces: what the matrix is, for each summand of the algebra; {x} for its name.
    """

    generators: tuple[Expr, ...]
    degrees: tuple[int, ...]
    dimensions: dict[int, int] = field(hash=False)
    independent: int
    corank: int
    complete: bool
    exceptional: tuple[ExceptionalCase, ...]
    examined: tuple[str, ...]
    undecided: tuple[str, ...]
    verified: bool
    method: str
    limits: str
    meanings: tuple[str, ...] = ()


@dataclass
class _Found:
    """The state of a search."""

    tensor: AnyTensor
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
    return list(KnownCasimirs.of(bracket, degree).expressions)


@dataclass(frozen=True)
class KnownCasimirs:
    """The generators that a search finds, as expressions and, where they are such, as rational polynomials.

    Attributes:
        bracket: The bracket.
        found: What was found.
        independent: How many generators are functionally independent (proved to be so many).
    """

    bracket: Bracket
    found: _Found | TraceCasimirs
    independent: int

    @classmethod
    def of(cls, bracket: Bracket, degree: int | None) -> KnownCasimirs:
        """The generators up to a degree, or as far as is needed."""
        found = _traces_or_found(bracket, degree)
        return cls(bracket, found, found.independent)

    @cached_property
    def expressions(self) -> tuple[Expr, ...]:
        """The generators as SymPy expressions."""
        found = self.found
        return found.generators if isinstance(found, TraceCasimirs) else tuple(_expressions(self.bracket, found))

    @cached_property
    def polynomials(self) -> tuple[RationalPolynomial, ...] | None:
        """The same without SymPy; None for traces, and where a coefficient is no rational number."""
        if isinstance(self.found, TraceCasimirs) or not self.bracket.tensor.field.is_rational:
            return None
        write = self.bracket.tensor.field.write
        rational: Any = [{m: write(c) for m, c in polynomial.items()} for _, polynomial in self.found.generators]
        return tuple(map(RationalPolynomial.of, rational))


def shortage(bracket: Bracket) -> str:
    """How many Casimirs are known where not all are, as in "only 1 of 6 independent Casimirs known"; else empty."""
    corank, missing = bracket.corank(), bracket.n_unknown_casimirs
    return f"only {corank - missing} of {corank} independent Casimirs known" if missing else ""


def leading_monomials(bracket: Bracket) -> tuple[tuple[int, ...], ...]:
    """The leading monomials of C1, C2, ..., as indices of coordinates; for traces, their words.

    Among brackets with the same ones the generators depend continuously on the structure constants: each is the one
    solution of a linear system with the same pivots.
    """
    found = _traces_or_found(bracket, None)
    if isinstance(found, TraceCasimirs):
        return found.leading
    return tuple(leading(polynomial, bracket.tensor.block) for _, polynomial in found.generators)


def independent_casimirs(bracket: Bracket) -> int:
    """How many functionally independent Casimirs are found (proved to be so many)."""
    return bracket.corank() - bracket.n_unknown_casimirs


def rank_certificate(bracket: Bracket) -> RankCertificate:
    """Bounds of the generic rank: from below J at one point, from above the Casimirs, or that the rank is even."""
    N, lower = bracket.dimension, bracket.tensor.rank_at_a_point
    even = N - N % 2
    if lower == even:
        return RankCertificate(lower, even, N, f"J has rank {lower} at one point, and no antisymmetric matrix has more")
    n = independent_casimirs(bracket)
    method = f"J has rank {lower} at one point; {n} of {N} directions are gradients of independent Casimirs"
    return RankCertificate(lower, min(even, N - n), N, method)


def _traces_or_found(bracket: Bracket, degree: int | None) -> _Found | TraceCasimirs:
    """What a search finds; traces where it could not end (`replaces_search`), and where it finds less."""
    if degree is None and replaces_search(bracket) and (traces := bracket.trace_casimirs) is not None:
        return traces
    found = _find(bracket, degree)
    return (_more_traces(bracket, found) if degree is None else None) or found


def _more_traces(bracket: Bracket, found: _Found) -> TraceCasimirs | None:
    """The traces, if they are more than a search found that is not complete."""
    traces = None if found.complete else bracket.trace_casimirs
    return traces if traces is not None and traces.independent > found.independent else None


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
    if degree is None and replaces_search(bracket) and (traces := bracket.trace_casimirs) is not None:
        return _report_of_traces(bracket, traces, {})
    search = CasimirSearch(bracket.tensor, with_pivots=bool(bracket.tensor.field.parameters))
    found = _search(search, _checked_degree(degree), _corank(bracket.tensor))
    if degree is None and (closed := _lift(bracket, search.pivots)) is not None:
        closed.dimensions, closed.limits = found.dimensions, "" if closed.complete else found.limits
        found = _better(closed, found)
    if degree is None and (traces := _more_traces(bracket, found)) is not None:
        return _report_of_traces(bracket, traces, found.dimensions)
    exceptional, examined, undecided = _exceptional(bracket, search, found, degree)
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


def _report_of_traces(bracket: Bracket, traces: TraceCasimirs, dimensions: dict[int, int]) -> CasimirReport:
    exceptional, examined, undecided = _exceptional_for_traces(bracket, traces)
    return CasimirReport(
        generators=traces.generators,
        degrees=traces.degrees,
        dimensions=dimensions,
        independent=traces.independent,
        corank=traces.corank,
        complete=traces.complete,
        exceptional=exceptional,
        examined=examined,
        undecided=undecided,
        verified=True,
        method=traces.method,
        limits=traces.limits,
        meanings=traces.meanings,
    )


def _exceptional_for_traces(
    bracket: Bracket, traces: TraceCasimirs
) -> tuple[tuple[ExceptionalCase, ...], tuple[str, ...], tuple[str, ...]]:
    """For Leibniz extensions the strength decides alone; for others special values are not looked for."""
    field, strength = bracket.tensor.field, leibniz_strength(bracket.extension)
    if not field.parameters:
        return (), (), ()
    if strength is None or not bracket.extension.symbols:
        return (), (), (f"values of {', '.join(map(str, field.parameters))} with more Casimirs were not looked for",)

    values, undecided = special_values({field.read(strength)}, field)
    cases: list[ExceptionalCase] = []
    for condition, substitution, special in _brackets_at(bracket, values):
        inserted: Any = {name: to_sympy(value) for name, value in substitution.items()}
        generators = casimir_generators(special)
        jumps = _differing([generator.subs(inserted) for generator in traces.generators], generators)
        if jumps or _corank(special.tensor) > traces.corank:
            cases.append(ExceptionalCase(condition, generators, jumps))
    return tuple(cases), tuple(condition for condition, _ in values), undecided


def quotient_casimirs(tensor: AnyTensor) -> list[Polynomial]:
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
                squares = search.sums_of_squares()
                if not search.tensor.is_homogeneous:
                    squares = search.new_generators(squares, _products(found, d))
                found.generators += [(d, without_constant_factors(polynomial)) for polynomial in squares]
            break
        space = search.of_degree(d)
        found.dimensions[d] = len(space)
        fresh = search.new_generators(space, _products(found, d)) if space else []
        found.generators += [(d, without_constant_factors(polynomial)) for polynomial in fresh]
    return found


def _products(found: _Found, degree: int) -> Iterator[Polynomial]:
    """What the generators so far say about this degree; with a constant part, multiplied by the constant coordinate."""
    if found.tensor.is_homogeneous:
        return products_of_degree(found.generators, degree)
    unit: Polynomial = {(CONSTANT,): found.tensor.field.one}
    known = [(1, unit), *((d, homogeneous(polynomial)) for d, polynomial in found.generators)]
    return (product for product in products_of_degree(known, degree) if any(m[-1] != CONSTANT for m in product))


def _size_limit(degree: int) -> str:
    return f"degree {degree} exceeds the size limit ({MAX_WORK} monomials times coordinates)"


def _lift(bracket: Bracket, pivots: set[Any] | None = None) -> _Found | None:
    """The closed form for Leibniz extensions of higher order, verified; None if this is no such bracket.

    Args:
        bracket: The bracket.
        pivots: What the search for the Casimirs of the Lie algebra divides by is added to it.
    """
    from liepoisson.structure.extensions import leibniz

    if not bracket.has_algebra:
        return None
    n, strength, field = bracket.extension.dimension, leibniz_strength(bracket.extension), bracket.tensor.field
    if n < 2 or strength is None or strength == 0 or field.is_cyclotomic or bracket.constant:
        return None
    base = bracket.algebra @ leibniz(1)
    of_base = CasimirSearch(base.tensor, with_pivots=pivots is not None and bool(base.tensor.field.parameters))
    found = _search(of_base, None, _corank(base.tensor))
    exactly = base.tensor.field.write
    if pivots is not None:
        pivots |= {field.read(exactly(pivot)) for pivot in of_base.pivots}
    generators: list[tuple[int, Polynomial]] = []
    for d, polynomial in found.generators:
        here = {m: field.read(exactly(c)) for m, c in polynomial.items()}
        generators += [(d, casimir) for casimir in lifted(here, bracket.algebra.dimension, n, field.read(strength))]
    generators.sort(key=lambda generator: (generator[0], place(leading(generator[1], base.dimension), base.dimension)))
    search = CasimirSearch(bracket.tensor)
    if any(search.image(polynomial) for _, polynomial in generators):
        return None
    method = f"closed form for Leibniz extensions, from the Casimirs of {bracket.algebra.name}"
    return _Found(bracket.tensor, _corank(bracket.tensor), generators, {}, found.limits, method)


def _corank(tensor: AnyTensor) -> int:
    return tensor.dimension - tensor.rank_at_a_point


def _exceptional(
    bracket: Bracket, search: CasimirSearch, found: _Found, degree: int | None
) -> tuple[tuple[ExceptionalCase, ...], tuple[str, ...], tuple[str, ...]]:
    if not bracket.tensor.field.parameters:
        return (), (), ()

    values, undecided = special_values(search.pivots, bracket.tensor.field)
    generic = _expressions(bracket, found)
    cases: list[ExceptionalCase] = []
    for condition, substitution, special in _brackets_at(bracket, values):
        inner = CasimirSearch(special.tensor)
        more = any(len(inner.of_degree(d)) > n for d, n in found.dimensions.items())
        here = _find(special, degree)
        generators = _expressions(special, here)
        limits = [_limit(generator, substitution, bracket) for generator in generic]
        jumps = _differing(limits, generators)
        if more or jumps or here.independent < found.independent or here.corank > found.corank:
            cases.append(ExceptionalCase(condition, generators, jumps))
    return tuple(cases), tuple(condition for condition, _ in values), undecided


def _brackets_at(
    bracket: Bracket, values: Iterable[tuple[str, Mapping[str, Exact]]]
) -> Iterator[tuple[str, Mapping[str, Exact], Bracket]]:
    """The bracket at each of some values of its parameters, with the condition; none where it has a pole."""
    for condition, substitution in values:
        try:
            special = bracket.substitute(substitution)
        except ParameterError:
            continue
        yield condition, substitution, special


def _limit(generator: Expr, values: Mapping[str, Exact], bracket: Bracket) -> Any:
    """A generator with these values of parameters; None if it has a pole there."""
    from sympy import Add, Mul, Poly, fraction

    inserted: Any = {name: to_sympy(value) for name, value in values.items()}
    terms: list[Any] = []
    for powers, coefficient in Poly(generator, *bracket.variables).terms():
        above, below = (part.subs(inserted) for part in fraction(coefficient.cancel()))
        if is_zero(below):
            return None
        terms.append(Mul(above / below, *(x**n for x, n in zip(bracket.variables, powers, strict=True))))
    return Add(*terms)


def _differing(limits: Sequence[Any], generators: Sequence[Expr]) -> tuple[str, ...]:
    """The names C1, C2, ... of generators that are not these limits of generic ones."""
    pairs: Any = zip_longest(limits, generators)
    return tuple(
        f"C{k}"
        for k, (limit, generator) in enumerate(pairs, start=1)
        if limit is None or generator is None or not is_zero(limit - generator)
    )


def _expressions(bracket: Bracket, found: _Found) -> list[Expr]:
    return [expression_of(polynomial, bracket.variables, bracket.tensor.field) for _, polynomial in found.generators]


def _checked_degree(degree: int | None) -> int | None:
    given: Any = degree
    if given is not None and (isinstance(given, bool) or not isinstance(given, Integral) or given < 1):
        raise ParameterError(f"degree must be an integer of at least 1; got {given!r}. Quadratic ones have degree 2.")
    return degree


SpecialValue: TypeAlias = "tuple[str, dict[str, Exact]]"
"""A condition as text, and the values to insert for it."""


def special_values(pivots: Iterable[Any], field: Coefficients) -> tuple[list[SpecialValue], tuple[str, ...]]:
    """The parameter values at which a null space may be larger, and conditions that were not solved.

    Args:
        pivots: Rational functions, elements of the field.
        field: A field with parameters.
    """
    found: dict[str, dict[str, Exact]] = {}
    undecided: list[str] = []
    for factor in _irreducible_factors(pivots, field):
        if not factor.free_symbols:  # a number such as e, of which nothing is known here
            continue
        solutions = _solve(factor, [s for s in field.parameters if factor.has(s)])
        if solutions is None:
            undecided.append(f"{factor} = 0")
        else:
            found |= {f"{name} = {value}": {name: value} for name, value in solutions}
    return sorted(found.items(), key=_by_size), tuple(undecided)


def _by_size(condition: SpecialValue) -> tuple[Any, ...]:
    """Names in the order of the alphabet, the values of one name by size; values that are no numbers at the end."""
    ((name, value),) = condition[1].items()
    number = to_sympy(value)
    return (name, 0, float(number), "") if number.is_number else (name, 1, 0.0, str(number))


def _irreducible_factors(pivots: Iterable[Any], field: Coefficients) -> list[Any]:
    polynomials = {part for pivot in pivots for part in (pivot.numer, pivot.denom) if not part.is_ground}
    factors = {factor for polynomial in polynomials for factor, _ in polynomial.factor_list()[1]}
    return sorted((factor.as_expr(*field.parameters) for factor in factors), key=str)


def _solve(factor: Any, symbols: list[Any]) -> list[tuple[str, Exact]] | None:
    """Solutions name = value of factor = 0, or None if none can be written down."""
    from sympy import Poly

    if not all(symbol.is_Symbol for symbol in symbols):
        return None
    if len(symbols) == 1:
        roots = Poly(factor, symbols[0]).real_roots(multiple=False)
        return [(str(symbols[0]), read_parameter(root, str(symbols[0]))) for root, _ in roots]
    for symbol in symbols:
        polynomial = Poly(factor, symbol)
        if polynomial.degree() == 1:
            slope, constant = polynomial.all_coeffs()
            return [(str(symbol), read_parameter((-constant / slope).cancel(), str(symbol)))]
    return None
