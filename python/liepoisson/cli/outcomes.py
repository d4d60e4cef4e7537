"""What a command says where none of its orbits came to the end, and with which exit code it ends."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from numpy.typing import NDArray

NO_RUN = 1
"""Exit code of a command that has nothing to report, as no run finished."""


def check_that_some_finished(outcome: NDArray[Any]) -> None:
    """End the command where no run finished, with the reason on standard error.

    Args:
        outcome: How each run ended, shape (trajectory,).

    Raises:
        Exit: no run finished.
    """
    names = sorted({str(name) for name in outcome})
    if "finished" in names:
        return
    if names == ["step too small"]:
        reason = (
            "all orbits left every bounded region, or ran into a singularity (step too small): take a lower energy, "
            "other starts, or an earlier --t-end"
        )
    else:
        reason = f"no run finished ({', '.join(names)})"
    print(f"liepoisson: {reason}.", file=sys.stderr)
    raise typer.Exit(NO_RUN)
