"""How trajectories ended, by name, and what the line of a result says of many."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from liepoisson import _core
from liepoisson.inputs.arrays import Array


def outcome_names(codes: NDArray[np.int8]) -> NDArray[np.str_]:
    """Outcomes by name."""
    return np.array(_core.outcomes())[codes]


def trajectories(outcome: NDArray[np.str_]) -> str:
    """How many there are, and how many of them failed, as a `repr` says it."""
    failed = int(np.sum(outcome != "finished"))
    return f"{outcome.size} trajector{'y' if outcome.size == 1 else 'ies'}" + (f" ({failed} failed)" if failed else "")


def typical(quantity: str, values: Array) -> str:
    """The median of the finite ones among the values, as a `repr` says it: the value itself if there is one."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return f"no {quantity}"
    return f"{'median ' if finite.size > 1 else ''}{quantity} {np.median(finite):.4g}"
