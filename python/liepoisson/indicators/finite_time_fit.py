r"""What an ensemble of finite-time exponents says about its long-time limit, with error bars.

Every estimate here is linear in the curves: least squares on the ensemble mean is the mean of the least-squares
coefficients of the trajectories.  A trajectory therefore enters only through a few numbers, and an ensemble of any size
can be reduced piece by piece (`EnsembleReduction`) and resampled at the cost of resampling those few numbers.

References: the asymptotic form is that of Tang and Boozer, Physica D 95, 283 (1996); the bootstrap over trajectories
is Efron's, Ann. Statist. 7, 1 (1979).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import TIME_LIMIT, as_array, as_deadline, as_number
from liepoisson.indicators.estimates import (
    Estimate,
    FiniteTimeFit,
    FloatArray,
    LogFit,
    MeanCurve,
    Resampling,
    Window,
    as_confidence,
)
from liepoisson.inputs.arrays import check_memory, check_shape
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.deadline import checkpoint
from liepoisson.inputs.given import at_times, listed
from liepoisson.inputs.refusals import shown
from liepoisson.portable import elementary, linear
from liepoisson.streams import generator

__all__ = [
    "EnsembleReduction",
    "Estimate",
    "FiniteTimeFit",
    "LogFit",
    "MeanCurve",
    "Resampling",
    "Window",
    "finite_time_fit",
    "log_fit",
    "mean_curve",
    "window_grid",
    "window_scan",
]

# Replicates drawn at a time: 32 x 20,000 counts of 8 bytes are 5 MB, and larger blocks were not faster.
_REPLICATES_AT_A_TIME = 32
# A law of three coefficients needs more samples than that, or its residual says nothing.
_MIN_TIMES = 5


_MOST = 1e150
"""The errors of coefficients are roots of sums of squares, which may not overflow."""


@dataclass(frozen=True)
class _Law:
    r"""A law $t^p\,\langle\lambda(t)\rangle = \sum_k c_k f_k(t)$, linear in its coefficients $c_k$."""

    names: tuple[str, ...]
    columns: tuple[Callable[[FloatArray], FloatArray], ...]
    power: int = 0

    def design(self, time: FloatArray) -> FloatArray:
        """The matrix f_k(t_j), shape (time, coefficient)."""
        return np.stack([column(time) for column in self.columns], axis=1)


def _one(time: FloatArray) -> FloatArray:
    return np.ones_like(time)


def _same(time: FloatArray) -> FloatArray:
    return time


def _inverse_root(time: FloatArray) -> FloatArray:
    return 1.0 / np.sqrt(time)


def _inverse(time: FloatArray) -> FloatArray:
    return 1.0 / time


def _inverse_square(time: FloatArray) -> FloatArray:
    return 1.0 / (time * time)


_FINITE_TIME = _Law(("lambda", "c1", "c0"), (_one, _inverse_root, _inverse))
_LOGARITHM = _Law(("A", "B"), (_one, elementary.log), power=1)
_LOGARITHM_AND_LINE = _Law(("A", "B", "D"), (_one, elementary.log, _same), power=1)
_LOGARITHM_LINE_AND_NEXT = _Law(("A", "B", "D", "E"), (_one, elementary.log, _same, _inverse), power=1)
_LOGARITHM_LINE_AND_TWO = _Law(
    ("A", "B", "D", "E", "F"), (_one, elementary.log, _same, _inverse, _inverse_square), power=1
)
_LOG_LAWS = (_LOGARITHM, _LOGARITHM_AND_LINE, _LOGARITHM_LINE_AND_NEXT, _LOGARITHM_LINE_AND_TWO)


@explains_its_methods
class EnsembleReduction:
    """Growth curves of an ensemble, reduced as they come to what the fits need.

    Give the windows first, then the curves in pieces of any size, then ask for the fits.  What is kept is the
    running mean and variance at each time and three numbers per trajectory and window: for 20,000 trajectories and 20
    windows 10 MB, whatever the number of sample times.

    Example:
        >>> top, times = lp.Top.twisted_kovalevskaya(), np.arange(1.0, 201.0)
        >>> reduction = lp.fits.EnsembleReduction(times, windows=[(20, 200)])
        >>> for first in (0, 25):  # members in pieces
        ...     starts = lp.sample_states(top, 25, seed=1, first=first)
        ...     reduction.add(lp.finite_time_exponents(top, starts, times=times, first=first).exponent)
        >>> reduction.n_members, round(reduction.finite_time_fits()[0].lambda_, 3)
        (50, 0.133)

    Args:
        time: Sample times, shape (time,), positive and increasing.
        windows: Windows of `finite_time_fits`.
        log_windows: Windows of `log_fits`.

    Raises:
        ShapeError: `time` is not one-dimensional.
        ParameterError: times not positive, finite and increasing, or a window with too few of them.
    """

    def __init__(self, time: ArrayLike, *, windows: Sequence[Window] = (), log_windows: Sequence[Window] = ()) -> None:
        self.time = _checked_time(time)
        self.windows = _checked_windows(windows, "windows")
        self.log_windows = _checked_windows(log_windows, "log_windows")
        requests = [(_FINITE_TIME, window) for window in self.windows]
        requests += [(law, window) for window in self.log_windows for law in _LOG_LAWS]
        projectors = [_projector(law, window, self.time) for law, window in requests]
        self._projector = np.concatenate([np.zeros((0, self.time.size)), *projectors])
        self._coefficients: list[FloatArray] = []
        self._estimated: dict[Resampling, list[Estimate]] = {}
        self._mean = np.zeros(self.time.size)
        self._squares = np.zeros(self.time.size)
        self.n_members = 0
        self.n_excluded = 0

    def add(self, exponent: ArrayLike) -> None:
        """Take in the curves of some trajectories, shape (trajectory, time).

        A trajectory with a value that is not finite did not finish: it is left out of everything and counted.

        Raises:
            ShapeError: the last axis does not match the sample times.
            ParameterError: it has other times as labels.
        """
        curves = as_array(at_times(exponent, "exponent", self.time.tolist()), "exponent")
        fits = curves.ndim == 2 and curves.shape[1] == self.time.size
        check_shape(fits, "exponent", f"(trajectory, time) with {self.time.size} times", curves, "Transpose it?")
        finished = np.isfinite(curves).all(axis=1)
        self.n_excluded += int(np.count_nonzero(~finished))
        if not finished.all():
            curves = curves[finished]
        if curves.shape[0] == 0:
            return
        self._coefficients.append(linear.matmul(curves, self._projector.T))
        self._estimated.clear()
        self._merge_moments(curves)

    def _merge_moments(self, curves: FloatArray) -> None:
        # Chan, Golub and LeVeque, Amer. Statist. 37, 242 (1983): moments of two samples merged without cancellation.
        n_new, n_old = curves.shape[0], self.n_members
        mean = curves.mean(axis=0)
        squares = np.square(curves - mean).sum(axis=0)
        difference = mean - self._mean
        n = n_old + n_new
        self._mean = self._mean + difference * (n_new / n)
        self._squares = self._squares + squares + np.square(difference) * (n_old * n_new / n)
        self.n_members = n

    def mean_curve(self, *, confidence: float = 0.95) -> MeanCurve:
        """The mean of all trajectories taken in so far, with its pointwise confidence band.

        Raises:
            ParameterError: fewer than two trajectories finished, or a confidence outside (0, 1).
        """
        confidence = as_confidence(confidence)
        self._require_members()
        standard_error = np.sqrt(self._squares / (self.n_members - 1) / self.n_members)
        half_width = NormalDist().inv_cdf(0.5 + confidence / 2) * standard_error
        low, high = self._mean - half_width, self._mean + half_width
        return MeanCurve(
            self.time, self._mean.copy(), standard_error, low, high, confidence, self.n_members, self.n_excluded
        )

    def finite_time_fits(self, resampling: Resampling | None = None) -> tuple[FiniteTimeFit, ...]:
        """One fit per window, all from the same bootstrap replicates, so that their differences are meaningful.

        Raises:
            ParameterError: fewer than two trajectories finished.
        """
        resampling = resampling or Resampling()
        n_coefficients = len(_FINITE_TIME.names)
        columns = self._estimates(resampling)
        return tuple(
            FiniteTimeFit(
                dict(zip(_FINITE_TIME.names, columns[n_coefficients * k :], strict=False)),
                window,
                *self._fit_facts(_FINITE_TIME, window),
                resampling,
                self._covariance(slice(n_coefficients * k, n_coefficients * (k + 1))),
            )
            for k, window in enumerate(self.windows)
        )

    def log_fits(self, resampling: Resampling | None = None) -> tuple[LogFit, ...]:
        """One logarithmic fit, plain and with further terms, per logarithmic window.

        Raises:
            ParameterError: fewer than two trajectories finished.
        """
        resampling = resampling or Resampling()
        columns = self._estimates(resampling)[len(_FINITE_TIME.names) * len(self.windows) :]
        fits: list[LogFit] = []
        start = 0
        for window in self.log_windows:
            estimates: list[dict[str, Estimate]] = []
            for law in _LOG_LAWS:
                estimates.append(dict(zip(law.names, columns[start:], strict=False)))
                start += len(law.names)
            plain, linear, further, both = estimates
            facts = self._fit_facts(_LOGARITHM, window)
            fits.append(LogFit(plain, linear, further, both, window, *facts, resampling))
        return tuple(fits)

    def _estimates(self, resampling: Resampling) -> list[Estimate]:
        """Value, standard error and percentile interval of every coefficient, in the order of the requests."""
        self._require_members()
        if resampling not in self._estimated:
            coefficients = np.concatenate(self._coefficients)
            replicates = _bootstrap_means(coefficients, resampling)
            tail = (1 - resampling.confidence) / 2
            low, high = np.quantile(replicates, [tail, 1 - tail], axis=0)
            errors = replicates.std(axis=0, ddof=1)
            table = np.stack([coefficients.mean(axis=0), errors, low, high], axis=1)
            self._estimated[resampling] = [Estimate(*map(float, row)) for row in table]
        return self._estimated[resampling]

    def _covariance(self, columns: slice) -> tuple[tuple[float, ...], ...]:
        """Covariance of the mean of some coefficients over the trajectories."""
        coefficients = np.concatenate([piece[:, columns] for piece in self._coefficients])
        covariance = linear.cov(coefficients) / self.n_members
        return tuple(tuple(map(float, row)) for row in covariance)

    def _fit_facts(self, law: _Law, window: Window) -> tuple[int, int, int, float]:
        """Number of times, of trajectories and of trajectories left out, and the residual of the mean curve."""
        inside = _inside(window, self.time)
        target = self._mean[inside] * elementary.power(self.time[inside], law.power)
        design = law.design(self.time[inside])
        residual = target - linear.matmul(design, linear.matmul(_projector(law, window, self.time), self._mean))
        rms = float(np.sqrt(np.mean(np.square(residual))))
        return int(np.count_nonzero(inside)), self.n_members, self.n_excluded, rms

    def _require_members(self) -> None:
        if self.n_members < 2:
            raise ParameterError(
                f"an average with an error needs at least 2 trajectories that finished; got {self.n_members} "
                f"({self.n_excluded} did not finish). Look at their outcomes, or take more trajectories."
            )


@explains_its_arguments
def finite_time_fit(
    time: ArrayLike,
    exponent: ArrayLike,
    *,
    window: Window | None = None,
    n_bootstrap: int = 1000,
    seed: int = 0,
    confidence: float = 0.95,
    time_limit: float = TIME_LIMIT,
) -> FiniteTimeFit:
    r"""Fit of the mean finite-time exponent to $\lambda + c_1/\sqrt t + c_0/t$, with a bootstrap over trajectories.

    Unweighted least squares on the sample times inside the window.  The result depends on the window (the law is
    asymptotic) and on the ensemble (a mean over regular and chaotic orbits of many energies): quote both, and see
    `window_scan`.  The errors are statistical only.

    Example:
        >>> time = np.geomspace(10, 1000, 60)
        >>> members = np.random.default_rng(1).normal(0.12, 0.01, (200, 1))
        >>> fit = lp.fits.finite_time_fit(time, members + 0.3 / np.sqrt(time) - 2 / time)
        >>> round(fit.c1, 6), round(fit.c0, 6), fit.estimates["lambda"].contains(0.12)
        (0.3, -2.0, True)

    Args:
        time: Sample times, shape (time,), positive and increasing.
        exponent: Finite-time exponents, shape (trajectory, time), in inverse time; where its axis has times as
            labels, they bring it into the order of `time`.  Trajectories with a value that is not finite are left out
            and counted.
        window: First and last time used; it must hold at least 5 sample times.  By default the last decade of the
            sample times, which may begin too early: see `window_scan`.
        n_bootstrap: Number of bootstrap replicates.
        seed: Draws the replicates.
        confidence: Coverage of the intervals.
        time_limit: Seconds that it may take.

    Returns:
        The coefficients with standard errors and percentile intervals.

    Raises:
        ShapeError: `exponent` is not (trajectory, time).
        ParameterError: bad times or window, or fewer than two trajectories that finished.
        TimeLimitError: the time limit has passed.

    References: Tang and Boozer, Physica D 95, 283 (1996); Thiffeault and Morrison (2001), figure of the exponents.
    """
    time = _checked_time(time)
    window = last_decade(time) if window is None else window
    options: dict[str, Any] = {"n_bootstrap": n_bootstrap, "seed": seed, "confidence": confidence}
    return window_scan(time, exponent, windows=[window], time_limit=time_limit, **options)[0]


@explains_its_arguments
def window_scan(
    time: ArrayLike,
    exponent: ArrayLike,
    *,
    windows: Sequence[Window] | None = None,
    n_bootstrap: int = 1000,
    seed: int = 0,
    confidence: float = 0.95,
    time_limit: float = TIME_LIMIT,
) -> tuple[FiniteTimeFit, ...]:
    """`finite_time_fit` over many windows, by default over `window_grid`; all share the bootstrap replicates.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 50, seed=1), t_end=500)
        >>> fits = lp.fits.window_scan(growth.time, growth.exponent, windows=[(20, 200), (50, 500)])
        >>> [(fit.window, round(fit.lambda_, 3)) for fit in fits]
        [((20.0, 200.0), 0.129), ((50.0, 500.0), 0.128)]

    Args:
        time: Sample times, shape (time,), positive and increasing.
        exponent: Finite-time exponents, shape (trajectory, time), in inverse time.
        windows: First and last times, at least 5 sample times in each.
        n_bootstrap: Number of bootstrap replicates.
        seed: Draws the replicates.
        confidence: Coverage of the intervals.
        time_limit: Seconds that it may take.

    Raises:
        ShapeError: `exponent` is not (trajectory, time).
        ParameterError: bad times, a bad window or none, or fewer than two trajectories that finished.
        TimeLimitError: the time limit has passed.
    """
    deadline, resampling = as_deadline(time_limit), Resampling(n_bootstrap, confidence, seed)
    time = as_array(time, "time")
    with deadline.running():
        wanted = window_grid(time) if windows is None else _checked_windows(windows, "windows")
        if not wanted:
            raise ParameterError(
                "windows: wanted at least one (start, end); got none; leave it out to take window_grid"
            )
        reduction = EnsembleReduction(time, windows=wanted)
        reduction.add(exponent)
        return reduction.finite_time_fits(resampling)


@explains_its_arguments
def log_fit(
    time: ArrayLike,
    exponent: ArrayLike,
    *,
    window: Window | None = None,
    n_bootstrap: int = 1000,
    seed: int = 0,
    confidence: float = 0.95,
    time_limit: float = TIME_LIMIT,
) -> LogFit:
    r"""Fit of the mean exponent to $t\,\langle\lambda(t)\rangle = A + B\ln t$, plain and with a linear term.

    Arguments and errors are those of `finite_time_fit`.  Whether the linear term vanishes within its error is the
    test for a floor below which the exponent does not fall; see `LogFit` for what spoils it.

    Example:
        >>> time, speed = np.geomspace(10, 1000, 60), np.random.default_rng(1).uniform(0.5, 2, (100, 1))
        >>> fit = lp.fits.log_fit(time, np.log(1 + speed * time) / time)  # tangent vectors grow linearly
        >>> round(fit.B, 2), fit.floor_is_zero
        (1.0, True)

    Args:
        time: Sample times, shape (time,), positive and increasing.
        exponent: Finite-time exponents, shape (trajectory, time), in inverse time.
        window: First and last time used; by default the last decade of the sample times.
        n_bootstrap: Number of bootstrap replicates.
        seed: Draws the replicates.
        confidence: Coverage of the intervals.
        time_limit: Seconds that it may take.

    Raises:
        ShapeError: `exponent` is not (trajectory, time).
        ParameterError: bad times or window, or fewer than two trajectories that finished.
        TimeLimitError: the time limit has passed.
    """
    deadline, resampling = as_deadline(time_limit), Resampling(n_bootstrap, confidence, seed)
    time = _checked_time(time)
    window = last_decade(time) if window is None else window
    with deadline.running():
        reduction = EnsembleReduction(time, log_windows=[window])
        reduction.add(exponent)
        return reduction.log_fits(resampling)[0]


@explains_its_arguments
def mean_curve(time: ArrayLike, exponent: ArrayLike, *, confidence: float = 0.95) -> MeanCurve:
    """Ensemble mean of the exponents (trajectory, time) with a pointwise confidence band.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 50, seed=1), t_end=500)
        >>> print(lp.fits.mean_curve(growth.time, growth.exponent).at(500))
        0.1313 ± 0.0040

    Raises:
        ShapeError: `exponent` is not (trajectory, time).
        ParameterError: bad times, or fewer than two trajectories that finished.
    """
    reduction = EnsembleReduction(time)
    reduction.add(exponent)
    return reduction.mean_curve(confidence=confidence)


def last_decade(time: ArrayLike) -> Window:
    """The last sample time and a tenth of it, or the first sample time where that is later.

    Raises:
        ShapeError: `time` is not one-dimensional, or empty.
        ParameterError: times that are not positive and increasing.
    """
    t = _checked_time(time)
    return max(float(t[0]), float(t[-1]) / 10.0), float(t[-1])


@explains_its_arguments
def window_grid(
    time: ArrayLike,
    *,
    starts: Sequence[float] | None = None,
    ends: Sequence[float] | None = None,
) -> tuple[Window, ...]:
    """The windows [start, end] inside the sample times whose end is at least twice their start.

    Example:
        >>> lp.fits.window_grid(np.arange(1.0, 201.0), starts=[10, 50], ends=[50, 200])
        ((10.0, 50.0), (10.0, 200.0), (50.0, 200.0))

    Args:
        time: Sample times, shape (time,), positive and increasing.
        starts: By default 1/200, 1/100, 1/50, 1/20, 1/10, 1/5 and 1/2 of the last time.
        ends: By default 1/10, 1/5, 1/2 of the last time, and this time.

    Raises:
        ParameterError: no such window.
    """
    t = _checked_time(time)
    last = float(t[-1])
    starts = [last / n for n in (200, 100, 50, 20, 10, 5, 2)] if starts is None else _times(starts, "starts")
    ends = [last / n for n in (10, 5, 2, 1)] if ends is None else _times(ends, "ends")
    grid = [(float(start), float(end)) for end in ends for start in starts if 2 * start <= end <= t[-1]]
    grid = [window for window in grid if window[0] >= t[0] * (1 - _SLACK)]
    windows = tuple(window for window in grid if np.count_nonzero(_inside(window, t)) >= _MIN_TIMES)
    if not windows:
        raise ParameterError(
            f"no window with starts {list(starts)} and ends {list(ends)} holds {_MIN_TIMES} of the sample times "
            f"{t[0]:g} .. {t[-1]:g}. Give `windows` yourself, or sample longer."
        )
    return windows


def _times(values: Sequence[float], name: str) -> list[float]:
    if (given := listed(values, name)) is None:
        raise ParameterError(f"{name} must be a sequence of times; got {shown(values)}. Try [10, 20].")
    return [as_number(value, name, "numbers") for value in given]


def _bootstrap_means(values: FloatArray, resampling: Resampling) -> FloatArray:
    """Means of trajectories drawn with replacement, shape (replicate, quantity), from (trajectory, quantity)."""
    n = values.shape[0]
    random = generator(np.random.SeedSequence(resampling.seed))
    blocks: list[FloatArray] = []
    check_memory(16 * resampling.n_bootstrap * values.shape[1], "n_bootstrap")  # the blocks, and all of them in one
    for start in range(0, resampling.n_bootstrap, _REPLICATES_AT_A_TIME):
        checkpoint("the bootstrap")
        size = min(_REPLICATES_AT_A_TIME, resampling.n_bootstrap - start)
        draws = random.integers(0, n, size=(size, n), dtype=np.int64)
        draws += np.arange(size, dtype=np.int64)[:, np.newaxis] * n
        counts = np.bincount(draws.ravel(), minlength=size * n).reshape(size, n)
        blocks.append(linear.matmul(counts.astype(np.float64), values) / n)
    return np.concatenate(blocks)


# Edges that differ from a sample time by round-off count as equal to it.
_SLACK = 1e-9


def _projector(law: _Law, window: Window, time: FloatArray) -> FloatArray:
    """The matrix, shape (coefficient, time), that takes a curve to its least-squares coefficients."""
    checkpoint("fitting the windows")
    inside = _inside(window, time)
    n_times = int(np.count_nonzero(inside))
    if window[0] < time[0] * (1 - _SLACK) or window[1] > time[-1] * (1 + _SLACK):
        raise ParameterError(
            f"the window [{window[0]:g}, {window[1]:g}] must lie inside the sample times, {time[0]:g} to {time[-1]:g}. "
            "Choose another window, or sample longer."
        )
    if n_times < _MIN_TIMES:
        raise ParameterError(
            f"the window [{window[0]:g}, {window[1]:g}] must hold at least {_MIN_TIMES} sample times; it holds "
            f"{n_times} of {time.size} between {time[0]:g} and {time[-1]:g}. Widen it, or sample longer or more often."
        )
    design = law.design(time[inside])
    # Powers of two, so that squares of times such as 1e150 neither overflow nor vanish.
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = elementary.exp2(np.floor(elementary.log2(np.abs(design).max(axis=0))))
        scale = unit * linear.norm(design / unit, axis=0)
    projector = np.full((len(law.names), time.size), np.nan)
    if (np.isfinite(scale) & (scale > 0.0)).all():
        with np.errstate(over="ignore"):
            # Columns of unit length keep the pseudo-inverse well conditioned although 1 and t differ by a factor 1000.
            projector[:, inside] = linear.pinv(design / scale) / scale[:, np.newaxis]
            projector[:, ~inside] = 0.0
            projector *= elementary.power(time, law.power)
    if not (np.abs(projector) < _MOST).all():
        raise ParameterError(
            f"time: wanted times whose powers in the law fit into doubles; got times from {time[inside][0]:g} to "
            f"{time[inside][-1]:g}; choose another unit of time"
        )
    return projector


def _inside(window: Window, time: FloatArray) -> NDArray[np.bool_]:
    return (time >= window[0]) & (time <= window[1])


def _checked_time(time: ArrayLike) -> FloatArray:
    t = as_array(time, "time")
    check_shape(t.ndim == 1 and t.size > 0, "time", "(time,) with at least one entry", t)
    if not np.isfinite(t).all() or t[0] <= 0 or (np.diff(t) <= 0).any():
        raise ParameterError(
            f"time must be finite, positive and strictly increasing; got {t.size} values from {t[0]:g} to {t[-1]:g}. "
            "Leave out t = 0, where a finite-time exponent is not defined."
        )
    return t


def as_window(window: Sequence[float]) -> Window:
    checkpoint("reading windows")
    edges = listed(window, "window") or []
    start, end = (as_number(edge, "window", "two numbers") for edge in edges) if len(edges) == 2 else (math.nan,) * 2
    if not (0 < start < end < math.inf):
        raise ParameterError(f"a window must be (start, end) with 0 < start < end; got {shown(window)}. Try (20, 200).")
    return start, end


def _checked_windows(windows: Sequence[Window], name: str) -> tuple[Window, ...]:
    if (given := listed(windows, name)) is None:
        raise ParameterError(f"{name} must be a sequence of windows; got {shown(windows)}. Try [(20, 200)].")
    return tuple(as_window(window) for window in given)
