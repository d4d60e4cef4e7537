r"""The period lattice of a torus: the times after which the commuting flows come back, and the frequencies.

On a compact fibre without critical points the action $\Phi^t$ of $\mathbb R^n$ has an isotropy group that is a lattice
$\Lambda$, the same on the whole torus: $\Phi^T(x) = x$.  With a basis of $\Lambda$ as rows of a matrix P the flow of
$\sum_kc_kF_k$ has the angular frequencies $\omega = 2\pi\,c\,P^{-1}$, those of H the first row of $2\pi P^{-1}$.

Closing flows are found by Newton's method: the derivative of $\Phi^t(x)$ along $t_k$ is the field $X_{F_k}$ there.
Times are measured by half turns, how long combinations of flows go away from the state before they come nearer again.
It starts from random t, of lengths that double until n independent periods are found and their lattice is the same
twice.  That it is not a part of a finer one is seen by trying the points of (1/p) times it for the primes p up to 13.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import frexp
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import OrbitError, ShapeError
from liepoisson.formula.scalars import TIME_LIMIT, as_phase_points, as_seed, as_time_limit
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import Deadline
from liepoisson.io.tables import vector_columns
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import elementary, linear
from liepoisson.streams import Purpose, stream
from liepoisson.tori.momentum_maps import MomentumMap, map_of

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.system import System

_GUESSES = 64
"""Guesses of one length, for each integral."""
_LENGTHS = (4.0, 8.0, 16.0, 32.0, 64.0)
"""How far the flows go at most, in half turns of the torus, one length after the other: a period has some two."""
_STEPS, _LONGEST = 16, 0.25
"""Steps of Newton's method, and the longest one, in half turns: beyond it the fields have turned."""
_CLOSES = 1e-10
"""The distance, in units of the state, to which Newton's method must come for a period."""
_THINNEST = 1e-5
"""The least extent of a torus, in units of the state: a distance of 1e-13, which flows have, is 1e-8 of a turn."""
_SAME = 1e-6
"""Times that differ by less, in half turns, are the same."""
_WINDOW = 16
"""So many times the first half turn a longer one is looked for."""
_PRIMES = (2, 3, 5, 7, 11, 13)
_SAMPLES, _DOUBLINGS = 48, 24
"""Times at which the extent of a flow is looked at, and how often they are doubled until it turns back."""


@dataclass(frozen=True, eq=False)
class PeriodLattice(SavedWhole):
    r"""The periods of the commuting flows on a torus.

    Example:
        >>> top = lp.Top.twisted_lagrange()
        >>> torus = lp.tori.period_lattice(top, [0.3, 0.1, 1.2, 0.5, 0.2, 0.4, 0.1, 0.3, 0.9])
        >>> torus.integrals, torus.periods.shape, bool(torus.residual < 1e-12)
        (('H', 'l3', 'P'), (3, 3), True)

    Attributes:
        momentum: The momentum map.
        state: A state on the torus, shape (N,).
        periods: A basis of the lattice as rows, times of the flows of the integrals, shape (n, n).
        residual: The largest distance from the state after a period of the basis, in units of the leaf times
            the power of two that makes the state of order 1.
    """

    kind = "period lattice"
    made_by = "lp.tori.period_lattice"
    row = "period"

    momentum: MomentumMap
    state: Array
    periods: Array
    residual: float

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.momentum.system

    @property
    def integrals(self) -> tuple[str, ...]:
        """The names of the integrals, in the order of the times."""
        return self.momentum.names

    @property
    def values(self) -> Array:
        """The values of the integrals, shape (n,)."""
        return self.momentum(self.state)

    @property
    def frequencies(self) -> Array:
        r"""The angular frequencies of the motion, $2\pi$ times the first row of the inverse of `periods`, shape (n,).

        Another basis gives other ones, integer combinations of these.
        """
        return 2 * np.pi * linear.inv(self.periods)[0]

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each period of the basis its times, and the frequency of its angle."""
        return vector_columns("time", self.periods, self.integrals) | {"frequency": self.frequencies}

    def __repr__(self) -> str:
        rates = ", ".join(f"{rate:.6g}" for rate in self.frequencies)
        return f"<Lattice of {len(self.periods)} periods of {self.momentum.system.name!r}: frequencies {rates}>"


@explains_its_arguments
def period_lattice(
    system: System | MomentumMap,
    state: ArrayLike,
    *,
    integrals: Sequence[str | Expr | PhaseFunction] | None = None,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
) -> PeriodLattice:
    r"""The periods of the commuting flows of an integrable system on the torus through a state, by closing flows.

    The basis is reduced: no sum of two of its vectors is shorter, in half turns of the torus.

    Example:
        >>> pendulum = lp.System(lp.canonical(names=["q"]), "p_q^2/2 + q^2/2 + q^4/4")
        >>> torus = lp.tori.period_lattice(pendulum, [1, 0])
        >>> torus.periods.round(9).tolist(), torus.frequencies.round(6).tolist()
        ([[4.768022029]], [1.317776])

    Args:
        system: A system whose parameters are all numbers, or its momentum map.
        state: A state, shape (N,).
        integrals: The other integrals than H, see `momentum_map`.
        seed: Draws the guesses.
        time_limit: Seconds that the call may take.

    Raises:
        ParameterError: the integrals are none, do not commute, or are not as many as wanted.
        LeafError: they commute on another leaf only.
        OrbitError: they are dependent at the state, or too few flows close: the fibre is not compact, or the state is
            near to a critical one.
        TimeLimitError: the time is over.
    """
    deadline = Deadline(as_time_limit(time_limit))
    momentum = map_of(system, integrals)
    bracket = momentum.system.bracket
    x = as_phase_points(state, bracket.coordinate_names_in_order, bracket.field_names, "state")
    if x.ndim != 1:
        raise ShapeError(f"state: wanted one state, shape ({x.shape[-1]},); got shape {x.shape}")
    number = as_seed(seed)
    with deadline.running(), np.errstate(all="ignore"):
        torus = Closures.at(momentum, x, momentum.leaf_through(x).in_units().units)
        periods = torus.lattice(number)
        return PeriodLattice(momentum, x, periods, float(torus.distances(periods).max()))


@dataclass(frozen=True, eq=False)
class Closures:
    """The flows through one state, with times measured by half turns of the torus.

    Attributes:
        momentum: The momentum map.
        state: Shape (N,).
        units: Units of the coordinates, those of the leaf times a number that makes the state of order 1, shape (N,).
        scaling: Takes half turns to times, shape (n, n).
    """

    momentum: MomentumMap
    state: Array
    units: Array
    scaling: Array

    @classmethod
    def at(cls, momentum: MomentumMap, state: Array, units: Array) -> Closures:
        """The flows through a state, with units of the leaf.

        Combinations of the flows that are orthogonal at the state are each followed until they turn back: to the
        largest distance from the state before it gets smaller again.

        Raises:
            OrbitError: they are dependent there, or the torus is too thin.
        """
        units = units * 2.0 ** max(0, frexp(float(np.abs(state / units).max()))[1])
        fields = momentum.fields(state) / units[:, None]
        if not np.isfinite(fields).all():
            raise OrbitError(f"state: wanted one with finite flows; got {state.tolist()}. Take a smaller one.")
        if momentum.rank(state) < len(momentum.names):
            raise OrbitError(
                f"state: wanted one with independent flows of {', '.join(momentum.names)}; got a critical one, "
                f"{state.tolist()}. Take another."
            )
        lengths = linear.norm(fields, axis=0)
        _, _, combinations = linear.svd(fields / lengths)
        found = [cls._half_turn(momentum, state, units, one / lengths) for one in combinations]
        if min(extent for extent, _ in found) < _THINNEST:
            raise OrbitError(
                f"state: wanted one on a torus that doubles resolve; the one through {state.tolist()} has the extent "
                f"{min(extent for extent, _ in found):.1g} in one direction, relative to the state: it is near to a "
                "critical one. Take another."
            )
        return cls(momentum, state, units, np.array([times for _, times in found]).T)

    @staticmethod
    def _whole(momentum: MomentumMap, state: Array, units: Array, times: Array, extent: float) -> tuple[float, Array]:
        """The half turn, if the first one was a small part of a longer one, as beside a well."""
        later = np.arange(1, 16 * _WINDOW + 1)[:, None] / 16 * times
        distance = linear.norm((momentum.flow(state, later) - state) / units, axis=1)
        if distance.max() < 2 * extent:
            return extent, times
        return extent, later[int(np.flatnonzero(distance >= distance.max() / 2)[0])]

    @classmethod
    def _half_turn(cls, momentum: MomentumMap, state: Array, units: Array, rates: Array) -> tuple[float, Array]:
        """The extent of a combination of the flows, in units, and the times after which it is reached."""
        speed = float(linear.norm(linear.matmul(momentum.fields(state) / units[:, None], rates)))
        # In a thousandth of the time in which the state would go its own size
        step = 1e-3 / speed
        times, distance = step * rates[None], np.ones(1)
        for _ in range(_DOUBLINGS):
            times = step * np.arange(1, _SAMPLES + 1)[:, None] * rates
            distance = linear.norm((momentum.flow(state, times) - state) / units, axis=1)
            falls = np.flatnonzero(distance[1:] < 0.999 * np.maximum.accumulate(distance)[:-1])
            if len(falls):
                top = int(distance[: falls[0] + 1].argmax())
                if top >= _SAMPLES // 8:
                    return cls._whole(momentum, state, units, times[top], float(distance[top]))
                step /= _SAMPLES / 2
                continue
            if not np.isfinite(distance).all():
                break
            step *= _SAMPLES / 4
        return float(distance[0]) if np.isfinite(distance[0]) else 1.0, times[0]

    def distances(self, times: Array) -> Array:
        """How far the flows are from closing, shape (m,), for times of shape (m, n)."""
        ends = self.momentum.flow(self.state, times)
        return linear.norm((ends - self.state) / self.units, axis=-1)

    def closes(self, times: Array) -> NDArray[np.bool_]:
        """Whether flows close, in distance and in turns, for times of shape (m, n)."""
        ends = self.momentum.flow(self.state, times)
        near = linear.norm((ends - self.state) / self.units, axis=-1) < _CLOSES
        turns = linear.norm(linear.matmul(self._step(ends, self.state), linear.inv(self.scaling).T), axis=-1)
        return near & (turns < _SAME)

    def closed(self, times: Array) -> Array:
        """What Newton's method makes of times of shape (m, n): those that close, in order, the time 0 among them."""
        t, rows = self.arriving(times, np.broadcast_to(self.state, (len(times), len(self.state))))
        t = t[np.argsort(rows)]
        # Steps along the orbit carry its errors along: once more from the state itself
        for _ in range(2):
            if len(t):
                t = t + self._step(self.momentum.flow(self.state, t), self.state)
                t = t[np.isfinite(t).all(axis=1)]
        return t[self.closes(t)] if len(t) else t

    def arriving(self, times: Array, targets: Array) -> tuple[Array, NDArray[np.intp]]:
        """Times after which the flows come from the state to targets, and whose, of guesses of shape (m, n)."""
        t, rows = times.copy(), np.arange(len(times))
        x = self.momentum.flow(self.state, t)
        arrived, whose = [np.zeros((0, times.shape[1]))], [np.zeros(0, dtype=np.intp)]
        for _ in range(_STEPS):
            step = self._step(x, targets[rows])
            there = linear.norm((targets[rows] - x) / self.units, axis=1) < _CLOSES / 100
            arrived.append(t[there])
            whose.append(rows[there])
            good = np.isfinite(step).all(axis=1) & ~there
            t, x, step, rows = t[good], x[good], step[good], rows[good]
            if not len(t):
                break
            length = linear.norm(linear.matmul(step, linear.inv(self.scaling).T), axis=1)
            step *= np.minimum(1.0, _LONGEST / np.maximum(length, 1e-300))[:, None]
            t, x = t + step, self.momentum.flow(x, step)
        there = linear.norm((targets[rows] - x) / self.units, axis=1) < _CLOSES
        return np.concatenate([*arrived, t[there]]), np.concatenate([*whose, rows[there]])

    def _step(self, x: Array, target: Array) -> Array:
        fields = self.momentum.fields(x) / self.units[:, None]
        gap = (target - x) / self.units
        transposed = np.swapaxes(fields, -1, -2)
        square = linear.matmul(transposed, fields)
        right = linear.matmul(transposed, gap[..., None])
        sizes = np.abs(linear.det(square))
        regular = np.isfinite(sizes) & (sizes > 0)
        found = np.full((len(x), fields.shape[-1]), np.nan)
        found[regular] = linear.solve(square[regular], right[regular])[..., 0]
        return found

    def lattice(self, seed: int) -> Array:
        """A reduced basis, as rows.

        Raises:
            OrbitError: too few flows close.
        """
        n = len(self.momentum.names)
        draw = stream(seed, Purpose.PERIOD_LATTICE)
        to_length = linear.inv(self.scaling).T
        known, last = np.zeros((0, n)), None
        for length in _LENGTHS:
            m = _GUESSES * n
            directions = draw.standard_normal((m, n))
            directions /= linear.norm(directions, axis=1, keepdims=True)
            sizes = length * elementary.power(draw.uniform(size=(m, 1)), 1 / n)
            found = linear.matmul(self.closed(linear.matmul(directions * sizes, self.scaling.T)), to_length)
            known = generated(np.concatenate([known, found]))
            if len(known) == n:
                if last is not None and abs(abs(linear.det(known)) - last) < 1e-6 * last:
                    periods = linear.matmul(self._finest(known), self.scaling.T)
                    if self.closes(periods).all():
                        return periods
                last = float(abs(linear.det(known)))
        raise OrbitError(
            f"state: wanted one on a torus of dimension {n}; of the flows of {', '.join(self.momentum.names)} only "
            f"{len(known)} independent combinations were found to close within {_LENGTHS[-1]:g} half turns. The "
            "fibre is not compact, or the state is near to a critical one."
        )

    def _finest(self, basis: Array) -> Array:
        """The lattice itself, if the one found is a part of it of small index."""
        n = len(basis)
        for p in _PRIMES:
            while True:
                shares = np.array([s for s in product(range(p), repeat=n) if _first(s) == 1]) / p
                tried = linear.matmul(shares, basis)
                closes = self.closes(linear.matmul(tried, self.scaling.T))
                if not closes.any():
                    break
                basis = generated(np.concatenate([basis, tried[closes]]))
        return basis


def _first(shares: Sequence[int]) -> int:
    return next((s for s in shares if s), 0)


def generated(vectors: Array) -> Array:
    """A reduced basis of the lattice that vectors generate, as rows; differences below `_SAME` are errors."""
    rows = list[Array]()
    pending = sorted(vectors, key=lambda v: float((v * v).sum()))
    while pending:
        v = _remainder(pending.pop(0), rows)
        if linear.norm(v) < _SAME:
            continue
        rank = _rank([*rows, v])
        if rank > len(rows):
            rows.append(v)
        else:
            # A shorter vector inside of the span: what it replaces is looked at again
            pending = [*rows, *pending]
            rows = [v]
        rows = _reduced(rows)
    return np.array(rows).reshape(len(rows), vectors.shape[1])


def _rank(rows: list[Array]) -> int:
    """The rank of vectors none of which is short; dependent ones are so to 1e-7."""
    sizes = linear.svd(np.array(rows) / linear.norm(np.array(rows), axis=1, keepdims=True), compute_uv=False)
    return int((sizes > 1e-7).sum())


def _remainder(v: Array, rows: list[Array]) -> Array:
    """A vector less the multiples of the basis that are nearest to it."""
    if not rows:
        return v
    basis = np.array(rows)
    shares = linear.lstsq(basis.T, v)[0]
    return v - linear.matmul(np.round(shares), basis)


def _reduced(rows: list[Array]) -> list[Array]:
    """No sum or difference of two vectors is shorter than the longer one."""
    rows = list(rows)
    changed = True
    while changed:
        changed = False
        rows.sort(key=lambda v: float((v * v).sum()))
        for i in range(len(rows)):
            for j in range(i):
                share = np.round((rows[i] * rows[j]).sum() / (rows[j] ** 2).sum())
                shorter = rows[i] - share * rows[j]
                if (shorter**2).sum() < (1 - 1e-12) * (rows[i] ** 2).sum():
                    rows[i], changed = shorter, True
    return rows
