r"""Symmetric cochains of a commutative algebra with values in it, of degree one to three, and their differentials.

$$(\delta g)(a, b) = a\,g(b) - g(ab) + g(a)\,b, \qquad
  (\delta f)(a, b, c) = a\,f(b, c) - f(ab, c) + f(a, bc) - f(a, b)\,c .$$

A unit, where there is one, is put into no argument: cochains with $g(1) = 0$, $f(1, b) = 0$ have the same cohomology
(normalised cochains).  Their arguments are elements of $A/\mathbb R1$, so that one basis element is left out.

References: Harrison, Trans. Amer. Math. Soc. 104 (1962) 191; Gerstenhaber, Ann. of Math. 79 (1964) 59.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import combinations_with_replacement
from typing import Any, TypeAlias

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.echelon import Echelon, Vector
from liepoisson.algebra.linear_algebra import NullSpace, nullspace
from liepoisson.inputs.deadline import checkpoint
from liepoisson.structure.extension import Products

Map: TypeAlias = "dict[tuple[int, int], Any]"
"""A linear map, $g(e_i) = \\sum_k$ `g[i, k]` $e_k$; without zeros."""

Cochain: TypeAlias = "dict[tuple[int, int, int], Any]"
"""A symmetric bilinear map, $f(e_i, e_j) = \\sum_k$ `f[i, j, k]` $e_k$ for i <= j; without zeros."""

Trilinear: TypeAlias = "dict[tuple[int, int, int, int], Any]"
"""A trilinear map with F(a, b, c) = -F(c, b, a), by (a, b, c, k) with a < c; without zeros."""

_MAP, _KEPT = 0, 1  # the two parts of a row: what it is, and what it is the image of


class CommutativeComplex:
    r"""The cochains of an algebra $e_i e_j = \sum_k W_k{}^{ij} e_k$, in coordinates over a field.

    Args:
        dimension: Number n of basis elements.
        products: `products[i, j][k]`, i <= j, elements of the field, without zeros.
        field: Where they live.
        unit: The unit by its coordinates, if there is one.
        normalised: Whether the unit is put into no argument.

    Attributes:
        arguments: The numbers of the basis elements that are put into cochains: all but one if there is a unit.
    """

    def __init__(
        self,
        dimension: int,
        products: Mapping[tuple[int, int], Mapping[int, Any]],
        field: Coefficients,
        unit: Sequence[Any] | None = None,
        *,
        normalised: bool = True,
    ) -> None:
        self.dimension, self.field, self.unit = dimension, field, unit
        self._table = {pair: dict(row) for pair, row in products.items()}
        self._left_out: int | None = None
        self._weights: dict[int, Any] = {}
        if unit is not None and normalised:
            support = [k for k, value in enumerate(unit) if value]
            q = support[0]
            self._left_out, self._weights = q, {k: unit[k] / unit[q] for k in support[1:]}
        self.arguments = [k for k in range(dimension) if k != self._left_out]

    @classmethod
    def of(cls, dimension: int, products: Products, field: Coefficients) -> CommutativeComplex:
        """The normalised cochains of an algebra with exact products."""
        read = {pair: {k: field.read(value) for k, value in row.items()} for pair, row in products.items()}
        unit, pivots = _unit(dimension, read, field)
        found = cls(dimension, read, field, unit)
        found._pivots_of_unit = pivots
        return found

    _pivots_of_unit: tuple[Any, ...] = ()

    @cached_property
    def plain(self) -> CommutativeComplex:
        """All cochains, which take the unit as an argument, too."""
        return CommutativeComplex(self.dimension, self._table, self.field, self.unit, normalised=False)

    @property
    def pivots(self) -> list[Any]:
        """What the eliminations divided by: where none of these vanishes, values of parameters keep the dimensions."""
        unit = [value for value in self.unit or () if value]
        return [*self._pivots_of_unit, *unit, *self._classes[1].pivots, *self.coboundaries.pivots]

    def product(self, i: int, j: int) -> Mapping[int, Any]:
        """The product of two basis elements."""
        return self._table.get((i, j) if i <= j else (j, i), {})

    def argument(self, vector: Mapping[int, Any]) -> Vector:
        """An element as an argument of a cochain: modulo the unit."""
        if (c := vector.get(self._left_out) if self._left_out is not None else None) is None:
            return dict(vector)
        rest: Vector = {k: value for k, value in vector.items() if k != self._left_out}
        for k, weight in self._weights.items():
            _add(rest, k, -(c * weight))
        return rest

    @cached_property
    def _modulo_unit(self) -> dict[tuple[int, int], Vector]:
        """The products of arguments as arguments."""
        pairs = combinations_with_replacement(self.arguments, 2)
        return {(i, j): row for i, j in pairs if (row := self.argument(self.product(i, j)))}

    def _argument(self, i: int, j: int) -> Mapping[int, Any]:
        return self._modulo_unit.get((i, j) if i <= j else (j, i), {})

    @cached_property
    def pairs(self) -> list[tuple[int, int, int]]:
        """The coordinates (i, j, k) of a cochain, i <= j."""
        n = range(self.dimension)
        return [(i, j, k) for i, j in combinations_with_replacement(self.arguments, 2) for k in n]

    @cached_property
    def _column(self) -> dict[tuple[int, int, int], int]:
        return {pair: number for number, pair in enumerate(self.pairs)}

    def triples(self) -> Iterator[tuple[int, int, int]]:
        """The triples at which a differential of a symmetric cochain is told."""
        for a in self.arguments:
            for b in self.arguments:
                yield from ((a, b, c) for c in self.arguments if a < c)

    def of_map(self, g: Mapping[tuple[int, int], Any]) -> Cochain:
        r"""The coboundary $\delta g$ of a linear map that annihilates the unit."""
        checkpoint("a coboundary")
        rows = _by_first(g)
        found: Cochain = {}
        for i, j in combinations_with_replacement(self.arguments, 2):
            for p, q in ((i, j), (j, i)):
                for k, value in rows.get(q, {}).items():
                    for m, w in self.product(p, k).items():
                        _add(found, (i, j, m), w * value)
            for p, w in self._argument(i, j).items():
                for m, value in rows.get(p, {}).items():
                    _add(found, (i, j, m), -(w * value))
        return found

    @cached_property
    def _equations(self) -> dict[tuple[int, int, int, int], dict[int, Any]]:
        """The components of the differential as rows, by triples, in the coordinates of a cochain."""
        rows: dict[tuple[int, int, int, int], dict[int, Any]] = {}
        n, column = range(self.dimension), self._column

        def add(place: tuple[int, int, int, int], i: int, j: int, k: int, value: Any) -> None:
            _add(rows.setdefault(place, {}), column[(i, j, k) if i <= j else (j, i, k)], value)

        for a, b, c in self.triples():
            checkpoint("the equations of cocycles")
            for k in n:
                for m, w in self.product(a, k).items():
                    add((a, b, c, m), b, c, k, w)
                for m, w in self.product(k, c).items():
                    add((a, b, c, m), a, b, k, -w)
            for p, w in self._argument(a, b).items():
                for m in n:
                    add((a, b, c, m), p, c, m, -w)
            for p, w in self._argument(b, c).items():
                for m in n:
                    add((a, b, c, m), a, p, m, w)
        return {key: row for key, row in rows.items() if row}

    def of_cochain(self, f: Cochain) -> Trilinear:
        r"""The differential $\delta f$ of a cochain."""
        found: Trilinear = {}
        by_column = {self._column[key]: value for key, value in f.items()}
        for key, row in self._equations.items():
            for column in row.keys() & by_column.keys():
                _add(found, key, row[column] * by_column[column])
        return found

    def inner(self, h: Cochain) -> list[tuple[int, int, Vector]]:
        """(a, b, h(a, b)) with the value as an argument, for all pairs in both orders."""
        rows = ((i, j, self.argument(row)) for (i, j), row in _by_pair(h).items())
        return [entry for i, j, row in rows for entry in ([(i, j, row)] if i == j else [(i, j, row), (j, i, row)])]

    def outer(self, f: Cochain) -> dict[int, list[tuple[int, int, Any]]]:
        """All (other, k, coefficient) of f(e_p, e_other), by p."""
        found: dict[int, list[tuple[int, int, Any]]] = {}
        for (i, j, k), value in f.items():
            found.setdefault(i, []).append((j, k, value))
            if i != j:
                found.setdefault(j, []).append((i, k, value))
        return found

    def composed(
        self, outer: Mapping[int, list[tuple[int, int, Any]]], inner: Iterable[tuple[int, int, Vector]]
    ) -> Trilinear:
        r"""$f(h(a, b), c) - f(a, h(b, c))$, of `outer` of f and `inner` of h."""
        found: Trilinear = {}
        for a, b, row in inner:
            for p, value in row.items():
                for other, k, w in outer.get(p, ()):
                    if a < other:
                        _add(found, (a, b, other, k), value * w)
                    if other < b:
                        _add(found, (other, a, b, k), -(value * w))
        return found

    @cached_property
    def _classes(self) -> tuple[list[int], NullSpace]:
        """The cocycles without the places where rows of coboundaries lead: one for each class, by columns."""
        leads = {lead[1:] for lead in self.coboundaries.rows if lead[0] == _MAP}
        columns = [column for column, key in enumerate(self.pairs) if key not in leads]
        place = {column: k for k, column in enumerate(columns)}
        rows = ({place[c]: value for c, value in row.items() if c in place} for row in self._equations.values())
        return columns, nullspace([row for row in rows if row], len(columns), self.field)

    @cached_property
    def coboundaries(self) -> Echelon:
        """The coboundaries, each row with the map that it comes from; rows of maps alone are derivations."""
        echelon = Echelon(self.field)
        one, n = self.field.one, self.dimension
        elementary: list[Map] = [{(i, k): one} for i in self.arguments for k in range(n)]
        images = [(self.of_map(g), g) for g in elementary]
        for image, g in sorted(images, key=lambda pair: len(pair[0])):
            echelon.insert({(_MAP, *key): v for key, v in image.items()} | {(_KEPT, *key): v for key, v in g.items()})
        return echelon

    @cached_property
    def derivations(self) -> list[Map]:
        """A basis of the derivations."""
        rows = self.coboundaries.rows
        kept = (rows[lead] for lead in sorted(rows) if lead[0] == _KEPT)
        return [self.with_unit_in({key[1:]: v for key, v in row.items()}) for row in kept]

    @property
    def n_coboundaries(self) -> int:
        """The dimension of the space of coboundaries, of all maps: those that do not annihilate the unit, too."""
        return self.dimension**2 - len(self.derivations)

    @cached_property
    def basis(self) -> list[Cochain]:
        """Representatives of a basis of the cohomology in degree two.

        In reduced echelon form modulo the coboundaries: each has the coefficient 1 at its first place, where no
        coboundary and no other representative has any.
        """
        columns, space = self._classes
        vectors = ({self.pairs[columns[k]]: value for k, value in vector.items()} for vector in space.vectors)
        return [dict(row) for row in Echelon(self.field, vectors).basis()]

    def reduced(self, f: Cochain) -> tuple[Cochain, Map]:
        r"""A cochain modulo coboundaries, f' and g with $f = f' + \delta g$."""
        left = self.coboundaries.reduce({(_MAP, *key): value for key, value in f.items()})
        remainder: Cochain = {key[1:]: value for key, value in left.items() if key[0] == _MAP}
        return remainder, self.with_unit_in({key[1:]: -value for key, value in left.items() if key[0] == _KEPT})

    def with_unit_in(self, g: Map) -> Map:
        """A map that annihilates the unit, by all basis elements, that which was left out among them."""
        found = dict(g)
        for (i, k), value in g.items():
            if i in self._weights:
                _add(found, (self._left_out, k), -(self._weights[i] * value))
        return found

    def coordinates(self, f: Cochain) -> tuple[list[Any], Map]:
        r"""The class of a cocycle in `basis`, and g such that f is this combination plus $\delta g$."""
        remainder, g = self.reduced(f)
        leads = [min(row) for row in self.basis]
        values = [remainder.get(lead, self.field.zero) for lead in leads]
        assert not combined([(self.field.one, remainder), *((-c, b) for c, b in zip(values, self.basis, strict=True))])
        return values, g

    @cached_property
    def images(self) -> Echelon:
        """The differentials of cochains, each row with the cochain that it comes from."""
        columns: list[dict[Any, Any]] = [{(_KEPT, *key): self.field.one} for key in self.pairs]
        for key, row in self._equations.items():
            for column, value in row.items():
                columns[column][_MAP, *key] = value
        return Echelon(self.field, sorted(columns, key=len))

    def mended(self, residual: Trilinear) -> tuple[Cochain, Trilinear]:
        r"""A cochain f and F' with $F = \delta f + F'$, of a trilinear map; F' is in a complement of differentials."""
        left = self.images.reduce({(_MAP, *key): value for key, value in residual.items()})
        f: Cochain = {key[1:]: -value for key, value in left.items() if key[0] == _KEPT}
        return f, {key[1:]: value for key, value in left.items() if key[0] == _MAP}

    def moved(self, D: Mapping[tuple[int, int], Any], f: Cochain) -> Cochain:
        """The rate of change of a cochain along a derivation, D(f(a, b)) - f(D a, b) - f(a, D b)."""
        rows, outer = _by_first(D), _by_pair(f)
        found: Cochain = {}
        for i, j in combinations_with_replacement(self.arguments, 2):
            for k, value in outer.get((i, j), {}).items():
                for m, w in rows.get(k, {}).items():
                    _add(found, (i, j, m), w * value)
            for first, other in ((i, j), (j, i)):
                for p, w in self.argument(rows.get(first, {})).items():
                    for m, value in outer.get(_ordered(p, other), {}).items():
                        _add(found, (i, j, m), -(w * value))
        return found

    def substituted(self, f: Cochain | None, g: Map | None, h: Map | None) -> Cochain:
        """f(g a, h b) for the product in place of f if it is None, and the identity in place of maps."""
        left, right = (None if one is None else _by_first(one) for one in (g, h))
        outer = self._table if f is None else _by_pair(f)
        found: Cochain = {}
        for i, j in combinations_with_replacement(self.arguments, 2):
            first = {i: self.field.one} if left is None else left.get(i, {})
            other = {j: self.field.one} if right is None else right.get(j, {})
            if f is not None:
                first, other = self.argument(first), self.argument(other)
            for p, v in first.items():
                for q, w in other.items():
                    for k, value in outer.get(_ordered(p, q), {}).items():
                        _add(found, (i, j, k), v * w * value)
        return found

    def applied(self, g: Map, f: Cochain) -> Cochain:
        """g(f(a, b)), for a map by all basis elements."""
        rows = _by_first(g)
        found: Cochain = {}
        for (i, j, k), value in f.items():
            for m, w in rows.get(k, {}).items():
                _add(found, (i, j, m), value * w)
        return found

    def multiplication_by(self, v: Mapping[int, Any]) -> Map:
        """The map x -> v x."""
        found: Map = {}
        for i in range(self.dimension):
            for p, c in v.items():
                for k, w in self.product(i, p).items():
                    _add(found, (i, k), c * w)
        return found

    def at_unit(self, f: Cochain) -> Vector:
        """f(1, 1), of a cochain by all pairs of basis elements."""
        unit = {i: c for i, c in enumerate(self.unit or ()) if c}
        found: Vector = {}
        for (i, j, k), value in f.items():
            if i in unit and j in unit:
                term = unit[i] * unit[j] * value
                _add(found, k, term if i == j else term + term)
        return found

    def is_normalised(self, f: Cochain) -> bool:
        """Whether f(1, .) = 0, of a cochain by all pairs of basis elements."""
        unit = {i: c for i, c in enumerate(self.unit or ()) if c}
        total: dict[tuple[int, int], Any] = {}
        for (i, j, k), value in f.items():
            if i in unit:
                _add(total, (j, k), unit[i] * value)
            if j in unit and i != j:
                _add(total, (i, k), unit[j] * value)
        return not total

    def restricted(self, f: Cochain) -> Cochain:
        """A normalised cochain by the pairs of arguments, from all pairs of basis elements."""
        return {key: value for key, value in f.items() if self._left_out not in key[:2]}

    def with_unit(self, f: Cochain) -> Cochain:
        """A normalised cochain by all pairs of basis elements, that which was left out among them."""
        if self._left_out is None or not self._weights:
            return dict(f)
        q, outer = self._left_out, _by_pair(f)
        found = dict(f)
        rows: dict[int, Vector] = {}
        for j in self.arguments:  # e_q = 1/u_q - sum of weights times e_i, and f(1, .) = 0
            for i, weight in self._weights.items():
                for k, value in outer.get(_ordered(i, j), {}).items():
                    _add(rows.setdefault(j, {}), k, -(weight * value))
        for j, row in rows.items():
            for k, value in row.items():
                found[*_ordered(q, j), k] = value
            if j in self._weights:
                for k, value in row.items():
                    _add(found, (q, q, k), -(self._weights[j] * value))
        return found


def _unit(
    n: int, products: Mapping[tuple[int, int], Mapping[int, Any]], field: Coefficients
) -> tuple[list[Any] | None, tuple[Any, ...]]:
    """The solution of u e_j = e_j, if there is one, and what the elimination divided by."""
    rows: dict[tuple[int, int], dict[int, Any]] = {}
    for (i, j), row in products.items():
        for k, w in row.items():
            rows.setdefault((j, k), {})[i] = w
            rows.setdefault((i, k), {})[j] = w
    for j in range(n):
        rows.setdefault((j, j), {})[n] = -field.one
    space = nullspace(list(rows.values()), n + 1, field)
    (*_, last) = [{}, *space.vectors]
    return ([last.get(k, field.zero) for k in range(n)] if n in last else None), space.pivots


def combined(terms: Sequence[tuple[Any, Mapping[Any, Any]]]) -> dict[Any, Any]:
    """The sum of multiples of cochains, (factor, cochain)."""
    total: dict[Any, Any] = {}
    for factor, cochain in terms:
        if factor:
            for key, value in cochain.items():
                _add(total, key, factor * value)
    return total


def _add(total: dict[Any, Any], key: Any, value: Any) -> None:
    """Add to an entry, dropping zeros."""
    value = total[key] + value if key in total else value
    if value:
        total[key] = value
    else:
        total.pop(key, None)


def _ordered(i: int, j: int) -> tuple[int, int]:
    return (i, j) if i <= j else (j, i)


def _by_first(g: Mapping[tuple[int, int], Any]) -> dict[int, Vector]:
    rows: dict[int, Vector] = {}
    for (i, k), value in g.items():
        rows.setdefault(i, {})[k] = value
    return rows


def _by_pair(f: Mapping[tuple[int, int, int], Any]) -> dict[tuple[int, int], Vector]:
    rows: dict[tuple[int, int], Vector] = {}
    for (i, j, k), value in f.items():
        rows.setdefault((i, j), {})[k] = value
    return rows
