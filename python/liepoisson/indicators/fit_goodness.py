r"""Whether the mean of an ensemble follows the law that `finite_time_fit` fits, with its correlations in time.

The curves of all trajectories are correlated in time, so residuals of the mean curve are not independent and their size
over the error band tells nothing.  Combinations of p + 3 sample times that vanish for every $\lambda + c_1/\sqrt t +
c_0/t$ make p numbers of each trajectory.  Hotelling's statistic of their means,

$$ T^2 = n\,\bar z^T S^{-1}\bar z, \qquad F = \frac{n - p}{p (n - 1)}\,T^2, $$

has the F distribution with p and n - p degrees of freedom if the mean curve is of that form, whatever its coefficients,
and the numbers of the trajectories are normally distributed; if they are not, it has it nearly, for many trajectories,
and less and less so in the tail.

References: Hotelling, Ann. Math. Statist. 2 (1931) 360.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.errors import ParameterError
from liepoisson.formula.scalars import as_array, as_count
from liepoisson.indicators.estimates import Window
from liepoisson.indicators.finite_time_fit import as_window, finite_time_fit, last_decade
from liepoisson.inputs.arrays import Array, ReadOnlyArrays, check_shape
from liepoisson.inputs.calls import explains_its_arguments
from liepoisson.inputs.given import at_times
from liepoisson.portable import linear

_COEFFICIENTS = 3
# Contrasts are known to some 1e-16 of the curves, and eigenvalues, squares of spreads, to 1e-16 of the largest: spreads
# below are round-off.  Those of ensembles of tops differ by factors of up to 60.
_ROUND_OFF = 1e-14
_SINGULAR = 1e-7
# So far into its tail the statistic of trajectories that are not normally distributed does not follow F; the figures of
# a smaller probability would say nothing.
_SMALLEST = 1e-6


@dataclass(frozen=True)
class FitGoodness(ReadOnlyArrays):
    """Goodness of the fit of a mean finite-time exponent.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 200, seed=1), t_end=500)
        >>> found = lp.fits.fit_goodness(growth.time, growth.exponent, window=(50, 500))
        >>> found.n_members, found.n_degrees, found.p_value > 0.05
        (200, 6, True)

    Attributes:
        chi_squared: Hotelling's T^2: chi squared with `n_degrees` degrees of freedom for very many trajectories.
        n_degrees: Degrees of freedom p.
        p_value: Probability of a larger value if the law holds, from the F distribution.  Below some 1e-6 its size says
            no more than that: trajectories are not normally distributed so far out.
        autocorrelation: Correlation of neighbouring residuals of the mean curve: near 1, the residuals are a smooth
            curve, which may be the correlations of the trajectories or a law that does not fit; `p_value` tells which.
        n_members: Trajectories that finished.
    """

    chi_squared: float
    n_degrees: int
    p_value: float
    autocorrelation: float
    n_members: int

    def __str__(self) -> str:
        verdict = "not refused" if self.p_value > 0.05 else "refused"
        p_value = f"p = {self.p_value:.2g}" if self.p_value >= _SMALLEST else f"p < {_SMALLEST:.0e}"
        return (
            f"chi squared {self.chi_squared:.1f} for {self.n_degrees} degrees of freedom: the law is "
            f"{verdict} ({p_value}); neighbouring residuals correlate by {self.autocorrelation:.2f}"
        )


@explains_its_arguments
def fit_goodness(
    time: ArrayLike, exponent: ArrayLike, *, window: Window | None = None, n_degrees: int = 6
) -> FitGoodness:
    r"""Goodness of $\lambda + c_1/\sqrt t + c_0/t$ for the mean of an ensemble in a window.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> growth = lp.finite_time_exponents(top, lp.sample_states(top, 200, seed=1), t_end=500)
        >>> early = lp.fits.fit_goodness(growth.time, growth.exponent, window=(1, 500))
        >>> late = lp.fits.fit_goodness(growth.time, growth.exponent, window=(50, 500))
        >>> early.p_value < 1e-6, late.p_value > 0.05  # the law is asymptotic
        (True, True)

    Args:
        time: Sample times, shape (time,), positive and increasing.
        exponent: Finite-time exponents, shape (trajectory, time).  Trajectories that did not finish are left out.
        window: First and last time used; by default the last decade of the sample times.
        n_degrees: Degrees of freedom p: p + 3 of the sample times, evenly spread in order, are used.  The p-value
            depends on it: more degrees see finer structure and dilute what is coarse.  Choose it before looking.

    Raises:
        ShapeError: `exponent` is not (trajectory, time).
        ParameterError: bad times or window, fewer than p + 3 sample times in it, fewer than 10 p trajectories, or
            trajectories whose differences from the law do not vary independently, as where all are the same.
    """
    times = as_array(time, "time")
    curves = as_array(at_times(exponent, "exponent", times.ravel().tolist()), "exponent")
    window = last_decade(times) if window is None else as_window(window)
    fit = finite_time_fit(times, curves, window=window, n_bootstrap=2)
    check_shape(curves.ndim == 2, "exponent", "(trajectory, time)", curves, "Transpose it?")
    inside = np.flatnonzero((times >= window[0]) & (times <= window[1]))
    p = as_count(n_degrees, "n_degrees", least=1, most=max(1, len(inside) - _COEFFICIENTS))
    curves = curves[np.isfinite(curves).all(axis=1)]
    if len(curves) < 10 * p:
        raise ParameterError(
            f"goodness: wanted at least {10 * p} trajectories for {p} degrees; got {len(curves)}; take more"
        )
    picked = inside[np.round(np.linspace(0, len(inside) - 1, p + _COEFFICIENTS)).astype(int)]
    contrasts = linear.matmul(curves[:, picked], _contrasts(times[picked]))
    mean = contrasts.mean(axis=0)
    covariance = linear.cov(contrasts)
    spread = np.sqrt(np.maximum(linear.eigvalsh(covariance), 0.0))
    if spread[0] <= max(_ROUND_OFF * np.abs(curves[:, picked]).max(), _SINGULAR * spread[-1]):
        raise ParameterError(
            f"goodness: wanted trajectories that differ from each other in all {p} degrees; got (nearly) the same "
            "curve, or curves of too few kinds; take other trajectories, or a smaller n_degrees"
        )
    squared = float(linear.matmul(len(curves) * mean, linear.solve(covariance, mean)))
    ratio = squared * (len(curves) - p) / (p * (len(curves) - 1))
    residual = curves[:, inside].mean(axis=0) - fit.curve(times[inside])
    return FitGoodness(squared, p, _f_tail(ratio, p, len(curves) - p), _neighbours(residual), len(curves))


def _contrasts(times: Array) -> Array:
    """Orthonormal combinations of samples at these times that vanish for the law, as columns."""
    design = np.stack([np.ones_like(times), 1 / np.sqrt(times), 1 / times], axis=1)
    return linear.qr(design, mode="complete")[0][:, _COEFFICIENTS:]


def _neighbours(residual: Array) -> float:
    return float(linear.matmul(residual[1:], residual[:-1]) / linear.matmul(residual, residual))


def _f_tail(ratio: float, p: int, q: int) -> float:
    r"""Probability that F with p and q degrees of freedom exceeds `ratio`: $I_x(q/2, p/2)$ at $x = q/(q + p F)$.

    Above 1/2 it is $1 - I_{1-x}(p/2, q/2)$, since x may be so near to 1 that it is 1 to all its digits.
    """
    from flint import arb, ctx

    with ctx.workprec(128):
        a, b, first = arb(p) / 2, arb(q) / 2, p * arb(ratio)
        most = 1 - (first / (first + q)).beta_lower(a, b, regularized=True)
        return float(most if most > 0.5 else (q / (first + q)).beta_lower(b, a, regularized=True))
