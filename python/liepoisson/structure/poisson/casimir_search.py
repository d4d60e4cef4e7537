r"""All polynomial Casimirs of a degree, $J \nabla C = 0$, by exact linear algebra on monomials.

Where J is homogeneous, degrees separate.  With a constant part the polynomials are made homogeneous by factors of the
constant coordinate, $x_{-1} = 1$, which is a Casimir itself, and of which the others lose their multiples.  So do the
characters of the bracket, that is, weights $w_i$ (integers, or integers modulo 2 or 3) with $w_i + w_j = w_m$ whenever
$x_m$ occurs in $\{x_i, x_j\}$: gradings of A, tori and reflections of g.  The linear system falls into blocks, one for
each weight.  Where the entries of J are polynomials of higher degree, $w_i + w_j$ may differ from the weights of all
their monomials by one number.

Its columns are in the order of `leading_monomials`, so that the reduced basis has a 1 at each leading monomial.

Those of Leibniz extensions have a closed form, from the Casimirs of the Lie algebra itself.

g (x) R[z]/(z^n) is a generalised Takiff algebra.  If F is a Casimir of g, so are the n lowest coefficients of

$$F(\epsilon x_0 z^{n-1} + x_1 z^{n-2} + \dots + x_{n-1}) \mod z^n .$$

For so(3) and $F = |x|^2$ these are $C_k = \sum_{i+j=n-2+k} x_i \cdot x_j$, $k = 1, \dots, n$, halved for odd n + k, as
each product then occurs twice (the leading coefficients are 1).  For n > 2 epsilon stands before the terms that
contain $x_0$: rescale $e_k$, $k \ge 1$, by $\epsilon^{k-1}$ in the formula for epsilon = 1; a common power drops out.

References: Rais and Tauvel, J. reine angew. Math. 425 (1992) 123, for their completeness when g is semisimple.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations_with_replacement, product
from math import comb, lcm
from random import Random
from typing import TYPE_CHECKING, Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon
from liepoisson.algebra.exact_numbers import Exact, is_zero
from liepoisson.algebra.linear_algebra import nullspace, nullspace_mod, rank, rank_mod
from liepoisson.algebra.sparse_polynomials import Monomial, Polynomial
from liepoisson.structure.poisson.poisson_tensor import CONSTANT
from liepoisson.structure.poisson.polynomials import gradient_at, leading, monic, multiply, place, size

if TYPE_CHECKING:
    from liepoisson.structure.extension import Extension
    from liepoisson.structure.poisson.poisson_tensor import LinearPoissonTensor
    from liepoisson.structure.poisson.polynomial_tensor import PolynomialTensor

AnyTensor: TypeAlias = "LinearPoissonTensor | PolynomialTensor"

MAX_WORK = 200_000
"""The largest number of monomials of one degree times number of coordinates; a search of that size takes a minute."""


@dataclass
class CasimirSearch:
    """The Casimirs of one Poisson tensor of polynomials, degree by degree.

    Attributes:
        tensor: The Poisson tensor.
        with_pivots: Whether to keep what the elimination divides by, for the exceptional values of parameters.
        pivots: The divisors so far.
    """

    tensor: AnyTensor
    with_pivots: bool = False
    pivots: set[Any] = field(default_factory=set[Any])

    def is_feasible(self, degree: int) -> bool:
        """Whether the linear system of this degree is below the size limit."""
        N = self.tensor.dimension
        return N * comb(len(self._factors) + degree - 1, degree) <= MAX_WORK

    def of_degree(self, degree: int) -> list[Polynomial]:
        """A basis of the homogeneous Casimirs of this degree: 1 at its leading monomial, where the others have 0.

        With a constant part those of at most this degree, made homogeneous, without constants.
        """
        blocks: dict[tuple[int, ...], list[Monomial]] = {}
        for monomial in combinations_with_replacement(self._factors, degree):
            if monomial[-1] == CONSTANT:
                continue
            blocks.setdefault(self._weight(monomial), []).append(monomial)
        return self.sorted(polynomial for monomials in blocks.values() for polynomial in self._solve(monomials))

    def sums_of_squares(self) -> list[Polynomial]:
        """A basis of the quadratic Casimirs without mixed products: a small system even in many dimensions."""
        factors = (i for i in self._factors if i != CONSTANT)
        linear = [] if self.tensor.is_homogeneous else [(CONSTANT, i) for i in range(self.tensor.dimension)]
        return self.sorted(self._solve([*((i, i) for i in factors), *linear]))

    def sorted(self, polynomials: Iterable[Polynomial]) -> list[Polynomial]:
        """Homogeneous polynomials of one degree in the order that numbers them."""
        block = self.tensor.block
        return sorted(polynomials, key=lambda polynomial: place(leading(polynomial, block), block))

    def new_generators(self, space: Sequence[Polynomial], products: Iterable[Polynomial]) -> list[Polynomial]:
        """Members of a reduced basis that complete the span of the products (which lies in the same space)."""
        given, block = list(products), self.tensor.block
        if not given:
            return list(space)
        monomials = sorted({m for p in (*space, *given) for m in p}, key=lambda m: size(m, block), reverse=True)
        order = {monomial: column for column, monomial in enumerate(monomials)}
        rows = ({order[m]: c for m, c in p.items()} for p in given)
        echelon = Echelon(self.tensor.field, sorted(rows, key=len))
        self._keep(() if self.tensor.field.is_rational else echelon.pivots)
        return [polynomial for polynomial in space if order[leading(polynomial, block)] not in echelon.rows]

    def image(self, polynomial: Polynomial) -> dict[tuple[int, Monomial], Any]:
        r"""The nonzero coefficients of $J\nabla C$, by component and monomial."""
        total: dict[tuple[int, Monomial], Any] = {}
        for monomial, coefficient in homogeneous(polynomial).items():
            for key, value in self._image_of_monomial(monomial):
                term = coefficient * value
                total[key] = total[key] + term if key in total else term
        return {key: value for key, value in total.items() if value}

    def _solve(self, given: Iterable[Monomial]) -> list[Polynomial]:
        monomials = sorted(given, key=lambda monomial: size(monomial, self.tensor.block))
        rows: dict[tuple[int, Monomial], dict[int, Any]] = {}
        for column, monomial in enumerate(monomials):
            for key, value in self._image_of_monomial(monomial):
                row = rows.setdefault(key, {})
                row[column] = row[column] + value if column in row else value
        nonzero = ({c: v for c, v in row.items() if v} for row in rows.values())
        distinct = list({tuple(row.items()): row for row in nonzero}.values())
        if not self.with_pivots and self._has_no_solution(distinct, len(monomials)):
            return []
        found = nullspace(distinct, len(monomials), self.tensor.field)
        self._keep(found.pivots)
        return [{monomials[column]: value for column, value in vector.items()} for vector in found.vectors]

    def _keep(self, pivots: Iterable[Any]) -> None:
        if self.with_pivots:
            self.pivots.update(pivots)

    def _has_no_solution(self, rows: Sequence[dict[int, Any]], n_columns: int) -> bool:
        """Whether there is none even modulo a prime, which proves that there is none."""
        if self.tensor.field.is_rational or self._residues is None:
            return False
        known: dict[int, int] = {}  # by identity: a few structure constants occur again and again
        for row in rows:
            known |= {id(v): self._residues(v) for v in row.values() if id(v) not in known}
        images = [{c: known[id(v)] for c, v in row.items()} for row in rows]
        return not nullspace_mod(images, n_columns, self._residues.p)

    @cached_property
    def _residues(self) -> Any:
        rank_at_a_point = self.tensor.generic_rank
        return None if rank_at_a_point is None else rank_at_a_point.residues

    def _image_of_monomial(self, monomial: Monomial) -> Iterator[tuple[tuple[int, Monomial], Any]]:
        # Each occurrence of a factor is differentiated for itself, so powers need no multiplicities.
        for position, factor in enumerate(monomial):
            if factor == CONSTANT:
                continue
            rest = monomial[:position] + monomial[position + 1 :]
            for i, factors, coefficient in self._columns[factor]:
                yield (i, tuple(sorted((*rest, *factors)))), coefficient

    @cached_property
    def _columns(self) -> list[list[tuple[int, Monomial, Any]]]:
        columns: list[list[tuple[int, Monomial, Any]]] = [[] for _ in range(self.tensor.dimension)]
        for i, j, m, coefficient in self.tensor.terms():
            columns[j].append((i, _factors(m), coefficient))
        return columns

    @cached_property
    def _factors(self) -> range:
        """The coordinates, and the constant one if it occurs."""
        return range(0 if self.tensor.is_homogeneous else CONSTANT, self.tensor.dimension)

    def _weight(self, monomial: Monomial) -> tuple[int, ...]:
        sums = ((sum(weights[v] for v in monomial), modulus) for weights, modulus in self._characters)
        return tuple(total % modulus if modulus else total for total, modulus in sums)

    @cached_property
    def _characters(self) -> list[tuple[list[int], int]]:
        """Weights of the coordinates, that of the constant one behind them, and their modulus (0 for integers)."""
        N, differ = len(self._factors), self.tensor.degree > 1
        relations: set[tuple[tuple[int, int], ...]] = set()
        for i, j, m, _ in self.tensor.terms():
            relation: dict[int, int] = {}
            for index, sign in ((i, 1), (j, 1), *((k, -1) for k in _factors(m))):
                place_of_weight = index % N
                relation[place_of_weight] = relation.get(place_of_weight, 0) + sign
            if differ:  # the number by which they do stands behind all weights
                relation[N] = 1
            relations.add(tuple(sorted(relation.items())))
        rows = [dict(relation) for relation in sorted(relations)]
        n = N + differ
        characters = [(_dense(vector, N), q) for q in (2, 3) for vector in nullspace_mod(rows, n, q)]
        rationals = Coefficients()
        exact = [{c: rationals.number(v) for c, v in row.items() if v} for row in rows]
        for vector in nullspace(exact, n, rationals).vectors:
            scale = lcm(*(value.denominator for value in vector.values()))
            characters.append((_dense({c: int(v * scale) for c, v in vector.items()}, N), 0))
        return characters


def _factors(m: int | Monomial) -> Monomial:
    """The coordinates that are multiplied in a term of a tensor, linear or not."""
    return (m,) if isinstance(m, int) else m


def homogeneous(polynomial: Polynomial) -> Polynomial:
    """The polynomial with factors of the constant coordinate, so that all monomials have one length."""
    degree = max(map(len, polynomial), default=0)
    return {(CONSTANT,) * (degree - len(m)) + m: c for m, c in polynomial.items()}


def without_constant_factors(polynomial: Polynomial) -> Polynomial:
    """The polynomial with 1 in place of the constant coordinate."""
    return {tuple(i for i in m if i != CONSTANT): c for m, c in polynomial.items()}


def products_of_degree(generators: Sequence[tuple[int, Polynomial]], degree: int) -> Iterator[Polynomial]:
    """All products of two or more of the generators, given with their degrees, that have this degree."""

    def extend(start: int, left: int, product: Polynomial | None, n_factors: int) -> Iterator[Polynomial]:
        if left == 0 and n_factors > 1 and product is not None:
            yield product
        for k in range(start, len(generators)):
            size, factor = generators[k]
            if size <= left and not (n_factors == 0 and size == degree):
                yield from extend(
                    k, left - size, factor if product is None else multiply(product, factor), n_factors + 1
                )

    yield from extend(0, degree, None, 0)


def n_independent(polynomials: Sequence[Polynomial], tensor: AnyTensor) -> int:
    """The rank of the gradients at one random point: that many of them are functionally independent (proved)."""
    generic = tensor.generic_rank
    if generic is not None:
        residues, p = generic.residues, generic.residues.p
        rows = [gradient_at({m: residues(c) for m, c in q.items()}, generic.point) for q in polynomials]
        return rank_mod([{v: value % p for v, value in row.items()} for row in rows], tensor.dimension, p)
    random = Random(1)
    point = [tensor.field.number(random.randrange(1, 100)) for _ in range(tensor.dimension)]
    gradients = [gradient_at(polynomial, point) for polynomial in polynomials]
    return rank([{v: value for v, value in row.items() if value} for row in gradients], tensor.field)


def _dense(vector: dict[int, int], n: int) -> list[int]:
    return [vector.get(k, 0) for k in range(n)]


def leibniz_strength(extension: Extension) -> Exact | None:
    """The number epsilon with e_0 e_mu = e_mu, e_mu e_nu = epsilon e_(mu+nu), or None if this is no such algebra."""
    W, n = extension.tensor, extension.dimension
    strength = W[2][1][1] if n > 2 else W[0][0][0]
    for lam, mu, nu in product(range(n), repeat=3):
        expected = 0 if mu + nu != lam else (strength if mu and nu else 1)
        if not is_zero(W[lam][mu][nu] - expected):
            return None
    return strength


def lifted(casimir: Polynomial, dimension: int, n: int, strength: Any) -> list[Polynomial]:
    """The n Casimirs of the Leibniz extension that come from one homogeneous Casimir of g.

    Args:
        casimir: F, its coefficients elements of a field.
        dimension: The dimension of g.
        n: Order of the extension.
        strength: Epsilon, an element of that field.

    Returns:
        The coefficients of z^(n-1), ..., z^0, each with leading coefficient 1.
    """
    degree = len(next(iter(casimir)))
    found: list[Polynomial] = [{} for _ in range(n)]
    for labels in product(range(n), repeat=degree):
        power = sum(n - 1 - label for label in labels)
        if power >= n:
            continue
        target = found[n - 1 - power]
        for monomial, coefficient in casimir.items():
            key = tuple(sorted(label * dimension + i for label, i in zip(labels, monomial, strict=True)))
            value = coefficient * strength if 0 in labels and n > 1 else coefficient
            target[key] = target[key] + value if key in target else value
    return [monic(polynomial, dimension) for polynomial in found]
