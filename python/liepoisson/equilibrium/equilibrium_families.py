r"""Families of equilibria: followed in a Casimir, in the value of an integral, or in a parameter.

With one value, or a parameter, set free the solutions of the equations (`liepoisson.equilibrium.family_equations`) form
curves (`liepoisson.numeric.curves`).  Along a curve the following functions, each in its order, are continuous, and
their zeros are located:

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
from liepoisson.equilibrium.family_equations import FamilyEquations, Place, family_equations, value_of
from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_positive
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import shown
from liepoisson.io.display import Found
from liepoisson.io.tables import Tabular
from liepoisson.leaf._checks import as_energy, as_system
from liepoisson.numeric.curves import HOLDS, LONGEST, Follower, Zero
from liepoisson.numeric.run_options import RunOptions

if TYPE_CHECKING:
    from liepoisson.model.system import System


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
    longest_step: float = LONGEST,
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
    longest = as_positive(longest_step, "longest_step", "a length > 0", example=LONGEST)
    bound = None if until is None else as_energy(until, "until")
    first = start.equilibrium if isinstance(start, EquilibriumFamilyPoint) else start
    if not isinstance(first, Equilibrium):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ParameterError(f"start: wanted an equilibrium or a point of a family; got {shown(start)}")
    equations = family_equations(system, first, along)
    with run.deadline.running():
        follower = _follower(equations, start, longest)
        if first is start:
            follower.turn_towards(bound, increasing)
        found, zeros, end = follower.followed(bound, most, run, equations.equilibrium)
    points = tuple(_point(equations, zero) for zero in zeros)
    return EquilibriumFamily(along, found, points, end or f"{most} equilibria")


def _follower(equations: FamilyEquations, start: EquilibriumFamilyStart, longest: float) -> Follower[Place]:
    """What begins at the start, or at the first place of a branch that leaves a family there.

    Raises:
        ParameterError: it is singular or not isolated, or there is no branch.
    """
    place = equations.first()
    if equations.is_singular(place):
        raise ParameterError(
            f"start: wanted independent gradients of {', '.join(equations.held)}; got dependent ones. Leave out "
            "integrals that are critical there"
        )
    if isinstance(start, EquilibriumFamilyPoint):
        if start.kind != "branch":
            raise ParameterError(f'start: wanted a point of the kind "branch"; got a {start.kind}')
        follower = Follower(equations, place, longest)
        if not follower.leave(start.tangent):
            raise ParameterError("start: no branch was found beside the family; it may be tangent to it")
        return follower
    place = equations.solved(place.unknowns, place, equations.value(place))
    if not place.residual <= HOLDS or len(equations.null_space(place)) > 1:
        raise ParameterError(
            "start: wanted an equilibrium that is isolated on its level, but for the motions of known integrals; "
            "this one is not. Begin beside it; branches are found along the family"
        )
    return Follower(equations, place, longest)


def _point(equations: FamilyEquations, zero: Zero[Place]) -> EquilibriumFamilyPoint:
    """A located point, with what it is; unknowns that are known to be as small as the residual may be are zero."""
    kind, at = zero.kind, zero.point.unknowns
    place = equations.place(np.where(np.abs(at) <= HOLDS * zero.point.units, 0.0, at))
    if kind == "collision":
        one, other = min(combinations(equations.squares(place), 2), key=lambda pair: abs(pair[0] - pair[1]))
        kind = "Hamiltonian Hopf" if one.real + other.real < 0 else kind
    else:
        kind = "branch" if len(equations.null_space(place)) > 1 else "fold"
    return EquilibriumFamilyPoint(kind, equations.value(place), equations.equilibrium(place), zero.after, zero.tangent)
