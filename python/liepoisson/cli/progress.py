"""A progress bar on standard error with rate and time left; silent when that is not a terminal."""

from __future__ import annotations

import sys
from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from liepoisson.cli.ending import INTERRUPTED

if TYPE_CHECKING:
    from rich.progress import Task
    from rich.text import Text

    from liepoisson.studies.twisted_top.integration import Progress

__all__ = ["INTERRUPTED", "progress_bar"]


@contextmanager
def progress_bar() -> Generator[Progress | None]:
    """A listener that draws a bar while the `with` block runs, or None when nobody watches."""
    if not sys.stderr.isatty():
        yield None
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
        """Trajectories x time per second."""

        def render(self, task: Task) -> Text:
            speed = task.finished_speed or task.speed
            return Text("" if speed is None else f"{speed / 1e6:.2f} M/s", style="progress.data.speed")

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
