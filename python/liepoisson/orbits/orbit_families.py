r"""Families of periodic orbits: followed in the energy, in a Casimir, or in a parameter.

With one of the held values set free, or a parameter, as a component of the state that does not move, loops form a
curve (`liepoisson.orbits.family_loops`), which is followed and searched for points where something changes by
`liepoisson.numeric.curves`.

References: [doedel2003]; [munozalmaraz2003].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.family_equations import free_parameter
from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import OrbitError, ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_positive
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import counted, shown
from liepoisson.io.display import Found
from liepoisson.leaf._checks import as_energy, as_system
from liepoisson.leaf.leaf import Leaf
from liepoisson.model.free_parameter import FreeParameter
from liepoisson.numeric.curves import FIRST, LONGEST, TOO_SHORT, TRIALS, Follower
from liepoisson.numeric.run_options import RunOptions
from liepoisson.orbits.closed_orbits import CLOSES, ISOLATED, SAME, Momenta, PeriodicOrbit
from liepoisson.orbits.family_loops import HOMOCLINIC, FamilyLoop, LoopCurve
from liepoisson.orbits.level import Level, level_of
from liepoisson.orbits.multipliers import SymmetricOrbit, orbit_columns
from liepoisson.orbits.saved_orbits import SavedOrbits
from liepoisson.orbits.slow_passages import slow_passages
from liepoisson.portable import elementary, linear
from liepoisson.structure.casimir_part import ORDINARY

if TYPE_CHECKING:
    from liepoisson.model.system import System

_NEAR = 0.1
"""How near the period of a small orbit must be to that of the linear equations."""
_RANGE = 332
"""Powers of two that are tried as a length, with squares and cubes in the range of doubles."""
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
class OrbitFamily(Found[PeriodicOrbit], SavedOrbits):
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
        end: Why it ends: "the wanted value", "an equilibrium" to which orbits shrink, "orbits homoclinic to the
            equilibrium (0, 1, 0, 0)" or "orbits heteroclinic between 2 equilibria" where the last orbit passes these at
            less than 0.003 of its size and the period grows, "the time limit", a number of orbits; or "the steps became
            too short", which may be near such an equilibrium, too, where multipliers of 1e10 leave no digits.
    """

    kind = "orbit family"
    made_by = "lp.orbits.orbit_family"
    titles = ("along", "period", "stability", "multipliers", "residual")

    along: str
    found: tuple[PeriodicOrbit, ...]
    points: tuple[FamilyPoint, ...]
    end: str

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system, that of the first orbit where a parameter varies."""
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
        columns = orbit_columns(self.found, self.system)
        value = {} if self.along in columns else {self.along: self.value}
        return value | columns | {"next_point": np.array(points)}

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
    longest_step: float = LONGEST,
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
    longest = as_positive(longest_step, "longest_step", "a length in units of the level", example=LONGEST)
    with run.deadline.running():
        family = _Family(system if variable is None else own, name, momenta, longest, variable)
        follower = family.follower(start, mode)
        if not isinstance(start, FamilyPoint):
            follower.turn_towards(bound, increasing)
        found, zeros, end = follower.followed(bound, most, run, lambda loop: loop.orbit)
        if end in (TOO_SHORT, HOMOCLINIC) and found[-1].period > found[max(0, len(found) - 2)].period:
            end = slow_passages(follower.here[0]) or end
    points = (FamilyPoint(one.kind, one.point.orbit, one.after, one.is_located, one.tangent) for one in zeros)
    return OrbitFamily(along, found, tuple(points), end or f"{most} orbits")


@dataclass(frozen=True)
class _Family:
    """What family is asked for."""

    system: System
    name: str
    momenta: Momenta
    longest: float
    variable: FreeParameter | None

    def _near(self, state: Array, units: Array, **options: Any) -> LoopCurve:
        options = {"momenta": self.momenta} | options
        return LoopCurve.near(self.system, state, units, self.name, self.variable, **options)

    def follower(self, start: FamilyStart, mode: int | None) -> Follower[FamilyLoop]:
        """What begins at the first loop, in a direction of the family.

        Raises:
            OrbitError: Newton's method does not come to an orbit.
            ParameterError: the equilibrium has no such frequency, or the start is none of these.
        """
        if mode is not None and not isinstance(start, Equilibrium):
            raise ParameterError(f"mode: it is which frequency of an equilibrium; the start is {shown(start)}")
        if isinstance(start, FamilyPoint):
            return self._on_a_branch(start)
        if isinstance(start, Equilibrium):
            return Follower(*self._at_rest(start, 0 if mode is None else mode), self.longest)
        if isinstance(start, (PeriodicOrbit, SymmetricOrbit)):  # pyright: ignore[reportUnnecessaryIsInstance]
            return Follower(*self._at_an_orbit(start), self.longest)
        raise ParameterError(f"start: wanted a periodic orbit or an equilibrium; got {shown(start)}")

    def _at_an_orbit(self, start: PeriodicOrbit | SymmetricOrbit) -> tuple[LoopCurve, FamilyLoop]:
        symmetry, time, momenta = None, start.period, self.momenta
        if isinstance(start, PeriodicOrbit):
            momenta = momenta or dict(start.momenta)
            if self.variable is None:  # which may break the symmetry
                symmetry, time = start.symmetry, start.time
        curve = self._near(start.start, start.level.units, momenta=momenta, symmetry=symmetry)
        loops = curve.held.solved(curve.first(start.start, time))
        if not loops.residual[0] <= CLOSES:
            raise OrbitError(f"start: wanted an orbit that closes to {CLOSES:g}; it does to {loops.residual[0]:.1e}")
        if not loops.regularity[0] > ISOLATED:
            raise ParameterError(
                "start: wanted an orbit that is alone on its level (and values of momenta); this one belongs to a "
                "family there, or is a fold or a branch. Hold a further integral by momenta=[...], or begin nearby"
            )
        return curve, FamilyLoop(curve, loops)

    def _on_a_branch(self, point: FamilyPoint) -> Follower[FamilyLoop]:
        """The first orbit of the branch that leaves a family at a point: across the family in the null space."""
        if point.kind not in _LEAVES:
            raise ParameterError(f"start: wanted a point of the kinds {' or '.join(_LEAVES)}; got a {point.kind}")
        orbit, turns = point.orbit, 2 if point.kind == "double period" else 1
        if turns == 2 and orbit.symmetry is not None:
            raise ParameterError("start: wanted an orbit that closes without a symmetry, to be run through twice")
        momenta = self.momenta or dict(orbit.momenta)
        curve = self._near(orbit.start, orbit.level.units, momenta=momenta, symmetry=orbit.symmetry)
        loop = FamilyLoop(curve, curve.first(orbit.start, turns * orbit.time, turns * orbit.angles[None]))
        follower = Follower(curve, loop, self.longest)
        if not follower.leave(point.tangent):
            raise OrbitError("start: no branch was found beside the family; it may be tangent to it")
        return follower

    def _at_rest(self, rest: Equilibrium, mode: int) -> tuple[LoopCurve, FamilyLoop]:
        """An orbit of small amplitude around an equilibrium."""
        found: Any = linear.eig(self.system.functions.jacobian(rest.state))
        values, vectors = found
        size = np.abs(values).max(initial=0.0)
        chosen = [k for k in range(len(values)) if values[k].imag > SAME * size and abs(values[k].real) < SAME * size]
        chosen.sort(key=lambda k: -values[k].imag)
        if not 0 <= as_count(mode, "mode") < len(chosen):
            what = f"mode: wanted one of {len(chosen)} frequencies of the equilibrium; got {mode}"
            what = what if chosen else "start: wanted an equilibrium around which orbits oscillate; this one has none"
            raise ParameterError(f"{what}. Its eigenvalues are {np.round(values, 6).tolist()}")
        k = chosen[mode]
        direction = vectors[:, k].real / linear.norm(vectors[:, k].real)
        ellipse = vectors[:, k].imag / linear.norm(vectors[:, k].real)
        time, residual, only_turns = 2 * np.pi / values[k].imag, np.inf, False
        level = level_of(self.system, Leaf.through(self.system, rest.state), rest.energy)
        length = _length(level, rest.state, np.array([direction, ellipse]))
        units = level.in_units_of(rest.state + length * np.array([direction, ellipse])).units
        for n in range(TRIALS):  # how small the orbits must be, only the nonlinear terms know
            state = rest.state + FIRST * 10.0**-n * length * direction
            curve = self._near(state, units, on=rest.state)
            extra = np.zeros(len(curve.units) + 1 + len(curve.closing.rotations))
            extra[: len(state)] = direction / curve.units[: len(state)]
            with np.errstate(all="ignore"):
                loops = curve.closing.solved(curve.first(state, time), extra=extra / linear.norm(extra))
            residual = loops.residual[0]
            if residual <= CLOSES and abs(loops.time[0] / time - 1) < _NEAR:
                size = linear.norm((loops.state[0, 0] - rest.state) / units)
                if curve.closing.extent(loops)[0] > _NEAR * size:
                    return curve, FamilyLoop(curve, loops)
                only_turns = True
        if only_turns:
            raise OrbitError(
                f"an orbit must move; those of the frequency {values[k].imag:.6g} around the equilibrium only turn, by "
                f"the flows of {', '.join(map(str, self.momenta))}: they are relative equilibria. Leave out the momenta"
            )
        raise OrbitError(
            f"an orbit around the equilibrium must close to {CLOSES:g}; those of the frequency {values[k].imag:.6g} do "
            f"to {residual:.1e}. Another frequency may be a multiple of it: the eigenvalues are "
            f"{np.round(values, 6).tolist()}"
        )


@np.errstate(all="ignore")  # the equations need not exist far off
def _length(level: Level, rest: Array, axes: Array) -> float:
    """About the distance from an equilibrium at which the linear equations are no longer those of the system.

    The size of its state, or 1 at zero; where that is too far from it by a factor of `ORDINARY`, the power of two up to
    which Df changes by no more than its own size along the axes of the linear orbits, shape (2, N).
    """
    given = float(np.abs(rest).max()) or 1.0
    tried = elementary.exp2(np.arange(-_RANGE, _RANGE + 1.0))
    units = level.in_units_of(rest + tried[0] * axes).units
    slope, slopes = (
        level.system.functions.jacobian(x) * (units / units[:, None])
        for x in (rest, rest + tried[:, None, None] * axes)
    )
    change = np.abs(slopes - slope).max(axis=(1, 2, 3))
    far = np.nonzero(~(change <= np.abs(slope).max()))[0]
    if not len(far) or far[0] == 0:
        return given
    found = float(tried[far[0] - 1])
    return found if max(found / given, given / found) > ORDINARY else given
