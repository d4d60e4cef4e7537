r"""Random states on a leaf with the Liouville measure, of any energy, of one energy, or below one.

The Liouville measure of a leaf is $\delta(C - c)\,d^Nx$ up to a constant, and at energy E it is
$\delta(H - E)\,\delta(C - c)\,d^Nx$ (microcanonical), if the flow of every Hamiltonian preserves $d^Nx$:
$\mathrm{div}\,J\nabla H = \sum_{ij}\partial_i J_{ij}\,\partial_j H = 0$, that is, if the Lie algebra is unimodular.

Tops are sampled independently (`top_sampling`).  All others, and tops so close to their least energy that fewer than
one of 50 000 proposals would be accepted, by a population of Markov chains (`chain_sampling`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liepoisson.algebra.exact_numbers import is_zero
from liepoisson.errors import LeafError, ParameterError
from liepoisson.formula.scalars import as_count, as_seed
from liepoisson.inputs.arrays import Array, check_memory
from liepoisson.inputs.deadline import checkpoint
from liepoisson.leaf._checks import as_energy
from liepoisson.leaf.chain_sampling import infinite_volume, sample_by_chains
from liepoisson.leaf.leaf_search import check_energy_in_reach
from liepoisson.leaf.top_sampling import Draw, top_draw
from liepoisson.portable import elementary
from liepoisson.streams import Purpose, Random, stream

if TYPE_CHECKING:
    from liepoisson.compile.field import TopField
    from liepoisson.leaf.leaf import Leaf

_PROPOSALS = 2**14
_TRIAL_BLOCKS = 16


@dataclass(frozen=True)
class Shell:
    """States of one energy, or all below it.

    Attributes:
        energy: The energy.
        is_filled: Whether the states below are meant too.
    """

    energy: float
    is_filled: bool

    def weight(self, k: Array, dimension: int) -> Array:
        r"""The volume of the ellipsoid $u^t A u \le 2k$, or its area as $dV/dk$, up to a constant."""
        power = dimension / 2 - (0 if self.is_filled else 1)
        return np.where(k > 0, elementary.power(np.maximum(k, 0.0), power), 0.0)

    def radius(self, rng: Random, k: Array, dimension: int) -> Array:
        r"""$\sqrt{2k}$, for a filled shell times the radius of a uniform point of the ball."""
        size = np.sqrt(2 * np.maximum(k, 0.0))
        return size * elementary.power(rng.uniform(size=k.shape), 1 / dimension) if self.is_filled else size


def sample_leaf(leaf: Leaf, n_starts: int, *, seed: int, energy: float | None, energy_below: float | None) -> Array:
    """Random states on a leaf whose Hamiltonian is all moving, see `Leaf.moving`; see `Leaf.sample`."""
    n_starts, seed = as_count(n_starts, "n_starts"), as_seed(seed)
    check_memory(8 * n_starts * len(leaf.state), "n_starts")
    shell = _shell(energy, energy_below)
    if not leaf.rank:
        _check_point(leaf, shell)
        return np.tile(leaf.state, (n_starts, 1))
    _check_unimodular(leaf)
    if shell is not None:
        check_energy_in_reach(leaf, shell.energy, is_filled=shell.is_filled)
    top = _top_of(leaf)
    if top is None:
        return sample_by_chains(leaf, n_starts, seed, shell)
    draw = top_draw(leaf, top, shell)
    if draw is None:
        raise LeafError(infinite_volume(leaf, shell))
    return _independent(leaf, draw, n_starts, seed, shell)


def _independent(leaf: Leaf, draw: Draw, n: int, seed: int, shell: Shell | None) -> Array:
    """States by rejection, block by block; the first ones do not depend on n."""
    kept, count, block = [np.zeros((0, len(leaf.state)))], 0, 0
    while count < n:
        checkpoint("sampling a leaf")
        rng = stream(seed, Purpose.LEAF, block)
        kept.append(draw(rng, _PROPOSALS))
        count, block = count + len(kept[-1]), block + 1
        if block == _TRIAL_BLOCKS and count < _TRIAL_BLOCKS * _PROPOSALS / 50_000:
            return sample_by_chains(leaf, n, seed, shell)
    return np.concatenate(kept)[:n]


def acceptance(leaf: Leaf, *, energy: float | None = None, energy_below: float | None = None, seed: int = 0) -> float:
    """The fraction of proposals that the independent sampler of a top accepts, from 2^14 of them.

    Raises:
        LeafError: the leaf is not that of a top, or its volume is infinite.
    """
    top, shell = _top_of(leaf), _shell(energy, energy_below)
    draw = top_draw(leaf, top, shell) if top is not None and leaf.rank else None
    if draw is None:
        raise LeafError(f"a leaf of a top of finite volume was wanted; got {leaf!r}. Give an energy?")
    rng = stream(seed, Purpose.LEAF, 0)
    return len(draw(rng, _PROPOSALS)) / _PROPOSALS


def _top_of(leaf: Leaf) -> TopField | None:
    """The top, if the bracket is that of a top and H is its energy, not only the equations the same."""
    from sympy import expand

    system, top = leaf.system, leaf.system.top_parameters
    if top is None or not leaf.place.is_known:
        return None
    fields = tuple(system.bracket.fields.values())
    if not top.has_bracket(system.bracket):
        return None
    return top.field() if expand(system.hamiltonian - top.hamiltonian(*fields)) == 0 else None


def _check_unimodular(leaf: Leaf) -> None:
    bracket = leaf.system.bracket
    if not bracket.is_linear:
        J: Any = bracket.poisson_tensor()
        for j in range(bracket.dimension):
            divergence_of_column: Any = sum(J[i, j].diff(x) for i, x in enumerate(bracket.variables))
            if not is_zero(divergence_of_column):
                raise ParameterError(
                    "the bracket must be unimodular, sum_i dJ_ij/dx_i = 0, so that flows preserve volume; got "
                    f"{divergence_of_column!s:.60} for {bracket.coordinate_names_in_order[j]}. There is no invariant "
                    "density to sample from in these coordinates; start from states of your own."
                )
        return
    divergence: dict[int, float] = {}
    for i, j, m, c in leaf.system.bracket.entries():
        value = float(cast("Any", c))
        if m == i:
            divergence[j] = divergence.get(j, 0.0) + value
        if m == j:
            divergence[i] = divergence.get(i, 0.0) - value
    names = leaf.system.component_names
    if failing := [names[k] for k, value in sorted(divergence.items()) if abs(value) > 1e-12]:
        raise ParameterError(
            "the Lie algebra must be unimodular, so that flows preserve volume; got none such for "
            f"{', '.join(failing)}. There is no invariant density to sample from in these coordinates; start from "
            "states of your own."
        )


def _check_point(leaf: Leaf, shell: Shell | None) -> None:
    value = leaf.energy_range()[0]
    if shell is not None and (shell.energy < value or (shell.energy > value and not shell.is_filled)):
        raise LeafError(f"{leaf!r} is a point of energy {value:.6g}; {shell.energy:.6g} was asked for.")


def _shell(energy: float | None, energy_below: float | None) -> Shell | None:
    if energy is not None and energy_below is not None:
        raise ParameterError(f"give energy or energy_below, not both; got {energy} and {energy_below}.")
    value = energy if energy is not None else energy_below
    if value is None:
        return None
    return Shell(as_energy(value, "energy" if energy is not None else "energy_below"), is_filled=energy is None)
