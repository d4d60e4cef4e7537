r"""Semi-invariants of linear brackets, $\{x_i, F\} = \lambda_i F$, and the rational Casimirs that are made of them.

The weight $\lambda$ of a polynomial F consists of numbers, as J is of degree one; it vanishes on [g, g].  So F is among
the polynomials that commute with [g, g], on which the other coordinates act by matrices that commute: F is a common
eigenvector.  A factor of a semi-invariant is one, too, and a quotient P/Q in lowest terms is a Casimir if and only if P
and Q are semi-invariants of one weight.  Up to a degree all rational Casimirs are found in this way whose weights lie
in the field of the structure constants; if a weight does not, the product of F with its conjugates, which has a higher
degree, has one that does.

A constant part belongs to one more coordinate, 1, which commutes with all and has the degree 1.

References: Dixmier, Enveloping Algebras (1977), section 4.3, for semi-invariants; Patera, Sharp, Winternitz and
Zassenhaus, J. Math. Phys. 17 (1976) 986.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations_with_replacement
from math import comb
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, Vector
from liepoisson.algebra.linear_algebra import nullspace
from liepoisson.algebra.matrices import characteristic_polynomial
from liepoisson.algebra.real_fields import RealField, RealRationals, real_field
from liepoisson.algebra.sparse_polynomials import Monomial, Polynomial
from liepoisson.errors import BracketError, ParameterError
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.deadline import checkpoint
from liepoisson.structure.poisson.casimir_search import MAX_WORK, without_constant_factors
from liepoisson.structure.poisson.poisson_tensor import CONSTANT
from liepoisson.structure.poisson.polynomials import multiply

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.structure.poisson.tensor_entries import TensorEntries

Weight: TypeAlias = tuple[Any, ...]
"""The numbers by coordinates, elements of the field."""

Term: TypeAlias = tuple[int, Weight, Polynomial]
"""Degree, weight, polynomial."""


@explains_its_methods
@dataclass(frozen=True)
class SemiInvariant:
    r"""A polynomial F with $\{x_i, F\} = \lambda_i F$: where it vanishes is a union of symplectic leaves.

    Example:
        >>> bracket = lp.algebras.bianchi("V") @ lp.trivial()
        >>> [(one.function, one.weight) for one in bracket.semi_invariants(2)]
        [(l2, {'l1': 1}), (l3, {'l1': 1})]

    Attributes:
        function: F.
        weight: The $\lambda_i$ that are not zero, by the names of the coordinates; none of a Casimir.
        degree: The degree of F.
    """

    function: Expr
    weight: Mapping[str, Expr] = field(hash=False)
    degree: int


def semi_invariants(tensor: TensorEntries, degree: int) -> list[SemiInvariant]:
    """Those up to a degree that are no sums of products of others.

    Raises:
        BracketError: the bracket is not linear.
        ParameterError: the degree is not a positive integer, or too large for the search.
    """
    search = _Search(tensor)
    names = [str(x) for x in tensor.variables]
    found: list[SemiInvariant] = []
    for d, weight, polynomial in search.generators(degree):
        if polynomial.keys() != {(CONSTANT,)}:
            shown = {names[i]: search.to_sympy(value) for i, value in enumerate(weight) if value}
            found.append(SemiInvariant(search.expression(polynomial), shown, d))
    return found


def rational_casimirs(tensor: TensorEntries, degree: int) -> list[Expr]:
    """Independent Casimirs P/Q with P and Q of at most a degree, the polynomials first, by their degrees.

    Raises:
        BracketError: the bracket is not linear.
        ParameterError: the degree is not a positive integer, or too large for the search.
    """
    search = _Search(tensor)
    by_weight: dict[Weight, list[tuple[int, Polynomial]]] = {}
    for d, weight, polynomial in _products(search.generators(degree), degree):
        if any(m != CONSTANT for monomial in polynomial for m in monomial):
            by_weight.setdefault(weight, []).append((d, polynomial))
    pairs: list[tuple[bool, int, Any]] = []
    for weight, terms in by_weight.items():
        written: list[tuple[int, Any]] = [(d, search.expression(p)) for d, p in sorted(terms, key=lambda term: term[0])]
        if any(weight):
            (size, Q), *written = written
            pairs += [(True, size + d, P / Q) for d, P in written]
        else:
            pairs += [(False, d, P) for d, P in written]
    corank, found = tensor.dimension - tensor.lower_rank, list[Any]()
    for is_quotient, _, one in sorted(pairs, key=lambda pair: pair[:2]):
        checkpoint("rational Casimirs")
        if len(found) >= corank:
            break
        casimir = one.cancel() if is_quotient else one
        if casimir.free_symbols & {*tensor.variables} and tensor.n_independent([*found, casimir]) > len(found):
            found.append(casimir)
    return found


class _Search:
    """The semi-invariants of one bracket, degree by degree."""

    def __init__(self, tensor: TensorEntries) -> None:
        from liepoisson.algebra.exact_numbers import to_sympy

        if tensor.degree is None or tensor.degree > 1:
            raise BracketError(
                "wanted a bracket that is linear in the coordinates, whose semi-invariants have numbers as weights; "
                f"got one of {', '.join(map(str, tensor.variables))}, which is none."
            )
        self.variables, self.dimension = tensor.variables, tensor.dimension
        terms = tensor.linear_terms
        self.field: RealField = real_field(c for *_, c in terms)
        self.one = self.field.one
        self._exactly = to_sympy
        read = {c: self.field.read(c) for *_, c in terms}
        self.rows: list[dict[int, list[tuple[int, Any]]]] = [{} for _ in range(self.dimension)]
        for i, j, m, c in terms:
            place = CONSTANT if m is None else m
            self.rows[i].setdefault(j, []).append((place, read[c]))
            self.rows[j].setdefault(i, []).append((place, -read[c]))
        self.has_constant = any(m is None for *_, m, _ in terms)

    def to_sympy(self, value: Any) -> Expr:
        """An element as an expression."""
        return self._exactly(self.field.write(value))

    def expression(self, polynomial: Polynomial) -> Expr:
        """A polynomial with 1 for the constant coordinate."""
        from sympy import Add, Mul

        x = self.variables
        plain = without_constant_factors(polynomial)
        return Add(*(Mul(self.to_sympy(c), *(x[k] for k in m)) for m, c in plain.items()))

    def generators(self, degree: int) -> list[Term]:
        """Semi-invariants of each degree and weight that are no sums of products of lower ones.

        Raises:
            ParameterError: the degree is not a positive integer, or too large for the search.
        """
        given: Any = degree
        if isinstance(given, bool) or not isinstance(given, int) or degree < 1:
            raise ParameterError(
                f"degree must be an integer of at least 1; got {degree!r}. Write for example degree=2."
            )
        if self.dimension * comb(len(self._factors) + degree - 1, degree) > MAX_WORK:
            raise ParameterError(
                f"the search must stay below its size limit; degree {degree} exceeds it. Lower the degree."
            )
        zero: Weight = (self.field.zero,) * self.dimension
        found: list[Term] = [(1, zero, {(CONSTANT,): self.one})] if self.has_constant else []
        for d in range(1, degree + 1):
            known: dict[Weight, Echelon] = {}
            for size, weight, product in _products(found, d):
                if size == d:
                    known.setdefault(weight, Echelon(self.field)).insert(product)
            for weight, space in self._of_degree(d):
                span = known.get(weight, Echelon(self.field))
                found += [(d, weight, dict(p)) for p in space if span.insert(p)]
        return found

    @property
    def _factors(self) -> range:
        return range(CONSTANT if self.has_constant else 0, self.dimension)

    def _of_degree(self, degree: int) -> Iterator[tuple[Weight, list[Polynomial]]]:
        """All weights of a degree, each with a basis of its polynomials."""
        monomials = [*combinations_with_replacement(self._factors, degree)]
        place = {m: k for k, m in enumerate(monomials)}
        derived, others = self.derived
        rows: dict[tuple[int, Monomial], Vector] = {}
        for k, monomial in enumerate(monomials):
            checkpoint("semi-invariants")
            for a, form in enumerate(derived):
                for m, c in self._image(form, {monomial: self.one}).items():
                    rows.setdefault((a, m), {})[k] = c
        solver: Any = Coefficients() if isinstance(self.field, RealRationals) else self.field
        if isinstance(solver, Coefficients):
            vectors = nullspace(list(rows.values()), len(monomials), solver).vectors
        else:
            vectors = Echelon(self.field, sorted(rows.values(), key=len)).null_space(len(monomials))
        start = [{monomials[k]: c for k, c in v.items()} for v in vectors]
        spaces: list[tuple[dict[int, Any], list[Polynomial]]] = [({}, start)] if start else []
        for i in others:
            spaces = [
                ({**values, i: value}, part)
                for values, space in spaces
                for value, part in self._eigenspaces(i, space, place)
            ]
        for values, space in spaces:
            yield self._weight(values, others), space

    @cached_property
    def derived(self) -> tuple[list[Vector], list[int]]:
        """Linear forms that span [g, g], modulo constants, and the coordinates that complete them."""
        span = Echelon(self.field)
        for i, row in enumerate(self.rows):
            for j, form in row.items():
                if i < j:
                    span.insert({m: c for m, c in form if m != CONSTANT})
        return span.basis(), [i for i in range(self.dimension) if i not in span.rows]

    def _weight(self, values: Mapping[int, Any], others: Sequence[int]) -> Weight:
        """All numbers of a weight from those of the coordinates that complete [g, g], on which it vanishes."""
        total = [self.field.zero] * self.dimension
        for i in others:
            total[i] = values[i]
        for row in self.derived[0]:
            lead = min(row)
            for k, c in row.items():
                if k != lead and k in values:
                    total[lead] = total[lead] - c * values[k]
        return tuple(total)

    def _image(self, form: Mapping[int, Any], polynomial: Polynomial) -> Polynomial:
        """{form, polynomial}, homogeneous with the constant coordinate."""
        total: Polynomial = {}
        for monomial, c in polynomial.items():
            for position, factor in enumerate(monomial):
                if factor == CONSTANT:
                    continue
                rest = monomial[:position] + monomial[position + 1 :]
                for i, weight in form.items():
                    for m, value in self.rows[i].get(factor, ()):
                        key = tuple(sorted((*rest, m)))
                        term = c * weight * value
                        total[key] = total[key] + term if key in total else term
        return {key: value for key, value in total.items() if value}

    def _eigenspaces(
        self, i: int, space: Sequence[Polynomial], place: Mapping[Monomial, int]
    ) -> Iterator[tuple[Any, list[Polynomial]]]:
        r"""The eigenvalues of $\{x_i, \cdot\}$ on a space in the field, each with a basis of its eigenvectors."""
        n, end = len(space), len(place)
        span = Echelon(self.field)
        for k, polynomial in enumerate(space):
            span.insert({**{place[m]: c for m, c in polynomial.items()}, end + k: self.one})
        columns: list[Vector] = []
        for polynomial in space:
            left = span.reduce({place[m]: c for m, c in self._image({i: self.one}, polynomial).items()})
            columns.append({key - end: -c for key, c in left.items()})
        matrix = [[columns[k].get(r, self.field.zero) for k in range(n)] for r in range(n)]
        polynomial = characteristic_polynomial(matrix, self.field.number)
        for factor in self.field.factors(polynomial[::-1]):
            if len(factor) == 2:
                value = -factor[1]
                rows = [{c: x - value if c == r else x for c, x in enumerate(row)} for r, row in enumerate(matrix)]
                kernel = Echelon(self.field, [{c: x for c, x in row.items() if x} for row in rows]).null_space(n)
                yield value, [self._combined(vector, space) for vector in kernel]

    def _combined(self, vector: Vector, space: Sequence[Polynomial]) -> Polynomial:
        total: Polynomial = {}
        for k, c in vector.items():
            for m, value in space[k].items():
                total[m] = total[m] + c * value if m in total else c * value
        return {m: value for m, value in total.items() if value}


def _products(generators: Sequence[Term], degree: int) -> Iterator[Term]:
    """All products of generators of at most a degree, with their weights; each generator among them."""

    def extend(start: int, left: int, so_far: Term | None) -> Iterator[Term]:
        if so_far is not None:
            yield so_far
        for k in range(start, len(generators)):
            size, weight, factor = generators[k]
            if size <= left:
                if so_far is None:
                    following = generators[k]
                else:
                    sums = tuple(a + b for a, b in zip(so_far[1], weight, strict=True))
                    following = so_far[0] + size, sums, multiply(so_far[2], factor)
                yield from extend(k, left - size, following)

    yield from extend(0, degree, None)
