"""The largest Lyapunov exponent along trajectories with noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_time
from liepoisson.indicators.estimates import Estimate
from liepoisson.indicators.mean_error import mean_error, mean_interval
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.io.result import labelled
from liepoisson.noise.noise import Noise, Noises, NoisyRun, steps_taken
from liepoisson.numeric.method.splitting import Splitting
from liepoisson.numeric.run import outcome_names, trajectories, typical
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.sampling import sample_tangents
from liepoisson.numeric.starts import StartsLike
from liepoisson.numeric.systems import HasBracket
from liepoisson.portable import elementary, linear

_RATE = "inverse time, dimensionless"
_RANK = 1e-10
"""Singular values of the Poisson tensor below this share of the largest are zero; those come out below 1e-15."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NoisyExponents(NoisyRun):
    """Largest Lyapunov exponents along trajectories with noise, on their leaves.

    Example:
        >>> spin, starts = lp.System(lp.so(3) @ lp.trivial(), "l3"), np.tile([0, 0, 1.0], (5, 1))
        >>> noise = {"noises": ["l1", "l2"], "method": lp.Splitting(0.05)}
        >>> run = lp.stochastic.noisy_exponents(spin, starts, t_end=5, n_blocks=10, **noise)
        >>> run.exponent.shape, run.rates.shape
        ((5,), (5, 10))

    Attributes:
        noises: The noise Hamiltonians.
        inverse_temperature: That of the law of Gibbs to which the damping leads, or 0.
        seed: Seed of the paths and of the tangent vectors.
        t_end: Averaging time.
        n_blocks: Blocks of time.
        rates: Growth rate of the tangent vector in each block, shape (trajectory, block).
        exponent: Mean growth rate, shape (trajectory,).
        error: Its standard error, from the blocks (`mean_error`), shape (trajectory,).
    """

    kind = "noisy exponents"
    made_by = "noisy_exponents"

    t_end: float
    n_blocks: int
    rates: Array = labelled("trajectory", "block", long_name="growth rate in each block", units=_RATE)
    exponent: Array = labelled("trajectory", long_name="mean growth rate", units=_RATE)
    error: Array = labelled("trajectory", long_name="its standard error over time", units=_RATE)
    end_state: Array = labelled("trajectory", "component", long_name="last good state")

    def arguments(self) -> dict[str, Any]:
        """What `noisy_exponents` was called with."""
        return super().arguments() | {"t_end": self.t_end, "n_blocks": self.n_blocks}

    @property
    def mean(self) -> Estimate:
        """Mean over the trajectories that finished, with its error from their spread: their paths are independent."""
        return mean_interval(self.exponent[np.isfinite(self.exponent)])

    def __repr__(self) -> str:
        value = typical("exponent", self.exponent)
        return f"<NoisyExponents of {self.system.name}: {trajectories(self.outcome)}, {value} over t = {self.t_end:g}>"


@shows_progress
def noisy_exponents(
    system: HasBracket,
    starts: StartsLike,
    *,
    noises: Noises,
    t_end: float,
    method: Splitting,
    n_blocks: int = 100,
    inverse_temperature: float = 0.0,
    seed: int = 0,
    first: int = 0,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> NoisyExponents:
    r"""Largest Lyapunov exponent along each trajectory of a system with noise, with its error.

    $\lambda = t^{-1}\ln(|v(t)|/|v(0)|)$ for one tangent vector, which is advanced by the derivative of the map that
    each step is on its path: the distance of two trajectories of one leaf on the same path, infinitely close.  After
    every block the vector is projected onto the leaf again, which the steps keep to round-off.  The first blocks, in
    which it turns into the direction of growth, are in the mean: a bias of the order of 1/t.

    Example:
        >>> spin, starts = lp.System(lp.so(3) @ lp.trivial(), "l3"), np.tile([1.0, 0, 0], (10, 1))
        >>> found = lp.stochastic.noisy_exponents(
        ...     spin, starts, noises=["l1", "l2", "l3"], inverse_temperature=2, t_end=100, method=lp.Splitting(0.02)
        ... )
        >>> print(found.mean)  # -coth 2 + 1/2 = -0.537: all trajectories on one path meet
        -0.527 ± 0.013

    Args:
        noises: The noise Hamiltonians, as for `noisy_orbits`.
        t_end: Averaging time, positive.
        method: `Splitting`, whose `step` is the largest one.
        n_blocks: Blocks of time, at least 4, from whose growth rates the error is estimated.
        inverse_temperature: That of the damping, as for `noisy_orbits`.
        seed: Draws the paths and the tangent vectors.

    Returns:
        NoisyExponents; a trajectory that fails is an outcome in it.

    Raises:
        ShapeError, ParameterError, UnsupportedFieldError: as for `noisy_orbits`; also a start whose leaf is a point.
        KeyboardInterrupt: Ctrl-C.

    References:
        Arnold, Random Dynamical Systems (1998).
    """
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first)
    noise = Noise.read(system, starts, noises, inverse_temperature, options)
    end, count = as_time(t_end, "t_end", example=100), as_count(n_blocks, "n_blocks", least=4, most=2**26)
    states, n = noise.start, noise.start.shape[1]
    vectors = _on_leaf(noise.system, states, sample_tangents(n, len(states), seed=options.seed, first=noise.first))
    finite = np.isfinite(states).all(axis=1)
    if (linear.norm(vectors[finite], axis=1) == 0).any():
        raise ParameterError("starts: wanted states whose leaves are no points; got one where the bracket vanishes")
    n_before = 0
    rates, outcome, present = np.full((len(states), count), np.nan), np.full(len(states), "finished", "U15"), states
    for block in range(count):
        with np.errstate(all="ignore"):
            vectors = vectors / linear.norm(vectors, axis=1)[:, None]
        raw = noise.orbits(
            np.array([0.0, end / count]),
            start=present,
            tangents=vectors,
            n_before=n_before,
            done=block / count,
            share=1.0 / count,
        )
        n_before += steps_taken(raw)
        going = outcome == "finished"
        outcome[going] = outcome_names(raw["outcome"])[going]
        present = raw["final_state"]
        vectors = _on_leaf(noise.system, present, raw["tangent"].reshape(len(states), 2, n)[:, 1])
        good = outcome == "finished"
        if not good.any():
            break
        rates[good, block] = elementary.log(linear.norm(vectors[good], axis=1)) * (count / end)
    return NoisyExponents(
        **noise.given(),
        t_end=end,
        n_blocks=count,
        rates=rates,
        exponent=rates.mean(axis=1),
        error=mean_error(rates),
        outcome=outcome,
        end_state=present,
    )


def _on_leaf(system: Any, states: Array, vectors: Array) -> Array:
    """Vectors without what is across the leaf: projected onto the image of the Poisson tensor."""
    finite = np.isfinite(states).all(axis=1) & np.isfinite(vectors).all(axis=1)
    projected = np.full_like(vectors, np.nan)
    if finite.any():
        frames, sizes, _ = linear.svd(system.functions.poisson_tensor(states[finite]))
        along = linear.einsum("kia,ki->ka", frames, vectors[finite]) * (sizes > _RANK * sizes[:, :1])
        projected[finite] = linear.einsum("kia,ka->ki", frames, along)
    return projected
