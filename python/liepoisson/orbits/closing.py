r"""Closed orbits by Newton's method: multiple shooting on a level, for many guesses at once.

A loop is a chain of states $x_0, \dots, x_{m-1}$, a time T and angles $\theta_k$ with

$$ \varphi_{T/m}(x_i) = x_{i+1},\quad \varphi_{T/m}(x_{m-1}) = P\,e^{\sum_k\theta_k G_k}x_0,\quad F_j(x_0) = c_j . $$

The $F_j$ are H, the Casimirs and, where asked, further integrals; P is a discrete symmetry, and $G_k$ generates the
rotations that a linear integral belongs to.  The flow keeps the $F_j$, so there are more equations than are
independent: with the state held across the flow and the rotations, steps of least squares converge quadratically to a
loop that is isolated on its level, and nothing has to be unfolded.  The corrections of all states but the first are
eliminated, so that the linear equations have the size of one state; residuals are those of the short segments.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from liepoisson.inputs.arrays import Array
from liepoisson.inputs.deadline import checkpoint
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.orbits.level import Level
from liepoisson.orbits.shooting import LONGEST_DELAY, LONGEST_STEP, Flow
from liepoisson.portable import elementary, linear

_MOST_STEPS = 30
_MEETS, _TRIALS = 1e-4, 12
"""A guess must have come to this residual, from which on convergence is quadratic, after so many steps."""
_RANK = 1e-11
"""Singular values below this, relative to the largest, belong to families: steps do not follow them."""
_LAST_DIGITS = 2 * float(np.finfo(float).eps)
"""A value that differs by less, relative, is the value that is held: cos(q) of a small q knows no more."""
GROWTH = 100.0
"""A segment is so short that neighbours grow by no more than about this along it: a hundredth of a double's digits."""
MOST_SEGMENTS = 256
_LAST_STEP = float(np.sqrt(np.finfo(float).eps / GROWTH))
"""A step of Newton's method that is shorter is the last one: what it leaves is its square, times the growth."""


@dataclass(frozen=True, eq=False)
class Loops:
    """Guesses, or what became of them.

    Attributes:
        state: The states where segments begin, shape (n, segment, N).
        time: Shape (n,).
        angle: Angles of the rotations by which they close, shape (n, k).
        residual: The largest gap between segments, in units of the level, and deviation from it, relative; shape (n,).
        regularity: The smallest singular value of the equations by the largest one, shape (n,): round-off where loops
            belong to families on their level.
    """

    state: Array
    time: Array
    angle: Array
    residual: Array
    regularity: Array

    def __len__(self) -> int:
        return len(self.time)

    def of(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> Loops:
        """Some of them."""
        return Loops(self.state[rows], self.time[rows], self.angle[rows], self.residual[rows], self.regularity[rows])

    def replaced(self, rows: NDArray[np.bool_], others: Loops) -> Loops:
        """The same with others in the place of some of them."""
        found = [getattr(self, one.name).copy() for one in fields(self)]
        for mine, one in zip(found, fields(others), strict=True):
            mine[rows] = getattr(others, one.name)
        return Loops(*found)


def guessed(state: Array, time: Array, angle: Array) -> Loops:
    """Guesses, of which nothing is known."""
    return Loops(state, time, angle, np.full(len(time), np.inf), np.zeros(len(time)))


@dataclass(frozen=True, eq=False)
class Closing:
    """The equations for closed orbits.

    Attributes:
        level: The level, which gives the sizes of states.
        flow: How orbits are followed.
        held: Functions that have given values, by name: the function and its value.
        symmetry: P, an orthogonal matrix.
        rotations: The matrices $G_k$, shape (k, N, N).
        holds_period: Whether the time is given and does not change: its column is zero, and no step of least norm moves
            it.
    """

    level: Level
    flow: Flow
    held: Mapping[str, tuple[PhaseFunction, float]]
    symmetry: Array
    rotations: Array
    holds_period: bool = False

    def without(self, name: str) -> Closing:
        """The same with one function less, as for a family."""
        return replace(self, held={key: value for key, value in self.held.items() if key != name})

    def turn(self, angle: Array) -> Array:
        r"""$P\,e^{\sum\theta_k G_k}$, shape (n, N, N)."""
        if not angle.shape[1]:
            return np.broadcast_to(self.symmetry, (len(angle), *self.symmetry.shape))
        return linear.matmul(self.symmetry, exponential(linear.einsum("nk,kij->nij", angle, self.rotations)))

    def solved(self, guesses: Loops, *, extra: Array | None = None) -> Loops:
        """What Newton's method makes of guesses; the residual says how well each closes.

        Args:
            guesses: States, times and angles.
            extra: A direction in (state, time, angle), in units, along which the first state does not move from the
                guess, shape (N + 1 + k,): a step along a family is corrected across it.

        Raises:
            TimeLimitError: the deadline of the call has passed.
        """
        x, T, angle = guesses.state.copy(), guesses.time.copy(), guesses.angle.copy()
        best = guessed(x.copy(), T.copy(), angle.copy())
        anchors = x[:, 0].copy(), T.copy(), angle.copy()
        active, arrived = np.arange(len(T)), np.zeros(len(T), dtype=bool)
        for k in range(_MOST_STEPS):
            checkpoint("Newton's method for closed orbits")
            here = x[active], T[active], angle[active]
            found = self.linearised(*here)
            rows, values = self._equations(found, here, tuple(a[active] for a in anchors), extra)
            off = np.abs(values[:, x.shape[2] : x.shape[2] + len(self.held)])  # deviations of the held functions
            size = np.maximum(np.abs(found.gaps).max(axis=(1, 2)), off.max(axis=1, initial=0.0))
            size[~np.isfinite(size)] = np.inf
            better = size < best.residual[active]
            chosen = active[better]
            best.state[chosen], best.time[chosen], best.angle[chosen] = x[chosen], T[chosen], angle[chosen]
            best.residual[chosen] = size[better]
            stalled = ~better & (best.residual[active] < _MEETS)
            go = np.isfinite(size) & ~stalled & ~arrived[active] & ((k < _TRIALS) | (size < _MEETS)) & (size > 1e-17)
            matrix = np.where(go[:, None, None], rows, 0.0)
            sizes = linear.svd(np.where(np.isfinite(size)[:, None, None], rows, 0.0), compute_uv=False)
            with np.errstate(all="ignore"):
                best.regularity[chosen] = (sizes[:, -2 if self.holds_period else -1] / sizes[:, 0])[better]
            step = -linear.einsum("nij,nj->ni", linear.pinv(matrix, rcond=_RANK), np.where(go[:, None], values, 0.0))
            moves, delay, turned = found.moves(step)
            with np.errstate(all="ignore"):
                long = np.maximum(linear.norm(moves, axis=2).max(axis=1) / LONGEST_STEP, np.abs(delay) / LONGEST_DELAY)
            factor = 1.0 / np.maximum(1.0, np.where(np.isfinite(long), long, 1.0))
            x[active] += factor[:, None, None] * moves * self.level.units
            T[active] *= 1.0 + factor * delay
            angle[active] += factor[:, None] * turned
            arrived[active] = np.maximum(long * LONGEST_STEP, linear.norm(turned, axis=1)) < _LAST_STEP
            active = active[go & np.isfinite(long) & (T[active] > 0)]
            if not active.size:
                break
        return best

    def chained(
        self, guesses: Loops, last: Loops, tangent: Array, length: float
    ) -> tuple[Loops, Linearised, Array] | None:
        r"""Loops that follow a last one, each by a step along the tangent of the one before, corrected across it.

        They are those to which `solved` comes one after the other, improved together: a correction moves the guess
        from which the next loop is held, $d_j = s_j + C_j d_{j-1}$.  A loop that does not begin where convergence is
        quadratic, or whose corrections do not become shorter, is left out with all that follow.

        Args:
            guesses: States, times and angles, in their order.
            last: The loop before them.
            tangent: Its direction in (state, time, angle), in units, shape (N + 1 + k,).
            length: The length of a step.

        Returns:
            The loops, their derivatives, and their tangents, shape (n, N + 1 + k); None where there is none.

        Raises:
            TimeLimitError: the deadline of the call has passed.
        """
        here, N, units = (guesses.state, guesses.time, guesses.angle), guesses.state.shape[2], self.level.units
        first, is_last, bound = N + len(self.held), False, np.full(len(guesses), _MEETS)
        while len(here[1]):
            checkpoint("Newton's method for closed orbits")
            found = self.linearised(*here)
            rows, values = self._equations(found, here, (here[0][:, 0], *here[1:]), None)
            whole = np.concatenate([rows.reshape(len(rows), -1), values], axis=1)
            some = slice(_prefix(np.isfinite(whole)))
            x, T, angle = here = here[0][some], here[1][some], here[2][some]
            rows, values, found = rows[some], values[some], found.of(some)
            if not len(T):
                break
            own = linear.svd(rows).Vh[:, -1]
            before = np.concatenate([tangent[None], own])[: len(own)]
            turns = np.cumprod(np.where((own * before).sum(axis=1) < 0, -1.0, 1.0))[:, None]
            own, before = own * turns, np.concatenate([tangent[None], own * turns])[: len(own)]
            if is_last:
                size = np.abs(values[:, N:first]).max(axis=1, initial=0.0)
                size = np.maximum(np.abs(found.gaps).max(axis=(1, 2)), size)
                return Loops(x, T, angle, size, np.ones(len(T))), found, own
            start, time, turned = (
                np.concatenate([one, others])[: len(T)]
                for one, others in ((last.state[:, 0], x[:, 0]), (last.time, T), (last.angle, angle))
            )
            moved = np.concatenate([
                (x[:, 0] - start) / units - length * before[:, :N],
                T[:, None] / (time[:, None] * (1.0 + length * before[:, N : N + 1])) - 1.0,
                angle - turned - length * before[:, N + 1 :],
            ], axis=1)  # fmt: skip
            across = np.concatenate([rows[:, first:], before[:, None]], axis=1)  # what is held from the loop before
            inverse = linear.pinv(np.concatenate([rows[:, :first], across], axis=1), rcond=_RANK)
            values = np.concatenate([values[:, :first], linear.einsum("nij,nj->ni", across, moved)], axis=1)
            step = -linear.einsum("nij,nj->ni", inverse, values)
            carried, n = linear.matmul(inverse[:, :, first:], across), 1
            while n < len(step):  # the sums over 1, 2, 4, ... loops
                step[n:] += linear.einsum("nij,nj->ni", carried[n:], step[:-n])
                carried[n:] = linear.matmul(carried[n:], carried[:-n])
                n *= 2
            moves, delay, turned = found.moves(step)
            long = np.maximum(linear.norm(moves, axis=2).max(axis=1), np.abs(delay))
            long = np.maximum(long, linear.norm(turned, axis=1))
            some = slice(_prefix(long < bound[: len(long)]))
            is_last, bound = bool((long[some] < _LAST_STEP).all()), np.maximum(long / 2, _LAST_STEP)
            here = (x + moves * units)[some], (T * (1.0 + delay))[some], (angle + turned)[some]
        return None

    def linearised(self, x: Array, T: Array, angle: Array) -> Linearised:
        """The gaps between the segments of some loops, and their derivatives by all states, times and angles."""
        n, m, N = x.shape
        units = self.level.units
        with np.errstate(all="ignore"):
            ends, tangents = self.flow.ends(x.reshape(-1, N), np.repeat(T / m, m), np.eye(N))
            rates = self.flow.system.vector_field(np.where(np.isfinite(ends), ends, 0.0)).reshape(n, m, N) / units
        tangents = tangents.reshape(n, m, N, N) * (units / units[:, None])
        last = linear.matmul(self.turn(angle), x[:, 0, :, None])[..., 0]
        gaps = (ends.reshape(n, m, N) - np.concatenate([x[:, 1:], last[:, None]], axis=1)) / units
        return Linearised(gaps, tangents, rates * (T / m)[:, None, None])

    def growth(self, loops: Loops) -> Array:
        """By how much neighbours grow in one of the segments, at most, in units of the level, shape (n,)."""
        found = self.linearised(loops.state, loops.time, loops.angle).segments
        return np.abs(found).sum(axis=3).max(axis=(1, 2))

    def sums(self, loops: Loops) -> Array:
        """The sums of the multipliers of loops, without the trivial ones, shape (n,)."""
        matrix, _, _ = self.linearised(loops.state, loops.time, loops.angle).condensed()
        turn = self.turn(loops.angle) * (self.level.units[:, None] / self.level.units)
        return linear.einsum("nij,nij->n", turn, matrix) - len(self.held) - 1 - len(self.rotations)

    def extent(self, loops: Loops) -> Array:
        """About how far loops move in their time, across the rotations and in units of the level, shape (n,)."""
        return linear.norm(self.rates(loops.state), axis=2).max(axis=1) * loops.time

    def rates(self, states: Array) -> Array:
        """The vector field across the rotations, in units of the level, shape (n, m, N), at so many states."""
        basis: list[Array] = []
        for rotation in self.rotations:
            turned = linear.einsum("ij,nmj->nmi", rotation, states) / self.level.units
            basis.append(_unit(_across(turned, basis)))
        return _across(self.level.system.vector_field(states) / self.level.units, basis)

    def _equations(
        self, found: Linearised, here: tuple[Array, Array, Array], anchors: tuple[Array, ...], extra: Array | None
    ) -> tuple[Array, Array]:
        """All equations for (first state, relative time, angles), shape (n, equation, unknown), and their values.

        The first N close the loop; those of the held functions follow.
        """
        start, time, angle = here[0][:, 0], here[1], here[2]
        (n, N), k, units = start.shape, angle.shape[1], self.level.units
        matrix, late, rest = found.condensed()
        late = np.zeros_like(late) if self.holds_period else late
        turn, directions = self.turn(angle), [self.level.system.vector_field(start)]
        along = np.zeros((n, N, 0))
        if k:
            turned = linear.matmul(turn, start[..., None])[..., 0]
            along = linear.einsum("kij,nj->nik", self.rotations, turned) / units[:, None]
            directions += [*linear.einsum("kij,nj->kni", self.rotations, start)]
        rows = [np.concatenate([matrix - turn * (units / units[:, None]), late[..., None], -along], axis=2)]
        values, none = [rest], np.zeros((n, 1 + k))
        for function, value in self.held.values():
            gradient = function.gradient(start) * units
            scale = np.maximum(np.abs(gradient).sum(axis=1), np.finfo(float).tiny)
            off = function(start) - value
            off = np.where(np.abs(off) <= _LAST_DIGITS * abs(value), 0.0, off)
            rows.append(np.concatenate([gradient / scale[:, None], none], axis=1)[:, None])
            values.append((off / scale)[:, None])
        off = (start - anchors[0]) / units
        for direction in directions:  # held across the flow and the rotations
            across = _unit(direction / units)
            rows.append(np.concatenate([across, none], axis=1)[:, None])
            values.append(linear.einsum("ni,ni->n", across, off)[:, None])
        if extra is not None:
            rows.append(np.broadcast_to(extra, (n, 1, N + 1 + k)))
            moved = np.concatenate([off, time[:, None] / anchors[1][:, None] - 1.0, angle - anchors[2]], axis=1)
            values.append(linear.einsum("ni,i->n", moved, extra)[:, None])
        return np.concatenate(rows, axis=1), np.concatenate(values, axis=1)

    def null_space(self, loops: Loops, found: Linearised, n: int) -> Array:
        """The n directions (state, relative time, angles) in which one loop moves most nearly along loops.

        The equations hold one function less than fixes the loop, so that loops form a curve, or several that cross.

        Raises:
            LinAlgError: an orbit does not reach its time.
        """
        here = loops.state, loops.time, loops.angle
        rows, _ = self._equations(found, here, (loops.state[:, 0], loops.time, loops.angle), None)
        return linear.svd(rows)[2][0, -n:]


@dataclass(frozen=True, eq=False)
class Linearised:
    """The gaps of loops in units of the level, and their derivatives.

    Attributes:
        gaps: Ends of segments less the states that they should be, shape (n, segment, N).
        segments: The derivatives of segments, shape (n, segment, N, N).
        late: Those of ends by the relative time, shape (n, segment, N).
    """

    gaps: Array
    segments: Array
    late: Array

    def of(self, rows: slice) -> Linearised:
        """Those of some loops."""
        return Linearised(self.gaps[rows], self.segments[rows], self.late[rows])

    def condensed(self) -> tuple[Array, Array, Array]:
        """The derivatives of the last end by the first state and the relative time, and the gap, all others closed."""
        matrix, late, rest = self.segments[:, 0], self.late[:, 0], self.gaps[:, 0]
        for i in range(1, self.segments.shape[1]):
            step = self.segments[:, i]
            matrix = linear.matmul(step, matrix)
            late = linear.einsum("nij,nj->ni", step, late) + self.late[:, i]
            rest = linear.einsum("nij,nj->ni", step, rest) + self.gaps[:, i]
        return matrix, late, rest

    def moves(self, step: Array) -> tuple[Array, Array, Array]:
        """The corrections of all states, shape (n, segment, N), of the relative time and of the angles."""
        n, m, N = self.gaps.shape
        moves, delay = np.empty((n, m, N)), step[:, N]
        moves[:, 0] = step[:, :N]
        for i in range(m - 1):
            moves[:, i + 1] = linear.einsum("nij,nj->ni", self.segments[:, i], moves[:, i]) + self.gaps[:, i]
            moves[:, i + 1] += self.late[:, i] * delay[:, None]
        return moves, delay, step[:, N + 1 :]


def _prefix(good: NDArray[np.bool_]) -> int:
    """How many rows are good before the first one that is not."""
    return int(np.cumprod(good.reshape(len(good), -1).min(axis=1, initial=True)).sum())


def _unit(vectors: Array) -> Array:
    """Vectors of length 1 in the same directions, shape (..., N)."""
    return vectors / np.maximum(linear.norm(vectors, axis=-1, keepdims=True), np.finfo(float).tiny)


def _across(vectors: Array, basis: Sequence[Array]) -> Array:
    """The parts of vectors that are orthogonal to those of an orthonormal basis, shape (..., N)."""
    for one in basis:
        vectors = vectors - linear.einsum("...i,...i->...", vectors, one)[..., None] * one
    return vectors


def exponential(matrices: Array) -> Array:
    """The exponentials of small matrices, shape (..., N, N): Taylor's series of a part 1/2^k, squared k times."""
    size = float(np.abs(matrices).sum(axis=-1).max(initial=0.0))
    halvings = max(0, int(np.ceil(elementary.log2(size))) + 1) if size > 0 else 0
    small = matrices / 2.0**halvings
    found = term = np.broadcast_to(np.eye(matrices.shape[-1]), matrices.shape)
    for k in range(1, 19):  # 2^-18 / 18! is below the round-off
        term = linear.matmul(term, small) / k
        found = found + term
    for _ in range(halvings):
        found = linear.matmul(found, found)
    return found
