"""Gauss collocation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from liepoisson.inputs.calls import explains_its_methods
from liepoisson.numeric.method.method import MAX_STEPS, Method


@explains_its_methods
@dataclass(frozen=True)
class Gauss(Method):
    r"""Gauss collocation: implicit, keeps every linear and quadratic invariant to round-off, at any step.

    Order 2 is the implicit midpoint rule $x' = x + h f((x + x')/2)$.  For a canonical bracket these maps are
    symplectic; for a Lie-Poisson bracket they are not Poisson maps.  The implicit equations are solved to round-off;
    where that fails the trajectory ends with the outcome "no convergence".  Steps are equal and end at every wanted
    time.

    Example:
        >>> body = lp.catalog.euler_top_on("so(3)", [1, 2, 3])
        >>> run = lp.integrate(body, [1, 1, 1], t_end=100, method=lp.Gauss(step=0.1, order=2))
        >>> {name: bool(drift.max() < 1e-13) for name, drift in run.drift.items()}  # both are quadratic
        {'H': True, 'C1': True}

    Args:
        step: Largest step, in units of the system's own time.
        order: 2, 4, 6 or 8: twice the number of stages.
        max_steps: Most steps that one trajectory may take.

    Raises:
        ParameterError: A value outside its range.

    References:
        Hairer, Lubich and Wanner, Geometric Numerical Integration, 2nd ed. (2006), II.1.3 and IV.2; Ge and Marsden,
        Phys. Lett. A 133 (1988) 134; Hairer, McLachlan and Razakarivony, BIT 48 (2008) 231 (iteration, sums).
    """

    name: ClassVar[str] = "gauss"

    step: float
    order: int = 4
    max_steps: int = MAX_STEPS

    def __str__(self) -> str:
        name = "implicit midpoint rule" if self.order == 2 else f"Gauss method of order {self.order}"
        return f"{name}, step {self.step:g}"
