r"""Symmetric homoclinic orbits, lists of them, and the unstable manifolds near where they begin.

A state near a symmetric periodic orbit or an equilibrium p is $x(a) = p + Ua + Gw(a)$: U spans the linear unstable
space, and w, along the gradients G of the functions that are constant, puts it back on the level.  The distance from
the unstable manifold is $O(|a|^2)$.  Along the unstable directions it only changes a, along the flow the time; along
the stable ones it shrinks while a grows.  At a distance of order 1 the error is therefore $O(|a|^3)$, beside the
round-off $\epsilon/|a|$, and both are about 1e-12 for $|a| = 10^{-4}$; midpoints were measured to be right to 3e-11.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import LeafError, ParameterError
from liepoisson.formula.scalars import as_count
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.deadline import CUT_SHORT
from liepoisson.io.display import Found
from liepoisson.io.tables import Tabular
from liepoisson.orbits.level import Level, level_of
from liepoisson.orbits.multipliers import HYPERBOLIC, SymmetricOrbit, transversal_basis
from liepoisson.orbits.shooting import Flow
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from liepoisson.model.discrete_symmetries import DiscreteSymmetry
    from liepoisson.model.system import System
    from liepoisson.orbits.refine import PreciseMidpoint

AMPLITUDE = 1e-4
"""Where orbits begin on the linear unstable space, in units of the level (see above)."""

_STEPS_TO_LEVEL = 6


@dataclass(frozen=True, eq=False)
class UnstableSpace(ReadOnlyArrays):
    r"""The linear unstable space at a state of a periodic orbit, or at an equilibrium.

    Attributes:
        level: The level; that of the equilibrium is not regular there.
        state: The state p, shape (N,).
        basis: U, orthonormal columns in units of the level, shape (N, k).
        matrix: What a loop does to the coordinates a, $a \mapsto Ma$; for an equilibrium the rate, $\dot a = Ma$; shape
            (k, k).
        loop_time: The time of the loop; 0 for an equilibrium.
        rate: The smallest growth rate of the space.
        constant: The gradients G, as columns, shape (N, c): those of H and the Casimirs, of the Casimirs only at an
            equilibrium, where that of H depends on them.
        names: The functions that they belong to, by their numbers.
    """

    level: Level
    state: Array
    basis: Array
    matrix: Array
    loop_time: float
    rate: float
    constant: Array
    names: tuple[int, ...]

    def states(self, amplitudes: Array) -> tuple[Array, Array]:
        """States x(a), shape (n, N), and their derivatives, shape (n, N, k), for a of shape (n, k)."""
        x = self.state + linear.matmul(amplitudes, self.basis.T)
        numbers = list(self.names)
        for _ in range(_STEPS_TO_LEVEL):
            rest = self.level.deviations(x)[:, numbers]
            slopes = linear.matmul(self.level.gradients(x)[:, numbers], self.constant)
            x = x - linear.matmul(linear.solve(slopes, rest[..., None])[..., 0], self.constant.T)
        gradients = self.level.gradients(x)[:, numbers]
        slopes = linear.solve(linear.matmul(gradients, self.constant), linear.matmul(gradients, self.basis))
        return x, self.basis - linear.matmul(self.constant, slopes)


def unstable_space(origin: SymmetricOrbit | Equilibrium) -> UnstableSpace:
    """The linear unstable space of a symmetric orbit at its start, or of an equilibrium.

    Raises:
        ParameterError: it is no such thing, or not hyperbolic: some multiplier is on the unit circle, some eigenvalue
            of the leaf on the imaginary axis.
        LeafError: the leaf of the equilibrium is not regular.
    """
    if isinstance(origin, SymmetricOrbit):
        return _of_orbit(origin)
    if isinstance(origin, Equilibrium):  # pyright: ignore[reportUnnecessaryIsInstance]
        return _of_equilibrium(origin)
    raise ParameterError(
        f"origin: wanted a symmetric periodic orbit or an equilibrium; got {origin!r:.60}; take one of "
        "symmetric_periodic_orbits or of equilibria"
    )


def _of_orbit(orbit: SymmetricOrbit) -> UnstableSpace:
    if orbit.stability != "hyperbolic":
        raise ParameterError(f"origin: wanted a hyperbolic orbit; got one that is {orbit.stability}, {orbit!r}")
    level, units = orbit.level, orbit.level.units
    closing = linear.matmul(orbit.last.matrix, orbit.first.matrix)
    _, matrix = Flow(orbit.system, 1).matrix(orbit.start, orbit.return_time)
    gradients, rate = level.gradients(orbit.start), orbit.system.vector_field(orbit.start)
    across = transversal_basis(gradients * units, rate / units) * units[:, None]
    back = (across / units[:, None] ** 2).T
    small = linear.matmul(linear.matmul(linear.matmul(back, closing.T), matrix), across)
    basis, loop = _invariant(small, len(small) // 2)
    slowest = float(elementary.log(np.abs(linear.eigvals(loop)).min())) / orbit.return_time
    if not slowest > 0:
        raise ParameterError(f"origin: wanted a hyperbolic orbit; that of {orbit!r} cannot be told from a neutral one")
    return UnstableSpace(
        level,
        orbit.start,
        linear.matmul(across, basis),
        loop,
        orbit.return_time,
        slowest,
        gradients.T * (units**2)[:, None],
        tuple(range(len(gradients))),
    )


def _of_equilibrium(origin: Equilibrium) -> UnstableSpace:
    if (np.abs(origin.spectrum.real) <= HYPERBOLIC * np.abs(origin.spectrum).max()).any():
        raise ParameterError(f"origin: wanted a hyperbolic equilibrium; got one with the spectrum {origin.spectrum}")
    if not origin.leaf.is_regular:
        raise LeafError(f"leaf must be a regular one; got {origin.leaf!r}")
    level = level_of(origin.system, origin.leaf, origin.energy)
    units = level.units
    matrix = origin.system.functions.jacobian(origin.state) * units / units[:, None]
    gradients = level.gradients(origin.state)[1:]
    along = linear.svd((gradients * units).T, full_matrices=True)[0][:, len(gradients) :]
    small = linear.matmul(linear.matmul(along.T, matrix), along)
    basis, rates = _invariant(small, len(small) // 2, of_rates=True)
    slowest = float(linear.eigvals(rates).real.min())
    if not slowest > 0:
        raise ParameterError(f"origin: wanted a hyperbolic equilibrium; the unstable space of {origin!r} is not known")
    return UnstableSpace(
        level,
        origin.state,
        linear.matmul(along, basis) * units[:, None],
        rates,
        0.0,
        slowest,
        gradients.T * (units**2)[:, None],
        tuple(range(1, len(gradients) + 1)),
    )


def _invariant(matrix: Array, k: int, *, of_rates: bool = False) -> tuple[Array, Array]:
    """An orthonormal basis of the invariant space of the k largest multipliers (or rates), and the matrix on it."""
    found = linear.eig(matrix)
    values, vectors = found[0].astype(np.complex128), found[1].astype(np.complex128)
    order = np.argsort(-(values.real if of_rates else np.abs(values)), kind="stable")[:k]
    chosen = vectors[:, order]
    basis = linear.svd(np.hstack([chosen.real, chosen.imag]))[0][:, :k]
    return basis, linear.matmul(linear.matmul(basis.T, matrix), basis)


@explains_its_methods
@dataclass(frozen=True, eq=False)
class HomoclinicOrbit(ReadOnlyArrays):
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
    def system(self) -> System:
        """The system."""
        return self.space.level.system

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


@dataclass(frozen=True, eq=False, repr=False)
class HomoclinicOrbits(Found[HomoclinicOrbit], Tabular):
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

    titles = ("half flight", "angles (rad)", "distance", "residual")

    origin: SymmetricOrbit | Equilibrium
    found: tuple[HomoclinicOrbit, ...]
    reversers: tuple[DiscreteSymmetry, ...]
    t_end: float
    n_starts: int
    is_cut_short: bool = False

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each orbit its half flight, midpoint and angles in rad."""
        names = self.origin.system.component_names
        states = np.array([one.midpoint for one in self.found], dtype=float).reshape(len(self.found), len(names))
        angles = np.array([one.angles for one in self.found], dtype=float).reshape(
            len(self.found), -1 if self.found else 0
        )
        return {
            **{name: np.array([getattr(one, name) for one in self.found]) for name in ("time", "residual", "distance")},
            "reverser": np.array([one.reverser.text for one in self.found]),
            **{f"midpoint_{name}": column for name, column in zip(names, states.T, strict=True)},
            **{f"angle_{k}": column for k, column in enumerate(angles.T, start=1)},
        }

    def _head(self) -> str:
        n = len(self.found)
        what = "an equilibrium" if not hasattr(self.origin, "period") else "a periodic orbit"
        return (
            f"{n or 'No'} symmetric homoclinic orbit{'' if n == 1 else 's'} to {what} of "
            f"{self.origin.system.name!r}, with half flights up to {self.t_end:.6g}, found from "
            f"{'up to ' if self.is_cut_short else ''}{self.n_starts} "
            f"starts{CUT_SHORT if self.is_cut_short else ''}; that there are no others is not proved."
        )

    def _row(self, one: HomoclinicOrbit, /) -> tuple[str, ...]:
        angles = ", ".join(f"{angle:.5f}" for angle in one.angles)
        return f"{one.time:.6f}", angles, f"{one.distance:.4f}", f"{one.residual:.0e}"
