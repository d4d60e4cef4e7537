"""The time that a call may take: one deadline, made where the call begins, which all of its parts see.

A part deep inside has no argument for it: it asks with `checkpoint` as often as it does a little work.  A call without
a limit of time has no deadline, and nothing is asked.
"""

from __future__ import annotations

import time
from collections.abc import Generator
from contextlib import contextmanager
from contextvars import ContextVar

from liepoisson.errors import TimeLimitError

BLOCK = 2048
"""Starts that a search works on together, before it looks at the clock again."""

SEARCH_LIMIT, FAMILY_LIMIT = 60.0, 600.0
"""Seconds of exact searches by default: of one system, and of all values of its parameters."""

CUT_SHORT = "; the time limit ended the search"
"""What the text of a result ends with, whose search was ended so."""

LEAST = 1e-9
"""Seconds of a part whose time is over; it must have some."""

_current: ContextVar[Deadline | None] = ContextVar("deadline of the call", default=None)


class Deadline:
    """When a call gives up.

    Args:
        seconds: From now, a positive number.
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._end = time.monotonic() + self.seconds

    @property
    def left(self) -> float:
        """Seconds until then, at least 0."""
        return max(self._end - time.monotonic(), 0.0)

    def lasts(self) -> bool:
        """Whether there is time left."""
        return time.monotonic() < self._end

    @contextmanager
    def running(self) -> Generator[Deadline]:
        """The block of the call, in which this deadline holds, or that of a call around it if it is the earlier one."""
        outer = _current.get()
        token = _current.set(outer if outer is not None and outer._end < self._end else self)
        try:
            yield self
        finally:
            _current.reset(token)


def has_passed() -> bool:
    """Whether the deadline of the call has passed; not where it has none."""
    deadline = _current.get()
    return deadline is not None and not deadline.lasts()


def seconds_left(most: float) -> float:
    """Seconds until the deadline of the call, a positive number of at most `most`: what one of its parts may take."""
    deadline = _current.get()
    return most if deadline is None else min(most, max(deadline.left, LEAST))


def blocks(n: int) -> Generator[int]:
    """The sizes of the blocks that make up n starts; no more of them once the deadline of the call has passed."""
    for done in range(0, n, BLOCK):
        if has_passed():
            return
        yield min(BLOCK, n - done)


def checkpoint(step: str) -> None:
    """Give up where the deadline of the call has passed.

    Args:
        step: What is under way, in words.

    Raises:
        TimeLimitError: it has.
    """
    if has_passed():
        raise passed(step)


def passed(step: str) -> TimeLimitError:
    """The error of a part that gives up; `step` says what was under way."""
    return TimeLimitError(f"the time limit has passed: {step} was under way. Give a larger time_limit")
