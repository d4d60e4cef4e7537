"""What a run was given and how it ended: the part that all numeric results share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.compile.field import Field, field_of, record_of
from liepoisson.errors import ParameterError
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.refusals import counted, shown
from liepoisson.io.result import Result, labelled, names_along, recorded
from liepoisson.numeric.methods import Method, method_of, method_record
from liepoisson.numeric.systems import HasField


@dataclass(frozen=True, kw_only=True, eq=False)
class Run(Result):
    """Trajectories of one system: what they were given and how they ended."""

    system: HasField
    components: tuple[str, ...] = names_along("component")
    field: Field = recorded(record_of, field_of)
    method: Method = recorded(method_record, method_of)
    start: Array = labelled("trajectory", "component", long_name="state as it was given")
    outcome: NDArray[np.str_] = labelled("trajectory", long_name="how the trajectory ended")
    time_limit: float = np.inf

    def arguments(self) -> dict[str, Any]:
        """The starts and the method."""
        return {"starts": self.start, "method": self.method}


@dataclass(frozen=True, kw_only=True, eq=False)
class IntegratedRun(Run):
    """Trajectories that were integrated by one call of the core."""

    end_time: Array = labelled("trajectory", long_name="time reached")
    n_steps: NDArray[np.int64] = labelled("trajectory", long_name="accepted steps", units="1")
    end_state: Array = labelled("trajectory", "component", long_name="last good state")
    order: int
    kernel: str


def whole(time: Array, t_end: float) -> float:
    """The last time, of evenly spaced times up to it.

    Raises:
        ParameterError: they are others: some were cut off or turned round, and the run cannot be made from them.
    """
    n = len(time)
    if not n or not np.allclose(time, t_end * np.arange(1, n + 1) / n, rtol=1e-12, atol=0.0):
        raise ParameterError(f"time: wanted all times of the run, up to {t_end:g}; got {shown(time)}; load the file")
    return t_end


def outcome_names(codes: NDArray[np.int8]) -> NDArray[np.str_]:
    """Outcomes by name."""
    return np.array(_core.outcomes())[codes]


def trajectories(outcome: NDArray[np.str_]) -> str:
    """How many there are, and how many of them failed, as a `repr` says it."""
    failed = int(np.sum(outcome != "finished"))
    return counted(outcome.size, "trajectory", "trajectories") + (f" ({failed} failed)" if failed else "")


def typical(quantity: str, values: Array) -> str:
    """The median of the finite ones among the values, as a `repr` says it: the value itself if there is one."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return f"no {quantity}"
    return f"{'median ' if finite.size > 1 else ''}{quantity} {np.median(finite):.4g}"
