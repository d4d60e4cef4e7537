"""Options that several commands have: seed, threads, time limit, and what times are where none is given."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


MEDIAN_T_END_HELP = (
    "Time of each run, the t of the system's equations.  [default: 1000 times the natural time of the median orbit]"
)


def check_limits(*, seed: int, time_limit: float, threads: int | None = None) -> None:
    """Refuse a seed, a number of threads or a time limit that no run can have.

    Raises:
        ParameterError: one of them is out of its range.
    """
    from liepoisson.formula.scalars import MOST_THREADS

    if seed < 0:
        raise ParameterError(f"--seed must be at least 0; got {seed}. Try 0.")
    if not time_limit > 0:
        raise ParameterError(f"--time-limit must be a positive number of seconds; got {time_limit:g}. Try 60.")
    if threads is not None and not 1 <= threads <= MOST_THREADS:
        raise ParameterError(f"--threads must be from 1 to {MOST_THREADS}; got {threads}. Leave it out to use all.")


def check_end_time(t_end: float | None) -> None:
    """Refuse an end time that is not positive and finite; None stands for the default.

    Raises:
        ParameterError: it is none.
    """
    if t_end is not None and not 0.0 < t_end < math.inf:
        raise ParameterError(f"--t-end must be a positive finite time; got {t_end:g}. Leave it out.")


def unit_of_time(system: Any, states: NDArray[np.float64]) -> float:
    """The natural time of the median orbit, in which commands take their default times and steps."""
    from liepoisson.numeric.time_scale import N_MEDIAN, time_scale
    from liepoisson.numeric.time_scale import unit_of_time as unit

    return unit(time_scale(system, states[:N_MEDIAN]))
