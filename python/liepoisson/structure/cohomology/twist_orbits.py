r"""Orbits of twists under the automorphisms of the algebra, with representatives.

* $\mathbb R[x,y]/(x,y)^2$: the classes are the binary cubics $C(v) = v \wedge f(v, v)$, on which GL2 acts, twisted by
  the determinant.  There are five orbits, told apart by the roots, and the twists are all unital algebras of dimension
  three.
* $\mathbb R[x]/(x^n)$: the classes are the polynomials p of degree at most n - 2, the deformations $x^n = t\,p(x)$.
  The substitution $x = y w(y)$ takes p to $p(y w)\,w^{-n}$ modulo $y^{n-1}$; so $p = x^i v(x)$ with $v(0) \ne 0$ goes to
  $x^i$ or $-x^i$, for which $w^{n-i} = \pm v(y w)$ is to be solved: with the sign of $v(0)$ if n - i is even, else with
  either one.
* An algebra without classes has one orbit.

Others are not decided here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from liepoisson.algebra.exact_numbers import Exact, symbols_of, to_sympy
from liepoisson.algebra.matrices import solved
from liepoisson.algebra.real_fields import real_field
from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.structure.automorphisms import Automorphism
from liepoisson.structure.cohomology.binary_cubics import KINDS, Cubic, cubic_form, discriminant, kind_of
from liepoisson.structure.classification import Classification, classify
from liepoisson.structure.extension import Products
from liepoisson.structure.normal_forms import null_square, truncated_polynomials

if TYPE_CHECKING:
    from liepoisson.structure.cohomology.cocycle import Cocycle
    from liepoisson.structure.cohomology.twists import Cocycles

Rows = Sequence[Sequence[Exact]]


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
    """How a twist is brought to the representative of its orbit.

    Example:
        >>> f = lp.cocycles(lp.so(3) @ lp.semidirect(3)).combination([2, 0, 0, 0])
        >>> form = f.normal_form()
        >>> form.orbit.name, form.text
        ('R[x]/(x^3)', 'beta -> 2*beta')

    Attributes:
        orbit: The orbit.
        automorphism: The linear map of fields: P with $e'_i = \\sum_j P_{ij} e_j$, in which basis the cocycle is the
            representative, up to a coboundary, and the algebra is the normal form.  None if it is not written out.
        field_extension: The field that its entries generate.
        text: The map in words.
    """

    orbit: TwistOrbit
    automorphism: Automorphism | None
    field_extension: str
    text: str


def orbits(twists: Cocycles) -> TwistOrbits:
    """The orbits of all classes; see `Cocycles.orbits`."""
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
    twists = f.twists
    values = [value for row in f.products.values() for value in row.values()]
    if any(symbols_of(value) for value in values) or twists.extension.symbols:
        raise ParameterError(
            f"the orbit of a twist depends on the values of symbols; got {f} of {twists.extension.name}. Insert numbers."
        )
    known = orbits(twists)
    kind, found = ("", None) if twists.is_rigid else _kind(twists)
    if twists.is_rigid or f.is_coboundary and known.is_decided:
        identity = [[Fraction(int(i == j)) for j in range(twists.extension.dimension)] for i in range(twists.extension.dimension)]
        rows = identity if found is None else _own_basis(found)
        return _form(f, known[0], rows, "Q")
    if not known.is_decided or found is None:
        raise ParameterError(f"the orbit of a twist of {twists.extension.name} is {known.reason}. Classify the algebra.")
    own = _own_basis(found)
    there = in_basis(f.representative.products, own)
    return _of_cubic(f, known, own, there) if kind == "null square" else _of_power(f, known, there)


def _of_cubic(f: Cocycle, known: TwistOrbits, own: Rows, there: dict[tuple[int, int, int], Any]) -> TwistForm:
    zero: Any = Fraction(0)
    get = lambda i, j, k: there.get((i, j, k), zero)  # noqa: E731
    two: Any = Fraction(2)
    cubic = (get(1, 1, 2), two * get(1, 2, 2) - get(1, 1, 1), get(2, 2, 2) - two * get(1, 2, 1), -get(2, 2, 1))
    if not all(isinstance(value, Fraction) for value in cubic):
        field = real_field(cubic)
        read = [field.read(value) for value in cubic]
        disc = discriminant(read)
        kind = kind_of(read, field.sign(disc) if disc else 0)
        return TwistForm(_named(known, kind), None, field.name, "not written out")
    found = cubic_form(cast("Cubic", cubic))
    (p, q), (r, s) = found.rows
    inner = [[1, 0, 0], [0, p, q], [0, r, s]]
    if all(isinstance(value, Fraction) for row in own for value in row) and found.field_extension == "Q":
        rows: Any = [[sum((Fraction(x) * own[k][j] for k, x in enumerate(row)), Fraction(0)) for j in range(3)] for row in inner]  # pyright: ignore
    else:
        from sympy import Add

        rows = [
            [Add(*(to_sympy(Fraction(x) if isinstance(x, int) else x) * to_sympy(own[k][j]) for k, x in enumerate(row))) for j in range(3)]
            for row in inner
        ]
    return _form(f, _named(known, found.kind), rows, found.field_extension)


def _of_power(f: Cocycle, known: TwistOrbits, there: dict[tuple[int, int, int], Any]) -> TwistForm:
    """The orbit of p = x^i v(x), from the class in the basis of powers."""
    from liepoisson.structure.cohomology.twists import cocycles

    n = f.twists.extension.dimension
    standard = cocycles(truncated_polynomials(n))
    products: Products = {}
    for (i, j, k), value in there.items():
        products.setdefault((i, j), {})[k] = value
    coordinates = standard.cocycle(products).coordinates
    i, value = next((i, c) for i, c in enumerate(coordinates) if c != 0)
    field = real_field([value])
    sign = field.sign(field.read(value)) if (n - i) % 2 == 0 else 1
    return TwistForm(_named(known, _condition(n, i, sign)), None, "Q", "not written out")


def _form(f: Cocycle, orbit: TwistOrbit, rows: Rows, field: str) -> TwistForm:
    from liepoisson.structure.derivations import arrows

    shown: list[list[Any]] = [[to_sympy(value) for value in row] for row in rows]
    return TwistForm(orbit, Automorphism(cast("Any", rows)), field, arrows(f.twists.extension.field_names, shown))


def _named(known: TwistOrbits, condition: str) -> TwistOrbit:
    return next(orbit for orbit in known if orbit.condition == condition)


def _condition(n: int, i: int, sign: int) -> str:
    text = f"x^{n} = {'t' if sign > 0 else '-t'}*x^{i}" if i else f"x^{n} = {'t' if sign > 0 else '-t'}"
    return text.replace("x^1", "x") if i == 1 else text


def _kind(twists: Cocycles) -> tuple[str, Classification]:
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


def _orbit(twists: Cocycles, condition: str, products: Products, rows: Rows | None = None) -> TwistOrbit:
    """The orbit of a cocycle that is given in the basis of the rows."""
    if rows is not None:
        products = _products(from_basis(products, rows))
    f = twists.cocycle(cast("Any", products))
    found = classify(f.extension(1))
    dimension = f.orbit_dimension
    return TwistOrbit(
        condition, f, dimension, twists.dimension - dimension, found.name, found.complex_name
    )


def _products(entries: dict[tuple[int, int, int], Any]) -> Products:
    found: Products = {}
    for (i, j, k), value in entries.items():
        found.setdefault((i, j), {})[k] = value
    return found


def in_basis(products: Products, rows: Rows) -> dict[tuple[int, int, int], Any]:
    """A cochain in another basis, $e'_i = \\sum_j P_{ij} e_j$: f(e'_i, e'_j) by its coordinates in e'."""
    return _in_basis(products, rows, _inverse(rows))


def from_basis(products: Products, rows: Rows) -> dict[tuple[int, int, int], Any]:
    """The cochain that is given in the basis of the rows."""
    return _in_basis(products, _inverse(rows), rows)


def _in_basis(products: Products, rows: Rows, back: Rows) -> dict[tuple[int, int, int], Any]:
    field = real_field([v for row in (*rows, *back) for v in row] + [v for row in products.values() for v in row.values()])
    n = len(rows)
    P, Q = ([[field.read(v) for v in row] for row in matrix] for matrix in (rows, back))
    found: dict[tuple[int, int, int], Any] = {}
    for i in range(n):
        for j in range(i, n):
            total = [field.zero] * n
            for (a, b), row in products.items():
                weight = P[i][a] * P[j][b] + (P[i][b] * P[j][a] if a != b else field.zero)
                for k, value in row.items() if weight else ():
                    total[k] = total[k] + weight * field.read(value)
            for k in range(n):
                value = field.zero
                for m in range(n):
                    value = value + total[m] * Q[m][k]
                if value:
                    found[i, j, k] = field.write(value)
    return found


def _inverse(rows: Rows) -> Rows:
    field = real_field(v for row in rows for v in row)
    n = range(len(rows))
    # P^T x = e_j has the columns of the transposed inverse
    matrix = [[field.read(v) for v in row] for row in rows]
    identity = [[field.one if i == j else field.zero for j in n] for i in n]
    return [[field.write(v) for v in row] for row in solved(matrix, identity, field)]
