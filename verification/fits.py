r"""Powers, measured: least squares in logarithms, with standard errors from what is independent in the data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Power:
    """The exponent p of y = c x^p.

    Attributes:
        exponent: p.
        error: Its standard error.
        coefficient: c.
        n_points: Points that the fit rests on.
    """

    exponent: float
    error: float
    coefficient: float
    n_points: int


def slope(x: Array, y: Array) -> tuple[float, float]:
    """The power p and ln c of y = c x^p by least squares in logarithms; positive numbers, shape (point,)."""
    p, log_c = np.polyfit(np.log(x), np.log(y), 1)
    return float(p), float(log_c)


def measured_order(steps: Array, errors: Array, low: float, high: float, least: int = 3) -> Power | None:
    """The order of a method: the mean over starts of the slope of the error against the step.

    Each start has a slope of its own from its errors between `low` and `high`; the starts are independent, so the
    standard error is that of their mean.  The residuals of one line would say nothing: they are curvature, not noise.

    Args:
        steps: Step sizes, shape (step,), or for each start, (start, step).
        errors: Errors at the end, shape (start, step).
        low: Errors below belong to the plateau of round-off.
        high: Errors above are not asymptotic.
        least: Points that a start needs to have a say.

    Returns:
        The order, or None if fewer than two starts have enough points.
    """
    fits: list[tuple[float, float]] = []
    n_points = 0
    for h, error in zip(np.broadcast_to(steps, errors.shape), errors, strict=True):
        inside = (error > low) & (error < high)  # a NaN is neither
        if np.count_nonzero(inside) >= least:
            fits.append(slope(h[inside], error[inside]))
            n_points += int(np.count_nonzero(inside))
    if len(fits) < 2:
        return None
    slopes, logs = np.array(fits).T
    error_of_mean = float(slopes.std(ddof=1) / np.sqrt(len(slopes)))
    return Power(float(slopes.mean()), error_of_mean, float(np.exp(logs.mean())), n_points)


def growth_of_rms(time: Array, squares: Array) -> Power:
    """The exponent p of RMS(t) = c t^p, with its standard error by the jackknife over members.

    Errors at neighbouring times are correlated, since they add up along a trajectory; members are independent.  So each
    member is left out in turn, and the spread of the fits gives the error.

    Args:
        time: Times, shape (window,).
        squares: Mean square of the error of each member in each window, shape (member, window).

    Raises:
        ValueError: Fewer than two members or two windows, or a window in which no member has an error.
    """
    n, windows = squares.shape
    total = squares.sum(axis=0)
    if n < 2 or windows < 2 or not (total > 0).all():
        raise ValueError(
            f"wanted errors that are not zero, of at least 2 members in 2 windows; got shape {squares.shape}"
        )
    p, log_c = slope(time, np.sqrt(total / n))
    # A member may hold all of the error of a window; its absence must not make the logarithm infinite.
    without = np.sqrt(np.maximum(total - squares, 1e-30 * total) / (n - 1))
    replicas = np.polyfit(np.log(time), np.log(without).T, 1)[0]
    error = float(np.sqrt((n - 1) / n * ((replicas - replicas.mean()) ** 2).sum()))
    return Power(p, error, float(np.exp(log_c)), windows)
