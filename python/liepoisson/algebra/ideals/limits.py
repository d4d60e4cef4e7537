"""How much work a polynomial system may cost, counted so that the answer does not depend on the machine.

The unit is about a microsecond of one core. Each step says what it is going to cost before it is taken; where the sum
passes the limit, the question is not decided, and an error says so.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from liepoisson.errors import LiePoissonError
from liepoisson.inputs.deadline import has_passed


class NotDecidedError(LiePoissonError):
    """A question about polynomials that was not decided within its limits: no answer was given, neither yes nor no."""


@dataclass(frozen=True)
class Limits:
    """What one question about a polynomial system may cost.

    Attributes:
        work: Units of about a microsecond, of all steps together.
        degree: The largest number of complex solutions, with multiplicities, of a system that is solved.
    """

    work: int = 30_000_000
    degree: int = 400

    def budget(self) -> Budget:
        """A fresh account of the work."""
        return Budget(self)


@final
class Budget:
    """The work that was done so far."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.spent = 0.0

    def spend(self, units: float, step: str) -> None:
        """Account for a step before it is taken.

        Raises:
            NotDecidedError: it does not fit into what is left, or the deadline of the call has passed.
        """
        if has_passed():
            raise NotDecidedError(f"not decided: the time limit was reached: {step}. Give a larger time_limit.")
        self.spent += units
        if self.spent > self.limits.work:
            raise NotDecidedError(
                f"not decided within {self.limits.work:.3g} units of work (about {self.limits.work / 1e6:.3g} s): "
                f"{step}. Allow more with Limits(work=...)."
            )
