r"""Families of equilibria: followed in a Casimir, in the value of an integral, or in a parameter.

With one value, or a parameter, set free the solutions of the equations (`liepoisson.equilibrium.family_equations`) form
curves, which are followed by their tangents (pseudo-arclength), so that folds are no obstacle.  Along a curve the
following functions, each in its order, are continuous, and their zeros are located by the secant method (Illinois) to
round-off:

* the derivative of the free value along the tangent; it vanishes at a fold;
* the eigenvalues of the second variation on the level of what is held, modulo symmetries.  Where one passes zero the
  equations are singular: at a fold, where their derivative still has full rank, or at a branch point;
* $(\sigma_i - \sigma_j)^2$ for the squares $\sigma = \mu^2$ of the eigenvalues of the linearised flow, where it is
  real: negative for a pair of complex numbers.  Where it passes zero, two imaginary pairs meet and leave the axis (a
  Hamiltonian Hopf bifurcation), or two real ones do.

References: [keller1977]; [vandermeer1985], the Hamiltonian Hopf bifurcation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.equilibrium_list import equilibrium_columns
from liepoisson.equilibrium.family_equations import HOLDS, SAME, FamilyEquations, Place, family_equations, value_of
from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import ParameterError, TimeLimitError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_positive
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import shown
from liepoisson.io.display import Found
from liepoisson.io.tables import Tabular
from liepoisson.leaf._checks import as_energy, as_system
from liepoisson.numeric.run_options import RunOptions
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from liepoisson.model.system import System

_FIRST, _LONGEST, _SHORTEST = 1e-2, 0.2, 1e-6
"""The first and the longest step, in units of the leaf, and the shortest, relative to the longest."""
_GOOD, _BAD = 0.2, 0.5
"""The step grows where its tangents differ by less than the first angle, and is made again above the second."""
_SECANTS, _TRIALS, _ROUND_OFF = 60, 8, 1e-14
_TOO_SHORT, _SINGULAR = "the steps became too short", "a singular level"


@dataclass(frozen=True, eq=False)
class EquilibriumFamilyPoint(ReadOnlyArrays):
    """A point of a family of equilibria at which something changes.

    Example:
        >>> hoop = lp.System(lp.canonical(1), "p1^2/2 - cos(q1) - w*sin(q1)^2/2", {"w": 0.5})
        >>> rest = lp.phase_space.equilibrium(hoop, [0, 0])
        >>> (point,) = lp.phase_space.equilibrium_family(hoop, rest, along="w", until=1.5).points
        >>> point.kind, round(point.value, 12)
        ('branch', 1.0)

    Attributes:
        kind: "fold", "branch", "Hamiltonian Hopf" (imaginary pairs meet and leave the axis) or "collision" (real ones
            do).
        value: The Casimir, the integral or the parameter there.
        equilibrium: The equilibrium.
        after: The number of the equilibrium of the family before it.
        tangent: The direction of the family there: of the state, of the parameter, if one varies, and of the
            multipliers, in units of the leaf.
    """

    kind: str
    value: float
    equilibrium: Equilibrium
    after: int
    tangent: Array


@dataclass(frozen=True, eq=False, repr=False)
class EquilibriumFamily(Found[Equilibrium], Tabular):
    """Equilibria of a family, in their order along it.

    Example:
        >>> top = lp.catalog.system("lagrange")
        >>> upright = lp.phase_space.equilibrium(top, [0, 0, 3, 0, 0, 1])
        >>> family = lp.phase_space.equilibrium_family(top, upright, along="C1", increasing=False, until=1.5)
        >>> [(point.kind, round(point.value, 12)) for point in family.points]  # it falls asleep at l3^2 = 4 I1 a3
        [('Hamiltonian Hopf', 2.0)]

    Attributes:
        along: What was set free: the name of a Casimir, of an integral or of a parameter.
        found: The equilibria.
        points: Folds, branches and collisions of eigenvalues between them.
        end: Why it ends.
    """

    titles = ("along", "energy", "linear", "growth", "signature", "energy-Casimir")

    along: str
    found: tuple[Equilibrium, ...]
    points: tuple[EquilibriumFamilyPoint, ...]
    end: str

    @property
    def value(self) -> Array:
        """The Casimir, the integral or the parameter at each equilibrium, shape (equilibrium,)."""
        return np.array([value_of(one, self.along) for one in self.found])

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each equilibrium the free value, energy, state and stability."""
        return {self.along: self.value, **equilibrium_columns(self.found, self.found[0].system.component_names)}

    def _head(self) -> str:
        points = ", ".join(f"{one.kind} at {one.value:.9g}" for one in self.points)
        return (
            f"{len(self.found)} equilibria of a family of {self.found[0].system.name!r}, {self.along} "
            f"{self.value[0]:.9g} to {self.value[-1]:.9g}; {points or 'no bifurcation'}; ended: {self.end}."
        )

    def _row(self, one: Equilibrium, /) -> tuple[str, ...]:
        verdicts = one.linear_stability, f"{one.growth_rate:.4g}", str(one.signature), one.nonlinear_stability
        return f"{value_of(one, self.along):.9g}", f"{one.energy:.6g}", *verdicts


EquilibriumFamilyStart: TypeAlias = "Equilibrium | EquilibriumFamilyPoint"
"""An equilibrium, or a point of a family where a branch leaves it."""


@shows_progress
def equilibrium_family(
    system: System,
    start: EquilibriumFamilyStart,
    *,
    along: str,
    until: float | str | None = None,
    increasing: bool | None = None,
    max_equilibria: int = 200,
    longest_step: float = _LONGEST,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> EquilibriumFamily:
    r"""The family of equilibria, or relative equilibria, that one belongs to: in a Casimir, an integral or a parameter.

    Example:
        >>> hoop = lp.System(lp.canonical(1), "p1^2/2 - cos(q1) - w*sin(q1)^2/2", {"w": 0.5})
        >>> rest = lp.phase_space.equilibrium(hoop, [0, 0])
        >>> family = lp.phase_space.equilibrium_family(hoop, rest, along="w", until=1.5)
        >>> tilted = lp.phase_space.equilibrium_family(hoop, family.points[0], along="w", until=2)
        >>> round(float(np.cos(tilted[-1].state[0])), 12)  # cos q = 1/w
        0.5

    Args:
        system: A system whose parameters are all numbers.
        start: An equilibrium of it, isolated on its level but for symmetries; one with respect to integrals belongs to
            a family in which their values are held; or a point of a family, of the kind "branch".
        along: What varies: a Casimir or one of the integrals of the start, by name; or a parameter of the system by its
            name in `parameters`, such as "g", or "a3" of a vector a. Of a `Top`: I1, ..., a1, ..., b1, ..., epsilon.
            Everything else is held.
        until: The value at which the family ends; the last equilibrium has it to round-off.
        increasing: Whether the value increases at the beginning; by default it moves towards `until`, or increases.
        max_equilibria: At most so many equilibria.
        longest_step: The longest step, in units of the leaf.
        time_limit: Seconds after which the family ends with what was found.

    Returns:
        The equilibria with their stability, the bifurcations between them, and why it ends: at the wanted value, at a
        singular level, or where the steps became too short.

    Raises:
        ParameterError: the start is no isolated equilibrium of this system on a regular leaf, or no branch was found
            beside the family; or a value is not as it must be.

    References: [keller1977].
    """
    run = RunOptions.read(None, None, time_limit, progress)
    system, most = as_system(system), as_count(max_equilibria, "max_equilibria", least=2, most=100_000)
    longest = as_positive(longest_step, "longest_step", "a length > 0", example=_LONGEST)
    bound = None if until is None else as_energy(until, "until")
    first = start.equilibrium if isinstance(start, EquilibriumFamilyPoint) else start
    if not isinstance(first, Equilibrium):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"start: wanted an equilibrium or a point of a family; got {shown(start)}")
    follower = _Follower(family_equations(system, first, along), longest)
    found: list[Equilibrium] = []
    points: list[EquilibriumFamilyPoint] = []
    end = ""
    with run.deadline.running():
        follower.begin(start, bound, increasing=increasing)
        found.append(follower.equations.equilibrium(follower.place))
        while not end and len(found) < most:
            try:
                end = follower.advance(bound)
                if end == _TOO_SHORT:  # it has not moved
                    break
                points += follower.points_between(len(found) - 1)
                if follower.is_singular:
                    end = _SINGULAR
                    break
                found.append(follower.equations.equilibrium(follower.place))
            except TimeLimitError:
                end = "the time limit"
            run.tell(len(found) / most)
    return EquilibriumFamily(along, tuple(found), tuple(points), end or f"{most} equilibria")


class _Follower:
    """A place that moves along a family."""

    def __init__(self, equations: FamilyEquations, longest: float) -> None:
        self.equations, self.longest, self.step = equations, longest, min(_FIRST, longest)
        self.place, self.is_singular = equations.first(), False

    def begin(self, start: EquilibriumFamilyStart, bound: float | None, *, increasing: bool | None) -> None:
        """The first place, and the direction in which it goes on.

        Raises:
            ParameterError: it is singular or not isolated, or there is no branch.
        """
        equations = self.equations
        if equations.is_singular(self.place):
            raise ParameterError(
                f"start: wanted independent gradients of {', '.join(equations.held)}; got dependent ones. Leave out "
                "integrals that are critical there"
            )
        if isinstance(start, EquilibriumFamilyPoint):
            return self._begin_a_branch(start)
        unknowns = self.place.unknowns
        self.place = equations.solved(unknowns, self.place, equations.value(unknowns))
        space = equations.null_space(self.place)
        if not self.place.residual <= HOLDS or len(space) > 1:
            raise ParameterError(
                "start: wanted an equilibrium that is isolated on its level, but for the motions of known integrals; "
                "this one is not. Begin beside it; branches are found along the family"
            )
        slope = float(linear.matmul(equations.slope(self.place.unknowns), space[0]))
        if increasing is None:
            increasing = bound is None or bound > equations.value(self.place.unknowns)
        self.tangent = -space[0] if (slope < 0) == increasing and slope != 0 else space[0]
        return None

    def _begin_a_branch(self, point: EquilibriumFamilyPoint) -> None:
        """The first place of a branch: across the family in the null space."""
        if point.kind != "branch":
            raise ParameterError(f'start: wanted a point of the kind "branch"; got a {point.kind}')
        space = self.equations.null_space(self.place)
        along = linear.matmul(space, point.tangent)[:, None]
        for direction in linear.matmul(linear.complement(along / linear.norm(along)).T, space):
            self.tangent, self.step = direction, min(_FIRST, self.longest)
            for _ in range(_TRIALS):
                new = self.moved(self.step)
                if new.residual <= HOLDS:
                    self.tangent, _ = self._turned(new)
                    self.place = new
                    return
                self.step /= 2
        raise ParameterError("start: no branch was found beside the family; it may be tangent to it")

    def moved(self, length: float, wanted: float | None = None) -> Place:
        """The place after a step along the tangent, corrected across it, or to the wanted value."""
        guess = self.place.unknowns + length * self.tangent * self.place.units
        return self.equations.solved(guess, self.place, self.tangent if wanted is None else wanted)

    def _turned(self, new: Place) -> tuple[Array, float]:
        """The tangent of a new place, and its angle to the tangent before."""
        before = self.tangent * self.place.units / new.units
        space = self.equations.null_space(new)
        share = linear.matmul(space, before / linear.norm(before))
        cosine = float(linear.norm(share))
        return linear.matmul(share, space) / (cosine or 1.0), float(elementary.arccos(min(1.0, cosine)))

    def advance(self, bound: float | None) -> str:
        """Go on by one place; why the family ends there, or nothing."""
        while self.step > _SHORTEST * self.longest:
            new, length, is_last = self.moved(self.step), self.step, False
            old, value = (self.equations.value(one.unknowns) for one in (self.place, new))
            holds = new.residual <= HOLDS
            if bound is not None and holds and old != bound and (old - bound) * (value - bound) <= 0:
                length *= (bound - old) / (value - old)
                new, is_last = self.moved(length, bound), True
            if new.residual <= HOLDS:
                tangent, angle = self._turned(new)
                if angle < _BAD:
                    break
            self.step /= 2
        else:
            return _TOO_SHORT
        self.before = self.place, self.tangent, length
        self.place, self.tangent = new, tangent
        if angle < _GOOD:
            self.step = min(self.longest, 1.5 * self.step)
        return "the wanted value" if is_last else ""

    def points_between(self, number: int) -> list[EquilibriumFamilyPoint]:
        """What changes between the last two places, up to a singular level.

        Args:
            number: That of the first of them.
        """
        now, last = (self.place, self.tangent), self.equations.tests(self.place, self.tangent)
        self.place, self.tangent, length = self.before
        found: list[EquilibriumFamilyPoint] = []
        try:
            located: list[tuple[float, str, Place]] = []
            for kind, first in self.equations.tests(self.place, self.tangent).items():
                low, high = sorted(int((one < 0).sum()) for one in (first, last[kind]))
                for k in range(low, high) if len(first) == len(last[kind]) else ():
                    located.append(self._located(kind, k, (first[k], last[kind][k]), length))
            where = -np.inf
            for at, kind, place in sorted(located, key=lambda one: one[0]):
                if self.equations.is_singular(place):
                    self.is_singular = True
                    break
                if kind == "collision" or at - where > SAME * length:  # a fold is a zero of two functions
                    found.append(self._point(kind, place, number))
                    where = where if kind == "collision" else at
        finally:
            self.place, self.tangent = now
        return found

    def _point(self, kind: str, place: Place, number: int) -> EquilibriumFamilyPoint:
        """A located point, with what it is."""
        equations = self.equations
        if kind == "collision":
            one, other = min(combinations(equations.squares(place), 2), key=lambda pair: abs(pair[0] - pair[1]))
            kind = "Hamiltonian Hopf" if one.real + other.real < 0 else kind
        else:
            kind = "branch" if len(equations.null_space(place)) > 1 else "fold"
        value, tangent = equations.value(place.unknowns), self._turned(place)[0]
        return EquilibriumFamilyPoint(kind, value, equations.equilibrium(place), number, tangent)

    def _located(self, kind: str, k: int, ends: tuple[float, float], length: float) -> tuple[float, str, Place]:
        """Where the k-th of the test functions of a kind vanishes, by the secant method in the step."""
        (low, high), a, b, side = ends, 0.0, length, 0
        middle, place = length, self.place
        for _ in range(_SECANTS):
            middle = (a * high - b * low) / (high - low)
            place = self.moved(middle)
            if self.equations.is_singular(place):
                break
            tests = self.equations.tests(place, self._turned(place)[0])[kind]
            value = float(tests[k]) if k < len(tests) else 0.0
            if value == 0 or b - a <= _ROUND_OFF * length:
                break
            if value * high > 0:
                b, high, low, side = middle, value, low / 2 if side == 1 else low, 1
            else:
                a, low, high, side = middle, value, high / 2 if side == -1 else high, -1
        return middle, kind, place
