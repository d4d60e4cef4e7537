"""Symmetric homoclinic orbits, and lists of them; midpoints were measured to be right to 3e-11."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.io.tables import vector_columns
from liepoisson.orbits.multipliers import SymmetricOrbit
from liepoisson.orbits.saved_orbits import SavedOrbits, SearchedOrbits
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from liepoisson.model.discrete_symmetries import DiscreteSymmetry
    from liepoisson.model.system import System
    from liepoisson.orbits.refine import PreciseMidpoint
    from liepoisson.orbits.unstable_spaces import UnstableSpace


@explains_its_methods
@dataclass(frozen=True, eq=False)
class HomoclinicOrbit(SavedOrbits):
    r"""An orbit that tends to a periodic orbit or an equilibrium for $t \to \pm\infty$ and is its own mirror image.

    Example:
        >>> duffing = lp.System(lp.canonical(1, names=["x"]), "p_x^2/2 - x^2/2 + x^4/4")
        >>> saddle = lp.phase_space.equilibrium(duffing, [0, 0])
        >>> orbit = lp.orbits.symmetric_homoclinic_orbits(saddle, n_starts=20)[0]  # x = sqrt(2)/cosh(t)
        >>> orbit.reverser.text, round(orbit.distance**2, 9)
        ('p_x -> -p_x; t -> -t', 2.0)

    Attributes:
        origin: The periodic orbit or the equilibrium.
        space: The linear unstable space where it begins.
        reverser: The reverser $\rho$, with $\varphi_t(m) = \rho\varphi_{-t}(m)$ for the midpoint m.
        amplitude: The coordinates a of the start on the unstable space, shape (k,).
        start: The state x(a), shape (N,).
        midpoint: The state m in $\mathrm{Fix}\,\rho$, shape (N,).
        time: From the start to the midpoint.
        residual: How far the computed midpoint was from the fixed set, in units of the level.
        angles: The angles between the tangent spaces of the unstable and the stable manifold at the midpoint, in the
            level across the flow, in rad, increasing, shape (m - 1,). The manifolds are transversal in the level if
            none is 0.
        distance: The distance of the midpoint from the orbit or equilibrium.
    """

    kind = "homoclinic orbit"
    made_by = "lp.orbits.symmetric_homoclinic_orbits"

    origin: SymmetricOrbit | Equilibrium
    space: UnstableSpace
    reverser: DiscreteSymmetry
    amplitude: Array
    start: Array
    midpoint: Array
    time: float
    residual: float
    angles: Array
    distance: float

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.space.level.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table, which has one row: half flight, midpoint and angles in rad."""
        return _columns((self,), self.system)

    def time_from(self, amplitude: float) -> float:
        """About the time from an amplitude to the midpoint, at the slowest unstable rate."""
        return self.time - float(elementary.log(amplitude / linear.norm(self.amplitude))) / self.space.rate

    def states(self, n_times: int = 401) -> tuple[Array, Array]:
        """Times, shape (n,), 0 at the midpoint, and states, shape (n, N), from the start to its mirror image.

        Each half is integrated towards the midpoint, from which errors do not grow.
        """
        from liepoisson.numeric.integrate import integrate

        n_times = as_count(n_times, "n_times", least=3)
        half = np.linspace(0.0, self.time, n_times // 2 + 1)
        first = integrate(self.system, self.start, times=half).state[0].copy()
        first[-1] = self.midpoint
        states = np.concatenate([first, self.reverser(first[:-1])[::-1]])
        return np.concatenate([half - self.time, (self.time - half[:-1])[::-1]]), states

    def polished(self, *, digits: int = 20) -> PreciseMidpoint:
        """The midpoint to any number of digits, for an orbit homoclinic to a periodic orbit.

        Raises:
            ParameterError: it is homoclinic to an equilibrium, or the equations are no polynomials.
            OrbitError: Newton's method does not converge.
        """
        from liepoisson.orbits.refine import polished_midpoint

        return polished_midpoint(self, digits)

    def __repr__(self) -> str:
        return (
            f"<HomoclinicOrbit of {self.system.name!r}: half flight {self.time:.6g}, angles "
            f"{', '.join(f'{angle:.5g}' for angle in self.angles)} rad>"
        )


def _columns(orbits: Sequence[HomoclinicOrbit], system: System) -> dict[str, NDArray[Any]]:
    return {
        **{name: np.array([getattr(one, name) for one in orbits]) for name in ("time", "residual", "distance")},
        "reverser": np.array([one.reverser.text for one in orbits]),
        **vector_columns("midpoint", [one.midpoint for one in orbits], system.component_names),
        **vector_columns("angle", [one.angles for one in orbits]),
    }


@dataclass(frozen=True, eq=False, repr=False)
class HomoclinicOrbits(SearchedOrbits[HomoclinicOrbit]):
    """Symmetric homoclinic orbits to one periodic orbit or equilibrium, those with the shortest flight first.

    Example:
        >>> duffing = lp.System(lp.canonical(1, names=["x"]), "p_x^2/2 - x^2/2 + x^4/4")
        >>> saddle = lp.phase_space.equilibrium(duffing, [0, 0])
        >>> found = lp.orbits.symmetric_homoclinic_orbits(saddle, n_starts=20)
        >>> len(found)  # its image under a change of both signs is not listed
        1

    Attributes:
        origin: The periodic orbit or the equilibrium.
        found: The orbits; of those that symmetries of the system take to one another, one.
        reversers: The reversers in whose fixed sets midpoints were looked for.
        t_end: The longest half flight that was looked for.
        n_starts: How many starts were taken, at most where the time limit ended the search.
        is_cut_short: Whether the time limit ended the search.
    """

    kind = "homoclinic orbits"
    made_by = "lp.orbits.symmetric_homoclinic_orbits"
    titles = ("half flight", "angles (rad)", "distance", "residual")

    origin: SymmetricOrbit | Equilibrium
    found: tuple[HomoclinicOrbit, ...]
    reversers: tuple[DiscreteSymmetry, ...]
    t_end: float
    n_starts: int
    is_cut_short: bool = False

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.origin.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its half flight, midpoint and angles in rad."""
        return _columns(self.found, self.system)

    def _head(self) -> str:
        what = "an equilibrium" if isinstance(self.origin, Equilibrium) else "a periodic orbit"
        where = f"of {self.system.name!r}, with half flights up to {self.t_end:.6g}"
        return self._sentence("symmetric homoclinic orbit", f"to {what} {where}", "{} starts")

    def _row(self, one: HomoclinicOrbit, /) -> tuple[str, ...]:
        angles = ", ".join(f"{angle:.5f}" for angle in one.angles)
        return f"{one.time:.6f}", angles, f"{one.distance:.4f}", f"{one.residual:.0e}"
