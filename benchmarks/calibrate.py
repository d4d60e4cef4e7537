"""Which setting does each side need?  The loosest whose measured errors meet the level; never its nominal value.

An error is the median over all starts, at t = 20, of the relative error of the state, and of the tangent vector; both
must be at most the level.  A looser setting is the faster one on both sides, so the loosest is the fastest.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import measure
import problem

if TYPE_CHECKING:
    from problem import Array
    from reference import Extended

HEYOKA_ORDERS = range(3, 22)
HEYOKA_SINGLE_ORDERS = range(3, 11)
"""Single precision: the tolerance of order 10 is below round-off, 6e-8."""


@dataclass(frozen=True)
class Setting:
    """What a side is asked for, with the errors that it brings.

    Attributes:
        request: What makes the choice: `tol`, or the method of liepoisson with its arguments.
        order: Order of the method; 0 where a side does not say.
        state: Median relative error of the state.
        tangent: Median relative error of the tangent vector; 0 where there is none.
        exponent: Median error of the finite-time exponent, in inverse time; 0 where there is none.
        exponent_largest: The largest of these errors.
        exponent_mean: Error of the mean exponent of the ensemble.
        largest: For state and tangent vector the largest error, the number of its start, and how many times longer its
            tangent vector has become.
        seconds: The least of a first look, where there was one.
        cold: Seconds of the processor from the start of a process to its first result, where they were measured.
    """

    request: dict[str, Any]
    order: int
    state: float
    tangent: float = 0.0
    exponent: float = 0.0
    exponent_largest: float = 0.0
    exponent_mean: float = 0.0
    largest: dict[str, Any] = field(default_factory=dict)
    seconds: float = 0.0
    cold: float = 0.0

    def meets(self, state: float, tangent: float) -> bool:
        """Whether both errors are at most those given; an error that is not a number is not."""
        return self.state <= state and self.tangent <= tangent

    def worst(self, judged_by_tangent: bool) -> float:
        """The larger of the errors that count; infinity for one that is not a number."""
        worst = max(self.state, self.tangent if judged_by_tangent else 0.0)
        return worst if np.isfinite(self.state + self.tangent) else float("inf")


def scan(side: str, request: dict[str, Any], exact: Extended, folder: Path) -> list[Setting]:
    """Errors of one side for all that the request lists, in its order."""
    out = folder / "scan.npz"
    answer, _ = measure.call(side, request | {"task": "scan", "t_end": problem.T_ACCURACY, "out": str(out)})
    with np.load(out) as arrays:
        found = {name: arrays[name] for name in ("state", "tangent", "exponent")}
    out.unlink()
    return [
        setting_of(chosen, {name: values[k] for name, values in found.items() if values.size}, exact)
        for k, chosen in enumerate(answer["settings"])
    ]


def setting_of(chosen: dict[str, Any], ends: dict[str, Array], exact: Extended) -> Setting:
    """One setting with its errors, from what was reached at t = 20; all but the state may be missing."""
    errors: dict[str, float] = {"state": _median(ends["state"], exact[:, :9])}
    if "tangent" in ends:
        errors["tangent"] = _median(ends["tangent"], exact[:, 9:])
        growth = np.log(np.linalg.norm(exact[:, 9:], axis=1)) / np.longdouble(problem.T_ACCURACY)
        off = np.asarray(ends["exponent"] - growth, dtype=np.float64)
        errors["exponent"] = float(np.median(np.abs(off)))
        errors["exponent_largest"] = float(np.abs(off).max())
        errors["exponent_mean"] = float(abs(off.mean()))
    return Setting(chosen["request"], chosen["order"], **errors)


def _median(ends: Array, exact: Extended) -> float:
    return float(np.median(problem.relative_error(ends, exact)))


def loosest(
    settings: list[Setting], state: float, tangent: float, judged_by_tangent: bool = True
) -> tuple[Setting, bool]:
    """The loosest setting with errors at most those given, and True; if there is none, the most accurate, and False."""
    for setting in settings:
        if setting.meets(state, tangent if judged_by_tangent else float("inf")):
            return setting, True
    return min(settings, key=lambda setting: setting.worst(judged_by_tangent)), False
