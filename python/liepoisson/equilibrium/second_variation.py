r"""A critical point of H on its leaf: the symplectic slice, the second variation, and how well the point is known.

**How well.** Newton's step s from a state x, the smallest singular value $\sigma$ of the linear equations M and the
round-off r in them give the distance $\delta = 2(|s| + r/\sigma)$. If M changes by less than $\sigma/2$ within it,
there is one zero of the equations at a distance of at most $\delta$, and no other as far as M changes by less than that
(Newton and Kantorovich). At a zero of order m the entries of M grow like $d^{m-1}$ with the distance d, and $\delta$
is $2d/m$: there they change by more, and so they do on a tail, where the slope only decays.

Where a symmetry carries x along an orbit of critical points, M vanishes along it, and all this holds across the orbit
(Palais' principle of symmetric criticality).

The flow of an integral K keeps H, so it carries an equilibrium along a curve of equilibria. A relative equilibrium is
carried by the flows of those combinations of the integrals that keep the values of all. Here such an orbit is followed
by the classical Runge–Kutta method in steps of 0.05 radians, after a turn of which some 3e-7 of the length is lost.

References: [kantorovich1948]; [palais1979].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from flint import arb

from liepoisson.algebra.ideals.certified_roots import precision
from liepoisson.equilibrium.critical_points import (
    CANCELLED,
    MOST_STEPS,
    ROUND_OFF,
    VANISHES,
    CriticalEquations,
    HamiltonianFields,
    multipliers,
)
from liepoisson.equilibrium.linearisation import LinearFlow, linear_flow
from liepoisson.inputs.arrays import Array, norm
from liepoisson.leaf.leaf_projection import solve
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.leaf.leaf_in_units import LeafInUnits
    from liepoisson.model.phase_functions import PhaseFunction

_BITS = 200
"""Of numbers in which slopes are computed without round-off: 60 digits, of which terms that cancel may cost 40."""
_FARTHEST = 0.25
"""The distance up to which others are excluded, relative to the length of the state: leaves are curved."""


@dataclass(frozen=True)
class CriticalPoint:
    """A critical point with what its second variations are made of."""

    fields: HamiltonianFields
    leaf: LeafInUnits
    x: Array
    omega: Array

    @cached_property
    def tangents(self) -> Array:
        """Orthonormal basis of the tangent space of the leaf."""
        return self.leaf.tangent_basis(self.x)

    @cached_property
    def _directions(self) -> tuple[Array, Array, Array]:
        """Singular vectors and values of the vector fields of the integrals, each relative to its scale."""
        rates, scale = self.fields.fields(self.x)[:, 1:], self.fields.scale(self.x)[1:]
        vectors, sizes, rows = linear.svd(rates / np.where(scale > 0, scale, 1.0))
        return vectors[:, : int((sizes > VANISHES).sum())], sizes, rows

    @property
    def symmetry(self) -> Array:
        """Basis of the span of the vector fields of the integrals, in coordinates of the tangent space of the leaf."""
        return linear.matmul(self.tangents.T, self._directions[0])

    def free(self) -> Array:
        """Combinations of the integrals whose vector fields vanish here, shape (free, k)."""
        vectors, _, rows = self._directions
        scale = self.fields.scale(self.x)[1:]
        return rows[vectors.shape[1] :] / np.where(scale > 0, scale, 1.0)

    def linear_flow(self, coefficients: Array) -> tuple[LinearFlow, float]:
        """The linearised flow of a combination of H and the integrals on the leaf, and its asymmetry."""
        basis, parts = self.tangents, self.fields.parts(self.x)
        derivative = linear.matmul(sum(parts), coefficients)
        # H - Omega K may be constant on the leaf: what is left of terms that cancel there is no second variation
        sizes = [norm(linear.einsum("ai,abk,bj->ijk", basis, part, basis), axis=(0, 1)) for part in parts]
        restricted = linear.matmul(linear.matmul(basis.T, derivative), basis)
        left = CANCELLED * float(linear.matmul(sum(sizes), np.abs(coefficients)))
        if norm(restricted) <= left:
            derivative = np.zeros_like(derivative)
        flow, asymmetry = linear_flow(self.fields.poisson(self.x), derivative, basis)
        return self._without_rounding(flow, coefficients), asymmetry

    def _without_rounding(self, flow: LinearFlow, coefficients: Array) -> LinearFlow:
        """The flow with zeros for eigenvalues of the second variation that the rounding of the state can make."""
        if not flow.size:
            return flow
        moved = ROUND_OFF * (float(norm(self.x)) + self.fields.unit) * self.tangents
        with np.errstate(all="ignore"):
            around = linear.matmul(
                sum(self.fields.parts(self.x + np.concatenate([moved, -moved], axis=1).T)), coefficients
            )
            change = around - linear.matmul(sum(self.fields.parts(self.x)), coefficients)
            change = linear.matmul(linear.matmul(self.tangents.T, change), self.tangents)
            bound = float(norm(flow.form) * norm(change, axis=(-2, -1)).max())
        values, vectors = linear.eigh(flow.hessian)
        if not (np.abs(values) <= bound).any():
            return flow
        kept = np.where(np.abs(values) <= bound, 0.0, values)
        return flow.with_hessian(linear.matmul(vectors * kept, vectors.T))


def on_slice(fields: HamiltonianFields, leaf: LeafInUnits, x: Array) -> tuple[CriticalPoint, LinearFlow, Array, float]:
    """The linearised flow at x on the symplectic slice, a basis of this, and the asymmetry."""
    omega = multipliers(fields.fields(x)[None], fields.scale(x)[None])[0]
    point = CriticalPoint(fields, leaf, x, omega)
    flow, asymmetry = point.linear_flow(np.array([1.0, *-omega]))
    basis = flow.slice_basis(point.symmetry) if point.symmetry.size else np.eye(flow.size)
    return point, flow.restricted(basis), basis, asymmetry


@dataclass(frozen=True)
class Accuracy:
    """How well a critical point is known.

    Attributes:
        distance: How far the state is from the zero of the equations at most, if there is one nearby.
        alone_within: Up to which distance it is the only one, but for those to which symmetries carry it; 0 where it is
            not known that there is one.
        n_regular: How many of the vector fields of integrals are independent there.
        is_alone: Whether it is the only one also among states at which more of them are.
    """

    distance: float
    alone_within: float
    n_regular: int = 0
    is_alone: bool = False

    @property
    def is_known(self) -> bool:
        """Whether it is known that there is a zero of the equations, and one only."""
        return self.alone_within > 0


@np.errstate(all="ignore")  # functions need not be defined in the neighbourhood; then nothing is known
def accuracy(equations: CriticalEquations, x: Array, n_symmetries: int, omega: Array | None = None) -> Accuracy:
    """How well a critical point is known from the linear equations at a state of the leaf.

    Args:
        equations: Those of the critical point.
        x: The state, shape (N,).
        n_symmetries: In how many directions symmetries carry it along critical points.
        omega: The multipliers, by default those of least squares.
    """
    fields = equations.fields
    rates, scale = fields.fields(x[None]), fields.scale(x[None])
    omega = multipliers(rates, scale) if omega is None else omega[None]
    basis = equations.tangents(x[None])
    rank, k = basis.shape[2], len(equations.values)
    n_regular = n_independent(rates[0, :, 1:], scale[0, 1:])
    if not n_regular:  # the level of integrals that are at rest says nothing
        k = 0
    units = equations.units(x[None], rank)[0][: rank + k]
    length = (float(norm(x)) + fields.unit) or 1.0  # the origin is a leaf of its own

    def linear_equations(states: Array, omegas: Array) -> Array:
        """The linear equations at states near x, in the units of x, shape (n, equation, rank + k)."""
        bases, among = np.repeat(basis, len(states), axis=0), np.repeat(x[None], len(states), axis=0)
        return equations.newton_matrix(states, omegas, bases, among)[:, : len(x) + k, : rank + k] * units

    matrix = linear_equations(x[None], omega)[0]
    if not np.isfinite(matrix).all():
        return Accuracy(np.inf, 0.0, n_regular)
    left, sizes, right = linear.svd(matrix, full_matrices=False)
    regular = rank + n_regular - n_symmetries
    if not regular:
        return Accuracy(ROUND_OFF * length, _FARTHEST * length, n_regular)
    smallest = float(sizes[regular - 1])
    if not smallest > 0:
        return Accuracy(np.inf, 0.0, n_regular)
    residual = equations.residual(x[None], omega)[0, : len(x) + k]

    def is_regular_within(share: float) -> bool:
        """Whether the linear equations change by less than half of the smallest singular value; to first order."""
        moved = share * np.eye(rank + k)
        moved = np.concatenate([moved, -moved]) * units
        states = x + linear.matmul(moved[:, :rank], basis[0].T)
        omegas = np.repeat(omega, len(moved), axis=0)
        omegas[:, :k] += moved[:, rank:]
        changes = norm(linear_equations(states, omegas) - matrix, axis=(1, 2)).reshape(2, -1).max(axis=0)
        return bool(norm(changes) <= smallest / 2)

    # terms of the slope that cancel may leave more than the round-off of its size: it is computed without
    exact = _exact_fields(fields, x)
    residual[: len(x)] = (exact[:, 0] - linear.matmul(exact[:, 1:], omega[0])) / (scale[0, 0] or 1.0)
    step = linear.matmul(linear.matmul(left.T, residual)[:regular] / sizes[:regular], right[:regular])
    distance = 2 * (float(norm(step)) + ROUND_OFF / smallest)
    if not is_regular_within(distance):
        return Accuracy(distance * length if np.isfinite(distance) else np.inf, 0.0, n_regular)
    within = distance
    while within < _FARTHEST and is_regular_within(2 * within):
        within *= 2
    return Accuracy(distance * length, min(within, _FARTHEST) * length, n_regular)


def _exact_fields(fields: HamiltonianFields, x: Array) -> Array:
    """The vector fields, shape (N, 1 + k), from slopes that are computed with 60 digits."""
    with precision(_BITS):
        state = [*map(arb, x.tolist())]
        slopes = [[float(v.mid()) for v in f.gradient_in_balls(state)] for f in fields.functions]
    return np.asarray(linear.matmul(fields.poisson(x), np.array(slopes).T))


def n_independent(rates: Array, scale: Array) -> int:
    """How many of the vector fields of integrals, shape (N, k), are independent at a state."""
    if not rates.shape[1]:
        return 0
    sizes = linear.svd(rates / np.where(scale > 0, scale, 1.0), compute_uv=False)
    return int((sizes > VANISHES).sum())


_STEP = 0.05
"""A step along an orbit, relative to the length of the state, and by what angle it turns the velocity, at most: a turn
loses 3e-7. An orbit that does not close is left after a hundred radians."""


@dataclass(frozen=True)
class Symmetries:
    """The motions of integrals of a system that carry critical points of H along critical points.

    Attributes:
        leaf: The leaf.
        integrals: Those of relative equilibria, whose values are kept; or all that are known of the system.
        are_kept: Whether their values are kept.
    """

    leaf: LeafInUnits
    integrals: tuple[PhaseFunction, ...]
    are_kept: bool

    @classmethod
    def of(cls, leaf: LeafInUnits, along: HamiltonianFields) -> Symmetries:
        """Those for equilibria, or for relative equilibria with respect to integrals."""
        if len(along.functions) > 1:
            return cls(leaf, along.functions[1:], are_kept=True)
        system, functions = leaf.source, leaf.system.functions
        own = {"H", *system.functions.casimirs}
        return cls(leaf, tuple(functions.of(f) for name, f in system.invariants.items() if name not in own), False)

    @cached_property
    def _fields(self) -> HamiltonianFields:
        return HamiltonianFields(self.leaf.system, self.integrals)

    def combinations(self, x: Array) -> Array:
        r"""Independent combinations of the integrals whose motions carry x along critical points, shape (k, n).

        Where values are kept, $\sum_j\{K_i, K_j\}c_j = 0$ for all i: all of them where the integrals commute, and the
        rotations about the angular momentum itself where these are its components.
        """
        k = len(self.integrals)
        if not k:
            return np.zeros((0, 0))
        scale = self._fields.scale(x)
        scale = np.where(scale > 0, scale, 1.0)
        rates, free = self._fields.fields(x) / scale, np.eye(k)
        if self.are_kept:
            slopes = np.stack([f.gradient(x) for f in self.integrals], axis=-1)
            lengths = norm(slopes, axis=0)
            brackets = linear.matmul((slopes / np.where(lengths > 0, lengths, 1.0)).T, rates)
            _, sizes, rows = linear.svd(brackets)
            free = rows[sizes <= VANISHES * norm(rates, axis=0).max()].T
        _, sizes, rows = linear.svd(linear.matmul(rates, free), full_matrices=False)
        return linear.matmul(free, rows[sizes > VANISHES].T) / scale[:, None]

    def velocities(self, x: Array, combinations: Array) -> Array:
        """The vector fields of combinations of the integrals, shape (N, n)."""
        return linear.matmul(self._fields.fields(x), combinations)

    def carried(self, x: Array, combination: Array) -> Array:
        """The state after the motion of a combination, shape (k,), for a unit of time."""
        first = self.velocities(x, combination)
        second = self.velocities(x + first / 2, combination)
        third = self.velocities(x + second / 2, combination)
        fourth = self.velocities(x + third, combination)
        return solve(self.leaf.equations, (x + (first + 2 * second + 2 * third + fourth) / 6)[None])[0][0]

    def _shortened(self, x: Array, combination: Array) -> Array:
        """The combination, less if its motion covers more than a step in a unit of time."""
        velocity = self.velocities(x, combination)
        bend = linear.matmul(linear.matmul(self._fields.derivatives(x), combination), velocity)
        speed, length = float(norm(velocity)), float(norm(x)) + self._fields.unit
        covered = max(speed / length, float(norm(bend)) / speed) / _STEP if speed > 0 else 1.0
        return combination / max(1.0, covered)

    def nearest(self, x: Array, goal: Array) -> Array:
        """The state of the orbit of x that is nearest to another one, as far as it is come to by approaching."""
        size = float(norm(goal)) + self._fields.unit
        for _ in range(round(MOST_STEPS / _STEP)):
            combinations = self.combinations(x)
            if not combinations.size:
                break
            share = linear.lstsq(self.velocities(x, combinations), goal - x, rcond=VANISHES)[0]
            step = self._shortened(x, linear.matmul(combinations, share))
            moved = self.carried(x, step)
            if not norm(moved - goal) < norm(x - goal) - CANCELLED * size:
                break
            x = moved
        return x

    def closed(self, begin: Array, within: float) -> Array | None:
        """States all along the orbit of one motion, shape (n, N); None if it was not seen to close to this distance."""
        combination = self.combinations(begin)[:, 0]
        start = self.velocities(begin, combination)
        combination = combination * (_STEP * (float(norm(begin)) + self._fields.unit) / float(norm(start)))
        states, x, side = [begin], begin, 1.0
        for _ in range(round(MOST_STEPS / _STEP)):
            x = self.carried(x, self._shortened(x, combination))
            before, side = side, float(linear.matmul(x - begin, start))
            if len(states) > 2 and before < 0 <= side and norm(self.nearest(x, begin) - begin) <= within:
                return np.array(states)
            states.append(x)
        return None
