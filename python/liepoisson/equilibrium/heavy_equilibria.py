r"""All equilibria of a heavy top on a leaf, and of tops that reduce to one, by algebra.

Unknown are $n$ with $|n|^2 = N$ and $\ell$ with $\ell\cdot n = c$; the energy is $\frac12\ell\cdot D\ell + A\cdot n$
with $D = I^{-1}$. An equilibrium has $n\times D\ell = 0$, so $\ell = \lambda I n$, and
$\ell\times D\ell + n\times A = 0$, so $(\lambda^2 I + \mu)\,n = A$. Put $\mu = \lambda^2\sigma$:

$$\sum_k \frac{A_k^2}{(I_k+\sigma)^2} =: P(\sigma) = N\lambda^4, \qquad
  \sum_k \frac{I_k A_k^2}{(I_k+\sigma)^2} =: Q(\sigma) = c\lambda^3 .$$

The branches, which together are all:

- $A = 0$: $n$ is an eigenvector of $I$ and $\lambda = c/(N I_k)$; for $c = 0$ every $n$ with $\ell = 0$.
- $c = 0$, $A\ne0$, $\lambda = 0$: $n = \pm\sqrt N A/|A|$.
- $c = 0$, $A\ne0$, $\lambda\ne0$: the real roots of Q, each with $\lambda = \pm(P/N)^{1/4}$. There are none, in this
  branch and in the last one, if all moments have the same sign.
- $c\ne0$, $A\ne0$, and $\sigma\ne-I_k$ wherever $A_k\ne0$: the real roots of $c^4P^3 = N^3Q^4$, a polynomial of degree
  at most 18; each gives one $\lambda = cP/(NQ)$. (P is positive, so Q is not zero.)
- $\sigma = -J$, a moment with $A_k = 0$ for all k of the set K where $I_k = J$. Then $n_K$ is free up to its length,
  $JN\lambda^4 - c\lambda^3 + \sum_{j\notin K}A_j^2/(I_j-J) = 0$ and $|n_K|^2 = N - \lambda^{-4}\sum_{j\notin K}
  A_j^2/(I_j-J)^2 > 0$: two points if the moment is simple, a circle if it is double. (Where the length is zero the
  state belongs to the branch before.)

Tops with rational parameters, recognised by their equations: what the algebra of equilibria starts from.

A heavy top in six components, $\ell$ and $\alpha$ with the bracket so(3) @ semidirect(2), is a top of which only the
leaves with $\beta = 0$ are there, and a free rigid body on so(3) is one with $\alpha = \beta = 0$.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias, cast

from flint import arb, fmpq, fmpq_poly

from liepoisson.algebra.ideals.certified_roots import (
    ball,
    evaluate,
    positive_roots_of,
    rational,
    real_roots,
)
from liepoisson.model.top_parameters import recognised_top

if TYPE_CHECKING:
    from liepoisson.model.system import System

Vector: TypeAlias = Sequence[fmpq]
BallVector: TypeAlias = list[arb]

POINT, CIRCLE, SPHERE, ROTATIONS = "point", "circle", "sphere", "all rotations"
"""What a connected set of equilibria is: the last are diffeomorphic to the group SO(3)."""
BY_COUNT = (POINT, CIRCLE, SPHERE)
"""The set of vectors of one length by their dimension, less one; two points for the first."""


@dataclass(frozen=True)
class Critical:
    """A connected set of equilibria: one state of it in balls, nine numbers, and what it is."""

    state: BallVector
    kind: str


def groups_of(inertia: Vector) -> list[tuple[int, ...]]:
    """The indices of equal moments."""
    return [tuple(k for k in range(3) if inertia[k] == moment) for moment in dict.fromkeys(inertia)]


def is_zero(vector: Vector, at: Sequence[int] = (0, 1, 2)) -> bool:
    """Whether the components at these indices vanish."""
    return all(vector[k] == 0 for k in at)


def dot(u: Vector, v: Vector, at: Sequence[int] = (0, 1, 2)) -> fmpq:
    """The scalar product over these indices."""
    return sum((u[k] * v[k] for k in at), fmpq(0))


def placed(rest: Sequence[arb], at: Sequence[int], length: arb, kind: str) -> list[tuple[BallVector, str]]:
    """The vectors with components `rest` and a free part of this length at the given indices: two for points."""
    signs = (1, -1) if kind == POINT else (1,)
    return [([x + sign * length if k == at[0] else x for k, x in enumerate(rest)], kind) for sign in signs]


def heavy_equilibria(inertia: Vector, field: Vector, size: fmpq, momentum: fmpq) -> list[tuple[BallVector, arb, str]]:
    r"""All equilibria, as (n, lambda, kind); $\ell = \lambda I n$.

    Args:
        inertia: Principal moments, of any sign.
        field: The vector A.
        size: $N = |n|^2$, positive.
        momentum: $c = \ell\cdot n$.

    Raises:
        UndecidedError: the balls are too wide at this precision.
    """
    if is_zero(field):
        return _free(inertia, size, momentum)
    found = _at_rest(field, size) if momentum == 0 else []
    found += _regular(inertia, field, size, momentum)
    for group in groups_of(inertia):
        if is_zero(field, group):
            found += _tilted(inertia, field, size, momentum, group)
    return found


def _free(inertia: Vector, size: fmpq, momentum: fmpq) -> list[tuple[BallVector, arb, str]]:
    length, zero = ball(size).sqrt(), [arb(0)] * 3
    if momentum == 0:
        return [([length, arb(0), arb(0)], arb(0), SPHERE)]
    return [
        (n, ball(momentum / (size * inertia[group[0]])), kind)
        for group in groups_of(inertia)
        for n, kind in placed(zero, group, length, BY_COUNT[len(group) - 1])
    ]


def _at_rest(field: Vector, size: fmpq) -> list[tuple[BallVector, arb, str]]:
    length = (ball(size) / ball(dot(field, field))).sqrt()
    return [([sign * length * ball(x) for x in field], arb(0), POINT) for sign in (1, -1)]


def _regular(inertia: Vector, field: Vector, size: fmpq, momentum: fmpq) -> list[tuple[BallVector, arb, str]]:
    factors, first, second = _polynomials(inertia, field)
    equation = momentum**4 * first**3 * factors**2 - size**3 * second**4 if momentum != 0 else second
    found: list[tuple[BallVector, arb, str]] = []
    for sigma in real_roots(equation):
        height = evaluate(first, sigma)
        if momentum != 0:
            speeds = [ball(momentum / size) * height / evaluate(second, sigma)]
        else:
            square = (height / ball(size)).sqrt() / abs(evaluate(factors, sigma))
            speeds = [sign * square.sqrt() for sign in (1, -1)]
        for speed in speeds:
            square = speed * speed
            n = [ball(x) / (square * (ball(inertia[k]) + sigma)) if x != 0 else arb(0) for k, x in enumerate(field)]
            found.append((n, speed, POINT))
    return found


def _polynomials(inertia: Vector, field: Vector) -> tuple[fmpq_poly, fmpq_poly, fmpq_poly]:
    r"""The product $\Pi$ of the factors $I_k+\sigma$ with $A_k\ne0$, and P and Q times its square."""
    active = [group for group in groups_of(inertia) if not is_zero(field, group)]
    factors = [fmpq_poly([inertia[group[0]], 1]) for group in active]
    weights = [dot(field, field, group) for group in active]
    all_factors, first, second = fmpq_poly([1]), fmpq_poly([0]), fmpq_poly([0])
    for k, factor in enumerate(factors):
        all_factors *= factor
        others = fmpq_poly([1])
        for j, other in enumerate(factors):
            others *= other * other if j != k else fmpq_poly([1])
        first += weights[k] * others
        second += weights[k] * inertia[active[k][0]] * others
    return all_factors, first, second


def _tilted(
    inertia: Vector, field: Vector, size: fmpq, momentum: fmpq, group: tuple[int, ...]
) -> list[tuple[BallVector, arb, str]]:
    moment, rest = inertia[group[0]], [k for k in range(3) if k not in group]
    bare = {k: field[k] / (inertia[k] - moment) for k in rest}
    total = sum((field[k] * bare[k] for k in rest), fmpq(0))
    equation = fmpq_poly([total, 0, 0, -momentum, moment * size])
    length = fmpq_poly([-sum((x * x for x in bare.values()), fmpq(0)), 0, 0, 0, size])
    found: list[tuple[BallVector, arb, str]] = []
    for speed in positive_roots_of(equation, length):
        if speed.is_zero():
            continue
        n = [ball(bare[k]) / (speed * speed) if k in bare else arb(0) for k in range(3)]
        free = evaluate(length, speed).sqrt() / (speed * speed)
        found += [(v, speed, kind) for v, kind in placed(n, group, free, BY_COUNT[len(group) - 1])]
    return found


@dataclass(frozen=True)
class ExactTop:
    """The parameters of a top as rational numbers; in a system that was typed by hand, moments may be negative.

    A system of six components has b = 0 and epsilon = 0, one of three a = 0, too.
    """

    inertia: Vector
    a: Vector
    b: Vector
    epsilon: fmpq

    @property
    def is_definite(self) -> bool:
        """Whether the kinetic energy is, which means that all moments have the same sign."""
        return len({moment > 0 for moment in self.inertia}) == 1


def exact_top(system: System) -> ExactTop | None:
    """The top with the bracket and the equations of this system, or None: not a top, or a parameter is irrational."""
    found = system.top_parameters if system.bracket.dimension == 9 else recognised_top(system)
    if found is None or not found.has_bracket(system.bracket):
        return None
    numbers = (*found.inertia, *found.a, *found.b, found.epsilon)
    if not all(isinstance(value, Fraction) for value in numbers):
        return None
    exact = [rational(cast("Fraction", value)) for value in numbers]
    return ExactTop(exact[:3], exact[3:6], exact[6:9], exact[9])
