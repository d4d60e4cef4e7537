r"""Equilibria of a twisted top on the branches where $I+\sigma$ is singular, at rest, and for a = 0.

The notation is that of `liepoisson.equilibrium.twisted_equilibria`, of which these are the special cases.

**Singular** $\sigma=-J$ with $(b-\tau a)_K=0$ on the set K of indices with $I_k=J$: there $\gamma_K$ is free.

- $a_K\ne0$: $\tau$ is known, $\gamma_K = g\,a_K + h$ with $h\perp a_K$, $g$ from $E_2$, $|h|^2$ from $E_3$, and
  $2\epsilon\big(\sum_{j\notin K}(I_j-J)\gamma_j^2 + Jc_3\kappa^4\big) + \epsilon^2|a|^2\kappa - G\kappa^3 = 0$.
  A simple moment has no h: $|h|^2=0$ is a second equation.
- $a_K=b_K=0$: $E_2$ is linear in $\tau$, $\tau = T/D$ with $T = \epsilon B - c_2\kappa^3$,
  $D = \epsilon A_0 + c_3\kappa^3$, $A_0 = \sum a_j^2/(I_j-J)$, $B = \sum a_jb_j/(I_j-J)$,
  $B_2=\sum b_j^2/(I_j-J)$; then
  $2\epsilon(B_2 - 2\tau B + \tau^2A_0 + Jc_3\kappa^4) + \epsilon^2|a|^2\kappa - G\kappa^3=0$ is an equation for
  $\kappa$ of degree 10, and $|\gamma_K|^2 = c_3\kappa^4-\sum_{j\notin K}\gamma_j^2 > 0$ (where it is zero, the state
  is a regular one). If T and D are proportional ($c_3B = -c_2A_0$), then $\tau=-c_2/c_3$, or $D = 0$ and $\tau$
  follows from $E_1$.

**Without rotation** $\kappa=0$: $\ell=0$ and $\beta=t\,a$, $\alpha = t\,b+s\,a$, on the leaves on which these have the
right lengths.

**a = 0**: $\alpha = (c_2/c_3)\beta$ and a heavy top in the field b for $\kappa\ne0$; for $\kappa=0$ circles of
$\alpha$ around $\beta=\pm\sqrt{c_3}\,b/|b|$.

`TwistedLeaf` is the problem of equilibria on a leaf of a twisted top as rational numbers, for both modules.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, fmpq, fmpq_poly

from liepoisson.algebra.ideals.certified_roots import (
    ball,
    evaluate,
    is_positive,
    positive_roots_of,
    real_roots,
    without,
)
from liepoisson.equilibrium.heavy_equilibria import (
    BY_COUNT,
    CIRCLE,
    POINT,
    ROTATIONS,
    Critical,
    Vector,
    dot,
    groups_of,
    heavy_equilibria,
    is_zero,
    placed,
)


@dataclass(frozen=True)
class TwistedLeaf:
    """The rational numbers of the problem: parameters of the top and values c1, c2, c3 of the Casimirs; c3 > 0."""

    inertia: Vector
    a: Vector
    b: Vector
    epsilon: fmpq
    c1: fmpq
    c2: fmpq
    c3: fmpq

    @property
    def active(self) -> list[tuple[int, ...]]:
        """The sets of equal moments on which a or b does not vanish."""
        return [group for group in groups_of(self.inertia) if not (is_zero(self.a, group) and is_zero(self.b, group))]

    @property
    def aa(self) -> fmpq:
        """The square of |a|."""
        return dot(self.a, self.a)

    @property
    def determinant(self) -> fmpq:
        """c1 c3 - c2^2."""
        return self.c1 * self.c3 - self.c2**2


def state_of(leaf: TwistedLeaf, tau: arb, kappa: arb, gamma: Sequence[arb], kind: str = POINT) -> Critical:
    r"""The state with $\kappa^2\beta = \gamma$, for $\kappa\ne0$."""
    beta = [x / (kappa * kappa) for x in gamma]
    alpha = [ball(leaf.epsilon * x) / kappa - tau * y for x, y in zip(leaf.a, beta, strict=True)]
    l = [kappa * ball(x) * y for x, y in zip(leaf.inertia, beta, strict=True)]
    return Critical([*l, *alpha, *beta], kind)


def ratio_of(b: Vector, a: Vector, at: Sequence[int] = (0, 1, 2)) -> fmpq | None:
    """The number t with b = t a on these indices, where a does not vanish; None if they are not parallel."""
    t = dot(a, b, at) / dot(a, a, at)
    return t if all(b[k] == t * a[k] for k in at) else None


def across(a: Vector, group: tuple[int, ...]) -> list[fmpq]:
    """A vector on these indices that is orthogonal to a there."""
    first = next(k for k in group if a[k] != 0)
    other = next(k for k in group if k != first)
    return [a[other] if k == first else -a[first] if k == other else fmpq(0) for k in range(3)]


def singular_with_mass(leaf: TwistedLeaf, group: tuple[int, ...]) -> list[Critical]:
    r"""Those with $\sigma=-J$, the moment of a group on which a does not vanish."""
    tau = ratio_of(leaf.b, leaf.a, group)
    if tau is None:
        return []
    moment, rest = leaf.inertia[group[0]], [k for k in range(3) if k not in group]
    own = dot(leaf.a, leaf.a, group)
    gamma = {k: (leaf.b[k] - tau * leaf.a[k]) / (leaf.inertia[k] - moment) for k in rest}
    bare = sum((leaf.a[k] * x for k, x in gamma.items()), fmpq(0))
    slope, big = leaf.c2 + leaf.c3 * tau, leaf.c1 + 2 * leaf.c2 * tau + leaf.c3 * tau**2
    factor = fmpq_poly([-bare / own, 0, 0, slope / (leaf.epsilon * own)])
    length = leaf.c3 * fmpq_poly([0, 0, 0, 0, 1]) - sum((x * x for x in gamma.values()), fmpq(0)) - own * factor**2
    rest_of_m = sum(((leaf.inertia[k] - moment) * x * x for k, x in gamma.items()), fmpq(0))
    equation = fmpq_poly(
        [2 * leaf.epsilon * rest_of_m, leaf.epsilon**2 * leaf.aa, 0, -big, 2 * leaf.epsilon * moment * leaf.c3]
    )
    found: list[Critical] = []
    common = equation.gcd(length)
    on_axis = [(root, None) for root in real_roots(common)]
    free = [(root, evaluate(length, root)) for root in positive_roots_of(equation, length)] if len(group) > 1 else []
    for kappa, square in [*on_axis, *free]:
        if kappa.is_zero():
            continue
        g = evaluate(factor, kappa)
        vector = [ball(gamma[k]) if k in gamma else g * ball(leaf.a[k]) for k in range(3)]
        if square is None:
            found.append(state_of(leaf, ball(tau), kappa, vector))
            continue
        aside = across(leaf.a, group)
        size = (square / ball(dot(aside, aside))).sqrt()
        kind = BY_COUNT[len(group) - 2]
        for sign in (1, -1) if kind == POINT else (1,):
            moved = [x + sign * size * ball(y) for x, y in zip(vector, aside, strict=True)]
            found.append(state_of(leaf, ball(tau), kappa, moved, kind))
    return found


def singular_without_mass(leaf: TwistedLeaf, group: tuple[int, ...]) -> list[Critical]:
    r"""Those with $\sigma=-J$, the moment of a group on which a and b vanish."""
    moment, rest = leaf.inertia[group[0]], [k for k in range(3) if k not in group]
    inverse = [1 / (leaf.inertia[k] - moment) if k in rest else fmpq(0) for k in range(3)]

    def product(u: Vector, v: Vector) -> fmpq:
        return dot([x * y for x, y in zip(u, v, strict=True)], inverse)

    aa, ab, bb = product(leaf.a, leaf.a), product(leaf.a, leaf.b), product(leaf.b, leaf.b)
    kappa = fmpq_poly([0, 1])
    cube = kappa**3
    d, t = fmpq_poly([leaf.epsilon * aa]) + leaf.c3 * cube, fmpq_poly([leaf.epsilon * ab]) - leaf.c2 * cube
    found: list[Critical] = []
    if leaf.c3 * ab == -leaf.c2 * aa:
        found += _any_slope(leaf, group, inverse, aa, bb)
        d, t = fmpq_poly([1]), fmpq_poly([-leaf.c2 / leaf.c3])
    quadratic = bb * d**2 - 2 * ab * t * d + aa * t**2 + moment * leaf.c3 * cube * kappa * d**2
    casimir = leaf.c1 * d**2 + 2 * leaf.c2 * t * d + leaf.c3 * t**2
    equation = 2 * leaf.epsilon * quadratic + leaf.epsilon**2 * leaf.aa * kappa * d**2 - casimir * cube
    length = leaf.c3 * cube * kappa * d**2
    for k in rest:
        length -= inverse[k] ** 2 * (leaf.b[k] * d - leaf.a[k] * t) ** 2
    for root in positive_roots_of(without(equation, kappa), length):
        tau = evaluate(t, root) / evaluate(d, root)
        found += _tilted(leaf, group, inverse, tau, root)
    return found


def _any_slope(leaf: TwistedLeaf, group: tuple[int, ...], inverse: Vector, aa: fmpq, bb: fmpq) -> list[Critical]:
    r"""The solutions with D = 0 where E2 holds for every tau: $3\epsilon A_0(\tau-\tau_0)^2 + \ldots = 0$.

    Here $\kappa$ is a cube root of a rational number, and what can be zero is a polynomial in it: decided exactly. A
    double solution $\tau = \tau_0$ adds nothing, for it solves the equation with $\tau=-c_2/c_3$ as well.
    """
    if aa == 0:
        return []
    moment, centre, kappa = leaf.inertia[group[0]], -leaf.c2 / leaf.c3, fmpq_poly([0, 1])
    zero = fmpq_poly([leaf.epsilon * aa, 0, 0, leaf.c3])
    still = leaf.epsilon * (2 * bb + leaf.c1 * aa / leaf.c3 - 3 * aa * centre**2)
    square = -(still + leaf.epsilon**2 * (leaf.aa - 2 * moment * aa) * kappa) / (3 * leaf.epsilon * aa)
    (root,) = real_roots(zero)
    if _vanishes(square, zero) or not is_positive(evaluate(square, root)):
        return []
    # the length of the free part is even + odd * (tau - centre)
    at_centre = [(b - centre * a) * x for a, b, x in zip(leaf.a, leaf.b, inverse, strict=True)]
    slopes = [a * x for a, x in zip(leaf.a, inverse, strict=True)]
    even = leaf.c3 * kappa**4 - dot(at_centre, at_centre) - dot(slopes, slopes) * square
    odd = 2 * dot(at_centre, slopes)
    is_zero_once = _vanishes(even**2 - odd**2 * square, zero)
    found: list[Critical] = []
    for sign in (1, -1):
        if is_zero_once and (odd == 0 or not is_positive(sign * ball(odd) * evaluate(even, root))):
            continue
        tau = ball(centre) + sign * evaluate(square, root).sqrt()
        found += _tilted(leaf, group, inverse, tau, root, is_checked=False)
    return found


def _vanishes(polynomial: fmpq_poly, zero: fmpq_poly) -> bool:
    r"""Whether a polynomial vanishes at the only real root of another one, $p + q\kappa^3$."""
    # of its factors over the rationals the one with the real root has real coefficients and no other real root
    common = zero.gcd(polynomial)
    return common.degree() % 2 == 1


def _tilted(
    leaf: TwistedLeaf, group: tuple[int, ...], inverse: Vector, tau: arb, kappa: arb, *, is_checked: bool = True
) -> list[Critical]:
    """The states with a free part of gamma on the group, if its length is positive."""
    gamma = [(ball(leaf.b[k]) - tau * ball(leaf.a[k])) * ball(inverse[k]) for k in range(3)]
    square = ball(leaf.c3) * kappa * kappa * kappa * kappa - sum((x * x for x in gamma), arb(0))
    if not is_checked and not is_positive(square):
        return []
    kind = BY_COUNT[len(group) - 1]
    return [state_of(leaf, tau, kappa, vector, k) for vector, k in placed(gamma, group, square.sqrt(), kind)]


def at_rest(leaf: TwistedLeaf) -> list[Critical]:
    r"""Those with $\kappa=0$ of a top with a != 0."""
    square = leaf.c3 / leaf.aa
    both = (leaf.c2 - square * dot(leaf.a, leaf.b)) / leaf.aa
    length = square * dot(leaf.b, leaf.b) + 2 * both * dot(leaf.a, leaf.b) + both**2 / square * leaf.aa
    if length != leaf.c1:
        return []
    found: list[Critical] = []
    for sign in (1, -1):
        t = sign * ball(square).sqrt()
        beta = [t * ball(x) for x in leaf.a]
        alpha = [t * ball(x) + ball(both) / t * ball(y) for x, y in zip(leaf.b, leaf.a, strict=True)]
        found.append(Critical([arb(0)] * 3 + alpha + beta, POINT))
    return found


def without_mass(leaf: TwistedLeaf) -> list[Critical]:
    """All of a top with a = 0."""
    slope = leaf.c2 / leaf.c3
    momentum = leaf.determinant / (2 * leaf.epsilon * leaf.c3)
    found: list[Critical] = []
    for beta, kappa, kind in heavy_equilibria(leaf.inertia, leaf.b, leaf.c3, momentum):
        l = [kappa * ball(x) * y for x, y in zip(leaf.inertia, beta, strict=True)]
        found.append(Critical([*l, *(ball(slope) * x for x in beta), *beta], kind))
    if leaf.determinant <= 0:
        return found
    is_free = is_zero(leaf.b)
    field = [fmpq(1), fmpq(0), fmpq(0)] if is_free else leaf.b
    first = next(k for k in range(3) if field[k] != 0)
    aside = across(field, (first, (first + 1) % 3))
    out = (ball(leaf.determinant / leaf.c3) / ball(dot(aside, aside))).sqrt()
    length = (ball(leaf.c3) / ball(dot(field, field))).sqrt()
    for sign in (1,) if is_free else (1, -1):
        beta = [sign * length * ball(x) for x in field]
        alpha = [ball(slope) * x + out * ball(y) for x, y in zip(beta, aside, strict=True)]
        found.append(Critical([arb(0)] * 3 + alpha + beta, ROTATIONS if is_free else CIRCLE))
    return found
