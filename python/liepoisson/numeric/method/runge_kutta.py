"""The explicit Runge-Kutta method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.inputs.refusals import shown
from liepoisson.numeric.method.method import MAX_STEPS, ROUND_OFF, Method, as_tolerance, keep

SINGLE_TOLERANCE = 2.0**-20
"""Least tolerance in single precision, 16 units of round-off."""


@explains_its_methods
@dataclass(frozen=True)
class RungeKutta(Method):
    r"""The explicit Runge-Kutta method of order 8 of Dormand and Prince, for coarse and middle accuracy and any field.

    Twelve evaluations of the field a step.  Steps adapt to `tol`, by the embedded estimates of orders 5 and 3, or are
    equal.  They end at every wanted time.  No conserved quantity is kept beyond the accuracy of the solution.

    Example:
        >>> oscillator = lp.System(lp.canonical(1), "dot(p, p)/2 + dot(q, q)/2")
        >>> turn = lp.integrate(oscillator, [1, 0], times=[0, 2 * np.pi], method=lp.RungeKutta(tol=1e-9))
        >>> bool(np.abs(turn.end_state - turn.start).max() < 1e-8), int(turn.n_steps[0])
        (True, 16)

    Args:
        tol: Error of a step relative to the size of the state, and of each tangent vector, from 1.1e-16 to 0.1.
        step: Equal steps of at most this size, instead of `tol`.
        precision: "double", or "single" (tops and quadratic fields): everything in single precision, twice as many
            trajectories to a register; each step rounds to 6e-8 of the state, and `tol` is at least 9.6e-7.
        compensated: Carry the rounding error of the sums $x + h\sum_i b_i k_i$ of the state from step to step.
        max_steps: Most steps that one trajectory may take, steps that were refused included.

    Raises:
        ParameterError: A value outside its range, or both `tol` and `step`.

    References:
        Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), DOP853.
    """

    name: ClassVar[str] = "runge-kutta"

    tol: float | None = None
    step: float | None = None
    precision: Literal["double", "single"] = "double"
    compensated: bool = False
    max_steps: int = MAX_STEPS

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        super().__post_init__()
        if self.tol is not None and self.step is not None:
            raise ParameterError(
                "RungeKutta: wanted tol for adaptive steps or step for equal ones; got both; leave out one"
            )
        if self.step is None:
            least, name = (ROUND_OFF, "1.1e-16") if self.precision == "double" else (SINGLE_TOLERANCE, "9.6e-7")
            default = 1e-8 if self.precision == "double" else 1e-5
            keep(self, tol=as_tolerance(default if self.tol is None else self.tol, least, name, f"try {default:g}"))
        if self.compensated not in (True, False):
            raise ParameterError(f"compensated: wanted True or False; got {shown(self.compensated)}")
        if self.compensated and self.precision == "single":
            raise ParameterError('compensated: wanted precision="double"; got "single"; leave one of them out')

    def __str__(self) -> str:
        how = f"tolerance {self.tol:g}" if self.step is None else f"step {self.step:g}"
        compensated = ", compensated sums" if self.compensated else ""
        return f"Runge-Kutta method of order 8, {how}{compensated}" + self._in_precision()
