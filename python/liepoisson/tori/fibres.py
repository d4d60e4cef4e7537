r"""How many tori the fibre of a regular value has, by a count: random states of it that commuting flows join.

Two states are on one torus if some $\Phi^t$ takes one to the other, which Newton's method finds from the points of a
grid of the torus that are near; that is a certainty to round-off.  A state that is farther from all points of the grid
than they are from their neighbours is on another torus; what is neither is not decided.  A torus that holds the share p
of the random states is missed by all m of them with probability $(1-p)^m$.

The states are random ones of the leaf that Newton's method moves onto the fibre: their density on it is of no meaning.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import OrbitError, ShapeError
from liepoisson.formula.scalars import TIME_LIMIT, as_array, as_count, as_positive, as_seed, as_time_limit
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.deadline import Deadline
from liepoisson.inputs.refusals import check_kind, counted
from liepoisson.io.tables import vector_columns
from liepoisson.leaf.leaf import Leaf
from liepoisson.orbits.saved_orbits import SavedWhole
from liepoisson.portable import elementary, linear
from liepoisson.streams import Purpose, stream
from liepoisson.tori.critical_search import check_resolved, momentum_of
from liepoisson.tori.momentum_maps import MomentumMap, on_fibre
from liepoisson.tori.period_lattices import Closures

if TYPE_CHECKING:
    from liepoisson.model.system import System

_ATTEMPTS = 8
"""Batches of random states that are moved to the fibre before it is called empty."""
_GRID, _REFINED = 600, 3
"""Points of a grid of a torus, and how often it may be made twice as fine in each direction."""
_NEAREST = 4
"""So many points of the grid near to a state are guesses."""


@dataclass(frozen=True, eq=False)
class Fibre(SavedWhole):
    r"""Random states of a fibre, by tori.

    Example:
        >>> oscillator = lp.System(lp.canonical(names=["q"]), "(p_q^2 + q^2)/2")
        >>> lp.tori.fibre(lp.Leaf(oscillator, {}), [0.5], n_states=20).states.shape
        (20, 2)

    Attributes:
        momentum: The momentum map.
        value: Values of the integrals, shape (n,).
        states: Shape (m, N).
        torus: The number of the torus of each state, shape (m,).
        n_tori: How many tori were found.
        missed: The share of states that a torus may have and be missed with a probability of 5%.
    """

    kind = "fibre"
    made_by = "lp.tori.fibre"
    row = "state"

    momentum: MomentumMap
    value: Array
    states: Array
    torus: NDArray[np.intp]
    n_tori: int
    missed: float

    @property
    def system(self) -> System:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The system."""
        return self.momentum.system

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table: of each state the number of its torus, and the state."""
        return {"torus": self.torus} | vector_columns("x", self.states, self.system.component_names)

    def __repr__(self) -> str:
        return (
            f"<Fibre of {self.momentum.system.name!r}: {counted(self.n_tori, 'torus', 'tori')} by {len(self.states)} "
            f"states; one with less than {100 * self.missed:.2g}% of them may be missed>"
        )


@explains_its_arguments
def fibre(
    leaf: Leaf,
    value: ArrayLike,
    *,
    momentum: MomentumMap | None = None,
    n_states: int = 200,
    spread: float = 1.0,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
) -> Fibre:
    r"""The tori of a regular fibre, counted.

    Example:
        >>> well = lp.System(lp.canonical(names=["q"]), "p_q^2/2 - q^2/2 + q^4/4")
        >>> leaf = lp.Leaf(well, {})
        >>> [lp.tori.fibre(leaf, [energy]).n_tori for energy in (-0.2, 0.2)]
        [2, 1]

    Args:
        leaf: The leaf.
        value: Values of the integrals, in the order of the momentum map, shape (n,).
        momentum: The momentum map; by default that of the known integrals of the system.
        n_states: Random states of the fibre.
        spread: Standard deviation of the random states that are moved to it, in units of the leaf.
        seed: Draws the random states.
        time_limit: Seconds that the call may take.

    Raises:
        ShapeError: there are not as many values as integrals.
        OrbitError: no state has these values, as far as was found; or the value is too near to a critical one.
        TimeLimitError: the time is over.
    """
    deadline = Deadline(as_time_limit(time_limit))
    check_kind(leaf, Leaf, "leaf", "a Leaf", "make it by lp.Leaf(system, {...})")
    momentum = momentum_of(leaf, momentum)
    wanted = as_array(value, "value", momentum.names)
    if wanted.shape != (len(momentum.names),) or not np.isfinite(wanted).all():
        raise ShapeError(
            f"value: wanted finite values of {', '.join(momentum.names)}, shape ({len(momentum.names)},); got "
            f"{wanted.tolist()}"
        )
    m = as_count(n_states, "n_states", least=1)
    width = as_positive(spread, "spread", "a positive number", example=1)
    with deadline.running(), np.errstate(all="ignore"):
        check_resolved(leaf, momentum)
        draw, units = stream(as_seed(seed), Purpose.FIBRES), leaf.in_units().units
        states = _states(leaf, momentum, wanted, lambda: width * draw.standard_normal((m, len(units))) * units, m)
        torus = joined(leaf, momentum, states, as_seed(seed))
    missed = 1 - float(elementary.power(0.05, 1 / len(states)))
    return Fibre(momentum, wanted, states, torus, int(torus.max()) + 1, missed)


def _states(leaf: Leaf, momentum: MomentumMap, value: Array, draw: Callable[[], Array], m: int) -> Array:
    """Random states of the fibre.

    Raises:
        OrbitError: none was found.
    """
    found = np.zeros((0, len(leaf.state)))
    for _ in range(_ATTEMPTS):
        some = on_fibre(momentum, leaf, draw(), value)
        found = np.concatenate([found, some[np.isfinite(some).all(axis=1)]])[:m]
        if len(found) == m:
            return found
    if len(found):
        return found
    raise OrbitError(
        f"value: wanted one of the image; none of {_ATTEMPTS * m} random states was moved to {value.tolist()} of "
        f"{', '.join(momentum.names)}. Take the values of a state, or another spread."
    )


def joined(leaf: Leaf, momentum: MomentumMap, states: Array, seed: int) -> NDArray[Any]:
    """The number of the torus of each of some states of a fibre.

    Raises:
        OrbitError: a state is near to a torus, but is not reached.
    """
    units = leaf.in_units().units
    torus = np.full(len(states), -1, dtype=np.intp)
    number = 0
    while (left := np.flatnonzero(torus < 0)).size:
        first = left[0]
        torus[first] = number
        if left.size > 1:
            flows = Closures.at(momentum, states[first], units)
            reached = _reached(flows, flows.lattice(seed), states[left[1:]])
            torus[left[1:][reached]] = number
        number += 1
    return torus


def _reached(flows: Closures, lattice: Array, targets: Array) -> NDArray[np.bool_]:
    """Which targets are on the torus of a state: those that flows lead to from a grid of the torus.

    A target of the torus is near to a point of the grid: no farther than its neighbours are.
    """
    n = len(lattice)
    reached = np.zeros(len(targets), dtype=bool)
    count = round(_GRID ** (1 / n))
    for _ in range(_REFINED):
        shares = np.array(list(product(range(count), repeat=n))) / count
        times = linear.matmul(shares, lattice)
        points = (flows.momentum.flow(flows.state, times) / flows.units).reshape(*(count,) * n, -1)
        reach = np.zeros((count,) * n)
        for axis in range(n):
            for shift in (1, -1):
                reach += linear.norm(np.roll(points, shift, axis) - points, axis=-1)
        points, reach = points.reshape(len(times), -1), reach.reshape(-1)
        left = np.flatnonzero(~reached)
        distance = linear.norm(targets[left, None] / flows.units - points, axis=2) / reach
        nearest = np.argsort(distance, axis=1, kind="stable")[:, :_NEAREST]
        near = np.take_along_axis(distance, nearest, axis=1) < 1
        guesses, rows = times[nearest[near]], np.broadcast_to(left[:, None], nearest.shape)[near]
        if not len(rows):
            return reached
        found = flows.arriving(guesses, targets[rows])[1]
        reached[rows[found]] = True
        if not set(rows.tolist()) - set(rows[found].tolist()):
            return reached
        count *= 2
    raise OrbitError(
        f"value: the number of its tori is not decided: the state {targets[np.flatnonzero(~reached)[0]].tolist()} is "
        f"near to the torus of {flows.state.tolist()}, but is not reached by its flows. The value is near to a "
        "critical one; take another."
    )
