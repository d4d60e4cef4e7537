r"""What is known of the leaves of a tensor that is given by formulas: its Casimirs and its strata.

Casimirs come from three places, in this order: those that were given, products of powers of a log-canonical tensor, and
the search for polynomials.  Of each only those are taken that are independent of the ones before.

Rational ones, C = P/Q in lowest terms, have $\{x_i, C\} = 0$ where $Q \{x_i, P\} = P \{x_i, Q\}$, so that P divides
$\{x_i, P\}$ and Q divides $\{x_i, Q\}$ with one quotient $\lambda_i$: both are normal, with the same factors.  For a
product Q of normal functions that are known this is a linear system for P.

References: Goodearl and Launois, Bull. Soc. Math. France 139 (2011) 1, for Poisson normal elements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from itertools import combinations, combinations_with_replacement
from math import comb, prod
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.ideals.components import Assumptions, components, irreducible_factors
from liepoisson.algebra.ideals.groebner import groebner_basis, rational_context
from liepoisson.algebra.ideals.limits import Limits, NotDecidedError
from liepoisson.algebra.ideals.operations import radical_contains
from liepoisson.algebra.ideals.polynomial_system import polynomial
from liepoisson.algebra.linear_algebra import nullspace, rank
from liepoisson.algebra.rational_polynomials import RationalPolynomial
from liepoisson.errors import BracketError, ParameterError
from liepoisson.inputs.deadline import checkpoint
from liepoisson.structure import casimirs as search
from liepoisson.structure.locus import Locus, Stratum
from liepoisson.structure.poisson.casimir_search import MAX_WORK
from liepoisson.structure.poisson.pfaffians import pfaffian_of

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.tensor_bracket import PoissonTensor

MOST_COORDINATES = 8
"""Of a tensor whose Pfaffians are taken: 70 of size 4."""
MOST_LISTED = 6
"""Coordinates of a log-canonical tensor whose 2^n strata are listed."""


@dataclass(frozen=True)
class TensorCasimirs:
    """The Casimirs of a tensor, as `liepoisson.structure.casimirs.KnownCasimirs` has those of a Lie-Poisson bracket.

    Attributes:
        bracket: The tensor.
        expressions: The Casimirs.
        independent: How many are functionally independent.
        limits: Why the search ended before they were complete, or "".
        method: How they were found, in words.
    """

    bracket: PoissonTensor
    expressions: tuple[Expr, ...]
    independent: int
    limits: str
    method: str

    @classmethod
    def of(cls, bracket: PoissonTensor, degree: int | None) -> TensorCasimirs:
        """All that are known; with a degree, the polynomials up to it that the search finds."""
        if degree is not None:
            known = search.KnownCasimirs.of(bracket, degree)
            return cls(bracket, known.expressions, known.independent, "", _SEARCHED)
        tensor, corank = bracket.formulas, bracket.corank()
        found, methods = list(bracket.given_casimirs), ["given"] if bracket.given_casimirs else []
        n, limits = tensor.n_independent(found) if found else 0, ""
        sources = {"powers of the coordinates": tensor.log_canonical_casimirs, _SEARCHED: partial(_searched, bracket)}
        for method, source in sources.items():
            if n >= corank:
                break
            for candidate in source() or ():
                if n < corank and tensor.n_independent([*found, candidate]) > n:
                    found, n = [*found, candidate], n + 1
                    methods += [method] if method not in methods else []
        if n < corank:
            limits = f"polynomials were searched up to degree {search.MAX_DEGREE} at most"
            limits = limits if tensor.is_rational else "none are searched, as the entries are no rational functions"
        return cls(bracket, tuple(found), n, limits, ", ".join(methods))

    @cached_property
    def polynomials(self) -> tuple[RationalPolynomial, ...] | None:
        """The Casimirs as polynomials; None if one has no rational numbers as coefficients."""
        from sympy import Poly

        found: list[RationalPolynomial] = []
        for casimir in self.expressions:
            if not casimir.is_polynomial(*self.bracket.variables):
                return None
            terms: Any = Poly(casimir, *self.bracket.variables).terms()
            if not all(c.is_Rational for _, c in terms):
                return None
            found.append(RationalPolynomial.of({_factors(m): Fraction(int(c.p), int(c.q)) for m, c in terms}))
        return tuple(found)


_SEARCHED = "linear algebra on all monomials of a degree"


def _searched(bracket: PoissonTensor) -> Sequence[Expr]:
    """Polynomials; none where the entries are no rational functions."""
    return search.KnownCasimirs.of(bracket, None).expressions if bracket.formulas.is_rational else ()


def casimir_report(bracket: PoissonTensor, degree: int | None) -> search.CasimirReport:
    """The Casimirs with what is proved: those of a search as of any bracket, others by their image."""
    only_searched = not bracket.given_casimirs and bracket.formulas.log_canonical is None
    if degree is not None or (only_searched and bracket.formulas.is_rational):
        return search.casimir_report(bracket, degree)
    known = TensorCasimirs.of(bracket, None)
    corank = bracket.corank()
    return search.CasimirReport(
        generators=known.expressions,
        degrees=tuple(_degree(casimir, bracket) for casimir in known.expressions),
        dimensions={},
        independent=known.independent,
        corank=corank,
        complete=known.independent == corank,
        exceptional=(),
        examined=(),
        undecided=("values of the parameters with more Casimirs were not looked for",) if bracket.symbols else (),
        verified=not any(bracket.formulas.image(casimir) for casimir in known.expressions),
        method=known.method,
        limits=known.limits,
    )


def _degree(casimir: Expr, bracket: PoissonTensor) -> int:
    """The degree of a polynomial; 0 of any other function."""
    from sympy import Poly

    if not casimir.is_polynomial(*bracket.variables):
        return 0
    return int(Poly(casimir, *bracket.variables).total_degree())


def strata(bracket: PoissonTensor) -> list[Stratum]:
    """The strata by decreasing rank; the open one alone where the others are not found.

    Of a log-canonical tensor they are the sets where some coordinates vanish and the others do not; of any other that
    is polynomial with rational numbers, the sets where Pfaffians of one size vanish and those of the next do not all.
    """
    numbers = bracket.formulas.log_canonical
    if numbers and bracket.dimension <= MOST_LISTED:
        return sorted(_log_canonical_strata(bracket), key=lambda stratum: -stratum.rank)
    if (found := _strata_by_pfaffians(bracket)) is not None:
        return found
    certificate = bracket.rank_certificate()
    complete, casimirs = not bracket.n_unknown_casimirs, bracket.casimirs
    is_constant = not any(entry.free_symbols & {*bracket.variables} for entry in bracket.formulas.entries.values())
    locus = Locus(is_generic=not is_constant)
    text = f"{certificate.method}; J is constant" if is_constant else certificate.method
    return [Stratum(locus, certificate.lower, casimirs, text, is_constant, complete)]


def _strata_by_pfaffians(bracket: PoissonTensor) -> list[Stratum] | None:
    """The sets where the rank is r, r - 2, ...; those without real points are left out.

    None where an entry is no polynomial with rational numbers, or the limits of the ideals are reached.
    """
    names, n = bracket.field_names, bracket.dimension
    if bracket.symbols or n > MOST_COORDINATES:
        return None
    context, budget = rational_context(names), Limits().budget()
    found: list[Stratum] = []
    try:
        entries = {pair: polynomial(entry, context) for pair, entry in bracket.formulas.entries.items()}
        nothing = context.constant(0)
        pfaffian = pfaffian_of(lambda i, j: entries.get((i, j), nothing), zero=nothing, one=context.constant(1))
        here = groebner_basis([nothing], budget)
        for size in range(bracket.rank(), -1, -2):
            functions = [_square_free(p) for rows in combinations(range(n), size) if (p := pfaffian(rows))]
            if not all(radical_contains(here, p, budget) for p in functions):
                below = components([*here.polynomials, *functions], Assumptions(is_real=True), budget)
                others = [q for p in functions if (q := here.remainder(p))] if below else []
                not_all = groebner_basis(others, budget).polynomials if others else ()
                locus = Locus(
                    vanishing=tuple(str(p) for p in reversed(here.polynomials)),
                    not_all_vanish=tuple(str(_square_free(p)) for p in reversed(not_all)),
                )
                found.append(_stratum(bracket, locus, size, is_open=not found))
                if not below:
                    return found
                here = below[0].basis if len(below) == 1 else groebner_basis([*here.polynomials, *functions], budget)
    except (ParameterError, NotDecidedError):
        return None
    return found


def _stratum(bracket: PoissonTensor, locus: Locus, size: int, *, is_open: bool) -> Stratum:
    """The set where the rank is the size of Pfaffians; where it is zero the coordinates are constant."""
    casimirs: Callable[[], Sequence[Expr]] = bracket.casimirs if size else lambda: bracket.variables
    complete = not bracket.n_unknown_casimirs if is_open else not size
    return Stratum(locus, size, casimirs, f"the Pfaffians of size {size}", proved=True, complete=complete)


def _square_free(p: Any) -> Any:
    """A polynomial with the same zeros, each factor once."""
    return prod(irreducible_factors(p), start=p.context().constant(1))


def _log_canonical_strata(bracket: PoissonTensor) -> Iterator[Stratum]:
    from liepoisson.structure.poisson.tensor_entries import TensorEntries

    numbers, names = bracket.formulas.log_canonical or {}, bracket.field_names
    field = Coefficients.containing(numbers.values())
    for size in range(len(names), -1, -1):
        for kept in combinations(range(len(names)), size):
            rows: list[dict[int, Any]] = [{} for _ in names]
            for (i, j), c in numbers.items():
                if i in kept and j in kept:
                    rows[i][j], rows[j][i] = field.read(c), -field.read(c)
            locus = Locus(
                zero=tuple(name for k, name in enumerate(names) if k not in kept),
                nonzero=tuple((names[k],) for k in kept),
            )
            here = rank([row for row in rows if row], field)
            # the coordinates that do not vanish have the bracket of their own
            own = {pair: entry for pair, entry in bracket.formulas.entries.items() if {*pair} <= {*kept}}
            functions = partial(_of_kept, TensorEntries(bracket.variables, own), kept)
            casimirs = bracket.casimirs if size == len(names) else functions
            yield Stratum(locus, here, casimirs, "the rank of c without the coordinates that vanish", proved=True)


def _of_kept(entries: Any, kept: Sequence[int]) -> tuple[Expr, ...]:
    """The Casimirs of the bracket of some coordinates, functions of these alone."""
    own = {entries.variables[k] for k in kept}
    return tuple(c for c in entries.log_canonical_casimirs() or () if c.free_symbols & {*entries.variables} <= own)


def rational_casimirs(bracket: PoissonTensor, degree: int) -> list[Expr]:
    """Independent Casimirs P/Q of at most a degree, Q a product of normal factors of the entries.

    Raises:
        BracketError: the entries are not rational functions.
        ParameterError: the degree is not a positive integer, or too large for the search.
    """
    tensor, N = bracket.formulas, bracket.dimension
    if not tensor.is_rational:
        raise BracketError(f"wanted entries that are rational functions of the coordinates; got those of {bracket!r}.")
    given: Any = degree
    if isinstance(given, bool) or not isinstance(given, int) or degree < 1:
        raise ParameterError(f"degree must be an integer of at least 1; got {degree!r}. Write for example degree=2.")
    if N * comb(N + degree, degree) > MAX_WORK:
        raise ParameterError(
            f"the search must stay below its size limit; degree {degree} exceeds it. Lower the degree."
        )
    found: list[Expr] = []
    corank, n = bracket.corank(), 0
    for Q in _denominators(bracket, degree):
        checkpoint("rational Casimirs")
        if n >= corank:
            break
        for P in _with_the_same_factors(bracket, Q, degree):
            quotient: Any = (P / Q).cancel()
            is_new = quotient.free_symbols & {*bracket.variables} and n < corank
            if is_new and tensor.n_independent([*found, quotient]) > n and not tensor.image(quotient):
                found, n = [*found, quotient], n + 1
    return found


def _denominators(bracket: PoissonTensor, degree: int) -> Iterator[Expr]:
    """Products of normal factors of the entries, by their number; 1 first."""
    from sympy import Mul, Poly

    factors = list(_normal_factors(bracket))
    for size in range(degree + 1):
        for chosen in combinations_with_replacement(factors, size):
            product: Any = Mul(*chosen)
            if Poly(product, *bracket.variables).total_degree() <= degree:
                yield product


def _normal_factors(bracket: PoissonTensor) -> Iterable[Expr]:
    """The irreducible factors F of numerators and denominators of the entries that divide all {x_i, F}."""
    from sympy import Poly, factor_list, fraction, together

    found: dict[Expr, None] = {}
    for entry in bracket.formulas.entries.values():
        for part in fraction(together(entry)):
            for factor, _ in factor_list(part)[1]:
                if factor not in found and factor.free_symbols & {*bracket.variables}:
                    rates = bracket.vector_field(factor)
                    parts: list[Any] = [fraction(together(rate))[0] for rate in rates]
                    divisor = Poly(factor, *bracket.variables)
                    if all(Poly(part, *bracket.variables).rem(divisor).is_zero for part in parts):
                        found[factor] = None
    return found


def _with_the_same_factors(bracket: PoissonTensor, Q: Expr, degree: int) -> Iterator[Expr]:
    """A basis of the polynomials P of at most a degree with Q {x_i, P} = P {x_i, Q} for all i, by their degrees."""
    from sympy import Add, Mul, Poly, fraction, together

    x, entries = bracket.variables, bracket.formulas.cleared
    assert entries is not None
    polynomials = {
        pair: Add(*(entries.field.to_sympy(c) * Mul(*(x[k] for k in m)) for m, c in terms.items()))
        for pair, terms in entries.entries.items()
    }
    slopes: list[Any] = [Q.diff(v) for v in x]
    monomials = [m for d in range(degree, -1, -1) for m in combinations_with_replacement(range(len(x)), d)]
    rows: dict[tuple[int, tuple[int, ...]], dict[int, Any]] = {}
    for column, monomial in enumerate(monomials):
        P: Any = Mul(*(x[k] for k in monomial))
        # Q {x_i, P} - P {x_i, Q} is linear in P
        weights: list[Any] = [Q * P.diff(v) - P * slope for v, slope in zip(x, slopes, strict=True)]
        sums: list[Any] = [0] * len(x)
        for (i, j), entry in polynomials.items():
            sums[i], sums[j] = sums[i] + entry * weights[j], sums[j] - entry * weights[i]
        for i, total in enumerate(sums):
            for powers, c in Poly(fraction(together(total))[0] if total else 0, *x).terms():
                if c != 0:
                    rows.setdefault((i, powers), {})[column] = c
    field = Coefficients.containing(_exact(c) for row in rows.values() for c in row.values())
    read = [{column: field.read(_exact(c)) for column, c in row.items()} for row in rows.values()]
    vectors = nullspace(read, len(monomials), field).vectors
    for vector in sorted(vectors, key=lambda vector: max(len(monomials[column]) for column in vector)):
        terms = (field.to_sympy(c) * Mul(*(x[k] for k in monomials[column])) for column, c in vector.items())
        yield Add(*terms)


def _exact(value: Any) -> Any:
    return Fraction(int(value.p), int(value.q)) if value.is_Rational else value


def _factors(powers: Sequence[int]) -> tuple[int, ...]:
    return tuple(k for k, power in enumerate(powers) for _ in range(power))
