"""Progress on standard error: a bar with rate and time left on a terminal, elsewhere a line from time to time."""

from __future__ import annotations

import sys
import time as clock
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Task
    from rich.text import Text

    from liepoisson.studies.twisted_top.integration import Progress

FIRST_LINE, LATER_LINES = 10.0, 60.0
"""Seconds before the first line where there is no terminal, and between lines: short runs stay silent."""


@contextmanager
def progress_bar(*, quiet: bool = False) -> Generator[Progress | None]:
    """A listener that shows progress while the `with` block runs, or None when nobody wants it."""
    if quiet:
        yield None
        return
    if not sys.stderr.isatty():
        yield _lines_from_time_to_time()
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        ProgressColumn,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.progress import Progress as Bar
    from rich.text import Text

    class RateColumn(ProgressColumn):
        """Trajectories x time per second; nothing where only a fraction is known."""

        def render(self, task: Task) -> Text:
            speed = task.finished_speed or task.speed
            return Text(
                "" if speed is None or (task.total or 0.0) <= 1.0 else f"{speed / 1e6:.2f} M/s",
                style="progress.data.speed",
            )

    columns = (
        TextColumn("{task.description:<34}"),
        BarColumn(),
        TaskProgressColumn(),
        RateColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=None)

        def listen(activity: str, done: float, total: float) -> None:
            # Nothing left to integrate: a full bar, not one of 0 out of 0.
            bar.update(task, description=activity, completed=done if total else 1.0, total=total or 1.0)

        yield listen


@contextmanager
def listening(activity: str, total: float = 1.0, *, quiet: bool) -> Generator[Callable[[float], None] | None]:
    """A listener for the fraction done of one activity, of which `total` is the whole, for the rate; 1: it has none."""
    with progress_bar(quiet=quiet) as bar:
        yield None if bar is None else lambda done: bar(activity, done * total, total)


def _lines_from_time_to_time() -> Progress:
    """A listener for logs: "liepoisson: integrating, 42% after 1 min 10 s, about 1 min 37 s left"."""
    began = clock.monotonic()
    due = began + FIRST_LINE

    def listen(activity: str, done: float, total: float) -> None:
        nonlocal due
        now = clock.monotonic()
        if now < due:
            return
        due = now + LATER_LINES
        share, elapsed = (done / total if total else 1.0), now - began
        left = f", about {_words(elapsed * (1 - share) / share)} left" if share > 0 else ""
        with suppress(OSError, ValueError):  # nobody reads it
            print(f"liepoisson: {activity}, {share:.0%} after {_words(elapsed)}{left}", file=sys.stderr, flush=True)

    return listen


def _words(seconds: float) -> str:
    """A time in two units: "42 s", "1 min 10 s", "3 h 5 min"."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
