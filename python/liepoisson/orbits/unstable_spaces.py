r"""Linear unstable spaces of periodic orbits and equilibria, and flights that begin on them.

A state near a periodic orbit or an equilibrium p is $x(a) = p + Ua + Gw(a)$: U spans the linear unstable space, and w,
along the gradients G of the functions that are constant, puts it back on the level.  The distance from the unstable
manifold is $O(|a|^2)$.  Along the unstable directions it only changes a, along the flow the time; along the stable ones
it shrinks while a grows.  At a distance of order 1 the error is therefore $O(|a|^3)$, beside the round-off
$\epsilon/|a|$, and both are about 1e-12 for $|a| = \epsilon^{1/4} = 10^{-4}$.  The stable space is the unstable one of
the flow that is run backwards.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from liepoisson.equilibrium.stability import Equilibrium
from liepoisson.errors import LeafError, ParameterError, TimeLimitError
from liepoisson.inputs.arrays import Array, ReadOnlyArrays
from liepoisson.orbits.closed_orbits import PeriodicOrbit
from liepoisson.orbits.level import Level, level_of
from liepoisson.orbits.multipliers import HYPERBOLIC, SymmetricOrbit, transversal_basis
from liepoisson.orbits.shooting import Flow, are_finite, n_times_of
from liepoisson.portable import elementary, linear

if TYPE_CHECKING:
    from liepoisson.streams import Random

Base: TypeAlias = "PeriodicOrbit | SymmetricOrbit | Equilibrium"
"""What has an unstable and a stable manifold."""

AMPLITUDE = 1e-4
"""Where orbits begin on the linear unstable space, in units of the level (see above)."""

MEETS = 1e-9
"""Largest distance of a midpoint from the fixed set, in units of the level; 1e-12 is usual (see above)."""

_GROWN_ROUND_OFF = 100 * float(np.finfo(float).eps)
"""The same times the amplitude of the start, where round-off is larger: up to 18 epsilon were measured.

The flow that makes 1 of the amplitude multiplies the last digits of the start as much.
"""

_STEPS_TO_LEVEL = 6
_MOST_STEPS = 24
_CONVERGING = 1e-3
_TIMES_PER_RATE = 24.0
_LONGEST_STEP = 0.3
EXCURSION = 6.0
"""By default flights go on for so many times 1 / rate after the amplitude would have grown to 1."""


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
        closing: The symmetry P up to which the loop closes, shape (N, N).
        n_images: After how many loops the orbit closes.
        is_whole: Whether the directions that are neither unstable nor stable are trivial.
        direction: -1 for the flow that is run backwards, else 1.
    """

    level: Level
    state: Array
    basis: Array
    matrix: Array
    loop_time: float
    rate: float
    constant: Array
    names: tuple[int, ...]
    closing: Array
    n_images: int = 1
    is_whole: bool = True
    direction: int = 1

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

    @property
    def period(self) -> float:
        """The time after which the orbit closes; 0 for an equilibrium."""
        return self.n_images * self.loop_time

    @property
    def fastest(self) -> float:
        """The largest rate of the space, with that of turning at an equilibrium."""
        values = linear.eigvals(self.matrix)
        if self.loop_time:
            return float(elementary.log(np.abs(values).max())) / self.loop_time
        return float(np.abs(values).max())

    def images(self) -> list[UnstableSpace]:
        """Those at the images of the state under the symmetry of the loop, which are states of the same orbit."""
        found: list[UnstableSpace] = [self]
        for _ in range(1, self.n_images):
            one, turn = found[-1], self.closing
            moved = [linear.matmul(turn, array) for array in (one.state, one.basis, one.constant)]
            found.append(replace(one, state=moved[0], basis=moved[1], constant=moved[2]))
        return found

    def frames(self, flow: Flow, times: Array) -> tuple[Array, Array]:
        """States of the orbit after times in the direction of the flow, shape (n, N), and bases there, (n, N, k)."""
        n, units = len(times), self.level.units
        if not self.loop_time:
            return np.tile(self.state, (n, 1)), np.tile(self.basis, (n, 1, 1))
        loops = np.floor(times / self.loop_time).astype(int)
        left = times - loops * self.loop_time
        states, moved = np.tile(self.state, (n, 1)), np.tile(self.basis, (n, 1, 1))
        if (late := left > 0).any():
            states[late], moved[late] = flow.ends(states[late], self.direction * left[late], self.basis)
        rates = self.level.system.vector_field(states) / units
        rates /= linear.norm(rates, axis=1, keepdims=True)
        moved = moved / units[:, None]
        moved = moved - rates[..., None] * linear.einsum("ni,nik->nk", rates, moved)[:, None]
        frames, triangle = linear.qr(moved)
        frames = units[:, None] * frames * np.sign(np.diagonal(triangle, axis1=1, axis2=2))[:, None]
        turn = self.closing if self.direction > 0 else self.closing.T
        for k in range(1, self.n_images):
            turned = loops % self.n_images >= k
            states[turned] = linear.matmul(states[turned], turn.T)
            frames[turned] = linear.matmul(turn, frames[turned])
        return states, frames


def unstable_space(origin: Base, *, direction: int = 1, wholly: bool = True, name: str = "origin") -> UnstableSpace:
    """The linear unstable space of a periodic orbit at its start, or of an equilibrium.

    Args:
        origin: The periodic orbit or equilibrium.
        direction: -1 for the stable space.
        wholly: Whether it must be hyperbolic, and not only have unstable directions.
        name: The argument that it is, for refusals.

    Raises:
        ParameterError: it is no such thing, or moves with rotations, or has no unstable direction, or is not
            hyperbolic: some multiplier is on the unit circle, some eigenvalue of the leaf on the imaginary axis.
        LeafError: the leaf of the equilibrium is not regular.
    """
    if isinstance(origin, SymmetricOrbit) or (isinstance(origin, PeriodicOrbit) and not wholly):
        return _of_orbit(origin, direction, name, wholly=wholly)
    if isinstance(origin, Equilibrium):  # pyright: ignore[reportUnnecessaryIsInstance]
        return _of_equilibrium(origin, direction, name, wholly=wholly)
    wanted = "a symmetric periodic orbit or an equilibrium" if wholly else "a periodic orbit or an equilibrium"
    raise ParameterError(
        f"{name}: wanted {wanted}; got {origin!r:.60}; take one of symmetric_periodic_orbits or of equilibria"
    )


def _of_orbit(orbit: SymmetricOrbit | PeriodicOrbit, direction: int, name: str, *, wholly: bool) -> UnstableSpace:
    if wholly and orbit.stability != "hyperbolic":
        raise ParameterError(f"{name}: wanted a hyperbolic orbit; got one that is {orbit.stability}, {orbit!r}")
    if isinstance(orbit, SymmetricOrbit):
        closing, time = linear.matmul(orbit.last.matrix, orbit.first.matrix), orbit.return_time
    elif orbit.is_relative:
        raise ParameterError(f"{name}: wanted an orbit that closes; got a relative one, {orbit!r}")
    else:
        closing, time = np.eye(len(orbit.start)), orbit.time
        closing = closing if orbit.symmetry is None else orbit.symmetry.matrix.astype(np.float64)
    k = int((np.abs(orbit.multipliers) > 1 + HYPERBOLIC).sum())
    if not k:
        raise ParameterError(f"{name}: wanted hyperbolic directions; the orbit is a centre, {orbit!r}")
    level, units = orbit.level, orbit.level.units
    _, matrix = Flow(orbit.system, 1).matrix(orbit.start, direction * time)
    gradients, rate = level.gradients(orbit.start), orbit.system.vector_field(orbit.start)
    across = transversal_basis(gradients * units, rate / units) * units[:, None]
    back = (across / units[:, None] ** 2).T
    undone = closing.T if direction > 0 else closing
    small = linear.matmul(linear.matmul(linear.matmul(back, undone), matrix), across)
    basis, loop = _invariant(small, k)
    slowest = float(elementary.log(np.abs(linear.eigvals(loop)).min())) / time
    if not slowest > 0:
        raise ParameterError(f"{name}: wanted a hyperbolic orbit; that of {orbit!r} cannot be told from a neutral one")
    return UnstableSpace(
        level,
        orbit.start,
        linear.matmul(across, basis),
        loop,
        time,
        slowest,
        gradients.T * (units**2)[:, None],
        tuple(range(len(gradients))),
        closing,
        round(orbit.period / time),
        orbit.stability == "hyperbolic",
        direction,
    )


def _of_equilibrium(origin: Equilibrium, direction: int, name: str, *, wholly: bool) -> UnstableSpace:
    if any(origin.omega.values()):
        raise ParameterError(f"{name}: wanted an equilibrium at rest; got a relative one, omega = {origin.omega}")
    is_whole = not (np.abs(origin.spectrum.real) <= HYPERBOLIC * np.abs(origin.spectrum).max(initial=0.0)).any()
    if wholly and not is_whole:
        raise ParameterError(f"{name}: wanted a hyperbolic equilibrium; got one with the spectrum {origin.spectrum}")
    if not origin.leaf.is_regular:
        raise LeafError(f"leaf must be a regular one; got {origin.leaf!r}")
    level = level_of(origin.system, origin.leaf, origin.energy).through(origin.state)
    units = level.units
    matrix = origin.system.functions.jacobian(origin.state) * units / units[:, None]
    gradients = level.gradients(origin.state)[1:]
    along = linear.svd((gradients * units).T, full_matrices=True)[0][:, len(gradients) :]
    small = direction * linear.matmul(linear.matmul(along.T, matrix), along)
    values = linear.eigvals(small)
    k = int((values.real > HYPERBOLIC * np.abs(values).max(initial=0.0)).sum())
    if not k:
        raise ParameterError(
            f"{name}: wanted hyperbolic directions; the equilibrium is a centre, with the spectrum {origin.spectrum}"
        )
    basis, rates = _invariant(small, k, of_rates=True)
    slowest = float(linear.eigvals(rates).real.min())
    if not slowest > 0:
        raise ParameterError(f"{name}: wanted a hyperbolic equilibrium; the unstable space of {origin!r} is not known")
    return UnstableSpace(
        level,
        origin.state,
        linear.matmul(along, basis) * units[:, None],
        rates,
        0.0,
        slowest,
        gradients.T * (units**2)[:, None],
        tuple(range(1, len(gradients) + 1)),
        np.eye(len(units)),
        1,
        is_whole,
        direction,
    )


def _invariant(matrix: Array, k: int, *, of_rates: bool = False) -> tuple[Array, Array]:
    """An orthonormal basis of the invariant space of the k largest multipliers (or rates), and the matrix on it."""
    found = linear.eig(matrix)
    values, vectors = found[0].astype(np.complex128), found[1].astype(np.complex128)
    order = np.argsort(-(values.real if of_rates else np.abs(values)), kind="stable")[:k]
    chosen = vectors[:, order]
    basis = linear.svd(np.hstack([chosen.real, chosen.imag]))[0][:, :k]
    return basis, linear.matmul(linear.matmul(basis.T, matrix), basis)


class Flights:
    """Orbits from the linear unstable space, in lanes: guesses for Newton's method in amplitudes and times.

    Args:
        space: The linear unstable space.
        flow: How they are followed.
        longest: The longest time.
        size: The least amplitude; one loop multiplies it by at most `factor`.
    """

    def __init__(self, space: UnstableSpace, flow: Flow, longest: float, size: float = AMPLITUDE) -> None:
        self.space, self.longest, self.size, self.fastest = space, longest, size, space.fastest
        self.n_times = n_times_of(_TIMES_PER_RATE * longest * space.fastest, 1.0)
        self.flow = flow.searching(self.n_times)
        # at an equilibrium the flow covers all amplitudes
        self.factor = float(np.abs(linear.eigvals(space.matrix)).max()) if space.loop_time else 1.0

    def drawn(self, n: int, draw: Random) -> Array:
        """Random amplitudes of the size that is searched, up to what one loop makes of it, shape (n, k)."""
        k = self.space.basis.shape[1]
        direction = draw.standard_normal((n, k))
        direction /= linear.norm(direction, axis=1, keepdims=True)
        return self.size * direction * elementary.power(self.factor, draw.random((n, 1)))

    def survey(self, amplitudes: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Times, states of the orbits then, and which times are so early that they are near where they began."""
        starts, _ = self.space.states(amplitudes)
        grid, states = self.flow.survey(starts, self.space.direction * self.longest, self.n_times)
        return grid, states, np.abs(grid) < 0.5 * elementary.log(1 / self.size) / self.fastest

    def ends(self, a: Array, T: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Ends of flights, shape (n, N), their derivatives by a / size and T, shape (n, N, k + 1), and which exist."""
        starts, slopes = self.space.states(a)
        ends, tangents = self.flow.ends(starts, self.space.direction * T, slopes * self.size)
        with np.errstate(all="ignore"):
            good = are_finite(ends)
            rate = np.where(good[:, None], self.space.direction * self.flow.system.vector_field(ends), 0.0)
        return ends, np.concatenate([tangents, rate[..., None]], axis=-1), good

    def shortened(self, a: Array, move: Array) -> Array:
        """By what steps of Newton's method are multiplied, shape (n,), for moves of (a / size, T)."""
        length = linear.norm(a, axis=1) / self.size
        shift, delay = linear.norm(move[:, :-1], axis=1) / length, np.abs(move[:, -1]) * self.fastest
        return 1.0 / np.maximum(1.0, np.maximum(shift, delay) / _LONGEST_STEP)

    def hold(self, a: Array, T: Array) -> np.ndarray:
        """Which amplitudes and times are among those that are searched, with a margin."""
        size_of_a = linear.norm(a, axis=1) / self.size
        inside = (size_of_a > 1 / (3 * self.factor)) & (size_of_a < 2 * self.factor) & (T > 0)
        return np.asarray(inside & (1.2 * self.longest > T))


@dataclass(frozen=True, eq=False)
class Meeting:
    """Where flights from one or two unstable spaces meet what they should.

    Attributes:
        amplitudes: Where each began, shape (k,) each.
        times: How long each takes.
        ends: Where each ends, shape (N,) each.
        residual: How far the equations are from being met, in units of the level.
    """

    amplitudes: tuple[Array, ...]
    times: tuple[float, ...]
    ends: tuple[Array, ...]
    residual: float


def meetings(
    flights: Sequence[Flights],
    amplitudes: Sequence[Array],
    times: Sequence[Array],
    equations: Callable[[list[Array], list[Array], list[Array]], tuple[Array, Array]],
) -> list[Meeting]:
    """What Newton's method makes of guesses for the same number of flights from each space, before the deadline.

    Steps are those of least squares, of minimum norm.

    Args:
        flights: From one space or two.
        amplitudes: Guesses, shape (n, k) for each space.
        times: Shape (n,) for each.
        equations: The values (n, e) and their derivatives (n, e, k + 1 + ...) by (a / size, T) of each flight, from
            the amplitudes, the ends and their derivatives.
    """
    a, T = [one.copy() for one in amplitudes], [one.copy() for one in times]
    residual, best = np.full(len(T[0]), np.inf), [Meeting((), (), (), np.inf)] * len(T[0])
    active, sizes = np.arange(len(T[0])), [one.space.basis.shape[1] + 1 for one in flights]
    for step in range(_MOST_STEPS):
        if not active.size:
            break
        try:
            found = [one.ends(b[active], t[active]) for one, b, t in zip(flights, a, T, strict=True)]
        except TimeLimitError:
            break
        good = np.logical_and.reduce([one[2] for one in found])
        ends = [one[0] for one in found]
        values, slopes = equations([b[active] for b in a], ends, [one[1] for one in found])
        values = np.where(good[:, None], values, np.inf)
        size = np.abs(values).max(axis=1, initial=0.0)
        better = size < residual[active]
        for k in np.flatnonzero(better):
            j = active[k]
            best[j] = Meeting(
                tuple(b[j].copy() for b in a), tuple(float(t[j]) for t in T), tuple(x[k].copy() for x in ends),
                float(size[k]),
            )  # fmt: skip
        stalled = ~better & (residual[active] < _CONVERGING)
        residual[active[better]] = size[better]
        go = good & ~stalled & ((step < 10) | (size < _CONVERGING))
        move = -linear.einsum("nij,nj->ni", linear.pinv(np.where(go[:, None, None], slopes, 0.0), rcond=1e-12),
                              np.where(go[:, None], values, 0.0))  # fmt: skip
        moves = np.split(move, np.cumsum(sizes)[:-1], axis=1)
        factor = np.minimum.reduce([f.shortened(b[active], m) for f, b, m in zip(flights, a, moves, strict=True)])
        for one, b, t, m in zip(flights, a, T, moves, strict=True):
            b[active] += one.size * factor[:, None] * m[:, :-1]
            t[active] += factor * m[:, -1]
            go &= one.hold(b[active], t[active])
        active = active[go]
    meets = max(MEETS, *(_GROWN_ROUND_OFF / one.size for one in flights))
    return [one for one in best if one.residual <= meets]


def usual_time(space: UnstableSpace, amplitude: float) -> float:
    """How long flights go on by default, at the slowest rate."""
    return float((elementary.log(1 / amplitude) + EXCURSION) / space.rate)


def points_of(origin: Base) -> Array:
    """States of the periodic orbit or the equilibrium itself."""
    return origin.state[None] if isinstance(origin, Equilibrium) else origin.states(400)


def pushed(flow: Flow, start: Array, time: float, tangents: Array, n_pieces: int = 12) -> Array:
    """An orthonormal basis of the space that tangent vectors span after a time, carried on in pieces."""
    x, basis = start, linear.qr(tangents)[0]
    for _ in range(n_pieces):
        ends, moved = flow.ends(x[None], np.array([time / n_pieces]), basis)
        x, basis = ends[0], linear.qr(moved[0])[0]
    return basis


def angles_between(level: Level, state: Array, one: Array, other: Array, dimensions: tuple[int, int]) -> Array:
    """The angles between two spaces of tangent vectors of a level, across the flow, in rad, increasing.

    Args:
        level: The level.
        state: Where, shape (N,).
        one: Columns that span the first space, with the flow or without.
        other: Those that span the second.
        dimensions: How many dimensions the spaces have across the flow.
    """
    across = transversal_basis(level.gradients(state), level.system.vector_field(state))
    first, second = (
        linear.svd(linear.matmul(across.T, space), full_matrices=False)[0][:, :n]
        for space, n in zip((one, other), dimensions, strict=True)
    )
    if len(first.T) < len(second.T):
        first, second = second, first
    cosines = linear.svd(linear.matmul(first.T, second), compute_uv=False)
    sines = linear.svd(second - linear.matmul(first, linear.matmul(first.T, second)), compute_uv=False)[::-1]
    return np.sort(
        np.where(cosines > 0.7, elementary.arcsin(np.minimum(sines, 1)), elementary.arccos(np.minimum(cosines, 1)))
    )
