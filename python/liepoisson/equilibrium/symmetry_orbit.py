r"""The orbits along which symmetries carry critical points.

The flow of an integral K keeps H, so it carries an equilibrium along a curve of equilibria. A relative equilibrium is
carried by the flows of those combinations of the integrals that keep the values of all. Here such an orbit is followed
by the classical Runge–Kutta method in steps of 0.05 radians, after a turn of which some 3e-7 of the length is lost.

References: [palais1979].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from liepoisson.equilibrium.critical_points import CANCELLED, MOST_STEPS, VANISHES, HamiltonianFields
from liepoisson.inputs.arrays import Array, norm
from liepoisson.leaf.leaf_projection import solve
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.leaf.leaf_in_units import LeafInUnits
    from liepoisson.model.phase_functions import PhaseFunction

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
