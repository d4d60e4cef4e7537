r"""The search for critical points of H on a leaf from random starts, and the families that symmetries make of them.

An end of the search is listed as an equilibrium where it is known that there is one, and one only but for those to
which the known integrals of the system carry it (`liepoisson.equilibrium.second_variation`). Ends at the same one are
told by the distance within which it is the only one. Other ends are listed as "undecided".
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.critical_points import (
    VANISHES,
    CriticalEquations,
    HamiltonianFields,
    critical_points,
    finished,
)
from liepoisson.equilibrium.equilibrium_list import signed_sum
from liepoisson.equilibrium.second_variation import Accuracy, Symmetries, n_independent
from liepoisson.equilibrium.stability import Equilibrium, judged
from liepoisson.errors import TimeLimitError
from liepoisson.inputs.arrays import Array, norm
from liepoisson.inputs.deadline import blocks, has_passed
from liepoisson.leaf.leaf_search import representative
from liepoisson.numeric.systems import periods_of_components
from liepoisson.portable import elementary, linear
from liepoisson.streams import Purpose, stream

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.model.phase_functions import PhaseFunction

_EDGE = 1e-6
"""A state is on the edge of its leaf, where J has a lower rank, if the last singular value of J, relative to the length
of the state, is below this fraction of that at the leaf's own state. It is larger than `VANISHES`: a Toda lattice
at the edge, where its leaf ends without an equilibrium, has a slope of the order of this value."""


@dataclass(eq=False)
class _Row:
    """An equilibrium with the family that symmetries make of it, or a place that is undecided.

    Attributes:
        first: The equilibrium.
        state: Its state, in the units of the leaf, and so are `states`.
        how: How well it is known.
        kind: What the family is.
        states: States of the orbit: all along it if it is closed, else those that were found.
        n_found: How many starts came here.
    """

    first: Equilibrium
    state: Array
    how: Accuracy
    kind: str
    states: list[Array] = field(default_factory=list[Array])
    n_found: int = 1

    def counted(self) -> Equilibrium:
        return replace(self.first, n_found=self.n_found, family=self.kind)


_BEFORE = 0.45
"""Part of the turn of an angle that is below zero."""


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
        self._itself, self._integrals = leaf, integrals
        self._origin = representative(leaf).in_units()
        self._leaf = replace(leaf.in_units(), units=self._origin.units)
        functions = self._leaf.system.functions
        self._fields = HamiltonianFields(self._leaf.system, [functions.energy, *map(functions.of, integrals.values())])
        self._equations = CriticalEquations(self._leaf, self._fields, values)
        self._rng = stream(seed, Purpose.EQUILIBRIA)
        self._rows: list[_Row] = []
        self.n_starts = 0
        self.is_cut_short = False

    @cached_property
    def _symmetries(self) -> Symmetries:
        return Symmetries.of(self._leaf, self._fields)

    @property
    def found(self) -> list[Equilibrium]:
        """What was found so far, by increasing energy."""
        return sorted((row.counted() for row in self._rows), key=lambda e: e.energy)

    def signed_sum(self) -> int | None:
        """The sum of the signs; None where the share of one is not known."""
        return signed_sum(self.found)

    def extend(self, n_starts: int) -> None:
        """Search from this many starts more."""
        origin = self._origin.state
        size = (float(norm(origin)) + self._fields.unit) / np.sqrt(len(origin)) or 1.0
        for n in blocks(n_starts):
            starts = self._rng.standard_normal((n, len(origin))) * size
            starts *= elementary.exp(self._rng.uniform(elementary.log(0.2), elementary.log(5.0), (n, 1)))
            self.n_starts += n
            self._add_from(starts)
        self.is_cut_short |= has_passed()

    def add_from(self, starts: Array) -> None:
        """Search from these states, and add what they lead to."""
        self._add_from(starts / self._leaf.units)

    def until_the_sum_is(self, expected: int | None, most_starts: int) -> None:
        """Twice as many starts each time, while the sum of the signs is known and not this number."""
        while expected is not None and self.signed_sum() not in {None, expected} and self._goes_on(most_starts):
            self.extend(min(self.n_starts, most_starts - self.n_starts))

    def until_all_were_met_again(self, most_starts: int) -> None:
        """Twice as many starts each time, while an equilibrium was met once only.

        The share of starts that lead to equilibria not met yet is about the number of those met once, divided by that
        of the starts (Good 1953).
        """
        while any(row.n_found == 1 and row.how.is_known for row in self._rows) and self._goes_on(most_starts):
            self.extend(min(self.n_starts, most_starts - self.n_starts))

    def _goes_on(self, most_starts: int) -> bool:
        """Whether there are starts and time left."""
        return self.n_starts < most_starts and not self.is_cut_short

    @np.errstate(all="ignore")  # H may overflow; where it is not defined there is no critical point
    def _add_from(self, starts: Array) -> None:
        states, residual = critical_points(self._equations, starts)
        good = is_critical(self._equations, states, residual)
        states, residual = self._within_a_turn(states[good]), residual[good]
        for state in states[np.argsort(residual, kind="stable")]:
            if has_passed():
                break
            with suppress(TimeLimitError):  # whether it belongs to a family was not seen
                self._add(state)

    def _within_a_turn(self, states: Array) -> Array:
        """States with angles within one turn, which does not begin at pi, where angles by round-off would lie apart."""
        periods = periods_of_components(self._itself.system, states.shape[1]) / self._leaf.units
        turning = np.isfinite(periods)
        if not turning.any():
            return states
        within = states.copy()
        within[:, turning] -= periods[turning] * np.floor(states[:, turning] / periods[turning] + _BEFORE)
        return within

    def _add(self, state: Array) -> None:
        if (row := self._known_at(state)) is not None:
            row.n_found += 1
            return
        state = finished(self._equations, state)
        row = self._row(state)
        if row.how.is_known:
            self._insert(row)
            return
        if (rest := at_rest(self._equations, state)) is not None:
            resting = self._known_at(rest) or self._row(rest)
            if resting.how.is_known:
                self._insert(resting)
                if self._is_at(resting, state):
                    return
        for other in self._rows:
            if not other.how.is_known and self._is_one_place(other, row):
                other.n_found += 1
                return
        self._rows.append(row)

    def _insert(self, row: _Row) -> None:
        """Add an equilibrium that is known, with the undecided ends that turn out to be at it."""
        taken_in = [one for one in self._rows if not one.how.is_known and self._is_at(row, one.state)]
        row.n_found += sum(one.n_found for one in taken_in)
        self._rows = [one for one in self._rows if one is not row and one not in taken_in] + [row]

    def _known_at(self, state: Array) -> _Row | None:
        """The row of the known equilibrium, or family, at which a state is."""
        return next((row for row in self._rows if row.how.is_known and self._is_at(row, state)), None)

    def _row(self, state: Array) -> _Row:
        """A row for a state where none is known yet, and its family: an orbit of the symmetries."""
        one, how = judged(self._itself, self._integrals, self._equations, state)
        if one.family == "undecided":
            return _Row(one, state, how, one.family, [state])
        if not self._integrals and not one.nullity:
            return _Row(one, state, how, "point", [state])
        n = self._symmetries.combinations(state).shape[1]
        if one.nullity != (0 if self._integrals else n):
            return _Row(one, state, how, "degenerate", [state])
        if n:
            orbit = self._symmetries.closed(state, how.alone_within) if n == 1 else None
            kind = f"family of dimension {n}" if orbit is None else "circle"
            return _Row(one, state, how, kind, [state] if orbit is None else list(orbit))
        return _Row(one, state, how, "point", [state])

    def _is_at(self, row: _Row, state: Array) -> bool:
        """Whether a state is at the known equilibrium of a row, or on its family."""
        if not row.how.is_alone and self._n_regular(state) != row.how.n_regular:
            return False
        distances = norm(np.asarray(row.states) - state, axis=1)
        nearest = row.states[int(np.argmin(distances))]
        if distances.min() <= row.how.alone_within:
            return True
        if row.kind in {"point", "degenerate"} or not self._has_energy_of(row, state):
            return False
        if row.kind == "circle" and distances.min() > float(norm(np.asarray(row.states)[1] - row.states[0])):
            return False
        nearest = self._symmetries.nearest(nearest, state)
        if not norm(nearest - state) <= row.how.alone_within:
            return False
        if row.kind != "circle":
            row.states.append(state)
        return True

    def _is_one_place(self, row: _Row, other: _Row) -> bool:
        """Whether two undecided ends are at one place: their bounds overlap, or the equations hold between them."""
        if not self._has_energy_of(row, other.state):
            return False
        near = self._symmetries.nearest(row.state, other.state)
        if norm(near - other.state) <= row.how.distance + other.how.distance:
            return True
        between, is_possible = self._equations.projected((near + other.state)[None] / 2)
        left = self._equations.left(between)
        return bool((is_possible & is_critical(self._equations, between, left))[0])

    def _n_regular(self, state: Array) -> int:
        """How many of the vector fields of integrals are independent there."""
        return n_independent(self._fields.fields(state)[:, 1:], self._fields.scale(state)[1:])

    def _has_energy_of(self, row: _Row, state: Array) -> bool:
        """Whether a state has the energy of a row, which is constant on a family."""
        energy = self._leaf.system.functions.energy
        length = float(norm(state)) + self._fields.unit
        slope = float(norm(energy.gradient(state))) * length  # zero where H is critical off the leaf, too
        slope += float(norm(energy.hessian(state))) * length**2
        return abs(row.first.energy - float(energy(state))) <= VANISHES * slope


def at_rest(equations: CriticalEquations, state: Array) -> Array | None:
    """A relative equilibrium near a state at which the motions of the integrals are at rest; None if there is none.

    Their level set is not regular there, and the equations at all states nearby are nearly singular. It is a critical
    point of H alone.
    """
    if not len(equations.values):
        return None
    leaf, fields = equations.leaf, equations.fields
    alone = CriticalEquations(leaf, HamiltonianFields(leaf.system, fields.functions[:1]), np.zeros(0))
    found, _ = critical_points(alone, state[None])
    if not len(found):
        return None
    rest = finished(alone, found[0])
    return rest if is_critical(equations, rest[None], equations.left(rest[None]))[0] else None


def is_critical(equations: CriticalEquations, states: Array, residual: Array) -> NDArray[np.bool_]:
    """Which states are critical points inside the leaf, as far as residuals tell, and not limits on its edge."""
    fields, leaf = equations.fields, equations.leaf
    rank = leaf.rank
    if not len(states) or not rank:
        return residual <= VANISHES
    if not (defined := fields.are_defined(states)).all():
        defined[defined] = is_critical(equations, states[defined], residual[defined])
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
    return (residual <= VANISHES) & inside & (left <= VANISHES * np.where(scale > 0, scale, 1.0))


def _unexplained(slopes: Array) -> float:
    """What the slopes of the integrals leave of that of H."""
    others = slopes[:, 1:]
    lengths = norm(others, axis=0)
    others = others[:, lengths > 0] / lengths[lengths > 0]
    return float(norm(slopes[:, 0] - linear.matmul(others, linear.lstsq(others, slopes[:, 0])[0])))
