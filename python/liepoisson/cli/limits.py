"""Options that several commands have, refused before anything is printed or computed: seed, threads, time limit."""

from __future__ import annotations

from liepoisson.errors import ParameterError

_MOST_THREADS = 4096


def check_limits(*, seed: int, time_limit: float, threads: int | None = None) -> None:
    """Refuse a seed, a number of threads or a time limit that no run can have.

    Raises:
        ParameterError: one of them is out of its range.
    """
    if seed < 0:
        raise ParameterError(f"--seed must be at least 0; got {seed}. Try 0.")
    if not time_limit > 0:
        raise ParameterError(f"--time-limit must be a positive number of seconds; got {time_limit:g}. Try 60.")
    if threads is not None and not 1 <= threads <= _MOST_THREADS:
        raise ParameterError(f"--threads must be from 1 to {_MOST_THREADS}; got {threads}. Leave it out to use all.")
