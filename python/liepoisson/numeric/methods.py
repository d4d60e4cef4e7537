"""Methods of integration, as data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from liepoisson.errors import ParameterError
from liepoisson.numeric._checks import as_count, as_number, shown

ROUND_OFF = 2.0**-53
MAX_ORDER = 64


@dataclass(frozen=True)
class Taylor:
    r"""The adaptive Taylor method.

    Each step expands the solution in powers of time, $x(t+\tau) = \sum_{k\le N} x_k\tau^k$, and is as long as
    $\|x_k\|\,|\tau|^k \le \mathrm{tol}\,\|x_0\|$ allows for $k = N-1, N$, where $\|\cdot\|$ is the sum of the absolute
    values of the components of the state; likewise for each tangent vector, so a trajectory with tangent vectors
    takes other steps than one without, and agrees with it to the accuracy of the method.

    Args:
        tol: Relative size of the last retained terms, from 1.1e-16 to 0.1.  The local error is smaller by about
            $h/\rho$, the step over the radius of convergence (about 0.15).
        order: $N$, from 2 to 64; by default the cheapest for `tol`.
        max_steps: Most steps that one trajectory may take; one that needs more ends with the outcome "max steps".

    Raises:
        ParameterError: A value outside its range.

    References:
        Jorba and Zou, Experimental Mathematics 14 (2005) 99.
    """

    tol: float = 1e-15
    order: int | None = None
    max_steps: int = 100_000_000

    def __post_init__(self) -> None:
        """Checks the ranges and keeps plain numbers, which can be written to a file."""
        tol = as_number(self.tol, "tol", "a number from 1.1e-16 to 0.1")
        if not ROUND_OFF <= tol <= 0.1:
            raise ParameterError(f"tol: wanted a number from 1.1e-16 to 0.1; got {tol!r}; try 1e-15")
        object.__setattr__(self, "tol", tol)
        if self.order is not None:
            order = as_count(self.order, "order", least=2, most=MAX_ORDER, hint="leave it out to be chosen")
            object.__setattr__(self, "order", order)
        max_steps = as_count(self.max_steps, "max_steps", least=1, hint="try 1_000_000")
        object.__setattr__(self, "max_steps", max_steps)

    @property
    def parameters(self) -> tuple[float, int | None, int]:
        """What the core takes."""
        return self.tol, self.order, self.max_steps


def as_method(method: Any, default: Taylor) -> Taylor:
    """The method, or the default one for None.

    Raises:
        ParameterError: It is not a method object.
    """
    if method is None:
        return default
    if not isinstance(method, Taylor):
        raise ParameterError(f"method: wanted a method object; got {shown(method)}; try method=Taylor(tol=1e-13)")
    return method
