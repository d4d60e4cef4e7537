r"""Orbits of twists under the automorphisms of the algebra, with representatives.

A unital algebra is the direct sum of local ones, $H^2$ that of theirs, and an automorphism permutes isomorphic ones and
acts in each.  So an orbit is one of each local factor, and the order of those of isomorphic factors does not count.
Those of local algebras are in `local_orbits`; where a factor is none of these, and without a unit, orbits are not
decided here, except that an algebra without classes has one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import combinations_with_replacement, groupby, product
from operator import add
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import Exact, symbols_of, to_sympy
from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.structure.automorphisms import Automorphism
from liepoisson.structure.classification import Classification, classify
from liepoisson.structure.cohomology.binary_cubics import Cubic, cubic_form
from liepoisson.structure.cohomology.change_of_basis import Rows, from_basis, in_basis, multiplied
from liepoisson.structure.cohomology.local_orbits import ZERO, LocalOrbits, cubic_of
from liepoisson.structure.derivations import arrows
from liepoisson.structure.extension import Extension, Products
from liepoisson.structure.normal_forms import null_square

if TYPE_CHECKING:
    from liepoisson.structure.cohomology.cocycle import Cocycle
    from liepoisson.structure.cohomology.twists import Twists


@explains_its_methods
@dataclass(frozen=True, eq=False)
class TwistOrbit:
    """One orbit of classes of cocycles under the automorphisms of the algebra.

    Example:
        >>> lp.cocycles(lp.so(3) @ lp.semidirect(3)).orbits()[1]
        <TwistOrbit a triple root: e1*e1 = e2, codimension 2, R[x]/(x^3)>

    Attributes:
        condition: Which classes are in it, in words.
        representative: A cocycle of it.
        dimension: Of the orbit.
        codimension: In the space of all classes.
        name: What the algebra becomes by a small twist of this kind, over the reals.
        complex_name: The same over the complex numbers.
    """

    condition: str
    representative: Cocycle
    dimension: int
    codimension: int
    name: str
    complex_name: str

    def __repr__(self) -> str:
        return f"<TwistOrbit {self.condition}: {self.representative}, codimension {self.codimension}, {self.name}>"


@explains_its_methods
@dataclass(frozen=True, eq=False)
class TwistOrbits:
    """All orbits of the classes of cocycles, if they are known.

    Example:
        >>> for orbit in lp.cocycles(lp.semidirect(3)).orbits():
        ...     print(f"{orbit.condition}: {orbit.name}")
        zero: R[x,y]/(x,y)^2
        a triple root: R[x]/(x^3)
        a double root: R[x]/(x^2) + R
        three real roots: R + R + R
        one real root: C + R

    Attributes:
        orbits: They, the smaller ones first; empty if this is not decided.
        is_decided: Whether the orbits are known.
        reason: By what, in words, or what is missing.
    """

    orbits: tuple[TwistOrbit, ...]
    is_decided: bool
    reason: str

    def __iter__(self) -> Iterator[TwistOrbit]:
        return iter(self.orbits)

    def __len__(self) -> int:
        return len(self.orbits)

    def __getitem__(self, k: int) -> TwistOrbit:
        return self.orbits[k]

    def __repr__(self) -> str:
        return f"<TwistOrbits: {len(self)} orbits>" if self.is_decided else "<TwistOrbits: not decided>"


@explains_its_methods
@dataclass(frozen=True, eq=False)
class TwistForm:
    r"""How a twist is brought to the representative of its orbit.

    Example:
        >>> f = lp.cocycles(lp.so(3) @ lp.semidirect(3)).combination([2, 0, 0, 0])
        >>> f.normal_form()
        <TwistForm a triple root, R[x]/(x^3): beta -> 2*beta>

    Attributes:
        orbit: The orbit.
        automorphism: The linear map of fields: P with $e'_i = \sum_j P_{ij} e_j$, in which basis the cocycle is the
            representative, up to a coboundary, and the algebra is the normal form.  None if it is not written out.
        field_extension: The field that its entries generate.
        text: The map in words.
    """

    orbit: TwistOrbit
    automorphism: Automorphism | None
    field_extension: str
    text: str

    def __repr__(self) -> str:
        return f"<TwistForm {self.orbit.condition}, {self.orbit.name}: {self.text}>"


UNKNOWN = "not decided: known where each local factor is R[x]/(x^n), C[x]/(x^n) or R[x,y]/(x,y)^2, or has no class"
"""Why no orbits are told."""


def orbits(twists: Twists) -> TwistOrbits:
    """The orbits of all classes; see `Twists.orbits`."""
    if twists.is_rigid:
        return TwistOrbits((_zero(twists),), True, "there is no class but zero")
    if (known := _factors(twists)) is None:
        return TwistOrbits((), False, UNKNOWN)
    found, factors = known
    made = [_orbit(twists, found, factors, names) for names in _choices(factors)]
    made.sort(key=lambda orbit: orbit.dimension)
    return TwistOrbits(tuple(made), True, f"orbits of the local factors of {found.name}")


def normal_form(f: Cocycle) -> TwistForm:
    """The orbit of a cocycle, and the way to its representative; see `Cocycle.normal_form`."""
    twists = f.twists
    values = [value for row in f.products.values() for value in row.values()]
    if twists.extension.symbols or any(symbols_of(value) for value in values):
        raise ParameterError(
            f"the orbit of a twist depends on the values of symbols; got {f} of {twists.extension.name}. Insert "
            "numbers."
        )
    if f.is_coboundary:
        found = classify(twists.extension)
        return _form(f, _zero(twists), found.change_of_basis, found.field_extension)
    if (known := _factors(twists)) is None:
        raise ParameterError(f"the orbit of a twist of {twists.extension.name} is {UNKNOWN}. Classify the algebra.")
    found, factors = known
    assert found.change_of_basis is not None
    there = in_basis(f.representative.products, found.change_of_basis)
    parts = [_part(there, factors, k) for k in range(len(factors))]
    names = [factor.orbit_of(part) for factor, part in zip(factors, parts, strict=True)]
    rows, field = _rows_of_cubic(parts[0], found) if found.name == null_square(3).name else (None, "Q")
    return _form(f, _orbit(twists, found, factors, _in_order(factors, names)), rows, field)


def _rows_of_cubic(f: Cocycle, found: Classification) -> tuple[Rows | None, str]:
    """The basis in which a twist of two fields is the representative, and the field that this needs."""
    assert found.change_of_basis is not None
    cubic, field = cubic_of(f)
    if not all(isinstance(value, Fraction) for value in cubic):
        return None, field.name
    form = cubic_form(cast("Cubic", cubic))
    one, zero = Fraction(1), Fraction(0)
    inner: list[list[Exact]] = [[one, zero, zero], *([zero, *row] for row in form.rows)]
    return multiplied(inner, found.change_of_basis), form.field_extension


def _zero(twists: Twists) -> TwistOrbit:
    """The orbit of the class zero."""
    found = classify(twists.extension)
    return TwistOrbit(ZERO, twists.cocycle({}), 0, twists.dimension, found.name, found.complex_name)


def _form(f: Cocycle, orbit: TwistOrbit, rows: Rows | None, field: str) -> TwistForm:
    if rows is None:
        return TwistForm(orbit, None, field, "not written out")
    shown: list[list[Any]] = [[to_sympy(value) for value in row] for row in rows]
    return TwistForm(orbit, Automorphism(cast("Any", rows)), field, arrows(f.twists.extension.field_names, shown))


def _factors(twists: Twists) -> tuple[Classification, list[LocalOrbits]] | None:
    """What the algebra is, and the orbits of its local factors, if they are known."""
    found = classify(twists.extension)
    if not found.is_unital or found.change_of_basis is None:
        return None
    factors = [LocalOrbits.of(cast("Extension", factor.normal_form)) for factor in found.factors]
    return None if None in factors else (found, cast("list[LocalOrbits]", factors))


def _choices(factors: Sequence[LocalOrbits]) -> list[tuple[str, ...]]:
    """An orbit for each factor; isomorphic factors stand beside each other, and their order does not count."""
    groups = [list(group) for _, group in groupby(factors, key=lambda factor: factor.algebra.name)]
    chosen = [combinations_with_replacement(group[0].representatives, len(group)) for group in groups]
    return [tuple(name for names in choice for name in names) for choice in product(*chosen)]


def _in_order(factors: Sequence[LocalOrbits], names: Sequence[str]) -> list[str]:
    """The orbits of isomorphic factors in the order of their list."""
    pairs = zip(factors, names, strict=True)
    groups = (list(group) for _, group in groupby(pairs, key=lambda pair: pair[0].algebra.name))
    return [
        name for group in groups for name in sorted((n for _, n in group), key=list(group[0][0].representatives).index)
    ]


def _told(factors: Sequence[LocalOrbits], names: Sequence[str]) -> str:
    """The condition in words, that of a single factor as it is."""
    if len(factors) == 1:
        return names[0]
    pairs = zip(factors, names, strict=True)
    return "; ".join(f"{factor.algebra.name}: {name}" for factor, name in pairs if name != ZERO) or ZERO


def _part(products: Products, factors: Sequence[LocalOrbits], k: int) -> Cocycle:
    """What a cocycle of the sum is in one of its factors."""
    from liepoisson.structure.cohomology.twists import cocycles

    start = sum(factor.algebra.dimension for factor in factors[:k])
    inside = range(start, start + factors[k].algebra.dimension)
    part = {
        (i - start, j - start): {m - start: value for m, value in row.items() if m in inside}
        for (i, j), row in products.items()
        if i in inside and j in inside
    }
    return cocycles(factors[k].algebra).cocycle(cast("Any", part))


def _orbit(twists: Twists, found: Classification, factors: Sequence[LocalOrbits], names: Sequence[str]) -> TwistOrbit:
    """The orbit with these in the factors."""
    from liepoisson.structure.cohomology.twists import cocycles

    assert found.change_of_basis is not None
    products, deformed, start = Products(), list[Extension](), 0
    for factor, name in zip(factors, names, strict=True):
        own = factor.representatives[name]
        for (i, j), row in own.items():
            products[i + start, j + start] = {k + start: value for k, value in row.items()}
        deformed.append(cocycles(factor.algebra).cocycle(cast("Any", own)).extension(1))
        start += factor.algebra.dimension
    f = twists.cocycle(cast("Any", from_basis(products, found.change_of_basis)))
    dimension, becomes = f.orbit_dimension, classify(reduce(add, deformed))
    codimension = twists.dimension - dimension
    return TwistOrbit(_told(factors, names), f, dimension, codimension, becomes.name, becomes.complex_name)
