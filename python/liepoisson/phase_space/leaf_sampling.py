r"""Random states on a leaf with the Liouville measure, of any energy, of one energy, or below one.

The Liouville measure of a leaf is $\delta(C - c)\,d^Nx$ up to a constant, and at energy E it is
$\delta(H - E)\,\delta(C - c)\,d^Nx$ (microcanonical), if the flow of every Hamiltonian preserves $d^Nx$:
$\mathrm{div}\,J\nabla H = \sum_{ij}\partial_i J_{ij}\,\partial_j H = 0$, that is, if the Lie algebra is unimodular.

Tops are sampled independently (`top_sampling`).  All others, and tops so close to their least energy that fewer than
one of 50 000 proposals would be accepted, by the Markov chain on a surface of [zappa2018].  Its states are correlated,
and where a leaf is thin in some direction (two fields almost parallel) 300 steps do not forget the start.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from liepoisson.arrays import Array
from liepoisson.errors import LeafError, ParameterError
from liepoisson.exact.phase_functions import PhaseFunction
from liepoisson.numeric._checks import as_count
from liepoisson.numeric.sampling import as_seed
from liepoisson.phase_space._checks import as_energy
from liepoisson.phase_space.leaf_projection import CONVERGED, Equations, solve
from liepoisson.phase_space.top_sampling import Draw, Shell, top_draw

if TYPE_CHECKING:
    from liepoisson.field import TopField
    from liepoisson.phase_space.leaf import Leaf

_INDEPENDENT, _CHAINS = 10, 11
"""First words of the spawn keys, apart from those of starts and tangent vectors."""

_PROPOSALS = 2**14
_TRIAL_BLOCKS = 16
N_CHAINS, BURN_IN, THINNING = 256, 300, 25
"""Chains side by side; steps of each before its first state, and from one kept state to the next."""


def sample_leaf(leaf: Leaf, n: int, *, seed: int, energy: float | None, energy_below: float | None) -> Array:
    """Random states on a leaf; see `Leaf.sample`."""
    n, seed = as_count(n, "n"), as_seed(seed)
    _check_memory(n, len(leaf.state))
    shell = _shell(energy, energy_below)
    if not leaf.rank:
        _check_point(leaf, shell)
        return np.tile(leaf.state, (n, 1))
    _check_unimodular(leaf)
    if shell is not None:
        _check_energy(leaf, shell)
    top = _top_of(leaf)
    if top is None:
        return _by_chains(leaf, n, seed, shell)
    draw = top_draw(leaf, top, shell)
    if draw is None:
        raise LeafError(_infinite(leaf))
    return _independent(leaf, draw, n, seed, shell)


def _independent(leaf: Leaf, draw: Draw, n: int, seed: int, shell: Shell | None) -> Array:
    """States by rejection, block by block; the first ones do not depend on n."""
    kept, count, block = [np.zeros((0, len(leaf.state)))], 0, 0
    while count < n:
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_INDEPENDENT, block)))
        kept.append(draw(rng, _PROPOSALS))
        count, block = count + len(kept[-1]), block + 1
        if block == _TRIAL_BLOCKS and count < _TRIAL_BLOCKS * _PROPOSALS / 50_000:
            return _by_chains(leaf, n, seed, shell)
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
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_INDEPENDENT, 0)))
    return len(draw(rng, _PROPOSALS)) / _PROPOSALS


@dataclass(frozen=True)
class _Chain:
    r"""A surface and a density on it, $1/\sqrt{\det G G^t}$ relative to the area, zero above an energy."""

    equations: Equations
    energy: PhaseFunction
    ceiling: float

    def log_density(self, x: Array) -> Array:
        rows = self.equations.rows(x)
        gram = np.linalg.slogdet(rows @ np.swapaxes(rows, -1, -2))[1]
        return np.where(self.energy(x) <= self.ceiling, -0.5 * gram, -np.inf)

    def step(self, rng: np.random.Generator, x: Array, density: Array, width: float) -> tuple[Array, Array, Array]:
        """One step of each chain: states, their densities, and which ones moved.

        Move along the tangent space, come back along the old normals, and check that the way back exists.
        """
        normals = self._normals(x)
        noise = width * rng.standard_normal(x.shape)
        there = noise - _along(normals, noise)
        y, found = self._return(x + there, normals)
        back = x - y
        new_normals = self._normals(y)
        back -= _along(new_normals, back)
        found &= np.linalg.norm(self._return(y + back, new_normals)[0] - x, axis=-1) <= 1e-8 * np.linalg.norm(
            x, axis=-1
        )
        target = self.log_density(y)
        forth_and_back = (np.sum(there**2, axis=-1) - np.sum(back**2, axis=-1)) / (2 * width**2)
        with np.errstate(invalid="ignore"):
            moved = found & (np.log(rng.uniform(size=len(x))) < target - density + forth_and_back)
        return np.where(moved[:, None], y, x), np.where(moved, target, density), moved

    def _normals(self, x: Array) -> Array:
        """Orthonormal bases of the normal spaces, as columns."""
        return np.linalg.qr(np.swapaxes(self.equations.rows(x), -1, -2))[0]

    def _return(self, start: Array, normals: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Newton's method from a point back to the surface, along given normals."""
        y = start.copy()
        for _ in range(12):
            values, rows = self.equations.relative(y)
            open_ones = np.abs(values).max(axis=-1) > 1e-15
            if np.mean(open_ones) < 0.05:  # the few that are left mostly have no solution
                break
            slopes = rows @ normals
            step, singular = _solved(slopes, values)
            step[singular] = 0.0
            y -= np.einsum("...ij,...j->...i", normals, step)
            lost = ~(np.abs(y) < 1e100)
            y[lost] = start[lost]
        return y, self.equations.residual(y) <= CONVERGED


def _by_chains(leaf: Leaf, n: int, seed: int, shell: Shell | None) -> Array:
    """Every 25th state of 256 chains after 300 steps, whose width is set in the first half of these."""
    chain, x = _chain_and_starts(leaf, seed, shell)
    streams = np.random.SeedSequence(seed, spawn_key=(_CHAINS,))
    rng = np.random.default_rng(streams)
    density, width = chain.log_density(x), 0.3 * float(np.linalg.norm(x, axis=-1).mean())
    for step in range(BURN_IN):
        x, density, moved = chain.step(rng, x, density, width)
        if step < BURN_IN // 2:  # towards half of the steps accepted, ever more slowly
            width *= float(np.exp((moved.mean() - 0.5) * 2 / np.sqrt(1 + step)))
    kept = [x]
    while len(kept) * N_CHAINS < n:
        for _ in range(THINNING):
            x, density, _ = chain.step(rng, x, density, width)
        kept.append(x)
    return np.concatenate(kept)[:n]


def _chain_and_starts(leaf: Leaf, seed: int, shell: Shell | None) -> tuple[_Chain, Array]:
    function = leaf.system.functions.energy
    filled = shell is None or shell.is_filled
    equations = leaf.constraints(None if filled or shell is None else shell.energy)
    ceiling = shell.energy if shell is not None and shell.is_filled else np.inf
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_CHAINS, 0)))
    boundary = leaf.constraints(shell.energy) if shell is not None else equations
    size = float(np.linalg.norm(solve(boundary, leaf.state[None])[0]))
    if _reaches_far(boundary, leaf.state, size, rng):
        raise LeafError(_infinite(leaf))
    spread = leaf.state + rng.standard_normal((4 * N_CHAINS, len(leaf.state))) * size * 0.5
    x, residual = solve(boundary, spread)
    x = x[residual <= CONVERGED]
    if ceiling < np.inf:
        inside, residual = solve(equations, x - 1e-3 * leaf.project_tangent(x, function.gradient(x)))
        x = inside[(residual <= CONVERGED) & (function(inside) <= ceiling)]
    if not len(x):
        raise LeafError(
            f"no state was found to start from on {leaf!r} with this energy. Take one further from its range."
        )
    return _Chain(equations, function, ceiling), x[np.arange(N_CHAINS) % len(x)]


def _reaches_far(equations: Equations, state: Array, size: float, rng: np.random.Generator) -> bool:
    """Whether Newton's method from states a thousand times as far ends a hundred times as far: not compact."""
    found, residual = solve(equations, state + rng.standard_normal((N_CHAINS, len(state))) * 1e3 * size)
    return bool(np.any(np.linalg.norm(found[residual <= CONVERGED], axis=-1) > 100 * size))


def _along(normals: Array, v: Array) -> Array:
    return np.einsum("...ij,...kj,...k->...i", normals, normals, v)


def _solved(matrices: Array, values: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Solutions of small systems, and which of the matrices are singular."""
    singular = ~(np.abs(np.linalg.det(matrices)) > 1e-200)
    safe = np.where(singular[:, None, None], np.eye(matrices.shape[-1]), matrices)
    return cast("Array", np.linalg.solve(safe, values[..., None])[..., 0]), singular


def _top_of(leaf: Leaf) -> TopField | None:
    """The top, if the bracket is that of a top and H is its energy, not only the equations the same."""
    from sympy import expand

    from liepoisson.exact.extensions import leibniz
    from liepoisson.exact.lie_algebras import so

    system, top = leaf.system, leaf.system.top_parameters
    if top is None or not leaf.place.is_known:
        return None
    fields = tuple(system.bracket.fields.values())
    if system.bracket.entries() != (so(3) @ leibniz(3, top.epsilon)).entries():
        return None
    return top.field() if expand(system.hamiltonian - top.hamiltonian(*fields)) == 0 else None


def _check_unimodular(leaf: Leaf) -> None:
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
            f"the Lie algebra must be unimodular, so that flows preserve volume; the flows of {', '.join(failing)} do "
            "not. There is no invariant density to sample from in these coordinates; start from states of your own."
        )


def _check_energy(leaf: Leaf, shell: Shell) -> None:
    lowest, highest = leaf.energy_range()
    slack = 1e-12 * (1 + abs(lowest)) if np.isfinite(lowest) else 0.0
    if shell.energy < lowest - slack or (not shell.is_filled and shell.energy > highest + slack):
        wanted = "of at most" if shell.is_filled else "of"
        raise LeafError(
            f"states {wanted} energy {shell.energy:.6g} were wanted; on {leaf!r} it lies between {lowest:.6g} and "
            f"{highest:.6g}."
        )


def _check_point(leaf: Leaf, shell: Shell | None) -> None:
    value = leaf.energy_range()[0]
    if shell is not None and (shell.energy < value or (shell.energy > value and not shell.is_filled)):
        raise LeafError(f"{leaf!r} is a point of energy {value:.6g}; {shell.energy:.6g} was asked for.")


def _infinite(leaf: Leaf) -> str:
    return (
        f"the set to sample on {leaf!r} is not bounded, so that its Liouville volume is infinite and no state is "
        "typical. Give energy= or energy_below=, if the energy bounds the set."
    )


def _shell(energy: float | None, energy_below: float | None) -> Shell | None:
    if energy is not None and energy_below is not None:
        raise ParameterError(f"give energy or energy_below, not both; got {energy} and {energy_below}.")
    value = energy if energy is not None else energy_below
    if value is None:
        return None
    return Shell(as_energy(value, "energy" if energy is not None else "energy_below"), is_filled=energy is None)


def _check_memory(n: int, n_components: int) -> None:
    try:
        np.empty((n, n_components))
    except (MemoryError, ValueError):  # numpy refuses sizes beyond the address space as a ValueError
        raise ParameterError(
            f"n: wanted a number of states that fits into memory; got {n}, {8 * n * n_components / 2**30:.3g} GiB; "
            "draw several samples, with one seed each"
        ) from None
