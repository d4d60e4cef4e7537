"""The law that trajectories with noise come to, as a histogram."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_count, as_positive, as_time
from liepoisson.indicators.mean_error import mean_over_starts
from liepoisson.inputs.arrays import Array, check_shape
from liepoisson.inputs.calls import shows_progress
from liepoisson.io.result import labelled
from liepoisson.noise.noise import Noise, Noises, NoisyRun, steps_taken
from liepoisson.numeric.method.splitting import Splitting
from liepoisson.numeric.run import outcome_names, trajectories
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_values
from liepoisson.numeric.systems import HasBracket


@dataclass(frozen=True, kw_only=True, eq=False)
class StationaryLaw(NoisyRun):
    """A histogram of a function along trajectories with noise.

    Example:
        >>> spin, starts = lp.System(lp.so(3) @ lp.trivial(), "l3"), np.tile([0, 0, 1.0], (5, 1))
        >>> noise = {"noises": ["l1", "l2"], "method": lp.Splitting(0.05)}
        >>> run = lp.stochastic.stationary_law(spin, starts, "l3", edges=[-1, 0, 1], t_end=5, n_samples=10, **noise)
        >>> run.fraction.sum(axis=1).round(12).tolist()  # l3 = 1 at the start is in the last bin
        [1.0, 1.0, 1.0, 1.0, 1.0]

    Attributes:
        noises: The noise Hamiltonians.
        inverse_temperature: That of the law of Gibbs to which the damping leads, or 0.
        seed: Seed of the paths.
        function: The function.
        t_end: Length of the runs.
        transient: Time before the first sample.
        n_samples: Samples of each trajectory.
        edges: Edges of the bins, shape (edge,).
        fraction: Share of the samples of each trajectory in each bin, shape (trajectory, bin); NaN for one that failed.
    """

    kind = "stationary law"
    made_by = "stationary_law"

    function: str
    t_end: float
    transient: float
    n_samples: int
    edges: Array = labelled("edge", long_name="edges of the bins")
    fraction: Array = labelled("trajectory", "bin", long_name="share of the samples in each bin", units="1")

    def arguments(self) -> dict[str, Any]:
        """What `stationary_law` was called with."""
        names = ("function", "t_end", "transient", "n_samples", "edges")
        return super().arguments() | {name: getattr(self, name) for name in names}

    @property
    def density(self) -> Array:
        """Probability density in each bin, shape (bin,): the mean over the trajectories that finished."""
        return self._estimates()[0]

    @property
    def error(self) -> Array:
        """Its standard error, from the spread of the trajectories, shape (bin,); NaN with fewer than two."""
        return self._estimates()[1]

    def _estimates(self) -> tuple[Array, Array]:
        known = self.fraction[np.isfinite(self.fraction).all(axis=1)]
        mean, error = mean_over_starts(known, np.full_like(known, np.nan))
        widths = np.diff(self.edges)
        return mean / widths, error / widths

    def __repr__(self) -> str:
        bins = f"{len(self.edges) - 1} bins"
        count = f"{trajectories(self.outcome)} of {self.n_samples} samples"
        return f"<StationaryLaw of {self.function} of {self.system.name}: {count}, {bins}>"


@shows_progress
def stationary_law(
    system: HasBracket,
    starts: StartsLike,
    function: str,
    *,
    edges: ArrayLike,
    noises: Noises,
    t_end: float,
    method: Splitting,
    transient: float = 0.0,
    n_samples: int = 1000,
    inverse_temperature: float = 0.0,
    seed: int = 0,
    first: int = 0,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> StationaryLaw:
    """A histogram of a function along trajectories of a system with noise.

    The trajectories, those of `noisy_orbits`, are sampled at equal times after a transient.  Samples of one trajectory
    are correlated, those of different ones are not: the error is from the spread of the trajectories.  Nothing here
    tells whether the transient was long enough; the law has an error of the second order in the step besides.

    Example:
        >>> top, starts = lp.catalog.euler_top_on("so(3)", [1, 2, 3]), np.tile([1.0, 0, 0], (100, 1))
        >>> law = lp.stochastic.stationary_law(
        ...     top, starts, "l3", edges=[-1, 0, 1], noises=["l1", "l2"], transient=10, t_end=50,
        ...     n_samples=100, method=lp.Splitting(step=0.02)
        ... )
        >>> law.density.round(1)  # uniform on the sphere, hence in l3
        array([0.5, 0.5])

    Args:
        function: A function on phase space.
        edges: Edges of the bins, increasing, shape (edge,).
        noises: The noise Hamiltonians, as for `noisy_orbits`.
        t_end: Length of the runs, positive.
        method: `Splitting`, whose `step` is the largest one.
        transient: Time before the first sample, below `t_end`.
        n_samples: Samples of each trajectory, at equal times from after the transient to `t_end`.
        inverse_temperature: That of the damping, as for `noisy_orbits`.
        seed: Draws the paths.

    Returns:
        StationaryLaw; a trajectory that fails is an outcome in it.

    Raises:
        ShapeError, ParameterError, UnsupportedFieldError: as for `noisy_orbits`.
        KeyboardInterrupt: Ctrl-C.
    """
    bins, end = _as_edges(edges), as_time(t_end, "t_end", example=100)
    before = as_positive(transient, "transient", f"a time from 0 to below {end:g}", example=end / 2, zero=True)
    if before >= end:
        raise ParameterError(f"transient: wanted a time from 0 to below {end:g}; got {before:g}; try {end / 2:g}")
    count = as_count(n_samples, "n_samples", least=1, most=2**26)
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first)
    noise = Noise.read(system, starts, noises, inverse_temperature, options)
    value: Any = noise.system.functions.of(function)
    start, outcome, n_before = noise.start, np.full(len(noise.start), "finished", dtype="U15"), 0
    if before:
        raw = noise.orbits(np.array([0.0, before]), share=before / end)
        start, outcome, n_before = raw["final_state"], outcome_names(raw["outcome"]), steps_taken(raw)
    counts = np.zeros((len(start), len(bins) - 1))
    for _, _, raw in noise.in_parts(start, before, (end - before) / count, count, n_before=n_before):
        with np.errstate(all="ignore"):
            sample = np.asarray(value(raw["state"][:, 1:]))
        ended = outcome_names(raw["outcome"])
        outcome = np.where(outcome == "finished", ended, outcome)
        for k in np.flatnonzero(outcome == "finished"):
            counts[k] += np.histogram(sample[k], bins=bins)[0]
        if (outcome != "finished").all():
            break
    counts[outcome != "finished"] = np.nan
    return StationaryLaw(
        **noise.given(),
        function=str(function),
        t_end=end,
        transient=before,
        n_samples=count,
        edges=bins,
        fraction=counts / count,
        outcome=outcome,
    )


def _as_edges(edges: ArrayLike) -> Array:
    """A copy of the edges of bins: finite increasing numbers, two or more.

    Raises:
        ShapeError, ParameterError: they are none.
    """
    bins = np.atleast_1d(as_values(edges, "edges"))
    check_shape(bins.ndim == 1 and len(bins) >= 2, "edges", "(edge,) with 2 or more edges", bins)
    if not np.isfinite(bins).all() or not (np.diff(bins) > 0).all():
        raise ParameterError(
            f"edges: wanted finite increasing numbers; got {np.array2string(bins, threshold=6)}; sort them and drop "
            "repeated ones"
        )
    return bins
