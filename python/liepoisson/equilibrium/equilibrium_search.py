r"""The search for critical points of H on a leaf from random starts, and the families that they form.

Two states belong to one family if a path of critical points leads from one to the other: steps in the kernel of the
second variation (and along the flows of the integrals), each followed by Newton's method.

Where the second variation is degenerate beyond the directions of a family, as where two equilibria meet, Newton's
method converges slowly and ends too early: with $f\sim d^3$ a residual of 1e-14 is reached at the distance
d = 1e-4 to 1e-5, and the second variation $\sim d^2$ still has a sign there, which says nothing. Such an end is moved
on by stretched Newton steps, until the soft directions are flat to round-off.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import takewhile
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.critical_points import (
    MOST_STEPS,
    SOFT,
    VANISHES,
    HamiltonianFields,
    critical_points,
    finished,
    residuals,
    stretched_steps,
)
from liepoisson.equilibrium.equilibrium_list import signed_sum
from liepoisson.equilibrium.flat_parts import FlatPart, HiddenPlace, flat_part_at, hidden_place_at
from liepoisson.equilibrium.second_variation import curvatures, null_directions, symmetry_directions
from liepoisson.equilibrium.soft_zeros import SoftZero, may_mislead, settled, zero_near
from liepoisson.equilibrium.stability import Equilibrium, analysis
from liepoisson.equilibrium.symmetry_orbit import Motion, SymmetryOrbit, free_motions
from liepoisson.errors import TimeLimitError
from liepoisson.inputs.arrays import Array, norm
from liepoisson.inputs.deadline import checkpoint, has_passed
from liepoisson.leaf.leaf_search import representative
from liepoisson.portable import elementary, linear
from liepoisson.streams import Purpose, generator, stream

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.leaf.leaf_in_units import LeafInUnits
    from liepoisson.model.phase_functions import PhaseFunction

FOUND, NEAR = 1e-11, 1e-8
"""Relative residual up to which a state counts as a critical point that was found; one below the second may be on the
slow way to a degenerate one."""

_SLOW, _FEW_SLOW = 1e-3, 20
"""The same for the way to an equilibrium of so high an order that Newton's method is still far, where H may have one;
and how many of these are followed."""

_CRITICAL = 1e-8
"""The same for the slope of H along the leaf, which does not become small where J does, at the edge of a leaf."""

_EDGE = 1e-6
"""A state is on the edge of its leaf, where J has a lower rank, if the last singular value of J, relative to the length
of the state, is below this fraction of that at the leaf's own state. It is larger than `_CRITICAL`: a Toda lattice
at the edge, where its leaf ends without an equilibrium, has a slope of the order of this value."""

_SAME, _SAME_ENERGY, _SCATTER = 1e-6, 1e-9, 1e-2
_STEP, _MOST_STEPS, _KICKS, _FEW_STEPS = 0.15, 120, 4, 20
"""Steps along a family, relative to the length of the state; random steps where the straight way is blocked; steps of
Newton's method after each."""

_PARTS, _BENT = (1.0, 0.5, 0.25, 0.125), 0.1
"""Parts of such a step that are tried, and what the correction may be to the length of one that is not too long."""

_SHORT, _ALONG, _CORRECTED, _ASIDE = (0.02, 0.0025), 0.3, 1.5, 0.3
"""Steps from which it is seen whether a family goes on, relative to the length of the state; what is left, at least, of
a step that leads along a family; how long its correction may be; and how far two states may be from each other to count
as one, relative to the step."""

_CARRIED = 1e-12
"""The residual that is left of a relative equilibrium where the motion of an integral has carried it without error."""

_ORDERS, _FLATTER = (2.0, 3.0, 4.0, 5.0), 0.25
"""Degrees of the first terms that do not vanish, which are tried, and what a step must do to the soft directions."""


@dataclass
class _Family:
    """One isolated equilibrium, or several of one connected family.

    `orbit` is what the motion of an integral makes of one relative equilibrium, and `curve` has states all along
    another closed family. `is_isolated`: it is known to be no part of a family. `is_crossed`: the second variation has
    a larger kernel at some of the states, as where the family crosses another or itself. The states are in the units of
    the leaf, except that of `first`.
    """

    first: Equilibrium
    states: list[Array] = field(default_factory=list[Array])
    kind: str = "point"
    curve: Array | None = None
    orbit: SymmetryOrbit | None = None
    is_isolated: bool = False
    is_crossed: bool = False

    def take(self, one: Equilibrium, states: list[Array]) -> None:
        """Add states, the first of which is this equilibrium."""
        self.states += states
        self.is_crossed |= one.nullity > self.first.nullity

    def counted(self) -> Equilibrium:
        return replace(self.first, n_found=len(self.states), family=self.kind)


class EquilibriumSearch:
    """The search on one leaf; each call of `extend` takes more starts.

    Where the deadline of the call passes, what was found stays, and `is_cut_short` is true.

    Args:
        leaf: The leaf.
        integrals: Integrals with their names.
        values: Their values.
        seed: Draws the starts.
    """

    def __init__(self, leaf: Leaf, integrals: Mapping[str, PhaseFunction], values: Array, seed: int) -> None:
        self._itself, self._integrals, self._values = leaf, integrals, values
        self._origin = representative(leaf).in_units()
        self._leaf = replace(leaf.in_units(), units=self._origin.units)
        functions = self._leaf.system.functions
        self._fields = HamiltonianFields(self._leaf.system, [functions.energy, *map(functions.of, integrals.values())])
        self._rng = stream(seed, Purpose.EQUILIBRIA)
        self._kicks = generator(0)
        self._families: list[_Family] = []
        self._zeros: list[SoftZero] = []
        self._flat_parts: list[FlatPart] = []
        self._hidden: list[HiddenPlace] = []
        self.n_starts = 0
        self.is_cut_short = False

    @property
    def found(self) -> list[Equilibrium]:
        """What was found so far, by increasing energy."""
        return sorted((family.counted() for family in self._families), key=lambda e: e.energy)

    def signed_sum(self) -> int | None:
        """The sum of the signs; not known where families cross, which are then no circles."""
        return None if any(family.is_crossed for family in self._families) else signed_sum(self.found)

    @property
    def n_undecided(self) -> int:
        """The number of places where H is flat to round-off and may have more equilibria than those found."""
        return sum(not part.is_decided for part in self._flat_parts) + len(self._hidden)

    def extend(self, n_starts: int) -> None:
        """Search from this many starts more."""
        origin = self._origin.state
        size = (float(norm(origin)) + self._fields.unit) / np.sqrt(len(origin)) or 1.0
        starts = self._rng.standard_normal((n_starts, len(origin))) * size
        starts *= elementary.exp(self._rng.uniform(elementary.log(0.2), elementary.log(5.0), (n_starts, 1)))
        self.n_starts += n_starts
        self._add_from(starts)

    def add_from(self, starts: Array) -> None:
        """Search from these states, and add what they lead to."""
        self._add_from(starts / self._leaf.units)

    @np.errstate(all="ignore")  # H may overflow; where it is not defined there is no critical point
    def _add_from(self, starts: Array) -> None:
        states, residual = self._reached(self._origin, starts, is_sure=False)
        for state in states[np.argsort(residual, kind="stable")]:
            with suppress(TimeLimitError):  # whether it belongs to a family was not seen
                self._add(state)
        self.is_cut_short |= has_passed()

    def until_the_sum_is(self, expected: int | None, most_starts: int) -> None:
        """Twice as many starts each time, while the sum of the signs is known and not this number."""
        while expected is not None and self.signed_sum() not in {None, expected} and self._goes_on(most_starts):
            self.extend(min(self.n_starts, most_starts - self.n_starts))

    def until_all_were_met_again(self, most_starts: int) -> None:
        """Twice as many starts each time, while an equilibrium was met once only.

        The share of starts that lead to equilibria not met yet is about the number of those met once, divided by that
        of the starts (Good 1953).
        """
        while any(family.n_found == 1 for family in self.found) and self._goes_on(most_starts):
            self.extend(min(self.n_starts, most_starts - self.n_starts))

    def _goes_on(self, most_starts: int) -> bool:
        """Whether there are starts and time left."""
        return self.n_starts < most_starts and not self.is_cut_short

    def _reached(
        self, leaf: LeafInUnits, starts: Array, most_steps: int = MOST_STEPS, *, is_sure: bool = True
    ) -> tuple[Array, Array]:
        """The critical points that Newton's method leads to from the starts, and their residuals.

        Unless `is_sure` that there are critical points nearby, those are left out that only look like one in doubles.
        """
        states, residual = critical_points(leaf, self._fields, starts, self._values, most_steps)
        near = is_critical(self._fields, self._leaf, states, residual, within=NEAR)
        if not is_sure and self._may_mislead:
            slow = is_critical(self._fields, self._leaf, states, residual, within=_SLOW) & ~near
            near[np.flatnonzero(slow)[:_FEW_SLOW]] = True
        states = states[near]
        ends = [
            [self._polished(x)] if is_sure else self._led_on(x) for x in takewhile(lambda _: not has_passed(), states)
        ]
        states = np.array([x for found in ends for x in found]).reshape(-1, starts.shape[1])
        if not len(states):
            return states, np.zeros(0)
        residual = residuals(leaf, self._fields, states, self._values)
        good = is_critical(self._fields, self._leaf, states, residual)
        return states[good], residual[good]

    def _add(self, state: Array) -> None:
        size = float(norm(state)) + self._fields.unit
        zero = next((zero for zero in self._zeros if np.array_equal(zero.state, state)), SoftZero(state))
        for family in self._families:
            distances = norm(np.asarray(family.states) - state, axis=1)
            nearest = family.states[int(np.argmin(distances))]
            are_exact = zero.is_isolated and family.is_isolated
            if distances.min() <= _SAME * size or (not are_exact and self._is_scattered(family.first, nearest, state)):
                family.states.append(state)
                return
        new = analysis(self._itself, state * self._leaf.units, self._integrals, is_flat=zero.is_flat)
        directions = null_directions(self._leaf, self._fields, state)
        if directions.shape[1]:
            alike = [family for family in self._families if self._may_be_one(family.first, new, state)]
            for family in sorted(alike, key=lambda f: _distance(f, state)):
                if self._is_connected(family, state):
                    family.take(new, [state])
                    return
        family = self._family(new, state, directions, is_isolated=zero.is_isolated)
        self._families = [known for known in self._families if not self._takes_in(family, known)]
        self._families.append(family)
        if self._may_mislead and family.kind in {"point", "degenerate"}:
            self._note_hidden_place(state)

    def _takes_in(self, family: _Family, known: _Family) -> bool:
        """Whether an equilibrium from which no family was seen to lead away is on this one; if so, it joins it."""
        if family.kind in {"point", "degenerate"} or known.kind != "degenerate" or known.is_isolated:
            return False
        if not self._may_be_one(family.first, known.first, known.states[0]):
            return False
        if not self._is_connected(family, known.states[0]):
            return False
        family.take(known.first, known.states)
        return True

    @cached_property
    def _may_mislead(self) -> bool:
        return may_mislead(self._leaf.system.functions.energy)

    def _led_on(self, state: Array) -> list[Array]:
        """The critical point to which Newton's method was on its way, and those which doubles do not tell from it."""
        if not self._may_mislead:
            state = finished(self._leaf, self._fields, state, self._values)
            zero = settled(self._leaf, self._fields, self._values, self._polished(state))
            self._zeros.append(zero)
            return [zero.state]
        part = self._flat_part_of(state)
        if part is not None and part.zeros and part.is_decided:
            return [zero.state for zero in part.zeros]
        zeros = [] if part is None else list(part.zeros)
        zero = zero_near(self._leaf, self._fields, self._values, state)
        if zero is not None and residuals(self._leaf, self._fields, zero.state[None], self._values)[0] > FOUND:
            # all directions are flat at the critical point, so that none looks soft beside the others
            zero = zero_near(self._leaf, self._fields, self._values, state, within=1.0)
        if zero is not None:
            self._zeros.append(zero)
            zeros = [zero, *zeros]
        elif part is None:
            self._note_hidden_place(state)
        return [zero.state for zero in zeros]

    def _note_hidden_place(self, state: Array) -> None:
        """Remember that others may be hidden beside a state, where several directions are soft."""
        if not any(place.contains(state) for place in self._hidden):
            place = hidden_place_at(self._leaf, self._fields, self._values, state)
            self._hidden += [] if place is None else [place]

    def _flat_part_of(self, state: Array) -> FlatPart | None:
        for part in self._flat_parts:
            if part.contains(state):
                return part
        part = flat_part_at(self._leaf, self._fields, self._values, state)
        if part is not None:
            self._flat_parts.append(part)
            self._zeros.extend(part.zeros)
        return part

    def _polished(self, state: Array) -> Array:
        """The state, or one nearer to a degenerate equilibrium to which Newton's method was on its way."""
        softness = self._softness(state)
        while softness > 0:
            trial = stretched_steps(self._leaf, self._fields, state, self._values, _ORDERS)
            trial = trial[residuals(self._leaf, self._fields, trial, self._values) <= FOUND]
            found = [self._softness(x) for x in trial]
            if not found or not min(found) <= _FLATTER * softness:
                break
            state, softness = trial[int(np.argmin(found))], min(found)
        return state

    def _is_scattered(self, known: Equilibrium, nearest: Array, state: Array) -> bool:
        """Whether a state is the end of a slow way to a degenerate equilibrium that is known, and no other one.

        Such ends lie some thousandths off where several directions are flat, and the ways along them differ.
        """
        close = norm(state - nearest) <= _SCATTER * (norm(nearest) + self._fields.unit)
        return bool(close) and known.nullity > 0 and self._has_energy_of(known, state) and self._softness(state) > 0

    def _may_be_one(self, known: Equilibrium, new: Equilibrium, state: Array) -> bool:
        """Whether two critical points agree in energy, which is constant on a family, and in the signs around them.

        Signs of degenerate ones may differ: where all directions are flat, round-off decides.
        """
        alike = known.nullity == new.nullity and known.signature == new.signature
        if not alike and not (known.nullity and new.nullity):
            return False
        return self._has_energy_of(known, state)

    def _are_level(self, first: Array, second: Array) -> bool:
        """Whether two states have the same energy."""
        return self._has_energy(float(self._leaf.system.functions.energy(first)), second)

    def _has_energy_of(self, known: Equilibrium, state: Array) -> bool:
        return self._has_energy(known.energy, state)

    def _has_energy(self, value: float, state: Array) -> bool:
        energy = self._leaf.system.functions.energy
        length = float(norm(state)) + self._fields.unit
        slope = float(norm(energy.gradient(state))) * length  # zero where H is critical off the leaf, too
        slope += float(norm(energy.hessian(state))) * length**2
        return abs(value - float(energy(state))) <= _SAME_ENERGY * slope

    def _softness(self, state: Array) -> float:
        """The largest curvature among the soft directions, relative to all; 0 if there is none."""
        values = curvatures(self._leaf, self._fields, state)
        return float(values[values <= SOFT].max(initial=0.0))

    def _family(self, first: Equilibrium, state: Array, directions: Array, *, is_isolated: bool) -> _Family:
        """What the family is: the motions of integrals, and steps in the kernel that stay steps, are along it."""
        if not directions.shape[1]:
            return _Family(first, [state], is_isolated=is_isolated)
        motions = free_motions(self._leaf, self._fields, state)
        kernel = directions[:, symmetry_directions(self._leaf, self._fields, state).shape[1] :]
        along = np.zeros((len(state), 0)) if is_isolated else self._free_steps(state, kernel)
        n_free = len(motions) + along.shape[1]
        if not n_free:
            return _Family(first, [state], "degenerate", is_isolated=is_isolated)
        orbit, curve = None, None
        if n_free == 1:
            orbit = SymmetryOrbit.through(motions[0], state, self._kept, _SAME) if motions else None
            curve = self._round(state, along[:, 0]) if along.size else None
        is_closed = orbit is not None or curve is not None
        return _Family(first, [state], "circle" if is_closed else f"family of dimension {n_free}", curve, orbit)

    def _free_steps(self, state: Array, kernel: Array) -> Array:
        """Directions of the kernel of the second variation in which a family goes on, shape (N, n).

        None where families cross: from there more directions lead along one of them than any has.
        """
        if not kernel.shape[1]:
            return kernel
        size = float(norm(state)) + self._fields.unit
        far, near = (self._followed_by_steps(state, kernel, part * size) for part in _SHORT)
        if far is None or near is None:
            return kernel[:, :0]
        if far.shape[1]:  # a step may also lead to another family that is near
            return min(far, near, key=lambda found: found.shape[1])
        # round a small circle short steps lead on, and where H is only flat they soon do not
        leads = [self._leads_on(state, _SHORT[1] * size * v) for v in near.T]
        return near[:, np.flatnonzero(leads)]

    def _followed_by_steps(self, state: Array, kernel: Array, step: float) -> Array | None:
        """Directions of the kernel in which a step leads along a family; None if more do so than a family has."""
        moved = [self._beside(state, step * v) for v in kernel.T]
        steps = np.array([m - state for m in moved]) / step
        _, lengths, along = linear.svd(linear.matmul(steps, kernel))
        n_along = int((lengths > _ALONG).sum())
        there = [m for m, s in zip(moved, steps, strict=True) if norm(s) > _ALONG]
        n_null = min((null_directions(self._leaf, self._fields, m).shape[1] for m in there), default=0)
        return linear.matmul(kernel, along[:n_along].T) if n_along <= n_null else None

    def _leads_on(self, x: Array, step: Array) -> bool:
        """Whether steps of this length lead on along a family, as far as a long one."""
        length = float(norm(step))
        for _ in range(round(_SHORT[0] / _SHORT[1])):
            moved = self._beside(x, step)
            way = moved - x
            if norm(way) <= _ALONG * length:
                return False
            x, step = moved, length * way / norm(way)
        return True

    def _beside(self, state: Array, step: Array) -> Array:
        """The state of the family of this one to which a step leads; the state itself if it leads to none.

        Where Newton's method comes to rest after the step there need be no critical point, and it is led on, perhaps
        back to this state; one that is far off is another one.
        """
        length, rest = float(norm(step)), self._corrected(state + step)
        if rest is None or norm(rest - state - step) >= _CORRECTED * length or not self._are_level(state, rest):
            return state
        zero = self._corrected(state + step, is_sure=False)
        if zero is None or norm(zero - state) <= _ASIDE * length:
            return state
        return zero if norm(zero - rest) <= _ASIDE * length else rest

    def _kept(self, carried: Array) -> Array | None:
        """A relative equilibrium that the motion of an integral has carried on, free of the error made on the way."""
        if residuals(self._leaf, self._fields, carried[None], self._values)[0] <= _CARRIED:
            return carried
        moved = self._corrected(carried)
        size = float(norm(carried)) + self._fields.unit
        return None if moved is None or norm(moved - carried) > _SAME * size else moved

    def _is_connected(self, family: _Family, goal: Array) -> bool:
        """Whether a path of critical points leads from the family to the goal; if not, none was found."""
        if family.kind == "degenerate":  # none leads away from it
            return False
        if family.orbit is not None:
            return family.orbit.contains(goal, _SAME)
        states = family.states if family.curve is None else family.curve
        distances = norm(np.asarray(states) - goal, axis=1)
        if family.curve is not None and distances.min() > 2 * _STEP * (float(norm(goal)) + self._fields.unit):
            return False
        return self._walk(states[int(np.argmin(distances))], goal)

    def _walk(self, x: Array, goal: Array) -> bool:
        """Steps towards the goal in the null directions, each corrected by Newton's method."""
        size, kicks = float(norm(goal)) + self._fields.unit, 0
        for _ in range(_MOST_STEPS):
            way = goal - x
            distance = float(norm(way))
            if distance <= _SAME * size:
                return True
            directions = null_directions(self._leaf, self._fields, x)
            step = linear.matmul(directions, linear.matmul(directions.T, way))
            length = float(norm(step))
            if length < 0.05 * distance:
                kicks += 1
                if kicks > _KICKS or directions.shape[1] < 2:
                    return False
                step = linear.matmul(directions, self._kicks.standard_normal(directions.shape[1]))
                length = float(norm(step)) * 10
            step *= min(1.0, _STEP * size / max(length, np.finfo(float).tiny))
            moved = self._followed(x, step)
            if moved is None:
                return False
            x = moved
        return False

    def _followed(self, x: Array, step: Array) -> Array | None:
        """The state of the family after a step, or after a part of it where the whole may lead to another family.

        A step of the length d along a curve with the radius R is corrected by $d^2/(2R)$. If it is corrected by more
        than a small part of d, a shorter one is taken; where none is short enough, the whole one.
        """
        whole = None
        for part in _PARTS:
            there = self._stepped(x, part * step)
            moved = self._corrected(there)
            if moved is not None and norm(moved - there) <= _BENT * part * norm(step):
                return moved
            whole = moved if part == 1 else whole
        return whole

    def _stepped(self, x: Array, step: Array) -> Array:
        """The state after a step along a family; as far as it is a motion of integrals, this carries the state."""
        turning = symmetry_directions(self._leaf, self._fields, x)
        part = linear.matmul(turning, linear.matmul(turning.T, step))
        if not norm(part) > VANISHES * norm(step):
            return x + step
        motion = Motion.with_velocity(self._leaf, self._fields, x, part)
        return motion.carried(x, min(1.0, motion.longest_step(x))) + step - part

    def _round(self, begin: Array, before: Array) -> Array | None:
        """States all along the curve through this one, or None if it was not seen to close."""
        size, x = float(norm(begin)) + self._fields.unit, begin
        curve = [begin]
        for _ in range(4 * _MOST_STEPS):
            directions = null_directions(self._leaf, self._fields, x)
            along = linear.matmul(directions, linear.matmul(directions.T, before))
            length = float(norm(along))
            if length < 0.3:
                return None
            moved = self._followed(x, _STEP * size * along / length)
            if moved is None:
                return None
            curve.append(moved)
            if len(curve) > 3 and norm(moved - begin) < 0.7 * norm(moved - x):
                return np.array(curve)
            way = moved - x  # its part along soft directions, which lead nowhere, was undone
            if not way.any():
                return None
            x, before = moved, way / norm(way)
        return None

    def _corrected(self, guess: Array, *, is_sure: bool = True) -> Array | None:
        """The critical point near a guess; near a degenerate one, few steps of Newton's method do, or all are slow."""
        for most_steps in (_FEW_STEPS, MOST_STEPS):
            states, _ = self._reached(self._leaf, guess[None], most_steps, is_sure=is_sure)
            if len(states):
                return states[int(np.argmin(norm(states - guess, axis=1)))]
        checkpoint("following a family of equilibria")
        return None


def _distance(family: _Family, state: Array) -> float:
    states = family.states if family.curve is None else family.curve
    return float(norm(np.asarray(states) - state, axis=1).min())


def is_critical(
    fields: HamiltonianFields, leaf: LeafInUnits, states: Array, residual: Array, within: float = FOUND
) -> NDArray[np.bool_]:
    """Which states are critical points inside the leaf, and not limits on its edge, where J is smaller."""
    rank = leaf.rank
    if not len(states) or not rank:
        return residual <= within
    if not (defined := fields.are_defined(states)).all():
        defined[defined] = is_critical(fields, leaf, states[defined], residual[defined], within)
        return defined
    vectors, sizes, _ = linear.svd(fields.poisson(states))
    own = linear.svd(fields.poisson(leaf.state), compute_uv=False)
    length, lengths = float(norm(leaf.state)) + fields.unit, norm(states, axis=1) + fields.unit
    inside = sizes[:, rank - 1] * length > _EDGE * own[rank - 1] * lengths
    gradients = np.stack([f.gradient(states) for f in fields.functions], axis=-1)
    slopes = linear.matmul(np.swapaxes(vectors[..., :rank], 1, 2), gradients)
    curvature = norm(fields.functions[0].hessian(states), axis=(1, 2)) * lengths
    scale = curvature + norm(gradients[..., 0], axis=1)
    left = np.array([_unexplained(s) for s in slopes])
    return (residual <= within) & inside & (left <= max(_CRITICAL, within) * np.where(scale > 0, scale, 1.0))


def _unexplained(slopes: Array) -> float:
    """What the slopes of the integrals leave of that of H."""
    others = slopes[:, 1:]
    lengths = norm(others, axis=0)
    others = others[:, lengths > 0] / lengths[lengths > 0]
    return float(norm(slopes[:, 0] - linear.matmul(others, linear.lstsq(others, slopes[:, 0])[0])))
