r"""All polynomial first integrals up to a degree, or of a weight, exactly.

The integrals of a degree are the null vectors of D on the monomials.  These fall into blocks by the gradings of the
equations.  In each block:

1. The dimension of the null space modulo a prime is at least the true one.
2. Products of the integrals that are known already span a part of it, whose dimension modulo the prime is at most the
   true one.
3. Where the two are equal there is no further integral: a proof.  Otherwise the null space is lifted to the exact field
   and multiplied with the matrix, and integrals that are no sums of products of others are taken, lowest degree first.

What is independent modulo a prime is independent exactly.  A term $c\,x^e\,\partial_k$ of D sends $x^m$ to
$c\,m_k\,x^{m + e - 1_k}$: one entry of the matrix for each term and each monomial with $m_k > 0$.  All entries of a
term are made at once, as the compiled elimination takes them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import count
from math import gcd, inf, lcm
from random import Random
from typing import TYPE_CHECKING, Any

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, transposed
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod, rank_mod
from liepoisson.algebra.number_fields import Element
from liepoisson.algebra.residues import Residues
from liepoisson.algebra.sparse_polynomials import Polynomial, gradient_at, multiply, value_at
from liepoisson.errors import ParameterError
from liepoisson.inputs.deadline import checkpoint, passed, seconds_left
from liepoisson.integrability.derivation import (
    Derivation,
    Exponents,
    Grading,
    Level,
    homogeneous_parts,
    in_blocks,
    order,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_MOST_PRIMES = 20


def modular(polynomial: Polynomial, residues: Residues) -> Polynomial:
    """The polynomial over the field of the prime."""
    number = residues.field.number
    image = {m: number(residues(c)) for m, c in polynomial.items()}
    return {m: c for m, c in image.items() if c}


def residues_of(field: Coefficients, polynomials: Iterable[Polynomial], skipped: int = 0) -> Residues:
    """The homomorphism modulo the first prime, after some that are skipped, modulo which no coefficient vanishes."""
    values = [c for polynomial in polynomials for c in polynomial.values()]
    for attempt in range(_MOST_PRIMES):
        found = field.residues(seed=1 + attempt, skipped=attempt)
        if found is None:
            break
        with suppress(ValueError, ZeroDivisionError):  # a denominator vanishes modulo the prime
            if all(map(found, values)):
                if not skipped:
                    return found
                skipped -= 1
    raise ParameterError(
        "the coefficients have no images modulo primes, which every search begins with; give rational numbers or roots"
    )


def random_point(n: int, residues: Residues, seed: int = 1) -> list[Element]:
    """Numbers of the field of the prime; the same for the same seed."""
    random = Random(seed)
    return [residues.field.number(random.randrange(1, residues.p)) for _ in range(n)]


_LARGEST_KEY = 2**62


def modular_nullity(
    derivation: Derivation,
    residues: Residues,
    monomials: Sequence[Exponents],
    progress: Callable[[float], Any] | None = None,
) -> int:
    """Dimension of the null space of D on some monomials; those of low degree come first, which costs least."""
    import numpy as np

    from liepoisson import _core

    parts = list(_entries(derivation, residues, np.array(sorted(monomials, key=lambda m: (sum(m), m)), dtype=np.int64)))
    if not parts:
        return len(monomials)
    columns, images, values = (np.concatenate(part) for part in zip(*parts, strict=True))
    rows = _numbered(images)
    order = np.lexsort((columns, rows))
    starts = np.searchsorted(rows[order], np.arange(rows.max() + 2))
    matrix = starts.astype(np.uint64), columns[order].astype(np.uint32), values[order]
    found = _core.modular_null_space(*matrix, len(monomials), residues.p, None, seconds_left(inf), progress)
    if not found["complete"]:
        raise passed("an elimination")
    return len(monomials) - found["rank"]


def _entries(derivation: Derivation, residues: Residues, monomials: NDArray[np.int64]) -> Iterator[Any]:
    """For each term of D the columns, the monomials of the rows and the residues of its entries."""
    import numpy as np

    p = residues.p
    for k, component in enumerate(derivation.components):
        columns = np.flatnonzero(monomials[:, k])
        powers = monomials[columns, k]
        for factor, coefficient in component.items():
            residue = residues(coefficient) % p
            if not residue or not len(columns):
                continue
            # residues of 61 bits times powers would overflow: a table of Python's integers
            table = np.array([residue * m % p for m in range(int(powers.max()) + 1)], dtype=np.uint64)
            images = monomials[columns] + np.array(factor)
            images[:, k] -= 1
            yield columns, images, table[powers]


def _numbered(monomials: NDArray[np.int64]) -> NDArray[np.int64]:
    """A number for each monomial from 0, the same for equal ones."""
    import numpy as np

    base = int(monomials.max(initial=0)) + 1
    keys, size = np.zeros(len(monomials), dtype=np.int64), 1
    for exponents in monomials.T:
        if size * base > _LARGEST_KEY:
            keys = np.unique(keys, return_inverse=True)[1]
            size = int(keys.max()) + 1
        keys, size = keys * base + exponents, size * base
    return np.unique(keys, return_inverse=True)[1]


Label = tuple[int, ...]
_MOST_TERMS = 400
"""Terms of the longest polynomials that are made shorter by subtracting products."""
_MOST_POINTS = 400
"""Points that are tried: k square roots exist at one in 2^k."""


@dataclass
class Generator:
    """An integral whose products with others are known."""

    name: str
    polynomial: Polynomial
    is_new: bool  # whether the search found it
    is_independent: bool = True  # whether it is functionally independent of those before it

    @property
    def degree(self) -> int:
        """Its total degree."""
        return max(map(sum, self.polynomial))


@dataclass(frozen=True)
class BlockCount:
    """What was found in one block."""

    label: Label  # the weights of its monomials
    n_unknowns: int
    nullity: int  # dimension of the null space modulo the prime, at least that of the integrals
    n_known: int  # dimension of the span of products of the known integrals and of those found


@dataclass
class Search:
    """The search on one set of monomials."""

    derivation: Derivation
    gradings: tuple[Grading, ...]  # their gradings; on a level only those in which its equations are homogeneous
    level: Level  # the level set, or all of phase space
    equations: tuple[Polynomial, ...]  # the polynomials that vanish on the level
    generators: list[Generator]  # integrals that are known, to which those that are found are added
    # the gradient of another known integral, which is no polynomial; empty if there is none
    slope: tuple[Polynomial, ...] = ()
    counts: list[BlockCount] = field(default_factory=list)  # what was found, block by block

    def over(self, field: Coefficients) -> Search:
        """The same over a larger field than the rational numbers, with nothing known."""
        components = tuple(in_field(f, field) for f in self.derivation.components)
        return Search(
            Derivation(self.derivation.variables, components, field),
            self.gradings,
            self.level.mapped(lambda generator: in_field(generator, field)),
            tuple(in_field(f, field) for f in self.equations),
            [],
        )

    @property
    def complete(self) -> bool:
        """Whether it is proved that products of integrals span all."""
        return all(count.nullity == count.n_known for count in self.counts)

    def run(
        self,
        monomials: Iterator[Exponents],
        progress: Callable[[float], Any] | None = None,
        weights: Sequence[int] = (),
    ) -> None:
        """Look for integrals among the combinations of some monomials, a union of blocks.

        Modulo a prime by which a difference of coefficients is divisible, null spaces may be larger than they are: then
        the search finds all integrals, and is not complete.
        """
        blocks = in_blocks((m for m in monomials if any(m) and self.level.is_standard(m)), self.gradings)
        self._split_known(blocks, weights or (1,) * len(self.derivation.variables))
        total, done = sum(len(b) ** 2 for b in blocks.values()), 0
        excess: list[tuple[Label, list[Exponents], int]] = []
        for label, block in sorted(blocks.items(), key=lambda item: len(item[1])):
            nullity = self._nullity(block, _part(progress, 0.9 * done / total, 0.9 * len(block) ** 2 / total))
            if nullity:
                excess.append((label, sorted(block, key=order, reverse=True), nullity))
            else:
                self.counts.append(BlockCount(label, len(block), 0, 0))
            done += len(block) ** 2
            if progress:
                progress(0.9 * done / total)
        self._compare(excess)

    def _split_known(self, blocks: Mapping[Label, Sequence[Exponents]], weights: Sequence[int]) -> None:
        """Each part of one weight of a known integral is an integral, though perhaps no polynomial in known ones.

        All parts but the heaviest, which is the known one without the others, are found in this way.
        """

        def weight(polynomial: Mapping[Exponents, Any]) -> int:
            return max(sum(w * k for w, k in zip(weights, m, strict=True)) for m in polynomial)

        largest = max((weight(dict.fromkeys(block)) for block in blocks.values()), default=0)
        candidates: list[tuple[int, Polynomial]] = []
        highest = 0
        for generator in self.generators:
            divided = homogeneous_parts(generator.polynomial, self.gradings).values()
            parts = sorted((part for part in divided if any(map(any, part))), key=weight)
            candidates += [(weight(part), part) for part in parts[:-1]]
            highest = max(highest, generator.degree if parts[1:] else 0)
        for size, part in sorted(candidates, key=lambda item: (item[0], len(item[1]))):
            if size > largest:
                break
            span = Echelon(self.residues.field)
            self._insert_products({(): span}, highest, whole=True)
            if span.reduce(modular(part, self.residues)):
                self._take(part, part)

    def _take(self, polynomial: Polynomial, written: Polynomial) -> None:
        """Take an integral that was found, as it is written, as known; ranks at a random point prove independence."""
        others = [g.polynomial for g in self.generators]
        is_independent = self._rank([*others, polynomial]) > self._rank(others)
        name = next_name({g.name for g in self.generators}, set(map(str, self.derivation.variables)))
        self.generators.append(Generator(name, written, is_new=True, is_independent=is_independent))

    def _nullity(self, block: Sequence[Exponents], progress: Callable[[float], Any] | None) -> int:
        """The dimension of the null space modulo the prime."""
        if not self.level.basis:
            return modular_nullity(self.derivation, self.residues, block, progress)
        columns: list[Polynomial] = []
        for k, monomial in enumerate(block):
            checkpoint("the search for integrals")
            if progress and not k % 100:
                progress(k / len(block))
            image = modular(self.derivation({monomial: self.derivation.field.one}), self.residues)
            columns.append(self.level_mod.remainder(image))
        return len(nullspace_mod(transposed(columns), len(block), self.residues.p))

    def _image(self, monomial: Exponents) -> Polynomial:
        checkpoint("the search for integrals")
        return self.level.remainder(self.derivation({monomial: self.derivation.field.one}))

    def _compare(self, excess: list[tuple[Label, list[Exponents], int]]) -> None:
        """Blocks with integrals: those that products of known ones give, and the others, lowest degree first."""
        highest = max((sum(block[0]) for _, block, _ in excess), default=0)
        spans = {label: Echelon(self.residues.field) for label, _, _ in excess}
        self._insert_products(spans, highest)
        waiting: list[tuple[int, Label, Polynomial]] = []
        for label, block, nullity in excess:
            if len(spans[label]) < nullity:
                waiting += [(max(map(sum, v)), label, v) for v in self._exact_null_space(block)]
        for _, label, polynomial in sorted(waiting, key=lambda item: (item[0], len(item[2]))):
            image = modular(polynomial, self.residues)
            if not spans[label].reduce(image):
                continue
            self._take(polynomial, self._simplest(polynomial, label))
            self._insert_products(spans, highest, must_contain=len(self.generators) - 1)
        for label, block, nullity in excess:
            self.counts.append(BlockCount(label, len(block), nullity, len(spans[label])))

    def _exact_null_space(self, block: Sequence[Exponents]) -> list[Polynomial]:
        """The null space over the exact field, as polynomials of the lowest degrees possible."""
        found = nullspace(transposed(map(self._image, block)), len(block), self.derivation.field)
        # the columns are ordered by degree, highest first: leading monomials tell what is of lower degree
        lowest = Echelon(self.derivation.field, found.vectors)
        return [{block[c]: v for c, v in vector.items()} for vector in lowest.basis()]

    def _simplest(self, polynomial: Polynomial, label: Label) -> Polynomial:
        """A sum of the polynomial and multiples of known products with few terms, by a greedy search."""
        shorter = [p for p in self._products(max(map(sum, polynomial)), label) if len(p) <= _MOST_TERMS]
        best, zero = polynomial, self.derivation.field.zero
        while len(best) <= _MOST_TERMS:
            found = [
                {m: c for m in best.keys() | q.keys() if (c := best.get(m, zero) - best[k] / q[k] * q.get(m, zero))}
                for q in shorter
                for k in best.keys() & q.keys()
            ]
            shortest = min(found, key=len, default=best)
            if len(shortest) >= len(best):
                break
            best = shortest
        return best

    def _products(self, highest: int, label: Label) -> list[Polynomial]:
        """The products of integrals in a block, up to a degree, exactly."""
        factors = [(max(map(sum, part)), part) for _, part in self._parts(self.gradings)]
        found = (
            {m: c for m, c in self.level.remainder(product).items() if any(m)}
            for _, _, product in products(factors, highest, _MOST_TERMS**2)
            if tuple(g.of(next(iter(product))) for g in self.gradings) == label
        )
        return [p for p in found if p]

    def _parts(self, gradings: Sequence[Grading]) -> list[tuple[int, Polynomial]]:
        """The homogeneous parts of the known integrals with the numbers of these."""
        divided = [homogeneous_parts(generator.polynomial, gradings) for generator in self.generators]
        return [(k, part) for k, parts in enumerate(divided) for part in parts.values()]

    def _insert_products(
        self,
        spans: Mapping[Label, Echelon],
        highest: int,
        *,
        must_contain: int | None = None,
        whole: bool = False,
    ) -> None:
        """Put all products of integrals up to a degree into the spans of their blocks.

        Those of parts of one weight; of whole integrals into one span, with an empty label.
        """
        gradings = () if whole else self.gradings
        parts = self._parts(gradings)
        factors = [(max(map(sum, part)), modular(part, self.residues)) for _, part in parts]
        for chosen, _, product in products(factors, highest):
            if must_contain is not None and all(parts[k][0] != must_contain for k in chosen):
                continue
            label = tuple(g.of(next(iter(product))) for g in gradings)
            if label in spans:
                reduced = self.level_mod.remainder(product)
                spans[label].insert({m: c for m, c in reduced.items() if any(m)})

    @cached_property
    def level_mod(self) -> Level:
        """The level modulo the prime."""
        return self.level.mapped(lambda generator: modular(generator, self.residues))

    @cached_property
    def residues(self) -> Residues:
        """The homomorphism modulo a prime."""
        known = [g.polynomial for g in self.generators]
        basis = [polynomial for _, polynomial in self.level.basis]
        coefficients = (*self.derivation.components, *self.slope, *self.equations, *basis, *known)
        return residues_of(self.derivation.field, coefficients)

    def _rank(self, polynomials: Sequence[Polynomial]) -> int:
        point = self.point
        rows = [gradient_at(modular(f, self.residues), point) for f in (*self.equations, *polynomials)]
        rows.append({k: value_at(modular(f, self.residues).items(), point) for k, f in enumerate(self.slope)})
        return rank_mod(rows, len(point), self.residues.p)

    @cached_property
    def point(self) -> list[Element]:
        """A random point modulo the prime, on the level."""
        return point_on_level(self.equations, self.residues, len(self.derivation.variables))


def in_field(polynomial: Polynomial, field: Coefficients) -> Polynomial:
    """A polynomial with rational coefficients over a larger field."""
    return {m: field.number(c) for m, c in polynomial.items()}


def next_name(*known: Collection[str], letter: str = "F") -> str:
    """F1, F2, ..., the first that is neither a coordinate nor taken."""
    return next(name for k in count(1) if all((name := f"{letter}{k}") not in names for names in known))


def products(
    factors: Sequence[tuple[int, Polynomial]], highest: int, most_terms: int | None = None
) -> Iterator[tuple[tuple[int, ...], int, Polynomial]]:
    """The products of factors of positive degree up to a degree: the numbers of the factors, the degree left, and it.

    Products of more than `most_terms` terms, before these are collected, are left out.
    """

    def extended(
        chosen: tuple[int, ...], left: int, product: Polynomial | None
    ) -> Iterator[tuple[tuple[int, ...], int, Polynomial]]:
        checkpoint("products of integrals")
        for k in range(chosen[-1] if chosen else 0, len(factors)):
            degree, factor = factors[k]
            if 0 < degree <= left and (
                product is None or most_terms is None or len(product) * len(factor) <= most_terms
            ):
                further = factor if product is None else multiply(product, factor)
                yield (*chosen, k), left - degree, further
                yield from extended((*chosen, k), left - degree, further)

    return extended((), highest, None)


def _part(progress: Callable[[float], Any] | None, start: float, share: float) -> Callable[[float], Any] | None:
    """A listener for a part of what is done."""
    return None if progress is None else lambda fraction: progress(start + share * fraction)


def point_on_level(equations: Sequence[Polynomial], residues: Residues, n: int) -> list[Element]:
    """A random point modulo the prime at which some polynomials in n variables vanish."""
    if not equations:
        return random_point(n, residues)
    images = [modular(f, residues) for f in equations]
    for seed in range(1, _MOST_POINTS):
        found = _point_on(images, random_point(n, residues, seed), residues.p)
        if found is not None:
            return found
    raise ParameterError(
        "on: no point was found modulo a prime at which the equations of the level, and the relations of the roots, "
        "exponentials and trigonometric functions, hold; give equations that can be solved one after the other"
    )


def _last_and_number(equation: Polynomial) -> tuple[int, int]:
    """The last variable of an equation, for which it is solved, and the number of variables."""
    occurring = {i for m in equation for i, k in enumerate(m) if k}
    return max(occurring, default=0), len(occurring)


def _point_on(equations: Sequence[Polynomial], point: list[Element], p: int) -> list[Element] | None:
    """The point, moved to the level by one coordinate for each equation; None if that has no solution.

    An equation may follow from those before, as some of the relations of exponentials do.
    """
    from flint import nmod_poly

    fixed: set[int] = set()
    for equation in sorted(equations, key=_last_and_number):
        occurring = sorted({i for m in equation for i, k in enumerate(m) if k} - fixed)
        if not occurring:
            if value_at(equation.items(), point):
                return None
            continue
        i = occurring[-1]
        by_power: dict[int, Polynomial] = {}
        for monomial, c in equation.items():
            by_power.setdefault(monomial[i], {})[*monomial[:i], 0, *monomial[i + 1 :]] = c
        coefficients = [value_at(by_power.get(k, {}).items(), point) for k in range(max(by_power) + 1)]
        polynomial = nmod_poly([int(c) for c in coefficients], p)
        roots = [r for r, _ in polynomial.factor()[1] if r.degree() == 1] if polynomial.degree() > 0 else []
        if not roots:
            return None
        point[i] = -roots[0][0] / roots[0][1]
        fixed |= {j for m in equation for j, k in enumerate(m) if k}
    return point


def tidied(polynomial: Polynomial) -> Polynomial:
    """With whole coefficients without a common factor, the leading one positive, where they are rational."""
    values = list(polynomial.values())
    if not all(isinstance(v, Fraction) for v in values):
        return polynomial
    scale = Fraction(lcm(*(v.denominator for v in values)))
    whole = {m: v * scale for m, v in polynomial.items()}
    common = gcd(*(int(v) for v in whole.values()))
    sign = -1 if whole[max(whole, key=lambda m: (sum(m), m))] < 0 else 1
    return {m: v * sign / common for m, v in whole.items()}
