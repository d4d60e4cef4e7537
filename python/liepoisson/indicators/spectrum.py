"""The Lyapunov spectrum along each trajectory, with error bars and the check that its structure allows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson.formula.scalars import TIME_LIMIT
from liepoisson.indicators.covariant_vectors import CovariantRecord, CovariantVectors
from liepoisson.indicators.mean_divergence import mean_divergence
from liepoisson.indicators.mean_error import mean_error, mean_over_starts
from liepoisson.indicators.structural_zeros import (
    PoissonStructure,
    SpectrumResiduals,
    check_lines,
    poisson_structure,
    spectrum_residuals,
)
from liepoisson.indicators.tangent_frames import Clock, TangentFrames, as_duration, n_intervals
from liepoisson.inputs.arrays import Array, check_shape, read_only
from liepoisson.inputs.calls import shows_progress
from liepoisson.inputs.refusals import check_kind
from liepoisson.io.result import labelled, part
from liepoisson.numeric.methods import MethodChoice
from liepoisson.numeric.run import IntegratedRun, trajectories, whole
from liepoisson.numeric.run_options import RunOptions
from liepoisson.numeric.starts import StartsLike, given_starts
from liepoisson.numeric.systems import HasField, with_momentum_of_time
from liepoisson.numeric.time_scale import natural_duration, orbit_units

INVERSE_TIME = "inverse time, dimensionless"
INTERVAL = 5.0
"""Default time between orthonormalisations, in natural times of the fastest orbit."""

N_TIMES = 256
"""Most output times; the intervals between them are the shortest batches of the errors."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Spectrum(IntegratedRun):
    r"""Lyapunov spectra with their errors.  The arrays are read-only; `.copy()` gives one that can be changed.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> spectrum = lp.lyapunov_spectrum(top, lp.sample_states(top, 1, seed=1), t_end=1000)
        >>> spectrum.end_exponent[0, [0, 1, -2, -1]].round(2)  # in pairs
        array([ 0.13,  0.04, -0.04, -0.13])

    Attributes:
        seed: Seed of the tangent frames.
        interval: Longest time between orthonormalisations, as given; a whole number of equal ones makes up each output
            interval.
        transient: Time before the averages begin.
        t_end: For how long they are taken.
        time: Averaging times, evenly spaced, shape (time,); they count from the end of the transient.
        exponent: Running values $t^{-1}\sum\ln R_{kk}$ in inverse time, shape (trajectory, time, k); NaN from where a
            trajectory failed, and of exponents that round-off hides (see `largest_ratio`).
        time_scale: Natural unit of time T of each trajectory (`liepoisson.orbits.time_scale`), shape (trajectory,).
        error: Standard error of each last value as an average over the time of this one orbit (see `mean_error`), shape
            (trajectory, k); NaN where the exponent is.  It is no error over starts: that is in `mean`.  It does
            not contain the bias of order $\ln(t/T)/t$ that all finite-time exponents have, and it is too small while t
            is below some twenty times the time for which orbits stick to islands.  Measured for the twisted
            Kovalevskaya top: at t = 1,000 the spread over copies within 1e-9 of four starts is 1.1 to 2.0 of it, and
            the intervals of 95% hold the mean in 65% to 90%; from t = 4,000 to 10,000 on in 83% to 94%.
        structure: What the bracket says about zeros and pairs, or None for a system without a Poisson tensor.
        largest_ratio: Largest ratio of two stretchings within one interval of the averages, shape (trajectory,).  The
            smallest stretching there has a relative error of some 2e-16 times this: choose a shorter interval above
            1e8.  Where an exponent's own ratio exceeds 4.5e14, a tenth and more of its stretching is round-off, and
            it is NaN.
        end_time: Time that each trajectory reached, shape (trajectory,), the transient included.
        covariant: The covariant Lyapunov vectors, if they were asked for.
    """

    kind = "spectrum"
    made_by = "lyapunov_spectrum"

    seed: int
    first: int
    interval: float
    transient: float
    t_end: float
    time: Array = labelled("time", long_name="time", is_coordinate=True)
    time_scale: Array = labelled("trajectory", long_name="natural unit of time of each orbit")
    exponent: Array = labelled(
        "trajectory", "time", "k", long_name="finite-time Lyapunov exponents", units=INVERSE_TIME
    )
    error: Array = labelled(
        "trajectory",
        "k",
        long_name="standard error at the last time, over the time of each orbit",
        units=INVERSE_TIME,
    )
    structure: PoissonStructure | None = part(lambda: PoissonStructure)
    largest_ratio: Array = labelled(
        "trajectory", long_name="largest ratio of stretchings within one interval", units="1"
    )
    covariant: CovariantVectors | None = part(lambda: CovariantVectors, "covariant_", default=None)

    def arguments(self) -> dict[str, Any]:
        """What `lyapunov_spectrum` was called with; zeros and pairs are those that were found."""
        own = {name: getattr(self, name) for name in ("seed", "first", "interval", "transient", "structure")}
        return (
            super().arguments()
            | own
            | {
                "t_end": whole(self.time, self.t_end),
                "n_exponents": self.exponent.shape[2],
                "covariant": self.covariant is not None,
            }
        )

    @property
    def end_exponent(self) -> Array:
        """The exponents at the last time, shape (trajectory, k); NaN where a trajectory failed.

        In the order of the frame: decreasing, but for zeros and others that differ by less than their errors.
        """
        return self.exponent[:, -1]

    @property
    def mean(self) -> tuple[Array, Array]:
        """Mean spectrum of the trajectories that finished, and its standard error, both shape (k,); NaN where none did.

        The error is the spread over the starts over the root of their number (`mean_over_starts`): that of the mean as
        an estimate for all starts like these.  It contains the errors over time, which are part of the spread.  Of a
        single trajectory it is the error over the time of this orbit.
        """
        finished = self.outcome == "finished"
        return mean_over_starts(self.end_exponent[finished], self.error[finished])

    @cached_property
    def mean_divergence(self) -> Array:
        r"""The mean of $\mathrm{div} f$ along each orbit, to which all exponents add up, shape (trajectory,).

        It is computed when it is first asked for, along the orbit without tangent vectors: of a chaotic orbit the sum
        is met up to the fluctuations of such means. NaN where a trajectory failed, or the equations are not known or
        depend on time.
        """
        finished, value = self.outcome == "finished", np.full(len(self.start), np.nan)
        if finished.any():
            value[finished] = mean_divergence(
                self.system,
                self.start[finished],
                transient=self.transient,
                t_end=float(self.time[-1]),
                time_limit=self.time_limit,
            )
        return read_only(value)

    @property
    def residuals(self) -> SpectrumResiduals:
        """How far the spectrum is from the structure that the bracket prescribes."""
        return spectrum_residuals(self)

    def check(self) -> str:
        """The self-check in words, a line for each property."""
        return "\n".join(check_lines(self))

    def __repr__(self) -> str:
        mean, error = self.mean
        n = int(np.sum(self.outcome == "finished"))
        over = f"over {n} starts" if n > 1 else "over the time of one orbit"
        known = f" ± {error[0]:.2g} ({over})" if np.isfinite(error[0]) else ""
        if n > 1:  # regular and chaotic starts may be among them
            ends = self.end_exponent[self.outcome == "finished", 0]
            known += f", from {ends.min():.2g} to {ends.max():.2g}"
        largest = f"largest {mean[0]:.4g}{known} at t = {self.time[-1]:g}"
        return f"<Spectrum of {self.system.name}: {len(mean)} exponents of {trajectories(self.outcome)}, {largest}>"


def _errors(growth: Array, t_end: float, finished: NDArray[np.bool_]) -> Array:
    """Standard errors of mean rates, from the growth in equal parts of the time, shape (trajectory, time, k).

    NaN for trajectories that did not finish.
    """
    error = np.full((len(growth), growth.shape[2]), np.nan)
    if finished.any():
        error[finished] = mean_error(growth[finished] * growth.shape[1] / t_end)
    return error


def _with_states(vectors: CovariantVectors, system: HasField, start: Array) -> CovariantVectors:
    return replace(vectors, state=with_momentum_of_time(system, start, vectors.state))


def _with_those_of_time(growth: Array, frames: TangentFrames) -> Array:
    """The growth of all vectors, with zeros in the middle for those that a frame at equal times leaves out."""
    if not frames.n_left_out:
        return growth
    n = frames.frame.shape[1]
    middle, zeros = (n - frames.n_left_out) // 2, np.repeat(0.0 * growth[..., :1], frames.n_left_out, axis=2)
    return np.concatenate([growth[..., :middle], zeros, growth[..., middle:]], axis=2)[..., : frames.n_wanted]


@shows_progress
def lyapunov_spectrum(
    system: HasField,
    starts: StartsLike,
    *,
    t_end: float,
    interval: float | None = None,
    transient: float = 0.0,
    n_exponents: int | None = None,
    covariant: bool = False,
    structure: PoissonStructure | None = None,
    seed: int = 0,
    first: int = 0,
    method: MethodChoice | None = None,
    threads: int | None = None,
    time_limit: float = TIME_LIMIT,
    progress: Callable[[float], Any] | None = None,
) -> Spectrum:
    r"""Lyapunov spectrum along each trajectory, by the method of Benettin and others.

    A frame of orthonormal tangent vectors is carried along and made orthonormal again after each interval,
    $D\,Q = Q'R$, and $\lambda_k = t^{-1}\sum\ln R_{kk}$.

    For a Lie-Poisson system the spectrum has structure: a zero for each Casimir, two for each integral in
    involution (the energy among them), and pairs $\pm\lambda$ on the leaf.  A generic orbit of the twisted top has
    $(x, y, 0, 0, 0, 0, 0, -y, -x)$.  `Spectrum.residuals` measures how well this holds, `Spectrum.check()` tells it.

    With time the vectors lead to neighbours at the same time, and t and $p_t$ add two zeros.  Covariant vectors are
    those of the flow of x and t, which on an orbit without bounds grows otherwise.

    Finite-time values are biased by some $\ln(t/T)/t$, as the vectors of the zeros grow like powers of time; T is the
    `time_scale` of the orbit.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> spectrum = lp.lyapunov_spectrum(top, lp.sample_states(top, 1, seed=1), t_end=200)
        >>> spectrum.end_exponent.shape
        (1, 9)

    Args:
        t_end: Averaging time, positive, in units of the system's own time.
        interval: Longest time between orthonormalisations, positive.  Within it the stretchings must not differ by more
            than some 1e8 (`Spectrum.largest_ratio`), nor exceed 1e308 ("not finite"); shorter ones cost time.  By
            default some 5 natural times of the fastest orbit; give it if an ensemble that is computed in pieces is to
            be the same, bit for bit.
        transient: Time before the averages begin, in which the frame turns into its directions.
        n_exponents: How many, the largest ones; by default all.
        covariant: Also compute the covariant Lyapunov vectors, by Ginelli's method.  The run then goes on for another
            `transient` after `t_end`, and 24 N^2 bytes per interval and trajectory are kept.
        structure: The zeros and pairs to expect; by default from the bracket and the known integrals at the start.
        seed: Draws the frames; the first vector is that of `finite_time_exponents`.

    Returns:
        Spectrum; a trajectory that fails is an outcome in it, not an error.

    Raises:
        ShapeError: `starts` or an array of `structure` has another shape.
        ParameterError: Numbers out of range; more than 10,000,000 intervals; `covariant` without a transient, without
            all exponents, or with more than 4 GiB to keep.
        KeyboardInterrupt: Ctrl-C.

    References:
        [benettin1980]; for covariant vectors [ginelli2007].
    """
    options = RunOptions.read(method, threads, time_limit, progress, seed=seed, first=first, system=system)
    t_end = as_duration(t_end, "t_end")
    transient = as_duration(transient, "transient", zero=True)
    starts = given_starts(system, starts)  # once, as several runs start from it
    units = orbit_units(system, starts, options)
    scale = units.time
    if interval is None:
        interval = natural_duration(INTERVAL, scale, fastest=True, otherwise=t_end / N_TIMES)
    interval = as_duration(interval, "interval")
    frames = TangentFrames(
        system, starts, options, units=units.of_frames(), n_vectors=n_exponents, at_equal_times=not covariant
    )
    start = frames.state.copy()  # which is advanced in place
    if structure is None:
        structure = poisson_structure(system, start, frames.unit, options.deadline)
    else:
        check_kind(structure, PoissonStructure, "structure", "a PoissonStructure", "leave it out")
        fits = structure.shape == (len(start),)
        check_shape(fits, "structure", f"({len(start)},), a value for each trajectory", structure)
    before = n_intervals(transient, interval, names=("transient", "interval"))
    per_time = -(-n_intervals(t_end, interval) // N_TIMES)
    n_times = -(-n_intervals(t_end, interval) // per_time)
    during = n_times * per_time
    clock = Clock(before + during + (before if covariant else 0), progress)
    vectors = CovariantRecord(frames, t_end, transient, during, before) if covariant else None
    clock.carry(frames, before, transient / max(1, before), per_row=max(1, before))
    frames.ratio.fill(1.0)  # what was hidden before the averages does not matter
    if vectors is not None:
        vectors.begin()
    carried = clock.carry(frames, during, t_end / during, per_row=per_time, keep=covariant)
    growth = _with_those_of_time(np.where(frames.is_hidden[:, None], np.nan, carried.growth), frames)
    largest_ratio = frames.ratio.max(axis=1)
    time, finished = t_end * np.arange(1, n_times + 1) / n_times, frames.outcome == "finished"
    time[-1] = t_end  # which the quotient may miss by a bit; a file has the time from here
    if vectors is not None:
        vectors.keep(carried)
        vectors.settle(clock.carry(frames, before, transient / before, per_row=before, keep=True))
    exponent = np.cumsum(growth, axis=1)
    exponent /= time[:, None]
    return Spectrum(
        **options.given(system, start, frames.field),
        **options.drawn,
        interval=interval,
        transient=transient,
        t_end=t_end,
        time=time,
        time_scale=scale,
        exponent=exponent,
        error=_errors(growth, t_end, finished),
        structure=structure,
        largest_ratio=largest_ratio,
        outcome=frames.outcome,
        end_time=frames.end_time,
        n_steps=frames.n_steps,
        end_state=with_momentum_of_time(system, start, frames.state),
        order=frames.order,
        kernel=frames.kernel,
        covariant=None if vectors is None else _with_states(vectors.vectors(), system, start),
    )
