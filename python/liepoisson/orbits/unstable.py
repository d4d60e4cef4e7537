r"""Unstable spaces of symmetric periodic orbits and of equilibria, and states on the unstable manifold near them.

A state near is $x(a) = p + Ua + Gw(a)$: U spans the linear unstable space, and w, along the gradients G of the
functions that are constant, puts it back on the level.  The distance from the unstable manifold is $O(|a|^2)$.  Along
the unstable directions it only changes a, along the flow the time; along the stable ones it shrinks while a grows.  At
a distance of order 1 the error is therefore $O(|a|^3)$, beside the round-off $\epsilon/|a|$, and both are about 1e-12
for $|a| = 10^{-4}$; midpoints were measured to be right to 3e-11.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import LeafError, ParameterError
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.orbits.level import Level, level_of
from liepoisson.orbits.multipliers import HYPERBOLIC, transversal_basis
from liepoisson.orbits.periodic_orbits import SymmetricOrbit
from liepoisson.orbits.shooting import Flow
from liepoisson.portable import elementary, linear

AMPLITUDE = 1e-4
"""Where orbits begin on the linear unstable space, in units of the level (see above)."""

_STEPS_TO_LEVEL = 6


@dataclass(frozen=True)
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
