"""One orbit of a sweep again: the system of its point, and where it started."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from liepoisson.errors import ParameterError
from liepoisson.sweeps.targets import evaluate_targets
from liepoisson.sweeps.tasks import FAILED, NO_START, NO_SYSTEM, Piece, system_and_starts

if TYPE_CHECKING:
    from liepoisson.inputs.arrays import Array
    from liepoisson.sweeps.result import Sweep


def orbit_at(sweep: Sweep, point: int, member: int) -> tuple[Any, Array]:
    """The system of a point, and where one of its orbits starts, shape (component,): the numbers of the sweep."""
    spec = sweep.spec
    if int(sweep.outcome_code[point, member]) in (NO_START, NO_SYSTEM, FAILED):
        raise ParameterError(
            f"orbit {member} of point {point} ({point_in_words(sweep, point)}) cannot be computed again: "
            f"its outcome is {str(sweep.outcome[point, member])!r}. Take another one."
        )
    targets = evaluate_targets(spec, sweep.system, sweep.points[[point]])
    system, states = system_and_starts(Piece.of(spec, sweep.system, targets, 1))
    return system, states[member]


def point_in_words(sweep: Sweep, point: int) -> str:
    """The values of the axes at a point."""
    pairs = zip(sweep.spec.axes, sweep.points[point], strict=True)
    return ", ".join(f"{axis.name} = {value:.6g}" for axis, value in pairs)
