r"""The curve of loops of a family, and the functions along it that pass zero where something changes.

A tangent is the direction of the first state, in units of the level, of the relative time, and of the angles.  With
$w_j = \mu_j + 1/\mu_j$ of the pairs of multipliers, the polynomial $p(w) = \prod_j(w - w_j)$ is real; along a family it
changes its sign

* at $w = 2$ in a fold of the energy, or where another branch crosses (of orbits with less symmetry, say);
* at $w = -2$ where a branch of orbits of the double period leaves;

and its discriminant does so where two pairs collide, on the unit circle or on the real line.

References: [munozalmaraz2003]; [howard1987], the multipliers.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from liepoisson.inputs.arrays import Array
from liepoisson.leaf.leaf import Leaf
from liepoisson.model.discrete_symmetries import DiscreteSymmetry
from liepoisson.model.free_parameter import FreeParameter
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.numeric.curves import Curve
from liepoisson.orbits.closed_orbits import Momenta, PeriodicOrbit, Problem, problem_at, with_parameter
from liepoisson.orbits.closing import GROWTH, Closing, Linearised, Loops, guessed
from liepoisson.orbits.level import level_of
from liepoisson.orbits.shooting import TOGETHER
from liepoisson.portable import linear

if TYPE_CHECKING:
    from liepoisson.model.system import System

AT_REST = "an equilibrium"
HOMOCLINIC = "an equilibrium on the orbit, which is homoclinic there"
_SMALL = 4.0


class AtStart(NamedTuple):
    """What varies along the curve, its gradient, and the velocity, in units, where a loop begins."""

    value: float
    gradient: Array
    rate: Array


@dataclass(frozen=True, eq=False)
class FamilyLoop:
    """A loop of a family, with what is computed of it once."""

    curve: LoopCurve
    loops: Loops

    @cached_property
    def direction(self) -> Array:
        """That of the curve, of either sign."""
        return self.curve.directions(self, 1)[0]

    @property
    def start(self) -> Array:
        """The first state, with the parameter behind it if one varies."""
        return self.loops.state[0, 0]

    @property
    def residual(self) -> float:
        """How well the loop closes."""
        return float(self.loops.residual[0])

    @property
    def unknowns(self) -> Array:
        """All states, the time and the angles."""
        return self._unknowns

    @cached_property
    def _unknowns(self) -> Array:
        return _flat(self.loops.state, self.loops.time, self.loops.angle)

    @property
    def units(self) -> Array:
        """Those of the level for the first state, from which others follow, and the time, which counts relatively."""
        return self._units

    @cached_property
    def _units(self) -> Array:
        units = np.full(self.loops.state[0].shape, np.inf)
        units[0] = self.curve.units
        return _flat(units, self.loops.time, np.ones_like(self.loops.angle))

    @cached_property
    def at_start(self) -> AtStart:
        """What the functions of the curve are there."""
        return self.curve.at_starts(self.start[None])[0]

    @cached_property
    def linearised(self) -> Linearised:
        """The derivatives of its equations."""
        return self.curve.closing.linearised(self.loops.state, self.loops.time, self.loops.angle)

    @cached_property
    def orbit(self) -> PeriodicOrbit:
        """The loop with its multipliers, on its own level; it is alone there if no multiplier is 1."""
        return self.curve.described(self.loops)[0]


@dataclass(frozen=True, eq=False)
class LoopCurve(Curve[FamilyLoop]):
    """The loops near a state that have the values of all held functions but one.

    Attributes:
        problem: The orbits that are looked for.
        held: The equations with all functions held.
        name: The one that varies.
        free: It.
        variable: The parameter, if one varies.
    """

    problem: Problem
    held: Closing
    name: str
    free: PhaseFunction
    variable: FreeParameter | None
    together = TOGETHER

    @classmethod
    def near(
        cls,
        system: System,
        state: Array,
        units: Array,
        name: str,
        variable: FreeParameter | None,
        *,
        momenta: Momenta,
        symmetry: DiscreteSymmetry | None = None,
        on: Array | None = None,
    ) -> LoopCurve:
        """The equations near a state, with the values of H, of Casimirs and of momenta there, or at a state `on`."""
        problem = problem_at(system, state, momenta=momenta, symmetry=symmetry, threads=1).in_units(units)
        functions = system.functions
        free = functions.energy if name == "H" else functions.casimirs.get(name, functions.energy)
        if variable is not None:
            problem = with_parameter(problem, variable)
            free = problem.closing.held[name][0]
        held = dict(problem.closing.held)
        if variable is None and name != "H":  # the whole of it, with what depends on the Casimir that varies
            held["H"] = functions.energy, float(functions.energy(state))
        if on is not None:
            at = on if variable is None else np.append(on, variable.value)
            held = {key: (function, float(function(at))) for key, (function, _) in held.items()}
        return cls(problem, replace(problem.closing, held=held), name, free, variable)

    @cached_property
    def closing(self) -> Closing:
        """The equations of the curve."""
        return self.held.without(self.name)

    @property
    def units(self) -> Array:
        """Those of a state."""
        return self.closing.level.units

    def first(self, state: Array, time: float, angles: Array | None = None) -> Loops:
        """A guess with the orbit of a state, to which the parameter is added if one varies."""
        start = state if self.variable is None else np.append(state, self.variable.value)
        return self.problem.loops(start[None], np.array([time]), angles)

    def value(self, point: FamilyLoop) -> float:
        """The energy, the Casimir or the parameter that varies."""
        return point.at_start.value

    @np.errstate(all="ignore")  # Newton's method may have ended where the functions do not exist
    def at_starts(self, starts: Array) -> list[AtStart]:
        """What the functions are where loops begin."""
        rates = self.closing.flow.system.vector_field(starts) / self.units
        return [*map(AtStart, self.free(starts).tolist(), self.free.gradient(starts) * self.units, rates)]

    def solved(self, guess: Array, near: FamilyLoop, aim: Array | float) -> FamilyLoop:
        """What Newton's method makes of a guess: across a direction, or where the value is a wanted one."""
        shape, n = near.loops.state.shape, near.loops.state.size
        loops = guessed(guess[:n].reshape(shape), guess[n : n + 1], guess[None, n + 1 :])
        if isinstance(aim, np.ndarray):
            return FamilyLoop(self, self.closing.solved(loops, extra=aim[np.isfinite(near.units)]))
        function = self.held.held[self.name][0]
        rest = 0.0 if function is self.free else float(function(near.start)) - self.value(near)  # of Casimirs alone
        closing = replace(self.held, held={**self.held.held, self.name: (function, aim + rest)})
        return FamilyLoop(self, closing.solved(loops))

    def ahead(self, guesses: Array, last: FamilyLoop, direction: Array, length: float) -> list[FamilyLoop]:
        """The loops that follow a last one by equal steps, from guesses, with all that is asked of them later."""
        shape, n = last.loops.state.shape, last.loops.state.size
        given = guessed(guesses[:, :n].reshape(-1, *shape[1:]), guesses[:, n], guesses[:, n + 1 :])
        tangent = (direction / last.units)[np.isfinite(last.units)]
        chained = self.closing.chained(given, last.loops, tangent, length)
        if chained is None:
            return []
        loops, found, tangents = chained
        moves, delay, turned = replace(found, gaps=np.zeros_like(found.gaps)).moves(tangents)
        points = [FamilyLoop(self, loops.of(np.array([k]))) for k in range(len(loops))]
        for k, (one, at_start) in enumerate(zip(points, self.at_starts(loops.state[:, 0]), strict=True)):
            vars(one)["linearised"], vars(one)["at_start"] = found.of(slice(k, k + 1)), at_start
            vars(one)["direction"] = _flat(moves[k] * self.units, delay[k : k + 1] * one.loops.time, turned[k])
        if self.variable is None and self.name == "H":
            with suppress(linear.LinAlgError):  # of one of them, which may not be reached
                for one, orbit in zip(points, self.described(loops), strict=True):
                    vars(one)["orbit"] = orbit
        return points

    def null_space(self, point: FamilyLoop, n: int, /, *, least: int = 1) -> Array:
        """The n directions in which it moves most nearly along loops."""
        del least
        return point.direction[None] if n == 1 else self.directions(point, n)

    def directions(self, point: FamilyLoop, n: int) -> Array:
        """The same, computed."""
        closed = replace(point.linearised, gaps=np.zeros_like(point.linearised.gaps))
        found: list[Array] = []
        for tangent in self.closing.null_space(point.loops, point.linearised, n):
            moves, delay, turned = closed.moves(tangent[None])
            found.append(_flat(moves * self.units, delay * point.loops.time, turned))
        return np.array(found)

    def tests(self, point: FamilyLoop, tangent: Array) -> dict[str, Array]:
        """Functions that pass zero where something changes; of loops without multipliers the slope of the value."""
        slope = linear.matmul(point.at_start.gradient, tangent[: len(point.start)])
        found: dict[str, Array] = {"fold": np.array([slope])}
        half = point.orbit.multipliers[: len(point.orbit.multipliers) // 2]
        if half.size:
            sums = half + 1 / half
            pairs = [sums[i] - sums[j] for i in range(len(sums)) for j in range(i)]
            factors = {"branch": 2 - sums, "double period": -2 - sums, "collision": np.array(pairs) ** 2}
            found |= {kind: np.array([float(np.prod(values).real)]) for kind, values in factors.items()}
        return found

    def obstacle(self, first: FamilyLoop, last: FamilyLoop) -> tuple[str, bool]:
        """An equilibrium between two starts, where the velocity turns around; no shorter step helps at a small orbit.

        An orbit that is as small as the step shrinks to it, after which the same orbits come: a small one has the size
        $2a$, and the step to one of the amplitude $-b$ the length $a + b$; an orbit near to a saddle stays large.
        """
        if not linear.matmul(first.at_start.rate, last.at_start.rate) < 0:
            return "", False
        half, _ = self.closing.flow.ends(first.start[None], np.array([float(first.loops.time[0]) / 2]))
        size, step = (linear.norm((one - first.start) / self.units) for one in (half[0], last.start))
        return (AT_REST, True) if size < _SMALL * step else (HOMOCLINIC, False)

    def settled(self, point: FamilyLoop) -> FamilyLoop:
        """The loop in other segments, if neighbours grow too much in these."""
        if not np.abs(point.linearised.segments).max() > 10 * GROWTH:  # whose round-off is a fifth of what must close
            return point
        loops = self.problem.loops(point.loops.state[:, 0], point.loops.time, point.loops.angle)
        return FamilyLoop(self, self.closing.solved(loops))

    def described(self, loops: Loops) -> list[PeriodicOrbit]:
        """Loops with their multipliers, each on its own level; with a parameter, one loop."""
        starts, system, problem = loops.state[:, 0], self.problem.system, replace(self.problem, closing=self.held)
        if self.variable is not None:
            system, starts = self.variable.at(float(starts[0, -1])), starts[:, :-1]
            problem = problem_at(system, starts[0], momenta=tuple(self.problem.momenta), threads=1)
            loops = replace(loops, state=loops.state[..., :-1])
        problem = problem.in_units(self.units[: starts.shape[1]])
        levels = [problem.closing.level] * len(loops)
        if self.variable is None and self.name != "H":
            levels = [
                level_of(system, Leaf.through(system, x), float(system.functions.energy(x))).through(x) for x in starts
            ]
            levels = [replace(one, units=problem.closing.level.units) for one in levels]
        elif self.variable is None:
            levels = problem.closing.level.through_each(starts)
        return problem.descriptions(loops, levels)


def _flat(state: Array, time: Array, angle: Array) -> Array:
    """A loop, or its change, as one vector."""
    return np.concatenate([state.ravel(), time, angle.ravel()])
