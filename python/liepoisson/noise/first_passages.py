"""When trajectories with noise first reach a surface."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_time
from liepoisson.indicators.estimates import Estimate
from liepoisson.indicators.mean_error import mean_interval
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import counted, shown
from liepoisson.io.result import labelled
from liepoisson.noise.noise import Noise, Noises, NoisyRun
from liepoisson.numeric.method.splitting import Splitting
from liepoisson.numeric.run import outcome_names, typical
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike
from liepoisson.numeric.systems import HasBracket
from liepoisson.poincare.section_arguments import as_formula, check_that_it_varies


@dataclass(frozen=True, kw_only=True, eq=False)
class FirstPassages(NoisyRun):
    r"""Times at which trajectories were first seen on the other side of a surface, at ends of steps.

    Example:
        >>> spin, starts = lp.System(lp.so(3) @ lp.trivial(), "l3"), np.tile([0, 0, 1.0], (5, 1))
        >>> noise = {"noises": ["l1", "l2"], "method": lp.Splitting(0.05)}
        >>> run = lp.stochastic.first_passages(spin, starts, function="l3", t_end=50, **noise)
        >>> bool(run.passed.all()), bool((run.coarse_time >= run.time).all())
        (True, True)

    Attributes:
        noises: The noise Hamiltonians.
        inverse_temperature: That of the law of Gibbs to which the damping leads, or 0.
        seed: Seed of the paths.
        function: The function that is zero on the surface.
        t_end: Longest time.
        time: End of the first step after which the function has the other sign, shape (trajectory,); NaN for a
            trajectory that did not pass until `t_end`.
        coarse_time: The same if only every second step of the same trajectory is looked at.
        n_steps: Accepted steps until `end_state`, shape (trajectory,).
        end_state: The state at that time, or the last one, shape (trajectory, component).
    """

    kind = "first passages"
    made_by = "first_passages"

    function: str
    t_end: float
    time: Array = labelled("trajectory", long_name="time of the first passage")
    coarse_time: Array = labelled("trajectory", long_name="time of the first passage seen at every second step")
    n_steps: NDArray[np.int64] = labelled("trajectory", long_name="accepted steps to the end state", units="1")
    end_state: Array = labelled("trajectory", "component", long_name="state after the passage")

    def arguments(self) -> dict[str, Any]:
        """What `first_passages` was called with."""
        return super().arguments() | {"function": self.function, "t_end": self.t_end}

    @property
    def passed(self) -> NDArray[np.bool_]:
        """Which trajectories passed, shape (trajectory,)."""
        return np.isfinite(self.time)

    @property
    def mean(self) -> Estimate:
        """Mean over the trajectories that passed, with its statistical error.

        If some did not, it is a mean under the condition that the passage is before `t_end`.
        """
        return mean_interval(self.time[self.passed])

    @property
    def step_bias(self) -> Estimate:
        r"""How much too late the mean is since passages between ends of steps are not seen, with its error.

        Such a delay falls like the root of the step (Broadie, Glasserman and Kou), so it is estimated by the delay with
        every second step alone, $(T_{2h} - T_h)/(\sqrt2 - 1)$, over the trajectories that pass in both.  The
        displacement of the trajectories themselves, of the order of the step, is not in it.
        """
        both = self.passed & np.isfinite(self.coarse_time)
        return mean_interval((self.coarse_time[both] - self.time[both]) / (math.sqrt(2.0) - 1.0))

    def __repr__(self) -> str:
        count = counted(len(self.time), "trajectory", "trajectories")
        return (
            f"<FirstPassages of {self.system.name}: {int(self.passed.sum())} of {count} passed until t = "
            f"{self.t_end:g}, {typical('time', self.time)}>"
        )


@shows_progress
def first_passages(
    system: HasBracket,
    starts: StartsLike,
    *,
    function: str,
    noises: Noises,
    t_end: float,
    method: Splitting,
    inverse_temperature: float = 0.0,
    seed: int = 0,
    first: int = 0,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> FirstPassages:
    """When trajectories of a system with noise first pass a surface.

    The trajectories are those of `noisy_orbits`, with equal steps.  The sign of the function is looked at after every
    step: a passage and return within one step is not seen, so times are too late on average, by an amount that falls
    like the root of the step; `step_bias` of the result estimates it from the same trajectories.

    Example:
        >>> top, start = lp.catalog.euler_top_on("so(3)", [1, 1, 1]), np.tile([0, 0, 1.0], (200, 1))
        >>> found = lp.stochastic.first_passages(
        ...     top, start, function="l3", noises=["l1", "l2"], t_end=50, method=lp.Splitting(step=0.01)
        ... )
        >>> found  # a Brownian motion on the sphere, from the pole to the equator: 2 ln 2 = 1.39 on average
        <FirstPassages of Euler top on so(3): 200 of 200 trajectories passed until t = 50, median time 1.185>

    Args:
        function: A function on phase space that is zero on the surface, and at no start.
        noises: The noise Hamiltonians, as for `noisy_orbits`.
        t_end: Longest time, positive.
        method: `Splitting`, whose `step` is the largest one.
        inverse_temperature: That of the damping, as for `noisy_orbits`.
        seed: Draws the paths.

    Returns:
        FirstPassages; a trajectory that has not passed at `t_end` has the outcome "finished" and no time.

    Raises:
        ShapeError, ParameterError, UnsupportedFieldError: as for `noisy_orbits`; also a start on the surface, or a
            function that is constant along every path or no real number at a start.
        KeyboardInterrupt: Ctrl-C.

    References:
        Broadie, Glasserman and Kou, Math. Finance 7 (1997) 325, for the root of the step.
    """
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first)
    noise = Noise.read(system, starts, noises, inverse_temperature, options)
    value: Any = noise.system.functions.of(function)
    check_that_it_varies(noise.system, as_formula(function, "function"), "function", noises=noise.texts)
    end = as_time(t_end, "t_end", example=100)
    states = noise.start
    with np.errstate(all="ignore"):
        side = np.sign(np.asarray(value(states)))
    known = side[np.isfinite(states).all(axis=1)]
    if (known == 0).any():
        raise ParameterError("function: wanted one that is not zero at the starts; got a start on it; move it off")
    if np.isnan(known).any():
        raise ParameterError(
            f"function: wanted one that is a real number at the starts; {shown(str(function))} is none at start "
            f"{int(np.flatnonzero(np.isnan(side) & np.isfinite(states).all(axis=1))[0])}; move it"
        )
    n_steps = max(1, math.ceil(end / method.step * (1.0 - 2 * np.finfo(float).eps)))
    time, coarse = np.full(len(states), np.nan), np.full(len(states), np.nan)
    outcome, last = np.full(len(states), "finished", dtype="U15"), states.copy()
    taken = np.zeros(len(states), dtype=np.int64)
    for before, at, raw in noise.in_parts(states, 0.0, end / n_steps, n_steps):
        seen = raw["state"][:, 1:]
        with np.errstate(all="ignore"):
            beyond = np.asarray(value(seen)) * side[:, None] <= 0
        was_going = outcome == "finished"
        for found, every in ((time, 1), (coarse, 2)):
            looked = beyond & (np.arange(before + 1, before + 1 + len(at)) % every == 0)
            new = looked.any(axis=1) & np.isnan(found) & was_going
            where = looked.argmax(axis=1)
            found[new] = at[where[new]]
            if every == 1:
                last[new], taken[new] = seen[new, where[new]], before + 1 + where[new]
        still = np.isnan(time) & was_going
        last[still] = raw["final_state"][still]
        taken[still] += raw["n_steps"][still]
        ended = outcome_names(raw["outcome"])
        outcome[still] = ended[still]
        if not (np.isnan(coarse) & (ended == "finished")).any():
            break
    return FirstPassages(
        **noise.given(),
        function=str(function),
        t_end=end,
        time=time,
        coarse_time=coarse,
        n_steps=taken,
        outcome=outcome,
        end_state=last,
    )
