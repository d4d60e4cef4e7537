"""Splitting methods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from liepoisson.inputs.calls import explains_its_methods
from liepoisson.numeric.method.method import MAX_STEPS, Method


@explains_its_methods
@dataclass(frozen=True)
class Splitting(Method):
    r"""Composition of the exact flows of the pieces of the Hamiltonian: a Poisson map that keeps every Casimir.

    For a top $H = T + V$: T flows by rotations (two for equal moments, else three), $V = a\cdot\alpha + b\cdot\beta$ by
    a polynomial in time.  For any other `System` the Hamiltonian must be a polynomial, a sum of powers of linear forms:
    $F(\xi\cdot x)$ flows by $\exp(t F'(\xi\cdot x)\,\mathrm{ad}^*_\xi)$.  The energy is not kept, but its error stays
    bounded over very long times.  Steps are equal and end at every wanted time.

    Example:
        >>> top, start = lp.Top.kovalevskaya(), {"l": (1, 0, 1), "alpha3": 1}
        >>> run = lp.integrate(top, start, t_end=1000, method=lp.Splitting(step=0.05))
        >>> bool(run.drift["C1"].max() < 1e-12), bool(run.drift["H"].max() < 1e-8)  # a Poisson map
        (True, True)

    Args:
        step: Largest step, in units of the system's own time.
        order: 2, 4, 6 or 8.
        precision: "double", or "single" (tops only): everything in single precision.
        max_steps: Most steps that one trajectory may take.

    Raises:
        ParameterError: A value outside its range.

    References:
        McLachlan, Phys. Rev. Lett. 71 (1993) 3043 (Lie-Poisson splitting); Strang (1968); Blanes and Moan, J. Comput.
        Appl. Math. 142 (2002) 313 (orders 4 and 6); Kahan and Li, Math. Comp. 66 (1997) 1089 (order 8).
    """

    name: ClassVar[str] = "splitting"

    step: float
    order: int = 4
    precision: Literal["double", "single"] = "double"
    max_steps: int = MAX_STEPS

    def __str__(self) -> str:
        return f"splitting of order {self.order}, step {self.step:g}" + self._in_precision()
