"""Which tolerance does each side need?  The loosest whose measured errors meet the level; never its nominal value.

An error is the median over all starts, at t = 20, of the relative error of the state, and of the tangent vector; both
must be at most the level.  A looser tolerance is the faster one on both sides, so the loosest is the fastest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import measure
import problem

if TYPE_CHECKING:
    from problem import Array
    from reference import Extended

HEYOKA_ORDERS = range(7, 22)
LIEPOISSON_TOLERANCES = [10.0 ** (-k / 8) for k in range(32, 128)]
"""Eight to a decade, from 1e-4 to 1.3e-16."""


@dataclass(frozen=True)
class Setting:
    """A tolerance with the errors that it brings.

    Attributes:
        tol: Tolerance as the user gives it.
        order: Order of the series that follows from it.
        state: Median relative error of the state.
        tangent: Median relative error of the tangent vector; 0 where there is none.
        exponent: Median error of the finite-time exponent, in inverse time; 0 where there is none.
    """

    tol: float
    order: int
    state: float
    tangent: float = 0.0
    exponent: float = 0.0

    def meets(self, state: float, tangent: float) -> bool:
        """Whether both errors are at most those given."""
        return self.state <= state and self.tangent <= tangent


def scan(side: str, request: dict[str, Any], exact: Extended, folder: Path) -> list[Setting]:
    """Errors of one side at all tolerances, loosest first."""
    out = folder / "scan.npz"
    answer, _ = measure.call(side, request | {"task": "scan", "t_end": problem.T_ACCURACY, "out": str(out)})
    with np.load(out) as arrays:
        states, tangents, exponents = (arrays[name] for name in ("state", "tangent", "exponent"))
    out.unlink()
    settings = [
        Setting(**chosen, state=_median(states[k], exact[:, :9])) for k, chosen in enumerate(answer["settings"])
    ]
    if not request["single"]:
        growth = np.log(np.linalg.norm(exact[:, 9:], axis=1)) / np.longdouble(problem.T_ACCURACY)
        settings = [
            replace(
                setting,
                tangent=_median(tangents[k], exact[:, 9:]),
                exponent=float(np.median(np.abs(exponents[k] - growth))),
            )
            for k, setting in enumerate(settings)
        ]
    return sorted(settings, key=lambda setting: -setting.tol)


def _median(ends: Array, exact: Extended) -> float:
    return float(np.median(problem.relative_error(ends, exact)))


def loosest(settings: list[Setting], state: float, tangent: float) -> tuple[Setting, bool]:
    """The loosest setting with errors at most those given, and True; if there is none, the most accurate, and False."""
    for setting in settings:
        if setting.meets(state, tangent):
            return setting, True
    return min(settings, key=lambda setting: max(setting.state, setting.tangent)), False
