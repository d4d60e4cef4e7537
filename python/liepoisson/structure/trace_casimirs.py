r"""Casimirs in closed form for g (x) A, g an algebra of matrices: traces of products, and Pfaffians.

The matrix X of a state (see `liepoisson.structure.lie.defining_matrices`) moves by conjugation, so the traces
$\operatorname{tr} X^k$ are Casimirs of g: k = 2, ..., n for sl(n), su(n) and the sine algebra, from 1 for gl(n), even k
for so(n), whose last one is the Pfaffian if n is even.  With several fields they are polarised over A
(`liepoisson.structure.trace_words`).  Nothing is expanded: they stay `liepoisson.structure.trace.Trace`.

The order, and with it the index of C1, C2, ...: by degree; at one degree by summands of g, traces before Pfaffians; for
each of these the n Casimirs of a Leibniz extension as the coefficients of $z^{n-1}, \dots, z^0$.  A trace enters as it
is, without the common factor of the multiplicities of its words; one that depends on those before it is left out.

What is proved: equation (1) of `defining_matrices` for all basis elements, exactly, hence $J\nabla C = 0$; this is
computed at a random exact point besides.  Independence, from below, by the rank of the gradients modulo a prime.

Products of matrices modulo a prime, over the rationals and over cyclotomic fields stand behind one set of functions.

References: Rais and Tauvel, J. reine angew. Math. 425 (1992) 123; Procesi, Adv. Math. 19 (1976) 306, on words.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from math import comb, prod
from operator import mul
from random import Random
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import Exact, is_zero, to_sympy
from liepoisson.algebra.linear_algebra import rank_mod
from liepoisson.algebra.number_fields import as_fmpq
from liepoisson.algebra.residues import Residues
from liepoisson.algebra.sparse_polynomials import Polynomial
from liepoisson.structure.lie.defining_matrices import (
    DefiningMatrices,
    Entries,
    defining_matrices,
    holds_roots,
    in_field,
    sparse_product,
)
from liepoisson.structure.poisson.casimir_search import MAX_WORK, CasimirSearch, leibniz_strength, lifted
from liepoisson.structure.poisson.polynomials import gradient_at
from liepoisson.structure.trace_words import Combination, Word, balanced_combinations, leibniz_combinations, rotations

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.lie_algebra import LieAlgebra

MOST_TERMS = 5000
"""Of an expanded Pfaffian with its polarisations; beyond it the trace of degree 2m takes its place, its square."""


@dataclass(frozen=True)
class TraceCasimirs:
    """Casimirs in closed form.

    Attributes:
        generators: Sums of traces; polynomials for Pfaffians.
        degrees: Their degrees.
        corank: The corank of J at one point.
        method: How they were found, in words.
        meanings: What the matrix of a field is, one sentence for each summand of g; {x} stands for the field.
        limits: Why there may be more, or "".
        leading: For each generator the number of its summand, and its first word or the first monomial of a Pfaffian:
            brackets that agree in these have the same generators up to the values of coefficients.
    """

    generators: tuple[Expr, ...]
    degrees: tuple[int, ...]
    corank: int
    method: str
    meanings: tuple[str, ...]
    limits: str
    leading: tuple[tuple[int, ...], ...]

    @property
    def independent(self) -> int:
        """Number of functionally independent ones: all, those that depend on others are left out (proved)."""
        return len(self.generators)

    @property
    def complete(self) -> bool:
        """Whether they are as many as the corank allows."""
        return self.independent == self.corank


@dataclass(frozen=True)
class _Candidate:
    """A Casimir that may depend on those before it: traces of words in one summand, or a polynomial."""

    degree: int
    part: int
    words: Combination | None = None
    polynomial: Polynomial | None = None


def summands(algebra: LieAlgebra) -> Iterator[tuple[int, LieAlgebra]]:
    """The direct summands that an algebra was made of, each with the number of its first basis element."""
    start = 0
    for part in algebra.summands or (algebra,):
        yield start, part
        start += part.dimension


def replaces_search(bracket: Bracket) -> bool:
    """Whether a search could not end: the rule by which closed forms stand in place of expanded polynomials.

    It needs all monomials of the highest degree d of the closed form for g, at most 200,000 of them times coordinates.
    For Leibniz extensions the search is that for g, whose Casimirs are lifted; for others it is that for g (x) A.
    """
    if not bracket.has_algebra or bracket.constant:
        return False
    strength = leibniz_strength(bracket.extension)
    lifts = strength is not None and not is_zero(strength) and not bracket.tensor.field.is_cyclotomic
    N, most = bracket.algebra.dimension if lifts else bracket.dimension, bracket.algebra.dimension + 1
    if N * comb(N + most - 1, most) <= MAX_WORK:  # whatever the matrices are, their size is below this
        return False
    parts = [defining_matrices(part) for _, part in summands(bracket.algebra)]
    degrees = [max((*part.degrees, part.pfaffian)) for part in parts if part is not None]
    if len(degrees) < len(parts):
        return False
    d = max(degrees)
    return N * comb(N + d - 1, d) > MAX_WORK


def trace_casimirs(bracket: Bracket) -> TraceCasimirs | None:
    """Independent Casimirs in closed form, verified, whatever the size; None where none is known.

    None if a summand of g was not made by a constructor of `structure.lie_algebras` or is no algebra of matrices with
    an invariant form (se(n), affine(n), Heisenberg), if its structure constants are not those of its matrices, or if
    the bracket has a constant part.
    """
    return None if not bracket.has_algebra or bracket.constant else _Traces.of(bracket)


def modulo_casimirs(expression: Expr, bracket: Bracket) -> tuple[Expr, dict[Any, Expr]]:
    """A function on phase space in which Casimirs are symbols, as far as it contains their traces, and their meaning.

    One trace of each Casimir is written as the Casimir less its other terms: its gradient does not matter under J.
    """
    from sympy import Dummy

    from liepoisson.structure.trace import traces_in

    occurring = traces_in(expression)
    known = bracket.trace_casimirs if occurring else None
    if known is None:
        return expression, {}
    replaced: dict[Any, Any] = {}
    meaning: dict[Any, Expr] = {}
    for generator in known.generators:
        others = {trace for other in known.generators if other is not generator for trace in traces_in(other)}
        for trace in sorted((traces_in(generator) & occurring) - others, key=str)[:1]:
            constant = Dummy()
            coefficient = generator.coeff(trace)
            replaced[trace] = (constant - (generator - coefficient * trace)) / coefficient
            meaning[constant] = generator
    return cast("Expr", expression.xreplace(replaced)), meaning


class _Traces:
    """The matrices of all summands of g, and the candidates that they give."""

    def __init__(self, bracket: Bracket, parts: list[tuple[int, DefiningMatrices]]) -> None:
        self.bracket, self.parts = bracket, parts
        self.n, self.d = bracket.extension.dimension, bracket.algebra.dimension
        self.field = bracket.tensor.field

    @classmethod
    def of(cls, bracket: Bracket) -> TraceCasimirs | None:
        """The Casimirs, or None where a summand has no matrices that are proved to be its own."""
        parts: list[tuple[int, DefiningMatrices]] = []
        for start, algebra in summands(bracket.algebra):
            found = defining_matrices(algebra)
            if found is None or not holds_roots(bracket.tensor.field, found.order) or found.defect(algebra):
                return None
            parts.append((start, found))
        return None if bracket.tensor.generic_rank is None else cls(bracket, parts).casimirs()

    def casimirs(self) -> TraceCasimirs | None:
        """The independent ones among the candidates, verified at a point; None if one of them is no Casimir."""
        generic: Any = self.bracket.tensor.generic_rank
        corank, residues = self.bracket.dimension - generic.rank, generic.residues
        modular = _Gradients(self, generic.point, modular_arithmetic(residues))
        kept: list[_Candidate] = []
        rows: list[dict[int, int]] = []
        for candidate in self._candidates():
            if len(kept) == corank:
                break
            row = {i: int(slope) for i, slope in modular.of(candidate).items()}
            if rank_mod([*rows, row], self.bracket.dimension, residues.p) > len(rows):
                kept.append(candidate)
                rows.append(row)
        if not self._hold_at_a_point(kept):
            return None
        return TraceCasimirs(
            tuple(map(self._expression, kept)),
            tuple(candidate.degree for candidate in kept),
            corank,
            f"closed form: invariants of the matrices of {self.bracket.algebra.name}",
            tuple(part.meaning for _, part in self.parts),
            "" if len(kept) == corank else "no others are known in closed form",
            tuple((candidate.part, *min(candidate.words or candidate.polynomial or ())) for candidate in kept),
        )

    def _candidates(self) -> Iterator[_Candidate]:
        strength = leibniz_strength(self.bracket.extension)
        if strength is None or (self.n > 1 and is_zero(strength)):
            yield from self._words()
            return
        highest = max(2 * part.size for _, part in self.parts)
        for degree in range(1, highest + 1):
            for k, (_, part) in enumerate(self.parts):
                pfaffian = part.pfaffian if self._n_terms(part) <= MOST_TERMS else 0
                if degree in part.degrees or (part.pfaffian and not pfaffian and degree == 2 * part.pfaffian):
                    all_powers = leibniz_combinations(self.n, degree, to_sympy(strength))
                    yield from (_Candidate(degree, k, words) for words in all_powers)
                if degree == pfaffian:
                    for polynomial in self._pfaffians(k, strength):
                        yield _Candidate(degree, k, polynomial=polynomial)

    def _words(self) -> Iterator[_Candidate]:
        """For extensions that are no Leibniz extensions: all words, as far as there are not too many."""
        for degree in range(1, 2 * max(part.size for _, part in self.parts) + 1):
            balanced = balanced_combinations(self.bracket.extension, degree)
            for k in range(len(self.parts)):
                yield from (_Candidate(degree, k, words) for words in balanced)

    def _n_terms(self, part: DefiningMatrices) -> int:
        return prod(range(1, 2 * part.pfaffian, 2)) * comb(part.pfaffian + self.n - 1, self.n - 1)

    def _pfaffians(self, k: int, strength: Exact) -> list[Polynomial]:
        """The Pfaffian of the coordinates x_ij, i < j, if J grad C = 0 on g, expanded; lifted to the extension."""
        from liepoisson.structure.extensions import trivial

        start, part = self.parts[k]
        places = {pair: start + k for k, pair in enumerate(combinations(range(2 * part.pfaffian), 2))}
        base = (self.bracket.algebra @ trivial()).tensor
        one = base.field.one
        pfaffian: Polynomial = {
            tuple(sorted(places[pair] for pair in matching)): one if sign > 0 else -one
            for sign, matching in _matchings(tuple(range(2 * part.pfaffian)))
        }
        if CasimirSearch(base).image(pfaffian):
            return []
        here = {monomial: self.field.number(sign) for monomial, sign in pfaffian.items()}
        return lifted(here, self.d, self.n, self.coefficient(to_sympy(strength)))

    def _hold_at_a_point(self, kept: list[_Candidate]) -> bool:
        """Whether J grad C = 0 at a point, for a sum C of all with integer weights; all integers random, exact."""
        random = Random(1)
        point = [random.randrange(-9, 10) for _ in range(self.bracket.dimension)]
        rational = all(part.order == 1 for _, part in self.parts)
        exact = _Gradients(
            self, point, rational_arithmetic(self.field) if rational else cyclotomic_arithmetic(self.field)
        )
        total: dict[int, Any] = {}
        for candidate in kept:
            weight = self.field.number(random.randrange(1, 1000))
            for i, slope in exact.of(candidate).items():
                total[i] = total[i] + weight * slope if i in total else weight * slope
        rows = self.bracket.tensor.at([self.field.number(x) for x in point])
        images = (_dot(row, total) for row in rows)
        return not any(image is not None and not self.field.vanishes(image) for image in images)

    def coefficient(self, value: Any) -> Any:
        """A coefficient of a word as an element of the field."""
        return self.field.number(Fraction(int(value.p), int(value.q))) if value.is_Rational else self.field.read(value)

    def _expression(self, candidate: _Candidate) -> Expr:
        from sympy import Add

        from liepoisson.structure.poisson.polynomials import expression_of
        from liepoisson.structure.trace import MatrixMap, Trace

        if candidate.words is None:
            assert candidate.polynomial is not None
            return expression_of(candidate.polynomial, self.bracket.variables, self.bracket.tensor.field)
        start, part = self.parts[candidate.part]
        matrices = MatrixMap.of(part, candidate.part + 1 if len(self.parts) > 1 else 0)
        x, names = self.bracket.variables, self.bracket.field_names
        terms: list[Any] = []
        for word, q in candidate.words.items():
            fields = sorted(set(word))
            first = [f * self.d + start for f in fields]
            coordinates = [x[i] for a in first for i in range(a, a + len(part.matrices))]
            letters = [fields.index(f) for f in word]
            terms.append(q * Trace(matrices, [names[f] for f in fields], letters, *coordinates))
        return Add(*terms)


class _Gradients:
    """Gradients of candidates at one point."""

    def __init__(self, traces: _Traces, point: Sequence[int], arithmetic: Arithmetic) -> None:
        self.traces, self.point, self.arithmetic = traces, point, arithmetic
        self.entries = [
            [
                {place: arithmetic.number(c) for place, c in _elements(matrix, part.order, traces.field).items()}
                for matrix in part.matrices
            ]
            for _, part in traces.parts
        ]
        self.products: dict[tuple[int, Word], Any] = {}

    def of(self, candidate: _Candidate) -> dict[int, Any]:
        """The components by coordinate, those that vanish left out or zero."""
        if candidate.words is not None:
            return self._of_words(candidate.part, candidate.words)
        assert candidate.polynomial is not None
        to_result, number = self.arithmetic.result, self.arithmetic.number
        polynomial = {monomial: self.arithmetic.coefficient(c) for monomial, c in candidate.polynomial.items()}
        return gradient_at(polynomial, [to_result(number(x)) for x in self.point])

    def _of_words(self, k: int, words: Combination) -> dict[int, Any]:
        r"""By $d \operatorname{tr}(X \cdots Y) = \sum \operatorname{tr}(X \cdots dY)$ over all rotations."""
        from sympy import Rational

        start, part = self.traces.parts[k]
        arithmetic, gradient = self.arithmetic, dict[int, Any]()
        for word, q in words.items():
            turned = rotations(word)
            multiplicity = Rational(len(word), len(turned) * part.copies)
            weight = arithmetic.coefficient(self.traces.coefficient(q * multiplicity))
            for turn in turned:
                matrix = self._product(k, turn[:-1])
                for i, entries in enumerate(self.entries[k]):
                    terms = [c * arithmetic.entry(matrix, b, a) for (a, b), c in entries.items()]
                    place = turn[-1] * self.traces.d + start + i
                    slope = weight * arithmetic.result(sum(terms[1:], terms[0]))
                    gradient[place] = gradient[place] + slope if place in gradient else slope
        return {place: slope for place, slope in gradient.items() if slope}

    def _product(self, k: int, word: Word) -> Any:
        if (k, word) not in self.products:
            if len(word) > 1:
                found = self.arithmetic.times(self._product(k, word[:-1]), self._product(k, word[-1:]))
            else:
                found = self._matrix(k, word)
            self.products[k, word] = found
        return self.products[k, word]

    def _matrix(self, k: int, word: Word) -> Any:
        """The matrix of one letter; the unit matrix of none."""
        start, part = self.traces.parts[k]
        entries: dict[tuple[int, int], Any] = {}
        if not word:
            entries = {(i, i): self.arithmetic.number(1) for i in range(part.size)}
        for i, matrix in enumerate(self.entries[k] if word else ()):
            x = self.arithmetic.number(self.point[word[0] * self.traces.d + start + i])
            for place, c in matrix.items():
                entries[place] = entries[place] + x * c if place in entries else x * c
        return self.arithmetic.matrix(part.size, entries)


def _elements(matrix: Entries, order: int, field: Coefficients) -> dict[tuple[int, int], Any]:
    """The entries as Fractions where they are rational, else as elements of the field."""
    return in_field(matrix, Coefficients() if order == 1 else field, order)


def _dot(row: Mapping[int, Any], vector: Mapping[int, Any]) -> Any:
    terms = [c * vector[i] for i, c in row.items() if i in vector]
    return sum(terms[1:], terms[0]) if terms else None


def _matchings(left: tuple[int, ...]) -> Iterator[tuple[int, tuple[tuple[int, int], ...]]]:
    """All ways to pair indices, with the sign that each has in the Pfaffian."""
    if not left:
        yield 1, ()
        return
    first, rest = left[0], left[1:]
    for k, partner in enumerate(rest):
        for sign, matching in _matchings(rest[:k] + rest[k + 1 :]):
            yield (-sign if k % 2 else sign), ((first, partner), *matching)


@dataclass(frozen=True)
class Arithmetic:
    """How matrices are multiplied, and in what the results are.

    Attributes:
        number: An entry of the F^k, or a coordinate, as a number of the matrices.
        matrix: A matrix from its number of rows and its nonzero entries.
        entry: An entry of a matrix.
        times: The product of two matrices.
        result: A number of the matrices as a result.
        coefficient: An element of the field of the bracket as a result.
    """

    number: Callable[[Any], Any]
    matrix: Callable[[int, dict[tuple[int, int], Any]], Any]
    entry: Callable[[Any, int, int], Any]
    times: Callable[[Any, Any], Any]
    result: Callable[[Any], Any]
    coefficient: Callable[[Any], Any]


def modular_arithmetic(residues: Residues) -> Arithmetic:
    """Modulo the prime of the residues, by python-flint."""
    from flint import nmod, nmod_mat

    def matrix(m: int, entries: dict[tuple[int, int], Any]) -> Any:
        return nmod_mat([[int(entries.get((i, j), 0)) for j in range(m)] for i in range(m)], residues.p)

    def number(value: Any) -> Any:
        return nmod(residues(value), residues.p)

    return Arithmetic(number, matrix, lambda M, i, j: M[i, j], mul, int, lambda c: nmod(residues(c), residues.p))


def rational_arithmetic(field: Coefficients) -> Arithmetic:
    """In rational matrices, by python-flint; results are elements of the field."""
    from flint import fmpq_mat

    def matrix(m: int, entries: dict[tuple[int, int], Any]) -> Any:
        return fmpq_mat([[entries.get((i, j), 0) for j in range(m)] for i in range(m)])

    def number(value: Any) -> Any:
        return as_fmpq(Fraction(value))

    def result(value: Any) -> Any:
        return field.number(Fraction(int(value.p), int(value.q)))

    return Arithmetic(number, matrix, lambda M, i, j: M[i, j], mul, result, lambda c: c)


def cyclotomic_arithmetic(field: Coefficients) -> Arithmetic:
    """In sparse matrices of elements of a cyclotomic field."""
    zero = field.zero

    def number(value: Any) -> Any:
        return field.number(value) if isinstance(value, (int, Fraction)) else value

    return Arithmetic(
        number, lambda _m, entries: entries, lambda M, i, j: M.get((i, j), zero), sparse_product, lambda c: c, number
    )
