r"""Families of periodic orbits: followed in the energy, in a Casimir, or in a parameter.

With one of the held values set free, or a parameter, as a component of the state that does not move, loops form a
curve, which is followed by its tangent (pseudo-arclength), so that folds are no obstacle.
With $w_j = \mu_j + 1/\mu_j$ of the pairs of multipliers, the polynomial $p(w) = \prod_j(w - w_j)$ is real; along a
family it changes its sign

* at $w = 2$ in a fold of the energy, or where another branch crosses (of orbits with less symmetry, say);
* at $w = -2$ where a branch of orbits of the double period leaves;

and its discriminant does so where two pairs collide, on the unit circle or on the real line.  These points are located
by the secant method along the family.

References: [doedel2003]; [munozalmaraz2003]; [howard1987], the multipliers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.family_equations import free_parameter
from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import OrbitError, ParameterError, TimeLimitError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_number
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import shown
from liepoisson.io.display import Found
from liepoisson.io.tables import Tabular
from liepoisson.leaf._checks import as_system
from liepoisson.leaf.leaf import Leaf
from liepoisson.model.free_parameter import FreeParameter
from liepoisson.numeric.run_options import RunOptions
from liepoisson.orbits.closed_orbits import CLOSES, Momenta, PeriodicOrbit, orbit_columns, problem_at, with_parameter
from liepoisson.orbits.closing import GROWTH, Loops, guessed
from liepoisson.orbits.level import level_of
from liepoisson.orbits.multipliers import SymmetricOrbit
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from liepoisson.model.system import System

_FIRST = 1e-2
"""The first step, and the amplitude of the first orbit around an equilibrium, in units of the level."""
_LONGEST, _SHORTEST = 0.2, 1e-6
_GOOD, _BAD = 0.2, 0.5
"""The step grows where its tangents differ by less than the first angle, and is made again above the second."""

_SAME = 1e-6
_SECANTS, _TRIALS = 20, 8
_SMALL = 0.1
"""An orbit that is smaller than this part of both neighbours is at an equilibrium; at a fold all are about as large."""
_TOO_SHORT, _AT_REST = "the steps became too short", "an equilibrium"
_LEAVES = ("branch", "double period")
"""Points at which another family begins."""


@dataclass(frozen=True, eq=False)
class FamilyPoint(ReadOnlyArrays):
    """A point of a family at which something changes.

    Example:
        >>> henon = lp.catalog.system("henon-heiles")
        >>> straight = lp.orbits.periodic_orbit(henon, [0, 0, 0, 0.2], period=6.3)
        >>> (point,) = lp.orbits.orbit_family(henon, straight, until=0.14).points
        >>> point.kind, round(point.orbit.energy, 9)
        ('double period', 0.135285919)

    Attributes:
        kind: "fold", "branch", "double period" or "collision".
        orbit: The orbit there.
        after: The number of the orbit of the family before it.
        tangent: The direction of the family there: of the start, in units of the level, of the relative time, and of
            the angles.
    """

    kind: str
    orbit: PeriodicOrbit
    after: int
    tangent: Array


@dataclass(frozen=True, eq=False, repr=False)
class OrbitFamily(Found[PeriodicOrbit], Tabular):
    """Periodic orbits of a family, in their order along it.

    Example:
        >>> pendulum = lp.System(lp.canonical(1), "p1^2/2 - cos(q1)")
        >>> family = lp.orbits.orbit_family(pendulum, lp.phase_space.equilibrium(pendulum, [0, 0]), until=0.5)
        >>> family.end, round(float(family.period[-1]), 8)
        ('the wanted value', 8.62606259)

    Attributes:
        along: What was set free: "energy", or the name of a Casimir or a parameter.
        found: The orbits.
        points: Folds, branches, double periods and collisions between them.
        end: Why it ends.
    """

    titles = ("along", "period", "stability", "multipliers", "residual")

    along: str
    found: tuple[PeriodicOrbit, ...]
    points: tuple[FamilyPoint, ...]
    end: str

    @property
    def system(self) -> System:
        """The system."""
        return self.found[0].system

    @property
    def value(self) -> Array:
        """The energy, the Casimir or the parameter of each orbit, shape (orbit,)."""
        return np.array([value_of(one, self.along) for one in self.found])

    @property
    def period(self) -> Array:
        """The period of each orbit, shape (orbit,)."""
        return np.array([one.period for one in self.found])

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """The multipliers of each orbit, shape (orbit, multiplier)."""
        return np.array([one.multipliers for one in self.found])

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its value, period, stability, start and multipliers."""
        return {self.along: self.value, **orbit_columns(self.found, self.system.component_names)}

    def _head(self) -> str:
        points = ", ".join(f"{one.kind} at {value_of(one.orbit, self.along):.9g}" for one in self.points)
        return (
            f"{len(self.found)} orbits of a family of {self.system.name!r}, {self.along} {self.value[0]:.9g} to "
            f"{self.value[-1]:.9g}; {points or 'no bifurcation'}; ended: {self.end}."
        )

    def _row(self, one: PeriodicOrbit, /) -> tuple[str, ...]:
        half = one.multipliers[: len(one.multipliers) // 2]
        shown_multipliers = ", ".join(f"{m:.5g}" for m in half)
        return (
            f"{value_of(one, self.along):.9g}",
            f"{one.period:.8f}",
            one.stability,
            shown_multipliers,
            f"{one.residual:.0e}",
        )


FamilyStart: TypeAlias = "PeriodicOrbit | SymmetricOrbit | Equilibrium | FamilyPoint"
"""An orbit; an equilibrium, around which orbits are small; or a point of a family where a branch leaves it."""


def value_of(orbit: PeriodicOrbit, along: str) -> float:
    """The energy of an orbit, a Casimir or a parameter."""
    functions = {"energy": orbit.system.functions.energy, **orbit.system.functions.casimirs}
    return float(functions[along](orbit.start)) if along in functions else FreeParameter(orbit.system, along).value


@shows_progress
def orbit_family(
    system: System,
    start: FamilyStart,
    *,
    along: str = "energy",
    until: float | str | None = None,
    increasing: bool = True,
    mode: int = 0,
    max_orbits: int = 200,
    longest_step: float = _LONGEST,
    momenta: Momenta = (),
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> OrbitFamily:
    r"""The family of periodic orbits that an orbit belongs to, or that begins at an equilibrium.

    Example:
        >>> henon = lp.catalog.system("henon-heiles")
        >>> straight = lp.orbits.periodic_orbit(henon, [0, 0, 0, 0.2], period=6.3)
        >>> family = lp.orbits.orbit_family(henon, straight, until=0.14)
        >>> [(point.kind, round(point.orbit.energy, 9)) for point in family.points]
        [('double period', 0.135285919)]
        >>> lp.orbits.orbit_family(henon, family.points[0], max_orbits=2)[0].stability
        'elliptic'

    Args:
        system: A system whose parameters are all numbers.
        start: An orbit; an equilibrium with imaginary eigenvalues, around which orbits are small; or one of the
            `points` of a family, where a branch or orbits of the double period leave it.
        along: What varies: "energy", a Casimir by name, or a parameter of the system by its name in `parameters`, such
            as "g", or "a3" of a vector a; of a `Top` I1, ..., a1, ..., b1, ..., epsilon. Everything else is held.
        until: The value at which the family ends; the last orbit has it to round-off.
        increasing: Whether the value increases at the beginning.
        mode: Of an equilibrium, which frequency, the largest first.
        max_orbits: At most so many orbits.
        longest_step: The longest step between starts, in units of the level.
        momenta: Linear integrals that are held, as for `periodic_orbit`.

    Returns:
        The orbits with their multipliers, the bifurcations between them, and why it ends.

    Raises:
        OrbitError: no orbit of the family was found near the start.
        ParameterError: the equilibrium has no such frequency, or a value is not as it must be.
    """
    run = RunOptions.read(None, threads, time_limit, progress)
    system, most = as_system(system), as_count(max_orbits, "max_orbits", least=2, most=100_000)
    own = getattr(start.orbit if isinstance(start, FamilyPoint) else start, "system", system)
    variable = free_parameter(system, own, along, "energy", *system.functions.casimirs)
    bound = None if until is None else as_number(until, "until", "a number")
    name = "H" if along == "energy" else along
    longest = as_number(longest_step, "longest_step", "a length")
    follower = _Follower(system if variable is None else own, name, momenta, longest, variable)
    orbits: list[PeriodicOrbit] = []
    points: list[FamilyPoint] = []
    end = ""
    with run.deadline.running():
        follower.begin(start, mode, increasing=increasing)
        orbits.append(follower.orbit())
        while not end and len(orbits) < most:
            try:
                end = follower.advance(bound)
                if end == _TOO_SHORT:  # it has not moved
                    break
                orbits.append(follower.orbit())
                if follower.passes_rest(*orbits[-2:]):
                    orbits.pop()
                    end = _AT_REST
                    break
                points += follower.points_between(len(orbits) - 2, *orbits[-2:])
            except TimeLimitError:
                end = "the time limit"
            run.tell(len(orbits) / most)
    return OrbitFamily(along, tuple(orbits), tuple(points), end or f"{most} orbits")


class _Follower:
    """A loop that moves along a family."""

    def __init__(
        self, system: System, name: str, momenta: Momenta, longest: float, variable: FreeParameter | None
    ) -> None:
        self.system, self.name, self.momenta, self.longest, self.variable = system, name, momenta, longest, variable
        self.step = min(_FIRST, longest)

    def _with_parameter(self, state: Array) -> Array:
        """A state, with the parameter behind it if one varies."""
        return state if self.variable is None else np.append(state, self.variable.value)

    def begin(self, start: FamilyStart, mode: int, *, increasing: bool) -> None:
        """The first loop, and the direction in which it goes on.

        Raises:
            OrbitError: Newton's method does not come to an orbit.
            ParameterError: the equilibrium has no such frequency, or the start is neither of these.
        """
        if isinstance(start, FamilyPoint):
            return self._begin_a_branch(start)
        if isinstance(start, Equilibrium):
            self._begin_at_rest(start, mode)
        elif isinstance(start, (PeriodicOrbit, SymmetricOrbit)):  # pyright: ignore[reportUnnecessaryIsInstance]
            symmetry, time = None, start.period
            if isinstance(start, PeriodicOrbit) and self.variable is None:  # which may break the symmetry
                symmetry, time = start.symmetry, start.time
            momenta = self.momenta or (dict(start.momenta) if isinstance(start, PeriodicOrbit) else ())
            self._problem(start.start, momenta, symmetry)
            state = self._with_parameter(start.start)
            self.loops = self.closing.solved(self.problem.loops(state[None], np.array([time])))
            if not self.loops.residual[0] <= CLOSES:
                raise OrbitError(
                    f"start: wanted an orbit that closes to {CLOSES:g}; it does to {self.loops.residual[0]:.1e}"
                )
        else:
            raise ParameterError(f"start: wanted a periodic orbit or an equilibrium; got {shown(start)}")
        self.tangent = self.closing.null_space(self.loops, 1)[0]
        slope = self._slope()
        if (slope < 0) == increasing and slope != 0:
            self.tangent = -self.tangent

    def _problem(self, state: Array, momenta: Momenta, symmetry: Any) -> None:
        self.problem = problem_at(self.system, state, momenta=momenta, symmetry=symmetry, threads=1)
        if self.variable is not None:
            self.problem = with_parameter(self.problem, self.variable)
        self.held = self.problem.closing
        self.closing = self.held.without(self.name)
        self.units = self.closing.level.units

    def _begin_a_branch(self, point: FamilyPoint) -> None:
        """The first orbit of the branch that leaves a family at a point: across the family in the null space."""
        if point.kind not in _LEAVES:
            raise ParameterError(f"start: wanted a point of the kinds {' or '.join(_LEAVES)}; got a {point.kind}")
        orbit, loops_of = point.orbit, 2 if point.kind == "double period" else 1
        if loops_of == 2 and orbit.symmetry is not None:
            raise ParameterError("start: wanted an orbit that closes without a symmetry, to be run through twice")
        self._problem(orbit.start, self.momenta or dict(orbit.momenta), orbit.symmetry)
        angles = loops_of * orbit.angles[None]
        start = self._with_parameter(orbit.start)
        self.loops = self.problem.loops(start[None], np.array([loops_of * orbit.time]), angles)
        across = self.closing.null_space(self.loops, 2)
        along = linear.matmul(across, point.tangent)
        self.tangent = linear.matmul(np.array([-along[1], along[0]]) / linear.norm(along), across)
        for _ in range(_TRIALS):
            new = self.moved(self.step)
            if new.residual[0] <= CLOSES:
                break
            self.step /= 2
        else:
            raise OrbitError("start: no branch was found beside the family; it may be tangent to it")
        before, self.loops = self.tangent, new
        tangent = self.closing.null_space(new, 1)[0]
        self.tangent = tangent if linear.matmul(tangent, before) > 0 else -tangent

    def _begin_at_rest(self, rest: Equilibrium, mode: int) -> None:
        """An orbit of small amplitude around an equilibrium."""
        found: Any = linear.eig(self.system.functions.jacobian(rest.state))
        values, vectors = found
        size = np.abs(values).max(initial=0.0)
        chosen = [k for k in range(len(values)) if values[k].imag > _SAME * size and abs(values[k].real) < _SAME * size]
        chosen.sort(key=lambda k: -values[k].imag)
        if not 0 <= as_count(mode, "mode") < len(chosen):
            raise ParameterError(
                f"mode: wanted one of {len(chosen)} frequencies of the equilibrium; got {mode}. Its eigenvalues are "
                f"{np.round(values, 6).tolist()}"
            )
        k = chosen[mode]
        direction = vectors[:, k].real
        length = float(np.abs(rest.state).max()) or 1.0
        state = rest.state + _FIRST * length * direction / linear.norm(direction)
        self._problem(state, self.momenta, None)
        time = np.array([2 * np.pi / values[k].imag])
        scaled = direction / self.units[: len(state)]
        extra = np.zeros(len(self.units) + 1 + len(self.closing.rotations))
        extra[: len(state)] = scaled / linear.norm(scaled)
        self.loops = self.closing.solved(self.problem.loops(self._with_parameter(state)[None], time), extra=extra)
        if not self.loops.residual[0] <= CLOSES:
            raise OrbitError(
                f"an orbit around the equilibrium must close to {CLOSES:g}; it does to {self.loops.residual[0]:.1e}. "
                "Another frequency may be a multiple of this one"
            )

    def orbit(self, loops: Loops | None = None) -> PeriodicOrbit:
        """The loop with its multipliers, on its own level."""
        loops = self.loops if loops is None else loops
        start = loops.state[0, 0]
        if self.variable is not None:
            system, state = self.variable.at(float(start[-1])), start[:-1]
            problem = problem_at(system, state, momenta=tuple(self.problem.momenta), threads=1)
            return problem.described(replace(loops, state=loops.state[..., :-1]))
        level = self.held.level
        if self.name == "H":
            level = replace(level, values={**level.values, "H": Fraction(float(self.system.functions.energy(start)))})
        else:
            level = level_of(self.system, Leaf.through(self.system, start), float(self.system.functions.energy(start)))
        return replace(self.problem, closing=replace(self.held, level=replace(level, units=self.units))).described(
            loops
        )

    def _slope(self) -> float:
        """The derivative of the free value along the tangent."""
        gradient = self.held.held[self.name][0].gradient(self.loops.state[0, 0]) * self.units
        return float(linear.matmul(gradient, self.tangent[: len(gradient)]))

    def moved(self, length: float) -> Loops:
        """The loop after a step along the tangent, corrected across it."""
        here = self.loops.state, self.loops.time, self.loops.angle
        found = self.closing.linearised(*here)
        moves, delay, turned = replace(found, gaps=np.zeros_like(found.gaps)).moves(length * self.tangent[None])
        guess = guessed(here[0] + moves * self.units, here[1] * (1 + delay), here[2] + turned)
        return self.closing.solved(guess, extra=self.tangent)

    def advance(self, bound: float | None) -> str:
        """Go on by one orbit; why the family ends there, or nothing."""
        function = self.held.held[self.name][0]
        while self.step > _SHORTEST * self.longest:
            new, length, is_last = self.moved(self.step), self.step, False
            old, value = (float(function(one.state[0, 0])) for one in (self.loops, new))
            if (
                bound is not None
                and new.residual[0] <= CLOSES
                and old != bound
                and (old - bound) * (value - bound) <= 0
            ):
                closing = replace(self.held, held={**self.held.held, self.name: (function, bound)})
                length *= (bound - old) / (value - old)
                new, is_last = closing.solved(self.moved(length)), True
            if new.residual[0] <= CLOSES:
                tangent = self.closing.null_space(new, 1)[0]
                cosine = float(linear.matmul(tangent, self.tangent))
                angle = float(elementary.arccos(min(1.0, abs(cosine))))
                if angle < _BAD:
                    break
            self.step /= 2
        else:
            return _TOO_SHORT
        tangent = tangent if cosine > 0 else -tangent
        self.before = self.loops, self.tangent, length
        self.loops, self.tangent = new, tangent
        if is_last:
            return "the wanted value"
        if angle < _GOOD:
            self.step = min(self.longest, 1.5 * self.step)
        if np.abs(self.closing.linearised(new.state, new.time, new.angle).segments).max() > GROWTH**2:
            self.loops = self.closing.solved(self.problem.loops(new.state[:, 0], new.time, new.angle))
        return ""

    def passes_rest(self, first: PeriodicOrbit, last: PeriodicOrbit) -> bool:
        """Whether the family comes to an equilibrium and out again between the last two orbits.

        The free value turns as in a fold, and the orbit at which it does is small beside both.
        """
        tests = [self._tests(first, self.before[1])["fold"], self._tests(last, self.tangent)["fold"]]
        if tests[0] * tests[1] >= 0:
            return False
        between, _ = self._located("fold", *tests)
        around = [first, last] if between is None else [first, last, between]
        units = self.units[: len(first.start)]
        sizes = [float(linear.norm(one.system.vector_field(one.start) / units)) * one.time for one in around]
        return len(sizes) == 3 and sizes[2] < _SMALL * min(sizes[:2])

    def points_between(self, number: int, first: PeriodicOrbit, last: PeriodicOrbit) -> list[FamilyPoint]:
        """What changes between the last two orbits, located by the secant method (Illinois) in the step.

        Args:
            number: That of the first of them.
            first: It.
            last: The other.
        """
        tests = [self._tests(first, self.before[1]), self._tests(last, self.tangent)]
        found: list[FamilyPoint] = []
        for kind in tests[0]:
            if tests[0][kind] * tests[1][kind] < 0:
                orbit, tangent = self._located(kind, tests[0][kind], tests[1][kind])
                if orbit is None:
                    continue
                is_fold = kind == "branch" and tests[0]["fold"] * tests[1]["fold"] < 0
                if kind != "fold" or orbit.multipliers.size == 0:
                    found.append(FamilyPoint("fold" if is_fold else kind, orbit, number, tangent))
        return found

    def _tests(self, orbit: PeriodicOrbit, tangent: Array) -> dict[str, float]:
        """Functions that change their signs where something changes."""
        sums = orbit.multipliers[: len(orbit.multipliers) // 2]
        sums = sums + 1 / sums
        gradient = self.held.held[self.name][0].gradient(self._with_parameter(orbit.start)) * self.units
        pairs = [sums[i] - sums[j] for i in range(len(sums)) for j in range(i)]
        return {
            "fold": float(linear.matmul(gradient, tangent[: len(gradient)])),
            "branch": float(np.prod(2 - sums).real) if len(sums) else 1.0,
            "double period": float(np.prod(-2 - sums).real) if len(sums) else 1.0,
            "collision": float(np.prod(np.array(pairs) ** 2).real) if pairs else 1.0,
        }

    def _located(self, kind: str, low: float, high: float) -> tuple[PeriodicOrbit | None, Array]:
        """The orbit at which a test function vanishes."""
        kept = self.loops, self.tangent
        self.loops, self.tangent, length = self.before
        a, b, best, side = 0.0, length, None, 0
        tangent = self.tangent
        try:
            for _ in range(_SECANTS):
                middle = (a * high - b * low) / (high - low)
                loops = self.moved(middle)
                if not loops.residual[0] <= CLOSES:
                    break
                tangent = self.closing.null_space(loops, 1)[0]
                tangent = tangent if linear.matmul(tangent, self.tangent) > 0 else -tangent
                best = self.orbit(loops)
                value = self._tests(best, tangent)[kind]
                if value == 0 or abs(b - a) < _SAME**2 * length:
                    break
                if value * high > 0:
                    b, high, low, side = middle, value, low / 2 if side == 1 else low, 1
                else:
                    a, low, high, side = middle, value, high / 2 if side == -1 else high, -1
        finally:
            self.loops, self.tangent = kept
        return best, tangent
