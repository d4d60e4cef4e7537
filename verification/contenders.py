"""The methods under test: how each is made from its tolerance or step, what it is called, and how it is drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import liepoisson as lp
from liepoisson.plot.style import ANGULAR_MOMENTUM, CENTRE_OF_MASS, FIRST_FIELD, SECOND_FIELD, VIOLET


@dataclass(frozen=True)
class Contender:
    """A method with one number left open.

    Attributes:
        name: In tables and legends.
        knob: What the open number is, "tol" or "step".
        order: Its order; None where the order follows from the tolerance.
        make: The method for a tolerance or a step.
        colour: Of its curves, one for each family.
        marker: Of its points, one for each order.
        double: Whether all of it is in double precision.
    """

    name: str
    knob: str
    order: int | None
    make: Callable[[float], Any]
    colour: str
    marker: str
    double: bool = True

    @property
    def style(self) -> dict[str, Any]:
        """How its curve is drawn: open markers for single and mixed precision."""
        face = self.colour if self.double else "white"
        return {"color": self.colour, "marker": self.marker, "markerfacecolor": face, "linewidth": 0.8}


MARKERS = {2: "o", 4: "s", 6: "^", 8: "D"}


def _splitting(order: int) -> Contender:
    def make(step: float) -> Any:
        return lp.Splitting(step=step, order=order)

    return Contender(f"splitting {order}", "step", order, make, FIRST_FIELD, MARKERS[order])


def _gauss(order: int) -> Contender:
    def make(step: float) -> Any:
        return lp.Gauss(step=step, order=order)

    name = "implicit midpoint" if order == 2 else f"Gauss {order}"
    return Contender(name, "step", order, make, SECOND_FIELD, MARKERS[order])


TAYLOR = Contender("Taylor", "tol", None, lambda tol: lp.Taylor(tol=tol), ANGULAR_MOMENTUM, "o")
MIXED = Contender(
    "Taylor, mixed precision",
    "tol",
    None,
    lambda tol: lp.Taylor(tol=tol, precision="mixed"),
    CENTRE_OF_MASS,
    "o",
    double=False,
)
ADAPTIVE = Contender("Runge-Kutta 8, adaptive", "tol", 8, lambda tol: lp.RungeKutta(tol=tol), VIOLET, "v")
FIXED = Contender("Runge-Kutta 8", "step", 8, lambda step: lp.RungeKutta(step=step), VIOLET, "D")
COMPENSATED = Contender(
    "Runge-Kutta 8, compensated", "step", 8, lambda step: lp.RungeKutta(step=step, compensated=True), "#4b5563", "D"
)
SINGLE_RUNGE_KUTTA = Contender(
    "Runge-Kutta 8, single precision",
    "step",
    8,
    lambda step: lp.RungeKutta(step=step, precision="single"),
    VIOLET,
    "D",
    double=False,
)
SINGLE_SPLITTING = Contender(
    "splitting 4, single precision",
    "step",
    4,
    lambda step: lp.Splitting(step=step, order=4, precision="single"),
    FIRST_FIELD,
    "s",
    double=False,
)
SPLITTING = {order: _splitting(order) for order in MARKERS}
GAUSS = {order: _gauss(order) for order in MARKERS}

WITH_STEPS = (*SPLITTING.values(), *GAUSS.values(), FIXED)
WITH_TOLERANCES = (TAYLOR, ADAPTIVE)


def exactly(interval: float, n: int) -> float:
    """A step that the method turns into `interval / n`.

    Methods without power series divide an interval into equal steps, as few as are no longer than asked for; a hair
    more keeps round-off from making it one step more.
    """
    return interval / n * (1 + 1e-9)
