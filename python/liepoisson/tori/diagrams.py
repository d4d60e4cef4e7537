r"""The bifurcation diagram of an integrable system on a leaf, in a plane: its critical values, as curves.

Of two integrals it is all of it, of three the slice where one of them has a value.  Critical states of one less than
the full rank are orbits of the flows in families, with one parameter in the plane.  They are found from random states
(`liepoisson.tori.critical_search`) and followed: the derivatives of the equations for $(x, \lambda)$ have null vectors
along the orbit and one across it, along the family, which is the direction of the next step.  States of two less than
the full rank are points of the plane: equilibria of both flows; in a slice relative equilibria, whose flows are all
along one orbit, where an edge or a thread of the diagram of three integrals crosses the plane.  Families leave them
along their elliptic and hyperbolic planes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_finite, as_positive, as_seed, as_time_limit
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import Deadline, checkpoint
from liepoisson.inputs.given import by_name
from liepoisson.inputs.refusals import check_choice, check_kind, counted
from liepoisson.io.tables import beside
from liepoisson.leaf.leaf import Leaf
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import linear
from liepoisson.tori.critical_search import Critical, check_resolved, momentum_of
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
_DOUBLE = 1e-5
"""A double root is nearer than this: Newton's method ends at residuals of 1e-12, whose root is 1e-6."""
_NEW = 0.02
"""Where half of a family is known, the rest is new if it is longer than this, relative to the figure."""
_SAME_HEIGHT = 1e-3
"""Families begin up to 1e-4 of the median height of random states beside the equilibria that they leave (catalog)."""
_REST = 1e-3
"""Fields that are dependent but for this length, relative to typical ones, are near to lower rank."""


@dataclass(frozen=True, eq=False)
class CriticalFamily(ReadOnlyArrays):
    """Critical values of one type along a curve.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> family = lp.tori.diagram(leaf, energy_max=2).families[0]
        >>> family.type, family.states.shape == (len(family.values), 6)
        ('elliptic', True)

    Attributes:
        type: "elliptic" or "hyperbolic"; parts that are degenerate are in no family.
        values: Those of the two integrals of the plane, shape (point, 2).
        states: A critical state for each, shape (point, N).
    """

    type: str
    values: Array
    states: Array

    def __repr__(self) -> str:
        return f"<{self.type} family of {len(self.values)} values>"


@dataclass(frozen=True, eq=False)
class Diagram(SavedWhole):
    r"""Critical values of a momentum map with two integrals, or in a slice of one with three.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> found = lp.tori.diagram(leaf, energy_max=2)
        >>> sorted({family.type for family in found.families}), sorted(found.rest_types)
        (['elliptic'], ['elliptic, elliptic', 'focus-focus'])

    Attributes:
        momentum: The momentum map.
        leaf: The leaf.
        families: Curves of one less than the full rank.
        rest_states: States of two less, shape (point, N): equilibria; in a slice relative ones, of rank 1.
        rest_values: Their values, shape (point, 2).
        rest_types: Their types.
        energy_max: The energy up to which families were followed.
        at: The value of the integral that is held in a slice, by its name; else empty.
        degenerate_values: Values at degenerate states of one less than the full rank that are on no curve, shape
            (point, 2).  Families of them are not followed: where there are such values curves are missing.
    """

    kind = "diagram"
    made_by = "lp.tori.diagram"
    row = "value"

    momentum: MomentumMap
    leaf: Leaf
    families: tuple[CriticalFamily, ...]
    rest_states: Array
    rest_values: Array
    rest_types: tuple[str, ...]
    energy_max: float
    at: dict[str, float] = field(default_factory=dict)
    degenerate_values: Array = field(default_factory=lambda: np.zeros((0, 2)))

    @property
    def names(self) -> tuple[str, str]:
        """The names of the two integrals of the plane."""
        one, other = (name for name in self.momentum.names if name not in self.at)
        return one, other

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.leaf.system

    def __len__(self) -> int:
        """How many critical values it has."""
        return sum(len(one.values) for one in self.families) + len(self.rest_types) + len(self.degenerate_values)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each critical value its curve (-1 if it is on none), type and values."""
        single = [*self.rest_types, *("degenerate" for _ in self.degenerate_values)]
        values = np.concatenate([*(one.values for one in self.families), self.rest_values, self.degenerate_values])
        lengths = [*(len(one.values) for one in self.families), *(1 for _ in single)]
        curves = [*range(len(self.families)), *(-1 for _ in single)]
        types = [*(one.type for one in self.families), *single]
        rows: dict[str, NDArray[Any]] = {"curve": np.repeat(np.array(curves, dtype=np.intp), lengths)}
        rows["type"] = np.repeat(np.array(types, dtype=np.str_), lengths)
        return beside(rows, self.names, values)

    def _missing(self) -> str:
        n = len(self.degenerate_values)
        return f"; curves are missing through {counted(n, 'degenerate value')}" if n else ""

    def __repr__(self) -> str:
        held = "".join(f" at {name} = {value:g}" for name, value in self.at.items())
        return (
            f"<Diagram of ({', '.join(self.names)}){held} of {self.leaf.system.name!r}: {len(self.families)} "
            f"families, {len(self.rest_states)} {'relative ' if held else ''}equilibria{self._missing()}>"
        )


@explains_its_arguments
def diagram(
    leaf: Leaf,
    *,
    at: Mapping[str, float] | None = None,
    momentum: MomentumMap | None = None,
    energy_max: float | None = None,
    n_starts: int = 200,
    spread: float = 1.5,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
) -> Diagram:
    r"""The critical values of a system with two commuting integrals on a leaf; of three, where one of them has a value.

    Families are followed from equilibria of both flows and from random states.  One that comes to no equilibrium and
    that no start comes to is not in it.  Families of degenerate states are not followed, such as all states where F = 0
    if the integral is F^2: their values are `degenerate_values`.  Families whose energy has no lower bound are shown as
    far below the lowest equilibrium, or minimum along another family, as `energy_max` is above it.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> found = lp.tori.diagram(leaf, energy_max=2)
        >>> found.rest_values.round(9).tolist()  # hanging and upright
        [[-1.0, 0.0], [1.0, 0.0]]
        >>> leaf = lp.Leaf(lp.Top.twisted_lagrange(), {"C1": 8, "C2": 1, "C3": 1})
        >>> found = lp.tori.diagram(leaf, at={"l3": 0.3}, energy_max=0, n_starts=20)
        >>> found.names, found.rest_types
        (('H', 'P'), ('elliptic, elliptic',))

    Args:
        leaf: A leaf of dimension 4, or of dimension 6 with `at`.
        at: One of three integrals by its name, with the value that it keeps.
        momentum: The momentum map; by default that of the known integrals of the system.
        energy_max: Families are followed up to this energy; by default twice as high above the lowest equilibrium, or
            minimum of a family, as the highest of these is, but not beyond the random states.
        n_starts: Number of starts.
        spread: Standard deviation of the random states, in units of the leaf.
        seed: Draws the random states.
        time_limit: Seconds that the call may take.

    Raises:
        ParameterError: there are not two integrals beside the one that is held, it has no such value, or no random
            state comes to the leaf and to it.
        LeafError: the equations of the leaf are not known.
        TimeLimitError: the time is over.
    """
    deadline = Deadline(as_time_limit(time_limit))
    check_kind(leaf, Leaf, "leaf", "a Leaf", "make it by lp.Leaf(system, {...})")
    momentum = momentum_of(leaf, momentum)
    held = _held({} if at is None else by_name(at, "at", "numbers", 'at={"l3": 0.3}'), momentum)
    if "H" in held and energy_max is not None:
        raise ParameterError("energy_max: at holds H, so that all states have one energy. Leave one of them out.")
    n = as_count(n_starts, "n_starts", least=1)
    highest = None if energy_max is None else as_finite(energy_max, "energy_max")
    width = as_positive(spread, "spread", "a positive number", example=1)
    with deadline.running(), np.errstate(all="ignore"):
        check_resolved(leaf, momentum)
        critical = Critical.on(leaf, momentum, held)
        starts, weights = (critical.starts_held if held else critical.starts)(n, width, as_seed(seed))
        energies = momentum.integrals["H"](starts * critical.units)
        is_level = "H" in held
        top = np.inf if is_level else float(energies.max()) if highest is None else highest
        rest = critical.doubly_critical(starts) if held else critical.resting(starts)
        lowest = momentum.integrals["H"](rest * critical.units).min(initial=2 * energies.min() - energies.max())
        search = _Families(critical, held, -np.inf if is_level else float(lowest), top)
        rest, critical_starts = search.each_once(rest) if held else rest, critical.solved(starts, weights)
        families = search.families(rest, *critical_starts)
        if held:  # families may end at states that no start came to, and others leave these
            ends = [family.states[k] / critical.units for family in families for k in (0, -1)]
            more = critical.doubly_critical(np.array(ends).reshape(-1, len(critical.units)))
            several = search.each_once(np.concatenate([rest, more]))
            if len(several) > len(rest):
                rest, families = several, search.families(several, *critical_starts)
        if highest is None and not is_level:
            top = search.interesting(rest, families, energies)
        families = search.between(rest, families, top)
        degenerate = search.on_none(families, search.values(rest))
        degenerate = degenerate[degenerate[:, 0] <= top]
    states = rest * critical.units
    return Diagram(
        momentum,
        leaf,
        tuple(families),
        states,
        search.values(rest),
        tuple(map(str, critical.kinds(rest)[1])),
        held.get("H", top),
        held,
        degenerate,
    )


def _held(at: Mapping[object, object], momentum: MomentumMap) -> dict[str, float]:
    """The integral that is held, with its value.

    Raises:
        ParameterError: not two integrals are left, or it is none of them.
    """
    names = momentum.names
    for name in at:
        check_choice(name, "at", names)
    if len(names) - len(at) != 2:
        raise ParameterError(
            f"at: wanted two integrals that are left for the plane; of {', '.join(names)} {len(names) - len(at)} are. "
            + (
                f'Hold one of three, such as at={{"{names[1]}": 0.3}}.'
                if len(names) > 2
                else "Leave it out."
                if at
                else "Its leaves have no such diagram."
            )
        )
    return {str(name): as_finite(value, f"at[{str(name)!r}]") for name, value in at.items()}


class _Families:
    """Families of critical states between two energies, where some integrals are held."""

    def __init__(self, critical: Critical, held: Mapping[str, float], energy_min: float, energy_max: float) -> None:
        self.critical = critical
        self.energy_min, self.energy_max = energy_min, energy_max
        self.n = len(critical.momentum.names)
        self.degenerate = np.zeros((0, 2))
        self.free = [k for k, name in enumerate(critical.momentum.names) if name not in held]

    def values(self, x: Array) -> Array:
        """Values of the integrals that are not held, at states in units."""
        return self.critical.momentum(x * self.critical.units)[..., self.free]

    def is_within(self, x: Array) -> NDArray[np.bool_]:
        """Which states in units are between the energies."""
        energies = self.critical.momentum.integrals["H"](x * self.critical.units)
        return (energies >= self.energy_min) & (energies <= self.energy_max)

    def each_once(self, x: Array) -> Array:
        """States between the energies, one for each value and type; those at which all flows rest also by these."""
        x = np.concatenate([self.critical.resting(x), x])
        x = x[self.is_within(x)]
        (ranks, types), values, found = self.critical.kinds(x), self.values(x), list[int]()
        for k in range(len(x)):
            # Where more flows rest the equations have a double root: x is known to the root of the residual
            if (linear.norm(x[ranks < ranks[k]] - x[k], axis=1) < _DOUBLE).any():
                continue
            twins = linear.norm(values[found] - values[k], axis=1) <= _SAME * (1 + linear.norm(values[k]))
            if not (twins & (types[found] == types[k])).any():
                found.append(k)
        return x[found]

    def families(self, rest: Array, x: Array, weights: Array) -> list[CriticalFamily]:
        """Followed from equilibria, and from starts that are on none yet."""
        critical = self.critical
        near = self._near(rest)
        x, weights = np.concatenate([near[0], x]), np.concatenate([near[1], weights])
        values = self.values(x)
        ranks, types = critical.kinds(x)
        wanted = (ranks == self.n - 1) & self.is_within(x)
        size = np.ptp(values[wanted], axis=0) if wanted.any() else np.ones(2)
        size = np.where(size > 0, size, 1.0)
        found = list[CriticalFamily]()

        def are_new(values: Array, kind: str) -> NDArray[np.bool_]:
            """Which values are on no curve yet."""
            inside = (values[:, 0] >= self.energy_min) & (values[:, 0] <= self.energy_max)
            for curve in (one.values for one in found if one.type == kind):
                inside &= ~are_on(values / size, curve / size)
            return inside

        dropped = [values[wanted & (types == "degenerate")]]
        for k in np.flatnonzero(wanted):
            if not are_new(values[k, None], str(types[k])).any():
                continue
            parts, degenerate = self._parts(self._both_ways(x[k], weights[k]), size)
            dropped.append(degenerate)
            for family in parts:
                fresh = are_new(family.values, family.type)
                lengths = linear.norm(np.diff(family.values / size, axis=0), axis=1)
                if fresh.sum() > len(fresh) / 2 or lengths[fresh[1:] & fresh[:-1]].sum() > _NEW:
                    found.append(family)
        self.degenerate = np.concatenate(dropped)
        return found

    def on_none(self, found: list[CriticalFamily], rest: Array) -> Array:
        """Degenerate values that were met, but for those on curves, where types change, and of states of lower rank."""
        values = self.degenerate
        size = np.ptp(np.concatenate([values, *(one.values for one in found)]), axis=0) if len(values) else np.ones(2)
        size = np.where(size > 0, size, 1.0)
        for family in found:
            values = values[~are_on(values / size, family.values / size)]
        return values[apart(values[:, None] / size, rest / size, rest / size).min(axis=1, initial=np.inf) > _DOUBLE]

    def interesting(self, rest: Array, found: list[CriticalFamily], energies: Array) -> float:
        """The energy up to which there is something to see, given those of random states.

        Where a potential has a pole these reach far beyond all equilibria.  Where nothing but the lowest energy is
        told from others, it is that of half of the random states.
        """
        lowest = self._lowest(rest, found)
        if not lowest:
            return self.energy_max
        low = min(lowest)
        middle = float(np.median(energies)) - low
        height = 2 * (max(lowest) - low)
        return min(self.energy_max, low + (height if height > _SAME_HEIGHT * middle else max(middle, 0.0)))

    def _lowest(self, rest: Array, found: list[CriticalFamily]) -> list[float]:
        """The energies of equilibria, and the lowest ones of families that have one."""
        energies = [float(one.values[:, 0].min()) for one in found]
        equilibria = self.critical.momentum(rest * self.critical.units)[:, 0].tolist()
        return [energy for energy in energies if energy >= self.energy_min] + equilibria

    def between(self, rest: Array, found: list[CriticalFamily], top: float) -> list[CriticalFamily]:
        """The families up to an energy; those without a lowest one as far below the others as this is above."""
        lowest = self._lowest(rest, found)
        bound = 2 * min(lowest) - top if lowest else -np.inf
        result = list[CriticalFamily]()
        for one in found:
            inside = np.pad((one.values[:, 0] >= bound) & (one.values[:, 0] <= top), 1)
            keep = np.flatnonzero(inside[:-2] | inside[1:-1] | inside[2:])  # to the first point beyond
            for part in np.split(keep, np.flatnonzero(np.diff(keep) > 1) + 1):
                if len(part) > 1:
                    result.append(CriticalFamily(one.type, one.values[part], one.states[part]))
        return result

    def _near(self, rest: Array) -> tuple[Array, Array]:
        """Critical states near to equilibria on the families that leave them; of twins with one value, of one."""
        critical = self.critical
        values, types = self.values(rest), critical.kinds(rest)[1]
        guesses = [np.zeros((0, rest.shape[1]))]
        for k in range(len(rest)):
            twins = linear.norm(values[:k] - values[k], axis=1) <= _SAME * (1 + linear.norm(values[k]))
            if not (twins & (types[:k] == types[k])).any():
                guesses.append(rest[k] + _STEP * critical.leaving(rest[k]))
        x = np.concatenate(guesses)
        return critical.solved(x, linear.svd(critical.fields(x))[2][:, -1]) if len(x) else (x, x[:, : self.n])

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
        points, values = [here], [self.values(x)]
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
            values.append(self.values(there[:n]))
            if not self.is_within(there[:n]) or self._is_beyond(here, there):
                break
            last, first = values[-1] - values[-2], values[1] - values[0]
            if len(points) > 8 and (last * first).sum() > 0 and linear.norm(values[-1] - values[0]) < linear.norm(last):
                return np.array([*points, points[0]])[:, :n], True
            here, direction, step = there, ahead, min(1.5 * step, _STEP)
        return np.array(points)[:, :n], False

    def _is_beyond(self, here: Array, there: Array) -> bool:
        """Whether a state of lower rank lies between two: beyond it orbits are the same, with the other phase."""
        N = len(self.critical.units)
        along = linear.complement(here[N:, None] / linear.norm(here[N:]))
        one, other = (linear.matmul(self.critical.fields(place[None, :N])[0], along) for place in (here, there))
        return bool(linear.det(linear.matmul(one.T, other)) < 0)

    def _direction(self, place: Array, like: Array | None) -> Array | None:
        """The unit vector along the family, across the orbit; None near to lower rank and where it is not unique."""
        N, n = len(self.critical.units), self.n
        x, weights = place[None, :N], place[None, N:]
        orbit, lengths, _ = linear.svd(self.critical.fields(x)[0])
        if lengths[n - 2] < _REST:
            return None
        sizes, vectors = linear.svd(self.critical.jacobian(x, weights)[0])[1:]
        if len(sizes) >= N and sizes[N - 1] < 1e-6 * sizes[0]:
            return None
        # Of the n null vectors the combination that is orthogonal to the orbit
        null = vectors[N:]
        shares = linear.matmul(null[:, :N], orbit[:, : n - 1])
        across = linear.matmul(linear.svd(shares)[0][:, -1], null)
        across = across / linear.norm(across)
        return across if like is None or (across * like).sum() > 0 else -across

    def _parts(self, points: Array, size: Array) -> tuple[list[CriticalFamily], Array]:
        """The parts between places where the type changes, or the values turn back, and the values that are degenerate.

        They do at a cusp, and where a family goes through an orbit of both flows that a symmetry maps to itself: what
        follows is the image of what was before, with the same values.  The longest part comes first.
        """
        critical = self.critical
        _, types = critical.kinds(points)
        states = points * critical.units
        values = self.values(points)
        steps = np.diff(values / size, axis=0)
        turns = np.pad((steps[:-1] * steps[1:]).sum(axis=1) < 0, 1) if len(points) > 2 else np.zeros(len(points), bool)
        found, begin = list[CriticalFamily](), 0
        for k in range(1, len(points) + 1):
            if k == len(points) or types[k] != types[begin] or turns[k]:
                stop = min(k + 1, len(points))  # both share the place
                if stop - begin > 1 and types[begin] not in {"degenerate", "regular"}:
                    found.append(CriticalFamily(str(types[begin]), values[begin:stop], states[begin:stop]))
                begin = k
        return sorted(found, key=lambda one: -len(one.values)), values[types == "degenerate"]


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
