"""Estimates with their errors, and the fits that `finite_time_fit` returns."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_array, as_count, as_number
from liepoisson.inputs.arrays import ReadOnlyArrays, check_shape
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.refusals import counted
from liepoisson.portable import elementary, linear

FloatArray: TypeAlias = NDArray[np.float64]
Window: TypeAlias = tuple[float, float]


class Estimate(NamedTuple):
    """A number with its standard error and its confidence interval [low, high].

    The error is that of this number as an estimate of what it stands for.  What was averaged, the starts, the
    trajectories of an ensemble or the time of one orbit, is said by what returns it.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 50, seed=1), t_end=500)
        >>> mean = lp.fits.mean_curve(growth.time, growth.exponent).at(500)
        >>> print(mean)
        0.1313 ± 0.0040
        >>> round(mean.low, 3), round(mean.high, 3)
        (0.123, 0.139)
    """

    value: float
    standard_error: float
    low: float
    high: float

    def __str__(self) -> str:
        """Read as `0.1236 ± 0.0005`: the error to two significant digits, the value to the same place."""
        if not (math.isfinite(self.standard_error) and self.standard_error > 0):
            return f"{self.value:.6g} ± {self.standard_error:.2g}"
        places = max(0, 1 - math.floor(math.log10(self.standard_error)))
        return f"{self.value:z.{places}f} ± {self.standard_error:.{places}f}"

    def contains(self, number: float) -> bool:
        """Whether `number` lies in the confidence interval."""
        return self.low <= number <= self.high


@explains_its_methods
@dataclass(frozen=True)
class Resampling:
    """How the errors of an estimate were made: by resampling whole trajectories, with replacement.

    Example:
        >>> lp.fits.Resampling(n_bootstrap=200, seed=1)
        Resampling(n_bootstrap=200, confidence=0.95, seed=1)

    Attributes:
        n_bootstrap: Number of replicates.
        confidence: Coverage of the (percentile) intervals, between 0 and 1.
        seed: Draws the replicates.
    """

    n_bootstrap: int = 1000
    confidence: float = 0.95
    seed: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "n_bootstrap", as_count(self.n_bootstrap, "n_bootstrap", least=2, hint="try 1000"))
        object.__setattr__(self, "seed", as_count(self.seed, "seed", most=2**128 - 1))
        object.__setattr__(self, "confidence", as_confidence(self.confidence))


@dataclass(frozen=True)
class FiniteTimeFit(ReadOnlyArrays):
    r"""Fit of the ensemble mean to $\langle\lambda(t)\rangle = \lambda + c_1/\sqrt t + c_0/t$.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 50, seed=1), t_end=500)
        >>> fit = lp.fits.finite_time_fit(growth.time, growth.exponent)
        >>> round(fit.lambda_, 3), fit.window, fit.n_members
        (0.128, (50.0, 500.0), 50)

    Attributes:
        estimates: `lambda`, `c1` and `c0`, each with standard error and confidence interval.
        window: First and last time used.
        n_times: Sample times inside the window.
        n_members: Trajectories averaged.
        n_excluded: Trajectories left out because they did not finish.
        rms_residual: Root mean square of mean curve minus fit over the window.
        resampling: How the errors were made.
        covariance: Covariance of `lambda`, `c1`, `c0` from the spread of the members: the three are strongly
            correlated, so they must not be compared with other values one by one.
    """

    estimates: dict[str, Estimate] = field(hash=False)
    window: Window
    n_times: int
    n_members: int
    n_excluded: int
    rms_residual: float
    resampling: Resampling
    covariance: tuple[tuple[float, ...], ...]

    def chi_squared(self, coefficients: ArrayLike) -> float:
        r"""$d^T V^{-1} d$ for the distance d to given (lambda, c1, c0): chi squared with 3 degrees of freedom."""
        values = [self.lambda_, self.c1, self.c0]
        given = as_array(coefficients, "coefficients", ("lambda", "c1", "c0"))
        check_shape(given.shape == (3,), "coefficients", "(3,): lambda, c1, c0", given, "Give three.")
        distance = given - values
        return float(linear.matmul(distance, linear.solve(np.array(self.covariance), distance)))

    @property
    def lambda_(self) -> float:
        r"""The limit $\lambda$ of the mean finite-time exponent, in inverse time."""
        return self.estimates["lambda"].value

    @property
    def c1(self) -> float:
        r"""The coefficient of $1/\sqrt t$."""
        return self.estimates["c1"].value

    @property
    def c0(self) -> float:
        r"""The coefficient of $1/t$."""
        return self.estimates["c0"].value

    @property
    def standard_errors(self) -> dict[str, float]:
        """Bootstrap standard error of each coefficient."""
        return {name: estimate.standard_error for name, estimate in self.estimates.items()}

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Bootstrap percentile interval of each coefficient."""
        return {name: (estimate.low, estimate.high) for name, estimate in self.estimates.items()}

    def curve(self, time: ArrayLike) -> FloatArray:
        """The fitted law at the given times (> 0), in inverse time."""
        t = as_array(time, "time")
        return self.lambda_ + self.c1 / np.sqrt(t) + self.c0 / t

    def __str__(self) -> str:
        low, high = self.window
        terms = ", ".join(f"{name} = {estimate}" for name, estimate in self.estimates.items())
        left_out = f", {self.n_excluded} left out" if self.n_excluded else ""
        return f"{terms}  (t in [{low:g}, {high:g}], {self.n_members} trajectories{left_out})"


@dataclass(frozen=True)
class LogFit(ReadOnlyArrays):
    r"""Fit of the ensemble mean to $t\,\langle\lambda(t)\rangle = A + B\ln t$, alone and with further terms.

    A regular system has tangent vectors that grow like a power of time, so $B$ is that power; a term $D\,t$ is a
    floor, the part of the exponent that does not go to zero.  The law is asymptotic: where tangents grow as
    $|u + w\,t|$ the next term is $E/t$, and if the window starts so early that it matters, a fit without it bends
    $D$ away from zero by many of its statistical errors.  So the floor is fitted with and without that term.

    The statistical error is not the only one of the floor: terms beyond $E/t$ bend it, too, and of trajectories with a
    small $w$ there may be few.  `floor_bias`, by how much a term $F/t^2$ moves it, measures this, and `floor_is_zero`
    allows for it.  Of 20 ensembles of curves $\ln|u + w\,t|/t$, t from 50 to 1,000, the interval of the floor alone
    holds zero in 10 (300 trajectories, log-normal $|w|$), 18 (1,000 of them) and none (300 with $|w|$ from 0.5 to 2,
    where the floors are $-8\cdot10^{-8}$); with the bias it is 20, 19 and 20.

    Example:
        >>> top = lp.Top.lagrange()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 50, seed=1), t_end=1000)
        >>> fit = lp.fits.log_fit(growth.time, growth.exponent)
        >>> round(fit.B, 2), fit.floor_is_zero  # tangent vectors grow linearly: the top is integrable
        (1.0, True)

    Attributes:
        estimates: `A` and `B` of the plain fit.
        with_linear_term: `A`, `B` and `D` of the fit to $A + B\ln t + D\,t$.
        with_next_term: `A`, `B`, `D` and `E` of the fit to $A + B\ln t + D\,t + E/t$.
        with_two_terms: `A`, `B`, `D`, `E` and `F` of the fit to $A + B\ln t + D\,t + E/t + F/t^2$.
        window: First and last time used.
        n_times: Sample times inside the window.
        n_members: Trajectories averaged.
        n_excluded: Trajectories left out because they did not finish.
        rms_residual: Root mean square of t times the mean curve minus the fit without linear term.
        resampling: How the errors were made.
    """

    estimates: dict[str, Estimate] = field(hash=False)
    with_linear_term: dict[str, Estimate] = field(hash=False)
    with_next_term: dict[str, Estimate] = field(hash=False)
    with_two_terms: dict[str, Estimate] = field(hash=False)
    window: Window
    n_times: int
    n_members: int
    n_excluded: int
    rms_residual: float
    resampling: Resampling

    @property
    def A(self) -> float:
        """The constant of the fit without the linear term."""
        return self.estimates["A"].value

    @property
    def B(self) -> float:
        """The power of time with which tangent vectors grow."""
        return self.estimates["B"].value

    @property
    def D(self) -> float:
        """The coefficient of t when only the linear term is added, in inverse time."""
        return self.with_linear_term["D"].value

    @property
    def floor(self) -> Estimate:
        """The coefficient of t when the next term of the regular law is allowed for, in inverse time."""
        return self.with_next_term["D"]

    @property
    def linear_term_is_zero(self) -> bool:
        """Whether the confidence interval of D contains zero when only the linear term is added."""
        return self.with_linear_term["D"].contains(0.0)

    @property
    def floor_bias(self) -> float:
        """By how much the floor moves when a term $F/t^2$ is allowed for as well, in inverse time, not negative."""
        return abs(self.with_two_terms["D"].value - self.floor.value)

    @property
    def floor_is_zero(self) -> bool:
        """Whether the confidence interval of the floor contains zero when it is made wider by `floor_bias` at each end.

        This is no test of a stated level: it says that the floor is not above what the fit can see.
        """
        return self.floor.low - self.floor_bias <= 0.0 <= self.floor.high + self.floor_bias

    def curve(self, time: ArrayLike) -> FloatArray:
        """The fitted mean exponent (A + B ln t)/t at the given times (> 0), in inverse time."""
        t = as_array(time, "time")
        return (self.A + self.B * elementary.log(t)) / t

    def __str__(self) -> str:
        low, high = self.window
        floors = ", ".join(
            f"{name} D = {D.value:.1e} ± {D.standard_error:.1e}, {'zero' if is_zero else 'not zero'} within its error"
            for name, D, is_zero in (
                ("linear term", self.with_linear_term["D"], self.linear_term_is_zero),
                ("with E/t", self.floor, self.floor_is_zero),
            )
        )
        return (
            f"A = {self.estimates['A']}, B = {self.estimates['B']}; {floors}  "
            f"(t in [{low:g}, {high:g}], {self.n_members} trajectories)"
        )


@dataclass(frozen=True, eq=False)
class MeanCurve(ReadOnlyArrays):
    r"""The ensemble mean with a pointwise confidence band, $\bar\lambda(t) \pm z\,s(t)/\sqrt n$.

    The band is that of the normal distribution ($z = 1.96$ at 95%), good from some tens of trajectories on.  It holds
    time by time; values at different times are correlated, because each trajectory keeps its own exponent.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 50, seed=1), t_end=500)
        >>> curve = lp.fits.mean_curve(growth.time, growth.exponent)
        >>> round(float(curve.mean[-1]), 3), curve.n_members
        (0.131, 50)

    Attributes:
        time: Sample times, shape (time,).
        mean: Mean exponent, shape (time,), in inverse time.
        standard_error: Of the mean, shape (time,).
        low: Lower edge of the band, shape (time,).
        high: Upper edge of the band, shape (time,).
        confidence: Pointwise coverage of the band.
        n_members: Trajectories averaged.
        n_excluded: Trajectories left out because they did not finish.
    """

    time: FloatArray
    mean: FloatArray
    standard_error: FloatArray
    low: FloatArray
    high: FloatArray
    confidence: float
    n_members: int
    n_excluded: int

    def at(self, time: float) -> Estimate:
        """The mean at one of the sample times, or linearly between two of them."""
        time = as_number(time, "time", "one time")
        if not self.time[0] <= time <= self.time[-1]:
            raise ParameterError(f"time must lie in [{self.time[0]:g}, {self.time[-1]:g}]; got {time:g}.")
        columns = (self.mean, self.standard_error, self.low, self.high)
        return Estimate(*(float(elementary.interp(time, self.time, column)) for column in columns))

    def __repr__(self) -> str:
        last = self.at(float(self.time[-1]))
        return (
            f"<MeanCurve: {self.n_members} trajectories, {counted(len(self.time), 'time')}, exponent {last} at t = "
            f"{self.time[-1]:g}>"
        )


def as_confidence(confidence: float) -> float:
    """A coverage as a plain float.

    Raises:
        ParameterError: it is not a number between 0 and 1.
    """
    coverage = as_number(confidence, "confidence", "a number between 0 and 1")
    if not 0 < coverage < 1:
        raise ParameterError(f"confidence must lie between 0 and 1; got {coverage}. Try 0.95.")
    return coverage
