"""Progress of a run that is made of several runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def part_of(progress: Callable[[float], Any] | None, done: float, share: float) -> Callable[[float], Any] | None:
    """What a part of a run reports to: the part begins when the fraction `done` of the whole is done.

    What `progress` raises ends the part, and so the whole: an interrupt is seen within each of the parts.

    Args:
        progress: Called with the fraction of the whole run that is done, or None.
        done: That fraction when the part begins.
        share: The part's share of the whole.
    """
    return None if progress is None else lambda fraction: progress(done + share * fraction)
