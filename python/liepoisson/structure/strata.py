r"""Strata of a bracket: where its rank drops, with proofs.

If the elements $e_\mu$, $\mu \in I$, span an ideal of A, the fields $x_\mu$, $\mu \in I$, vanish on a Poisson
submanifold, on which the bracket is that of g (x) A/I.  That the rank does not drop anywhere else is proved by
Pfaffians: if powers of the equations of a set are combinations of Pfaffians of J of size r, then the rank is at least r
outside of this set.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, product
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.structure.casimirs import quotient_casimirs
from liepoisson.structure.locus import Locus, Stratum
from liepoisson.structure.poisson.casimir_search import n_independent
from liepoisson.structure.poisson.pfaffians import PfaffianIdeal, casimirs_on_parallel_fields, vanish_on_parallel_fields
from liepoisson.structure.poisson.poisson_tensor import CONSTANT, potential_of_constant_part
from liepoisson.structure.poisson.polynomials import expression_of

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.algebra.sparse_polynomials import Polynomial
    from liepoisson.structure.bracket import Bracket
    from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor

_Functions: TypeAlias = "Callable[[], Sequence[Expr]]"


@dataclass(frozen=True)
class _Drop:
    """A set where the rank is lower: some fields vanish, or one of several does, or two fields are parallel."""

    fields: tuple[int, ...]
    kind: str
    assumption: str = ""


def strata(bracket: Bracket) -> list[Stratum]:
    """The strata by decreasing rank, from the open one down to the origin.

    For Lie algebras of dimension 3 and up to nine coordinates the conditions are exact where one of these sets is the
    degenerate one: a field vanishes, one of several fields vanishes, two fields are parallel.  Beyond, the list follows
    the ideals spanned by basis elements, and `proved` says whether the rank was decided at every point.

    With a constant part conditions on whole fields do not describe where the rank drops: one stratum is returned, and
    it is all of phase space where that is proved.

    If all are proved, the list is a partition of phase space.  Otherwise it is none: there may be sets of lower rank
    that are not listed, inside of those that are not proved.
    """
    if bracket.constant:
        return [_with_constant_part(bracket)]
    found = _Stratification(bracket).below(tuple(range(bracket.extension.dimension)), set())
    return sorted(found, key=lambda stratum: -stratum.rank)


def _with_constant_part(bracket: Bracket) -> Stratum:
    """The generic stratum, "everywhere" if J is constant or 1 is a combination of its Pfaffians."""
    tensor, casimirs = bracket.tensor, bracket.casimirs
    rank, n = tensor.rank_at_a_point, bracket.dimension
    known = n - rank - bracket.n_unknown_casimirs
    bound = min(n - known, n - n % 2)
    text = f"rank {rank} at one point, at most {bound} by parity and independent Casimirs"
    nowhere_less, reason = not bracket.entries(), "J is constant"
    if not nowhere_less:
        ideal = PfaffianIdeal(tensor, rank, bracket.algebra.dimension)
        assumption = ideal.contains_powers_of([{(CONSTANT,): tensor.field.one}]) if ideal.generators else None
        nowhere_less = assumption is not None
        reason = f"1 is a combination of Pfaffians of size {rank}" + (f" ({assumption})" if assumption else "")
    if nowhere_less:
        return Stratum(Locus(), rank, casimirs, f"{text}; {reason}", rank == bound, known == n - rank)
    if potential_of_constant_part(tensor) is not None:
        text += "; in the coordinates x + bracket.coboundary() the constant part vanishes: see the strata there"
    return Stratum(Locus(is_generic=True), rank, casimirs, text, False, known == n - rank)


class _Stratification:
    def __init__(self, bracket: Bracket) -> None:
        self.bracket = bracket
        self.size = bracket.algebra.dimension
        self.names = bracket.field_names

    def below(self, fields: tuple[int, ...], seen: set[tuple[int, ...]]) -> Iterator[Stratum]:
        """The strata where the fields that are not listed vanish."""
        if fields in seen:
            return
        seen.add(fields)
        tensor = self._restricted(fields)
        rank = tensor.rank_at_a_point if fields else 0
        if rank == 0:
            here = Locus(zero=self._vanishing(fields))
            yield Stratum(here, 0, self._casimirs(fields), certificate="J vanishes", proved=True)
            return
        casimirs = quotient_casimirs(tensor)
        n = n_independent(casimirs, tensor) if casimirs else 0
        bound = min(tensor.dimension - n, tensor.dimension - tensor.dimension % 2)
        drop = self._drop(fields, tensor, rank)
        found = self._open(fields, rank, bound, drop, self._embedded(casimirs, fields))
        yield replace(found, complete=n == tensor.dimension - rank)
        if drop is not None and drop.kind == "parallel":
            yield self._parallel(fields, tensor, drop)
            yield from self.below(tuple(f for f in fields if f not in drop.fields), seen)
        elif drop is not None and drop.kind == "one of":
            for field in drop.fields:
                yield from self.below(tuple(f for f in fields if f != field), seen)
        else:
            lost = drop.fields if drop is not None else (self._ideals(fields) or [fields])[0]
            yield from self.below(tuple(f for f in fields if f not in lost), seen)

    def _open(
        self, fields: tuple[int, ...], rank: int, bound: int, drop: _Drop | None, casimirs: _Functions
    ) -> Stratum:
        text = f"rank {rank} at one point, at most {bound} by parity and independent Casimirs"
        zero = self._vanishing(fields)
        if drop is None:
            return Stratum(Locus(zero=zero, is_generic=True), rank, casimirs, certificate=text, proved=False)
        names = tuple(self.names[f] for f in drop.fields)
        if drop.kind == "parallel":
            outside = Locus(zero=zero, not_parallel=(names,))
        else:
            outside = Locus(zero=zero, nonzero=(names,) if drop.kind == "zero" else tuple((name,) for name in names))
        text += f"; no less elsewhere: powers of the equations are combinations of Pfaffians of size {rank}"
        text += f" ({drop.assumption})" if drop.assumption else ""
        return Stratum(outside, rank, casimirs, certificate=text, proved=rank == bound)

    def _parallel(self, fields: tuple[int, ...], tensor: LinearPoissonTensor, drop: _Drop) -> Stratum:
        """Two fields parallel, not both zero."""
        pair = [fields.index(f) for f in drop.fields]
        blocks = [tuple(range(k * self.size, (k + 1) * self.size)) for k in pair]
        rank = tensor.rank_at_a_point
        while rank and vanish_on_parallel_fields(PfaffianIdeal(tensor, rank, self.size).generators, blocks):
            rank -= 2
        coordinates: list[Polynomial] = [{(i,): tensor.field.one} for block in blocks for i in block]
        assumption = PfaffianIdeal(tensor, rank, self.size).contains_powers_of(coordinates)
        found = casimirs_on_parallel_fields(tensor, blocks)
        names = tuple(self.names[f] for f in drop.fields)
        locus = Locus(zero=self._vanishing(fields), parallel=(names,), nonzero=(names,))
        text = f"all Pfaffians of size {rank + 2} vanish there"
        if assumption is not None:
            text += f"; powers of the components of both fields are combinations of those of size {rank}"
        casimirs = self._embedded(found, fields)
        return Stratum(locus, rank, casimirs, certificate=text, proved=assumption is not None)

    def _drop(self, fields: tuple[int, ...], tensor: LinearPoissonTensor, rank: int) -> _Drop | None:
        """The first of the sets, in the order of the text of `strata`, that is proved to be the degenerate one."""
        if len(fields) == 1 and self.size != 3:
            return None
        ideal = PfaffianIdeal(tensor, rank, self.size)
        if not ideal.generators:
            return None
        for candidate in self._candidates(fields, tensor, ideal, rank):
            assumption = ideal.contains_powers_of(self._equations(candidate, fields, tensor))
            if assumption is not None:
                return _Drop(candidate.fields, candidate.kind, assumption)
        return None

    def _candidates(
        self, fields: tuple[int, ...], tensor: LinearPoissonTensor, ideal: PfaffianIdeal, rank: int
    ) -> Iterator[_Drop]:
        ideals = self._ideals(fields)
        lower = [i for i in ideals if self._rank(tuple(f for f in fields if f not in i)) < rank]
        yield from (_Drop(i, "zero") for i in lower if len(i) == 1)
        singles = [i[0] for i in lower if len(i) == 1]
        if len(singles) > 1:
            yield _Drop(tuple(singles), "one of")
        for pair in combinations(fields, 2):
            blocks = [self._block(fields, f) for f in pair]
            if ideal.is_full and pair in ideals and vanish_on_parallel_fields(ideal.generators, blocks):
                yield _Drop(pair, "parallel")
        yield from (_Drop(i, "zero") for i in lower if len(i) > 1)

    def _equations(self, drop: _Drop, fields: tuple[int, ...], tensor: LinearPoissonTensor) -> list[Polynomial]:
        one = tensor.field.one
        blocks = [self._block(fields, f) for f in drop.fields]
        if drop.kind == "zero":
            return [{(i,): one} for block in blocks for i in block]
        if drop.kind == "one of":
            return [{tuple(sorted(choice)): one} for choice in product(*blocks)]
        first, second = blocks
        pairs = combinations(range(self.size), 2)
        return [
            {tuple(sorted((first[i], second[j]))): one, tuple(sorted((first[j], second[i]))): -one} for i, j in pairs
        ]

    def _ideals(self, fields: tuple[int, ...]) -> list[tuple[int, ...]]:
        """Sets of one or two of the fields, the last ones first, that span an ideal of the quotient algebra."""
        W, found = self.bracket.extension.tensor, list[tuple[int, ...]]()
        for size in (1, 2):
            for chosen in reversed(list(combinations(fields, size))):
                left = [f for f in fields if f not in chosen]
                if all(is_zero(W[lam][mu][nu]) for lam, mu, nu in product(left, chosen, fields)):
                    found.append(chosen)
        return found

    def _rank(self, fields: tuple[int, ...]) -> int:
        return self._restricted(fields).rank_at_a_point if fields else 0

    def _restricted(self, fields: tuple[int, ...]) -> LinearPoissonTensor:
        return self.bracket.tensor.restricted(self._coordinates(fields))

    def _coordinates(self, fields: Sequence[int]) -> list[int]:
        return [f * self.size + i for f in fields for i in range(self.size)]

    def _block(self, fields: tuple[int, ...], field: int) -> tuple[int, ...]:
        start = fields.index(field) * self.size
        return tuple(range(start, start + self.size))

    def _casimirs(self, fields: tuple[int, ...]) -> _Functions:
        one = self.bracket.tensor.field.one
        return partial(_expressions, self.bracket, [{(i,): one} for i in self._coordinates(fields)])

    def _embedded(self, polynomials: Sequence[Polynomial], fields: tuple[int, ...]) -> _Functions:
        place = self._coordinates(fields)
        moved: list[dict[Any, Any]] = [{tuple(place[i] for i in m): c for m, c in p.items()} for p in polynomials]
        return partial(_expressions, self.bracket, moved)

    def _vanishing(self, fields: tuple[int, ...]) -> tuple[str, ...]:
        """The fields that are not listed, the last one first: the order in which they were lost."""
        return tuple(name for k, name in reversed(list(enumerate(self.names))) if k not in fields)


def _expressions(bracket: Bracket, polynomials: Sequence[Polynomial]) -> tuple[Expr, ...]:
    return tuple(expression_of(polynomial, bracket.variables, bracket.tensor.field) for polynomial in polynomials)
