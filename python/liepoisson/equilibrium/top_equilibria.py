r"""All equilibria of a top on a leaf, proved to be all, by algebra over the rational numbers.

Parameters and values of Casimirs are rational numbers (doubles are), and so every question below, how many real roots
a polynomial has and which numbers are zero, has an exact answer. Which systems are tops is said in
`liepoisson.equilibrium.heavy_equilibria`. By the leaf:

- $\beta\ne0$, $\epsilon\ne0$ (twisted): see `liepoisson.equilibrium.twisted_equilibria`.
- $\alpha\times\beta\ne0$, $\epsilon=0$ (charged): $\alpha$ and $\beta$ turn as one rigid body, $\alpha=R\alpha_0$,
  $\beta=R\beta_0$, and an equilibrium has $\ell=0$ and $\alpha\times a+\beta\times b=0$: with
  $B = a\alpha_0^T+b\beta_0^T$ the matrix $RB^T$ is symmetric, so it is a square root of $BB^T$. If
  $B$ has singular values $s_1>s_2>0$ there are four; if $s_1=s_2>0$ two and a circle; if $s_1>s_2=0$ two circles; if
  $B=0$ all rotations. The squares $s_1^2, s_2^2$ are the eigenvalues of the product of the Gram matrices of $(a,b)$ and
  $(\alpha_0,\beta_0)$, whose trace and determinant are rational.
- one field n left (six components, or $\beta=0$, or $\epsilon=0$ and $\alpha = pn$, $\beta = qn$): a heavy top with
  $A = a$ or $pa+qb$, see `liepoisson.equilibrium.heavy_equilibria`.
- $\alpha=\beta=0$: a free rigid body on a sphere, $\ell$ an eigenvector of $I$.

Units do not matter: the twisted problem is first brought to numbers of order one by powers of two. With
$I = i\hat I$, $\beta = B\hat\beta$, $a = p\hat a$, $\omega = k\hat\omega$ the equations stay what they are if
$\ell = ik\hat\ell$, $\alpha = (ik^2/p)\hat\alpha$, $b = (ik^2/B)\hat b$, $\epsilon = (ik^3/Bp^2)\hat\epsilon$.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from flint import arb, fmpq

from liepoisson.algebra.ideals.certified_roots import PRECISIONS, UndecidedError, ball, precision, rational
from liepoisson.equilibrium.heavy_equilibria import (
    BY_COUNT,
    CIRCLE,
    POINT,
    ROTATIONS,
    Critical,
    ExactTop,
    dot,
    groups_of,
    heavy_equilibria,
)
from liepoisson.equilibrium.twisted_equilibria import NotProvedError, TwistedEquilibria
from liepoisson.equilibrium.twisted_singular import TwistedLeaf
from liepoisson.inputs.arrays import Array
from liepoisson.portable import linear

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.leaf.leaf import Leaf


@dataclass(frozen=True)
class FoundByAlgebra:
    """A connected set of equilibria: one state of it, rounded to doubles, shape (N,), and what the set is."""

    state: Array
    kind: str


def equilibria_of_top(leaf: Leaf, top: ExactTop) -> tuple[list[FoundByAlgebra], bool]:
    """The equilibria of the top on the leaf, and whether the algebra proves that these are all.

    It does not where one is degenerate and isolated (two are about to meet), and where the equations have a factor in
    common that is not expected. Then the list has what was decided, and candidates, which need not be equilibria.

    Args:
        leaf: A leaf of a system with the equations and the bracket of the top, of any rank above 0. N = 9, or 6 or 3
            where the system is without beta, or without alpha and beta.
        top: Its parameters.
    """
    try:
        search = _search(leaf, top)
    except NotProvedError:
        return [], False
    n = len(leaf.state)

    def at(bits: int, *, is_all: bool) -> list[FoundByAlgebra]:
        with precision(bits):
            return [FoundByAlgebra(one.state[:n], one.kind) for one in search(is_all)]

    for bits in PRECISIONS:
        try:
            return at(bits, is_all=True), True
        except UndecidedError:
            continue
    return [one for one in at(PRECISIONS[-1], is_all=False) if np.isfinite(one.state).all()], False


Search: TypeAlias = Callable[[bool], list[FoundByAlgebra]]
"""All equilibria at the present precision; if they need not be all (False), those that are decided, and candidates."""


def _search(leaf: Leaf, top: ExactTop) -> Search:
    """The search on this leaf, to be called at one precision after the other; its states have nine components."""
    if leaf.rank == 2:
        square = value_on(leaf, _product(leaf, 0, 0))
        return lambda is_all: _decided(is_all, lambda: _sphere(top, square))
    if leaf.rank == 4 and (len(leaf.state) == 6 or top.epsilon != 0):
        size, momentum = value_on(leaf, _product(leaf, 1, 1)), value_on(leaf, _product(leaf, 0, 1))
        return lambda is_all: _decided(is_all, lambda: _heavy(top, (fmpq(1), fmpq(0)), size, momentum))
    if leaf.rank == 4:
        l, alpha, beta = ([rational(x) for x in v] for v in leaf.state.reshape(3, 3).tolist())
        share = _shares(leaf.state)
        total = share[0] ** 2 + share[1] ** 2
        n = [(share[0] * x + share[1] * y) / total for x, y in zip(alpha, beta, strict=True)]
        return lambda is_all: _decided(is_all, lambda: _heavy(top, share, fmpq(1), dot(l, n)))
    values = casimir_values(leaf, top)
    if top.epsilon == 0:
        return lambda _: _charged(leaf, top, values)
    return _twisted(top, values)


def _decided(is_all: bool, found: Callable[[], list[Critical]]) -> list[FoundByAlgebra]:
    """All of them, or none if they are not decided and need not be all."""
    try:
        return [FoundByAlgebra(_doubles(critical.state), critical.kind) for critical in found()]
    except UndecidedError:
        if is_all:
            raise
        return []


def _doubles(state: list[arb]) -> Array:
    return np.array([float(x.mid()) for x in state])


def casimir_values(leaf: Leaf, top: ExactTop) -> tuple[fmpq, fmpq, fmpq]:
    r"""The values of $|\alpha|^2+2\epsilon\,\ell\cdot\beta$, $\alpha\cdot\beta$, $|\beta|^2$ on a regular leaf."""
    from sympy import Rational

    twice = 2 * Rational(int(top.epsilon.p), int(top.epsilon.q))
    first = _product(leaf, 1, 1) + twice * _product(leaf, 0, 2)
    return value_on(leaf, first), value_on(leaf, _product(leaf, 1, 2)), value_on(leaf, _product(leaf, 2, 2))


def value_on(leaf: Leaf, formula: Any) -> fmpq:
    """The value of a polynomial that is constant on the leaf.

    The one that the leaf was made from, if one of its Casimirs is a multiple of the polynomial; else that of its state.
    """
    from sympy import Poly, PolynomialError

    x = leaf.system.variables
    wanted = Poly(formula, *x)
    for name, function in leaf.casimir_functions.items():
        try:
            given: Any = Poly(function.expression, *x)
        except PolynomialError:
            continue
        factor = given.LC() / wanted.LC()
        if factor.is_Rational and factor != 0 and given == factor * wanted:
            return rational(leaf.casimirs[name]) * fmpq(int(factor.q), int(factor.p))
    value: Any = formula.subs({v: _as_sympy(c) for v, c in zip(x, leaf.state.tolist(), strict=True)})
    return fmpq(int(value.p), int(value.q))


def _product(leaf: Leaf, i: int, j: int) -> Any:
    """The scalar product of two fields, counted from 0: l, alpha, beta."""
    x = leaf.system.variables
    return sum(x[3 * i + k] * x[3 * j + k] for k in range(3))


def _as_sympy(value: float) -> Expr:
    from sympy import Rational

    return Rational(*value.as_integer_ratio())


# One leaf after the other


def _sphere(top: ExactTop, square: fmpq) -> list[Critical]:
    """The steady rotations of a free rigid body with l.l = square."""
    length = ball(square).sqrt()
    found: list[Critical] = []
    for group in groups_of(top.inertia):
        for sign in (1, -1) if len(group) == 1 else (1,):
            l = [sign * length if k == group[0] else arb(0) for k in range(3)]
            found.append(Critical([*l, *[arb(0)] * 6], BY_COUNT[len(group) - 1]))
    return found


def _heavy(top: ExactTop, share: tuple[fmpq, fmpq], size: fmpq, momentum: fmpq) -> list[Critical]:
    """Those with alpha = p n, beta = q n, where the share is (p, q)."""
    field = [share[0] * x + share[1] * y for x, y in zip(top.a, top.b, strict=True)]
    found: list[Critical] = []
    for n, speed, kind in heavy_equilibria(top.inertia, field, size, momentum):
        l = [speed * ball(moment) * x for moment, x in zip(top.inertia, n, strict=True)]
        found.append(Critical(l + [ball(p) * x for p in share for x in n], kind))
    return found


def _shares(state: Array) -> tuple[fmpq, fmpq]:
    """The doubles p and q of alpha = p n, beta = q n with |n| = 1, for parallel alpha and beta."""
    _, alpha, beta = state.reshape(3, 3)
    longest = alpha if linear.norm(alpha) >= linear.norm(beta) else beta
    n = longest / linear.norm(longest)
    return rational(float(linear.matmul(alpha, n))), rational(float(linear.matmul(beta, n)))


def _twisted(top: ExactTop, values: tuple[fmpq, fmpq, fmpq]) -> Search:
    c1, c2, c3 = values
    i, big = _power_of_two(top.inertia[1]), _power_of_two(c3, root=2)
    p = _power_of_two(max((abs(x) for x in top.a), default=fmpq(0)))
    k = _power_of_two(abs(top.epsilon) * big * p**2 / i, root=3)
    to_alpha, to_b = i * k**2 / p, i * k**2 / big
    scaled = TwistedLeaf(
        [x / i for x in top.inertia],
        [x / p for x in top.a],
        [x / to_b for x in top.b],
        top.epsilon * big * p**2 / (i * k**3),
        c1 / to_alpha**2,
        c2 / (to_alpha * big),
        c3 / big**2,
    )
    search = TwistedEquilibria(scaled)
    units = [i * k] * 3 + [to_alpha] * 3 + [big] * 3

    def found(is_all: bool) -> list[FoundByAlgebra]:
        return [
            FoundByAlgebra(_doubles([x * ball(unit) for x, unit in zip(c.state, units, strict=True)]), c.kind)
            for c in (search.all() if is_all else search.some())
        ]

    return found


def _power_of_two(value: fmpq, root: int = 1) -> fmpq:
    """The power of two next to the root of a positive number; 1 for zero."""
    if value == 0:
        return fmpq(1)
    exponent = round((int(value.p).bit_length() - int(value.q).bit_length()) / root)
    return fmpq(2) ** exponent


def _charged(leaf: Leaf, top: ExactTop, values: tuple[fmpq, fmpq, fmpq]) -> list[FoundByAlgebra]:
    c1, c2, c3 = values
    aa, ab, bb = dot(top.a, top.a), dot(top.a, top.b), dot(top.b, top.b)
    trace = aa * c1 + 2 * ab * c2 + bb * c3
    determinant = (aa * bb - ab**2) * (c1 * c3 - c2**2)
    _, alpha, beta = leaf.state.reshape(3, 3)
    a, b = (np.array([float(Fraction(int(x.p), int(x.q))) for x in v]) for v in (top.a, top.b))
    left, _, right = linear.svd(np.outer(a, alpha) + np.outer(b, beta))
    if trace == 0:
        signs = {(1, 1): ROTATIONS}
    elif determinant == 0:
        signs = {(1, 1): CIRCLE, (-1, 1): CIRCLE}
    elif trace**2 == 4 * determinant:
        signs = {(1, 1): POINT, (-1, -1): POINT, (1, -1): CIRCLE}
    else:
        signs = {(first, second): POINT for first in (1, -1) for second in (1, -1)}
    found: list[FoundByAlgebra] = []
    for (first, second), kind in signs.items():
        third = first * second * round(float(linear.det(left) * linear.det(right)))
        turn = linear.matmul(linear.matmul(left, np.diag([first, second, third])), right)
        found.append(
            FoundByAlgebra(np.concatenate([np.zeros(3), linear.matmul(turn, alpha), linear.matmul(turn, beta)]), kind)
        )
    return found


def natural_units(leaf: Leaf, top: ExactTop, found: list[FoundByAlgebra]) -> Array:
    """The sizes of l, alpha and beta on the leaf, shape (N,), in which the second variation is of order one.

    Those of its equilibria; where l is zero at all of them, the momentum whose kinetic energy is that of the fields.
    """
    inertia, a, b = ([float(Fraction(int(x.p), int(x.q))) for x in v] for v in (top.inertia, top.a, top.b))
    n = len(leaf.state)
    # The state of the leaf is one of many, and that of a leaf by values of Casimirs of a size that means nothing.
    known = [one.state for one in found] or [leaf.state]
    states = np.zeros((len(known), 9))
    states[:, :n] = known
    l, alpha, beta = linear.norm(states.reshape(-1, 3, 3), axis=2).max(axis=0)
    moment = float(np.median(np.abs(inertia)))
    l = max(float(l), np.sqrt(moment * (linear.norm(a) * alpha + linear.norm(b) * beta)))
    whole = max(l, float(alpha), float(beta)) or 1.0
    return np.repeat([size if size > 0 else whole for size in (l, alpha, beta)], 3)[:n]


def euler_characteristic_of_leaf(leaf: Leaf, top: ExactTop) -> int | None:
    r"""2 for $S^2\times R^4$ (twisted), for a leaf like $T^*S^2$ (one field) and for a sphere; 0 for $SO(3)\times R^3$.

    H is proper on each if the kinetic energy is definite: on a twisted leaf $|\alpha|^2$ grows like $|\ell|$ only, on
    the others alpha and beta are bounded. If it is not, only the sphere has one: None.
    """
    if leaf.rank > 2 and not top.is_definite:
        return None
    return 0 if leaf.rank == 6 and top.epsilon == 0 else 2
