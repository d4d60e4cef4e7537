"""Fractions of members: Wilson's interval, for one fraction and for arrays of them."""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.formula.scalars import as_count
from liepoisson.indicators.estimates import Estimate, as_confidence
from liepoisson.inputs.arrays import Array


def proportion(count: int, n: int, *, confidence: float = 0.95) -> Estimate:
    r"""A proportion k/n of independent cases with Wilson's score interval and the binomial standard error.

    The interval holds the p with $|k/n - p|\le z\sqrt{p(1-p)/n}$, so it stays in [0, 1] and is not empty for k = 0,
    where it is $[0, z^2/(n + z^2)]$.

    Raises:
        ParameterError: n is not a whole number >= 1, or `count` is not one from 0 to n.

    References: [wilson1927].
    """
    n = as_count(n, "n", least=1, hint="give at least one case that finished")
    k = as_count(count, "count", most=n)
    low, high = wilson_interval(k, n, as_confidence(confidence))
    return Estimate(k / n, math.sqrt(k / n * (1 - k / n) / n), float(low), float(high))


def wilson_interval(successes: ArrayLike, n: ArrayLike, confidence: float = 0.95) -> tuple[Array, Array]:
    r"""Ends of Wilson's intervals of probabilities from k successes in n trials; NaN where n = 0.

    $\frac{1}{1 + z^2/n}\Bigl(p + \frac{z^2}{2n} \pm z\sqrt{\frac{p(1-p)}{n} + \frac{z^2}{4n^2}}\Bigr)$, $p = k/n$.

    References: [wilson1927].
    """
    z = NormalDist().inv_cdf((1 + confidence) / 2)
    k, trials = np.asarray(successes, np.float64), np.asarray(n, np.float64)
    with np.errstate(all="ignore"):
        p = k / trials
        middle = p + z**2 / (2 * trials)
        half = z * np.sqrt(p * (1 - p) / trials + z**2 / (4 * trials**2))
        low, high = ((middle + sign * half) / (1 + z**2 / trials) for sign in (-1, 1))
    # at the ends the two terms cancel to round-off
    nothing = np.where(trials > 0, 0.0, np.nan)
    return np.where(k == 0, nothing, low), np.where(k == trials, nothing + 1.0, high)
