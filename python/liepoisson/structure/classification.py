r"""Which commutative algebra an extension is: its local factors over the reals, and the way to their normal forms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from operator import add
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra.exact_numbers import Exact, ExactMatrix, to_sympy
from liepoisson.algebra.matrices import determinant
from liepoisson.algebra.real_fields import RealField, Surd
from liepoisson.errors import ParameterError
from liepoisson.formula.parameters import Parameter
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.names import free_name
from liepoisson.structure.commutative_algebra import CommutativeAlgebra
from liepoisson.structure.extension import Extension, Products
from liepoisson.structure.local_normal_form import RealFactor, SurdVector, real_factors
from liepoisson.structure.normal_forms import complex_name, maximal_ideal

if TYPE_CHECKING:
    from sympy import Expr

MAX_FIELDS = 40
"""The largest number of fields that is classified, which takes some seconds; the work grows like its fourth power."""

_MOST_MINORS = 8  # a dense matrix of n rows has 2^n minors

EqualSymbols: TypeAlias = "tuple[tuple[tuple[str, ...], Expr], ...]"
"""Values of symbols, each with the names of all symbols that have it."""


@explains_its_methods
@dataclass(frozen=True)
class LocalFactor:
    """One local direct factor of an algebra over the reals.

    Example:
        >>> circle = lp.Extension.from_products(2, {(0, 0): {0: 1}, (0, 1): {1: 1}, (1, 1): {0: -1}})
        >>> [(factor.name, factor.residue_field) for factor in circle.classify().factors]  # i^2 = -1
        [('C', 'C')]

    Attributes:
        dimension: Over the reals.
        residue_field: "R" or "C", the factor modulo its maximal ideal m.
        hilbert_function: Dimensions of m^i / m^(i+1) over the residue field.
        socle_dimension: Dimension over the residue field of the elements that m annihilates.
        signature: Numbers of squares of either sign, the larger first, of the quadratic form that tells apart the
            algebras of this Hilbert function: that of the products for (1, d, 1), that of the relation for (1, 2, 2).
        normal_form: The normal form; None for an algebra that our lists do not contain.
        basis: One element of the algebra for each basis element of the normal form, in the coordinates of the given
            basis; None if there is no normal form, or if it would need roots of a polynomial of degree three or more.
    """

    dimension: int
    residue_field: str
    hilbert_function: tuple[int, ...]
    socle_dimension: int
    signature: tuple[int, int] | None
    normal_form: Extension | None
    basis: ExactMatrix | None

    @property
    def name(self) -> str:
        """The name of the normal form, or what is known."""
        if self.normal_form is not None:
            return self.normal_form.name
        return f"[local, residue field {self.residue_field}, Hilbert function {self.hilbert_function}]"


@explains_its_methods
@dataclass(frozen=True)
class Classification:
    """What an extension is, up to isomorphism over the reals.

    Example:
        >>> found = lp.leibniz(3, "epsilon").classify()
        >>> found.name, found.conditions
        ('R[x]/(x^3)', (epsilon,))
        >>> [(symbol, int(value), case.name) for symbol, value, case in found.exceptional]
        [('epsilon', 0, 'R[x,y]/(x,y)^2')]

    Attributes:
        extension: The extension that was asked about.
        is_unital: Whether it has a unit.
        factors: Its local factors, the largest first.  Of an algebra without unit: those of A + R 1, the last one
            being R + N with N the nilpotent part that has no unit.
        normal_form: The direct sum of the normal forms of the factors, for an algebra without unit the maximal ideal
            in place of the last factor; None if a factor has none.
        change_of_basis: P with e'_i = sum_j P[i][j] e_j, exact; in the basis e' the tensor is that of the normal form,
            which was verified.  None if a factor has no basis.
        field_extension: Name of the field that the entries of P generate, for example "Q" or "Q(sqrt(2))".  For a
            rational local W it is Q whenever that is possible, and no other P needs fewer square roots, except that for
            a definite form of rank three one might do where two are given.  (Rank three needs prime factors: of
            determinants beyond 128 bits they are not looked for, and roots may stand that are not needed.)
        adjoined: The square roots in it that are not in the field of the entries of W.
        complex_name: Names of the factors after complexification; real forms that differ by signs share it.
        conditions: With symbols the answer is the generic one: it holds where none of these expressions vanishes.
        exceptional: Values of a symbol at which one of them does vanish, with the answer there; only linear conditions
            are followed.
    """

    extension: Extension
    is_unital: bool
    factors: tuple[LocalFactor, ...]
    normal_form: Extension | None
    change_of_basis: ExactMatrix | None
    field_extension: str
    adjoined: tuple[Expr, ...]
    complex_name: str
    conditions: tuple[Expr, ...]
    exceptional: tuple[tuple[str, Exact, Classification], ...]

    @property
    def is_local(self) -> bool:
        """Whether the algebra is unital with one maximal ideal over the reals."""
        return self.is_unital and len(self.factors) == 1

    @property
    def name(self) -> str:
        """The names of the normal forms, joined by +."""
        names = [factor.name for factor in self.factors]
        if not self.is_unital:
            names[-1] = f"maximal ideal of {names[-1]}"
        return " + ".join(names)

    def __str__(self) -> str:
        text = f"{self.extension.name} is {self.name}"
        if self.conditions:
            text += f" for {', '.join(f'{c} != 0' for c in self.conditions)}"
        if self.adjoined:
            text += f", by a change of basis over {self.field_extension}"
        for values, other in self.exceptional_cases:
            equalities = [f"{' = '.join(names)} = {value}" for names, value in values]
            conditions = [f"{condition} != 0" for condition in other.conditions]
            text += f"; {', '.join(equalities + conditions)}: {other.name}"
        return text

    @property
    def exceptional_cases(self) -> list[tuple[EqualSymbols, Classification]]:
        """`exceptional` and the exceptional values of those in turn, each set of values once, fewer values first.

        Of each case, the values as (names of the symbols that have it, value), and the answer, which again is the
        generic one: it holds where none of its own conditions vanishes.
        """
        found: dict[EqualSymbols, Classification] = {}
        waiting: list[tuple[dict[str, Expr], Classification]] = [({}, self)]
        while waiting:
            values, here = waiting.pop(0)
            for name, value, other in here.exceptional:
                at: Any = {name: to_sympy(value)}
                now = {n: cast("Any", v).subs(at) for n, v in values.items()} | at
                if (key := _equal_symbols(now)) not in found:
                    found[key] = other
                    waiting.append((now, other))
        return list(found.items())


def _equal_symbols(values: Mapping[str, Expr]) -> EqualSymbols:
    """The values of symbols, those of equal ones together: s = t = 0."""
    names: dict[Expr, tuple[str, ...]] = {}
    for name in sorted(values):
        names[values[name]] = (*names.get(values[name], ()), name)
    return tuple((row, value) for value, row in names.items())


def classify(extension: Extension | Sequence[Sequence[Sequence[Parameter]]]) -> Classification:
    r"""Decompose an extension into local algebras and bring each to its normal form.

    Local algebras with residue field R are recognised up to dimension five, beyond that only $\mathbb R[x]/(x^n)$ and
    $m^2 = 0$; with residue field C, $\mathbb C[x]/(x^n)$.  Everything is exact, and the change of basis is verified.

    Args:
        extension: The extension, or its tensor `W[lam][mu][nu]`.  Entries may be rational or algebraic numbers, or
            rational functions of symbols; then the answer is the generic one, with its conditions.

    Raises:
        BracketError: the tensor is not that of a commutative associative algebra.
        ShapeError: not an extension and no tensor, either.
        ParameterError: there are more than 40 fields, or the answer depends on the sign of an expression in the
            symbols, or SymPy has no exact field that contains the entries.

    References: see `normal_forms`; a finite commutative algebra is the product of its localisations.
    """
    given = _read(extension)
    given = Extension.from_products(given.dimension, given.products, given.name, given.field_names)
    algebra = CommutativeAlgebra(given.dimension, given.products)
    is_unital = algebra.unit is not None
    whole = algebra if is_unital else _with_unit(given, algebra.field)
    factors = [factor for component in whole.components for factor in real_factors(component)]
    factors.sort(key=lambda f: (not is_unital and _has_outer_unit(f), -_dimension(f), _name(f)))
    normal_form = _total_form(factors, is_unital=is_unital)
    rows = _total_basis(factors, is_unital=is_unital)
    if normal_form is not None and rows is not None:
        _verify(algebra, normal_form, rows)
    field, conditions = algebra.field, algebra.field.conditions
    radicands = dict.fromkeys(
        d for f in factors for v in f.basis or () for c in v for d in sorted(c.radicands, key=str)
    )
    adjoined = tuple(_square_root(field, d) for d in radicands)
    return Classification(
        extension=given,
        is_unital=is_unital,
        factors=tuple(_written(factor) for factor in factors),
        normal_form=normal_form,
        change_of_basis=None if rows is None else tuple(tuple(c.write(field) for c in row) for row in rows),
        field_extension=_field_name(field, adjoined, factors),
        adjoined=adjoined,
        complex_name=_complex_name(factors, is_unital=is_unital),
        conditions=conditions,
        exceptional=_exceptional(given, conditions),
    )


def _read(extension: Extension | Sequence[Sequence[Sequence[Parameter]]]) -> Extension:
    given = extension if isinstance(extension, Extension) else Extension(extension)
    if given.dimension > MAX_FIELDS:
        raise ParameterError(
            f"an extension is classified for up to {MAX_FIELDS} fields; {given.name} has {given.dimension}. "
            "Classify its direct summands one by one."
        )
    return given


def _with_unit(extension: Extension, field: RealField) -> CommutativeAlgebra:
    """The unitisation: basis e_1, ..., e_n of A, then the unit."""
    n = extension.dimension
    one: Exact = Fraction(1)
    unit: Products = {(k, n): {k: one} for k in range(n + 1)}
    return CommutativeAlgebra(n + 1, extension.products | unit, field)


def _has_outer_unit(factor: RealFactor) -> bool:
    """Whether the unit of the factor is not an element of A, inside A + R 1."""
    return bool(factor.component.unit[-1])


def _dimension(factor: RealFactor) -> int:
    component = factor.component
    return sum(component.hilbert_function) * (1 if factor.residue_field == "R" else 2)


def _name(factor: RealFactor) -> str:
    return "" if factor.normal_form is None else factor.normal_form.name


def _total_form(factors: Sequence[RealFactor], *, is_unital: bool) -> Extension | None:
    forms = [factor.normal_form for factor in factors]
    if None in forms:
        return None
    known = [form for form in forms if form is not None]
    if not is_unital:
        known[-1] = maximal_ideal(known[-1])
    return reduce(add, known)


def _total_basis(factors: Sequence[RealFactor], *, is_unital: bool) -> list[SurdVector] | None:
    bases = [factor.basis for factor in factors]
    if None in bases:
        return None
    rows = [vector for basis in bases for vector in basis or ()]
    if is_unital:
        return rows
    outer = len(rows) - len(bases[-1] or ())  # the unit of the last factor is not in A; of the rest no vector leaves A
    return [row[:-1] for k, row in enumerate(rows) if k != outer]


def _verify(algebra: CommutativeAlgebra, form: Extension, rows: Sequence[SurdVector]) -> None:
    """Assert that the rows are independent and multiply as the normal form says."""
    n, field = algebra.dimension, algebra.field
    assert form.dimension == len(rows) == n
    for i in range(n):
        for j in range(i, n):
            product: Any = algebra.multiply(rows[i], rows[j])
            wanted = [Surd({})] * n
            for k, value in form.products.get((i, j), {}).items():
                wanted = [w + c * field.read(value) for w, c in zip(wanted, rows[k], strict=True)]
            assert not any(p - w for p, w in zip(product, wanted, strict=True)), f"e'_{i} e'_{j} in {form.name}"
    if n > _MOST_MINORS and not any(c.radicands for row in rows for c in row):
        entries = [[c.field_value() if c else field.zero for c in row] for row in rows]
        assert len(algebra.echelon(entries)) == n, f"independent vectors for {form.name}"
        return
    minor = determinant(rows, Surd({}))
    assert minor.norm(), f"independent vectors for {form.name}"
    field.rely_on(minor.norm())


def _written(factor: RealFactor) -> LocalFactor:
    component = factor.component
    field = component.algebra.field
    basis = factor.basis
    return LocalFactor(
        dimension=_dimension(factor),
        residue_field=factor.residue_field,
        hilbert_function=component.hilbert_function,
        socle_dimension=len(component.socle) // component.degree,
        signature=factor.signature,
        normal_form=factor.normal_form,
        basis=None if basis is None else tuple(tuple(c.write(field) for c in vector) for vector in basis),
    )


def _square_root(field: RealField, radicand: Any) -> Expr:
    from sympy import sqrt

    root: Any = sqrt(to_sympy(field.write(radicand)))
    return root


def _field_name(field: RealField, adjoined: Sequence[Expr], factors: Sequence[RealFactor]) -> str:
    names = [field.name[2:-1]] if field.name != "Q" else []
    names += [str(root) for root in adjoined]
    for component in dict.fromkeys(f.component for f in factors if f.component.degree > 2):
        terms = [to_sympy(field.write(c)) for c in component.polynomial]
        names.append(f"roots of {_polynomial(terms)}")
    return f"Q({', '.join(names)})" if names else "Q"


def _polynomial(coefficients: Sequence[Expr]) -> str:
    from sympy import Symbol

    x: Any = Symbol(free_name("x", {str(s) for c in coefficients for s in c.free_symbols}))
    total: Any = sum((c * x**k for k, c in enumerate(reversed(coefficients))), 0 * x)
    return str(total)


def _complex_name(factors: Sequence[RealFactor], *, is_unital: bool) -> str:
    names: list[str] = []
    for factor in factors:
        known = factor.normal_form is not None
        name = (
            complex_name(_name(factor)) if known else f"[local, Hilbert function {factor.component.hilbert_function}]"
        )
        names += [name] * (1 if factor.residue_field == "R" else 2)
    last = [] if is_unital else [f"maximal ideal of {names.pop()}"]
    return " + ".join([*sorted(names), *last])


def _exceptional(extension: Extension, conditions: Sequence[Expr]) -> tuple[tuple[str, Exact, Classification], ...]:
    found: list[tuple[str, Exact, Classification]] = []
    for condition in conditions:
        for symbol in sorted(condition.free_symbols, key=str):
            slope: Any = condition.diff(symbol)
            if slope.free_symbols:
                continue
            constant: Any = condition.subs(symbol, 0)
            value: Any = -constant / slope
            exact: Exact = Fraction(int(value.p), int(value.q)) if value.is_Rational else value
            try:
                found.append((str(symbol), exact, classify(extension.substitute({str(symbol): exact}))))
            except ParameterError:
                continue  # the entries are not defined there, or signs stay open
            break
    return tuple(found)
