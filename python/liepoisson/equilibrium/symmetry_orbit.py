r"""The curve along which the motions of integrals carry a relative equilibrium.

A relative equilibrium is a whole orbit of the symmetry: with x, all $\phi_t(x)$ are relative equilibria of the same
energy, where $\phi_t$ is the flow of the integral K (or of a combination of several). The flow stays on its orbit
however near another one passes, where Newton's method from a step along the tangent may come to the other one.

References: [hairer1993], section II.9, for the midpoint rule with extrapolation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from liepoisson.equilibrium.critical_points import VANISHES, HamiltonianFields
from liepoisson.inputs.arrays import Array, norm
from liepoisson.leaf.leaf_in_units import LeafInUnits
from liepoisson.leaf.leaf_projection import solve
from liepoisson.portable import linear

_PARTS = (2, 4, 6, 8, 10, 12)
"""Into how many parts the midpoint rule divides a step: of order 12, to round-off for turns by half a radian. A circle
that is degenerate across magnifies errors."""
_LONGEST, _BEND = 0.15, 0.5
"""What a step covers, relative to the length of the state, and the angle by which it turns the velocity, at most."""
_MOST_STEPS, _MOST_CORRECTIONS = 2000, 12
_SETTLED = 1e-13
_STEPS_TO_REST, _SINGULAR = 4, 1e-8
"""Steps of Newton's method to where a motion is at rest, and singular values that are zero, relative."""

Corrected = Callable[[Array], Array | None]
"""What leads a state back to the relative equilibrium that is at its place, to round-off; None if none is."""


@dataclass(frozen=True)
class Motion:
    """The motion of a combination of the integrals, with constant coefficients.

    Attributes:
        leaf: The leaf.
        fields: Those of H and the integrals.
        coefficients: Of the integrals, shape (k,).
    """

    leaf: LeafInUnits
    fields: HamiltonianFields
    coefficients: Array

    @classmethod
    def with_velocity(cls, leaf: LeafInUnits, fields: HamiltonianFields, x: Array, velocity: Array) -> Motion:
        """The one that has this velocity at x, which is in the span of those of the integrals."""
        rates, scale = fields.fields(x)[:, 1:], fields.scale(x)[1:]
        scale = np.where(scale > 0, scale, 1.0)
        return cls(leaf, fields, linear.lstsq(rates / scale, velocity, rcond=1e-8)[0] / scale)

    def velocity(self, x: Array) -> Array:
        """The vector field at x."""
        return linear.matmul(self.fields.fields(x)[:, 1:], self.coefficients)

    def rest_near(self, x: Array) -> Array:
        """A state of the leaf near x that the motion does not move, if there is one, by Newton's method."""
        for _ in range(_STEPS_TO_REST):
            basis = self.leaf.tangent_basis(x)
            matrix = linear.matmul(linear.matmul(self.fields.derivatives(x)[..., 1:], self.coefficients), basis)
            step = linear.matmul(basis, linear.lstsq(matrix, -self.velocity(x), rcond=_SINGULAR)[0])
            x = solve(self.leaf.equations, (x + step)[None])[0][0]
        return x

    def longest_step(self, x: Array) -> float:
        """The time in which the state moves by a small part of its length, and its velocity turns by a small angle."""
        velocity = self.velocity(x)
        speed, size = float(norm(velocity)), float(norm(x)) + self.fields.unit
        if not speed > 0:
            return 0.0
        bend = float(
            norm(linear.matmul(linear.matmul(self.fields.derivatives(x)[..., 1:], self.coefficients), velocity))
        )
        return min(_LONGEST * size / speed, _BEND * speed / bend if bend > 0 else np.inf)

    def carried(self, x: Array, time: float) -> Array:
        """The state after this time, by the midpoint rule with extrapolation."""
        rows: list[list[Array]] = []
        for i, n in enumerate(_PARTS):
            h, last, now = time / n, x, x + time / n * self.velocity(x)
            for _ in range(n - 1):
                last, now = now, last + 2 * h * self.velocity(now)
            row = [now]
            for j in range(i):
                row.append(row[j] + (row[j] - rows[-1][j]) / ((n / _PARTS[i - j - 1]) ** 2 - 1))
            rows.append(row)
        x = rows[-1][-1]
        return solve(self.leaf.equations, x[None])[0][0]


@dataclass(frozen=True)
class SymmetryOrbit:
    """A closed orbit of a symmetry.

    Attributes:
        motion: The motion of the integral.
        states: States all along it, in their order, shape (n, N).
    """

    motion: Motion
    states: Array

    @classmethod
    def through(cls, motion: Motion, begin: Array, corrected: Corrected, within: float) -> SymmetryOrbit | None:
        """The orbit of a state, None if it was not seen to close to this distance, relative to the state's length."""
        start, states, x = motion.velocity(begin), [begin], begin
        size = float(norm(begin)) + motion.fields.unit
        side = 1.0
        for _ in range(_MOST_STEPS):
            time = motion.longest_step(x)
            moved = corrected(motion.carried(x, time)) if time > 0 else None
            if moved is None:
                return None
            before, side = side, float(linear.matmul((moved - begin), start))
            if len(states) > 2 and before < 0 <= side:
                near = _nearest(motion, moved, begin)
                if norm(near - begin) <= within * size:
                    return cls(motion, np.array(states))
            states.append(moved)
            x = moved
        return None

    def contains(self, goal: Array, within: float) -> bool:
        """Whether a state is on the orbit, to this distance, relative to its length."""
        size = float(norm(goal)) + self.motion.fields.unit
        distances = norm(self.states - goal, axis=1)
        lowest = (distances <= np.roll(distances, 1)) & (distances <= np.roll(distances, -1))
        near = (_nearest(self.motion, x, goal) for x in self.states[lowest])
        return any(norm(x - goal) <= within * size for x in near)


def _nearest(motion: Motion, x: Array, goal: Array) -> Array:
    """The state of the orbit of x that is nearest to the goal, by Newton's method for the time."""
    for _ in range(_MOST_CORRECTIONS):
        velocity = motion.velocity(x)
        time = float(linear.matmul((goal - x), velocity) / linear.matmul(velocity, velocity))
        longest = motion.longest_step(x)
        x = motion.carried(x, float(np.clip(time, -longest, longest)))
        if abs(time) * norm(velocity) <= _SETTLED * norm(x):
            break
    return x


def free_motions(leaf: LeafInUnits, fields: HamiltonianFields, x: Array) -> list[Motion]:
    r"""Independent motions of integrals that keep the values of all of these and carry x away.

    They are those of $\sum_jc_jK_j$ with $\sum_j\{K_i, K_j\}c_j = 0$ for all i: all of them where the integrals
    commute, and the rotations about the angular momentum itself where these are its components.
    """
    rates, scale = fields.fields(x)[:, 1:], fields.scale(x)[1:]
    scale = np.where(scale > 0, scale, 1.0)
    rates = rates / scale
    if not rates.size:
        return []
    slopes = np.stack([f.gradient(x) for f in fields.functions[1:]], axis=-1)
    lengths = norm(slopes, axis=0)
    brackets = linear.matmul((slopes / np.where(lengths > 0, lengths, 1.0)).T, rates)
    _, sizes, rows = linear.svd(brackets)
    free = rows[sizes <= VANISHES * norm(rates, axis=0).max()].T
    _, sizes, rows = linear.svd(linear.matmul(rates, free), full_matrices=False)
    return [
        Motion(leaf, fields, linear.matmul(free, row) / scale)
        for row, size in zip(rows, sizes, strict=True)
        if size > VANISHES
    ]
