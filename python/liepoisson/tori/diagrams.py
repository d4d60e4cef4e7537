r"""The bifurcation diagram of an integrable system of two degrees of freedom on a leaf: its critical values, as curves.

Critical states of rank 1 are orbits of the flows in one-parameter families.  They are found from random states
(`liepoisson.tori.critical_search`) and followed: the derivatives of the equations for $(x, \lambda)$ have a null vector
along the orbit and one across it, along the family, which is the direction of the next step.  States of rank 0 are
equilibria of both flows; families leave them along their elliptic and hyperbolic planes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_number, as_positive, as_seed, as_time_limit
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import Deadline, checkpoint
from liepoisson.inputs.refusals import check_kind
from liepoisson.leaf.leaf import Leaf
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import linear
from liepoisson.tori.critical_search import Critical, momentum_of
from liepoisson.tori.momentum_maps import MomentumMap

if TYPE_CHECKING:
    from liepoisson.model.system import System

_STEP, _LEAST = 0.05, 1e-4
"""The longest and the shortest step along a family, in units of the leaf and of the weights."""
_TURN = 0.98
"""Cosine of the angle by which a family may turn in a step."""
_MOST_POINTS = 4000
_SAME = 1e-9
"""Values that differ by less, relative to the figure, are the same."""
_REST = 1e-3
"""Fields of this length, relative to typical ones, are near to rank 0."""


@dataclass(frozen=True, eq=False)
class CriticalFamily(ReadOnlyArrays):
    """Critical values of one type along a curve.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> family = lp.tori.diagram(leaf, energy_max=2).families[0]
        >>> family.type, family.states.shape == (len(family.values), 6)
        ('elliptic', True)

    Attributes:
        type: "elliptic", "hyperbolic" or "degenerate".
        values: Shape (point, 2).
        states: A critical state for each, shape (point, N).
    """

    type: str
    values: Array
    states: Array

    def __repr__(self) -> str:
        return f"<{self.type} family of {len(self.values)} values>"


@dataclass(frozen=True, eq=False)
class Diagram(SavedWhole):
    r"""Critical values of a momentum map with two integrals.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> found = lp.tori.diagram(leaf, energy_max=2)
        >>> sorted({family.type for family in found.families}), sorted(found.rest_types)
        (['elliptic'], ['elliptic, elliptic', 'focus-focus'])

    Attributes:
        momentum: The momentum map.
        leaf: The leaf.
        families: Curves of rank 1.
        rest_states: States of rank 0, shape (point, N).
        rest_values: Their values, shape (point, 2).
        rest_types: Their types.
        energy_max: The energy up to which families were followed.
    """

    kind = "diagram"
    row = "value"

    momentum: MomentumMap
    leaf: Leaf
    families: tuple[CriticalFamily, ...]
    rest_states: Array
    rest_values: Array
    rest_types: tuple[str, ...]
    energy_max: float

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.leaf.system

    def __len__(self) -> int:
        """How many critical values it has."""
        return sum(len(one.values) for one in self.families) + len(self.rest_types)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each critical value its curve (-1 for an equilibrium), type and values."""
        values = np.concatenate([*(one.values for one in self.families), self.rest_values])
        lengths = [*(len(one.values) for one in self.families), *(1 for _ in self.rest_types)]
        curves = [*range(len(self.families)), *(-1 for _ in self.rest_types)]
        types = [*(one.type for one in self.families), *self.rest_types]
        rows: dict[str, NDArray[Any]] = {"curve": np.repeat(np.array(curves, dtype=np.intp), lengths)}
        rows["type"] = np.repeat(np.array(types, dtype=np.str_), lengths)
        return rows | dict(zip(self.momentum.names, values.T, strict=True))

    def __repr__(self) -> str:
        return (
            f"<Diagram of ({', '.join(self.momentum.names)}) of {self.leaf.system.name!r}: {len(self.families)} "
            f"families, {len(self.rest_states)} equilibria>"
        )


@explains_its_arguments
def diagram(
    leaf: Leaf,
    *,
    momentum: MomentumMap | None = None,
    energy_max: float | None = None,
    n_starts: int = 200,
    spread: float = 1.5,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
) -> Diagram:
    r"""The critical values of a system with two commuting integrals on a leaf.

    Families are followed from equilibria of both flows and from random states.  One that comes to no equilibrium and
    that no start comes to is not in it.  Where the energy has no lower bound they are followed as far below the lowest
    energy of the random states as the highest one is above it.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> found = lp.tori.diagram(leaf, energy_max=2)
        >>> found.rest_values.round(9).tolist()  # hanging and upright
        [[-1.0, 0.0], [1.0, 0.0]]

    Args:
        leaf: A leaf of dimension 4.
        momentum: The momentum map; by default that of the known integrals of the system.
        energy_max: Families are followed up to this energy; by default the highest one of the random states.
        n_starts: Number of starts.
        spread: Standard deviation of the random states, in units of the leaf.
        seed: Draws the random states.
        time_limit: Seconds that the call may take.

    Raises:
        ParameterError: there are not two integrals.
        LeafError: the equations of the leaf are not known.
        TimeLimitError: the time is over.
    """
    deadline = Deadline(as_time_limit(time_limit))
    check_kind(leaf, Leaf, "leaf", "a Leaf", "make it by lp.Leaf(system, {...})")
    momentum = momentum_of(leaf, momentum)
    if len(momentum.names) != 2:
        raise ParameterError(
            f"leaf: wanted one of dimension 4, with two integrals; got {', '.join(momentum.names)}. Take "
            "lagrange_diagram for the twisted Lagrange top, critical_states for others."
        )
    n = as_count(n_starts, "n_starts")
    width = as_positive(spread, "spread", "a positive number", example=1)
    with deadline.running(), np.errstate(all="ignore"):
        critical = Critical.on(leaf, momentum)
        starts, weights = critical.starts(n, width, as_seed(seed))
        energies = momentum.integrals["H"](starts * critical.units)
        top = float(energies.max()) if energy_max is None else as_number(energy_max, "energy_max", "a number")
        rest = critical.resting(starts)
        lowest = momentum.integrals["H"](rest * critical.units).min(initial=2 * energies.min() - energies.max())
        search = _Families(critical, float(lowest), top)
        families = search.families(rest, *critical.solved(starts, weights))
    states = rest * critical.units
    return Diagram(
        momentum,
        leaf,
        tuple(families),
        states,
        momentum(states),
        tuple(map(str, critical.kinds(rest)[1])),
        top,
    )


class _Families:
    """Families of critical states between two energies."""

    def __init__(self, critical: Critical, energy_min: float, energy_max: float) -> None:
        self.critical = critical
        self.energy_min, self.energy_max = energy_min, energy_max

    def families(self, rest: Array, x: Array, weights: Array) -> list[CriticalFamily]:
        """Followed from equilibria, and from starts that are on none yet."""
        critical = self.critical
        near = self._near(rest)
        x, weights = np.concatenate([near[0], x]), np.concatenate([near[1], weights])
        values = critical.momentum(x * critical.units)
        ranks, types = critical.kinds(x)
        wanted = (ranks == 1) & (values[:, 0] >= self.energy_min) & (values[:, 0] <= self.energy_max)
        size = np.ptp(values[wanted], axis=0) if wanted.any() else np.ones(2)
        size = np.where(size > 0, size, 1.0)
        found = list[CriticalFamily]()

        def share_known(values: Array, kind: str) -> float:
            curves = [one.values / size for one in found if one.type == kind]
            on = np.zeros(len(values), dtype=bool)
            for curve in curves:
                on |= are_on(values / size, curve)
            return float(on.mean())

        for k in np.flatnonzero(wanted):
            if share_known(values[k, None], str(types[k])) == 1:
                continue
            for family in self._by_type(self._both_ways(x[k], weights[k])):
                if share_known(family.values, family.type) < 0.5:
                    found.append(family)
        return found

    def _near(self, rest: Array) -> tuple[Array, Array]:
        """Critical states near to equilibria on the families that leave them; of twins with one value, of one."""
        critical = self.critical
        values, types = critical.momentum(rest * critical.units), critical.kinds(rest)[1]
        guesses = [np.zeros((0, rest.shape[1]))]
        for k in range(len(rest)):
            twins = linear.norm(values[:k] - values[k], axis=1) <= _SAME * (1 + linear.norm(values[k]))
            if not (twins & (types[:k] == types[k])).any():
                guesses.append(rest[k] + _STEP * critical.leaving(rest[k]))
        x = np.concatenate(guesses)
        return critical.solved(x, linear.svd(critical.fields(x))[2][:, -1]) if len(x) else (x, x[:, :2])

    def _both_ways(self, x: Array, weights: Array) -> Array:
        back, is_closed = self._followed(x, weights, -1)
        if is_closed:
            return back
        return np.concatenate([back[:0:-1], self._followed(x, weights, 1)[0]])

    def _followed(self, x: Array, weights: Array, sign: int) -> tuple[Array, bool]:
        """States along a family to where it ends, and whether it closes."""
        critical, n = self.critical, len(x)
        here = np.concatenate([x, weights])
        direction = self._direction(here, None)
        if direction is None:
            return x[None], False
        direction, step = sign * direction, _STEP / 4
        points, values = [here], [critical.momentum(x * critical.units)]
        while len(points) < _MOST_POINTS and step > _LEAST:
            checkpoint("following critical states")
            guess = here + step * direction
            y, v = critical.solved(guess[None, :n], guess[None, n:], 8)
            there = np.concatenate([y[0], v[0]]) if len(y) else guess
            ahead = self._direction(there, direction) if len(y) else None
            if ahead is None or (ahead * direction).sum() < _TURN or linear.norm(there - guess) > step:
                step /= 2
                continue
            points.append(there)
            values.append(critical.momentum(there[:n] * critical.units))
            # Beyond a state of rank 0 the orbits are the same, with the other phase
            energy = values[-1][0]
            if not self.energy_min <= energy <= self.energy_max or (self._orbit(here) * self._orbit(there)).sum() < 0:
                break
            last, first = values[-1] - values[-2], values[1] - values[0]
            if len(points) > 8 and (last * first).sum() > 0 and linear.norm(values[-1] - values[0]) < linear.norm(last):
                return np.array([*points, points[0]])[:, :n], True
            here, direction, step = there, ahead, min(1.5 * step, _STEP)
        return np.array(points)[:, :n], False

    def _orbit(self, place: Array) -> Array:
        """The flow along the critical orbit: that of the function whose weights are orthogonal to lambda."""
        n = len(self.critical.units)
        weights = np.array([-place[n + 1], place[n]])
        return linear.matmul(self.critical.fields(place[None, :n])[0], weights)

    def _direction(self, place: Array, like: Array | None) -> Array | None:
        """The unit vector along the family, across the orbit; None near to rank 0 and where it is not unique."""
        n = len(self.critical.units)
        x, weights = place[None, :n], place[None, n:]
        fields = self.critical.fields(x)[0]
        if linear.norm(fields, axis=0).max() < _REST:
            return None
        sizes, vectors = linear.svd(self.critical.jacobian(x, weights)[0])[1:]
        orbit = np.append(linear.svd(fields)[0][:, 0], np.zeros(len(place) - n))
        null = vectors[(len(place) - 2) :]
        if len(sizes) >= len(place) - 2 and sizes[len(place) - 3] < 1e-6 * sizes[0]:
            return None
        # Of the two null vectors the combination that is orthogonal to the orbit
        shares = linear.matmul(null, orbit)
        across = shares[1] * null[0] - shares[0] * null[1]
        across = across / linear.norm(across)
        return across if like is None or (across * like).sum() > 0 else -across

    def _by_type(self, points: Array) -> list[CriticalFamily]:
        critical = self.critical
        _, types = critical.kinds(points)
        states = points * critical.units
        values = critical.momentum(states)
        found, begin = list[CriticalFamily](), 0
        for k in range(1, len(points) + 1):
            if k == len(points) or types[k] != types[begin]:
                stop = min(k + 1, len(points))  # both share the place where the type changes
                if stop - begin > 1 and types[begin] not in {"degenerate", "regular"}:
                    found.append(CriticalFamily(str(types[begin]), values[begin:stop], states[begin:stop]))
                begin = k
        return found


def are_on(values: Array, curve: Array) -> NDArray[np.bool_]:
    """Which values are on a curve, nearer to a segment than the curve bends there; shape (m,)."""
    bends = apart(curve[1:-1], curve[:-2], curve[2:])
    bends = np.pad(bends, 1, mode="edge") if len(bends) else np.zeros(2)
    near = apart(values[:, None], curve[:-1], curve[1:]) <= np.maximum(bends[:-1], bends[1:]) + _SAME
    return np.asarray(near.any(axis=1))


def apart(values: Array, begins: Array, ends: Array) -> Array:
    """The distances of values from segments."""
    along, offset = ends - begins, values - begins
    square = (along**2).sum(axis=-1)
    share = np.clip((offset * along).sum(axis=-1) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    return linear.norm(offset - share[..., None] * along, axis=-1)
