"""The largest Lyapunov exponent of each trajectory with its error, in runs that go on until the error is wanted."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.scalars import TIME_LIMIT, as_array, as_count, as_positive
from liepoisson.indicators.estimates import Estimate, Resampling
from liepoisson.indicators.mean_error import mean_error, mean_interval, n_longest_batches, student_quantile
from liepoisson.indicators.tangent_frames import Clock, TangentFrames, as_duration, n_intervals
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import shown
from liepoisson.io.result import labelled
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import Run, trajectories, typical
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, given_starts
from liepoisson.numeric.systems import HasField, with_momentum_of_time
from liepoisson.numeric.time_scale import natural_duration, orbit_units, zero_threshold
from liepoisson.portable import elementary

LONGEST, BLOCK, TRANSIENT = 100_000.0, 20.0, 100.0
"""Defaults for the longest run, if an error is wanted, the blocks and the transient: in natural times."""

_RATE = "inverse time, dimensionless"

# Fewer blocks give no autocorrelation worth the name.
_LEAST_BLOCKS = 64
# Blocks before the first look at an error that is wanted.  A run that stops when its error looks small stops too often
# where it happens to look small: for the twisted Kovalevskaya top and a wanted error of 0.01 the 95% intervals (normal)
# held the exponent in 53% to 75% of the runs with 64.  With 256, from four starts (48 copies each within 1e-9), normal
# intervals held the mean of runs to t = 20,000 in 92, 79, 83 and 75%, those of Student's t in 98, 85, 88 and 83%.
# Stopping only at 0.7 of the wanted error did not help: 96, 77, 88 and 83%, for runs 2 to 4 times as long.
_FIRST_LOOK = 256
# Rates that one call computes: a run may end by its time long before there are as many as would fill the memory.
_MOST_RATES = 2**23
# Runs are made longer by this factor until the error is small enough; an error falls by the root of it.
_LONGER = 1.5
# Halves of a run that differ by more of their combined errors than this are not one stationary orbit.
_HALVES = 3.0


@dataclass(frozen=True, kw_only=True, eq=False)
class ExponentEstimate(Run):
    r"""Largest Lyapunov exponents with errors.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> found = lp.lyapunov_exponent(system, [[0, 0.1, 0.3, 0], [0, -0.1, 0.5, 0]], t_end=2000)
        >>> found.is_zero.tolist(), found.exponent.round(2)
        ([True, False], array([0.  , 0.08]))

    Attributes:
        block: Length of the blocks of time.
        transient: Time before the first block.
        rates: Mean growth rate in each block, in inverse time, shape (trajectory, block); NaN after the end of a run.
        time: Averaging time of each trajectory, shape (trajectory,).
        time_scale: Natural unit of time T of each trajectory (`liepoisson.orbits.time_scale`), shape (trajectory,).
        exponent: Mean growth rate over all blocks, shape (trajectory,); NaN for a run that failed.
        error: Its standard error as an average over the time of this one orbit, from the autocorrelation of the blocks
            and from batches of them (`mean_error`), shape (trajectory,).
        is_zero: Whether the value is consistent with zero at time t, at most $3\ln(t/T)/t$ in size, as on a regular
            orbit.  It then falls with time: `error` is that of the average until t and of no limit, and there is no
            interval.
            This bounds nothing: a chaotic orbit that has stuck to an island until t looks the same.  `decide` is the
            rule for regular and chaotic.
        converged: Whether the run finished with an exponent: not `is_zero`, both halves agree within three of their
            combined errors, and the error is at most `wanted_error`, if one was wanted.  If none was, the error may be
            of any size, also as large as the exponent.
        wanted_error: What the runs were continued for, or None.
        t_end: Longest averaging time.
    """

    kind = "exponent"
    made_by = "lyapunov_exponent"

    seed: int
    first: int
    t_end: float
    block: float
    transient: float
    rates: Array = labelled("trajectory", "block", long_name="growth rate in each block", units=_RATE)
    time: Array = labelled("trajectory", long_name="averaging time")
    time_scale: Array = labelled("trajectory", long_name="natural unit of time of each orbit")
    exponent: Array = labelled("trajectory", long_name="mean growth rate", units=_RATE)
    error: Array = labelled("trajectory", long_name="its standard error, over the time of each orbit", units=_RATE)
    is_zero: NDArray[np.bool_] = labelled("trajectory", long_name="whether it is consistent with zero", units="1")
    converged: NDArray[np.bool_] = labelled("trajectory", long_name="whether the run converged", units="1")
    wanted_error: float | None
    end_state: Array = labelled("trajectory", "component", long_name="last good state")

    def arguments(self) -> dict[str, Any]:
        """What `lyapunov_exponent` was called with."""
        names = ("seed", "first", "t_end", "block", "transient", "wanted_error")
        return super().arguments() | {name: getattr(self, name) for name in names}

    @property
    def zero_below(self) -> Array:
        r"""The value up to which an exponent is consistent with zero, $3\ln(t/T)/t$, in inverse time, (trajectory,)."""
        return np.asarray(zero_threshold(self.time, self.time_scale))

    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the table by name: the fields of each trajectory, and `zero_below` before `is_zero`."""
        found = list(super().columns().items())
        k = [name for name, _ in found].index("is_zero")
        return dict([*found[:k], ("zero_below", self.zero_below), *found[k:]])

    def interval(self, confidence: float = 0.95) -> Array:
        r"""Confidence intervals, shape (trajectory, 2): value -+ q error; NaN where `is_zero`.

        q is the quantile of Student's t with one degree of freedom less than there are longest batches (7 to 14), as
        the error itself is known to no more.  They are wider than their name where the growth rates of the blocks are
        hardly correlated, those of 95% hold then 97% to 99%; and too narrow where an orbit sticks for as long as the
        run lasts (`liepoisson.indicators.mean_error` has the numbers).
        """
        probability = 0.5 + Resampling(confidence=confidence).confidence / 2
        n_blocks = np.round(self.time / self.block).astype(int)
        q = np.array([student_quantile(probability, max(1, n_longest_batches(n) - 1)) for n in n_blocks.tolist()])
        ends = np.stack([self.exponent - q * self.error, self.exponent + q * self.error], axis=1)
        return np.where(self.is_zero[:, None], np.nan, ends)

    @property
    def mean(self) -> Estimate:
        """Mean over the trajectories that have a value, with its standard error and Student's interval of 95%.

        The error is the spread over the starts over the root of their number (`mean_over_starts`), as in
        `Spectrum.mean`; of a single trajectory, the value with its own error over time.  Over random starts this mixes
        leaves, energies, regular and chaotic orbits; the error tells how well the mean of this mixture is known, not
        how well any orbit's exponent is.
        """
        known = np.isfinite(self.exponent)
        if known.sum() == 1:
            (k,) = np.flatnonzero(known)
            return Estimate(float(self.exponent[k]), float(self.error[k]), *map(float, self.interval()[k]))
        return mean_interval(self.exponent[known])

    def finite_time(self, duration: float) -> Array:
        """Exponents over consecutive windows of a duration, a whole number of blocks, shape (trajectory, window).

        NaN for windows that a run did not reach.  Their distribution narrows with the length; two humps mean that the
        orbit alternates between two regions, as one that sticks to an island does.

        Raises:
            ParameterError: the duration is shorter than a block, or longer than all runs.
        """
        n = round(as_duration(duration, "duration") / self.block)
        n_windows = self.rates.shape[1] // n if n else 0
        if n_windows == 0:
            raise ParameterError(
                f"duration: wanted a time from {self.block:g} to {self.block * self.rates.shape[1]:g}; got {duration:g}"
            )
        return self.rates[:, : n * n_windows].reshape(len(self.rates), n_windows, n).mean(axis=2)

    def quantiles(self, q: float | Sequence[float] | Array, *, duration: float | None = None) -> Array:
        """Quantiles of the exponents of all trajectories, or of those over windows of a duration.

        Raises:
            ParameterError: a q that is not between 0 and 1, or no trajectory has a value.
        """
        try:
            wanted = as_array(q, "q")
        except ShapeError:
            wanted = np.array(np.nan)
        if not ((wanted >= 0.0) & (wanted <= 1.0)).all():
            raise ParameterError(f"q: wanted numbers from 0 to 1; got {shown(q)}; try (0.05, 0.5, 0.95)")
        return np.quantile(self._known(duration), wanted)

    def histogram(self, bins: int = 40, *, duration: float | None = None) -> tuple[Array, Array]:
        """Probability densities (bin,) and edges (bin + 1,) of the same.

        Raises:
            ParameterError: `bins` is not from 1 to 1,000,000, or no trajectory has a value.
        """
        n_bins = as_count(bins, "bins", least=1, most=1_000_000, hint="try bins=40")
        return np.histogram(self._known(duration), bins=n_bins, density=True)

    def _known(self, duration: float | None) -> Array:
        """The exponents that are known, of whole runs or over windows of a duration, shape (value,)."""
        values = self.exponent if duration is None else self.finite_time(duration)
        values = values[np.isfinite(values)]
        if not len(values):
            raise ParameterError("wanted trajectories with a value; got none; see the outcomes, and take other starts")
        return values

    def __repr__(self) -> str:
        value = typical("exponent", self.exponent)
        n_zero = f", {int(self.is_zero.sum())} consistent with zero" if self.is_zero.any() else ""
        return (
            f"<ExponentEstimate of {self.system.name}: {trajectories(self.outcome)}, {value}{n_zero} over t = "
            f"{self.time.max(initial=0.0):g}>"
        )

    def __str__(self) -> str:
        lines: list[str] = []
        for k, outcome in enumerate(self.outcome):
            if not np.isfinite(self.exponent[k]):
                lines.append(f"{outcome} at once: no value")
                continue
            if self.is_zero[k]:
                threshold = f"below 3 ln(t/T) / t = {self.zero_below[k]:.1e}"
                lines.append(f"consistent with zero at t = {self.time[k]:g}: {threshold}  ({outcome})")
                continue
            value = str(Estimate(self.exponent[k], self.error[k], *self.interval()[k]))
            lines.append(f"{value}  (over t = {self.time[k]:g}, {outcome}, {self._agreement(k)})")
        return "\n".join(lines)

    def _agreement(self, k: int) -> str:
        """What speaks for the value of a trajectory: its halves, and its error if one was wanted."""
        rates = self.rates[k, np.isfinite(self.rates[k])]
        apart = _difference_of_halves(rates[None])[0]
        halves = "too short for halves"
        if math.isfinite(apart):
            first, second = (part.mean() for part in np.split(rates, [len(rates) // 2]))
            differ = "" if apart <= _HALVES else " differ"
            halves = f"halves {first:#.2g} and {second:#.2g}{differ}, {apart:.1f} of their errors apart"
        if self.wanted_error is None:
            return halves
        return f"{halves}, error {'' if self.error[k] <= self.wanted_error else 'not '}as wanted"


@shows_progress
def lyapunov_exponent(
    system: HasField,
    starts: StartsLike,
    *,
    wanted_error: float | None = None,
    t_end: float | None = None,
    block: float | None = None,
    transient: float | None = None,
    seed: int = 0,
    first: int = 0,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> ExponentEstimate:
    r"""Largest Lyapunov exponent of each trajectory, with a statistical error from the run itself.

    The growth rates of one tangent vector in blocks of time are averaged.  They are correlated: the error comes from
    their autocorrelation or from 8 to 15 batches of them, whichever is larger.  If an error is wanted, each run goes
    on from where it is, half as long again each time, until its error is that small and its halves agree, its
    value is consistent with zero and $3\ln(t/T)/t$ is that small, or `t_end` is reached.

    A value of at most $3\ln(t/T)/t$ in size is what a regular orbit shows, with T its `time_scale`; then `is_zero`
    holds, there is no interval, and `error` is that of the average so far and no bound of a limit: a sticky orbit may
    look regular for thousands of natural times. No error can tell of a region that the orbit has not visited yet, and
    the halves of one that has stuck to an island for most of the run agree. Of one that sticks in a part of the run
    they do, too, as their errors are wide: the text of the result has the values of both, `finite_time` those of
    shorter windows.

    Example:
        >>> system = lp.catalog.system("henon-heiles")
        >>> starts = [[0, 0.1, 0.3, 0], [0, -0.1, 0.5, 0]]  # energies 0.05 and 0.13
        >>> found = lp.lyapunov_exponent(system, starts, t_end=2000)
        >>> found.is_zero
        array([ True, False])
        >>> round(float(found.exponent[1]), 3), round(float(found.error[1]), 3)
        (0.077, 0.007)

    Args:
        wanted_error: Error at which a run stops, in inverse time.  Without one all runs last until `t_end`.
        t_end: (Longest) averaging time, positive; by default, if an error is wanted, some 100,000 natural times of the
            median orbit.
        block: Length of a block, positive, in which the vector must not grow by more than 1e308 ("not finite").
            Shorter ones do not change the estimate.  By default some 20 natural times of the fastest orbit, and at most
            `t_end`/128; give it if an ensemble that is computed in pieces is to be the same, bit for bit.
        transient: Time before averaging, in which the vector turns into its direction; by default some 100 natural
            times of the median orbit.
        seed: Draws the tangent vectors, those of `finite_time_exponents`.
        progress: Called a few times a second with the fraction of `t_end` that is done.

    Returns:
        ExponentEstimate; a trajectory that fails is an outcome in it, with the value up to there.

    Raises:
        ShapeError: `starts` has another shape.
        ParameterError: numbers out of range, neither `wanted_error` nor `t_end`, fewer than 64 blocks in `t_end`, or
            more than 10,000,000 in it or in `transient`.
        KeyboardInterrupt: Ctrl-C.

    References: [benettin1980]; for the error see `liepoisson.indicators.mean_error`.
    """
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first, system=system)
    if wanted_error is None and t_end is None:
        raise ParameterError("wanted t_end, wanted_error, or both; got neither; try wanted_error=0.01")
    starts = given_starts(system, starts)  # once, as several runs start from it
    units = orbit_units(system, starts, options)
    scale = units.time
    wanted, n_blocks, block = _as_plan(wanted_error, t_end, block, scale)
    if transient is None:
        transient = natural_duration(TRANSIENT, scale, otherwise=0.0)
    transient = as_duration(transient, "transient", zero=True)
    frames = TangentFrames(system, starts, options, units=units.of_frames(), n_vectors=1, at_equal_times=True)
    start = frames.state.copy()
    before = n_intervals(transient, block, names=("transient", "block"))
    clock = Clock(before + n_blocks, progress)
    clock.carry(frames, before, transient / max(1, before), per_row=max(1, before))
    # a list, as most runs stop long before the largest number of blocks
    done, n_done = [np.empty((len(start), 0))], 0
    stopped = np.zeros(len(start), dtype=np.bool_)
    goal = n_blocks if wanted is None else _FIRST_LOOK
    most = max(1, _MOST_RATES // max(1, len(start)))
    while n_done < n_blocks:
        if n_done == goal and wanted is not None:
            stopped |= _is_done(np.concatenate(done, axis=1), block, wanted, scale)
            goal = math.ceil(_LONGER * goal)
        if not frames.goes_on(~stopped).any():
            break
        n = min(goal - n_done, n_blocks - n_done, most)
        done.append(clock.carry(frames, n, block, only=~stopped).growth[:, :, 0] / block)
        n_done += n
    rates = np.concatenate(done, axis=1)
    found = _estimate(system, frames, rates, start, scale, block=block, transient=transient, wanted=wanted)
    return replace(found, t_end=block * n_blocks)


def _as_plan(
    wanted_error: float | None, t_end: float | None, block: float | None, scale: Array
) -> tuple[float | None, int, float]:
    """The wanted error, the largest number of blocks, and their length, which divides the longest time."""
    wanted = (
        None if wanted_error is None else as_positive(wanted_error, "wanted_error", "a positive number", example=0.01)
    )
    longest = as_duration(natural_duration(LONGEST, scale, otherwise=LONGEST) if t_end is None else t_end, "t_end")
    if block is None:
        most = longest / (2 * _LEAST_BLOCKS)
        block = min(natural_duration(BLOCK, scale, fastest=True, otherwise=most), most)
        if t_end is None:
            longest = block * math.ceil(longest / block)
    else:
        block = as_duration(block, "block")
    n_blocks = n_intervals(longest, block, names=("t_end", "block"))
    if n_blocks < _LEAST_BLOCKS:
        raise ParameterError(
            f"t_end: wanted at least {_LEAST_BLOCKS} blocks, as fewer give no error; got t_end={longest:g} with "
            f"block={block:g}; try block={longest / 100:g}"
        )
    return wanted, n_blocks, longest / n_blocks


def _is_done(rates: Array, block: float, wanted: float, scale: Array) -> NDArray[np.bool_]:
    """Whether runs may stop: error small enough and halves agree, or consistent with zero as closely as is wanted."""
    threshold = zero_threshold(block * rates.shape[1], scale)
    settled = (_difference_of_halves(rates) <= _HALVES) & (mean_error(rates) <= wanted)
    return np.where(np.abs(rates.mean(axis=1)) <= threshold, threshold <= wanted, settled)


def _estimate(
    system: HasField,
    frames: TangentFrames,
    done: Array,
    start: Array,
    scale: Array,
    *,
    block: float,
    transient: float,
    wanted: float | None,
) -> ExponentEstimate:
    n_done = np.isfinite(done).sum(axis=1)
    done = done[:, : int(n_done.max(initial=0))]
    value, error, halves = (np.full(len(done), np.nan) for _ in range(3))
    for length in np.unique(n_done[n_done > 0]):
        rows = n_done == length
        part = done[rows, :length]
        value[rows], error[rows] = part.mean(axis=1), mean_error(part)
        halves[rows] = _difference_of_halves(part)
    duration = n_done * block
    is_zero = np.abs(value) <= zero_threshold(duration, scale)
    converged = (frames.outcome == "finished") & (halves <= _HALVES) & ~is_zero
    if wanted is not None:
        converged &= error <= wanted
    return ExponentEstimate(
        **frames.options.given(system, start, frames.field),
        **frames.options.drawn,
        t_end=math.inf,
        block=block,
        transient=transient,
        rates=done,
        time=duration,
        time_scale=scale,
        exponent=value,
        error=error,
        is_zero=is_zero,
        converged=converged,
        wanted_error=wanted,
        outcome=frames.outcome,
        end_state=with_momentum_of_time(system, start, frames.state),
    )


def _difference_of_halves(rates: Array) -> Array:
    """Difference of the means of both halves over their combined error, shape (trajectory,)."""
    middle = rates.shape[1] // 2
    if middle < 4:
        return np.full(len(rates), np.inf)
    parts = rates[:, :middle], rates[:, middle:]
    error = elementary.hypot(*map(mean_error, parts))
    difference = np.abs(parts[0].mean(axis=1) - parts[1].mean(axis=1))
    return np.divide(difference, error, out=np.zeros_like(error), where=error > 0)
