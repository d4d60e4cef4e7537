"""The problem of equilibria on a leaf of a twisted top as rational numbers, and the state that solves it.

The notation is that of `liepoisson.equilibrium.twisted_equilibria`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, fmpq

from liepoisson.algebra.ideals.certified_roots import ball
from liepoisson.equilibrium.heavy_equilibria import POINT, Critical, Vector, dot, groups_of, is_zero


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
