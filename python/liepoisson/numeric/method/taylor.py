"""Taylor's method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from liepoisson.formula.scalars import as_count
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.numeric.method.method import MAX_STEPS, ROUND_OFF, Method, as_tolerance, keep

MAX_ORDER = 64


@explains_its_methods
@dataclass(frozen=True)
class Taylor(Method):
    r"""The adaptive Taylor method: the default, to round-off or any tolerance, with dense output.

    Each step expands the solution in powers of time, $x(t+\tau) = \sum_{k\le N} x_k\tau^k$, and is as long as
    $\|x_k\|\,|\tau|^k \le \mathrm{tol}\,\|x_0\|$ allows for $k = N-1, N$, where $\|\cdot\|$ is the sum of the absolute
    values of the components of the state; likewise for each tangent vector, so a trajectory with tangent vectors
    takes other steps than one without, and agrees with it to the accuracy of the method.

    Example:
        >>> top, start = lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}
        >>> runs = [lp.integrate(top, start, t_end=100, method=lp.Taylor(tol=tol)) for tol in (1e-15, 1e-6)]
        >>> [run.order for run in runs], [bool(run.drift["H"].max() < 1e-12) for run in runs]
        ([24, 12], [True, False])

    Args:
        tol: Relative size of the last retained terms, from 1.1e-16 to 0.1.  The local error is smaller by about
            $h/\rho$, the step over the radius of convergence (about 0.15).
        order: $N$, from 2 to 64; by default the cheapest for `tol` and, of a system without a kernel of its own, for
            its counted operations.
        precision: "double", or "mixed" (tops only): terms of the state's series below $2^{22}\,\mathrm{tol}$ of the
            state, and all of the tangent vectors, in single precision.  The state is as accurate as in double
            precision; a tangent vector gains a relative error of $\max(6\cdot10^{-8}, \mathrm{tol})$ in a
            step, so an exponent after $n$ steps and time T one of about $\sqrt n/T$ times that.
        max_steps: Most steps that one trajectory may take; one that needs more ends with the outcome "max steps".

    Raises:
        ParameterError: A value outside its range.

    References:
        Jorba and Zou, Experimental Mathematics 14 (2005) 99.
    """

    name: ClassVar[str] = "taylor"

    tol: float = 1e-15
    order: int | None = None
    precision: Literal["double", "mixed"] = "double"
    max_steps: int = MAX_STEPS

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        keep(self, tol=as_tolerance(self.tol, ROUND_OFF, "1.1e-16", "try 1e-15"))
        super().__post_init__()

    def _as_order(self, value: Any) -> int:
        return as_count(value, "order", least=2, most=MAX_ORDER, hint="leave it out to be chosen")

    def __str__(self) -> str:
        return f"Taylor method, tolerance {self.tol:g}" + self._in_precision()
