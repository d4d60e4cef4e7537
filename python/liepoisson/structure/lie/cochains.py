r"""Cochains of a Lie algebra with values in a module, and the differential of Chevalley and Eilenberg.

A k-cochain is an alternating map of k elements of g to a module M,

$$(df)(x_0, \dots, x_k) = \sum_i (-1)^i x_i f(\dots \hat x_i \dots)
  + \sum_{i<j} (-1)^{i+j} f([x_i, x_j], \dots \hat x_i \dots \hat x_j \dots) .$$

On the basis $e^S \otimes v_a$, $S = \{s_1 < \dots < s_k\}$, this is $d(e^S \otimes v_a) = \sum_i e^i \wedge e^S \otimes
e_i v_a + de^S \otimes v_a$ with the derivation $de^l = -\sum_{i<j} c_{ij}^l\, e^i \wedge e^j$.

References: Chevalley and Eilenberg, Trans. Amer. Math. Soc. 63 (1948) 85; Fuks, Cohomology of Infinite-Dimensional Lie
Algebras (1986), section 1.3.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import gcd, lcm
from numbers import Integral
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.algebra.coefficients import Coefficients
from liepoisson.algebra.exact_numbers import Exact, ExactMatrix, is_zero, product_of, substituted, sum_of
from liepoisson.algebra.number_fields import Element
from liepoisson.errors import BracketError, CochainError, ParameterError, ShapeError, did_you_mean
from liepoisson.formula.parameters import read_parameter
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.given import is_named
from liepoisson.inputs.refusals import not_a, shown
from liepoisson.structure.lie_algebras import read_representation

if TYPE_CHECKING:
    from liepoisson.structure.lie_algebra import LieAlgebra

Indices: TypeAlias = tuple[int, ...]
"""The set S of $e^S$, increasing."""

Vector: TypeAlias = dict[tuple[Indices, int], Any]
"""A cochain by its nonzero components, at (S, a) that of $e^S \\otimes v_a$."""

NAMED = ("trivial", "adjoint", "coadjoint")
"""The modules that every algebra has."""


@dataclass(frozen=True)
class LieModule:
    r"""A module of a Lie algebra.

    Attributes:
        kind: "trivial", "adjoint", "coadjoint" or "representation".
        action: $e_i v_a = \sum_b$ `action[i][a][b]` $v_b$, the nonzero ones only.
        names: Names of the basis.
    """

    kind: str
    action: tuple[tuple[Mapping[int, Exact], ...], ...]
    names: tuple[str, ...]

    @property
    def dimension(self) -> int:
        """The number of basis elements."""
        return len(self.names)

    def substitute(self, values: Mapping[str, Exact]) -> LieModule:
        """The same module with values for some of its symbols."""
        action = tuple(tuple({b: substituted(c, values) for b, c in row.items()} for row in rho) for rho in self.action)
        return LieModule(self.kind, action, self.names)


def read_module(algebra: LieAlgebra, coefficients: object) -> LieModule:
    """The module that a caller names, or whose matrices are given.

    Raises:
        ParameterError: a text that names no module, or an entry is not exact.
        ShapeError: not one square matrix per basis element, all of one size.
        BracketError: the matrices are no representation.
    """
    n, own = algebra.dimension, labels(algebra.basis_names)
    if not isinstance(coefficients, str):
        columns = read_representation(algebra, cast("Sequence[object]", coefficients))
        names = tuple(f"v{a + 1}" for a in range(len(columns[0])))
        return LieModule("representation", tuple(tuple(rho) for rho in columns), names)
    if coefficients == "trivial":
        return LieModule("trivial", (({},),) * n, ("1",))
    if coefficients not in NAMED:
        hint = did_you_mean(coefficients, NAMED).strip() or "Or give one matrix per basis element."
        raise ParameterError(
            f'coefficients must be "trivial", "adjoint", "coadjoint" or matrices; got {coefficients!r:.60}. {hint}'
        )
    action: list[list[dict[int, Exact]]] = [[{} for _ in range(n)] for _ in range(n)]
    for (i, j), row in algebra.brackets.items():
        for k, c in row.items():
            if coefficients == "adjoint":
                action[i][j][k], action[j][i][k] = c, -c
            else:  # the dual of e_k goes to minus the dual of e_j
                action[i][k][j], action[j][k][i] = -c, c
    names = own if coefficients == "adjoint" else tuple(f"{name}*" for name in own)
    return LieModule(coefficients, tuple(tuple(rho) for rho in action), names)


def labels(names: Sequence[str]) -> tuple[str, ...]:
    """Names of basis elements in texts: e1, e2, ... for the numbers 1, 2, ..."""
    return tuple(f"e{name}" if name[:1].isdecimal() else name for name in names)


@explains_its_methods
@dataclass(frozen=True, eq=False)
class Cochain:
    r"""An alternating map of several elements of a Lie algebra to a module.

    Example:
        >>> mass = lp.algebras.cohomology(lp.algebras.galilei(2), 2).representatives[0]
        >>> print(mass)
        J^H

    Attributes:
        algebra: The Lie algebra.
        module: The module.
        degree: How many elements it takes.
        values: Its nonzero values $f(e_{s_1}, \dots, e_{s_k})$ by $(s_1 < \dots < s_k)$, counted from 0; each by its
            nonzero components in the basis of the module.
    """

    algebra: LieAlgebra
    module: LieModule
    degree: int
    values: Mapping[Indices, Mapping[int, Exact]]

    @property
    def form(self) -> dict[Indices, Exact]:
        """The values of one with trivial coefficients, as numbers: what `Bracket.with_constant` takes.

        Raises:
            ParameterError: the coefficients are not trivial.
        """
        if self.module.kind != "trivial":
            raise ParameterError(f"form: wanted trivial coefficients; got {self.module.kind} ones; take .values")
        return {place: row[0] for place, row in self.values.items()}

    @property
    def matrix(self) -> ExactMatrix:
        r"""A 1-cochain as the matrix of $e_i \mapsto \sum_a m_{ai} v_a$, shape (dim M, dim g).

        Raises:
            ParameterError: it takes another number of elements.
        """
        if self.degree != 1:
            raise ParameterError(f"matrix: wanted a cochain of degree 1; got one of degree {self.degree}; take .values")
        one = next((v for row in self.values.values() for v in row.values()), Fraction(0))
        zero = one - one  # of the same kind: Fractions and expressions do not mix
        rows = range(self.module.dimension)
        return tuple(tuple(self.values.get((i,), {}).get(a, zero) for i in range(self.algebra.dimension)) for a in rows)

    def __bool__(self) -> bool:
        return bool(self.values)

    def __str__(self) -> str:
        own, trivial = labels(self.algebra.basis_names), self.module.kind == "trivial"
        parts: list[str] = []
        for place, row in self.values.items():
            wedge = "^".join(own[s] for s in place)
            if trivial:
                parts.append(_term(row[0], wedge))
            else:
                value = _sum([_term(c, self.module.names[a]) for a, c in row.items()])
                parts.append(f"{wedge} -> {value}" if wedge else value)
        return (_sum(parts) if trivial else "; ".join(parts)) or "0"

    def __repr__(self) -> str:
        return str(self)


def _term(coefficient: Exact, name: str) -> str:
    if coefficient in (1, -1):
        return (name or "1") if coefficient == 1 else f"-{name or 1}"
    text = str(coefficient).replace("**", "^")
    text = f"({text})" if not isinstance(coefficient, Fraction) and coefficient.is_Add and name else text
    return f"{text}*{name}" if name else text


def _sum(terms: Sequence[str]) -> str:
    return " + ".join(terms).replace("+ -", "- ")


def read_cochain(algebra: LieAlgebra, module: LieModule, degree: int, given: object, name: str = "cocycle") -> Cochain:
    """The cochain that a caller gives: one, or its values by the names or the numbers of basis elements.

    Values are mappings from basis elements of the module to numbers; numbers with trivial coefficients.

    Raises:
        ParameterError: neither, or an entry is not exact.
        BracketError: an unknown basis element, or values given twice, or at the same element twice.
        ShapeError: not as many basis elements as the degree says, or the cochain is one of another algebra.
    """
    if isinstance(given, Cochain):
        if (given.algebra.brackets, given.degree, given.module.action) != (algebra.brackets, degree, module.action):
            raise ShapeError(
                f"{name}: wanted a {degree}-cochain of {algebra.name} with {module.kind} coefficients; got a "
                f"{given.degree}-cochain of {given.algebra.name} with {given.module.kind} ones"
            )
        return given
    if not is_named(given):
        raise not_a("a cochain, or a mapping from basis elements to values", given, name, _example(algebra, module))
    found: dict[Indices, dict[int, Exact]] = {}
    own = algebra.basis_names
    values = [own, module.names] if module.kind == "adjoint" else [module.names]
    for key, value in given.items():
        place = [_read_element(one, [own, labels(own)], name) for one in (key if isinstance(key, tuple) else (key,))]
        if len(place) != degree:
            raise ShapeError(f"{name}: wanted {degree} basis elements; got {shown(key)}; {_example(algebra, module)}")
        ordered = tuple(sorted(place))
        if ordered in found or len(set(ordered)) < degree:
            raise BracketError(
                f"{name}: wanted each set of different basis elements once; got {shown(key)} again or with an element "
                "twice; remove one entry"
            )
        sign = permutation_sign(place)
        row: Any = {0: value} if module.kind == "trivial" and not is_named(value) else value
        if not is_named(row):
            raise not_a("a mapping from basis elements to numbers", row, f"{name}[{shown(key)}]", 'write {"e3": 1}')
        components = {
            _read_element(b, values, name): read_parameter(v, f"{name}[{shown(key)}]") for b, v in row.items()
        }
        found[ordered] = {a: v if sign > 0 else -v for a, v in sorted(components.items()) if not is_zero(v)}
    return Cochain(algebra, module, degree, {place: row for place, row in sorted(found.items()) if row})


def _example(algebra: LieAlgebra, module: LieModule) -> str:
    first, second = algebra.basis_names[0], algebra.basis_names[-1]
    value = "1" if module.kind == "trivial" else f'{{"{module.names[0]}": 1}}'
    return f'write for example {{("{first}", "{second}"): {value}}}'


def _read_element(given: object, names: Sequence[tuple[str, ...]], what: str) -> int:
    """A number counted from 0, or one of the names: those of the algebra, and those in texts."""
    if not isinstance(given, bool) and isinstance(given, Integral) and 0 <= int(given) < len(names[0]):
        return int(given)
    for known in names:
        if str(given) in known:  # a text or a symbol
            return known.index(str(given))
    hint = did_you_mean(given, names[-1]).strip() or "Count from 0."
    raise BracketError(f"{what}: wanted basis elements {', '.join(names[-1][:20])}; got {given!r:.60}. {hint}")


def permutation_sign(order: Sequence[int]) -> int:
    """The sign of the permutation that sorts distinct numbers."""
    inversions = sum(a > b for k, a in enumerate(order) for b in order[k + 1 :])
    return -1 if inversions % 2 else 1


class Differential:
    r"""The differential on basis cochains, with constants in any ring.

    Args:
        algebra: The Lie algebra.
        module: The module.
        image: What stands for a structure constant or an entry of the module.
    """

    def __init__(self, algebra: LieAlgebra, module: LieModule, image: Callable[[Exact], Any]) -> None:
        self.n = algebra.dimension
        known: dict[Exact, Any] = {}

        def of(value: Exact) -> Any:
            if value not in known:
                known[value] = image(value)
            return known[value]

        self._of_basis: list[list[tuple[int, int, Any]]] = [[] for _ in range(self.n)]
        for (i, j), row in algebra.brackets.items():
            for l, c in row.items():
                self._of_basis[l].append((i, j, of(c)))
        self._action = [[[(b, of(c)) for b, c in row.items()] for row in rho] for rho in module.action]
        self._acts = any(row for rho in self._action for row in rho)
        self._of_set: dict[Indices, dict[Indices, Any]] = {}

    def __call__(self, place: Indices, a: int) -> Vector:
        """The image of one basis cochain; components may be zero where terms cancel."""
        found: Vector = {(larger, a): value for larger, value in self._exterior(place).items()}
        if not self._acts:
            return found
        for i in range(self.n):
            row = self._action[i][a]
            if not row or i in place:
                continue
            at = bisect_left(place, i)
            larger = (*place[:at], i, *place[at:])
            for b, value in row:
                term = -value if at % 2 else value
                key = larger, b
                found[key] = found[key] + term if key in found else term
        return found

    def _exterior(self, place: Indices) -> dict[Indices, Any]:
        """The image of $e^S$ in the exterior algebra."""
        if place in self._of_set:
            return self._of_set[place]
        found: dict[Indices, Any] = {}
        for position, l in enumerate(place):
            rest = (*place[:position], *place[position + 1 :])
            for i, j, c in self._of_basis[l]:
                if i in rest or j in rest:
                    continue
                first, second = bisect_left(rest, i), bisect_left(rest, j)
                larger = (*rest[:first], i, *rest[first:second], j, *rest[second:])
                term = c if (position + first + second) % 2 else -c
                found[larger] = found[larger] + term if larger in found else term
        self._of_set[place] = found
        return found


def field_of(algebra: LieAlgebra, module: LieModule, values: Iterable[Exact] = ()) -> Coefficients:
    """The field of the structure constants, the module and further values."""
    own = [c for row in algebra.brackets.values() for c in row.values()]
    return Coefficients.containing([*own, *(c for rho in module.action for row in rho for c in row.values()), *values])


def image_of(cochain: Cochain) -> tuple[Vector, Coefficients]:
    """The differential of a cochain in the field that all numbers generate, without its scale."""
    values = [v for row in cochain.values.values() for v in row.values()]
    field = field_of(cochain.algebra, cochain.module, values)
    d, total = Differential(cochain.algebra, cochain.module, field.read), cast("Vector", {})
    for place, row in cochain.values.items():
        for a, value in row.items():
            add_multiple(total, d(place, a), field.read(value))
    return {key: value for key, value in sorted(total.items()) if not field.vanishes(value)}, field


def add_multiple(target: Vector, vector: Mapping[Any, Element], factor: Element) -> None:
    """Add a multiple of a vector to the target, in place."""
    for key, value in vector.items():
        target[key] = target[key] + factor * value if key in target else factor * value


def check_closed(cochain: Cochain) -> None:
    """Refuse a cochain that is no cocycle.

    Raises:
        CochainError: it is none; the error names the basis elements.
    """
    image, field = image_of(cochain)
    if not image:
        return
    (place, a), value = next(iter(image.items()))
    own = labels(cochain.algebra.basis_names)
    along = "" if cochain.module.kind == "trivial" else f" along {cochain.module.names[a]}"
    residual = f"{str(field.write(value, 2)).replace('**', '^')}{along}"
    raise CochainError(tuple(own[s] for s in place), residual, f"{cochain.degree}-cochain of {cochain.algebra.name}")


def integral(vector: Vector) -> Vector:
    """The multiple of a rational vector with coprime integers, the first of them positive."""
    scale = _coprime([vector[key] for key in sorted(vector)])
    return {key: value * scale for key, value in vector.items()}


def _coprime(values: Sequence[Any]) -> Fraction:
    """What makes rational numbers coprime integers, the first of them positive."""
    scale = Fraction(lcm(*(int(v.denominator) for v in values)), gcd(*(int(v.numerator) for v in values)) or 1)
    return -scale if values and values[0] < 0 else scale


def polynomial(vector: Vector) -> Vector:
    """The multiple of a vector of rational functions with coprime polynomials, which has no poles."""
    values = [vector[key] for key in sorted(vector)]
    common = reduce(lambda a, b: a.lcm(b), (v.denom for v in values))
    content = reduce(lambda a, b: a.gcd(b), (v.numer * common.exquo(v.denom) for v in values))
    factor = values[0].field(common) / values[0].field(content)
    scaled = [(v * factor).numer for v in values]
    if common.ring.domain.is_QQ:
        number = _coprime([c for numerator in scaled for c in numerator.coeffs()])
        factor = factor * common.ring.domain(number.numerator, number.denominator)
    return {key: value * factor for key, value in vector.items()}


def cochain_of(algebra: LieAlgebra, module: LieModule, degree: int, vector: Vector, field: Coefficients) -> Cochain:
    """The cochain with these components, elements of a field."""
    values: dict[Indices, dict[int, Exact]] = {}
    for (place, a), value in sorted(vector.items()):
        if not field.vanishes(value):
            values.setdefault(place, {})[a] = field.write(value)
    return Cochain(algebra, module, degree, values)


def combination(terms: Sequence[tuple[Exact, Cochain]], like: Cochain) -> Cochain:
    """A sum of multiples of cochains; `like` says which kind."""
    total: dict[Indices, dict[int, Exact]] = {}
    for factor, cochain in terms:
        for place, row in cochain.values.items():
            into = total.setdefault(place, {})
            for a, value in row.items():
                term = product_of(factor, value)
                into[a] = sum_of(into[a], term) if a in into else term
    kept = {place: {a: v for a, v in sorted(row.items()) if not is_zero(v)} for place, row in sorted(total.items())}
    return Cochain(like.algebra, like.module, like.degree, {place: row for place, row in kept.items() if row})
