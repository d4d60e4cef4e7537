"""The diagram of Kovalevskaya's top against the curves and numbers of tori in the literature.

With l.alpha = 2 ell, |alpha| = 1 the critical values are on [kharlamov1988]

- k = 0,
- k = (h - 2 ell^2)^2,
- h = s + ell^2/s^2, k = 1 - 2 ell^2/s + ell^4/s^4.
"""

import numpy as np
import pytest

import liepoisson as lp

TOP = lp.catalog.system("kovalevskaya")
SQUARES = (0.1, 0.6, 0.9, 1.3)
"""ell^2 in each of the four intervals between 0, 1/2, 4/(3 sqrt 3), 1 and infinity, where the diagram changes."""


def leaf(square):
    return lp.Leaf(TOP, {"C1": 2 * square**0.5, "C2": 1})


def third_curve(s, square):
    return s + square / s**2, 1 - 2 * square / s + square**2 / s**4


def on_curves(values, square):
    """How far values are from the nearest curve, which it is, and its s."""
    h, k = values
    s = np.roots([1, -h, 0, square])
    s = s.real[np.abs(s.imag) < 1e-5]
    miss = np.abs(k - third_curve(s, square)[1])
    best = int(miss.argmin())
    misses = [abs(k), abs(k - (h - 2 * square) ** 2), float(miss[best])]
    return min(misses) / max(1.0, abs(k)), int(np.argmin(misses)), float(s[best])
