r"""Structure of a finite commutative associative algebra over a real field: unit, nilradical, primary components."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, count, pairwise
from itertools import product as pairs
from typing import TypeAlias, final

from liepoisson.algebra.exact_numbers import Exact
from liepoisson.algebra.matrices import echelon, null_space, pivot_column
from liepoisson.algebra.real_fields import RealField, Scalar, real_field

Vector: TypeAlias = tuple[Scalar, ...]
"""An element of the algebra, by its n coordinates."""


@final
class CommutativeAlgebra:
    r"""The algebra with $e_\mu e_\nu = \sum_\lambda W_\lambda{}^{\mu\nu} e_\lambda$, over the field that W generates.

    Args:
        dimension: Number n of basis elements.
        products: `products[mu, nu][lam]`, the nonzero entries for mu <= nu.
        field: Field of the entries, taken from them if left out.
    """

    def __init__(
        self,
        dimension: int,
        products: Mapping[tuple[int, int], Mapping[int, Exact]],
        field: RealField | None = None,
    ) -> None:
        self.dimension = dimension
        values = (value for row in products.values() for value in row.values())
        self.field = field or real_field(values)
        read = self.field.read
        self._table = {pair: [(k, read(value)) for k, value in row.items()] for pair, row in products.items()}

    @cached_property
    def basis(self) -> list[Vector]:
        """The basis elements."""
        zero, one = self.field.zero, self.field.one
        return [tuple(one if i == j else zero for j in range(self.dimension)) for i in range(self.dimension)]

    def multiply(self, u: Vector, v: Vector) -> Vector:
        """The product u v; of surds, too."""
        result = [u[0] - u[0]] * self.dimension
        support = [(j, b) for j, b in enumerate(v) if b]
        for i, a in enumerate(u):
            for j, b in support if a else ():
                for k, value in self._table.get((i, j) if i <= j else (j, i), ()):
                    result[k] = result[k] + a * b * value
        return tuple(result)

    def span_of_products(self, left: Sequence[Vector], right: Sequence[Vector]) -> list[Vector]:
        """A basis of the span of all products of two subspaces."""
        return self.echelon([self.multiply(u, v) for u, v in pairs(left, right)])

    @cached_property
    def unit(self) -> Vector | None:
        """The unit element, if there is one: the solution of u e_mu = e_mu."""
        n = self.dimension
        images = [[self.multiply(e, b) for e in self.basis] for b in self.basis]
        rows = [[*(image[k] for image in images[b]), self.basis[b][k]] for b in range(n) for k in range(n)]
        solved = echelon(self.field, rows)
        if any(pivot_column(row) == n for row in solved):
            return None  # inconsistent; a unit that exists is unique
        return tuple(row[-1] for row in solved)

    @cached_property
    def nilradical(self) -> list[Vector]:
        r"""A basis of the nilpotent elements: the kernel of the trace form $\operatorname{tr} L_{xy}$."""
        traces = [self._trace(b) for b in self.basis]
        form = [[_dot(self.field, self.multiply(a, b), traces) for b in self.basis] for a in self.basis]
        return self.nullspace(form)

    @cached_property
    def annihilator(self) -> list[Vector]:
        """A basis of the elements whose product with every element is zero."""
        return self.annihilator_of(self.basis)

    def annihilator_of(self, subspace: Sequence[Vector]) -> list[Vector]:
        """A basis of the elements whose product with every element of the subspace is zero."""
        images = [[self.multiply(b, s) for b in self.basis] for s in subspace]
        return self.nullspace([[image[k] for image in row] for row in images for k in range(self.dimension)])

    def _trace(self, u: Vector) -> Scalar:
        total = self.field.zero
        for k, b in enumerate(self.basis):
            total = total + self.multiply(u, b)[k]
        return total

    def echelon(self, vectors: Iterable[Sequence[Scalar]]) -> list[Vector]:
        """The reduced echelon basis of a span."""
        return [tuple(row) for row in echelon(self.field, vectors)]

    def nullspace(self, rows: Iterable[Sequence[Scalar]]) -> list[Vector]:
        """A basis of the vectors that all rows annihilate."""
        return null_space(self.field, rows, self.dimension)

    def complement(self, subspace: Sequence[Vector], space: Sequence[Vector]) -> list[Vector]:
        """Vectors among those given for the space that complete a basis of the subspace to one of the space."""
        chosen: list[Vector] = []
        rank = len(self.echelon(subspace))
        for vector in space:
            if len(self.echelon([*subspace, *chosen, vector])) > rank + len(chosen):
                chosen.append(vector)
        return chosen

    def coordinates(self, vector: Vector, basis: Sequence[Vector]) -> list[Scalar]:
        """The coefficients of a vector of the span of independent vectors."""
        rows = [[*(b[k] for b in basis), vector[k]] for k in range(self.dimension)]
        return [row[-1] for row in echelon(self.field, rows)]

    def combine(self, coefficients: Sequence[Scalar], vectors: Sequence[Vector]) -> Vector:
        """The sum of vectors with coefficients."""
        result = (self.field.zero,) * self.dimension
        for c, vector in zip(coefficients, vectors, strict=True):
            result = tuple(a + c * b for a, b in zip(result, vector, strict=True))
        return result

    def powers_of(self, ideal: Sequence[Vector]) -> list[list[Vector]]:
        """Bases of m, m^2, ... up to the last that is not zero; m must be nilpotent."""
        powers: list[list[Vector]] = []
        current, factors = list(ideal), list(ideal)
        while current:
            powers.append(current)
            if len(powers) == 2:
                # Generators suffice from here on: m^k m = m^k G + m^k m^2, and the latter is in (m^k m) m.
                factors = self.complement(current, ideal)
            current = self.span_of_products(current, factors)
        return powers

    @cached_property
    def components(self) -> tuple[Component, ...]:
        """The primary components of a unital algebra: it is their direct product, each local over the field."""
        assert self.unit is not None
        n = self.dimension
        if len(self.nilradical) == n - 1:
            return (Component(self, tuple(self.basis), self.unit, self.unit, (self.field.one, -self.field.one)),)
        x, polynomial = self._separating_element()
        factors = self.field.factors(polynomial)
        subspaces = [self._kernel(self._evaluate(factor, x)) for factor in factors]
        units = self._split(self.unit, subspaces)
        return tuple(
            Component(self, tuple(space), unit, self.multiply(x, unit), tuple(factor))
            for space, unit, factor in zip(subspaces, units, factors, strict=True)
        )

    def _separating_element(self) -> tuple[Vector, list[Scalar]]:
        """An element x whose powers span A modulo the nilradical, and its minimal polynomial there."""
        wanted = self.dimension - len(self.nilradical)
        # The last candidates suffice: two characters agree on sum_i (i + 1)^k e_i for finitely many k only.
        powers = (tuple(self.field.number((i + 1) ** k) for i in range(self.dimension)) for k in count(1))
        for x in chain(self.basis, powers):
            polynomial = self.minimal_polynomial(x, modulo=self.nilradical)
            if len(polynomial) == wanted + 1:
                return x, polynomial
        raise AssertionError

    def minimal_polynomial(self, x: Vector, modulo: Sequence[Vector] = ()) -> list[Scalar]:
        """The monic polynomial of lowest degree with f(x) = 0, or f(x) in an ideal, from the leading coefficient down.

        Args:
            x: An element of the algebra, which has a unit.
            modulo: A basis of the ideal.
        """
        assert self.unit is not None
        powers = [self.unit]
        rank = len(modulo)
        while len(self.echelon([*modulo, *powers])) == rank + len(powers):
            powers.append(self.multiply(powers[-1], x))
        coefficients = self.coordinates(powers[-1], [*powers[:-1], *modulo])
        return [self.field.one, *(-c for c in reversed(coefficients[: len(powers) - 1]))]

    def _evaluate(self, polynomial: Sequence[Scalar], x: Vector) -> Vector:
        assert self.unit is not None
        value = (self.field.zero,) * self.dimension
        for c in polynomial:
            value = self.combine([self.field.one, c], [self.multiply(value, x), self.unit])
        return value

    def _kernel(self, y: Vector) -> list[Vector]:
        """The elements that a power of y annihilates."""
        power = y
        for _ in range(self.dimension.bit_length()):  # y^(2^k) with 2^k > n
            power = self.multiply(power, power)
        return self.annihilator_of([power])

    def _split(self, vector: Vector, subspaces: Sequence[Sequence[Vector]]) -> list[Vector]:
        coefficients = self.coordinates(vector, [b for space in subspaces for b in space])
        parts: list[Vector] = []
        for space in subspaces:
            parts.append(self.combine(coefficients[: len(space)], space))
            coefficients = coefficients[len(space) :]
        return parts


@final
@dataclass(frozen=True)
class Component:
    """A primary component: a direct factor that is local over the field.

    Attributes:
        algebra: The algebra it is a part of.
        basis: Basis of the component, vectors of the algebra.
        unit: Its unit, an idempotent of the algebra.
        generator: An element that generates the residue field.
        polynomial: Its minimal polynomial there, monic and irreducible, coefficients from the leading one down.
    """

    algebra: CommutativeAlgebra
    basis: tuple[Vector, ...]
    unit: Vector
    generator: Vector
    polynomial: tuple[Scalar, ...]

    @property
    def degree(self) -> int:
        """Degree of the residue field."""
        return len(self.polynomial) - 1

    @property
    def discriminant(self) -> Scalar:
        r"""$D = p^2/4 - q$ of a quadratic polynomial $x^2 + p x + q$: the residue field is $K(\sqrt D)$."""
        _, p, q = self.polynomial
        return p * p / self.algebra.field.number(4) - q

    @cached_property
    def powers(self) -> list[list[Vector]]:
        """Bases of m, m^2, ... for the maximal ideal m, the nilpotent elements."""
        algebra = self.algebra
        ideal = algebra.echelon([algebra.multiply(self.unit, v) for v in algebra.nilradical])
        return algebra.powers_of(ideal)

    @cached_property
    def hilbert_function(self) -> tuple[int, ...]:
        r"""$\dim m^i/m^{i+1}$, $i = 0, 1, \dots$, over the residue field."""
        sizes = [len(self.basis), *map(len, self.powers), 0]
        return tuple((a - b) // self.degree for a, b in pairwise(sizes))

    @cached_property
    def socle(self) -> list[Vector]:
        """Basis of the elements of the component that its maximal ideal annihilates."""
        algebra = self.algebra
        killed = algebra.annihilator_of(self.powers[0]) if self.powers else algebra.basis
        return algebra.echelon([algebra.multiply(self.unit, v) for v in killed])


def _dot(field: RealField, u: Sequence[Scalar], v: Sequence[Scalar]) -> Scalar:
    total = field.zero
    for a, b in zip(u, v, strict=True):
        total = total + a * b
    return total
