"""One orbit of a sweep again: the system of its point, and where it started."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liepoisson import __version__
from liepoisson.errors import ParameterError
from liepoisson.numeric.verdict import as_rule
from liepoisson.sweeps.targets import evaluate_targets
from liepoisson.sweeps.tasks import FAILED, NO_START, NO_SYSTEM, Piece, system_and_starts

if TYPE_CHECKING:
    from liepoisson.arrays import Array
    from liepoisson.sweeps.result import Sweep


def orbit_at(sweep: Sweep, point: int, member: int) -> tuple[Any, Array]:
    """The system of a point, and the start of one of its orbits, shape (component,): the same numbers as in the sweep.

    Raises:
        ParameterError: the point has no system, or this orbit no start with the wanted energy and Casimirs.
    """
    if int(sweep.outcome_code[point, member]) in (NO_START, NO_SYSTEM, FAILED):
        raise ParameterError(
            f"orbit {member} of point {point} ({point_in_words(sweep, point)}) cannot be computed again: "
            f"its outcome is {str(sweep.outcome[point, member])!r}. Take another one."
        )
    system, states = system_and_starts(_piece(sweep, point))
    return system, states[member]


def reasons(sweep: Sweep) -> NDArray[np.str_]:
    """Why points have no orbit with a value, shape (point,): how all ended, or why there is no system; else ""."""
    return np.array([_reason(sweep, point) for point in range(len(sweep.points))], dtype=np.str_)


def _reason(sweep: Sweep, point: int) -> str:
    ended = sorted(set(sweep.outcome[point].tolist()) - {"finished"})
    if np.isfinite(sweep.value[point]).any() or not ended:
        return ""
    if (sweep.outcome_code[point] == NO_SYSTEM).all():
        piece = _piece(sweep, point)
        try:
            piece.family.system(piece.targets.values(0))
        except Exception as error:  # that of the user's function may be of any kind
            return f"no system: {error}"
    return ", ".join(ended)


def _piece(sweep: Sweep, point: int) -> Piece:
    spec = sweep.spec
    return Piece(
        index=0,
        family=sweep.system,
        targets=evaluate_targets(spec, sweep.system, sweep.points[[point]]),
        n_points=1,
        starts=spec.starts,
        n=spec.n_starts,
        t_end=float(spec.t_end),
        quantity=spec.quantity,
        rule=as_rule(spec.rule),
        method=spec.method,
        seed=spec.seed,
        version=__version__,
    )


def point_in_words(sweep: Sweep, point: int) -> str:
    """The values of the axes at a point."""
    pairs = zip(sweep.spec.axes, sweep.points[point], strict=True)
    return ", ".join(f"{axis.name} = {value:.6g}" for axis, value in pairs)
