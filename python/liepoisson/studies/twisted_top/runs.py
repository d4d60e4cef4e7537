r"""What the study computes: one run per top, inertia and ensemble of starts.

The paper follows "20,000 random initial conditions" of the twisted and of the ordinary Kovalevskaya top with
a = (-1, 0, 0) and epsilon = 1, and gives the inertia by ratios only.  It does not say how the starts are drawn, so
three ensembles are run; the ratios allow both (2, 2, 1) and (1, 1, 1/2), so both are; and the ratio as printed,
I3 = 2 I1, is run as well, to show what it would have given.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

import liepoisson as lp

FloatArray: TypeAlias = NDArray[np.float64]
Moments: TypeAlias = tuple[Fraction, Fraction, Fraction]

# Fixed before the first run: where the finite-time law and the logarithmic law are fitted.
WINDOW = (20.0, 200.0)
LOG_WINDOW = (50.0, 1000.0)
ENSEMBLES = ("unit-vectors", "cube", "gaussian")
SMALLEST_END_TIME = 60.0
# Far above any machine; a larger number is a slip of the finger, which would end in an overflow or never.
MOST_THREADS = 4096
MOST_MEMBERS = 10**8
# Measured on 1024 starts of the twisted top: the exponent at t = 20 is then right to 7e-13 (median), the energy at
# t = 200 to 5e-12.  The statistical errors are eight orders larger.
TOLERANCE = 1e-10

CENTRE_OF_MASS = (-1, 0, 0)
KOVALEVSKAYA: Moments = (Fraction(2), Fraction(2), Fraction(1))
KOVALEVSKAYA_HALVED: Moments = (Fraction(1), Fraction(1), Fraction(1, 2))
AS_PRINTED: Moments = (Fraction(1), Fraction(1), Fraction(2))

# Trajectories per stored piece: two seconds of work at t = 1000 on two cores, so an interruption loses little.
PIECE_SIZE = 2000


@dataclass(frozen=True)
class Settings:
    """The options of the study."""

    members: int = 20_000  # random starts per ensemble, 2 to 10^8
    end_time: float = 1000.0  # time to which the main runs go, in units of the top's own time; at least 60
    seed: int = 0  # draws starts and tangent vectors; all runs share it, so tops are compared on the same starts
    tolerance: float = TOLERANCE  # relative tolerance of the Taylor method
    threads: int | None = None  # worker threads, or None for all cores; the results do not depend on it

    def __post_init__(self) -> None:
        if self.members < 2:
            raise lp.errors.ParameterError(f"members must be at least 2, for an error bar; got {self.members}.")
        if self.members > MOST_MEMBERS:
            raise lp.errors.ParameterError(
                f"members must be at most {MOST_MEMBERS}; got {self.members}. Try 20000, as in the report."
            )
        if not (math.isfinite(self.end_time) and self.end_time >= SMALLEST_END_TIME):
            raise lp.errors.ParameterError(
                f"end time must be finite and at least {SMALLEST_END_TIME:g}, so that the fits have a window; "
                f"got {self.end_time:g}. Try 200, or 1000 as in the report."
            )
        if self.seed < 0:
            raise lp.errors.ParameterError(f"seed must be an integer >= 0; got {self.seed}.")
        if self.threads is not None and not 1 <= self.threads <= MOST_THREADS:
            raise lp.errors.ParameterError(
                f"threads must be from 1 to {MOST_THREADS}; got {self.threads}. Leave it out to use all cores."
            )


@dataclass(frozen=True)
class Run:
    """One ensemble of one top."""

    name: str  # stable name, used for files and in `measurements.json`
    inertia: Moments  # principal moments of inertia
    epsilon: int  # cocycle strength, 1 twisted or 0 ordinary
    ensemble: str  # how starts are drawn, see `liepoisson.sample_states`
    members: int  # number of starts
    end_time: float  # last sample time
    seed: int  # draws starts and tangent vectors
    tolerance: float  # relative tolerance of the Taylor method

    @property
    def window(self) -> tuple[float, float]:
        """Window of the finite-time fit, cut at the end time."""
        return WINDOW[0], min(WINDOW[1], self.end_time)

    @property
    def log_window(self) -> tuple[float, float]:
        """Window of the logarithmic fit, cut at the end time."""
        return min(LOG_WINDOW[0], self.end_time / 4), min(LOG_WINDOW[1], self.end_time)

    @property
    def time(self) -> FloatArray:
        """The sample times."""
        return sample_times(self.end_time)

    def top(self) -> lp.Top:
        """The top that is run."""
        return lp.Top(inertia=self.inertia, a=CENTRE_OF_MASS, b=(0, 0, 0), epsilon=self.epsilon)

    def pieces(self) -> Iterator[tuple[int, int]]:
        """(first trajectory, number of trajectories) of each piece that is computed and stored by itself."""
        for first in range(0, self.members, PIECE_SIZE):
            yield first, min(PIECE_SIZE, self.members - first)


def sample_times(end_time: float) -> FloatArray:
    """Every 0.1 to 1, every 0.25 to 5, every 1 to 200, then at most 150 times in geometric progression to the end.

    The early times only draw the rise of the curves: every fit starts at t = 5 or later.  The number of times is
    bounded, so memory and disk do not grow with the end time.
    """
    early = np.concatenate([np.arange(1, 10) / 10, np.arange(4, 20) / 4])
    regular = np.arange(5.0, min(200.0, math.floor(end_time)) + 1)
    late = np.round(np.geomspace(200, end_time, 151)[1:-1]) if end_time > 200 else np.array([])
    return np.unique(np.concatenate([early, regular, late[(late > 200) & (late < end_time)], [end_time]]))


def plan(settings: Settings) -> tuple[Run, ...]:
    """All runs of the study, the ones of the paper's figure first."""
    short = min(200.0, settings.end_time)

    def run(name: str, inertia: Moments, epsilon: int, ensemble: str, end_time: float) -> Run:
        drawn = (settings.members, end_time, settings.seed, settings.tolerance)
        return Run(f"{name}-{ensemble}", inertia, epsilon, ensemble, *drawn)

    main = [
        run(name, KOVALEVSKAYA, epsilon, ensemble, settings.end_time)
        for ensemble in ENSEMBLES
        for name, epsilon in (("twisted", 1), ("ordinary", 0))
    ]
    readings = [
        run("twisted-halved", KOVALEVSKAYA_HALVED, 1, "unit-vectors", short),
        run("twisted-halved", KOVALEVSKAYA_HALVED, 1, "cube", short),
        run("twisted-as-printed", AS_PRINTED, 1, "unit-vectors", short),
        run("ordinary-as-printed", AS_PRINTED, 0, "unit-vectors", short),
    ]
    return (*main, *readings)
