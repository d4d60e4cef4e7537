r"""Random states on a leaf with the Liouville measure by a population of Markov chains.

The chain is that of [zappa2018] on the leaf, with the density $1/\sqrt{\det GG^t}$ relative to the area, where the rows
of $G$ are the gradients of the equations.  An energy surface may consist of parts between which no chain passes, and
the number of chains in each must not be that of their starts.  So the population begins in a large set around the
surface and descends, as in subset simulation (Au and Beck) and nested sampling (Skilling):

1. The set is $|H - E|\le s$, for states below an energy $(H - E)_+\le s$, with s so large that the set is the whole
   leaf if that is compact, and most of the random starts else.
2. Half of the states lie in a smaller set of this kind; they are kept and doubled, and all make some steps in it.  No
   state needs to pass from one part to another: the parts keep the shares that the measure gives them.
3. In a window so narrow that H is uniform in it, the states are projected to $H = E$; the surfaces at the two ends err
   in opposite directions.

With N states the share p of a part that got separated k halvings before the end has a standard error of about
$\sqrt{k\,p(1-p)/N}$.  Parts that no set of step 1 connects have the shares of their starts.  Such chains remember where
they started, and this is what the `MixingWarning` says.

References: Au and Beck, Probab. Eng. Mech. 16 (2001) 263; Skilling, Bayesian Anal. 1 (2006) 833.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import LeafError, MixingWarning
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import level_of_the_caller
from liepoisson.inputs.deadline import checkpoint
from liepoisson.leaf.leaf_in_units import LeafInUnits, unit_length
from liepoisson.leaf.leaf_projection import CONVERGED, Equations, solve
from liepoisson.leaf.leaf_search import energy_scale, representative
from liepoisson.model.phase_functions import PhaseFunction
from liepoisson.portable import elementary, linear
from liepoisson.streams import Purpose, Random, stream

if TYPE_CHECKING:
    from liepoisson.leaf.leaf import Leaf
    from liepoisson.leaf.leaf_sampling import Shell

N_CHAINS = 2048
"""Chains side by side: the states of the population."""

_BURN_IN, _DOUBLINGS = 80, 6
"""Steps in the largest set until its states are compared for the first time; their number is doubled at most this often
until the population stands still."""

_DRIFT = 4.0
"""Largest difference of two means, of a coordinate, its square or H, that counts as none, in standard errors.

The starts are not distributed like the set, and chains that forget them one by one may still move all in one direction.
What moves by this little from half of the steps to all of them has, if it relaxes exponentially, less left to go.
"""

_REMEMBERED = 0.35
"""Largest correlation of a coordinate or its square with that at half of the steps that counts as forgotten.

Chance alone gives 0.02 in 2048 chains.  Chains that never leave their part remember it with a correlation near one.
"""

_ROUNDS, _LAST_STEPS, _THINNING = 2, 25, 25
"""Steps of each kind after a halving; steps on the last set; steps from one kept state to the next."""

_RETURN_STEPS = 8
"""Newton steps back to the surface; a proposal that needs more is refused, there as on the way back."""

_MOST_HALVINGS = 150
_UNIFORM = 0.05
"""How far the shares of the four quarters of a window may be from 1/4; five standard errors of 2048 states."""
_HALVINGS_WHEN_UNIFORM = 2
"""Further halvings then; what H departs from uniform by its curvature falls by 16."""

_NARROWEST = 1e-13
"""Smallest width of a window, as a fraction of the scale of energies."""

_QUANTILES = (0.75, 0.4, 0.15, 0.05)
"""Shares of the random starts that the first set contains; the first one for which it is bounded."""


@dataclass(frozen=True)
class _Chain:
    r"""A surface with the density $1/\sqrt{\det G G^t}$ relative to the area, where H is at most a distance away."""

    equations: Equations
    energy: PhaseFunction
    shell: Shell | None
    width: float = np.inf

    def distance(self, x: Array) -> Array:
        """How far H is from the energy that was asked for, infinite where it is not defined."""
        if self.shell is None:
            return np.zeros(len(x))
        excess = self.energy(x) - self.shell.energy
        excess = np.maximum(excess, 0.0) if self.shell.is_filled else np.abs(excess)
        return np.where(np.isnan(excess), np.inf, excess)

    def log_density(self, x: Array) -> Array:
        rows = self.equations.rows(x)
        gram = linear.slogdet(linear.matmul(rows, np.swapaxes(rows, -1, -2)))[1]
        inside = self.distance(x) <= self.width if self.width < np.inf else np.isfinite(gram)
        return np.where(inside, -0.5 * gram, -np.inf)

    def levels(self, x: Array) -> _Chain:
        """The chain on which each state keeps its own energy."""
        equations = self.equations.with_function(self.energy, 0.0)
        values = np.broadcast_to(equations.values, (len(x), len(equations.values))).copy()
        values[:, -1] = self.energy(x)
        return _Chain(replace(equations, values=values), self.energy, self.shell)

    @np.errstate(all="ignore")  # functions need not exist at proposals; these are refused
    def step(self, rng: Random, x: Array, size: float) -> tuple[Array, float]:
        """One step of each chain, and the share of them that moved.

        Move along the tangent space, come back along the old normals, and check that the way back exists.
        """
        checkpoint("sampling a leaf")
        normals = self._normals(x)
        noise = size * rng.standard_normal(x.shape)
        there = noise - _along(normals, noise)
        y, found = self._return(x + there, normals)
        y[~found] = x[~found]
        back, new_normals = x - y, self._normals(y)
        back -= _along(new_normals, back)
        change = self.log_density(y) - self.log_density(x)
        forth_and_back = (np.sum(there**2, axis=-1) - np.sum(back**2, axis=-1)) / (2 * size**2)
        moved = found & (elementary.log(rng.uniform(size=len(x))) < change + forth_and_back)
        left = np.flatnonzero(moved)  # the way back is the larger half of the work
        again = self._rows(left)._return((y + back)[left], new_normals[left])[0]
        moved[left] = linear.norm(again - x[left], axis=-1) <= 1e-8 * linear.norm(x[left], axis=-1)
        return np.where(moved[:, None], y, x), float(moved.mean())

    def _rows(self, rows: NDArray[np.intp]) -> _Chain:
        """The chain of some of the states, which may have values of their own."""
        values = self.equations.values
        return replace(self, equations=replace(self.equations, values=values[rows])) if values.ndim == 2 else self

    def _normals(self, x: Array) -> Array:
        """Orthonormal bases of the normal spaces, as columns."""
        return linear.qr(np.swapaxes(self.equations.rows(x), -1, -2))[0]

    def _return(self, start: Array, normals: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Newton's method from a point back to the surface, along given normals."""
        y, active = start.copy(), np.arange(len(start))
        for _ in range(_RETURN_STEPS):
            values, rows = self._rows(active).equations.relative(y[active])
            is_open = np.abs(values).max(axis=-1, initial=0.0) > 1e-14
            active = active[is_open]
            if not active.size:
                break
            step, singular = _solved(linear.matmul(rows[is_open], normals[active]), values[is_open])
            step[singular] = 0.0
            moved = y[active] - linear.einsum("...ij,...j->...i", normals[active], step)
            lost = ~(np.abs(moved) < 1e100).all(axis=-1)
            moved[lost] = start[active[lost]]
            y[active] = moved
            active = active[~lost]
        return y, self.equations.residual(y) <= CONVERGED


@dataclass
class _Population:
    """The states, and the sizes of the steps of the two kinds."""

    rng: Random
    x: Array
    along_leaf: float
    along_level: float

    def move(self, chain: _Chain) -> None:
        """A step on the leaf; the size is adapted towards half of the steps accepted."""
        self.x, moved = chain.step(self.rng, self.x, self.along_leaf)
        self.along_leaf *= float(elementary.exp(2 * (moved - 0.5)))

    def move_along_levels(self, chain: _Chain) -> None:
        """A step at constant energy, which in a narrow window can be much longer."""
        self.x, moved = chain.levels(self.x).step(self.rng, self.x, self.along_level)
        self.along_level *= float(elementary.exp(2 * (moved - 0.5)))

    def refill(self, kept: NDArray[np.bool_]) -> None:
        """Keep some states only, in random order, as often as it takes to have as many as before."""
        order = self.rng.permutation(np.flatnonzero(kept))
        self.x = self.x[order[np.arange(len(self.x)) % len(order)]]


def sample_by_chains(leaf: Leaf, n: int, seed: int, shell: Shell | None) -> Array:
    """The population at the end of its descent, then every 25th state of its chains.

    Raises:
        LeafError: the set is not bounded, or no state of it was found.
    """
    view = representative(leaf).in_units(None if shell is None else shell.energy)
    rng = stream(seed, Purpose.CHAINS)
    chain, starts = _chain_and_starts(view, rng, shell)
    size = 0.3 * float(linear.norm(starts, axis=-1).mean())
    population = _Population(rng, starts, size, size)
    view, chain = _forget(view, chain, population)
    last = _descend(view, chain, population)
    size = population.along_leaf if last.shell is None or last.shell.is_filled else population.along_level
    x = population.x
    for step in range(_LAST_STEPS):
        x, moved = last.step(rng, x, size)
        size *= float(elementary.exp((moved - 0.5) * 2 / np.sqrt(1 + step)))
    kept = [rng.permutation(x)]
    while len(kept) * N_CHAINS < n:
        for _ in range(_THINNING):
            x, _ = last.step(rng, x, size)
        kept.append(x)
    return np.concatenate(kept)[:n] * view.units


def _forget(leaf: LeafInUnits, chain: _Chain, population: _Population) -> tuple[LeafInUnits, _Chain]:
    """Steps in the largest set until the states say nothing about their starts, and the population stands still.

    Returns:
        The leaf in units in which the population is as wide in each coordinate, so that steps are as long as they can
        be in all of them, and the chain there.
    """
    memory = drift = np.inf
    n_done = 0
    for _ in range(_DOUBLINGS + 1):
        before, n_more = population.x, n_done or _BURN_IN
        for _ in range(n_more):
            population.move(chain)
        n_done += n_more
        memory, drift = _memory(before, population.x), _drift(chain, before, population.x)
        if memory <= _REMEMBERED and drift <= _DRIFT:
            return leaf, chain
        leaf, chain = _equally_wide(leaf, chain, population)
    warnings.warn(
        f"the states of {leaf!r} should be spread by its Liouville measure; after {n_done} steps "
        f"they have a correlation of {memory:.2f} with where their chains were halfway, and means that moved by up to "
        f"{drift:.1f} standard errors since: the chains mix slowly, or the leaf has parts between which they do not "
        "pass, whose shares are then arbitrary. Compare seeds, and split the sample into its parts.",
        MixingWarning,
        stacklevel=level_of_the_caller(),
    )
    return leaf, chain


def _equally_wide(leaf: LeafInUnits, chain: _Chain, population: _Population) -> tuple[LeafInUnits, _Chain]:
    """The leaf, the chain and the population with each coordinate divided by its width, to a power of two."""
    widths = population.x.std(axis=0)
    typical = float(np.median(widths[widths > 0])) if widths.any() else 1.0
    factors = np.ldexp(1.0, np.round(elementary.log2(np.where(widths > 0, widths, typical) / typical)).astype(int))
    leaf = replace(leaf, units=leaf.units * factors)
    population.x = population.x / factors
    return leaf, replace(chain, equations=leaf.equations, energy=leaf.system.functions.energy)


def _drift(chain: _Chain, before: Array, after: Array) -> float:
    """The largest change of a mean of the coordinates, their squares and H, in standard errors."""
    earlier, later = (np.column_stack([x, x**2, chain.energy(x)]) for x in (before, after))
    errors = np.sqrt((earlier.var(axis=0) + later.var(axis=0)) / len(before))
    varies = errors > 1e-10 * np.abs(later).max(axis=0) / np.sqrt(len(before))
    changes = np.abs(later.mean(axis=0) - earlier.mean(axis=0))
    return float((changes[varies] / errors[varies]).max(initial=0.0))


def _memory(before: Array, after: Array) -> float:
    """The largest correlation, in absolute value, of a coordinate or its square in two sets of states."""
    earlier, later = (np.concatenate([x, x**2], axis=-1) for x in (before, after))
    earlier, later = (v - v.mean(axis=0) for v in (earlier, later))
    sizes = np.sqrt(np.sum(earlier**2, axis=0) * np.sum(later**2, axis=0))
    varies = np.minimum(earlier.std(axis=0), later.std(axis=0)) > 1e-10 * np.abs(after).max()
    return float(np.abs(np.sum(earlier * later, axis=0)[varies] / sizes[varies]).max(initial=0.0))


def _descend(leaf: LeafInUnits, chain: _Chain, population: _Population) -> _Chain:
    """Halve the set until it is the one that was asked for, and return the chain on that."""
    shell = chain.shell
    if shell is None:
        return chain
    n_uniform = 0
    for _ in range(_MOST_HALVINGS):
        distance = chain.distance(population.x)
        width = float(np.median(distance))
        n_uniform += bool(n_uniform) or (not shell.is_filled and _is_uniform(chain, population.x, width))
        if n_uniform > _HALVINGS_WHEN_UNIFORM or not width < chain.width:
            break
        population.refill(distance <= width)
        chain = replace(chain, width=width)
        for _ in range(_ROUNDS):
            population.move(chain)
            # As long as the window ends below the least energy, steps on the leaf are long enough.
            if not shell.is_filled and np.mean(chain.energy(population.x) < shell.energy) > 0.1:
                population.move_along_levels(chain)
        if width <= _NARROWEST * energy_scale(leaf, shell.energy):
            break
    last = chain if shell.is_filled else _Chain(leaf.constraints(shell.energy), chain.energy, shell)
    x, residual = solve(last.equations, population.x)
    found = residual <= CONVERGED
    if shell.is_filled:
        last = replace(chain, width=0.0)
        found &= chain.distance(x) <= 0.0
    if not found.any():
        raise LeafError(
            f"no state was found to start from on {leaf!r} with this energy. Take one further from its range."
        )
    population.x = x
    population.refill(found)
    return last


def _is_uniform(chain: _Chain, x: Array, width: float) -> bool:
    """Whether H looks uniform in the window of a chain: in four parts, cut in the middle and at half the width."""
    assert chain.shell is not None
    if not width < 0.75 * chain.width < np.inf:
        return False
    parts = np.histogram((chain.energy(x) - chain.shell.energy) / chain.width, np.linspace(-1, 1, 5))[0]
    return bool(np.abs(parts / len(x) - 0.25).max() <= _UNIFORM)


def _chain_and_starts(leaf: LeafInUnits, rng: Random, shell: Shell | None) -> tuple[_Chain, Array]:
    """The chain on the largest set, and states in it that depend on the leaf but not on how it was given."""
    energy, n = leaf.system.functions.energy, len(leaf.state)
    boundary = leaf.constraints(shell.energy) if shell is not None else leaf.equations
    size = float(linear.norm(leaf.state)) + unit_length(leaf.system.bracket)
    if _reaches_far(boundary, size, rng):
        raise LeafError(infinite_volume(leaf, shell))
    chain = _Chain(leaf.equations, energy, shell)
    spread = rng.standard_normal((4 * N_CHAINS, n)) * size / np.sqrt(n)
    spread *= elementary.exp(rng.uniform(elementary.log(0.2), elementary.log(5.0), (len(spread), 1)))
    x, residual = solve(leaf.equations, spread)
    x = x[(residual <= CONVERGED)]
    x = x[np.isfinite(chain.log_density(x))]
    if shell is not None and _reaches_far(leaf.equations, size, rng):
        x, chain = _bounded(leaf, chain, x, size, rng)
    if not len(x):
        raise LeafError(f"no state was found to start from on {leaf!r}. Take another leaf.")
    return chain, x[np.arange(N_CHAINS) % len(x)]


def _bounded(leaf: LeafInUnits, chain: _Chain, x: Array, size: float, rng: Random) -> tuple[Array, _Chain]:
    """The states in a bounded set around the energy, and the chain on that; the smallest one if none looks bounded."""
    shell = chain.shell
    assert shell is not None
    distance = chain.distance(x)
    x, distance = x[np.isfinite(distance)], distance[np.isfinite(distance)]
    for quantile in _QUANTILES if len(x) else ():
        chain = replace(chain, width=float(np.quantile(distance, quantile)))
        ends = [shell.energy + chain.width]
        if not shell.is_filled:
            ends.append(shell.energy - chain.width)
        if not any(_reaches_far(leaf.constraints(end), size, rng) for end in ends):
            break
    return x[distance <= chain.width], chain


def _reaches_far(equations: Equations, size: float, rng: Random) -> bool:
    """Whether Newton's method from states a thousand times as far ends a hundred times as far: not compact."""
    found, residual = solve(equations, rng.standard_normal((256, equations.pinned.shape[-1])) * 1e3 * size)
    return bool(np.any(linear.norm(found[residual <= CONVERGED], axis=-1) > 100 * size))


def infinite_volume(leaf: Leaf | LeafInUnits, shell: Shell | None = None) -> str:
    """What is wrong with a set of infinite volume."""
    at = "" if shell is None else f" at the energy {shell.energy + leaf.still_energy:.6g}"
    advice = (
        "Give an energy, if the energy bounds the set."
        if shell is None
        else "A bounded part of it, such as a well, has no name here: draw states around it, keep those inside, and "
        "start from them."
    )
    return (
        f"the set to sample on {leaf!r}{at} is not bounded, "
        f"so that its Liouville volume is infinite and no state is typical. {advice}"
    )


def _along(normals: Array, v: Array) -> Array:
    return linear.einsum("...ij,...kj,...k->...i", normals, normals, v)


def _solved(matrices: Array, values: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Solutions of small systems, and which of the matrices are singular."""
    singular = ~(np.abs(linear.det(matrices)) > 1e-200)
    safe = np.where(singular[:, None, None], np.eye(matrices.shape[-1]), matrices)
    return cast("Array", linear.solve(safe, values[..., None])[..., 0]), singular
