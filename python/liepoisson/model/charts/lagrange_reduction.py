r"""Reduced Lagrange tops: the twisted and charged one with two degrees of freedom, the ordinary one with one.

In the gauge $(e_3, e_1)$ the angle psi does not occur and $p_\psi = \ell_3$ is constant:

$$H = \frac{p_\theta^2}{2I_1} + \frac{(p_\phi - \ell_3\cos\theta)^2}{2I_1\sin^2\theta} + \frac{\ell_3^2}{2I_3}
  + (a_3v + b_3w)\cos\theta + a_3\,r\sin\theta\sin\phi, \qquad r^2 = \eta - 2\epsilon w\,p_\phi .$$

What the reductions of Lagrange tops share: which tops they take, the conserved l3, and the cyclic angle psi.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liepoisson.algebra.exact_numbers import as_float, is_zero, to_sympy
from liepoisson.errors import ParameterError, ShapeError
from liepoisson.formula.numbers import as_array
from liepoisson.formula.parameters import Parameter, read_parameter
from liepoisson.inputs.arrays import Array
from liepoisson.inputs.calls import explains_its_methods
from liepoisson.model.canonical_system import CanonicalSystem
from liepoisson.model.charts.euler_chart import EulerChart
from liepoisson.model.charts.leaf_constants import COMPONENTS, FIELDS, GivenLeaf, chart_points, decimal, refuse, top_of
from liepoisson.model.hamiltonian import symbols_in
from liepoisson.model.top_parameters import TopParameters
from liepoisson.portable import linear

if TYPE_CHECKING:
    from sympy import Expr


def check_lagrange(top: TopParameters) -> None:
    """Refuse tops without a symmetry axis.

    Raises:
        ParameterError: the first two moments differ, or a or b is not along the third axis.
    """
    first, second, _ = (to_sympy(value) for value in top.inertia)
    off_axis = [value for vector in (top.a, top.b) for value in vector[:2] if not is_zero(value)]
    if first != second or off_axis:
        raise ParameterError(
            "the reduction needs a Lagrange top: I1 = I2 and a, b along the third axis; got "
            f"{top.describe()}. Use EulerChart for other tops."
        )


def conserved_l3(l3: Parameter | None, state: ArrayLike | None, *, symbolic: bool) -> Any:
    """The value of l3: as given, from the state, or a symbol.

    Raises:
        ParameterError: it is given twice, or missing beside a leaf.
    """
    if state is not None and l3 is not None:
        raise ParameterError("l3 is known from the state; got both. Leave l3 out.")
    if state is not None:
        return to_sympy(read_parameter(float(as_array(state, "state", COMPONENTS)[2]), "l3"))
    if l3 is None and not symbolic:
        raise ParameterError("the reduction needs l3 beside the leaf; got none. Give l3=, or a state with state=.")
    return to_sympy(read_parameter("l3" if l3 is None else l3, "l3"))


def cyclic_angle(within: Array, given: ArrayLike | None, shape: tuple[int, ...]) -> Array:
    """The angle psi: the last component of the states, or as given beside them.

    Raises:
        ParameterError: neither or both.
        ShapeError: another shape.
    """
    if (given is None) == (within.shape[-1] == 0):
        raise ParameterError(
            "the state in the body needs psi once; got it "
            + ("not at all. Give psi=, or reduce with_cyclic_angle=True." if given is None else "twice. Leave psi out.")
        )
    if given is None:
        return within[..., 0]
    angle = as_array(given, "psi")
    try:
        return np.broadcast_to(angle, shape)
    except ValueError:
        raise ShapeError(f"psi must have shape {shape}, one for each state; got shape {angle.shape}.") from None


def check_l3(states: Array, l3: Expr) -> None:
    """Refuse states with another l3 than that of the reduction.

    Raises:
        ChartError: with the condition "l3".
    """
    wanted, l = as_float(l3, "l3"), states[..., :3]
    size = 1e-8 * (linear.norm(l, axis=-1) + abs(wanted) + 1e-300)
    hint = "Reduce with state=state for that state."
    refuse(np.abs(l[..., 2] - wanted) > size, l[..., 2], "l3", f"l3 = {wanted:.9g}", quantity="l3", hint=hint)


@explains_its_methods
class ReducedLagrange:
    r"""The twisted (or charged) Lagrange top, $I_1 = I_2$ with a and b along the axis, with psi reduced away.

    Coordinates (phi, theta) with momenta (p_phi, p_theta), at fixed $\ell_3 = p_\psi$ and Casimirs; the gauge is
    $(e_3, e_1)$, in which $\ell\cdot\beta = w p_\phi$.  The domain is that of `EulerChart`.  On beta = 0 one degree of
    freedom is left: `OrdinaryLagrange`.

    Example:
        >>> chart = lp.charts.ReducedLagrange(lp.Top.twisted_lagrange())
        >>> chart.component_names, chart.rate_of_psi
        (('phi', 'theta', 'p_phi', 'p_theta'), 2*l3 - (-l3*cos(theta) + p_phi)*cos(theta)/sin(theta)**2)

    Args:
        system: A Lagrange top, twisted or charged.
        l3: The conserved third component of the angular momentum, if no state is given.
        leaf: A `Leaf`, or the values of C1, C2, C3 of the bracket of the system; l3 is not known from it.
        state: Instead of both, a state, shape (9,).  If nothing is given, l3, v, w and eta stay symbols.
        with_cyclic_angle: Append psi to the state, $\dot\psi = \partial H/\partial p_\psi$, so that the state in the
            body is known.

    Raises:
        ParameterError: the system is no such top, or l3 is given twice or missing.
        ShapeError: `state` is not one state.
        ChartError: the leaf has beta = 0.
    """

    def __init__(
        self,
        system: Any,
        *,
        l3: Parameter | None = None,
        state: ArrayLike | None = None,
        leaf: GivenLeaf | Mapping[str, Parameter] | None = None,
        with_cyclic_angle: bool = False,
    ) -> None:
        check_lagrange(top_of(system))
        state = None if state is None else as_array(state, "state", COMPONENTS)  # once, as it is read twice
        self.chart: EulerChart = EulerChart(system, leaf=leaf, state=state, gauge="e3, e1")
        self.l3: Expr = conserved_l3(l3, state, symbolic=leaf is None)
        self.with_cyclic_angle: bool = with_cyclic_angle
        self.name: str = f"{system.name}, reduced"

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions of the domain."""
        return self.chart.conditions

    @property
    def component_names(self) -> tuple[str, ...]:
        """Names of the components of the state."""
        return ("phi", "theta", "p_phi", "p_theta", *(("psi",) if self.with_cyclic_angle else ()))

    @cached_property
    def hamiltonian(self) -> Expr:
        """The reduced Hamiltonian, in which p_psi is the constant l3."""
        return self._at_l3(self.chart.hamiltonian)

    @cached_property
    def rate_of_psi(self) -> Expr:
        r"""$\dot\psi = \partial H/\partial p_\psi$, a function of (phi, theta, p_phi, p_theta)."""
        H: Any = self.chart.hamiltonian
        return self._at_l3(H.diff(self._p_psi))

    @cached_property
    def system(self) -> CanonicalSystem:
        """The reduced system, followed by psi if it was asked for."""
        quadratures = {"psi": self.rate_of_psi} if self.with_cyclic_angle else None
        coordinates, momenta = ("phi", "theta"), ("p_phi", "p_theta")
        symbols = symbols_in(self.hamiltonian, (*coordinates, *momenta))
        return CanonicalSystem(
            coordinates, momenta, self.hamiltonian, quadratures=quadratures, symbols=symbols, name=self.name
        )

    def to_body(self, z: ArrayLike, psi: ArrayLike | None = None) -> Array:
        """States (l, alpha, beta), shape (..., 9).

        Args:
            z: Reduced states, shape (..., 4), or (..., 5) with the cyclic angle.
            psi: The cyclic angle, shape (...), where the state does not contain it.

        Raises:
            ParameterError: psi is missing or given twice, or l3 is symbolic.
            ChartError: as for `EulerChart.to_body`.
            ShapeError: the last axis of `z` has another length.
        """
        points = chart_points(z, self.component_names, self.component_names)
        angle = cyclic_angle(points[..., 4:], psi, points.shape[:-1])
        phi, theta, p_phi, p_theta = (points[..., k] for k in range(4))
        l3 = np.full(points.shape[:-1], as_float(self.l3, "l3"))
        return self.chart.to_body(np.stack([phi, angle, theta, p_phi, l3, p_theta], axis=-1))

    def from_body(self, states: ArrayLike) -> Array:
        """Reduced states, shape (..., 4), or (..., 5) with the cyclic angle, of states of shape (..., 9).

        Raises:
            ChartError: as for `EulerChart.from_body`, or l3 is not that of the reduction (condition "l3").
        """
        states = chart_points(states, COMPONENTS, FIELDS)
        check_l3(states, self.l3)
        full = self.chart.from_body(states)
        return full[..., [0, 2, 3, 5, *((1,) if self.with_cyclic_angle else ())]]

    def margins(self, states: ArrayLike) -> dict[str, Array]:
        """How far states are from where the chart ends; as `EulerChart.margins`."""
        return self.chart.margins(states)

    @property
    def _p_psi(self) -> Any:
        from sympy import Symbol

        return Symbol("p_psi")

    def _at_l3(self, expression: Any) -> Expr:
        return expression.xreplace({self._p_psi: self.l3})

    def __repr__(self) -> str:
        return f"<ReducedLagrange of {self.chart.top_name!r}: l3 = {decimal(self.l3)}, {self.chart.leaf.describe()}>"
