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
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.family_equations import free_parameter
from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import OrbitError, ParameterError, TimeLimitError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_positive
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import counted, shown
from liepoisson.io.display import Found
from liepoisson.io.tables import Tabular
from liepoisson.leaf._checks import as_energy, as_system
from liepoisson.leaf.leaf import Leaf
from liepoisson.model.free_parameter import FreeParameter
from liepoisson.numeric.run_options import RunOptions
from liepoisson.orbits.closed_orbits import (
    CLOSES,
    ISOLATED,
    Momenta,
    PeriodicOrbit,
    orbit_columns,
    problem_at,
    with_parameter,
)
from liepoisson.orbits.closing import GROWTH, Loops, guessed
from liepoisson.orbits.level import level_of
from liepoisson.orbits.multipliers import HYPERBOLIC, SymmetricOrbit
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from pathlib import Path

    from xarray import Dataset

    from liepoisson.model.system import System
    from liepoisson.orbits.saved_families import SavedFamily

_FIRST = 1e-2
"""The first step, and the amplitude of the first orbit around an equilibrium, in units of the level."""
_LONGEST, _SHORTEST = 0.2, 1e-7
_LEAST = 0.01
"""Part of the longest step down to which one is made again where a point in it was not located."""
_GOOD, _BAD = 0.2, 0.5
"""The step grows where its tangents differ by less than the first angle, and is made again above the second."""

_SAME = 1e-6
_SECANTS, _TRIALS = 40, 8
_ZERO = 1e-13
"""A test function vanishes below this part of its change: the multipliers have no more digits."""
_KNOWN = 4
_NEAR = 0.1
"""How near the period of a small orbit must be to that of the linear equations."""
_SMALL = 4.0
_TOO_SHORT, _AT_REST = "the steps became too short", "an equilibrium"
_HOMOCLINIC = "an equilibrium on the orbit, which is homoclinic there"
_STAYS = (_TOO_SHORT, _AT_REST, _HOMOCLINIC)
"""Ends at which no further orbit was reached."""
Rates: TypeAlias = "tuple[Array, Array, Array]"
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
        is_located: Whether the point was located to round-off; else Newton's method failed near it, and `orbit` is the
            nearest one that was found.
        tangent: The direction of the family there: of the start, in units of the level, of the relative time, and of
            the angles.
    """

    kind: str
    orbit: PeriodicOrbit
    after: int
    is_located: bool
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
        """The columns of the table: of each orbit its level, period, stability, start, multipliers, and `next_point`.

        `next_point` says what lies between it and the next orbit ("branch at 0.161551515").
        """
        points = [""] * len(self.found)
        for one in self.points:
            words = f"{one.kind} at {value_of(one.orbit, self.along):.9g}"
            points[one.after] = ", ".join(filter(None, [points[one.after], words]))
        return orbit_columns(self.found, self.system) | {"next_point": np.array(points)}

    @property
    def dataset(self) -> Dataset:
        """The family as a labelled xarray Dataset."""
        return self._saved.dataset

    def save(self, path: str | Path) -> Path:
        """Writes a NetCDF file; `liepoisson.load` reads it as the same family, from whose last orbit another may go on.

        Raises:
            OutputError: The name does not end in .nc, or the file cannot be written.
        """
        return self._saved.save(path)

    @property
    def _saved(self) -> SavedFamily:
        from liepoisson.orbits.saved_families import SavedFamily

        return SavedFamily.of(self)

    def _head(self) -> str:
        points = ", ".join(f"{one.kind} at {value_of(one.orbit, self.along):.9g}" for one in self.points)
        return (
            f"{counted(len(self.found), 'orbit')} of a family of {self.system.name!r}, {self.along} "
            f"{self.value[0]:.9g} to {self.value[-1]:.9g}; {points or 'no bifurcation'}; ended: {self.end}."
        )

    def _row(self, one: PeriodicOrbit, /) -> tuple[str, ...]:
        return (
            f"{value_of(one, self.along):.9g}",
            f"{one.period:.8f}",
            one.stability,
            one.multiplier_words,
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
    increasing: bool | None = None,
    mode: int | None = None,
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
        increasing: Whether the value increases at the beginning; by default it moves towards `until`, or increases.  Of
            a branch it is not asked.
        mode: Of an equilibrium, which frequency, 0 for the largest.
        max_orbits: At most so many orbits.
        longest_step: The longest step between starts, in units of the level.  Two points of one kind between neighbours
            hide each other; shorter steps show them.
        momenta: Linear integrals that are held, as for `periodic_orbit`.

    Returns:
        The orbits with their multipliers, the bifurcations between them, and why it ends.

    Raises:
        OrbitError: no orbit of the family was found near the start.
        ParameterError: the equilibrium has no such frequency, the orbit belongs to a family on its own level, or a
            value is not as it must be.
    """
    run = RunOptions.read(None, threads, time_limit, progress)
    system, most = as_system(system), as_count(max_orbits, "max_orbits", least=2, most=100_000)
    own = getattr(start.orbit if isinstance(start, FamilyPoint) else start, "system", system)
    variable = free_parameter(system, own, along, "energy", *system.functions.casimirs)
    bound = None if until is None else as_energy(until, "until")
    name = "H" if along == "energy" else along
    longest = as_positive(longest_step, "longest_step", "a length in units of the level", example=_LONGEST)
    follower = _Follower(system if variable is None else own, name, momenta, longest, variable)
    orbits: list[PeriodicOrbit] = []
    points: list[FamilyPoint] = []
    end = ""
    with run.deadline.running():
        follower.begin(start, mode)
        orbits.append(follower.orbit())
        follower.turn_towards(bound, increasing)
        while not end and len(orbits) < most:
            try:
                end = follower.advance(bound)
                if end in _STAYS:
                    break
                new = follower.orbit()
                between = follower.points_between(len(orbits) - 1, orbits[-1], new)
                if not all(one.is_located for one in between) and follower.can_go_back():
                    end = ""
                    continue
                orbits.append(new)
                points += between
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
        self.step, self.is_branch = min(_FIRST, longest), False

    def _with_parameter(self, state: Array) -> Array:
        """A state, with the parameter behind it if one varies."""
        return state if self.variable is None else np.append(state, self.variable.value)

    def begin(self, start: FamilyStart, mode: int | None) -> None:
        """The first loop, and a direction of the family.

        Raises:
            OrbitError: Newton's method does not come to an orbit.
            ParameterError: the equilibrium has no such frequency, or the start is neither of these.
        """
        if mode is not None and not isinstance(start, Equilibrium):
            raise ParameterError(f"mode: it is which frequency of an equilibrium; the start is {shown(start)}")
        if isinstance(start, FamilyPoint):
            return self._begin_a_branch(start)
        if isinstance(start, Equilibrium):
            self._begin_at_rest(start, 0 if mode is None else mode)
        elif isinstance(start, (PeriodicOrbit, SymmetricOrbit)):  # pyright: ignore[reportUnnecessaryIsInstance]
            symmetry, time = None, start.period
            if isinstance(start, PeriodicOrbit) and self.variable is None:  # which may break the symmetry
                symmetry, time = start.symmetry, start.time
            momenta = self.momenta or (dict(start.momenta) if isinstance(start, PeriodicOrbit) else ())
            self._problem(start.start, momenta, symmetry)
            state = self._with_parameter(start.start)
            self.loops = self.held.solved(self.problem.loops(state[None], np.array([time])))
            if not self.loops.residual[0] <= CLOSES:
                raise OrbitError(
                    f"start: wanted an orbit that closes to {CLOSES:g}; it does to {self.loops.residual[0]:.1e}"
                )
            if not self.loops.regularity[0] > ISOLATED:
                raise ParameterError(
                    "start: wanted an orbit that is alone on its level (and values of momenta); this one belongs to a "
                    "family there, or is a fold or a branch. Hold a further integral by momenta=[...], or begin nearby"
                )
        else:
            raise ParameterError(f"start: wanted a periodic orbit or an equilibrium; got {shown(start)}")
        self.tangent = self._tangent_of(self.loops)

    def turn_towards(self, bound: float | None, increasing: bool | None) -> None:
        """Go on towards a value, or to larger or smaller ones."""
        slope = self._slope()
        if increasing is None:
            increasing = bound is None or bound > self._value(self.loops)
        if (slope < 0) == increasing and slope != 0 and not self.is_branch:
            self.tangent = -self.tangent

    def _value(self, loops: Loops) -> float:
        """The energy, the Casimir or the parameter that varies."""
        return float(self.free(loops.state[0, 0]))

    def _tangent_of(self, loops: Loops, like: Array | None = None) -> Array:
        """The direction of the family at a loop; NaN where its neighbours cannot be followed."""
        try:
            tangent = self.closing.null_space(loops, 1)[0]
        except linear.LinAlgError:
            return np.full(len(self.units) + 1 + loops.angle.shape[1], np.nan)
        return -tangent if like is not None and linear.matmul(tangent, like) < 0 else tangent

    def _problem(self, state: Array, momenta: Momenta, symmetry: Any, on: Array | None = None) -> None:
        """The equations near a state, with the values of H, of Casimirs and of momenta there, or at a state `on`."""
        self.problem = problem_at(self.system, state, momenta=momenta, symmetry=symmetry, threads=1)
        functions, held = self.system.functions, dict(self.problem.closing.held)
        self.free = functions.energy if self.name == "H" else functions.casimirs.get(self.name, functions.energy)
        if self.variable is not None:
            self.problem = with_parameter(self.problem, self.variable)
            held = dict(self.problem.closing.held)
            self.free = held[self.name][0]
        elif self.name != "H":  # the whole of it, with what depends on the Casimir that varies
            held["H"] = functions.energy, float(functions.energy(state))
        if on is not None:
            at = self._with_parameter(on)
            held = {name: (function, float(function(at))) for name, (function, _) in held.items()}
        self.held = replace(self.problem.closing, held=held)
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
        self.loops, self.is_branch = new, True
        self.tangent = self._tangent_of(new, self.tangent)

    def _begin_at_rest(self, rest: Equilibrium, mode: int) -> None:
        """An orbit of small amplitude around an equilibrium."""
        found: Any = linear.eig(self.system.functions.jacobian(rest.state))
        values, vectors = found
        size = np.abs(values).max(initial=0.0)
        chosen = [k for k in range(len(values)) if values[k].imag > _SAME * size and abs(values[k].real) < _SAME * size]
        chosen.sort(key=lambda k: -values[k].imag)
        if not 0 <= as_count(mode, "mode") < len(chosen):
            what = f"mode: wanted one of {len(chosen)} frequencies of the equilibrium; got {mode}"
            what = what if chosen else "start: wanted an equilibrium around which orbits oscillate; this one has none"
            raise ParameterError(f"{what}. Its eigenvalues are {np.round(values, 6).tolist()}")
        k = chosen[mode]
        direction = vectors[:, k].real / linear.norm(vectors[:, k].real)
        length, time = float(np.abs(rest.state).max()) or 1.0, 2 * np.pi / values[k].imag
        for n in range(_TRIALS):  # how small the orbits must be, only the nonlinear terms know
            state = rest.state + _FIRST * 10.0**-n * length * direction
            self._problem(state, self.momenta, None, rest.state)
            scaled, extra = (
                direction / self.units[: len(state)],
                np.zeros(len(self.units) + 1 + len(self.closing.rotations)),
            )
            extra[: len(state)] = scaled / linear.norm(scaled)
            with np.errstate(all="ignore"):
                loops = self.problem.loops(self._with_parameter(state)[None], np.array([time]))
                self.loops = self.closing.solved(loops, extra=extra)
            if self.loops.residual[0] <= CLOSES and abs(self.loops.time[0] / time - 1) < _NEAR:
                return
        raise OrbitError(
            f"an orbit around the equilibrium must close to {CLOSES:g}; those of the frequency {values[k].imag:.6g} do "
            f"to {self.loops.residual[0]:.1e}. Another frequency may be a multiple of it: the eigenvalues are "
            f"{np.round(values, 6).tolist()}"
        )

    def orbit(self, loops: Loops | None = None) -> PeriodicOrbit:
        """The loop with its multipliers, on its own level."""
        loops = self.loops if loops is None else loops
        start = loops.state[0, 0]
        if self.variable is not None:
            system, state = self.variable.at(float(start[-1])), start[:-1]
            problem = problem_at(system, state, momenta=tuple(self.problem.momenta), threads=1)
            return _alone(problem.described(replace(loops, state=loops.state[..., :-1])))
        level = self.held.level
        if self.name != "H":
            level = level_of(self.system, Leaf.through(self.system, start), float(self.system.functions.energy(start)))
        closing = replace(self.held, level=replace(level.through(start), units=self.units))
        return _alone(replace(self.problem, closing=closing).described(loops))

    def _slope(self) -> float:
        """The derivative of the free value along the tangent."""
        gradient = self.free.gradient(self.loops.state[0, 0]) * self.units
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
        is_homoclinic = False
        while self.step > _SHORTEST:
            new, length, is_last = self.moved(self.step), self.step, False
            old, value = self._value(self.loops), self._value(new)
            if (
                new.residual[0] <= CLOSES
                and bound is not None
                and old != bound
                and (old - bound) * (value - bound) <= 0
            ):
                function = self.held.held[self.name][0]
                rest = 0.0 if function is self.free else float(function(new.state[0, 0])) - value  # of Casimirs alone
                closing = replace(self.held, held={**self.held.held, self.name: (function, bound + rest)})
                length *= (bound - old) / (value - old)
                new, is_last = closing.solved(self.moved(length)), True
            if new.residual[0] <= CLOSES:
                if self._has_turned(new):
                    if self._is_small(new):
                        return _AT_REST
                    is_homoclinic = True
                    self.step /= 2
                    continue
                tangent = self._tangent_of(new, self.tangent)
                angle = float(elementary.arccos(min(1.0, float(linear.matmul(tangent, self.tangent)))))
                if angle < _BAD:
                    break
            self.step /= 2
        else:
            return _HOMOCLINIC if is_homoclinic else _TOO_SHORT
        self.piece = self._piece((self.loops, self.tangent), (new, tangent))
        self.loops, self.tangent = new, tangent
        if is_last:
            return "the wanted value"
        if angle < _GOOD:
            self.step = min(self.longest, 1.5 * self.step)
        if np.abs(self.closing.linearised(new.state, new.time, new.angle).segments).max() > GROWTH**2:
            self.loops = self.closing.solved(self.problem.loops(new.state[:, 0], new.time, new.angle))
        return ""

    def can_go_back(self) -> bool:
        """Go back by the last step, to make it again with half the length, if it was not short."""
        if self.piece.length < _LEAST * self.longest:
            return False
        self.loops, self.tangent, self.step = self.piece.ends[0], self.piece.tangents[0], self.piece.length / 2
        return True

    def _has_turned(self, loops: Loops) -> bool:
        """Whether the velocity of the start has turned around: between the two starts is an equilibrium."""
        field = self.closing.flow.system.vector_field
        rates = [field(one.state[0, 0]) / self.units for one in (self.loops, loops)]
        return bool(linear.matmul(rates[0], rates[1]) < 0)

    def _is_small(self, loops: Loops) -> bool:
        """Whether the orbit is as small as the step: it shrinks to the equilibrium, after which the same orbits come.

        A small one has the size $2a$, and the step to one of the amplitude $-b$ the length $a + b$; an orbit that comes
        near to a saddle stays large.
        """
        start, time = self.loops.state[0, 0], float(self.loops.time[0])
        half, _ = self.closing.flow.ends(start[None], np.array([time / 2]))
        size, step = (linear.norm((one - start) / self.units) for one in (half[0], loops.state[0, 0]))
        return bool(size < _SMALL * step)

    def points_between(self, number: int, first: PeriodicOrbit, last: PeriodicOrbit) -> list[FamilyPoint]:
        """What changes between the last two orbits, located by the secant method (Illinois) along the family.

        Args:
            number: That of the first of them.
            first: It.
            last: The other.
        """
        piece = self.piece
        tests = self._tests(first, piece.tangents[0]), self._tests(last, piece.tangents[1])
        changed = {kind for kind in tests[0] if tests[0][kind] * tests[1][kind] < 0}
        if "fold" in changed and not first.multipliers.size:
            changed.add("branch")  # without multipliers there is nothing else to see
        found: list[tuple[float, FamilyPoint]] = []
        for kind in sorted(changed - {"fold"}):
            test = "fold" if kind == "branch" and not first.multipliers.size else kind
            place, loops, tangent, is_exact = self._located(piece, test, tests[0][test], tests[1][test])
            name = "fold" if kind == "branch" and "fold" in changed else kind
            found.append((place, self._point(name, number, loops, tangent, is_exact)))
        if "fold" in changed and "branch" not in changed:
            found.append(self._crossed(number, tests[0]["fold"], tests[1]["fold"]))
        return [point for _, point in sorted(found, key=lambda one: one[0])]

    def _point(self, kind: str, number: int, loops: Loops, tangent: Array, is_located: bool) -> FamilyPoint:
        return FamilyPoint(kind, self.orbit(loops), number, is_located, tangent)

    def _tests(self, orbit: PeriodicOrbit, tangent: Array) -> dict[str, float]:
        """Functions that change their signs where something changes."""
        sums = orbit.multipliers[: len(orbit.multipliers) // 2]
        sums = sums + 1 / sums
        gradient = self.free.gradient(self._with_parameter(orbit.start)) * self.units
        pairs = [sums[i] - sums[j] for i in range(len(sums)) for j in range(i)]
        return {
            "fold": float(linear.matmul(gradient, tangent[: len(gradient)])),
            "branch": float(np.prod(2 - sums).real) if len(sums) else 1.0,
            "double period": float(np.prod(-2 - sums).real) if len(sums) else 1.0,
            "collision": float(np.prod(np.array(pairs) ** 2).real) if pairs else 1.0,
        }

    def _piece(self, first: tuple[Loops, Array], last: tuple[Loops, Array]) -> _Piece:
        """The family between two loops with their tangents."""
        rates: list[Rates] = []
        for loops, tangent in (first, last):
            found = self.closing.linearised(loops.state, loops.time, loops.angle)
            moves, delay, turned = replace(found, gaps=np.zeros_like(found.gaps)).moves(tangent[None])
            rates.append((moves * self.units, delay * loops.time, turned))
        return _Piece((first[0], last[0]), (first[1], last[1]), (rates[0], rates[1]), self.units)

    def _located(self, piece: _Piece, kind: str, low: float, high: float) -> tuple[float, Loops, Array, bool]:
        """Where on a piece a test function vanishes: the place, the loop, the tangent there, and whether it is exact.

        Where families cross, the equations are singular: Newton's method begins so near to the one that is followed,
        on a curve through its loops that are known, that it stays there.
        """
        a, b, side, k = 0.0, piece.length, 0, int(abs(high) < abs(low))
        nearest = (piece.length * k, piece.ends[k], piece.tangents[k], False)
        for _ in range(_SECANTS):
            middle = (a * high - b * low) / (high - low)
            guess, along = piece.at(middle)
            loops = self.closing.solved(guess, extra=piece.tangents[0])
            if not loops.residual[0] <= CLOSES:
                break
            piece.add(middle, loops)
            across = self.closing.null_space(loops, 2 if kind == "branch" else 1)
            tangent = linear.matmul(linear.matmul(across, along), across)
            tangent = tangent / linear.norm(tangent)
            value = self._tests(self.orbit(loops), tangent)[kind]
            is_exact = abs(b - a) < _SAME**2 * piece.length or abs(value) <= _ZERO * abs(high - low)
            nearest = (middle, loops, tangent, is_exact)
            if is_exact:
                break
            if value * high > 0:
                b, high, low, side = middle, value, low / 2 if side == 1 else low, 1
            else:
                a, low, high, side = middle, value, high / 2 if side == -1 else high, -1
        return nearest

    def _crossed(self, number: int, low: float, high: float) -> tuple[float, FamilyPoint]:
        """Where the value turns but no multiplier passes 1: the family crosses another one there, which has the branch.

        The point is located along the other one.
        """
        place, loops, tangent, _ = self._located(self.piece, "fold", low, high)
        near = place, self._point("branch", number, loops, tangent, False)
        plane = self.closing.null_space(loops, 2)
        along = linear.matmul(plane, tangent)
        other = linear.matmul(np.array([-along[1], along[0]]) / linear.norm(along), plane)
        kept, ends = (self.loops, self.tangent), list[tuple[Loops, Array]]()
        try:
            for way in (-1, 1):
                self.loops, self.tangent = loops, way * other
                moved = self.moved(self.piece.length / 4)
                if not moved.residual[0] <= CLOSES:
                    return near
                ends.append((moved, self._tangent_of(moved, other)))
        finally:
            self.loops, self.tangent = kept
        values = [self._tests(self.orbit(one), there)["branch"] for one, there in ends]
        if values[0] * values[1] >= 0:
            return near
        _, loops, along, is_exact = self._located(self._piece(*ends), "branch", *values)
        plane = self.closing.null_space(loops, 2)
        own = linear.matmul(linear.matmul(plane, tangent), plane)
        own = own - linear.matmul(own, along) * along
        return place, self._point("branch", number, loops, own / linear.norm(own), is_exact)


class _Piece:
    """A family between two loops: a cubic curve with its tangents, corrected by the loops that were found on it."""

    def __init__(
        self, ends: tuple[Loops, Loops], tangents: tuple[Array, Array], rates: tuple[Rates, Rates], units: Array
    ) -> None:
        self.ends, self.tangents, self.units = ends, tangents, units
        first, last = (_flat(one.state, one.time, one.angle) for one in ends)
        slopes = [_flat(*rate) for rate in rates]
        self.length = self._along(last - first)
        slopes = [slope / self._along(slope) for slope in slopes]
        self.cubic = first, slopes[0], last, slopes[1]
        self.known: list[tuple[float, Array]] = []

    def _along(self, change: Array) -> float:
        """The displacement of the first state, of the time and of the angles along the first tangent."""
        n, k = len(self.units), self.ends[0].angle.shape[1]
        time = float(self.ends[0].time[0])
        own = np.concatenate([change[:n] / self.units, [change[len(change) - k - 1] / time], change[len(change) - k :]])
        return float(linear.matmul(self.tangents[0], own))

    def add(self, place: float, loops: Loops) -> None:
        """Let the curve pass through a loop."""
        u = place / self.length
        off = _flat(loops.state, loops.time, loops.angle) - self._cubic(u)[0]
        if all(abs(u - other) > _SAME for other, _ in self.known):
            self.known = [*self.known, (u, off / (u * (1 - u)) ** 2)][-_KNOWN:]

    def at(self, place: float) -> tuple[Loops, Array]:
        """The loop of the curve at a displacement, and the direction there, as a tangent is written."""
        u = place / self.length
        value, slope = self._cubic(u)
        for j, (one, off) in enumerate(self.known):  # Lagrange's polynomial of what is left, by u^2 (1 - u)^2
            weight = float(np.prod([(u - other) / (one - other) for i, (other, _) in enumerate(self.known) if i != j]))
            value = value + (u * (1 - u)) ** 2 * weight * off
        shape, k = self.ends[0].state.shape, self.ends[0].angle.shape[1]
        n, time = len(self.units), value[len(value) - k - 1 : len(value) - k]
        loops = guessed(value[: len(value) - k - 1].reshape(shape), time, value[len(value) - k :][None])
        along = np.concatenate([slope[:n] / self.units, slope[len(slope) - k - 1 : len(slope) - k] / time])
        return loops, np.concatenate([along, slope[len(slope) - k :]])

    def _cubic(self, u: float) -> tuple[Array, Array]:
        """Hermite's polynomial, and its derivative by the displacement."""
        first, rate, last, rate_at_end = self.cubic
        h = self.length
        value = (1 + 2 * u) * (1 - u) ** 2 * first + u * (1 - u) ** 2 * h * rate
        value = value + u * u * (3 - 2 * u) * last + u * u * (u - 1) * h * rate_at_end
        slope = 6 * u * (1 - u) * (last - first) / h + (1 - u) * (1 - 3 * u) * rate + u * (3 * u - 2) * rate_at_end
        return value, slope


def _alone(orbit: PeriodicOrbit) -> PeriodicOrbit:
    """The orbit, alone on its level if no multiplier is 1: the loop was found without the level's equation."""
    return replace(orbit, is_isolated=bool((np.abs(orbit.multipliers - 1) > HYPERBOLIC).all()))


def _flat(state: Array, time: Array, angle: Array) -> Array:
    """A loop, or its change, as one vector."""
    return np.concatenate([state.ravel(), time, angle.ravel()])
