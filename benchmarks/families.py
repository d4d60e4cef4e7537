"""Which methods of liepoisson take part?  Families of settings, each from loose to tight."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

TOLERANCES = [10.0 ** (-k / 8) for k in range(16, 128)]
"""Eight to a decade, from 1e-2 to 1.3e-16."""
STEPS = [1.5 * 2.0 ** (-k / 16) for k in range(112)]
"""Sixteen to an octave, from 1.5 to 0.012: the next tighter step costs 4% more."""


@dataclass(frozen=True)
class Family:
    """One method of liepoisson with one number left to choose.

    Attributes:
        name: What the tables call it.
        method: The class, by name.
        varied: The argument that is left to choose, `tol` or `step`.
        precision: "double", "mixed" or "single".
        options: The other arguments.
    """

    name: str
    method: str
    varied: str
    precision: str = "double"
    options: dict[str, Any] = field(default_factory=dict)

    def requests(self) -> list[dict[str, Any]]:
        """What the worker is asked for, loosest first: the class and its arguments."""
        fixed = self.options | ({} if self.precision == "double" else {"precision": self.precision})
        values = TOLERANCES if self.varied == "tol" else STEPS
        return [{"method": {"name": self.method, self.varied: value, **fixed}} for value in values]

    @property
    def judged_by_tangent(self) -> bool:
        """Whether the tangent vector, too, has to meet the level: not in mixed precision, which computes it roughly."""
        return self.precision != "mixed"


TAYLOR = Family("Taylor", "Taylor", "tol")
MIXED = Family("Taylor, mixed precision", "Taylor", "tol", "mixed")


def _fixed_steps(precision: str, suffix: str) -> list[Family]:
    runge_kutta = Family(f"RungeKutta, fixed step{suffix}", "RungeKutta", "step", precision)
    splittings = [
        Family(f"Splitting, order {order}{suffix}", "Splitting", "step", precision, {"order": order})
        for order in (4, 6, 8)
    ]
    return [runge_kutta, *splittings]


DOUBLE = [TAYLOR, Family("RungeKutta, tolerance", "RungeKutta", "tol"), *_fixed_steps("double", "")]
SINGLE = [
    Family("RungeKutta, tolerance, single precision", "RungeKutta", "tol", "single"),
    *_fixed_steps("single", ", single precision"),
]

AT_LEVEL = {1e-13: [*DOUBLE[:3], MIXED], 1e-8: [*DOUBLE, MIXED], 1e-4: DOUBLE}
"""Splitting is left out at 1e-13: at best its errors are 1.2e-13 (state) and 2.6e-13 (tangent)."""
