r"""The normal form of one local factor: a basis in which its products are those of the list in `normal_forms`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from liepoisson.algebra.matrices import null_space
from liepoisson.algebra.quadratic_forms import (
    SurdCoordinates,
    diagonalise,
    equal_squares,
    hyperbolic_pair,
    hyperbolic_triple,
    restricted,
    signature,
)
from liepoisson.algebra.real_fields import Scalar, Surd
from liepoisson.structure.commutative_algebra import CommutativeAlgebra, Component, Vector
from liepoisson.structure.extension import Extension
from liepoisson.structure.normal_forms import (
    complex_truncated_polynomials,
    normal_form_named,
    null_square,
    truncated_polynomials,
)

SurdVector: TypeAlias = tuple[Surd, ...]
"""An element of the algebra whose coordinates may contain square roots."""


@dataclass(frozen=True)
class RealFactor:
    """A direct factor over the reals, with residue field R or C.

    Attributes:
        component: The component over the field of the entries that it is a part of.
        residue_field: "R" or "C".
        normal_form: Its normal form; None beyond the list.
        basis: The elements of the algebra that the basis of the normal form stands for; None if not written out.
        signature: Of the form that decides between the cases, if there is one.
    """

    component: Component
    residue_field: str
    normal_form: Extension | None
    basis: tuple[SurdVector, ...] | None
    signature: tuple[int, int] | None = None


def real_factors(component: Component) -> list[RealFactor]:
    """The local factors over the reals of one primary component.

    Raises:
        ParameterError: it depends on the sign of an expression in the symbols.
    """
    if component.degree == 1:
        return [_residue_field_r(component)]
    if component.degree == 2:
        return _quadratic(component)
    roots = component.algebra.field.real_roots(component.polynomial)
    hilbert = component.hilbert_function
    forms: dict[str, Extension] = {}
    if set(hilbert) == {1}:  # one generator over the residue field, and so over each of its completions
        forms = {"R": truncated_polynomials(len(hilbert)), "C": complex_truncated_polynomials(len(hilbert))}
    elif len(hilbert) == 2:
        forms = {"R": null_square(1 + hilbert[1])}
    places = ["R"] * roots + ["C"] * ((component.degree - roots) // 2)
    return [RealFactor(component, place, forms.get(place), None) for place in places]


def _residue_field_r(component: Component) -> RealFactor:
    cases: dict[tuple[int, ...], Callable[[Component], RealFactor]] = {(1, 2, 2): _one_relation, (1, 2, 1, 1): _chain}
    hilbert = component.hilbert_function
    if set(hilbert) == {1}:
        x = _generators(component)[0] if component.powers else component.unit
        basis = _powers(component.algebra, component.unit, x, len(hilbert))
        return RealFactor(component, "R", truncated_polynomials(len(hilbert)), _lift(basis))
    if len(hilbert) == 2:
        basis = [component.unit, *component.powers[0]]
        return RealFactor(component, "R", null_square(len(basis)), _lift(basis))
    if len(hilbert) == 3 and hilbert[2] == 1:
        return _one_form(component)
    return cases.get(hilbert, lambda c: RealFactor(c, "R", None, None))(component)


def _one_form(component: Component) -> RealFactor:
    r"""Hilbert function (1, d, 1): the products on $m/m^2$ are a quadratic form times one element t."""
    algebra, d = component.algebra, component.hilbert_function[1]
    field, generators, t = algebra.field, _generators(component), component.powers[1]
    form = [[algebra.coordinates(algebra.multiply(u, v), t)[0] for v in generators] for u in generators]
    kernel = null_space(field, form, d)
    units = [tuple(field.one if i == j else field.zero for j in range(d)) for i in range(d)]
    support = [list(v) for v in algebra.complement(kernel, units)]
    core = restricted(form, support)
    signs = signature(field, diagonalise(field, core))
    shapes: dict[tuple[int, int], tuple[Callable[..., Sequence[SurdCoordinates]], str]] = {
        (1, 0): (lambda _f, _q: [[Surd.of(field.one)]], "x^3"),
        (1, 1): (hyperbolic_pair, "xy"),
        (2, 0): (equal_squares, "x^2 + y^2"),
        (2, 1): (hyperbolic_triple, "xy + z^2"),
        (3, 0): (equal_squares, "x^2 + y^2 + z^2"),
    }
    name = _ONE_FORM_NAMES.get((d, signs))
    if name is None:
        return RealFactor(component, "R", None, None, signs)
    shaped = shapes[signs][0](field, core)
    vectors = [_combine(u, [_combine_scalars(s, generators) for s in support]) for u in shaped]
    null_vectors = _lift([_combine_scalars(k, generators) for k in kernel])
    last = _multiply(algebra, vectors[0], vectors[1] if signs[1] else vectors[0])
    basis = (*_lift([component.unit]), *vectors, *null_vectors, last)
    return RealFactor(component, "R", normal_form_named(name), basis, signs)


# By d and the signature: the names in `normal_forms`.
_ONE_FORM_NAMES = {
    (2, (1, 0)): "R[x,y]/(x^3, xy, y^2)",
    (2, (1, 1)): "R[x,y]/(x^2, y^2)",
    (2, (2, 0)): "R[x,y]/(x^2 - y^2, xy)",
    (3, (1, 0)): "R[x,y,z]/(x^3, xy, xz, y^2, yz, z^2)",
    (3, (1, 1)): "R[x,y,z]/(x^2, xz, y^2, yz, z^2)",
    (3, (2, 0)): "R[x,y,z]/(x^2 - y^2, xy, xz, yz, z^2)",
    (3, (2, 1)): "R[x,y,z]/(x^2, xy - z^2, xz, y^2, yz)",
    (3, (3, 0)): "R[x,y,z]/(x^2 - y^2, x^2 - z^2, xy, xz, yz)",
}


def _one_relation(component: Component) -> RealFactor:
    r"""Hilbert function (1, 2, 2): one relation $a u^2 + b w^2 = 0$ between the squares of two generators."""
    algebra, field = component.algebra, component.algebra.field
    u, w = _generators(component)
    square_u, mixed, square_w = algebra.multiply(u, u), algebra.multiply(u, w), algebra.multiply(w, w)
    ((p, q, r),) = null_space(field, list(zip(square_u, mixed, square_w, strict=True)), 3)
    half = q / field.number(2)
    relation = [[p, half], [half, r]]
    # The relation lives on the dual space: in the basis dual to orthogonal covectors it is a sum of squares.
    signs, (x, y) = _factored(component, relation, (u, w))
    name, last = {
        (1, 0): ("R[x,y]/(x^3, x^2 y, y^2)", (x, y)),
        (1, 1): ("R[x,y]/(x^3, xy, y^3)", (y, y)),
        (2, 0): ("R[x,y]/(x^3, x^2 y, x^2 + y^2)", (x, y)),
    }[signs]
    basis = (*_lift([component.unit]), x, y, _multiply(algebra, x, x), _multiply(algebra, *last))
    return RealFactor(component, "R", normal_form_named(name), basis, signs)


def _factored(
    component: Component, relation: Sequence[Sequence[Scalar]], generators: tuple[Vector, Vector]
) -> tuple[tuple[int, int], tuple[SurdVector, SurdVector]]:
    """The signature of p u^2 + 2 h u w + r w^2 = 0, and x, y with y^2 = 0, xy = 0 or x^2 + y^2 = 0 from it."""
    field = component.algebra.field
    (u, w), ((p, h), (_, r)) = generators, relation
    if not p and not r:
        return (1, 1), _pair(u, w)
    if not p:
        (u, w), (p, r) = (w, u), (r, p)
    field.rely_on(p)
    u = _combine_scalars((field.one, h / p), (u, w))  # p (u + h/p w)^2 + (r - h^2/p) w^2
    rest = r - h * h / p
    if not rest:
        return (1, 0), _pair(w, u)
    field.rely_on(rest)
    first, second = _pair(u, w)
    if field.sign(-(p * rest)) > 0:
        scaled = tuple(Surd.root(field, -(p * rest)) * (field.one / p) * c for c in second)
        return (1, 1), (_sum(first, scaled, -field.one), _sum(first, scaled, field.one))
    scaled = tuple(Surd.root(field, p * rest) * (field.one / p) * c for c in second)
    return (2, 0), (first, scaled)


def _chain(component: Component) -> RealFactor:
    r"""Hilbert function (1, 2, 1, 1): $x, x^2, x^3$ and y with $xy = 0$, $y^2 = b x^3$."""
    algebra, field = component.algebra, component.algebra.field
    generators, t = _generators(component), component.powers[2]
    cubes = [algebra.multiply(v, algebra.multiply(v, v)) for v in generators]
    x, y = generators if any(cubes[0]) else reversed(generators)
    square = algebra.multiply(x, x)
    (cube,) = algebra.coordinates(algebra.multiply(x, square), t)
    field.rely_on(cube)
    # First x^2 y = 0, by a multiple of x, then xy = 0, by a multiple of x^2.
    y = _combine_scalars((field.one, -(algebra.coordinates(algebra.multiply(square, y), t)[0] / cube)), (y, x))
    y = _combine_scalars((field.one, -(algebra.coordinates(algebra.multiply(x, y), t)[0] / cube)), (y, square))
    b = algebra.coordinates(algebra.multiply(y, y), t)[0] / cube
    name = "R[x,y]/(x^4, xy, y^2)"
    if b:
        field.rely_on(b)  # (b y)^2 = (b x)^3
        x, y, name = _scaled(b, x), _scaled(b, y), "R[x,y]/(x^3 - y^2, xy)"
    square = algebra.multiply(x, x)
    basis = [component.unit, x, y, square, algebra.multiply(x, square)]
    return RealFactor(component, "R", normal_form_named(name), _lift(basis))


def _quadratic(component: Component) -> list[RealFactor]:
    r"""Residue field $K(\sqrt D)$: C when D < 0, and two factors when D > 0."""
    algebra, field, D = component.algebra, component.algebra.field, component.discriminant
    sign = field.sign(D)
    chain = set(component.hilbert_function) == {1}
    length = len(component.hilbert_function)
    if not chain and (sign < 0 or length > 2):
        return [RealFactor(component, place, None, None) for place in ("RR" if sign > 0 else "C")]
    root = _root_of_discriminant(component)
    if not chain:
        return _two_null_squares(component, root)
    x = _generators(component)[0] if component.powers else component.unit
    powers = _lift(_powers(algebra, component.unit, x, length))
    if sign < 0:
        weight = Surd.root(field, -D) * (field.one / -D)
        i = tuple(weight * c for c in root)
        basis = tuple(v for power in powers for v in (power, _multiply(algebra, i, power)))
        return [RealFactor(component, "C", complex_truncated_polynomials(length), basis)]
    return [
        RealFactor(
            component, "R", truncated_polynomials(length), tuple(_multiply(algebra, unit, power) for power in powers)
        )
        for unit in _idempotents(component, root)
    ]


def _idempotents(component: Component, root: Vector) -> list[SurdVector]:
    """The units of the two factors of a component whose residue field has a real square root."""
    field, D = component.algebra.field, component.discriminant
    half = field.one / field.number(2)
    (unit,) = _lift([component.unit])
    weight = Surd.root(field, D) * (half / D)
    return [
        tuple(c * half + weight * orientation * r for c, r in zip(unit, root, strict=True))
        for orientation in (field.one, -field.one)
    ]


def _two_null_squares(component: Component, root: Vector) -> list[RealFactor]:
    """The two factors with m^2 = 0 of one component, from a basis of m over the residue field."""
    algebra, generators, span = component.algebra, list[Vector](), list[Vector]()
    for v in component.powers[0]:
        if algebra.complement(span, [v]):
            generators.append(v)
            span = algebra.echelon([*span, v, algebra.multiply(root, v)])
    form = null_square(1 + len(generators))
    return [
        RealFactor(component, "R", form, (unit, *(_multiply(algebra, unit, v) for v in _lift(generators))))
        for unit in _idempotents(component, root)
    ]


def _root_of_discriminant(component: Component) -> Vector:
    r"""An element $\xi$ with $\xi^2 = D$ exactly, by Newton's iteration from one that is a root modulo nilpotents."""
    algebra, field, D = component.algebra, component.algebra.field, component.discriminant
    half = field.one / field.number(2)
    xi = _combine_scalars((field.one, component.polynomial[1] * half), (component.generator, component.unit))
    while any(error := _combine_scalars((field.one, -D), (algebra.multiply(xi, xi), component.unit))):
        xi = _combine_scalars((field.one, -(half / D)), (xi, algebra.multiply(error, xi)))
    return xi


def _generators(component: Component) -> list[Vector]:
    """Elements of m that are a basis of m modulo m^2."""
    ideal, square = component.powers[0], [*component.powers, []][1]
    return component.algebra.complement(square, ideal)


def _powers(algebra: CommutativeAlgebra, unit: Vector, x: Vector, length: int) -> list[Vector]:
    powers = [unit]
    for _ in range(length - 1):
        powers.append(algebra.multiply(powers[-1], x))
    return powers


def _combine_scalars(coefficients: Sequence[Scalar], vectors: Sequence[Vector]) -> Vector:
    terms = [tuple(c * v for v in vector) for c, vector in zip(coefficients, vectors, strict=True)]
    return tuple(sum(column[1:], column[0]) for column in zip(*terms, strict=True))


def _combine(coefficients: Sequence[Surd], vectors: Sequence[Vector]) -> SurdVector:
    return tuple(
        sum((c * v for c, v in zip(coefficients, column, strict=True)), Surd({}))
        for column in zip(*vectors, strict=True)
    )


def _scaled(factor: Scalar, vector: Vector) -> Vector:
    return tuple(factor * c for c in vector)


def _sum(u: SurdVector, v: SurdVector, factor: Scalar) -> SurdVector:
    return tuple(a + b * factor for a, b in zip(u, v, strict=True))


def _pair(u: Vector, v: Vector) -> tuple[SurdVector, SurdVector]:
    first, second = _lift([u, v])
    return first, second


def _lift(vectors: Sequence[Vector]) -> tuple[SurdVector, ...]:
    return tuple(tuple(Surd.of(c) for c in vector) for vector in vectors)


def _multiply(algebra: CommutativeAlgebra, u: SurdVector, v: SurdVector) -> SurdVector:
    product: Any = algebra.multiply(u, v)
    return product
