r"""The graph of the tori of a level of energy: which families of them begin, join, divide and end, and where.

On a compact level H = E of a system of two degrees of freedom with the integral K the critical points of K are circles,
at each of which K has an extremum (elliptic) or a saddle (hyperbolic) across.  Families of tori lie between critical
values; a connected critical fibre with the tori beside it is an *atom*, and the graph of the atoms, joined by the
families, is the *molecule*, here without marks [bolsinov2004].  One elliptic circle is the atom A; one hyperbolic
circle is B if two tori become one, and A* if one becomes one.

It is computed as follows.  Circles are found from random states of the level.  Beside each, states with higher and with
lower values are carried along K, by small steps on the level, to the middle between critical values.  There commuting
flows tell which of them are on one torus, and random states of the fibre are asked the same.  Circles beside one torus
belong to one atom.  A torus with no circle at a critical value is carried past it.  In the end each family has an atom
at both ends, and no random state lies beyond: else a circle was missed, and there is no answer.  A component of the
level that no random state comes to has no part in this, and is missing.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import OrbitError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_finite, as_positive, as_seed, as_time_limit
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import Deadline, checkpoint
from liepoisson.inputs.refusals import check_kind, counted
from liepoisson.leaf.leaf import Leaf
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import elementary, linear
from liepoisson.streams import Purpose, stream
from liepoisson.tori.critical_search import Critical, check_resolved, momentum_of
from liepoisson.tori.fibres import joined
from liepoisson.tori.momentum_maps import MomentumMap, moved_onto, on_fibre, on_leaf, unit_equations

if TYPE_CHECKING:
    from liepoisson.model.system import System

_BESIDE = 0.01
"""Distance from a circle of the states beside it, in units of the leaf, or relative to a circle that is smaller."""
_AROUND = 256
"""Directions across a circle in which K is looked at."""
_MOVE, _LEAST = 0.1, 1e-9
"""The longest move of a carried state, in units of the leaf, and the shortest step, relative to the way."""
_SAME = 1e-7
"""Critical values of K that differ by less, relative to all, are one; states on circles are known to some 1e-12."""
_ON = 1e-5
"""A state nearer than this to a circle is on it, likewise."""
_GRID, _MOST = 0.05, 20_000
"""Distance of the points of a circle, likewise, and the most of them."""
_SMALLEST = 1e-3
"""The least size of a circle, in units of the leaf: of distances beside it K changes by their squares."""


@dataclass(frozen=True, eq=False)
class Atom(ReadOnlyArrays):
    """A connected critical fibre of a level of energy.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> lp.tori.molecule(leaf, 0).atoms[0]
        <A at l3 = -0.877383, 1 circle, 0 tori below, 1 above>

    Attributes:
        name: "A", "B" or "A*"; of more circles their number, "2 circles".
        integral: The name of K.
        value: The value of K.
        states: A state on each of its circles, shape (circle, N).
        below: The families of tori that end here, of lower values of K.
        above: Those that begin here.
    """

    name: str
    integral: str
    value: float
    states: Array
    below: tuple[int, ...]
    above: tuple[int, ...]

    def __repr__(self) -> str:
        return (
            f"<{self.name} at {self.integral} = {self.value:.6g}, {counted(len(self.states), 'circle')}, "
            f"{counted(len(self.below), 'torus', 'tori')} below, {len(self.above)} above>"
        )


@dataclass(frozen=True, eq=False)
class Molecule(SavedWhole):
    """The graph of the tori of a level of energy.

    Example:
        >>> leaf = lp.Leaf(lp.catalog.system("spherical-pendulum"), {"C1": 0, "C2": 1})
        >>> found = lp.tori.molecule(leaf, 0)
        >>> found.families.tolist(), [atom.name for atom in found.atoms]
        ([[0, 1]], ['A', 'A'])

    Attributes:
        momentum: The momentum map, (H, K).
        leaf: The leaf.
        energy: E.
        atoms: In the order of the values of K.
        families: The numbers of the lower and of the upper atom of each family of tori, shape (family, 2).
    """

    kind = "molecule"
    made_by = "lp.tori.molecule"
    row = "family"

    momentum: MomentumMap
    leaf: Leaf
    energy: float
    atoms: tuple[Atom, ...]
    families: NDArray[np.intp]

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.leaf.system

    def __len__(self) -> int:
        """How many families of tori it has."""
        return len(self.families)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each family of tori its atoms and the values of K there."""
        lower, upper = self.families.T
        names = np.array([atom.name for atom in self.atoms], dtype=np.str_)
        values = np.array([atom.value for atom in self.atoms])
        return {
            "lower": lower,
            "upper": upper,
            "lower_atom": names[lower],
            "upper_atom": names[upper],
            "from": values[lower],
            "to": values[upper],
        }

    def __repr__(self) -> str:
        names = Counter(atom.name for atom in self.atoms)
        atoms = ", ".join(f"{n} {name}" for name, n in sorted(names.items()))
        return (
            f"<Molecule of {self.leaf.system.name!r} at H = {self.energy:.6g}: {atoms}; "
            f"{counted(len(self), 'family', 'families')} of tori>"
        )


@explains_its_arguments
def molecule(
    leaf: Leaf,
    energy: float,
    *,
    momentum: MomentumMap | None = None,
    n_starts: int = 200,
    n_states: int = 60,
    spread: float = 1.5,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
) -> Molecule:
    r"""The graph of the tori of a level of energy, for two degrees of freedom.

    A component of the level that no random state comes to is not in it: take a larger `spread`, or more `n_starts`.

    Example:
        >>> double_well = lp.System(lp.canonical(2), "p1^2/2 - q1^2/2 + q1^4/4 + p2^2/2 + q2^2/2")
        >>> momentum = lp.tori.momentum_map(double_well, ["p1^2/2 - q1^2/2 + q1^4/4"])
        >>> lp.tori.molecule(lp.Leaf(double_well, {}), 0.1, momentum=momentum)
        <Molecule of 'Hamiltonian system' at H = 0.1: 3 A, 1 B; 3 families of tori>

    Args:
        leaf: A leaf of dimension 4.
        energy: E, no critical value of H.
        momentum: The momentum map; by default that of the known integrals of the system.
        n_starts: Number of starts for critical circles.
        n_states: Random states of each fibre between critical values.
        spread: Standard deviation of the random states, in units of the leaf.
        seed: Draws the random states.
        time_limit: Seconds that the call may take.

    Raises:
        ParameterError: there are not two integrals.
        OrbitError: no state has the energy, a critical point is degenerate or an equilibrium, the level is not compact,
            or a circle was missed.
        TimeLimitError: the time is over.

    References: [bolsinov2004].
    """
    deadline = Deadline(as_time_limit(time_limit))
    check_kind(leaf, Leaf, "leaf", "a Leaf", "make it by lp.Leaf(system, {...})")
    momentum = momentum_of(leaf, momentum)
    if len(momentum.names) != 2:
        raise ParameterError(f"leaf: wanted one of dimension 4, with two integrals; got {', '.join(momentum.names)}")
    value = as_finite(energy, "energy")
    n, m = as_count(n_starts, "n_starts", least=1), as_count(n_states, "n_states", least=1)
    width = as_positive(spread, "spread", "a positive number", example=1)
    with deadline.running(), np.errstate(all="ignore"):
        check_resolved(leaf, momentum)
        level = _Level(leaf, momentum, value, width, as_seed(seed))
        return _Graph(level, level.circles(n), m).molecule()


@dataclass(frozen=True, eq=False)
class _Circle:
    """A critical circle: K there, a state, and states beside it with lower and with higher values."""

    value: float
    state: Array
    is_elliptic: bool
    lower: Array
    higher: Array


class _Level:
    """The level of energy of a leaf."""

    def __init__(self, leaf: Leaf, momentum: MomentumMap, energy: float, spread: float, seed: int) -> None:
        self.leaf, self.momentum, self.energy, self.spread, self.seed = leaf, momentum, energy, spread, seed
        equations, self.units = unit_equations(leaf, [(momentum.integrals["H"], energy)])
        self.critical = replace(Critical.on(leaf, momentum), equations=equations)
        self.name = momentum.names[1]
        self.integral = momentum.integrals[self.name]

    def random(self, m: int) -> Array:
        """States of the level."""
        draw = stream(self.seed, Purpose.FIBRES)
        rough = self.spread * draw.standard_normal((m, len(self.units))) * self.units
        return self._on_level(on_leaf(self.leaf, rough))

    def _on_level(self, states: Array) -> Array:
        """States of the level near given ones, those that were found."""
        found = moved_onto(self.critical.equations, self.units, states[np.isfinite(states).all(axis=1)])
        return found[np.isfinite(found).all(axis=1)]

    def circles(self, n: int) -> list[_Circle]:
        """Critical circles of K, each once."""
        critical = self.critical
        x, weights = critical.solved(*critical.starts(n, self.spread, self.seed))
        if not len(x):
            raise self.refused("no critical state of this energy was found: take another energy, or more n_starts")
        ranks, types = critical.kinds(x)
        for k in np.flatnonzero((ranks != 1) | (types == "degenerate")):
            raise self.refused(
                f"the state {(x[k] * self.units).tolist()} is {'an equilibrium' if not ranks[k] else types[k]}: take "
                "another energy"
            )
        values = self.integral(x * self.units)
        found = list[tuple[float, Array]]()
        circles = list[_Circle]()
        for k in range(len(x)):
            near = [points for value, points in found if abs(value - values[k]) <= _SAME * np.abs(values).max()]
            if any(self._is_on(x[k], weights[k], points) for points in near):
                continue
            found.append((float(values[k]), self._points(x[k], weights[k])))
            size = _size(found[-1][1])
            circles.append(self._circle(x[k], weights[k], float(values[k]), str(types[k]) == "elliptic", size))
        return circles

    def refused(self, why: str) -> OrbitError:
        """What says that there is no answer."""
        return OrbitError(f"energy: wanted a regular one of a compact level; at H = {self.energy:.9g} {why}")

    def _rates(self, weights: Array) -> Array:
        """Of the flows, the combination along the circle: that of the function whose weights are orthogonal."""
        return np.array([-weights[1], weights[0]]) / self.critical.sizes

    def _velocity(self, x: Array, weights: Array) -> Array:
        """That of a state in units, along the circle."""
        fields = self.momentum.fields(x * self.units) / self.units[:, None]
        return linear.matmul(fields, self._rates(weights))

    def _orbit(self, x: Array, weights: Array, lengths: Array) -> Array:
        """States along the circle, in units, at given lengths of the way."""
        times = lengths / linear.norm(self._velocity(x, weights))
        return self.momentum.flow(x * self.units, times[:, None] * self._rates(weights)) / self.units

    def _points(self, x: Array, weights: Array) -> Array:
        """Points of a circle, in units, once around or farther."""
        # unequal lengths: equal ones may be whole turns of a small circle
        share = np.arange(200) / 200
        grid = _GRID * _size(self._orbit(x, weights, 200 * _GRID * share**2))
        if grid < _GRID * _SMALLEST:
            raise self.refused(f"the circle of {(x * self.units).tolist()} is too small: take another energy")
        for count in (200, 2000, _MOST):
            points = self._orbit(x, weights, grid * np.arange(count, dtype=np.float64))
            distance = linear.norm(points - x, axis=1)
            away = np.flatnonzero(distance > 4 * grid)
            back = np.flatnonzero(distance < grid)
            if len(away) and len(back) and back[-1] > away[0]:
                return points[: back[back > away[0]][0] + 2]
        raise self.refused(f"the orbit of {(x * self.units).tolist()} does not close: the level is not compact")

    def _is_on(self, x: Array, weights: Array, points: Array) -> bool:
        """Whether a critical state is on a circle: the tangents of its points lead to it."""
        nearest = linear.norm(points - x, axis=1)
        place = points[int(nearest.argmin())]
        if nearest.min() > linear.norm(points[1:] - points[:-1], axis=1).max():
            return False
        here, way, enough = x, 0.0, _ON * _size(points)
        speed = linear.norm(self._velocity(x, weights))
        for _ in range(8):
            tangent = self._velocity(here, weights) / speed
            step = float(((place - here) * tangent).sum() / (tangent * tangent).sum())
            way += step
            here = self._orbit(x, weights, np.array([way]))[0]
            if abs(step) < enough:  # what is left is of the order of its square
                break
        return bool(linear.norm(here - place) < enough)

    def _circle(self, x: Array, weights: Array, value: float, is_elliptic: bool, size: float) -> _Circle:
        """A circle with the states beside it."""
        rows = np.concatenate([self.critical.equations.relative(x[None])[1][0], self._velocity(x, weights)[None]])
        across = linear.svd(rows)[2][-2:]
        angles = 2 * np.pi * np.arange(_AROUND) / _AROUND
        turned = np.stack([elementary.cos(angles), elementary.sin(angles)], axis=1)
        beside = self._on_level((x + _BESIDE * size * linear.matmul(turned, across)) * self.units)
        if len(beside) < _AROUND:
            raise self.refused(f"the states around {(x * self.units).tolist()} are not resolved: take another energy")
        change = self.integral(beside) - value
        if is_elliptic:
            ends = [int(np.abs(change).argmax())]
        else:
            after = np.roll(change, -1)
            ends = [
                k for k in range(_AROUND) if abs(change[k]) >= abs(change[k - 1]) and abs(change[k]) > abs(after[k])
            ]
        lower, higher = [k for k in ends if change[k] < 0], [k for k in ends if change[k] > 0]
        if not is_elliptic and (len(lower), len(higher)) != (2, 2):
            raise self.refused(f"the saddle at {(x * self.units).tolist()} is not resolved: take another energy")
        return _Circle(value, x * self.units, is_elliptic, beside[lower], beside[higher])

    def carried(self, state: Array, target: float, critical: float | None = None) -> Array:
        """A state moved along K on the level, near to itself at each step, to a value of K."""
        here = float(self.integral(state))
        way = abs(target - here)
        step = way if critical is None else abs(here - critical) / 2
        while here != target:
            checkpoint("carrying states between critical values")
            limit = step if critical is None else min(step, abs(here - critical) / 2)
            there = target if abs(target - here) <= limit else here + float(np.sign(target - here)) * limit
            moved = on_fibre(self.momentum, self.leaf, state[None], np.array([self.energy, there]))[0]
            if np.isfinite(moved).all() and linear.norm((moved - state) / self.units) <= _MOVE:
                here, state, step = there, moved, 1.5 * limit
            else:
                step = limit / 2
                if step < _LEAST * way:
                    raise self.refused(
                        f"a torus cannot be carried beyond {self.name} = {here:.9g}: a critical circle was missed, or "
                        "the level is not compact. Take more n_starts"
                    )
        return state


def _size(points: Array) -> float:
    """The extent of a circle from its first point, in units of the leaf; of larger ones 1."""
    return min(1.0, float(linear.norm(points - points[0], axis=1).max()))


class _Graph:
    """Circles joined by the tori between them."""

    def __init__(self, level: _Level, circles: list[_Circle], n_states: int) -> None:
        self.level, self.circles = level, circles
        values = np.sort([circle.value for circle in circles])
        size = np.abs(values).max()
        self.values = values[np.append(True, np.diff(values) > _SAME * size)]
        self.rank = [int(np.abs(self.values - circle.value).argmin()) for circle in circles]
        self.middles = (self.values[1:] + self.values[:-1]) / 2
        self.n_states = n_states
        self.random = level.random(4 * n_states)
        self.tori = list[dict[int, Array]]()
        """Of each gap between critical values a state on each torus, by its label."""
        self.below, self.above = ([set[tuple[int, int]]() for _ in circles] for _ in range(2))
        """The tori beside each circle, by gap and label."""
        self.parent = dict[tuple[int, int], tuple[int, int]]()

    def molecule(self) -> Molecule:
        level = self.level
        beyond = level.integral(self.random)
        slack = _SAME * np.abs(self.values).max()
        if ((beyond < self.values[0] - slack) | (beyond > self.values[-1] + slack)).any():
            raise level.refused("states lie beyond all critical values found: take more n_starts, or a larger spread")
        if not len(self.middles):
            raise level.refused("one critical value was found: take more n_starts, or a larger spread")
        for gap, middle in enumerate(self.middles):
            states, owners = self._beside(gap, float(middle))
            random = on_fibre(
                level.momentum, level.leaf, self.random[: self.n_states], np.array([level.energy, middle])
            )
            random = random[np.isfinite(random).all(axis=1)]
            states = np.array([*states, *random])
            if not len(states):
                raise level.refused(f"no state has {level.name} = {middle:.9g}: the level is not connected as assumed")
            labels = joined(level.leaf, level.momentum, states, level.seed)
            self.tori.append({int(label): states[k] for k, label in reversed(list(enumerate(labels)))})
            for (circle, is_above), label in zip(owners, labels, strict=False):
                (self.above if is_above else self.below)[circle].add((gap, int(label)))
        self._pass()
        return self._assembled()

    def _beside(self, gap: int, middle: float) -> tuple[list[Array], list[tuple[int, bool]]]:
        """States beside the circles at both ends of a gap, carried to its middle, and whose they are."""
        states, owners = list[Array](), list[tuple[int, bool]]()
        for k, circle in enumerate(self.circles):
            beside = circle.higher if self.rank[k] == gap else circle.lower if self.rank[k] == gap + 1 else ()
            for state in beside:
                states.append(self.level.carried(state, middle, circle.value))
                owners.append((k, self.rank[k] == gap))
        return states, owners

    def _root(self, torus: tuple[int, int]) -> tuple[int, int]:
        while self.parent.get(torus, torus) != torus:
            torus = self.parent[torus]
        return torus

    def _pass(self) -> None:
        """Tori that a critical value does not concern are one family on both sides of it."""
        level, tori = self.level, self.tori
        begun = set[tuple[int, int]]().union(*self.above)
        ended = set[tuple[int, int]]().union(*self.below)
        for gap in range(len(tori) - 1):
            passing = [(gap, label) for label in tori[gap] if (gap, label) not in ended]
            entering = [(gap + 1, label) for label in tori[gap + 1] if (gap + 1, label) not in begun]
            if not passing and not entering:
                continue
            middle = float(self.middles[gap + 1])
            carried = [level.carried(tori[gap][label], middle) for _, label in passing]
            states = np.array([*carried, *tori[gap + 1].values()])
            labels = joined(level.leaf, level.momentum, states, level.seed)
            known = dict(zip(labels[len(carried) :].tolist(), tori[gap + 1], strict=True))
            reached = [(gap + 1, known.get(int(label), -1)) for label in labels[: len(carried)]]
            if sorted(reached) != sorted(entering):
                raise level.refused(f"tori change at {level.name} = {self.values[gap + 1]:.9g}: take more n_starts")
            for torus, there in zip(passing, reached, strict=True):
                self.parent[there] = self._root(torus)
        first = {(0, label) for label in tori[0]} - begun
        last = {(len(tori) - 1, label) for label in tori[-1]} - ended
        if first or last:
            raise level.refused("a family of tori has no end: take more n_starts")

    def _assembled(self) -> Molecule:
        """Circles beside one torus are one atom."""
        level = self.level
        roots = sorted({self._root((gap, label)) for gap, some in enumerate(self.tori) for label in some})
        number = {root: k for k, root in enumerate(roots)}
        down = [{number[self._root(torus)] for torus in some} for some in self.below]
        up = [{number[self._root(torus)] for torus in some} for some in self.above]
        groups = list[list[int]]()
        for k in range(len(self.circles)):
            mine = [
                group
                for group in groups
                if any(self.rank[k] == self.rank[j] and (down[k] & down[j] or up[k] & up[j]) for j in group)
            ]
            groups = [group for group in groups if group not in mine] + [[k, *(j for group in mine for j in group)]]
        groups.sort(key=lambda group: (self.rank[group[0]], min(group)))
        atoms, families = list[Atom](), np.full((len(roots), 2), -1, dtype=np.intp)
        for place, group in enumerate(groups):
            lower, upper = (tuple(sorted(set[int]().union(*(some[k] for k in group)))) for some in (down, up))
            families[list(lower), 1] = place
            families[list(upper), 0] = place
            states = np.array([self.circles[k].state for k in group])
            name = f"{len(group)} circles"
            if len(group) == 1:
                name = "A" if self.circles[group[0]].is_elliptic else "A*" if len(lower) == len(upper) else "B"
            atoms.append(Atom(name, level.name, float(self.values[self.rank[group[0]]]), states, lower, upper))
        return Molecule(level.momentum, level.leaf, level.energy, tuple(atoms), families)
