r"""Orbits of twists under the automorphisms of the algebra, with representatives.

* $\mathbb R[x,y]/(x,y)^2$: the classes are the binary cubics $C(v) = v \wedge f(v, v)$, on which GL2 acts, twisted by
  the determinant.  There are five orbits, told apart by the roots, and the twists are all unital algebras of dimension
  three.
* $\mathbb R[x]/(x^n)$: the classes are the polynomials p of degree at most n - 2, the deformations $x^n = t\,p(x)$.
  The substitution $x = y w(y)$ takes p to $p(y w)\,w^{-n}$ modulo $y^{n-1}$; so $p = x^i v(x)$ with $v(0) \ne 0$ goes
  to $x^i$ or $-x^i$, for which $w^{n-i} = \pm v(y w)$ is to be solved: with the sign of $v(0)$ if n - i is even, else
  with either one.
* An algebra without classes has one orbit.

Others are not decided here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import Exact, symbols_of, to_sympy
from liepoisson.algebra.real_fields import real_field
from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.structure.automorphisms import Automorphism
from liepoisson.structure.classification import Classification, classify
from liepoisson.structure.cohomology.binary_cubics import KINDS, Cubic, cubic_form, discriminant, kind_of
from liepoisson.structure.cohomology.change_of_basis import Rows, from_basis, in_basis, multiplied
from liepoisson.structure.derivations import arrows
from liepoisson.structure.extension import Products
from liepoisson.structure.normal_forms import null_square, truncated_polynomials

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
        >>> form = f.normal_form()
        >>> form.orbit.name, form.text
        ('R[x]/(x^3)', 'beta -> 2*beta')

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


def orbits(twists: Twists) -> TwistOrbits:
    """The orbits of all classes; see `Twists.orbits`."""
    if twists.is_rigid:
        return TwistOrbits((_orbit(twists, "zero", {}),), True, "there is no class but zero")
    kind, found = _kind(twists)
    if kind == "null square":
        rows = _own_basis(found)
        made = [_orbit(twists, name, _products_of_cubic(form), rows) for name, form in KINDS.items()]
        return TwistOrbits(tuple(made), True, "binary cubics, by their roots")
    if kind == "truncated":
        n, rows = twists.extension.dimension, _own_basis(found)
        made = [_orbit(twists, "zero", {}, rows)]
        for i in reversed(range(n - 1)):
            for sign in (1, -1) if (n - i) % 2 == 0 else (1,):
                made.append(_orbit(twists, _condition(n, i, sign), _products_of_power(n, i, sign), rows))
        return TwistOrbits(tuple(made), True, "x^n = p(x), by the order of p")
    return TwistOrbits((), False, "not decided: known for R[x,y]/(x,y)^2, for R[x]/(x^n), and where there is no class")


def normal_form(f: Cocycle) -> TwistForm:
    """The orbit of a cocycle, and the way to its representative; see `Cocycle.normal_form`."""
    twists, known = f.twists, orbits(f.twists)
    values = [value for row in f.products.values() for value in row.values()]
    if twists.extension.symbols or any(symbols_of(value) for value in values):
        raise ParameterError(
            f"the orbit of a twist depends on the values of symbols; got {f} of {twists.extension.name}. Insert "
            "numbers."
        )
    if not known.is_decided:
        raise ParameterError(
            f"the orbit of a twist of {twists.extension.name} is {known.reason}. Classify the algebra."
        )
    kind, found = _kind(twists)
    own = found.change_of_basis
    if f.is_coboundary:
        return _form(f, known[0], own, found.field_extension)
    assert own is not None
    there = in_basis(f.representative.products, own)
    return _of_cubic(f, known, own, there) if kind == "null square" else _of_power(f, known, there)


def _of_cubic(f: Cocycle, known: TwistOrbits, own: Rows, there: Products) -> TwistForm:
    p, q, r = (there.get(pair, {}) for pair in ((1, 1), (1, 2), (2, 2)))
    field = real_field(value for row in (p, q, r) for value in row.values())

    def entry(row: Mapping[int, Exact], k: int) -> Any:
        return field.read(row[k]) if k in row else field.zero

    two = field.number(2)
    cubic = (entry(p, 2), two * entry(q, 2) - entry(p, 1), entry(r, 2) - two * entry(q, 1), -entry(r, 1))
    if not all(isinstance(value, Fraction) for value in cubic):
        disc = discriminant(cubic)
        kind = kind_of(cubic, field.sign(disc) if disc else 0)
        return _form(f, _named(known, kind), None, field.name)
    found = cubic_form(cast("Cubic", cubic))
    one, zero = Fraction(1), Fraction(0)
    inner = [[one, zero, zero], *([zero, *row] for row in found.rows)]
    return _form(f, _named(known, found.kind), multiplied(inner, own), found.field_extension)


def _of_power(f: Cocycle, known: TwistOrbits, there: Products) -> TwistForm:
    """The orbit of p = x^i v(x), from the class in the basis of powers."""
    from liepoisson.structure.cohomology.twists import cocycles

    n = f.twists.extension.dimension
    coordinates = cocycles(truncated_polynomials(n)).cocycle(cast("Any", there)).coordinates
    i, value = next((i, c) for i, c in enumerate(coordinates) if c != 0)
    field = real_field([value])
    sign = field.sign(field.read(value)) if (n - i) % 2 == 0 else 1
    return _form(f, _named(known, _condition(n, i, sign)), None, field.name)


def _form(f: Cocycle, orbit: TwistOrbit, rows: Rows | None, field: str) -> TwistForm:
    if rows is None:
        return TwistForm(orbit, None, field, "not written out")
    shown: list[list[Any]] = [[to_sympy(value) for value in row] for row in rows]
    return TwistForm(orbit, Automorphism(cast("Any", rows)), field, arrows(f.twists.extension.field_names, shown))


def _named(known: TwistOrbits, condition: str) -> TwistOrbit:
    return next(orbit for orbit in known if orbit.condition == condition)


def _condition(n: int, i: int, sign: int) -> str:
    text = f"x^{n} = {'t' if sign > 0 else '-t'}*x^{i}" if i else f"x^{n} = {'t' if sign > 0 else '-t'}"
    return text.replace("x^1", "x") if i == 1 else text


def _kind(twists: Twists) -> tuple[str, Classification]:
    """Which of the two families the algebra belongs to, if to one."""
    found = classify(twists.extension)
    n = twists.extension.dimension
    if found.name == null_square(3).name:
        return "null square", found
    if n >= 2 and found.name == truncated_polynomials(n).name:
        return "truncated", found
    return "", found


def _own_basis(found: Classification) -> Rows:
    assert found.change_of_basis is not None
    return found.change_of_basis


def _products_of_cubic(form: Sequence[int]) -> Products:
    """The cocycle e1 e1 = -b e1 + a e2, e2 e2 = -d e1 + c e2 of a cubic."""
    a, b, c, d = (Fraction(x) for x in form)
    return {(1, 1): {1: -b, 2: a}, (2, 2): {1: -d, 2: c}}


def _products_of_power(n: int, i: int, sign: int) -> Products:
    """x^n = x^i, read to first order."""
    pairs = [(a, b) for a in range(1, n) for b in range(a, n) if n <= a + b < 2 * n - i]
    return {(a, b): {a + b - n + i: Fraction(sign)} for a, b in pairs}


def _orbit(twists: Twists, condition: str, products: Products, rows: Rows | None = None) -> TwistOrbit:
    """The orbit of a cocycle that is given in the basis of the rows."""
    if rows is not None:
        products = from_basis(products, rows)
    f = twists.cocycle(cast("Any", products))
    found = classify(f.extension(1))
    dimension = f.orbit_dimension
    return TwistOrbit(condition, f, dimension, twists.dimension - dimension, found.name, found.complex_name)
