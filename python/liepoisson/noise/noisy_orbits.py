"""Trajectories of a system with noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_time
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.io.result import labelled
from liepoisson.noise.noise import Noise, Noises, NoisyRun, as_increments
from liepoisson.numeric.method.splitting import Splitting
from liepoisson.numeric.run import IntegratedRun, KeepsInvariants, outcome_names, trajectories
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, as_times
from liepoisson.numeric.systems import HasBracket

_N_TIMES = 1001
"""Times of a run of which only the end is given."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NoisyOrbits(NoisyRun, IntegratedRun, KeepsInvariants):
    """Trajectories of a system with noise, each on its own path.

    `drift` has the largest changes of the Hamiltonian, which noise moves, and of the Casimirs, which it does not.

    Example:
        >>> top = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> method = lp.Splitting(step=0.01)
        >>> run = lp.stochastic.noisy_orbits(top, [1, 0, 0], noises=["l1/2", "l2/2"], t_end=10, method=method)
        >>> run
        <NoisyOrbits of Euler top on so(3): 1 trajectory, 1001 times, t = 0 to 10>

    Attributes:
        noises: The noise Hamiltonians.
        inverse_temperature: That of the law of Gibbs to which the damping leads, or 0.
        seed: Seed of the paths.
        increments: Increments of the path in each step.
        time: Times, shape (time,).
        state: States, shape (trajectory, time, component); NaN from where a trajectory failed.
    """

    kind = "noisy orbits"
    made_by = "noisy_orbits"
    rows = ("trajectory", "time")

    increments: int
    time: Array = labelled("time", long_name="time", is_coordinate=True)
    state: Array = labelled("trajectory", "time", "component", long_name="state")

    def arguments(self) -> dict[str, Any]:
        """What `noisy_orbits` was called with."""
        return super().arguments() | {"times": self.time, "increments": self.increments}

    def __repr__(self) -> str:
        span = f"t = {self.time[0]:g} to {self.time[-1]:g}"
        return f"<NoisyOrbits of {self.system.name}: {trajectories(self.outcome)}, {len(self.time)} times, {span}>"


@shows_progress
def noisy_orbits(
    system: HasBracket,
    starts: StartsLike,
    *,
    noises: Noises,
    method: Splitting,
    inverse_temperature: float = 0.0,
    times: ArrayLike | None = None,
    t_end: float | None = None,
    increments: int = 1,
    seed: int = 0,
    first: int = 0,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> NoisyOrbits:
    r"""Trajectories of $dx = \{x,H\}\,dt + \sum_k\{x,H_k\}\circ dW_k$, on request damped along the noise.

    The $W_k$ are independent Brownian motions, the integrals those of Stratonovich.  A step of length h is Strang's
    composition of exact flows around a step of `method`: the flows of the $H_k$ for the increments over its first half,
    the step of H, and in reverse order the flows for those over its second half.  So each step is a Poisson map, and
    Casimirs are kept to round-off on every path.  The weak order is 2; the strong order is 1 for one noise, or several
    that commute, and else 1/2.  Without noise the orbits are those of `integrate` with the same method, bit for bit.

    With an inverse temperature $\beta$ there is a damping along the noise,

    $$dx = \{x,H\}\,dt - \tfrac\beta2\sum_k\{H,H_k\}\{x,H_k\}\,dt + \sum_k\{x,H_k\}\circ dW_k ,$$

    for which $e^{-\beta H}$ is stationary with respect to Liouville's measure on each leaf.  It is the flow of $H_k$
    for a time that depends on the state, found by the midpoint rule: it stays on the leaf, too.  Steps must be short
    beside the times in which it relaxes: $h\frac\beta2\sum_k|\{\{H,H_k\},H_k\}| \le \frac12$.

    Example:
        >>> top = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> noises = ["l1/2", "l2/2", "l3/2"]
        >>> run = lp.stochastic.noisy_orbits(top, [1, 0, 0], noises=noises, t_end=100, method=lp.Splitting(step=0.01))
        >>> bool(run.drift["C1"].max() < 1e-12), bool(run.drift["H"].max() > 0.1)
        (True, True)

    Args:
        noises: The noise Hamiltonians $H_k$, with their strengths: a text like that of a Hamiltonian, a SymPy
            expression, or a sequence of such.  Each is a function of one linear form, $F(\xi\cdot x)$ with a polynomial
            F, or a sum of such functions whose forms commute: these flow exactly.  An empty sequence is no noise, and
            "0" a noise of the amplitude 0.
        method: `Splitting`, whose `step` is the largest one.
        inverse_temperature: $\beta$, at least 0; 0 is no damping.
        times: Times at which states are wanted, increasing, shape (time,), the first that of the starts.
        t_end: Instead, the end of a run from 0, with 1,001 evenly spaced times.
        increments: How many increments of the path a step adds up: runs with steps m times as long, of m increments
            each, follow the same paths, if all steps are equal.
        seed: Draws the paths.  Trajectory k has the same path whatever the number of trajectories and threads.

    Returns:
        NoisyOrbits; a trajectory that fails is an outcome in it, not an error: "not finite" where an increment turns
        the state further than the flow of a piece can follow (a generator times the increment beyond 4096), "step too
        large" where the damping needs a shorter one: beyond the bound above the law could be wider than that of
        Gibbs by a tenth.

    Raises:
        ShapeError: An array has another shape than stated.
        ParameterError: Numbers that are not finite, times that do not increase, another method, a noise that is a
            function of Casimirs, or a vector field instead of a function.
        UnsupportedFieldError: The bracket is not linear in the state, or a noise has no exact flow.
        KeyboardInterrupt: Ctrl-C.

    References:
        Lázaro-Camí and Ortega, Rep. Math. Phys. 61 (2008) 65; Arnaudon, De Castro and Holm, J. Nonlinear Sci. 28 (2018)
        91; Strang (1968); Salmon, Moraes, Dror and Shaw (2011), for the random numbers.
    """
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first)
    noise = Noise.read(system, starts, noises, inverse_temperature, options)
    at, n_increments = _as_times(times, t_end), as_increments(increments)
    raw = noise.orbits(at, n_increments=n_increments)
    return NoisyOrbits(
        **noise.given(),
        increments=n_increments,
        time=at,
        state=raw["state"],
        outcome=outcome_names(raw["outcome"]),
        end_time=raw["end_time"],
        n_steps=raw["n_steps"],
        end_state=raw["final_state"],
        order=raw["order"],
        kernel=raw["kernel"],
    )


def _as_times(times: ArrayLike | None, t_end: float | None) -> Array:
    if (times is None) == (t_end is None):
        raise ParameterError("times: wanted times or t_end; got both or neither; try t_end=100")
    if times is None:
        return np.linspace(0.0, as_time(t_end, "t_end", example=100), _N_TIMES)
    at = as_times(times, "times", least=2)
    if at[1] < at[0]:
        raise ParameterError(
            f"times: wanted increasing times, since a path has a direction; got {at[0]:g} to {at[-1]:g}; reverse them"
        )
    return at
