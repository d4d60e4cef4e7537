r"""Monodromy: the period lattice carried around a loop of regular values.

Along a path of values inside of the regular ones the lattice moves continuously.  Its basis $P(s)$ is carried by
Newton's method for closing flows, from one value to the next; around a loop it comes back as another basis of the same
lattice, $P(1) = M\,P(0)$ with a matrix M of integers of determinant 1, the same for loops that can be deformed into
each other [duistermaat1980].  M is not trusted unless it is of integers to the accuracy of the periods, its determinant
is 1, and the carried periods close.

Steps are halved until the periods change by less than a quarter of the shortest vector of the lattice: a lattice point
can then not be taken for another one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import OrbitError, ParameterError, ShapeError
from liepoisson.formula.scalars import TIME_LIMIT, as_array, as_phase_points, as_seed, as_time_limit
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import Deadline
from liepoisson.io.tables import vector_columns
from liepoisson.leaf.leaf import Leaf
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import linear
from liepoisson.tori.momentum_maps import MomentumMap, map_of, on_fibre
from liepoisson.tori.period_lattices import Closures

if TYPE_CHECKING:
    from sympy import Expr

    from liepoisson.model.system import System

_SHARE = 0.25
"""How far a period may move in a step, in lengths of the shortest vector: half of it could be another lattice point."""
_PARTS, _SMOOTH = 4, 0.05
"""A step goes in so many parts, between which the periods differ from a straight line by less than this share of the
shortest vector: beside a critical value they grow like logarithms, and do not, however short the step."""
_LEAST_STEP = 2.0**-20
"""The shortest step, relative to the loop: below it the path meets a critical value."""
_INTEGER = 1e-6
"""How far the matrix may be from integers."""


@dataclass(frozen=True, eq=False)
class Monodromy(SavedWhole):
    r"""What becomes of the basis of a period lattice that is carried around a loop.

    Example:
        >>> pendulum = lp.catalog.system("spherical-pendulum")
        >>> angle = np.linspace(0, 2 * np.pi, 25)
        >>> loop = np.stack([1 + 0.5 * np.cos(angle), 0.5 * np.sin(angle)], axis=1)  # around the upright pendulum
        >>> found = lp.tori.monodromy(pendulum, [0, 1.3, 0, 0.8, 0, 0.6], loop)
        >>> found.trace, found.is_unipotent
        (2, True)

    Attributes:
        momentum: The momentum map.
        loop: The values at the corners of the loop, shape (m, n), the last equal to the first.
        periods: A basis at the first value, as rows, shape (n, n).
        matrix: M, of integers, shape (n, n); the carried basis is M times `periods`.
        residual: How far M was from integers.
        n_steps: Values at which the lattice was computed.
    """

    kind = "monodromy"
    made_by = "lp.tori.monodromy"
    row = "period"

    momentum: MomentumMap
    loop: Array
    periods: Array
    matrix: NDArray[np.int64]
    residual: float
    n_steps: int

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.momentum.system

    @property
    def trace(self) -> int:
        """The trace of M."""
        return int(np.trace(self.matrix))

    @property
    def is_trivial(self) -> bool:
        """Whether M is the identity."""
        return bool((self.matrix == np.eye(len(self.matrix), dtype=np.int64)).all())

    @property
    def is_unipotent(self) -> bool:
        """Whether a power of M - 1 is zero, as around focus-focus values."""
        rest = (self.matrix - np.eye(len(self.matrix))).astype(np.float64)
        power = rest
        for _ in rest:
            power = linear.matmul(power, rest)
        return not power.any()

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each period of the basis its times, and what it becomes, a row of M."""
        rows: dict[str, NDArray[Any]] = dict(vector_columns("time", self.periods, self.momentum.names))
        return rows | {f"M_{k}": column for k, column in enumerate(self.matrix.T, start=1)}

    def __repr__(self) -> str:
        return f"<Monodromy {self.matrix.tolist()} of {self.momentum.system.name!r}>"


@explains_its_arguments
def monodromy(
    system: System | MomentumMap,
    state: ArrayLike,
    loop: ArrayLike,
    *,
    integrals: Sequence[str | Expr | PhaseFunction] | None = None,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
) -> Monodromy:
    r"""The monodromy of the tori of an integrable system along a closed polygon of values.

    Example:
        >>> pendulum = lp.catalog.system("spherical-pendulum")
        >>> loop = [[0, 0.2], [0.5, 0.2], [0.5, -0.2], [0, -0.2]]  # around nothing
        >>> lp.tori.monodromy(pendulum, [0.3, 0.8, 0.2, 0.8, 0, 0.6], loop).is_trivial
        True

    Args:
        system: A system whose parameters are all numbers, or its momentum map.
        state: A state on the leaf, near the first torus: it is moved to the first value.
        loop: Values of the integrals at the corners, in the order of the momentum map, shape (m, n).  If the last is
            not the first, the polygon is closed.
        integrals: The other integrals than H, see `momentum_map`.
        seed: Draws the guesses for the first lattice.
        time_limit: Seconds that the call may take.

    Raises:
        ShapeError: loop is no array of values.
        ParameterError: the loop is a point.
        LeafError: the integrals commute on another leaf only.
        OrbitError: the first value is not reached from the state, too few flows close there, or the loop meets a
            critical value, with the value where it does.
        TimeLimitError: the time is over.

    References: [duistermaat1980], [cushman2015].
    """
    deadline = Deadline(as_time_limit(time_limit))
    momentum = map_of(system, integrals)
    bracket = momentum.system.bracket
    x = as_phase_points(state, bracket.coordinate_names_in_order, bracket.field_names, "state")
    corners, number = _corners(loop, momentum.names), as_seed(seed)
    with deadline.running(), np.errstate(all="ignore"):
        leaf = momentum.leaf_through(x)
        first = on_fibre(momentum, leaf, x[None], corners[0])[0]
        if not np.isfinite(first).all():
            raise OrbitError(
                f"loop: Newton's method did not come from the state, with the values {momentum(x).tolist()}, to the "
                f"first value {corners[0].tolist()}. Give a state nearer to it."
            )
        periods = Closures.at(momentum, first, leaf.in_units().units).lattice(number)
        forth = _Carrier(momentum, leaf, first, periods)
        for corner in corners[1:]:
            forth.go(corner)
        quotient = linear.matmul(forth.periods, linear.inv(periods))
    matrix = np.round(quotient)
    residual = float(np.abs(quotient - matrix).max())
    if not residual < _INTEGER or round(float(linear.det(matrix))) != 1:
        raise OrbitError(
            f"loop: the carried periods are {residual:.1g} away from integer combinations of the first ones: the "
            "fibres have several tori, and another one was met. Give a loop with more corners."
        )
    return Monodromy(momentum, corners, periods, matrix.astype(np.int64), residual, forth.n_steps)


def _corners(given: ArrayLike, names: Sequence[str]) -> Array:
    corners, n = as_array(given, "loop", names), len(names)
    if corners.ndim != 2 or corners.shape[1] != n or len(corners) < 3:
        raise ShapeError(f"loop: wanted at least three values of {n} integrals, shape (m, {n}); got {corners.shape}")
    if not np.isfinite(corners).all():
        raise ParameterError("loop: wanted finite values")
    if not np.array_equal(corners[0], corners[-1]):
        corners = np.concatenate([corners, corners[:1]])
    if not np.ptp(corners, axis=0).any():
        raise ParameterError("loop: wanted values that differ; got one point")
    return corners


class _Carrier:
    """A state on a fibre and a basis of its lattice, which follow a path of values."""

    def __init__(self, momentum: MomentumMap, leaf: Leaf, state: Array, periods: Array) -> None:
        self.momentum = momentum
        self.leaf = leaf
        self.state = state
        self.periods = periods
        self.value = momentum(state)
        self.n_steps = 0
        self._step = 1.0
        self._to_length, self._shortest = np.eye(len(periods)), 0.0

    def go(self, target: Array) -> None:
        """Along a straight line.

        Raises:
            OrbitError: it meets a critical value.
        """
        begin, done = self.value, 0.0
        while done < 1:
            step = min(self._step, 1 - done)
            ends = [begin + (done + step * k / _PARTS) * (target - begin) for k in range(1, _PARTS + 1)]
            if done + step >= 1:
                ends[-1] = target
            if self._moves(ends):
                done += step
                self._step = min(2 * step, 1.0)
            else:
                self._step = step / 2
                if self._step < _LEAST_STEP:
                    at = (begin + done * (target - begin)).tolist()
                    raise OrbitError(
                        f"loop: wanted one of regular values; the lattice cannot be carried beyond {at}. There is a "
                        "critical value, or the fibre ends. Go around it."
                    )

    def _moves(self, values: Sequence[Array]) -> bool:
        """A step in equal parts, along which the periods are smooth."""
        before = self.state, self.periods, self.value, self.n_steps
        passed = [self.periods]
        for value in values:
            if not self._moves_to(value):
                break
            passed.append(self.periods)
        if len(passed) > len(values):
            along = np.array(passed)
            shares = (np.arange(len(along)) / len(values))[:, None, None]
            bent = along - along[0] - shares * (along[-1] - along[0])
            if linear.norm(linear.matmul(bent, self._to_length), axis=-1).max() < _SMOOTH * self._shortest:
                return True
        self.state, self.periods, self.value, self.n_steps = before
        return False

    def _moves_to(self, value: Array) -> bool:
        state = on_fibre(self.momentum, self.leaf, self.state[None], value)[0]
        if not np.isfinite(state).all() or self.momentum.rank(state) < len(value):
            return False
        try:
            torus = Closures.at(self.momentum, state, self.leaf.in_units().units)
        except OrbitError:  # too thin
            return False
        found = torus.closed(self.periods)
        if len(found) < len(self.periods):
            return False
        self._to_length = linear.inv(torus.scaling).T
        old, new = linear.matmul(self.periods, self._to_length), linear.matmul(found, self._to_length)
        self._shortest = linear.norm(new, axis=1).min()
        if not linear.norm(new - old, axis=1).max() < _SHARE * self._shortest:
            return False
        self.state, self.periods, self.value = state, found, value
        self.n_steps += 1
        return True
